//! Width and length of the deformed patch, by a polynomial fitted to its bottom plane.
//!
//! The bottom plane is sampled on 17 x 17 flat points `(u, v)` in \[-1, 1]², each coordinate is fitted by a tensor
//! polynomial of degree (p, q) in the least-squares sense, and `W' = mean over v of ∫ |r_u| du`, `L'` likewise, by the
//! 24-point Gauss rule. Parametric, so the patch may turn through any angle.

use super::quadrature::{gauss_legendre, plane_points, uniform};
use super::{CompensationError, MAX_FIT_ORDER};
use crate::deform::SmoothMap;
use crate::geometry::{DVec2, DVec3, chebyshev};
use nalgebra::DMatrix;

const SAMPLES: usize = 17;
const GAUSS_POINTS: usize = 24;

/// Measures the width and length (m) of the image of the patch's bottom plane.
///
/// * `half`: half width and half length of the flat patch, m.
/// * `orders`: polynomial degrees across width and length, 1 to [`MAX_FIT_ORDER`].
///
/// # Errors
/// [`CompensationError::FitOrders`], or that the map is not defined on the patch.
pub fn patch_size(map: &impl SmoothMap, half: DVec2, orders: [usize; 2]) -> Result<DVec2, CompensationError> {
    if orders.iter().any(|o| !(1..=MAX_FIT_ORDER).contains(o)) {
        return Err(CompensationError::FitOrders(orders[0], orders[1]));
    }
    let samples = uniform(SAMPLES);
    let images = map.positions(&plane_points(&samples, &samples, half, 0.0))?;
    Ok(fitted_size(&images, orders))
}

/// Where a live preview samples the patch: the points whose images [`fitted_size`] takes.
#[must_use]
pub fn sample_points(half: DVec2) -> Vec<DVec3> {
    let samples = uniform(SAMPLES);
    plane_points(&samples, &samples, half, 0.0)
}

/// Width and length (m) from the images of [`sample_points`], for checked orders.
#[must_use]
pub fn fitted_size(images: &[DVec3], orders: [usize; 2]) -> DVec2 {
    let gauss = gauss_legendre(GAUSS_POINTS);
    let nodes: Vec<f64> = gauss.iter().map(|g| g.0).collect();
    let [(value_u, slope_u), (value_v, slope_v)] = orders.map(|order| evaluation(order, &nodes));
    let coordinate = |axis: usize| DMatrix::from_fn(SAMPLES, SAMPLES, |i, j| images[i * SAMPLES + j][axis]);
    let mut along = [DMatrix::zeros(GAUSS_POINTS, GAUSS_POINTS), DMatrix::zeros(GAUSS_POINTS, GAUSS_POINTS)];
    for axis in 0..3 {
        let samples = coordinate(axis);
        for (sum, (left, right)) in along.iter_mut().zip([(&slope_u, &value_v), (&value_u, &slope_v)]) {
            let slope = left * &samples * right.transpose();
            *sum += slope.component_mul(&slope);
        }
    }
    let mean_length = |squares: &DMatrix<f64>| {
        let weighted = |a: usize, b: usize| gauss[a].1 * gauss[b].1 * squares[(a, b)].sqrt();
        (0..GAUSS_POINTS).flat_map(|a| (0..GAUSS_POINTS).map(move |b| (a, b))).map(|(a, b)| weighted(a, b)).sum::<f64>()
            / 2.0
    };
    DVec2::new(mean_length(&along[0]), mean_length(&along[1]))
}

/// Matrices that take the samples to the fitted polynomial's values and slopes at `nodes`: `[nodes, SAMPLES]`.
fn evaluation(order: usize, nodes: &[f64]) -> (DMatrix<f64>, DMatrix<f64>) {
    let samples = uniform(SAMPLES);
    let columns = |points: &[f64], pick: fn((f64, f64)) -> f64| {
        DMatrix::from_row_iterator(
            points.len(),
            order + 1,
            points.iter().flat_map(|&t| chebyshev(t).take(order + 1).map(pick)),
        )
    };
    let at_samples = columns(&samples, |t| t.0);
    // Full column rank, since there are more distinct samples than coefficients.
    let normal = (at_samples.transpose() * &at_samples).cholesky().expect("distinct samples");
    let fit = normal.solve(&at_samples.transpose());
    (columns(nodes, |t| t.0) * &fit, columns(nodes, |t| t.1) * &fit)
}

#[cfg(test)]
mod tests {
    use super::super::Cylinder;
    use super::*;
    use crate::cage::Axis;

    #[test]
    fn the_exact_cylinder_keeps_width_and_length() {
        let half = DVec2::new(5.415e-3, 4.0885e-3);
        for radius in [4.2e-3, 10e-3] {
            let cylinder = Cylinder { axis: Axis::X, radius, kept_plane: 0.0 };
            let size = patch_size(&cylinder, half, [9, 3]).expect("valid orders");
            assert!((size / (2.0 * half) - 1.0).abs().max_element() < 1e-6, "R {radius}: {size}");
        }
    }

    #[test]
    fn orders_out_of_range_are_refused() {
        let cylinder = Cylinder { axis: Axis::X, radius: 0.01, kept_plane: 0.0 };
        let half = DVec2::splat(1e-3);
        assert_eq!(patch_size(&cylinder, half, [0, 3]), Err(CompensationError::FitOrders(0, 3)), "order 0");
        assert_eq!(patch_size(&cylinder, half, [3, 16]), Err(CompensationError::FitOrders(3, 16)), "order 16");
    }
}
