//! Reads an export folder again and proves its certificate from the bytes.
//!
//! Hashes tell whether a file is the one that was written; the geometric proof does not rely on them, so a file that
//! was edited and hashed anew is still found. Sums run in the order of the file, so that certified volumes and areas
//! come out to the last bit. OBJ and glTF must hold the STL's triangles in the same order: OBJ, rounded anew, to the
//! bit; glTF within the rounding of both formats.

use super::certificate::{Certificate, FileRecord, Sidecar, SolidRecord, sha256, sidecar_name, stl_name};
use super::error::{IoError, ParseError};
use super::export::{GLTF_FILE, OBJ_FILE};
use super::import::{from_gltf, from_obj};
use super::proof::{Fault, Finding, Interface, Proof, Solid, prove};
use super::rounding::stl_vertex;
use super::stl::widen;
use super::weld::LooseSolid;
use super::{Material, stl};
use crate::geometry::DVec3;
use crate::units::MM;
use std::collections::{BTreeMap, HashSet};
use std::fmt::Debug;
use std::path::Path;

/// What became of a verification.
#[derive(Clone, Debug, PartialEq)]
pub struct Verification {
    /// The certificate as it stands in the folder.
    pub certificate: Certificate,
    /// Everything that is not as certified; empty when all holds.
    pub findings: Vec<Finding>,
}

impl Verification {
    /// True if every claim of the certificate was proved anew.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.findings.is_empty()
    }
}

/// Proves the certificate of an export folder from its files.
///
/// # Errors
/// [`IoError`] if the folder or its certificate cannot be read; whatever else is wrong is a [`Finding`].
pub fn verify(dir: &Path) -> Result<Verification, IoError> {
    let certificate = Certificate::read(dir)?;
    let mut check = Check { certificate: &certificate, findings: Vec::new() };
    let files = check.files(dir);
    check.strays(dir)?;
    let solids = check.solids(&files);
    let proof = prove(&solids, certificate.clearance_mm);
    check.claims(&solids, proof);
    for (name, read) in [(OBJ_FILE, from_obj as Reader), (GLTF_FILE, from_gltf)] {
        if let Some(bytes) = files.get(name) {
            check.other_format(name, read(bytes), &solids);
        }
    }
    let findings = check.findings;
    Ok(Verification { certificate, findings })
}

type Reader = fn(&[u8]) -> Result<Vec<LooseSolid>, ParseError>;

struct Check<'a> {
    certificate: &'a Certificate,
    findings: Vec<Finding>,
}

