//! The cage at rest, with everything about it that does not depend on the point.

use super::elementary::atan2;
use super::{DeformError, Pose};
use crate::geometry::{DVec3, FaceId, SurfaceError, TriMesh, inside, tri_mesh};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Height over a face, relative to the cage's size, below which rounding might put a point on the other side. Heights
/// are good to about 1e-16 of the size, so a greater value only costs exact tests; one near 1e-16 would miss some.
pub(super) const AMBIGUOUS_HEIGHT: f64 = 1e-9;
/// Solid angle below which a face, even a wrong one, cannot turn an outside into an inside.
pub(super) const AMBIGUOUS_ANGLE: f64 = 1e-6;

/// One face of the cage at rest. Corner i is opposite edge i + 1; edge k runs from corner k to corner k + 1.
#[derive(Clone, Debug)]
pub(super) struct Face {
    pub(super) corners: [usize; 3],
    /// Unique edges.
    pub(super) edges: [usize; 3],
    /// Outward unit normal.
    pub(super) normal: DVec3,
    /// Twice the area, m².
    pub(super) double_area: f64,
    /// In-plane outward unit normals of the edges.
    pub(super) edge_normals: [DVec3; 3],
    /// Gradients of the hat functions, 1/m.
    pub(super) gradients: [DVec3; 3],
    /// `gradients[i] · edge_normals[k]`, 1/m.
    pub(super) slopes: [[f64; 3]; 3],
}

/// One edge of the cage at rest, run forward by the first of its faces and backward by the second.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) ends: [usize; 2],
    /// Length, m.
    pub(super) length: f64,
    /// Unit vector from the first end to the second.
    pub(super) tangent: DVec3,
    /// The two faces, each with the number of this edge in it.
    pub(super) faces: [(usize, usize); 2],
}

/// A closed triangle cage at rest, ready for the evaluation of Green coordinates.
#[derive(Clone, Debug)]
pub struct GreenCage {
    rest: TriMesh,
    pub(super) faces: Vec<Face>,
    pub(super) edges: Vec<Edge>,
    size: f64,
}

impl GreenCage {
    /// Checks a cage and prepares it.
    ///
    /// * `rest`: any closed, outward-oriented triangle surface that does not cross itself (which is not checked).
    ///
    /// # Errors
    /// [`DeformError::Surface`] if the surface is open, flipped, inside out or has a face without area.
    pub fn new(rest: TriMesh) -> Result<Self, DeformError> {
        rest.check()?;
        let (edges, face_edges) = unique_edges(&rest);
        let faces = face_edges
            .into_iter()
            .enumerate()
            .map(|(f, edges)| Face::new(&rest, f, edges).ok_or(SurfaceError::Degenerate { face: FaceId::new(f) }))
            .collect::<Result<_, _>>()?;
        let distances = rest.vertices.iter().flat_map(|a| rest.vertices.iter().map(|b| a.distance_squared(*b)));
        let size = distances.fold(0.0, f64::max).sqrt();
        Ok(Self { rest, faces, edges, size })
    }

    /// The surface at rest.
    #[must_use]
    pub fn rest(&self) -> &TriMesh {
        &self.rest
    }

    /// Number of vertices, which is the number of `phi` of a point.
    #[must_use]
    pub fn n_vertices(&self) -> usize {
        self.rest.vertices.len()
    }

    /// Number of faces, which is the number of `psi` of a point.
    #[must_use]
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// Greatest distance between two vertices, m.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The pose that leaves every point where it is.
    #[must_use]
    pub fn rest_pose(&self) -> Pose {
        Pose::at_rest(self)
    }

    /// True if `point` (m) is inside the cage or on it; exact.
    ///
    /// The solid angle decides where it can; near the surface the crossings of a ray do, with exact predicates.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let (lo, hi) = self.rest.bounds();
        if !(point.cmpge(lo).all() && point.cmple(hi).all()) {
            return false;
        }
        let mut total = 0.0;
        let mut ambiguous = false;
        for (f, face) in self.faces.iter().enumerate() {
            let [a, b, c] = self.rest.corners(f).map(|v| v - point);
            let (ra, rb, rc) = (a.length(), b.length(), c.length());
            let height = face.normal.dot(a);
            let denominator = ra * rb * rc + a.dot(b) * rc + b.dot(c) * ra + c.dot(a) * rb;
            let angle = 2.0 * atan2(height * face.double_area, denominator);
            ambiguous |= height.abs() <= AMBIGUOUS_HEIGHT * self.size && angle.abs() > AMBIGUOUS_ANGLE;
            total += angle;
        }
        match side(total / (4.0 * PI), ambiguous) {
            Some(inside) => inside,
            None => inside::contains(&self.rest, point),
        }
    }
}

