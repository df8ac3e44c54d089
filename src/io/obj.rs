//! Wavefront OBJ: vertices that faces share, with all digits, one group per solid.
//!
//! Our own files are millimetres and say so in a comment; a comment line per region carries what it is made of. The
//! decimal point of each coordinate is moved in its text, not by a multiplication, so that metres come back bit for
//! bit. Reading takes any `v`, `f`, `g` and `o` lines: texture and normal indices, negative indices, and polygons
//! (cut as a fan from their first corner, right for convex ones); every other statement is passed over.

use super::certificate::Material;
use super::decimal::{MM_DIGITS, millimetres, number};
use super::error::{IoError, ParseError, Place, read};
use super::stl::shorten;
use crate::geometry::{DVec3, Plc, TriMesh, VertexId};
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

const REGION_COMMENT: &str = "# region ";

/// What an OBJ file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Obj {
    /// All positions, in the unit asked for when reading.
    pub vertices: Vec<DVec3>,
    /// Groups in order of first mention, without those that have no face.
    pub groups: Vec<Group>,
    /// Materials named in the comments of our own files.
    pub materials: Vec<Material>,
}

/// The triangles under one `g` or `o` name.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The name; empty before the first `g` or `o`.
    pub name: String,
    /// Name of the material that its first face has by `usemtl`; empty where there is none.
    pub material: String,
    /// Corners by index into [`Obj::vertices`].
    pub faces: Vec<[VertexId; 3]>,
}

/// Encodes a complex in millimetres: each solid as a group with outward faces, vertices shared by all.
pub(super) fn encode(plc: &Plc) -> Vec<u8> {
    let mut text = String::from("# Conformant antenna, unit mm\n");
    for (_, region) in plc.solids() {
        let material = serde_json::to_string(&Material::of(region)).expect("plain fields");
        text.extend([REGION_COMMENT, &material, "\n"]);
    }
    for vertex in &plc.vertices {
        text.extend(["v ", &millimetres(*vertex), "\n"]);
    }
    for (id, region) in plc.solids() {
        text.extend(["g ", &region.name, "\n"]);
        for face in plc.boundary_faces(id) {
            let [a, b, c] = face.map(|v| v.index() + 1);
            writeln!(text, "f {a} {b} {c}").expect("writing to a string");
        }
    }
    text.into_bytes()
}

/// Reads an OBJ file of any origin, numbers as they stand.
///
/// # Errors
/// [`ParseError`] with the line for a number that is not finite, an index out of range or a face of fewer than three
/// corners.
pub fn parse(bytes: &[u8]) -> Result<Obj, ParseError> {
    parse_scaled(bytes, 0)
}

/// Reads our own export: millimetres in the file, metres in the result, exactly.
pub(super) fn parse_mm(bytes: &[u8]) -> Result<Obj, ParseError> {
    parse_scaled(bytes, MM_DIGITS)
}

/// Reads one closed triangle surface, such as a cage, with all groups taken together and numbers as they stand.
///
/// # Errors
/// [`IoError::Malformed`] for broken content, [`IoError::NotClosed`] for a surface that is open, inside out or not
/// oriented throughout.
pub fn read_surface(path: &Path) -> Result<TriMesh, IoError> {
    let obj = parse(&read(path)?).map_err(|e| e.at(path))?;
    let mesh = TriMesh { vertices: obj.vertices, faces: obj.groups.into_iter().flat_map(|g| g.faces).collect() };
    mesh.check().map_err(|source| IoError::NotClosed { path: path.to_owned(), source })?;
    Ok(mesh)
}

