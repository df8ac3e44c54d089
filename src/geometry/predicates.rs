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

    /// The published trap of plain floating point: points a few units of the last place from the line through
    /// (12, 12) and (24, 24) \[KMP08\], against integer arithmetic.
    #[test]
    fn nearly_collinear_points_are_told_apart() {
        let step = 2.0_f64.powi(-53);
        let (q, r) = (DVec2::splat(12.0), DVec2::splat(24.0));
        let whole = |x: i128| (1_i128 << 52) + x;
        for (i, j) in (0..256_i128).flat_map(|i| (0..256).map(move |j| (i, j))) {
            let p = DVec2::new(0.5 + i as f64 * step, 0.5 + j as f64 * step);
            let scaled = |k: i128| k << 53;
            let (px, py) = (whole(i), whole(j));
            let exact = (scaled(12) - px) * (scaled(24) - py) - (scaled(12) - py) * (scaled(24) - px);
            let found = orient2d(p, q, r);
            assert_eq!(found > 0.0, exact > 0, "({i}, {j})");
            assert_eq!(found < 0.0, exact < 0, "({i}, {j})");
        }
    }

    /// The same in space: the third coordinate repeats the first, so the plane's sign is the line's.
    #[test]
    fn nearly_coplanar_points_are_told_apart_in_any_order() {
        let step = 2.0_f64.powi(-53);
        let lift = |p: DVec2| DVec3::new(p.x, p.y, p.x);
        let (q, r, top) = (lift(DVec2::splat(12.0)), lift(DVec2::splat(24.0)), DVec3::new(18.0, 18.0, 30.0));
        for (i, j) in (0..64).flat_map(|i| (0..64).map(move |j| (f64::from(i), f64::from(j)))) {
            let p = DVec2::new(0.5 + i * step, 0.5 + j * step);
            // All four but `top` are in the plane x = z, on one side of which it lies.
            let plane = orient2d(p, DVec2::splat(12.0), DVec2::splat(24.0));
            let found = orient3d(lift(p), q, r, top);
            assert_eq!((found > 0.0, found < 0.0), (plane > 0.0, plane < 0.0), "({i}, {j})");
            for (turned, sign) in [(orient3d(q, r, lift(p), top), 1.0), (orient3d(q, lift(p), r, top), -1.0)] {
                assert_eq!((turned * sign > 0.0, turned * sign < 0.0), (found > 0.0, found < 0.0), "({i}, {j})");
            }
        }
    }

    /// Points with whole coordinates on spheres about the origin, moved far away and to a small scale.
    #[test]
    fn cospherical_points_give_exactly_zero_and_their_neighbors_a_sign() {
        let on_sphere =
            [(1, 2, 2), (2, -1, 2), (-2, 2, 1), (2, 2, -1), (-1, -2, 2), (3, 0, 0), (0, -3, 0), (-2, -1, -2)];
        let shift = DVec3::new(1024.0, -512.0, 2048.0);
        let place = |(x, y, z): (i32, i32, i32)| (DVec3::new(x.into(), y.into(), z.into()) + shift) * 2.0_f64.powi(-20);
        let points = on_sphere.map(place);
        let center = shift * 2.0_f64.powi(-20);
        let mut corners = [points[0], points[1], points[2], points[3]];
        if orient3d(corners[0], corners[1], corners[2], corners[3]) < 0.0 {
            corners.swap(0, 1);
        }
        for &p in &points[4..] {
            assert!(insphere(corners, p).abs() <= 0.0, "{p} is on the sphere");
            let outwards = (p - center).abs().max_position();
            let away = (p - center)[outwards] > 0.0;
            for (neighbor, sign) in [(p[outwards].next_up(), 1.0), (p[outwards].next_down(), -1.0)] {
                let mut moved = p;
                moved[outwards] = neighbor;
                let inside = insphere(corners, moved) * if away { -sign } else { sign };
                assert!(inside > 0.0, "{p} moved by the last place");
            }
        }
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
