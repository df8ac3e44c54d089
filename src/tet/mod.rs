//! From a surface complex to a conforming Delaunay tetrahedral mesh.
//!
//! ```text
//! PatchParams, map --block--> Block (tets of the antenna) --skin + sphere--> Surface --fill--> TetMesh
//! ```

pub mod block;
mod classify;
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
mod seeds;
mod shape;
mod sizing;
mod sphere;
mod store;
mod surface;

pub use block::{Block, BlockError, BlockFault, BlockSettings, Metal};
pub use enclose::{AirSettings, EncloseError, Enclosed, enclose};
pub use error::TetError;
pub use fill::{Filled, fill};
pub use mesh::{FACES, FaceGroup, FaceRole, MarkedFace, MeshFault, Tet, TetMesh, face_key, volume};
pub use quality::{
    BIN_WIDTH, CellStatistics, EdgeFit, N_BINS, QualityReport, RegionQuality, SizeFn, TetQuality, WorstCell, quality,
    tet_qualities,
};
pub use recover::{EdgeSplit, RecoveryReport};
pub use sizing::{Sizing, SizingSettings};
pub use surface::{Surface, SurfaceFacet, SurfaceFault};