fn parse_scaled(bytes: &[u8], digits: i32) -> Result<Obj, ParseError> {
    let text = String::from_utf8_lossy(bytes);
    let mut obj = Obj::default();
    let mut numbers: HashMap<String, usize> = HashMap::new();
    let (mut name, mut material) = (String::new(), String::new());
    for (i, line) in text.lines().enumerate() {
        let place = Place::Line(i + 1);
        obj.materials
            .extend(line.strip_prefix(REGION_COMMENT).and_then(|json| serde_json::from_str::<Material>(json).ok()));
        let statement = line.split('#').next().unwrap_or_default();
        let mut words = statement.split_ascii_whitespace();
        match words.next() {
            Some("v") => obj.vertices.push(vertex(words, digits, place)?),
            Some("g" | "o") => name = words.collect::<Vec<_>>().join(" "),
            Some("usemtl") => material = words.collect::<Vec<_>>().join(" "),
            Some("f") => {
                let corners: Vec<VertexId> =
                    words.map(|word| corner(word, obj.vertices.len(), place)).collect::<Result<_, _>>()?;
                if corners.len() < 3 {
                    return Err(ParseError::new(place, format!("a face of {} corners, not 3 or more", corners.len())));
                }
                let group = *numbers.entry(name.clone()).or_insert_with(|| {
                    obj.groups.push(Group { name: name.clone(), material: material.clone(), faces: Vec::new() });
                    obj.groups.len() - 1
                });
                let fan = corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]);
                obj.groups[group].faces.extend(fan);
            }
            _ => {}
        }
    }
    Ok(obj)
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a str>, digits: i32, place: Place) -> Result<DVec3, ParseError> {
    let mut coordinates = [0.0; 3];
    for coordinate in &mut coordinates {
        let word = words.next().ok_or_else(|| ParseError::new(place, "a vertex needs three numbers"))?;
        *coordinate = number(word, digits)
            .ok_or_else(|| ParseError::new(place, format!("\"{}\" is not a finite number", shorten(word))))?;
    }
    Ok(DVec3::from_array(coordinates))
}

/// The vertex of one face corner (`7`, `7/2`, `7//3`, `7/2/3` or `-1`).
fn corner(word: &str, n_vertices: usize, place: Place) -> Result<VertexId, ParseError> {
    let index: i64 = word
        .split('/')
        .next()
        .and_then(|i| i.parse().ok())
        .ok_or_else(|| ParseError::new(place, format!("\"{}\" is not a vertex index", shorten(word))))?;
    let count = i64::try_from(n_vertices).expect("a file's lines fit in 63 bits");
    let from_zero = if index < 0 { count.checked_add(index) } else { index.checked_sub(1) };
    match from_zero.map(usize::try_from) {
        Some(Ok(i)) if i < n_vertices => Ok(VertexId::new(i)),
        _ => Err(ParseError::new(place, format!("vertex {index} is named, but {n_vertices} stand above this line"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_of_every_form_and_polygons_are_read() {
        let text = "v 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl x\ng top side\nf 1 2/1 3/1/1 4//1\no b\nf -4 -3 -2\n";
        let obj = parse(text.as_bytes()).unwrap();
        let faces: Vec<_> = obj.groups.iter().map(|g| (g.name.as_str(), &g.material[..], g.faces.len())).collect();
        assert_eq!(faces, [("top side", "x", 2), ("b", "x", 1)], "a quad is two triangles");
        assert_eq!(obj.groups[1].faces[0], [0, 1, 2].map(VertexId::new), "counted from the end");
    }

    #[test]
    fn faults_name_their_line() {
        for (text, line) in [
            ("v 0 0\n", 1),
            ("v 0 0 nan\n", 1),
            ("v 0 0 1e999\n", 1),
            ("v 0 0 0\nf 1 1 2\n", 2),
            ("v 0 0 0\nf 1 1 -2\n", 2),
            ("v 0 0 0\nf 1 1 0\n", 2),
            ("v 0 0 0\nf 1 1\n", 2),
            ("v 0 0 0\nf 1 1 -9223372036854775808\n", 2),
        ] {
            assert_eq!(parse(text.as_bytes()).unwrap_err().place, Place::Line(line), "{text:?}");
        }
    }

    #[test]
    fn a_surface_must_be_closed() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("cage.obj");
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
        std::fs::write(&path, format!("{vertices}f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")).unwrap();
        assert_eq!(read_surface(&path).unwrap().vertices[3], DVec3::Z, "numbers as they stand");
        std::fs::write(&path, format!("{vertices}f 1 3 2\nf 1 2 4\nf 1 4 3\n")).unwrap();
        assert!(matches!(read_surface(&path), Err(IoError::NotClosed { .. })), "a face is missing");
    }
}
