//! From a surface complex to a conforming Delaunay tetrahedral mesh.
//!
//! ```text
//! PatchParams, map --block--> Block (tets of the antenna) --skin + sphere--> Surface --fill--> TetMesh --quality--> report
//! ```
//!
//! The antenna itself is meshed flat, as layers of split prisms, and carried through the deformation like its surfaces:
//! [`mod@block`]. The air around it, or any other non-manifold complex of many regions, goes through [`fill()`]
//! (flat parts of an imported one are first triangulated anew, both sides of a plate alike: [`remesh()`]):
//!
//! 1. points inside, at the corners and centers of an octree that follows the sizing field;
//! 2. the Delaunay mesh of all points, by insertion along a space-filling curve with exact predicates;
//! 3. every edge and facet of the surface brought back by flips, within a budget; helper points and halved edges last;
//! 4. regions by what hangs together between the facets;
//! 5. flips, moves and new vertices that raise the smallest mean ratio.
//!
//! What is promised: positive tetrahedra (exact sign), conforming, each facet of the surface (or its halves) a face with
//! its mark, the same bits for the same input whatever the number of threads. [`TetMesh::check`] states it. What is
//! refused, with places: a surface that crosses itself, is not closed, or cannot be recovered. Not handled: curved
//! cells, and anisotropic ones other than thin metal layers.
//!
//! Sources: \[BOW81\], \[WAT81\] (insertion), \[ACR03\] (order), \[KLI80\] (best filling of an edge's ring), \[LJ94\] (mean
//! ratio), \[SI15\] (recovery by flips), \[SHE97\] (predicates).

pub mod block;
mod classify;
pub mod cutaway;
mod delaunay;
mod enclose;
mod error;
mod fill;
mod flip;
mod mesh;
mod optimise;
mod order;
mod quality;
mod recover;
mod remesh;
mod seeds;
mod shape;
mod sizing;
mod sphere;
mod store;
mod surface;

pub use block::{Block, BlockError, BlockFault, BlockSettings, Metal};
pub use cutaway::{CutFace, Cutaway};
pub use enclose::{AirSettings, EncloseError, Enclosed, enclose};
pub use error::TetError;
pub use fill::{Filled, fill};
pub use mesh::{FACES, FaceGroup, FaceRole, MarkedFace, MeshFault, Tet, TetMesh, face_key, volume};
pub use quality::{
    BIN_WIDTH, CellStatistics, EdgeFit, N_BINS, QualityReport, RegionQuality, SizeFn, TetQuality, WorstCell, quality,
    tet_qualities,
};
pub use recover::{EdgeSplit, RecoveryReport};
pub use remesh::{Sizes, remesh};
pub use sizing::{Sizing, SizingSettings};
pub use sphere::sphere;
pub use surface::{Surface, SurfaceFacet, SurfaceFault};
