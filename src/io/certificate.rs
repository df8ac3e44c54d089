//! The certificate and the sidecars: what is claimed of the files beside them, as versioned JSON.

use super::error::{IoError, ParseError, Place, read};
use super::proof::{Interface, Proof, SolidShape};
use crate::geometry::{Region, RegionRole};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::Path;

/// Name of the certificate in an export folder.
pub const CERTIFICATE_FILE: &str = "certificate.json";
/// Marks the certificate among other JSON files.
const CERTIFICATE_FORMAT: &str = "conformant-certificate";
/// Raised with every change that an older reader would misread.
const CERTIFICATE_VERSION: u32 = 1;
const SIDECAR_FORMAT: &str = "conformant-solid";
const SIDECAR_VERSION: u32 = 1;

/// What a solid is made of; its name is the region's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name of region, file, group and material.
    pub material: String,
    /// "dielectric", "conductor" or "air".
    pub role: Role,
    /// Relative permittivity.
    pub eps_r: f64,
    /// Loss tangent.
    pub tan_delta: f64,
}

/// [`RegionRole`] as files spell it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// A hollow.
    Air,
    /// A dielectric body.
    Dielectric,
    /// A metal body.
    Conductor,
}

impl From<RegionRole> for Role {
    fn from(role: RegionRole) -> Self {
        match role {
            RegionRole::Air => Self::Air,
            RegionRole::Dielectric => Self::Dielectric,
            RegionRole::Conductor => Self::Conductor,
        }
    }
}

impl From<Role> for RegionRole {
    fn from(role: Role) -> Self {
        match role {
            Role::Air => Self::Air,
            Role::Dielectric => Self::Dielectric,
            Role::Conductor => Self::Conductor,
        }
    }
}

impl Material {
    pub(super) fn of(region: &Region) -> Self {
        let role = region.role.into();
        Self { material: region.name.clone(), role, eps_r: region.eps_r, tan_delta: region.tan_delta }
    }

    pub(super) fn into_region(self) -> Region {
        let role = self.role.into();
        Region { name: self.material, role, eps_r: self.eps_r, tan_delta: self.tan_delta }
    }
}

/// What stands beside each STL file, which itself has neither unit nor material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sidecar {
    format: String,
    version: u32,
    /// Name of the STL file.
    pub file: String,
    /// Unit of its coordinates; "mm".
    pub unit: String,
    /// What the solid is made of.
    #[serde(flatten)]
    pub material: Material,
    /// SHA-256 of the STL file, lower-case hexadecimal.
    pub sha256: String,
    /// Added to every coordinate of the export, whole mm.
    pub shift_mm: [f64; 3],
}

impl Sidecar {
    pub(super) fn new(material: Material, stl: &[u8], shift_mm: [f64; 3]) -> Self {
        Self {
            format: SIDECAR_FORMAT.to_owned(),
            version: SIDECAR_VERSION,
            file: stl_name(&material.material),
            unit: "mm".to_owned(),
            material,
            sha256: sha256(stl),
            shift_mm,
        }
    }

    pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Self, IoError> {
        let sidecar: Self = parse_versioned(bytes, path, SIDECAR_FORMAT, SIDECAR_VERSION)?;
        if sidecar.unit == "mm" && sidecar.shift_mm.iter().all(|s| s.is_finite()) {
            return Ok(sidecar);
        }
        Err(ParseError::new(Place::File, format!("unit \"{}\" is not \"mm\"", sidecar.unit)).at(path))
    }
}

/// One file of an export.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRecord {
    /// Name in the export's folder.
    pub name: String,
    /// SHA-256, lower-case hexadecimal.
    pub sha256: String,
    /// Length.
    pub bytes: u64,
}

/// One solid: what it is made of and what was proved of its STL file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidRecord {
    /// What it is made of.
    #[serde(flatten)]
    pub material: Material,
    /// What was proved.
    #[serde(flatten)]
    pub shape: SolidShape,
}

