//! The welded multi-region surface complex of an antenna (a piecewise linear complex).
//!
//! Every triangle stands once and carries the regions on both sides; a point used by several parts is one vertex. Two
//! parts that touch therefore share their interface bit for bit, whatever map moves the vertices: there is nothing
//! that could open a gap.

use super::tri_mesh::doubled_area_vector;
use super::{DVec3, FaceId, RegionId, SurfaceError, TriMesh, VertexId};
use std::collections::HashMap;

/// What a region is for the field: a body of dielectric, a conductor, or the air around everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RegionRole {
    /// The unbounded surroundings (region 0).
    Air,
    /// A dielectric body.
    Dielectric,
    /// A metal body.
    Conductor,
}

/// One region: its name (also the name of its file, group and material in exports) and what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Lower-case name: `substrate`, `patch`, `ground`, `pin`, `coax`.
    pub name: String,
    /// Dielectric, conductor or air.
    pub role: RegionRole,
    /// Relative permittivity; 1 for conductors and air.
    pub eps_r: f64,
    /// Loss tangent; 0 for conductors and air.
    pub tan_delta: f64,
}

/// One triangle between two regions; its normal points from `back` into `front`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Corners, counter-clockwise seen from `front`.
    pub vertices: [VertexId; 3],
    /// The region behind the triangle.
    pub back: RegionId,
    /// The region before it.
    pub front: RegionId,
}

/// Why a surface complex is not valid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlcError {
    /// A facet has the same region on both sides, or names one that does not exist.
    #[error("facet {facet} lies between regions {back} and {front}, which is not a boundary")]
    BadRegions {
        /// The facet.
        facet: FaceId,
        /// Region behind.
        back: RegionId,
        /// Region before.
        front: RegionId,
    },
    /// Two facets have the same three corners.
    #[error("facets {first} and {second} have the same corners")]
    DoubledFacet {
        /// One facet.
        first: FaceId,
        /// The other.
        second: FaceId,
    },
    /// The boundary of one region is not a closed oriented surface.
    #[error("the boundary of region \"{region}\" is not closed: {source}")]
    Open {
        /// Name of the region.
        region: String,
        /// What is wrong with its boundary.
        source: SurfaceError,
    },
}

/// A surface complex: vertices in metres, facets with a region on each side, regions by number (0 is air).
#[derive(Clone, Debug, PartialEq)]
pub struct Plc {
    /// Positions, each used by at least one facet.
    pub vertices: Vec<DVec3>,
    /// Triangles, each standing once.
    pub facets: Vec<Facet>,
    /// Regions by [`RegionId`]; the first is the air.
    pub regions: Vec<Region>,
}

impl Plc {
    /// Finds a region by its name.
    #[must_use]
    pub fn region(&self, name: &str) -> Option<RegionId> {
        self.regions.iter().position(|r| r.name == name).map(RegionId::new)
    }

    /// The bounded regions (all but the air), in order.
    pub fn solids(&self) -> impl Iterator<Item = (RegionId, &Region)> {
        self.regions.iter().enumerate().skip(1).map(|(i, r)| (RegionId::new(i), r))
    }

    /// The three corners of a facet.
    #[must_use]
    pub fn corners(&self, facet: usize) -> [DVec3; 3] {
        self.facets[facet].vertices.map(|v| self.vertices[v.index()])
    }

    /// The triangles around one region with outward orientation, by the vertex numbers of the whole complex.
    #[must_use]
    pub fn boundary_faces(&self, region: RegionId) -> Vec<[VertexId; 3]> {
        let outward = |f: &Facet| {
            let [a, b, c] = f.vertices;
            if f.back == region {
                Some([a, b, c])
            } else if f.front == region {
                Some([a, c, b])
            } else {
                None
            }
        };
        self.facets.iter().filter_map(outward).collect()
    }

    /// The closed surface of one region with vertices of its own; positions are copied bit for bit.
    #[must_use]
    pub fn boundary(&self, region: RegionId) -> TriMesh {
        let mut own = vec![None; self.vertices.len()];
        let mut mesh = TriMesh::default();
        for face in self.boundary_faces(region) {
            let local = face.map(|v| {
                *own[v.index()].get_or_insert_with(|| {
                    mesh.vertices.push(self.vertices[v.index()]);
                    VertexId::new(mesh.vertices.len() - 1)
                })
            });
            mesh.faces.push(local);
        }
        mesh
    }

    /// Number of facets between two bodies (neither side air): the interfaces that must be shared in every export.
    #[must_use]
    pub fn n_shared_facets(&self) -> usize {
        self.facets.iter().filter(|f| f.back != RegionId::AIR && f.front != RegionId::AIR).count()
    }

    /// The same complex with its vertices moved.
    ///
    /// # Panics
    /// If `vertices` has another length: the caller maps every vertex.
    #[must_use]
    pub fn with_vertices(&self, vertices: Vec<DVec3>) -> Self {
        assert_eq!(vertices.len(), self.vertices.len(), "one new position per vertex");
        Self { vertices, facets: self.facets.clone(), regions: self.regions.clone() }
    }

    /// Checks that each facet bounds two different regions, stands once, and that every region's boundary is a closed
    /// oriented surface of positive volume.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), PlcError> {
        let mut seen = HashMap::with_capacity(self.facets.len());
        for (f, facet) in self.facets.iter().enumerate() {
            let id = FaceId::new(f);
            let known = |r: RegionId| r.index() < self.regions.len();
            if facet.back == facet.front || !known(facet.back) || !known(facet.front) {
                return Err(PlcError::BadRegions { facet: id, back: facet.back, front: facet.front });
            }
            let mut key = facet.vertices;
            key.sort_unstable();
            if let Some(first) = seen.insert(key, id) {
                return Err(PlcError::DoubledFacet { first, second: id });
            }
        }
        for (region, named) in self.solids() {
            self.boundary(region).check().map_err(|source| PlcError::Open { region: named.name.clone(), source })?;
        }
        Ok(())
    }

    /// Area of all facets that bound a region.
    #[must_use]
    pub fn boundary_area(&self, region: RegionId) -> f64 {
        (0..self.facets.len())
            .filter(|&f| self.facets[f].back == region || self.facets[f].front == region)
            .map(|f| doubled_area_vector(self.corners(f)).length() / 2.0)
            .sum()
    }
}
