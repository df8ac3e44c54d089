//! Closed bodies of other programs: STL, OBJ and binary glTF to named surfaces.
//!
//! | Format | A body is | Name | Material | Unit |
//! |---|---|---|---|---|
//! | STL, text or binary | a `solid` | of the solid, else of the file | beside our own files, in the sidecar | asked for |
//! | OBJ | a group or object (`g`, `o`) | of the group | `usemtl`; in the comments of our own files | asked for |
//! | glTF, binary (`.glb`) | a mesh as a node shows it | of the node | of its first primitive | metre, y up |
//!
//! Corners that agree bit for bit become one vertex; glTF's y up becomes z up as an export's z up became y up. Names
//! become such as a region may have, and each is there once. Whether a surface is closed is not looked at here.

use super::certificate::{Material, Sidecar, is_plain, sha256, sidecar_name};
use super::error::{IoError, ParseError, Place};
use super::weld::Weld;
use super::{gltf, obj, stl};
use crate::geometry::{DVec3, TriMesh};
use crate::units::MM;
use std::collections::HashMap;
use std::path::Path;

/// Files larger than this hold no flat antenna.
const MAX_BYTES: u64 = 256 << 20;

/// A surface as read.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// What it is called: lower-case letters, digits, `-` and `_`; other names of the same file differ.
    pub name: String,
    /// Name of its material in the file; empty where there is none.
    pub material_name: String,
    /// What it is made of, where one of our own exports says so.
    pub material: Option<Material>,
    /// Its triangles, m.
    pub surface: TriMesh,
}

/// Reads the bodies of a file.
///
/// * `unit`: length of the file's unit, m; a glTF file is in metres whatever it says here.
///
/// # Errors
/// [`IoError`] naming the file and the place.
pub fn read(path: &Path, unit: f64) -> Result<Vec<Solid>, IoError> {
    let length = std::fs::metadata(path).map_or(0, |m| m.len());
    if length > MAX_BYTES {
        let what = format!("is larger than {} MiB: simplify the bodies before", MAX_BYTES >> 20);
        return Err(ParseError::new(Place::File, what).at(path));
    }
    let bytes = super::error::read(path)?;
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let solids = match extension.as_deref() {
        Some("stl") => from_stl(&bytes, unit, sidecar_of(path, &bytes).as_ref()),
        Some("obj") => from_obj(&bytes, unit),
        Some("glb") => from_gltf(&bytes),
        Some("gltf") => {
            Err(ParseError::new(Place::File, "text glTF is not read, since its data is in other files: save as .glb"))
        }
        _ => Err(ParseError::new(Place::File, "bodies are read from .stl, .obj and .glb: export as one of these")),
    };
    let mut solids = solids.map_err(|e| e.at(path))?;
    solids.retain(|s| !s.surface.faces.is_empty());
    if solids.is_empty() {
        return Err(ParseError::new(Place::File, "there are no triangles in it").at(path));
    }
    solids.iter_mut().filter(|s| s.name.is_empty()).for_each(|s| s.name.clone_from(&stem));
    name_plainly(&mut solids);
    Ok(solids)
}

/// Gives each body a name of its own that a region may have.
pub fn name_plainly(solids: &mut [Solid]) {
    let mut seen: HashMap<String, usize> = HashMap::new();
    for solid in solids {
        let lower = solid.name.trim().to_lowercase();
        let plain: String =
            lower.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).take(40).collect();
        let plain = if plain.chars().all(|c| c == '_') { "body".to_owned() } else { plain };
        let mut name = plain.clone();
        while name == "certificate" || name == "air" || seen.contains_key(&name) {
            let n = seen.entry(plain.clone()).or_insert(1);
            *n += 1;
            name = format!("{plain}_{n}");
        }
        debug_assert!(is_plain(&name), "made of plain characters");
        seen.insert(name.clone(), 1);
        solid.name = name;
    }
}

/// The sidecar of one of our own STL files, if it is of these bytes.
fn sidecar_of(path: &Path, bytes: &[u8]) -> Option<Sidecar> {
    let path = path.with_file_name(sidecar_name(&path.file_stem()?.to_string_lossy()));
    let sidecar = Sidecar::parse(&std::fs::read(&path).ok()?, &path).ok()?;
    (sidecar.sha256 == sha256(bytes)).then_some(sidecar)
}