/// What an export claims of its files, each claim proved from the bytes that were written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    format: String,
    version: u32,
    /// Unit of lengths in the STL files and here; "mm".
    pub unit: String,
    /// Added to every coordinate of the STL files, whole mm; OBJ and glTF are not shifted.
    pub shift_mm: [f64; 3],
    /// Every file of the export but this one.
    pub files: Vec<FileRecord>,
    /// Every solid, in order of the regions.
    pub solids: Vec<SolidRecord>,
    /// Every pair of solids that touch in at least one facet.
    pub interfaces: Vec<Interface>,
    /// Vertices of one solid on the surface of another without being a vertex of it; always 0.
    pub t_junctions: usize,
    /// Pairs of triangles that cross; always 0.
    pub crossing_triangles: usize,
    /// No vertex of one solid comes closer than this to another solid without being a vertex of it, mm.
    ///
    /// Looked for up to [`CLEARANCE_MM`](super::proof::CLEARANCE_MM), so at most that.
    pub clearance_mm: f64,
    /// Whatever the caller wants beside the proof (rho, strain, hash of the project).
    pub summary: serde_json::Map<String, serde_json::Value>,
}

impl Certificate {
    pub(super) fn new(materials: Vec<Material>, proof: Proof, shift_mm: [f64; 3], files: &[(String, Vec<u8>)]) -> Self {
        let record = |(name, bytes): &(String, Vec<u8>)| FileRecord {
            name: name.clone(),
            sha256: sha256(bytes),
            bytes: bytes.len() as u64,
        };
        let solids = materials.into_iter().zip(proof.solids);
        Self {
            format: CERTIFICATE_FORMAT.to_owned(),
            version: CERTIFICATE_VERSION,
            unit: "mm".to_owned(),
            shift_mm,
            files: files.iter().map(record).collect(),
            solids: solids.map(|(material, shape)| SolidRecord { material, shape }).collect(),
            interfaces: proof.interfaces,
            t_junctions: 0,
            crossing_triangles: 0,
            clearance_mm: proof.clearance_mm,
            summary: serde_json::Map::new(),
        }
    }

    /// Reads the certificate of an export folder; nothing is verified.
    ///
    /// # Errors
    /// [`IoError`] if there is none, or it is broken or too new.
    pub fn read(dir: &Path) -> Result<Self, IoError> {
        let path = dir.join(CERTIFICATE_FILE);
        let certificate: Self = parse_versioned(&read(&path)?, &path, CERTIFICATE_FORMAT, CERTIFICATE_VERSION)?;
        let names = certificate.files.iter().map(|f| f.name.as_str());
        if let Some(name) =
            names.chain(certificate.solids.iter().map(|s| s.material.material.as_str())).find(|n| !is_plain(n))
        {
            let what = format!("\"{}\" is not a plain file name", super::stl::shorten(name));
            return Err(ParseError::new(Place::File, what).at(&path));
        }
        Ok(certificate)
    }

    /// Number of facets shared bit for bit, over all interfaces.
    #[must_use]
    pub fn n_shared_facets(&self) -> usize {
        self.interfaces.iter().map(|i| i.shared_facets).sum()
    }
}

/// Encodes a sidecar or certificate as readable JSON.
pub(super) fn to_json(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = serde_json::to_vec_pretty(value).expect("string keys and finite numbers");
    bytes.push(b'\n');
    bytes
}

fn parse_versioned<T: for<'de> Deserialize<'de>>(
    bytes: &[u8],
    path: &Path,
    format: &str,
    known: u32,
) -> Result<T, IoError> {
    #[derive(Deserialize)]
    struct Head {
        format: String,
        version: u32,
    }
    let head: Head = serde_json::from_slice(bytes).map_err(|e| ParseError::json(&e).at(path))?;
    if head.format != format {
        let what = format!("\"format\" is not \"{format}\": this file is something else");
        return Err(ParseError::new(Place::File, what).at(path));
    }
    if head.version > known {
        return Err(IoError::TooNew { path: path.to_owned(), found: head.version, known });
    }
    serde_json::from_slice(bytes).map_err(|e| ParseError::json(&e).at(path))
}

/// SHA-256 as lower-case hexadecimal.
pub(super) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut text, byte| {
        write!(text, "{byte:02x}").expect("writing to a string");
        text
    })
}

/// True for a name that stays in its folder on every system.
pub(super) fn is_plain(name: &str) -> bool {
    !name.is_empty()
        && !name.starts_with('.')
        && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || matches!(b, b'-' | b'_' | b'.'))
}

/// Name of a region's STL file.
pub(super) fn stl_name(region: &str) -> String {
    format!("{region}.stl")
}

/// Name of a region's sidecar.
pub(super) fn sidecar_name(region: &str) -> String {
    format!("{region}.json")
}
