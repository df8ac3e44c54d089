//! Points, triangle surfaces and multi-region surface complexes: the vocabulary of everything else.
//!
//! Lengths are metres, faces run counter-clockwise seen from the side their normal points to. [`TriMesh`] is one
//! closed surface (a cage, one exported solid); [`Plc`] is the welded surface complex of a whole antenna, where each
//! triangle stands once and knows the regions on both sides, so that two parts cannot drift apart. [`bvh`] and
//! [`intersect`] find crossing triangles with the exact signs of [`predicates`]; [`inside`] decides inside or outside
//! exactly.

pub mod bvh;
mod chebyshev;
pub mod id;
pub mod inside;
pub mod intersect;
pub mod plc;
pub mod predicates;
pub mod tri_mesh;

pub use chebyshev::chebyshev;
pub use glam::{DMat2, DMat3, DQuat, DVec2, DVec3};
pub use id::{FaceId, RegionId, TetId, VertexId};
pub use plc::{Facet, Plc, PlcError, Region, RegionRole};
pub use tri_mesh::{SurfaceError, TriMesh};
