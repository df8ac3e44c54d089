//! The surface complex that is filled with tetrahedra: any number of regions, non-manifold where they meet.

use super::FaceGroup;
use crate::geometry::{DVec3, Region, RegionId, VertexId};

/// A triangle between two regions; its normal points from `back` into `front`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceFacet {
    /// Corners, counter-clockwise seen from `front`.
    pub vertices: [VertexId; 3],
    /// The region behind.
    pub back: RegionId,
    /// The region before; the same one for a sheet inside a region.
    pub front: RegionId,
    /// Index into [`Surface::groups`] where the facet carries a boundary condition.
    pub group: Option<usize>,
}

/// What is to be filled.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Positions, m.
    pub vertices: Vec<DVec3>,
    /// Facets, each once.
    pub facets: Vec<SurfaceFacet>,
    /// Regions by number; 0 is the outside. Neither it nor conductors are filled.
    pub regions: Vec<Region>,
    /// Groups of facets with a boundary condition.
    pub groups: Vec<FaceGroup>,
}
