//! Exact signs of the orientation and in-sphere determinants.
//!
//! One convention: [`orient3d`] is positive when `d` lies on the side of `abc` that its right-hand normal points to,
//! so a tetrahedron `abcd` with positive sign is positively oriented (the `robust` crate has the opposite sign).
//! Valid for coordinates of magnitude between about 1e-70 and 1e70, which metres and millimetres never leave.

use super::{DVec2, DVec3};

/// Relative rounding error of [`orient3d`]'s plain evaluation is below this times the sum of the terms' magnitudes: 7 + 56
/// units of the last place of a double \[SHE97\], rounded up.
const ORIENT_ERROR: f64 = 1e-15;

/// Six times the signed volume of `abcd` with an exact sign.
#[inline]
#[must_use]
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    let determinant = u.cross(v).dot(w);
    let (p, q) = (u.abs(), v.abs());
    let magnitudes = DVec3::new(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x).dot(w.abs());
    if determinant.abs() > ORIENT_ERROR * magnitudes {
        return determinant;
    }
    -robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// Positive if `e` lies inside the circumsphere of the positively oriented `abcd`, zero on it, with an exact sign.
#[must_use]
pub fn insphere([a, b, c, d]: [DVec3; 4], e: DVec3) -> f64 {
    -robust::insphere(coord(a), coord(b), coord(c), coord(d), coord(e))
}

fn coord(p: DVec3) -> robust::Coord3D<f64> {
    robust::Coord3D { x: p.x, y: p.y, z: p.z }
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
    fn a_sphere_tells_inside_from_on_it() {
        let corners = [DVec3::X, DVec3::Y, -DVec3::X, DVec3::Z];
        let corners = if orient3d(corners[0], corners[1], corners[2], corners[3]) > 0.0 {
            corners
        } else {
            [corners[1], corners[0], corners[2], corners[3]]
        };
        assert!(insphere(corners, DVec3::ZERO) > 0.0, "center");
        assert!(insphere(corners, -DVec3::Z).abs() <= 0.0, "on it: exactly zero");
        assert!(insphere(corners, DVec3::new(0.0, 0.0, -1.0 - f64::EPSILON)) < 0.0, "just outside");
        assert!(insphere(corners, DVec3::new(0.0, 0.0, -1.0 + f64::EPSILON)) > 0.0, "just inside");
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
