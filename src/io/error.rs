//! What can go wrong with a file, with its path and the place in it.

use super::proof::Fault;
use crate::geometry::{PlcError, SurfaceError};
use crate::tet::SurfaceFault;
use std::fmt;
use std::path::{Path, PathBuf};

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(usize),
    /// An offset into a binary file, bytes.
    Byte(usize),
    /// An element of a glTF document by the name of its list and its index.
    Element(&'static str, usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("the file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Element(list, index) => write!(f, "{list}[{index}]"),
        }
    }
}

/// Content that does not follow its format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct ParseError {
    /// Where.
    pub place: Place,
    /// What is wrong there and, where it helps, what to try.
    pub what: String,
}

impl ParseError {
    pub(super) fn new(place: Place, what: impl Into<String>) -> Self {
        Self { place, what: what.into() }
    }

    pub(super) fn json(error: &serde_json::Error) -> Self {
        Self::new(Place::Line(error.line()), format!("not the JSON that belongs here: {error}"))
    }

    pub(super) fn at(self, path: &Path) -> IoError {
        IoError::Malformed { path: path.to_owned(), source: self }
    }
}

/// Why a file could not be written, read or trusted.
#[derive(Debug, thiserror::Error)]
pub enum IoError {
    /// The operating system refused.
    #[error("cannot {action} {}: {source}; check that the folder exists, is writable and has room", path.display())]
    System {
        /// What was tried: "read", "write" or "create".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The content does not follow its format.
    #[error("{}, {source}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What and where.
        source: ParseError,
    },
    /// The file was written by a later version of the program.
    #[error("{} has format version {found}, newer than {known}, the last one known here: update the program", path.display())]
    TooNew {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// The newest version this program reads.
        known: u32,
    },
    /// Neither a folder with a certificate nor a file of a known kind.
    #[error("{} is neither a folder written by an export nor an .obj or .glb file: name one of these", path.display())]
    UnknownKind {
        /// What was named.
        path: PathBuf,
    },
    /// A solid's file is not the one that its sidecar describes.
    #[error("{} is not the file its sidecar describes (SHA-256 differs): export again, or ask `verify` what changed", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// The surface complex to be exported is not valid.
    #[error("nothing was exported, because the geometry is not valid: {0}")]
    Invalid(#[from] PlcError),
    /// A region cannot be a file name, or stands twice.
    #[error(
        "region name \"{region}\" cannot name a file: use each name once, of a-z, 0-9, - and _, other than \"certificate\""
    )]
    BadName {
        /// The name.
        region: String,
    },
    /// The name of a region or a group of faces cannot stand in a mesh file, or stands twice.
    #[error(
        "\"{name}\" cannot name a part of a mesh file: use each name once, of 1 to 127 characters without quotes and control characters"
    )]
    BadPartName {
        /// The name.
        name: String,
    },
    /// The surface in the file, or to be written, cannot be filled.
    #[error("{}: {source}", path.display())]
    BadSurface {
        /// The file.
        path: PathBuf,
        /// What is wrong; facets and vertices are counted as in the file, from 0.
        source: SurfaceFault,
    },
    /// A region's permittivity or loss tangent is not a finite number.
    #[error("region \"{region}\" has eps_r {eps_r} and tan_delta {tan_delta}: both must be finite numbers")]
    BadMaterial {
        /// Name of the region.
        region: String,
        /// Relative permittivity.
        eps_r: f64,
        /// Loss tangent.
        tan_delta: f64,
    },
    /// Two vertices become one, or a triangle loses its area, in single precision.
    #[error(
        "a triangle near ({:.6}, {:.6}, {:.6}) mm collapses in the single precision of {format}: use a larger splitting tolerance",
        place_mm[0], place_mm[1], place_mm[2]
    )]
    Merged {
        /// The format whose numbers are too coarse.
        format: &'static str,
        /// Where they are, mm.
        place_mm: [f64; 3],
    },
    /// What would be written does not pass the proof that the certificate states.
    #[error(
        "nothing was exported: solid \"{region}\" would not stand its certificate: {fault}; use a larger splitting tolerance"
    )]
    Unsound {
        /// Name of the region.
        region: String,
        /// What the proof found.
        fault: Fault,
    },
    /// The solids in the file do not fit together into one surface complex.
    #[error("{} holds no valid surface complex: {source}", path.display())]
    NotAComplex {
        /// The file or folder.
        path: PathBuf,
        /// What is wrong.
        source: PlcError,
    },
    /// Two solids in the file lie on the same side of a facet.
    #[error(
        "{}: solid \"{region}\" overlaps another at the facet near ({:.6}, {:.6}, {:.6}) mm: a facet has one solid on each side",
        path.display(), place_mm[0], place_mm[1], place_mm[2]
    )]
    Overlap {
        /// The file or folder.
        path: PathBuf,
        /// The later of the solids.
        region: String,
        /// First corner of the facet, mm.
        place_mm: [f64; 3],
    },
    /// The surface is not closed.
    #[error("{}: {source}", path.display())]
    NotClosed {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SurfaceError,
    },
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, IoError> {
    std::fs::read(path).map_err(|source| IoError::System { action: "read", path: path.to_owned(), source })
}
