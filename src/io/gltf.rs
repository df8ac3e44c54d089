//! glTF 2.0 binary: metres, +Y up, one mesh and node per solid, its material named as the region.
//!
//! The axes turn from ours (z up) by (x, y, z) -> (x, z, -y). No normals are stored: a viewer then shades each facet
//! flat, as it is. What a region is made of stands in its material's `extras`. The reader takes triangle lists from
//! the binary chunk, indexed or not, once for each node that shows them, with the node's transforms; it refuses what
//! would be read wrongly if passed over: sparse accessors, compression and outside buffers.

use super::certificate::Material;
use super::error::{IoError, ParseError, Place};
use super::stl::shorten;
use crate::geometry::{DQuat, DVec3, Plc, RegionRole, VertexId};
use glam::{DAffine3, DMat4};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

const MAGIC: u32 = 0x4654_6C67;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BIN_CHUNK: u32 = 0x004E_4942;
const FLOAT: u32 = 5126;
const TRIANGLES: u32 = 4;

/// One primitive of a mesh of a glTF file as a node shows it, turned back to z up, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Name of the material, else of the mesh, else empty.
    pub name: String,
    /// Name of the node, else of the mesh, else empty.
    pub object: String,
    /// Which placed mesh it is part of: a mesh of several materials has a part for each.
    pub number: usize,
    /// What it is made of, where `extras` say so.
    pub material: Option<Material>,
    /// Triangles, counter-clockwise from outside, m.
    pub triangles: Vec<[DVec3; 3]>,
}

#[derive(Serialize, Deserialize)]
struct Extras {
    unit: String,
    #[serde(flatten)]
    material: Material,
}