impl Check<'_> {
    fn find(&mut self, file: &str, fault: Fault) {
        self.findings.push(Finding { file: file.to_owned(), fault });
    }

    fn compare<T: Debug + PartialEq>(&mut self, file: &str, quantity: &'static str, found: &T, certified: &T) {
        if found != certified {
            let (found, certified) = (format!("{found:?}"), format!("{certified:?}"));
            self.find(file, Fault::Differs { quantity, found, certified });
        }
    }

    /// All certified files that can be read, by name.
    fn files(&mut self, dir: &Path) -> BTreeMap<String, Vec<u8>> {
        let mut files = BTreeMap::new();
        for FileRecord { name, sha256: hash, bytes: length } in &self.certificate.files {
            match std::fs::read(dir.join(name)) {
                Ok(bytes) => {
                    if sha256(&bytes) != *hash || bytes.len() as u64 != *length {
                        self.find(name, Fault::Changed);
                    }
                    files.insert(name.clone(), bytes);
                }
                Err(e) => self.find(name, Fault::Unreadable { reason: e.to_string() }),
            }
        }
        files
    }

    /// Geometry in the folder that nothing is certified of would be taken for part of the export.
    fn strays(&mut self, dir: &Path) -> Result<(), IoError> {
        let certified: HashSet<&str> = self.certificate.files.iter().map(|f| f.name.as_str()).collect();
        let system = |source| IoError::System { action: "read", path: dir.to_owned(), source };
        let mut strays = Vec::new();
        for entry in std::fs::read_dir(dir).map_err(system)? {
            let name = entry.map_err(system)?.file_name().to_string_lossy().into_owned();
            let is_ours = name.to_ascii_lowercase().ends_with(".stl") || name == OBJ_FILE || name == GLTF_FILE;
            if is_ours && !certified.contains(name.as_str()) {
                strays.push(name);
            }
        }
        strays.sort_unstable();
        strays.iter().for_each(|name| self.find(name, Fault::Stray));
        Ok(())
    }

    /// The solids with readable STL files, and whether their sidecars agree with the certificate.
    fn solids(&mut self, files: &BTreeMap<String, Vec<u8>>) -> Vec<Solid> {
        let mut solids = Vec::new();
        let certificate = self.certificate;
        for SolidRecord { material, .. } in &certificate.solids {
            let region = &material.material;
            let (name, sidecar) = (stl_name(region), sidecar_name(region));
            let Some(bytes) = files.get(&name) else {
                self.missing(&name);
                continue;
            };
            match stl::parse(bytes) {
                Ok(triangles) => solids.push(Solid { region: region.clone(), triangles }),
                Err(e) => self.find(&name, Fault::Unreadable { reason: e.to_string() }),
            }
            match files.get(&sidecar).map(|json| Sidecar::parse(json, Path::new(&sidecar))) {
                None => self.missing(&sidecar),
                Some(Err(e)) => self.find(&sidecar, Fault::Unreadable { reason: e.to_string() }),
                Some(Ok(found)) => {
                    let expected = Sidecar::new(material.clone(), bytes, certificate.shift_mm);
                    self.compare(&sidecar, "the sidecar", &found, &expected);
                }
            }
        }
        solids
    }

    /// A solid without a certified file, unless that it cannot be read was told already.
    fn missing(&mut self, name: &str) {
        if !self.findings.iter().any(|f| f.file == name && matches!(f.fault, Fault::Unreadable { .. })) {
            self.find(
                name,
                Fault::Unreadable { reason: "the certificate does not list it among its files".to_owned() },
            );
        }
    }

    fn claims(&mut self, solids: &[Solid], proof: Proof) {
        let certificate = self.certificate;
        self.findings.extend(proof.findings);
        for (solid, found) in solids.iter().zip(&proof.solids) {
            let certified = certificate.solids.iter().find(|s| s.material.material == solid.region);
            let Some(certified) = certified.map(|s| &s.shape) else { continue };
            let file = stl_name(&solid.region);
            self.compare(&file, "2-manifold", &found.closed_2_manifold, &certified.closed_2_manifold);
            self.compare(&file, "number of triangles", &found.triangles, &certified.triangles);
            self.compare(&file, "number of vertices", &found.vertices, &certified.vertices);
            let euler = (found.euler_characteristic, certified.euler_characteristic);
            self.compare(&file, "Euler characteristic", &euler.0, &euler.1);
            self.compare(&file, "volume in mm3", &found.volume_mm3, &certified.volume_mm3);
            self.compare(&file, "area in mm2", &found.area_mm2, &certified.area_mm2);
        }
        let counts = |list: &[Interface]| -> BTreeMap<[String; 2], usize> {
            list.iter().map(|i| (i.solids.clone(), i.shared_facets)).collect()
        };
        let (found, certified) = (counts(&proof.interfaces), counts(&certificate.interfaces));
        let pairs: std::collections::BTreeSet<_> = found.keys().chain(certified.keys()).collect();
        for pair in pairs {
            let count = |list: &BTreeMap<[String; 2], usize>| list.get(pair).copied().unwrap_or(0);
            let quantity = "number of facets shared bit for bit";
            self.compare(&format!("{}.stl, {}.stl", pair[0], pair[1]), quantity, &count(&found), &count(&certified));
        }
        let file = super::certificate::CERTIFICATE_FILE;
        self.compare(file, "clearance in mm", &proof.clearance_mm, &certificate.clearance_mm);
        self.compare(file, "T-junctions", &0, &certificate.t_junctions);
        self.compare(file, "crossing triangles", &0, &certificate.crossing_triangles);
    }

    fn other_format(&mut self, file: &str, read: Result<Vec<LooseSolid>, ParseError>, solids: &[Solid]) {
        let certificate = self.certificate;
        let shift = DVec3::from_array(certificate.shift_mm);
        let others = match read {
            Ok(others) => others,
            Err(e) => return self.find(file, Fault::Unreadable { reason: e.to_string() }),
        };
        let materials: Vec<Material> = others.iter().map(|o| Material::of(&o.region)).collect();
        let certified: Vec<Material> = certificate.solids.iter().map(|s| s.material.clone()).collect();
        self.compare(file, "the list of materials", &materials, &certified);
        let exact = file == OBJ_FILE;
        for solid in solids {
            let Some(other) = others.iter().find(|o| o.region.name == solid.region) else { continue };
            let stl = stl_name(&solid.region);
            if other.triangles.len() != solid.triangles.len() {
                let what = format!("{} triangles, not {}", other.triangles.len(), solid.triangles.len());
                self.find(file, Fault::Disagrees { stl, what });
                continue;
            }
            let differs = other.triangles.iter().zip(&solid.triangles).position(|(ours, theirs)| {
                ours.iter().zip(theirs.corners).any(|(&p, corner)| !agrees(p, corner, shift, exact))
            });
            if let Some(triangle) = differs {
                self.find(file, Fault::Disagrees { stl, what: format!("triangle {triangle} lies elsewhere") });
            }
        }
    }
}

/// True if a position (m) is the one that an STL file holds.
fn agrees(position: DVec3, corner: [f32; 3], shift_mm: DVec3, exact: bool) -> bool {
    let expected = stl_vertex(position, shift_mm);
    if exact {
        return expected.map(f32::to_bits) == corner.map(f32::to_bits);
    }
    // Half a step of rounding in each format, doubled.
    let allowed = (widen(corner).abs() + (position / MM).abs()) * f64::from(f32::EPSILON);
    ((position / MM + shift_mm - widen(corner)).abs() - allowed).max_element() <= 0.0
}
