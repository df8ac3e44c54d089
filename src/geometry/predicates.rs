//! Exact signs of the orientation determinants.
//!
//! One convention: [`orient3d`] is positive when `d` lies on the side of `abc` that its right-hand normal points to,
//! so a tetrahedron `abcd` with positive sign is positively oriented (the `robust` crate has the opposite sign).
//! Valid for coordinates of magnitude between about 1e-70 and 1e70, which metres and millimetres never leave.

use super::{DVec2, DVec3};

/// Six times the signed volume of `abcd` with an exact sign.
#[must_use]
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let coord = |p: DVec3| robust::Coord3D { x: p.x, y: p.y, z: p.z };
    -robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// Twice the signed area of `abc` with an exact sign; positive when counter-clockwise.
#[must_use]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_tetrahedron_is_positive() {
        assert!(orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z) > 0.0, "d above abc");
        assert!(orient3d(DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::Z) < 0.0, "swapped");
        assert!(orient2d(DVec2::ZERO, DVec2::X, DVec2::Y) > 0.0, "counter-clockwise");
    }

    #[test]
    fn the_smallest_lift_is_seen() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.1 * x + 0.3 * y);
        let flat = DVec3::new(0.5, 0.5, 0.0);
        let lifted = DVec3::new(flat.x, flat.y, f64::from_bits(1));
        let base = (DVec3::ZERO, DVec3::X, DVec3::Y);
        assert!(orient3d(base.0, base.1, base.2, flat).abs() <= 0.0, "coplanar is exactly zero");
        assert!(orient3d(base.0, base.1, base.2, lifted) >= 0.0, "never negative");
        assert!(orient3d(p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0), DVec3::new(0.3, 0.3, 0.2)) > 0.0, "above the slope");
    }
}