/// Encodes a complex.
///
/// * `positions`: per vertex of the complex, in glTF's axes, m.
pub(super) fn encode(plc: &Plc, positions: &[[f32; 3]]) -> Result<Vec<u8>, IoError> {
    let mut bin: Vec<u8> = Vec::new();
    let (mut views, mut accessors, mut meshes, mut nodes, mut materials) = (vec![], vec![], vec![], vec![], vec![]);
    for (m, (id, region)) in plc.solids().enumerate() {
        let (own, indices) = own_vertices(&plc.boundary_faces(id), positions);
        let (lo, hi) = own.iter().fold(([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |(lo, hi), p| {
            (std::array::from_fn(|k| lo[k].min(p[k])), std::array::from_fn(|k| hi[k].max(p[k])))
        });
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": 12 * own.len(), "target": 34962}));
        bin.extend(own.iter().flatten().flat_map(|x| x.to_le_bytes()));
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": 4 * indices.len(), "target": 34963}));
        bin.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
        accessors.push(json!({"bufferView": 2 * m, "componentType": FLOAT, "count": own.len(), "type": "VEC3",
            "min": lo, "max": hi}));
        accessors.push(json!({"bufferView": 2 * m + 1, "componentType": 5125, "count": indices.len(),
            "type": "SCALAR"}));
        let primitive = json!({"attributes": {"POSITION": 2 * m}, "indices": 2 * m + 1, "material": m,
            "mode": TRIANGLES});
        meshes.push(json!({"name": region.name, "primitives": [primitive]}));
        nodes.push(json!({"name": region.name, "mesh": m}));
        let metal = region.role == RegionRole::Conductor;
        let color = if metal { [0.80, 0.45, 0.20, 1.0] } else { [0.75, 0.78, 0.70, 1.0] };
        let look = json!({"baseColorFactor": color, "metallicFactor": if metal { 1.0 } else { 0.0 },
            "roughnessFactor": 0.5});
        let extras = Extras { unit: "m".to_owned(), material: Material::of(region) };
        materials.push(json!({"name": region.name, "pbrMetallicRoughness": look, "extras": extras}));
    }
    let scene = json!({"name": "antenna", "nodes": (0..nodes.len()).collect::<Vec<_>>()});
    let root = json!({
        "asset": {"version": "2.0", "generator": concat!("Conformant ", env!("CARGO_PKG_VERSION"))},
        "scene": 0, "scenes": [scene], "nodes": nodes, "meshes": meshes, "materials": materials,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": bin.len()}],
    });
    container(root.to_string().into_bytes(), bin)
}

/// The vertices that some faces use, and the faces over them as a flat list.
fn own_vertices(faces: &[[VertexId; 3]], positions: &[[f32; 3]]) -> (Vec<[f32; 3]>, Vec<u32>) {
    let mut own = Vec::new();
    let mut local: HashMap<VertexId, u32> = HashMap::new();
    let index = |&v: &VertexId| {
        *local.entry(v).or_insert_with(|| {
            own.push(positions[v.index()]);
            VertexId::new(own.len() - 1).raw()
        })
    };
    let indices = faces.iter().flatten().map(index).collect();
    (own, indices)
}

fn container(mut json: Vec<u8>, mut bin: Vec<u8>) -> Result<Vec<u8>, IoError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let size = |n: usize| {
        let what = "the binary glTF format ends at 4 GiB: export without it";
        u32::try_from(n).ok().ok_or_else(|| ParseError::new(Place::File, what).at(Path::new(super::export::GLTF_FILE)))
    };
    let mut bytes = Vec::with_capacity(28 + json.len() + bin.len());
    for word in [MAGIC, 2, size(28 + json.len() + bin.len())?, size(json.len())?, JSON_CHUNK] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(json);
    for word in [size(bin.len())?, BIN_CHUNK] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(bin);
    Ok(bytes)
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Root {
    #[serde(default)]
    extensions_required: Vec<String>,
    #[serde(default)]
    buffer_views: Vec<View>,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    meshes: Vec<RawMesh>,
    #[serde(default)]
    nodes: Vec<Node>,
    #[serde(default)]
    materials: Vec<RawMaterial>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Node {
    name: String,
    mesh: Option<usize>,
    children: Vec<usize>,
    /// Column by column.
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

impl Node {
    /// Its transform within its parent; `None` where it has none.
    fn transform(&self) -> Option<DAffine3> {
        if let Some(columns) = &self.matrix {
            return Some(DAffine3::from_mat4(DMat4::from_cols_array(columns)));
        }
        let Self { translation, rotation, scale, .. } = self;
        (translation.is_some() || rotation.is_some() || scale.is_some()).then(|| {
            DAffine3::from_scale_rotation_translation(
                DVec3::from_array(scale.unwrap_or([1.0; 3])),
                DQuat::from_array(rotation.unwrap_or([0.0, 0.0, 0.0, 1.0])),
                DVec3::from_array(translation.unwrap_or_default()),
            )
        })
    }
}

/// A mesh where a node shows it.
struct Placed<'a> {
    mesh: usize,
    name: &'a str,
    world: Option<DAffine3>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<Value>,
}

#[derive(Deserialize)]
struct RawMesh {
    #[serde(default)]
    name: String,
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: HashMap<String, usize>,
    indices: Option<usize>,
    material: Option<usize>,
    mode: Option<u32>,
}

#[derive(Deserialize)]
struct RawMaterial {
    name: Option<String>,
    extras: Option<Value>,
}

/// Reads the triangles of a binary glTF file, one [`Mesh`] per primitive and node that shows it.
///
/// # Errors
/// [`ParseError`] for a broken container, any reference out of bounds, numbers that are not finite, and what is not
/// handled.
pub fn parse(bytes: &[u8]) -> Result<Vec<Mesh>, ParseError> {
    let (json, bin) = chunks(bytes)?;
    let root: Root = serde_json::from_slice(json).map_err(|e| ParseError::json(&e))?;
    if let Some(name) = root.extensions_required.first() {
        return Err(ParseError::new(Place::File, format!("needs the extension {}, which is not read", shorten(name))));
    }
    let mut meshes = Vec::new();
    // Views may overlap, so a short file could ask for much: each byte of it is good for one index at most.
    let mut left = bin.len();
    for (number, placed) in root.placed()?.into_iter().enumerate() {
        let mesh = get(&root.meshes, "meshes", placed.mesh)?;
        for primitive in &mesh.primitives {
            let mut triangles = root.triangles(primitive, Place::Element("meshes", placed.mesh), bin, &mut left)?;
            if let Some(world) = placed.world {
                triangles.iter_mut().flatten().for_each(|p| *p = to_ours(world.transform_point3(to_gltf(*p))));
            }
            let material = match primitive.material {
                Some(i) => Some(get(&root.materials, "materials", i)?),
                None => None,
            };
            let name = material.and_then(|m| m.name.clone()).unwrap_or_else(|| mesh.name.clone());
            let object = if placed.name.is_empty() { &mesh.name } else { placed.name }.to_owned();
            let extras = material.and_then(|m| m.extras.clone());
            let extras = extras.and_then(|e| serde_json::from_value::<Extras>(e).ok()).filter(|e| e.unit == "m");
            meshes.push(Mesh { name, object, number, material: extras.map(|e| e.material), triangles });
        }
    }
    Ok(meshes)
}

/// From z up to glTF's y up.
fn to_gltf(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, -p.y)
}

/// From glTF's y up to z up; zero is always positive zero.
fn to_ours(p: DVec3) -> DVec3 {
    DVec3::new(p.x, 0.0 - p.z, p.y) + DVec3::ZERO
}

fn chunks(bytes: &[u8]) -> Result<(&[u8], &[u8]), ParseError> {
    let word = |at: usize| {
        let four = bytes.get(at..at + 4).and_then(|w| <[u8; 4]>::try_from(w).ok());
        four.map(u32::from_le_bytes)
            .ok_or_else(|| ParseError::new(Place::Byte(at), "the file ends here: it was cut off"))
    };
    if word(0)? != MAGIC || word(4)? != 2 {
        return Err(ParseError::new(Place::Byte(0), "not a binary glTF 2.0 file (.glb)"));
    }
    if u64::from(word(8)?) != bytes.len() as u64 {
        let what =
            format!("the header says {} bytes, the file has {}: it was cut off or changed", word(8)?, bytes.len());
        return Err(ParseError::new(Place::Byte(8), what));
    }
    let (mut json, mut bin) = (None, None);
    let mut at = 12;
    while at < bytes.len() {
        let length = word(at)? as usize;
        let content = bytes.get(at + 8..).and_then(|rest| rest.get(..length));
        let content =
            content.ok_or_else(|| ParseError::new(Place::Byte(at), "this chunk runs past the end of the file"))?;
        match word(at + 4)? {
            JSON_CHUNK if json.is_none() => json = Some(content),
            BIN_CHUNK if bin.is_none() => bin = Some(content),
            JSON_CHUNK | BIN_CHUNK => return Err(ParseError::new(Place::Byte(at), "a second chunk of its kind")),
            _ => {}
        }
        at += 8 + length;
    }
    let json = json.ok_or_else(|| ParseError::new(Place::File, "there is no JSON chunk"))?;
    Ok((json, bin.unwrap_or_default()))
}

fn get<'a, T>(list: &'a [T], name: &'static str, index: usize) -> Result<&'a T, ParseError> {
    list.get(index).ok_or_else(|| ParseError::new(Place::Element(name, index), "is named but does not exist"))
}

/// The elements of an accessor: `count` of them, `size` bytes each, `stride` apart, all within `bytes`.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn get<const N: usize>(&self, index: usize) -> Option<[u8; N]> {
        let bytes = self.bytes.get(index.checked_mul(self.stride)?..)?.get(..N)?;
        (index < self.count).then_some(bytes.try_into().ok()?)
    }
}