fn surface(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> TriMesh {
    let mut weld = Weld::default();
    let faces = triangles.into_iter().map(|t| t.map(|p| weld.vertex(p))).collect();
    TriMesh { vertices: weld.vertices, faces }
}

fn from_stl(bytes: &[u8], unit: f64, sidecar: Option<&Sidecar>) -> Result<Vec<Solid>, ParseError> {
    // A sidecar says the unit itself.
    let (shift, unit) = sidecar.map_or((DVec3::ZERO, unit), |s| (DVec3::from_array(s.shift_mm), MM));
    let solid = |solid: stl::Solid| Solid {
        name: sidecar.map_or(solid.name, |s| s.material.material.clone()),
        material_name: String::new(),
        material: sidecar.map(|s| s.material.clone()),
        surface: surface(solid.triangles.iter().map(|t| t.corners.map(|c| (stl::widen(c) - shift) * unit))),
    };
    Ok(stl::parse_solids(bytes)?.into_iter().map(solid).collect())
}

fn from_obj(bytes: &[u8], unit: f64) -> Result<Vec<Solid>, ParseError> {
    let obj = obj::parse(bytes)?;
    let solid = |group: &obj::Group| Solid {
        name: group.name.clone(),
        material_name: group.material.clone(),
        material: obj.materials.iter().find(|m| m.material == group.name).cloned(),
        surface: surface(group.faces.iter().map(|f| f.map(|v| obj.vertices[v.index()] * unit))),
    };
    Ok(obj.groups.iter().map(solid).collect())
}

fn from_gltf(bytes: &[u8]) -> Result<Vec<Solid>, ParseError> {
    let mut objects: Vec<(usize, Vec<gltf::Mesh>)> = Vec::new();
    for mesh in gltf::parse(bytes)? {
        match objects.last_mut().filter(|(number, _)| *number == mesh.number) {
            Some((_, parts)) => parts.push(mesh),
            None => objects.push((mesh.number, vec![mesh])),
        }
    }
    let solid = |(_, parts): (usize, Vec<gltf::Mesh>)| Solid {
        name: parts[0].object.clone(),
        material_name: parts[0].name.clone(),
        material: parts[0].material.clone(),
        surface: surface(parts.into_iter().flat_map(|p| p.triangles)),
    };
    Ok(objects.into_iter().map(solid).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_as(name: &str, bytes: &[u8], unit: f64) -> Result<Vec<Solid>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read(&path, unit).map_err(|e| e.to_string())
    }

    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\nendloop\nendfacet\n";

    #[test]
    fn solids_of_a_text_are_bodies_with_names_of_their_own() {
        let text =
            format!("solid Top Plate\n{FACET}endsolid\nsolid top plate\n{FACET}endsolid x\nsolid\n{FACET}endsolid");
        let solids = read_as("My part.STL", text.as_bytes(), 0.0254).unwrap();
        let names: Vec<&str> = solids.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["top_plate", "top_plate_2", "my_part"], "plain, and each once");
        assert_eq!(solids[0].surface.vertices[2], DVec3::Y * 2.0 * 0.0254, "inches");
    }

    #[test]
    fn groups_have_the_material_they_use() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\no Patch\nusemtl copper\nf 1 2 3\no none\n# nothing\no Base\nusemtl FR-4\nf 1 3 2\n";
        let solids = read_as("a.obj", text.as_bytes(), MM).unwrap();
        let found: Vec<_> = solids.iter().map(|s| (s.name.as_str(), s.material_name.as_str())).collect();
        assert_eq!(found, [("patch", "copper"), ("base", "FR-4")], "groups without faces are none");
    }

    #[test]
    fn what_cannot_be_read_says_what_to_try() {
        for (name, bytes, what) in [
            ("a.step", "x", "export as one of these"),
            ("a.gltf", "{}", "save as .glb"),
            ("a.obj", "v 0 0 0\n", "no triangles"),
            ("a.obj", "v 0 0 zero\n", "line 1"),
            ("a.stl", "solid\nfacet", "line 2"),
            ("a.glb", "glTF", "byte"),
        ] {
            let message = read_as(name, bytes.as_bytes(), MM).unwrap_err();
            assert!(message.contains(name) && message.contains(what), "{name}: {message}");
        }
    }

    /// A binary glTF of one triangle that two nodes show.
    fn glb(nodes: &str) -> Vec<u8> {
        let bin: Vec<u8> =
            [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let mut json = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":{nodes},"meshes":[{{"name":"m","primitives":[
            {{"attributes":{{"POSITION":0}},"material":0}}]}}],"materials":[{{"name":"Copper"}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36}}]}}"#
        )
        .into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let size = |n: usize| u32::try_from(n).unwrap().to_le_bytes();
        let mut bytes = b"glTF".to_vec();
        bytes.extend([size(2), size(28 + json.len() + bin.len()), size(json.len())].concat());
        bytes.extend(b"JSON");
        bytes.extend(json);
        bytes.extend(size(bin.len()));
        bytes.extend(b"BIN\0");
        bytes.extend(bin);
        bytes
    }

    #[test]
    fn nodes_of_a_gltf_file_are_placed_by_all_their_parents() {
        let nodes = r#"[{"name":"A","mesh":0,"scale":[2,2,2]},
            {"name":"B","mesh":0,"translation":[0,1,0]},
            {"children":[1],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"translation":[0,0,3]}]"#;
        let solids = read_as("a.glb", &glb(nodes), 1.0).unwrap();
        let found: Vec<_> = solids.iter().map(|s| (s.name.as_str(), s.material_name.as_str())).collect();
        assert_eq!(found, [("a", "Copper"), ("b", "Copper")], "two bodies");
        assert_eq!(solids[0].surface.vertices, [DVec3::ZERO, DVec3::X * 2.0, DVec3::Z * 2.0], "y up is z up");
        // Up by one, a quarter turn about glTF's z, which is our -y, then along it by three.
        let expected = [DVec3::new(-1.0, -3.0, 0.0), DVec3::new(-1.0, -3.0, 1.0), DVec3::new(-2.0, -3.0, 0.0)];
        for (p, q) in solids[1].surface.vertices.iter().zip(expected) {
            assert!(p.distance(q) < 1e-12, "{p} for {q}");
        }
        for (nodes, what) in [
            (r#"[{"mesh":0,"children":[0]}]"#, "descendant"),
            (r#"[{"mesh":0},{"children":[0,0]}]"#, "two parents"),
            (r#"[{"mesh":1}]"#, "does not exist"),
        ] {
            let message = read_as("a.glb", &glb(nodes), 1.0).unwrap_err();
            assert!(message.contains(what), "{message}");
        }
    }
}