/// Inside or outside by the winding number, where it is certain.
pub(super) fn side(winding: f64, ambiguous: bool) -> Option<bool> {
    /// Of the winding number; rounding makes far less, and the next integers are far more.
    const SLACK: f64 = 1e-3;
    match winding {
        _ if ambiguous => None,
        w if (w - 1.0).abs() < SLACK => Some(true),
        w if w.abs() < SLACK => Some(false),
        _ => None,
    }
}

impl Face {
    /// `None` if the face is so thin that it has no normal.
    fn new(rest: &TriMesh, face: usize, edges: [usize; 3]) -> Option<Self> {
        let corners = rest.corners(face);
        let cross = tri_mesh::doubled_area_vector(corners);
        let (normal, double_area) = (cross.try_normalize()?, cross.length());
        let run = |k: usize| corners[(k + 1) % 3] - corners[k % 3];
        let edge_normals = [0, 1, 2].map(|k| run(k).cross(normal) / run(k).length());
        let gradients = [0, 1, 2].map(|i| normal.cross(run(i + 1)) / double_area);
        let slopes = gradients.map(|g| edge_normals.map(|m| g.dot(m)));
        let corners = rest.faces[face].map(|v| v.index());
        Some(Self { corners, edges, normal, double_area, edge_normals, gradients, slopes })
    }
}

/// The edges in the order in which the faces first name them, and each face's three.
fn unique_edges(rest: &TriMesh) -> (Vec<Edge>, Vec<[usize; 3]>) {
    let mut numbers: HashMap<[usize; 2], usize> = HashMap::new();
    let mut edges: Vec<Edge> = Vec::new();
    let mut of_faces = Vec::with_capacity(rest.faces.len());
    for (f, face) in rest.faces.iter().enumerate() {
        of_faces.push([0, 1, 2].map(|k| {
            let ends = [face[k].index(), face[(k + 1) % 3].index()];
            // A closed oriented surface runs each edge once in each direction.
            if let Some(&e) = numbers.get(&[ends[1], ends[0]]) {
                edges[e].faces[1] = (f, k);
                return e;
            }
            let run = rest.vertices[ends[1]] - rest.vertices[ends[0]];
            let length = run.length();
            numbers.insert(ends, edges.len());
            edges.push(Edge { ends, length, tangent: run / length, faces: [(f, k); 2] });
            edges.len() - 1
        }));
    }
    (edges, of_faces)
}

#[cfg(test)]
mod tests {
    use super::super::samples::{bumpy_sphere, cuboid, random_point};
    use super::*;

    #[test]
    fn every_edge_is_shared_by_two_faces() {
        let cage = GreenCage::new(cuboid(3, 2)).unwrap();
        assert_eq!(2 * cage.edges.len(), 3 * cage.n_faces(), "half as many edges as face sides");
        assert_eq!(cage.n_vertices() + cage.n_faces(), cage.edges.len() + 2, "Euler");
        for (e, edge) in cage.edges.iter().enumerate() {
            for (side, &(f, k)) in edge.faces.iter().enumerate() {
                let face = &cage.faces[f];
                assert_eq!(face.edges[k], e, "the face names the edge");
                assert_eq!(face.corners[k], edge.ends[side], "first forward, second backward");
            }
        }
    }

    #[test]
    fn an_open_cage_is_refused() {
        let mut open = cuboid(2, 2);
        open.faces.pop();
        assert!(matches!(GreenCage::new(open), Err(DeformError::Surface(SurfaceError::OpenEdge { .. }))), "open");
    }

    #[test]
    fn the_quick_inside_test_is_the_exact_one() {
        let mut rng = fastrand::Rng::with_seed(5);
        let cage = GreenCage::new(bumpy_sphere(2, 4)).unwrap();
        for _ in 0..500 {
            let p = random_point(&mut rng) * 1.3;
            assert_eq!(cage.contains(p), inside::contains(cage.rest(), p), "{p}");
        }
        let flat = GreenCage::new(cuboid(4, 3)).unwrap();
        let (lo, hi) = flat.rest().bounds();
        for offset in [-1e-12, -1e-17, 0.0, 1e-17, 1e-12] {
            let p = DVec3::new(0.3 * lo.x, 0.2 * hi.y, hi.z + offset);
            assert_eq!(flat.contains(p), p.z <= hi.z, "{offset:e} above the top");
        }
        assert!(flat.rest().vertices.iter().all(|&v| flat.contains(v)), "vertices are inside");
        assert!(!flat.contains(DVec3::splat(f64::NAN)), "NaN is nowhere");
    }
}
