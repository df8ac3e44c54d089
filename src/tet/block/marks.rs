//! Which faces of the block carry a boundary condition.

use super::footprint::{Cover, Footprint};
use super::layers::Layers;
use super::prisms::Split;
use super::{COAX_ID, GROUND_ID, PATCH_ID, PIN_ID};
use crate::geometry::{RegionId, VertexId};
use crate::tet::{FaceGroup, FaceRole, MarkedFace, Tet, face_key};
use std::collections::HashMap;

/// Numbers of the groups, in the order of [`groups`].
const PATCH: usize = 0;
const GROUND: usize = 1;
const FEED: usize = 2;
const PORT: usize = 3;

/// The groups of a mesh around the block, always all of them.
pub(super) fn groups() -> Vec<FaceGroup> {
    let group = |name: &str, role| FaceGroup { name: name.to_owned(), role };
    vec![
        group("pec_patch", FaceRole::Conductor),
        group("pec_ground", FaceRole::Conductor),
        group("pec_feed", FaceRole::Conductor),
        group("port1", FaceRole::Port),
        group("outer", FaceRole::Outer),
    ]
}

/// Each face of some tetrahedra, by the first (tetrahedron, face number) that has it and the second if there is one.
pub(super) type FaceTable = HashMap<[VertexId; 3], ((usize, usize), Option<(usize, usize)>)>;

/// Pairs the faces of tetrahedra.
pub(super) fn face_table(tets: &[Tet]) -> FaceTable {
    let mut table = FaceTable::with_capacity(2 * tets.len() + tets.len() / 5);
    for (t, tet) in tets.iter().enumerate() {
        for i in 0..4 {
            table.entry(face_key(tet.face(i))).and_modify(|e| e.1 = Some((t, i))).or_insert(((t, i), None));
        }
    }
    table
}

/// Marks the faces of conductors and of the port, in the order of the tetrahedra; `planes` has the plane of each vertex.
pub(super) fn mark(split: &Split, planes: &[usize], print: &Footprint, layers: &Layers) -> Vec<MarkedFace> {
    let table = face_table(&split.tets);
    let mut marked = Vec::new();
    for (t, tet) in split.tets.iter().enumerate() {
        for i in 0..4 {
            let vertices = tet.face(i);
            let Some(&(first, second)) = table.get(&face_key(vertices)) else { continue };
            // A face between two tetrahedra comes up twice and is decided at that with the conductor, if there is one.
            let other = if first == (t, i) { second } else { Some(first) };
            let beyond = other.map(|(s, _)| split.tets[s].region);
            let [a, b, c] = vertices.map(|v| planes[v.index()]);
            let plane = (a == b && b == c).then_some(a);
            let cover = print.covers[split.triangle[t]];
            let group = match (sheet(layers, plane, cover), conductor(tet.region)) {
                (Some(group), _) => Some(group),
                (None, Some(group)) => beyond.and_then(conductor).is_none().then_some(group),
                // The end of the sheath and, below the ground, its sleeve.
                (None, None) if tet.region.index() == COAX_ID && beyond.is_none() => {
                    Some(if plane == Some(0) { PORT } else { FEED })
                }
                (None, None) => None,
            };
            marked.extend(group.map(|group| MarkedFace { vertices, group }));
        }
    }
    marked
}

/// The group of a face in the plane of a sheet. Sheets lie on the block's skin, so their faces come up once.
fn sheet(layers: &Layers, plane: Option<usize>, cover: Cover) -> Option<usize> {
    if !layers.has_sheets() {
        return None;
    }
    if plane == Some(layers.patch_plane) && cover.patch {
        Some(PATCH)
    } else if plane == Some(layers.ground_plane) && !cover.pin && !cover.sheath {
        Some(GROUND)
    } else {
        None
    }
}

/// The group of a conducting region's faces.
fn conductor(region: RegionId) -> Option<usize> {
    match region.index() {
        PATCH_ID => Some(PATCH),
        GROUND_ID => Some(GROUND),
        PIN_ID => Some(FEED),
        _ => None,
    }
}
