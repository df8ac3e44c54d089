//! From a surface complex to a folder of files with their certificate.
//!
//! Everything is made and proved in memory first; the proof reads the bytes that are about to be written. Files are
//! then written one by one, each whole or not at all, the certificate last: a folder whose export was interrupted
//! has an old certificate or none, and `verify` says so.

use super::certificate::{CERTIFICATE_FILE, Certificate, Material, Sidecar, is_plain, sidecar_name, stl_name, to_json};
use super::error::IoError;
use super::proof::{Finding, Solid, prove};
use super::{gltf, obj, rounding, stl, write_atomic};
use crate::geometry::Plc;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Name of the OBJ file in an export folder.
pub const OBJ_FILE: &str = "antenna.obj";
/// Name of the glTF file in an export folder.
pub const GLTF_FILE: &str = "antenna.glb";

/// A vertex closer than this part of the largest coordinate to a solid it does not belong to is a T-junction: eight
/// steps of single precision, so that no rounding hides one; a foil that thin could not be told from a gap.
const JUNCTION: f64 = 1.0 / (1 << 20) as f64;

/// What an export holds besides the STL files, on which the certificate rests.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportOptions {
    /// Write `antenna.obj`.
    pub obj: bool,
    /// Write `antenna.glb`.
    pub gltf: bool,
    /// Goes into the certificate as it stands.
    pub summary: serde_json::Map<String, serde_json::Value>,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self { obj: true, gltf: true, summary: serde_json::Map::new() }
    }
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// All files, the certificate last.
    pub files: Vec<PathBuf>,
    /// What is claimed of them.
    pub certificate: Certificate,
}

/// Writes a complex (m) as one STL file with sidecar per solid (mm), OBJ (mm), glTF (m) and the certificate.
///
/// Makes the folder where it is missing; files of the same names are replaced, others are left alone.
///
/// # Errors
/// [`IoError::Invalid`], [`IoError::BadName`], [`IoError::BadMaterial`], [`IoError::Merged`] and [`IoError::Unsound`]
/// before anything is written; [`IoError::System`] when the folder cannot be written.
pub fn export(plc: &Plc, dir: &Path, options: &ExportOptions) -> Result<Export, IoError> {
    let (contents, certificate) = bundle(plc, options)?;
    std::fs::create_dir_all(dir).map_err(|source| IoError::System {
        action: "create",
        path: dir.to_owned(),
        source,
    })?;
    let mut files = Vec::with_capacity(contents.len() + 1);
    for (name, bytes) in contents.into_iter().chain([(CERTIFICATE_FILE.to_owned(), to_json(&certificate))]) {
        let path = dir.join(name);
        write_atomic(&path, &bytes)?;
        files.push(path);
    }
    Ok(Export { files, certificate })
}

/// The certificate of an export, without writing one.
///
/// # Errors
/// As [`export`], but for those of the files.
pub fn certify(plc: &Plc, options: &ExportOptions) -> Result<Certificate, IoError> {
    bundle(plc, options).map(|(_, certificate)| certificate)
}

/// File names with their content.
pub(super) type NamedFiles = Vec<(String, Vec<u8>)>;

/// All files of an export but the certificate, and the certificate.
pub(super) fn bundle(plc: &Plc, options: &ExportOptions) -> Result<(NamedFiles, Certificate), IoError> {
    plc.check()?;
    check_regions(plc)?;
    let shift = rounding::shift_mm(plc);
    let rounded: Vec<[f32; 3]> = plc.vertices.iter().map(|&v| rounding::stl_vertex(v, shift)).collect();
    rounding::check_distinct(plc, &rounded, "STL")?;
    let mut files = Vec::new();
    let mut solids = Vec::new();
    for (id, region) in plc.solids() {
        let triangles: Vec<_> = plc.boundary_faces(id).iter().map(|f| f.map(|v| rounded[v.index()])).collect();
        let bytes = stl::encode(&format!("Conformant binary STL, unit mm, region {}", region.name), &triangles);
        let name = stl_name(&region.name);
        let triangles = stl::parse(&bytes).map_err(|e| e.at(Path::new(&name)))?;
        solids.push(Solid { region: region.name.clone(), triangles });
        let sidecar = Sidecar::new(Material::of(region), &bytes, shift.to_array());
        files.push((name, bytes));
        files.push((sidecar_name(&region.name), to_json(&sidecar)));
    }
    let largest = rounded.iter().flatten().fold(0.0_f64, |m, &x| m.max(f64::from(x.abs())));
    let mut proof = prove(&solids, JUNCTION * largest);
    if let Some(Finding { file, fault }) = proof.findings.pop() {
        let region = file.trim_end_matches(".stl").to_owned();
        return Err(IoError::Unsound { region, fault });
    }
    if options.obj {
        files.push((OBJ_FILE.to_owned(), obj::encode(plc)));
    }
    if options.gltf {
        let positions: Vec<[f32; 3]> = plc.vertices.iter().map(|&v| rounding::gltf_vertex(v)).collect();
        rounding::check_distinct(plc, &positions, "glTF")?;
        files.push((GLTF_FILE.to_owned(), gltf::encode(plc, &positions)?));
    }
    let materials = plc.solids().map(|(_, region)| Material::of(region)).collect();
    let mut certificate = Certificate::new(materials, proof, shift.to_array(), &files);
    certificate.summary.clone_from(&options.summary);
    Ok((files, certificate))
}

fn check_regions(plc: &Plc) -> Result<(), IoError> {
    let mut seen = HashSet::from([CERTIFICATE_FILE.to_owned()]);
    for (_, region) in plc.solids() {
        let good = is_plain(&region.name) && !region.name.contains('.');
        if !good || !seen.insert(sidecar_name(&region.name)) {
            return Err(IoError::BadName { region: region.name.clone() });
        }
        if !(region.eps_r.is_finite() && region.tan_delta.is_finite()) {
            let (eps_r, tan_delta) = (region.eps_r, region.tan_delta);
            return Err(IoError::BadMaterial { region: region.name.clone(), eps_r, tan_delta });
        }
    }
    Ok(())
}