impl Root {
    /// All meshes where nodes show them, in the order of the nodes; all meshes as they stand where no node shows any.
    fn placed(&self) -> Result<Vec<Placed<'_>>, ParseError> {
        let mut parent = vec![None; self.nodes.len()];
        for (n, node) in self.nodes.iter().enumerate() {
            for &child in &node.children {
                get(&self.nodes, "nodes", child)?;
                if parent[child].replace(n).is_some() {
                    return Err(ParseError::new(Place::Element("nodes", child), "the node has two parents"));
                }
            }
        }
        let mut placed = Vec::new();
        for (n, node) in self.nodes.iter().enumerate() {
            let Some(mesh) = node.mesh else { continue };
            let mut world: Option<DAffine3> = None;
            let mut at = Some(n);
            for _ in 0..=self.nodes.len() {
                let Some(k) = at else { break };
                if let Some(own) = self.nodes[k].transform() {
                    world = Some(world.map_or(own, |world| own * world));
                }
                at = parent[k];
            }
            if at.is_some() {
                return Err(ParseError::new(Place::Element("nodes", n), "the node is a descendant of itself"));
            }
            if world.is_some_and(|w| !w.is_finite()) {
                return Err(ParseError::new(Place::Element("nodes", n), "the node's transform is not finite"));
            }
            placed.push(Placed { mesh, name: &node.name, world });
        }
        if placed.is_empty() {
            placed = (0..self.meshes.len()).map(|mesh| Placed { mesh, name: "", world: None }).collect();
        }
        Ok(placed)
    }

    fn elements<'a>(&self, index: usize, kind: &str, size: usize, bin: &'a [u8]) -> Result<Elements<'a>, ParseError> {
        let fault = |what: &str| ParseError::new(Place::Element("accessors", index), what);
        let accessor = get(&self.accessors, "accessors", index)?;
        if accessor.sparse.is_some() || accessor.kind != kind {
            return Err(fault("is sparse or of a type that does not belong here"));
        }
        let view = accessor.buffer_view.ok_or_else(|| fault("has no bufferView"))?;
        let view = get(&self.buffer_views, "bufferViews", view)?;
        let stride = view.byte_stride.unwrap_or(size);
        let length = accessor.count.checked_sub(1).and_then(|n| n.checked_mul(stride)?.checked_add(size));
        let inside = accessor.byte_offset.checked_add(length.unwrap_or(0)).is_some_and(|end| end <= view.byte_length);
        let bytes = bin.get(view.byte_offset..).and_then(|b| b.get(..view.byte_length));
        match bytes.and_then(|b| b.get(accessor.byte_offset..)) {
            Some(bytes)
                if view.buffer == 0 && inside && stride >= size && (length.is_some() || accessor.count == 0) =>
            {
                Ok(Elements { bytes, stride, count: accessor.count })
            }
            _ => Err(fault("runs past the end of its data, or its data is outside this file")),
        }
    }

    fn triangles(
        &self,
        primitive: &Primitive,
        place: Place,
        bin: &[u8],
        left: &mut usize,
    ) -> Result<Vec<[DVec3; 3]>, ParseError> {
        let fault = |what: &str| ParseError::new(place, what);
        if primitive.mode.unwrap_or(TRIANGLES) != TRIANGLES {
            return Err(fault("only triangle lists (mode 4) are read"));
        }
        let position = *primitive.attributes.get("POSITION").ok_or_else(|| fault("a primitive has no POSITION"))?;
        if get(&self.accessors, "accessors", position)?.component_type != FLOAT {
            return Err(fault("POSITION is not of type float"));
        }
        let positions = self.elements(position, "VEC3", 12, bin)?;
        let indices = match primitive.indices {
            None => None,
            Some(i) => {
                let size = match get(&self.accessors, "accessors", i)?.component_type {
                    5121 => 1,
                    5123 => 2,
                    5125 => 4,
                    _ => return Err(fault("indices are not unsigned integers")),
                };
                Some((self.elements(i, "SCALAR", size, bin)?, size))
            }
        };
        let count = indices.as_ref().map_or(positions.count, |(e, _)| e.count);
        *left = left.checked_sub(count).ok_or_else(|| fault("more indices than the file has bytes"))?;
        if count % 3 != 0 {
            return Err(fault("the number of corners is not a multiple of 3"));
        }
        let index = |k: usize| match &indices {
            None => Some(k),
            Some((e, 1)) => e.get::<1>(k).map(|b| usize::from(b[0])),
            Some((e, 2)) => e.get::<2>(k).map(|b| usize::from(u16::from_le_bytes(b))),
            Some((e, _)) => e.get::<4>(k).map(|b| u32::from_le_bytes(b) as usize),
        };
        let corner = |k: usize| {
            let bytes: [u8; 12] =
                index(k).and_then(|i| positions.get(i)).ok_or_else(|| fault("an index is out of range"))?;
            let (words, _) = bytes.as_chunks::<4>();
            let [x, y, z] = [words[0], words[1], words[2]].map(|w| f64::from(f32::from_le_bytes(w)));
            let point = to_ours(DVec3::new(x, y, z));
            if point.is_finite() { Ok(point) } else { Err(fault("a position is not a finite number")) }
        };
        (0..count / 3).map(|t| Ok([corner(3 * t)?, corner(3 * t + 1)?, corner(3 * t + 2)?])).collect()
    }
}
