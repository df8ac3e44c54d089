//! Back from an export of this program to a surface complex.
//!
//! Corners that agree bit for bit become one vertex, facets that two solids share become one: the regions on both
//! sides of each facet are those of the original. Positions come back exactly from OBJ, in single precision from STL
//! (of shifted millimetres) and glTF (of metres). Files of other programs carry no materials and are refused.

use super::certificate::{Certificate, Material, Sidecar, sha256, sidecar_name, stl_name};
use super::error::{IoError, ParseError, Place, read};
use super::stl::{Triangle, widen};
use super::weld::{LooseSolid, join};
use super::{gltf, obj, stl};
use crate::geometry::{DVec3, Plc};
use crate::units::from_mm;
use std::collections::HashMap;
use std::path::Path;

/// Reads an export folder (its STL files), an exported `.obj` or an exported `.glb`.
///
/// # Errors
/// [`IoError`] naming the file and the place: content that does not follow its format, a solid without material, one
/// that is not closed, two that overlap, or an STL file that is not the one its sidecar describes.
pub fn import(path: &Path) -> Result<Plc, IoError> {
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let solids = match extension.as_ref().and_then(|e| e.to_str()) {
        _ if path.is_dir() => from_folder(path)?,
        Some("obj") => from_obj(&read(path)?).map_err(|e| e.at(path))?,
        Some("glb") => from_gltf(&read(path)?).map_err(|e| e.at(path))?,
        _ => return Err(IoError::UnknownKind { path: path.to_owned() }),
    };
    join(solids, path)
}

fn from_folder(dir: &Path) -> Result<Vec<LooseSolid>, IoError> {
    let read_solid = |name: &str| {
        let path = dir.join(sidecar_name(name));
        let sidecar = Sidecar::parse(&read(&path)?, &path)?;
        let path = dir.join(stl_name(name));
        let bytes = read(&path)?;
        if sha256(&bytes) != sidecar.sha256 {
            return Err(IoError::Changed { path });
        }
        let shift = DVec3::from_array(sidecar.shift_mm);
        let metres = |c| DVec3::from_array((widen(c) - shift).to_array().map(from_mm));
        let triangles = stl::parse(&bytes).map_err(|e| e.at(&path))?;
        let triangles = triangles.iter().map(|t: &Triangle| t.corners.map(metres)).collect();
        Ok(LooseSolid { region: sidecar.material.into_region(), triangles })
    };
    Certificate::read(dir)?.solids.iter().map(|s| read_solid(&s.material.material)).collect()
}

/// The solids of our own OBJ file, m.
pub(super) fn from_obj(bytes: &[u8]) -> Result<Vec<LooseSolid>, ParseError> {
    let obj = obj::parse_mm(bytes)?;
    let mut materials: HashMap<String, Material> = obj.materials.into_iter().map(|m| (m.material.clone(), m)).collect();
    let solid = |group: &obj::Group| {
        let material = materials.remove(&group.name).ok_or_else(|| without_material(&group.name))?;
        let triangles = group.faces.iter().map(|f| f.map(|v| obj.vertices[v.index()])).collect();
        Ok(LooseSolid { region: material.into_region(), triangles })
    };
    obj.groups.iter().map(solid).collect()
}

/// The solids of our own glTF file, m.
pub(super) fn from_gltf(bytes: &[u8]) -> Result<Vec<LooseSolid>, ParseError> {
    let solid = |mesh: gltf::Mesh| {
        let material = mesh.material.ok_or_else(|| without_material(&mesh.name))?;
        Ok(LooseSolid { region: material.into_region(), triangles: mesh.triangles })
    };
    gltf::parse(bytes)?.into_iter().map(solid).collect()
}

fn without_material(name: &str) -> ParseError {
    let name = stl::shorten(name);
    ParseError::new(Place::File, format!("says nothing of the material of \"{name}\": only exports of this program do"))
}
