//! Whether a point lies inside a closed surface, decided exactly.
//!
//! Parity of the crossings of a ray with exact orientation signs. A ray that passes through an edge or a vertex is
//! not counted but replaced by another of a fixed sequence of directions. A point on the surface counts as inside.

use super::predicates::orient3d;
use super::{DVec3, TriMesh};

/// Directions tried in turn: no two parallel, none along a coordinate axis or a likely cage edge.
const DIRECTIONS: [DVec3; 6] = [
    DVec3::new(0.572_815_664, 0.307_129_995, 0.759_937_415),
    DVec3::new(-0.431_294_481, 0.826_515_963, 0.361_705_112),
    DVec3::new(0.264_497_212, -0.641_410_546, 0.720_509_870),
    DVec3::new(0.917_965_594, 0.185_859_642, -0.350_511_906),
    DVec3::new(-0.690_147_180, -0.371_611_238, 0.621_447_193),
    DVec3::new(0.113_001_001, 0.762_223_653, -0.637_475_239),
];

/// True if `point` is inside the closed surface or on it.
///
/// Decided by the signs of exact determinants, for any closed surface that does not cross itself.
#[must_use]
pub fn contains(surface: &TriMesh, point: DVec3) -> bool {
    let (lo, hi) = surface.bounds();
    if point.cmplt(lo).any() || point.cmpgt(hi).any() || !point.is_finite() {
        return false;
    }
    let reach = 4.0 * (hi - lo).length();
    DIRECTIONS.iter().find_map(|&direction| parity(surface, point, point + direction * reach)).unwrap_or(false)
}

enum Crossing {
    None,
    Once,
    OnSurface,
    /// The ray runs through an edge or a vertex, or along the face.
    Degenerate,
}

/// Crossing parity along the segment from `point` to the far `end`; `None` if the direction is degenerate.
fn parity(surface: &TriMesh, point: DVec3, end: DVec3) -> Option<bool> {
    let mut inside = false;
    let mut degenerate = false;
    for face in 0..surface.faces.len() {
        match crossing(surface.corners(face), point, end) {
            Crossing::None => {}
            Crossing::Once => inside = !inside,
            Crossing::OnSurface => return Some(true),
            Crossing::Degenerate => degenerate = true,
        }
    }
    (!degenerate).then_some(inside)
}

fn crossing([a, b, c]: [DVec3; 3], p: DVec3, q: DVec3) -> Crossing {
    let side_p = orient3d(a, b, c, p);
    let side_q = orient3d(a, b, c, q);
    if side_p * side_q > 0.0 || (side_p > 0.0 && side_q > 0.0) || (side_p < 0.0 && side_q < 0.0) {
        return Crossing::None;
    }
    let around = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    let any_positive = around.iter().any(|&s| s > 0.0);
    let any_negative = around.iter().any(|&s| s < 0.0);
    if any_positive && any_negative {
        return Crossing::None;
    }
    let on_line = !any_positive && !any_negative;
    if is_zero(side_p) {
        // The point is in the plane of the face. The three signs, if not all zero, say that the line meets the
        // triangle, and it meets the plane in the point only.
        return if on_line || is_zero(side_q) { Crossing::Degenerate } else { Crossing::OnSurface };
    }
    if on_line || is_zero(side_q) || around.iter().any(|&s| is_zero(s)) {
        return Crossing::Degenerate;
    }
    Crossing::Once
}

/// Exact: the predicates return zero for degenerate input only.
fn is_zero(sign: f64) -> bool {
    sign.abs() <= 0.0
}

#[cfg(test)]
mod tests {
    use super::super::VertexId;
    use super::*;

    fn cube() -> TriMesh {
        let corner = |i: usize| DVec3::new((i & 1) as f64, ((i >> 1) & 1) as f64, ((i >> 2) & 1) as f64);
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|f| f.map(VertexId::new));
        TriMesh { vertices: (0..8).map(corner).collect(), faces: faces.collect() }
    }

    #[test]
    fn the_cube_is_a_cube() {
        assert_eq!(cube().check(), Ok(()), "closed and outward");
    }

    #[test]
    fn inside_outside_and_surface_are_told_apart() {
        let cube = cube();
        let mut rng = fastrand::Rng::with_seed(3);
        for _ in 0..500 {
            let p = DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 1.6 - DVec3::splat(0.3);
            let expected = p.cmpge(DVec3::ZERO).all() && p.cmple(DVec3::ONE).all();
            assert_eq!(contains(&cube, p), expected, "{p}");
        }
        for p in [DVec3::ZERO, DVec3::new(0.5, 0.0, 0.5), DVec3::new(0.5, 1.0, 1.0), DVec3::new(1.0, 0.25, 0.75)] {
            assert!(contains(&cube, p), "{p} is on the surface");
        }
        assert!(contains(&cube, DVec3::new(0.5, 0.5, f64::MIN_POSITIVE)), "just inside");
        assert!(!contains(&cube, DVec3::new(0.5, 0.5, -1e-300)), "just outside");
    }
}
