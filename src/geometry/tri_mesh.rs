//! One triangle surface by vertices and indices, and the proof that it is a closed, oriented manifold.

use super::{DVec3, FaceId, VertexId};
use std::collections::HashMap;

/// Why a surface is not a closed, outward-oriented 2-manifold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// The surface has no triangle.
    #[error("the surface has no triangles")]
    Empty,
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are only {n_vertices} vertices")]
    BadIndex {
        /// The face.
        face: FaceId,
        /// The vertex it names.
        vertex: VertexId,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// A triangle has no area.
    #[error("face {face} has no area")]
    Degenerate {
        /// The triangle.
        face: FaceId,
    },
    /// An edge has a triangle on one side only.
    #[error("the surface is open at the edge between vertices {from} and {to} (face {face})")]
    OpenEdge {
        /// First vertex of the edge.
        from: VertexId,
        /// Second vertex of the edge.
        to: VertexId,
        /// The triangle on its only side.
        face: FaceId,
    },
    /// An edge is run twice in the same direction: more than two triangles meet, or one is flipped.
    #[error(
        "faces {first} and {second} run the edge from vertex {from} to {to} in the same direction: one is flipped or too many meet there"
    )]
    DoubledEdge {
        /// First vertex of the edge.
        from: VertexId,
        /// Second vertex of the edge.
        to: VertexId,
        /// One triangle.
        first: FaceId,
        /// The other.
        second: FaceId,
    },
    /// The normals point inwards.
    #[error("the surface is inside out: its signed volume is {volume:e}")]
    InsideOut {
        /// Signed volume, cubed length unit of the input.
        volume: f64,
    },
}

/// A triangle surface: vertices in metres, faces counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Positions.
    pub vertices: Vec<DVec3>,
    /// Vertex triples.
    pub faces: Vec<[VertexId; 3]>,
}

impl TriMesh {
    /// The three corners of a face.
    #[must_use]
    pub fn corners(&self, face: usize) -> [DVec3; 3] {
        self.faces[face].map(|v| self.vertices[v.index()])
    }

    /// Total area.
    #[must_use]
    pub fn area(&self) -> f64 {
        (0..self.faces.len()).map(|f| doubled_area_vector(self.corners(f)).length() / 2.0).sum()
    }

    /// Enclosed volume by the divergence theorem, taken about the first vertex; positive when normals point outwards.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let origin = self.vertices.first().copied().unwrap_or_default();
        let six_fold: f64 = (0..self.faces.len())
            .map(|f| {
                let [a, b, c] = self.corners(f).map(|p| p - origin);
                a.dot(b.cross(c))
            })
            .sum();
        six_fold / 6.0
    }

    /// Greatest extent between two vertices, as the diagonal of the bounding box bounds it from above.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let start = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
        self.vertices.iter().fold(start, |(lo, hi), &p| (lo.min(p), hi.max(p)))
    }

    /// Checks that the surface is closed, consistently oriented and not inside out.
    ///
    /// Several disjoint closed pieces, and pieces that touch in a vertex, are accepted.
    ///
    /// # Errors
    /// The first [`SurfaceError`] found, in face order.
    pub fn check(&self) -> Result<(), SurfaceError> {
        self.check_finite()?;
        let mut directed = HashMap::with_capacity(3 * self.faces.len());
        for (f, face) in self.faces.iter().enumerate() {
            let id = FaceId::new(f);
            if doubled_area_vector(self.corners(f)).length_squared() <= 0.0 {
                return Err(SurfaceError::Degenerate { face: id });
            }
            for k in 0..3 {
                let (from, to) = (face[k], face[(k + 1) % 3]);
                if let Some(first) = directed.insert((from, to), id) {
                    return Err(SurfaceError::DoubledEdge { from, to, first, second: id });
                }
            }
        }
        for (f, face) in self.faces.iter().enumerate() {
            for k in 0..3 {
                let (from, to) = (face[k], face[(k + 1) % 3]);
                if !directed.contains_key(&(to, from)) {
                    return Err(SurfaceError::OpenEdge { from, to, face: FaceId::new(f) });
                }
            }
        }
        let volume = self.volume();
        if volume > 0.0 { Ok(()) } else { Err(SurfaceError::InsideOut { volume }) }
    }

    fn check_finite(&self) -> Result<(), SurfaceError> {
        if self.faces.is_empty() {
            return Err(SurfaceError::Empty);
        }
        if let Some(v) = self.vertices.iter().position(|p| !p.is_finite()) {
            return Err(SurfaceError::NotFinite { vertex: VertexId::new(v) });
        }
        let n_vertices = self.vertices.len();
        for (f, face) in self.faces.iter().enumerate() {
            if let Some(&vertex) = face.iter().find(|v| v.index() >= n_vertices) {
                return Err(SurfaceError::BadIndex { face: FaceId::new(f), vertex, n_vertices });
            }
        }
        Ok(())
    }
}

/// The cross product of two edges: twice the area along the right-hand normal.
#[must_use]
pub fn doubled_area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> TriMesh {
        let id = VertexId::new;
        TriMesh {
            vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            faces: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f| f.map(id)).to_vec(),
        }
    }

    #[test]
    fn a_tetrahedron_is_closed_and_has_its_volume() {
        let mesh = tetrahedron();
        assert_eq!(mesh.check(), Ok(()), "closed and outward");
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15, "volume {}", mesh.volume());
    }

    #[test]
    fn faults_are_named() {
        let mut open = tetrahedron();
        open.faces.pop();
        assert!(matches!(open.check(), Err(SurfaceError::OpenEdge { .. })), "a missing face leaves an open edge");
        let mut flipped = tetrahedron();
        flipped.faces[2].swap(0, 1);
        assert!(matches!(flipped.check(), Err(SurfaceError::DoubledEdge { .. })), "a flipped face doubles edges");
        let mut inverted = tetrahedron();
        inverted.faces.iter_mut().for_each(|f| f.swap(0, 1));
        assert!(matches!(inverted.check(), Err(SurfaceError::InsideOut { .. })), "all flipped is inside out");
        let mut bad = tetrahedron();
        bad.faces[0][0] = VertexId::new(9);
        assert!(matches!(bad.check(), Err(SurfaceError::BadIndex { .. })), "index out of range");
        let mut nan = tetrahedron();
        nan.vertices[0].x = f64::NAN;
        assert!(matches!(nan.check(), Err(SurfaceError::NotFinite { .. })), "NaN is caught");
    }
}
