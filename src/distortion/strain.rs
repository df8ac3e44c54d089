//! Principal stretches: how much the map lengthens and widens the sheet at a place.

use super::CompensationError;
use super::quadrature::{plane_points, uniform};
use crate::deform::SmoothMap;
use crate::geometry::{DVec2, DVec3};

/// Principal stretches (greater, smaller) of a surface patch by the images of two orthonormal flat directions.
///
/// The singular values of the 3 x 2 matrix with columns `ru`, `rv`, in closed form.
#[must_use]
pub fn principal_stretches(ru: DVec3, rv: DVec3) -> [f64; 2] {
    let (e, f, g) = (ru.length_squared(), ru.dot(rv), rv.length_squared());
    let mean = (e + g) / 2.0;
    let spread = ((e - g) / 2.0).hypot(f);
    [(mean + spread).sqrt(), (mean - spread).max(0.0).sqrt()]
}

/// Principal stretches (greater, smaller) of one triangle carried from `flat` to `posed`; 1 for a flat triangle
/// without area.
#[must_use]
pub fn facet_strain(flat: [DVec3; 3], posed: [DVec3; 3]) -> [f64; 2] {
    let (u, v) = (flat[1] - flat[0], flat[2] - flat[0]);
    let Some(along) = u.try_normalize() else { return [1.0, 1.0] };
    let length = u.length();
    let shear = v.dot(along);
    let Some(across) = (v - along * shear).try_normalize() else { return [1.0, 1.0] };
    let height = v.dot(across);
    let ru = (posed[1] - posed[0]) / length;
    let rv = (posed[2] - posed[0] - ru * shear) / height;
    principal_stretches(ru, rv)
}

/// Largest and root-mean-square strain of a rectangle of the flat antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StrainSummary {
    /// Largest deviation of a principal stretch from 1.
    pub(super) largest: f64,
    /// Root mean square of both principal strains.
    pub(super) rms: f64,
}

/// Strain of the rectangle about the origin at height z.
///
/// * `n`: samples along each side, rim included, where strain is greatest.
pub(super) fn rectangle_strain(
    map: &impl SmoothMap,
    half: DVec2,
    z: f64,
    n: usize,
) -> Result<StrainSummary, CompensationError> {
    let samples = uniform(n);
    let jacobians = map.jacobians(&plane_points(&samples, &samples, half, z))?;
    let strains = jacobians.iter().flat_map(|(_, j)| principal_stretches(j.col(0), j.col(1)).map(|s| (s - 1.0).abs()));
    let (mut largest, mut squares) = (0.0_f64, 0.0);
    for strain in strains {
        largest = largest.max(strain);
        squares += strain * strain;
    }
    Ok(StrainSummary { largest, rms: (squares / (2 * jacobians.len()) as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_of_a_known_map_are_found_in_any_triangle() {
        // Stretch by 2 along a tilted direction, by 0.5 across, then a rotation out of the plane.
        let (sin, cos) = 0.7_f64.sin_cos();
        let map = |p: DVec3| {
            let (a, b) = (2.0 * (cos * p.x + sin * p.y), 0.5 * (cos * p.y - sin * p.x));
            DVec3::new(a * 0.6, b, a * 0.8)
        };
        let triangle = [DVec3::new(0.1, 0.2, 0.0), DVec3::new(1.3, -0.4, 0.0), DVec3::new(0.7, 0.9, 0.0)];
        let [greater, smaller] = facet_strain(triangle, triangle.map(map));
        assert!((greater - 2.0).abs() < 1e-14 && (smaller - 0.5).abs() < 1e-14, "{greater} {smaller}");
    }
}
