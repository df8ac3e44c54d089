//! Reading and writing geometry: one file per format, and the certificate.
//!
//! Enters: a welded [`Plc`](crate::geometry::Plc) in metres. Leaves: a folder that other programs take without repair.
//!
//! ```text
//! Plc --export--> <region>.stl + <region>.json per solid, antenna.obj, antenna.glb, certificate.json --verify--> findings
//!      <--import--'
//! ```
//!
//! A tetrahedral mesh leaves as one file for other solvers and viewers ([`msh`], [`nastran`], [`vtu`]), each region and
//! each group of faces under its name; a surface to be filled enters as [`surface_json`].
//!
//! STL is single precision: each vertex of the whole complex is rounded once (and shifted, where a reader would drop a
//! solid at coordinates <= 0), so solids that touched still agree bit for bit in their separate files. The
//! [`Certificate`] states what is proved of these bytes ([`proof`]): each solid closed and outward, each interface
//! shared facet by facet, no T-junction, no gap, no crossing; [`verify()`] proves it anew. Every file is written whole
//! or not at all ([`write_atomic`]).
//!
//! A flat outline for a patch enters as DXF or SVG ([`outline`]), closed bodies of any program as STL, OBJ or glTF
//! ([`bodies`]).
//!
//! A field run under way is kept as a [`checkpoint`].
//!
//! Files are millimetres except glTF (metres, as its standard demands). Readers refuse rather than guess, say the
//! place, and take memory in proportion to the file's length only.

mod atomic;
pub mod bodies;
mod certificate;
pub mod checkpoint;
pub mod csv;
mod decimal;
pub mod document;
mod error;
mod export;
pub mod ffs;
pub mod gltf;
mod import;
pub mod msh;
pub mod nastran;
pub mod obj;
pub mod outline;
mod parts;
pub mod proof;
mod rounding;
pub mod stl;
pub mod surface_json;
pub mod touchstone;
mod verify;
pub mod vtu;
mod weld;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod tests;

pub use atomic::{write_atomic, write_atomic_with};
pub use certificate::{CERTIFICATE_FILE, Certificate, FileRecord, Material, Role, Sidecar, SolidRecord};
pub use error::{IoError, ParseError, Place};
pub use export::{Export, ExportOptions, GLTF_FILE, OBJ_FILE, certify, export};
pub use import::import;
pub use proof::{Fault, Finding};
pub use verify::{Verification, verify};
