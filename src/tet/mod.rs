//! From a surface complex to a conforming Delaunay tetrahedral mesh.
//!
//! ```text
//! PatchParams, map --block--> Block (tets of the antenna) --skin + sphere--> Surface --fill--> TetMesh
//! ```

mod mesh;
mod surface;

pub use mesh::{FACES, FaceGroup, FaceRole, MarkedFace, MeshFault, Tet, TetMesh, face_key, volume};
pub use surface::{Surface, SurfaceFacet};
