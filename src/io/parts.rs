//! The parts that mesh files name: a volume for each region that has cells, a surface for each group that has faces.
//!
//! A part's tag is above 0 and the same in every format: the region's number; for a group, its place after the
//! regions. No tag stands for both a volume and a surface, since some formats have one list of them.

use super::IoError;
use crate::tet::{TetMesh, face_key};
use std::collections::{BTreeSet, HashMap, HashSet};

/// The cells of a region.
pub(super) struct Volume<'a> {
    pub(super) tag: usize,
    pub(super) name: &'a str,
    /// Numbers of the tetrahedra.
    pub(super) tets: Vec<usize>,
    /// Tags of the sheets that have a face of these cells.
    pub(super) sheets: BTreeSet<usize>,
}

/// The faces of a group.
pub(super) struct Sheet<'a> {
    pub(super) tag: usize,
    pub(super) name: &'a str,
    /// Numbers of the marked faces.
    pub(super) faces: Vec<usize>,
}

/// All parts by ascending tag.
pub(super) struct Parts<'a> {
    pub(super) volumes: Vec<Volume<'a>>,
    pub(super) sheets: Vec<Sheet<'a>>,
}

impl<'a> Parts<'a> {
    /// Sorts a mesh into its parts.
    ///
    /// # Errors
    /// [`IoError::BadPartName`].
    pub(super) fn of(mesh: &'a TetMesh) -> Result<Self, IoError> {
        let regions = mesh.regions.iter().enumerate();
        let mut volumes: Vec<Volume<'a>> =
            regions.map(|(tag, r)| Volume { tag, name: &r.name, tets: Vec::new(), sheets: BTreeSet::new() }).collect();
        let groups = mesh.groups.iter().zip(volumes.len()..);
        let mut sheets: Vec<Sheet<'a>> =
            groups.map(|(g, tag)| Sheet { tag, name: &g.name, faces: Vec::new() }).collect();
        let mut sheet_of = HashMap::with_capacity(mesh.faces.len());
        for (f, face) in mesh.faces.iter().enumerate() {
            sheets[face.group].faces.push(f);
            sheet_of.insert(face_key(face.vertices), sheets[face.group].tag);
        }
        for (t, tet) in mesh.tets.iter().enumerate() {
            let volume = &mut volumes[tet.region.index()];
            volume.tets.push(t);
            volume.sheets.extend((0..4).filter_map(|i| sheet_of.get(&face_key(tet.face(i)))));
        }
        volumes.retain(|v| !v.tets.is_empty());
        sheets.retain(|s| !s.faces.is_empty());
        let parts = Self { volumes, sheets };
        let mut seen = HashSet::new();
        let mut names = parts.sheets.iter().map(|s| s.name).chain(parts.volumes.iter().map(|v| v.name));
        if let Some(name) = names.find(|name| !is_label(name) || !seen.insert(*name)) {
            return Err(IoError::BadPartName { name: name.to_owned() });
        }
        Ok(parts)
    }
}

fn is_label(name: &str) -> bool {
    (1..=127).contains(&name.len()) && !name.contains(|c: char| c.is_control() || c == '"' || c == '\'')
}
