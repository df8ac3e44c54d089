//! The tetrahedral mesh and its invariants.

use crate::geometry::predicates::orient3d;
use crate::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use std::collections::HashMap;

/// One tetrahedron: `(b - a) x (c - a) . (d - a) > 0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tet {
    /// Corners; face i is opposite corner i.
    pub vertices: [VertexId; 4],
    /// What it is filled with.
    pub region: RegionId,
}

impl Tet {
    /// The corners opposite corner `i`, counter-clockwise seen from outside.
    #[must_use]
    pub fn face(&self, i: usize) -> [VertexId; 3] {
        FACES[i].map(|k| self.vertices[k])
    }
}

/// Corners of face i (opposite corner i) of a positive tetrahedron, counter-clockwise seen from outside.
pub const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// What a group of faces is for the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaceRole {
    /// A perfect conductor: the surface of a metal body, or a sheet without thickness.
    Conductor,
    /// A port plane. The wave enters the region behind the face (`back`); what lies before it is a conducting cap, so
    /// the port's edges exist twice for the field: live behind, shorted before.
    Port,
    /// The outer boundary, through which waves leave.
    Outer,
}

/// A named group of faces: `pec_patch`, `pec_ground`, `pec_feed`, `port1`, `outer`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FaceGroup {
    /// Its name, also in files.
    pub name: String,
    /// What it is for the field.
    pub role: FaceRole,
}

/// A face with a boundary condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MarkedFace {
    /// Corners, counter-clockwise seen from the region before it.
    pub vertices: [VertexId; 3],
    /// Index into [`TetMesh::groups`].
    pub group: usize,
}

/// A conforming tetrahedral mesh of several regions.
#[derive(Clone, Debug, PartialEq)]
pub struct TetMesh {
    /// Positions, m; each used by at least one tetrahedron.
    pub vertices: Vec<DVec3>,
    /// Tetrahedra; those of conductors are left out.
    pub tets: Vec<Tet>,
    /// Faces with a boundary condition.
    pub faces: Vec<MarkedFace>,
    /// Regions by number; 0 is the outside, of which there are no tetrahedra.
    pub regions: Vec<Region>,
    /// Groups that [`MarkedFace::group`] counts.
    pub groups: Vec<FaceGroup>,
}

/// An invariant that a mesh breaks.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// Not positively oriented.
    #[error("tetrahedron {tet} at ({x_mm:.4}, {y_mm:.4}, {z_mm:.4}) mm is turned inside out", x_mm = at.x * 1e3, y_mm = at.y * 1e3, z_mm = at.z * 1e3)]
    Inverted {
        /// Its number.
        tet: usize,
        /// Its center, m.
        at: DVec3,
    },
    /// A region that is not meshed, or none at all.
    #[error("tetrahedron {tet} is in region {region}, which has no cells")]
    BadRegion {
        /// Its number.
        tet: usize,
        /// The region.
        region: RegionId,
    },
    /// Three or more tetrahedra at a face, or two on the same side of it.
    #[error("more than two tetrahedra meet at a face of tetrahedron {tet}")]
    Crowded {
        /// One of them.
        tet: usize,
    },
    /// A face with one tetrahedron that no boundary explains: a hole.
    #[error("tetrahedron {tet} at ({x_mm:.4}, {y_mm:.4}, {z_mm:.4}) mm has an open face that is no boundary", x_mm = at.x * 1e3, y_mm = at.y * 1e3, z_mm = at.z * 1e3)]
    Open {
        /// Its number.
        tet: usize,
        /// Center of the face, m.
        at: DVec3,
    },
    /// A marked face that no tetrahedron has.
    #[error("marked face {face} is no face of a tetrahedron")]
    LooseFace {
        /// Its number.
        face: usize,
    },
    /// A face marked twice.
    #[error("face {face} is marked twice")]
    MarkedTwice {
        /// The second one's number.
        face: usize,
    },
    /// A vertex that no tetrahedron uses.
    #[error("vertex {vertex} is not used")]
    LooseVertex {
        /// Its number.
        vertex: usize,
    },
}

/// Corners in ascending order: the identity of a face.
#[must_use]
pub fn face_key(mut vertices: [VertexId; 3]) -> [VertexId; 3] {
    vertices.sort_unstable();
    vertices
}

impl TetMesh {
    /// Corner positions of a tetrahedron.
    #[must_use]
    pub fn corners(&self, tet: usize) -> [DVec3; 4] {
        self.tets[tet].vertices.map(|v| self.vertices[v.index()])
    }

    /// Volume of each region, m³, by region number.
    #[must_use]
    pub fn volumes(&self) -> Vec<f64> {
        let mut volumes = vec![0.0; self.regions.len()];
        for (t, tet) in self.tets.iter().enumerate() {
            volumes[tet.region.index()] += volume(self.corners(t));
        }
        volumes
    }

    /// Checks every invariant: positive tetrahedra of meshed regions, at most two at a face and then on its two sides,
    /// single ones only at marked boundaries, each marked face present once, no loose vertex.
    ///
    /// # Errors
    /// The first [`MeshFault`].
    pub fn check(&self) -> Result<(), MeshFault> {
        let mut used = vec![false; self.vertices.len()];
        let mut at_face: HashMap<[VertexId; 3], (usize, usize, bool)> = HashMap::new();
        for (t, tet) in self.tets.iter().enumerate() {
            let [a, b, c, d] = self.corners(t);
            if orient3d(a, b, c, d) <= 0.0 {
                return Err(MeshFault::Inverted { tet: t, at: (a + b + c + d) / 4.0 });
            }
            let role = self.regions.get(tet.region.index()).map(|r| r.role);
            if tet.region.index() == 0 || matches!(role, None | Some(RegionRole::Conductor)) {
                return Err(MeshFault::BadRegion { tet: t, region: tet.region });
            }
            tet.vertices.iter().for_each(|v| used[v.index()] = true);
            for i in 0..4 {
                let face = tet.face(i);
                let side = is_even(face);
                let seen = at_face.entry(face_key(face)).or_insert((0, t, side));
                if seen.0 == 2 || (seen.0 == 1 && seen.2 == side) {
                    return Err(MeshFault::Crowded { tet: t });
                }
                *seen = (seen.0 + 1, t, side);
            }
        }
        let mut marked = std::collections::HashSet::new();
        for (f, face) in self.faces.iter().enumerate() {
            let key = face_key(face.vertices);
            if !at_face.contains_key(&key) {
                return Err(MeshFault::LooseFace { face: f });
            }
            if !marked.insert(key) {
                return Err(MeshFault::MarkedTwice { face: f });
            }
        }
        let open = at_face.iter().filter(|(key, seen)| seen.0 == 1 && !marked.contains(*key));
        if let Some((key, (_, tet, _))) = open.min_by_key(|(_, seen)| seen.1) {
            let at = key.iter().map(|v| self.vertices[v.index()]).sum::<DVec3>() / 3.0;
            return Err(MeshFault::Open { tet: *tet, at });
        }
        used.iter().position(|u| !u).map_or(Ok(()), |vertex| Err(MeshFault::LooseVertex { vertex }))
    }
}

/// Volume of a tetrahedron, m³; negative when inside out.
#[must_use]
pub fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a) / 6.0
}

/// True if the corners are an even permutation of their ascending order: tells the two sides of a face apart.
fn is_even([a, b, c]: [VertexId; 3]) -> bool {
    (a < b) ^ (b < c) ^ (a < c)
}
