//! Crossing triangles of one surface, found with exact signs over a bounding-volume hierarchy.
//!
//! Pairs that share an edge cannot cross properly unless they fold onto each other, which the sign of the map's
//! Jacobian tells; pairs that share one vertex are tested by the edges opposite to it. Coplanar overlap is not
//! reported: two such triangles share an edge or another pair crosses beside them.

use super::bvh::{Aabb, Bvh};
use super::predicates::orient3d;
use super::{DVec3, FaceId, VertexId};
use rayon::prelude::*;

/// Two triangles that cross each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crossing {
    /// The one with the smaller number.
    pub first: FaceId,
    /// The other.
    pub second: FaceId,
}

/// Finds all crossing pairs of a triangle soup with shared vertices, in ascending order.
///
/// * `vertices`: positions, any unit.
/// * `faces`: vertex triples; neighbors are recognised by their vertex numbers.
#[must_use]
pub fn crossings(vertices: &[DVec3], faces: &[[VertexId; 3]]) -> Vec<Crossing> {
    let corners = |f: usize| faces[f].map(|v| vertices[v.index()]);
    let boxes: Vec<Aabb> = (0..faces.len()).map(|f| Aabb::around(&corners(f))).collect();
    let bvh = Bvh::new(boxes.clone());
    let mut found: Vec<Crossing> = (0..faces.len())
        .into_par_iter()
        .flat_map_iter(|f| {
            let mut hits = Vec::new();
            bvh.for_each_meeting(&boxes[f], |g| {
                if g > f && pair_crosses(vertices, faces[f], faces[g]) {
                    hits.push(Crossing { first: FaceId::new(f), second: FaceId::new(g) });
                }
            });
            hits
        })
        .collect();
    found.sort_unstable();
    found
}

fn pair_crosses(vertices: &[DVec3], f: [VertexId; 3], g: [VertexId; 3]) -> bool {
    let shared = f.iter().filter(|v| g.contains(v)).count();
    if shared >= 2 {
        return false;
    }
    let at = |t: [VertexId; 3]| t.map(|v| vertices[v.index()]);
    // An edge that ends in a shared vertex touches the other triangle there and nowhere else, unless they overlap.
    let edge_hits = |edges: [VertexId; 3], triangle: [VertexId; 3]| {
        (0..3).any(|k| {
            let (from, to) = (edges[k], edges[(k + 1) % 3]);
            !triangle.contains(&from)
                && !triangle.contains(&to)
                && segment_meets_triangle(vertices[from.index()], vertices[to.index()], at(triangle))
        })
    };
    edge_hits(f, g) || edge_hits(g, f)
}

/// True if the closed segment meets the closed triangle in a point off its plane's degenerate cases.
#[must_use]
pub fn segment_meets_triangle(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let side_p = orient3d(a, b, c, p);
    let side_q = orient3d(a, b, c, q);
    if (side_p > 0.0) == (side_q > 0.0) && (side_p < 0.0) == (side_q < 0.0) {
        return false;
    }
    let around = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    !(around.iter().any(|&s| s > 0.0) && around.iter().any(|&s| s < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(list: &[[usize; 3]]) -> Vec<[VertexId; 3]> {
        list.iter().map(|f| f.map(VertexId::new)).collect()
    }

    #[test]
    fn a_piercing_triangle_is_found_and_a_neighbor_is_not() {
        let v = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::new(0.2, 0.2, -1.0),
            DVec3::new(0.2, 0.2, 1.0),
            DVec3::new(5.0, 5.0, 0.5),
            DVec3::new(1.0, 1.0, 0.3),
        ];
        let found = crossings(&v, &faces(&[[0, 1, 2], [3, 4, 5], [1, 6, 2]]));
        assert_eq!(found.first(), Some(&Crossing { first: FaceId::new(0), second: FaceId::new(1) }), "pierced");
        let neighbors = crossings(&v, &faces(&[[0, 1, 2], [1, 6, 2]]));
        assert!(neighbors.is_empty(), "an edge in common is no crossing");
    }

    #[test]
    fn triangles_sharing_a_vertex_can_cross() {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.5, 0.2, -1.0), DVec3::new(0.5, 0.2, 1.0)];
        assert_eq!(crossings(&v, &faces(&[[0, 1, 2], [0, 3, 4]])).len(), 1, "the far edge pierces");
    }
}
