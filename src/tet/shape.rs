//! How good a tetrahedron is, for the optimiser.

use crate::geometry::DVec3;
use crate::geometry::predicates::orient3d;

/// The cube of the mean ratio `12 (3V)^(2/3) / sum of squared edge lengths` \[LJ94\]: 1 for the regular tetrahedron, 0 for a
/// flat one, negative inside out. The cube orders tetrahedra as the ratio does and needs no root.
pub(super) fn cubed_ratio([a, b, c, d]: [DVec3; 4]) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    let volume6 = u.cross(v).dot(w);
    let squares = u.length_squared()
        + v.length_squared()
        + w.length_squared()
        + b.distance_squared(c)
        + b.distance_squared(d)
        + c.distance_squared(d);
    // 12^3 (3V)^2 = 432 (6V)^2
    432.0 * volume6 * volume6.abs() / (squares * squares * squares)
}

/// Radius of the sphere inside, m: three volumes over the surface; negative inside out.
pub(super) fn inradius([a, b, c, d]: [DVec3; 4]) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    let faces = u.cross(v).length() + v.cross(w).length() + w.cross(u).length() + (v - u).cross(w - u).length();
    u.cross(v).dot(w) / faces
}

/// The cube of a mean ratio, as a threshold for [`cubed_ratio`].
pub(super) const fn cubed(ratio: f64) -> f64 {
    ratio * ratio * ratio
}

/// [`cubed_ratio`], and -1 where the exact orientation is not positive.
pub(super) fn exact_ratio(corners: [DVec3; 4]) -> f64 {
    let [a, b, c, d] = corners;
    if orient3d(a, b, c, d) > 0.0 { cubed_ratio(corners).max(f64::MIN_POSITIVE) } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_regular_tetrahedron_is_best() {
        let regular =
            [DVec3::ONE, DVec3::new(1.0, -1.0, -1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(-1.0, -1.0, 1.0)];
        let [a, b, c, d] = regular;
        let positive = if orient3d(a, b, c, d) > 0.0 { regular } else { [b, a, c, d] };
        assert!((cubed_ratio(positive) - 1.0).abs() < 1e-14, "regular");
        assert!((cubed_ratio(positive.map(|p| p * 1e-3)) - 1.0).abs() < 1e-14, "whatever its size");
        assert!(cubed_ratio([positive[1], positive[0], positive[2], positive[3]]) < -0.99, "turned");
        assert!(exact_ratio([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y]) < 0.0, "flat");
        // A sphere in a cube's regular tetrahedron touches at a third of the way to its corners.
        assert!((inradius(positive) - 1.0 / 3.0_f64.sqrt()).abs() < 1e-14, "inradius {}", inradius(positive));
    }
}
