//! A mesh cut open: the surface of those cells that are kept.
//!
//! A [`TetMesh`] enters once; neighbors and centers are noted. From then on any choice of cells gives the faces that
//! exactly one of them has: whole cells stay or go, nothing is cut through (a "crinkle" cut). That is one look at each
//! face of the kept cells, so that a plane can be moved while one watches.
//!
//! The surface is closed and its faces are counter-clockwise seen from outside: each edge is run through as often in
//! one direction as in the other. Where kept cells touch at an edge alone, four faces or more meet there. NOT handled:
//! faces between two kept cells, such as a conducting sheet inside; they are not seen from outside.

use super::TetMesh;
use super::mesh::face_key;
use crate::geometry::{DVec3, VertexId};
use rayon::prelude::*;

/// Stands for no cell and no group.
const NONE: u32 = u32::MAX;

/// A face of the surface of the kept cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutFace {
    /// Corners, counter-clockwise seen from outside.
    pub vertices: [VertexId; 3],
    /// The kept cell behind it.
    pub tet: usize,
    /// Its group of marked faces, where it has one: an index into [`TetMesh::groups`].
    pub group: Option<usize>,
}

/// What lies across a face of a cell.
#[derive(Clone, Copy, Debug)]
struct Across {
    tet: u32,
    group: u32,
}

/// A mesh prepared for being cut open.
#[derive(Clone, Debug)]
pub struct Cutaway {
    across: Vec<[Across; 4]>,
    centers: Vec<DVec3>,
}

impl Cutaway {
    /// Notes the neighbors and centers of a valid mesh's cells.
    ///
    /// # Panics
    /// If the mesh has 2^32 - 1 cells or more.
    #[must_use]
    pub fn new(mesh: &TetMesh) -> Self {
        let number = |index: usize| u32::try_from(index).ok().filter(|n| *n != NONE).expect("fewer than 2^32 cells");
        let faces = (0..mesh.tets.len())
            .into_par_iter()
            .flat_map_iter(|t| (0..4).map(move |i| (face_key(mesh.tets[t].face(i)), number(t), i)));
        let mut faces: Vec<([VertexId; 3], u32, usize)> = faces.collect();
        faces.par_sort_unstable();
        let mut across = vec![[Across { tet: NONE, group: NONE }; 4]; mesh.tets.len()];
        for pair in faces.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let [(_, s, i), (_, t, k)] = [pair[0], pair[1]];
            across[s as usize][i].tet = t;
            across[t as usize][k].tet = s;
        }
        for face in &mesh.faces {
            let key = face_key(face.vertices);
            let first = faces.partition_point(|f| f.0 < key);
            for &(_, t, i) in faces[first..].iter().take_while(|f| f.0 == key) {
                across[t as usize][i].group = number(face.group);
            }
        }
        let center = |t: usize| mesh.corners(t).iter().sum::<DVec3>() / 4.0;
        Self { across, centers: (0..mesh.tets.len()).into_par_iter().map(center).collect() }
    }

    /// Centers of the cells, m.
    #[must_use]
    pub fn centers(&self) -> &[DVec3] {
        &self.centers
    }

    /// The surface of the cells that `keep` names by number, in their order. `mesh` is the one prepared.
    ///
    /// # Panics
    /// If the mesh has another number of cells.
    #[must_use]
    pub fn faces(&self, mesh: &TetMesh, keep: impl Fn(usize) -> bool) -> Vec<CutFace> {
        assert_eq!(mesh.tets.len(), self.across.len(), "the mesh is the one prepared");
        let kept: Vec<bool> = (0..self.across.len()).map(keep).collect();
        let mut faces = Vec::new();
        for (t, sides) in self.across.iter().enumerate().filter(|(t, _)| kept[*t]) {
            for (i, side) in sides.iter().enumerate() {
                if side.tet == NONE || !kept[side.tet as usize] {
                    let group = (side.group != NONE).then_some(side.group as usize);
                    faces.push(CutFace { vertices: mesh.tets[t].face(i), tet: t, group });
                }
            }
        }
        faces
    }
}

/// The edges of a closed surface, from the smaller to the larger vertex: once for each pair of faces that meet there.
pub fn edges(faces: &[CutFace]) -> impl Iterator<Item = [VertexId; 2]> {
    let sides = faces.iter().flat_map(|f| {
        let [a, b, c] = f.vertices;
        [[a, b], [b, c], [c, a]]
    });
    sides.filter(|[from, to]| from < to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Region, RegionId, RegionRole};
    use crate::tet::{FaceGroup, FaceRole, MarkedFace, Tet, volume};
    use std::collections::HashMap;

    /// A block of n x n x n cubes of six cells each, region 1 below half its height and 2 above; the faces between the
    /// two conduct.
    fn block(n: usize) -> TetMesh {
        let number = |p: [usize; 3]| VertexId::new(p[0] + (n + 1) * (p[1] + (n + 1) * p[2]));
        let steps = |k: usize| [k % (n + 1), k / (n + 1) % (n + 1), k / (n + 1).pow(2)];
        #[allow(clippy::cast_precision_loss, reason = "small counts")]
        let vertices: Vec<DVec3> = (0..(n + 1).pow(3)).map(|k| DVec3::from_array(steps(k).map(|s| s as f64))).collect();
        let mut tets = Vec::new();
        for cube in 0..n.pow(3) {
            let low = [cube % n, cube / n % n, cube / n.pow(2)];
            let region = RegionId::new(if 2 * low[2] < n { 1 } else { 2 });
            for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
                let mut at = low;
                let mut path = [number(low); 4];
                for (k, axis) in axes.into_iter().enumerate() {
                    at[axis] += 1;
                    path[k + 1] = number(at);
                }
                if volume(path.map(|v| vertices[v.index()])) < 0.0 {
                    path.swap(1, 2);
                }
                tets.push(Tet { vertices: path, region });
            }
        }
        let region =
            |name: &str| Region { name: name.into(), role: RegionRole::Dielectric, eps_r: 1.0, tan_delta: 0.0 };
        let groups = vec![FaceGroup { name: "sheet".into(), role: FaceRole::Conductor }];
        let regions = ["outside", "low", "high"].map(region).to_vec();
        let mut mesh = TetMesh { vertices, tets, faces: Vec::new(), regions, groups };
        #[allow(clippy::cast_precision_loss, reason = "small counts")]
        let middle = (n - n / 2) as f64;
        let is_level = |f: &[VertexId; 3]| f.iter().all(|v| (mesh.vertices[v.index()].z - middle).abs() < 1e-9);
        let below = mesh.tets.iter().filter(|t| t.region.index() == 1);
        let sheet = below.flat_map(|t| [0, 1, 2, 3].map(|i| t.face(i))).filter(is_level);
        mesh.faces = sheet.map(|vertices| MarkedFace { vertices, group: 0 }).collect();
        mesh
    }

    /// Each edge is run through as often in one direction as in the other, and the edges are listed once for each pair.
    fn check_closed(faces: &[CutFace], what: &str) {
        let mut balance: HashMap<[VertexId; 2], (i32, u32)> = HashMap::new();
        for face in faces {
            let [a, b, c] = face.vertices;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let seen = balance.entry([from.min(to), from.max(to)]).or_default();
                seen.0 += if from < to { 1 } else { -1 };
                seen.1 += 1;
            }
        }
        let open = balance.iter().find(|(_, (sum, count))| *sum != 0 || count % 2 != 0);
        assert_eq!(open, None, "{what}: closed");
        assert_eq!(2 * edges(faces).count(), 3 * faces.len(), "{what}: an edge for each pair of faces");
    }

    #[test]
    fn the_whole_mesh_shows_its_hull() {
        let n = 4;
        let mesh = block(n);
        assert_eq!(mesh.faces.len(), 2 * n * n, "the sheet");
        let cut = Cutaway::new(&mesh);
        let faces = cut.faces(&mesh, |_| true);
        assert_eq!(faces.len(), 6 * 2 * n * n, "two triangles for each square of the hull");
        assert!(faces.iter().all(|f| f.group.is_none()), "the sheet is inside");
        check_closed(&faces, "hull");
        let center = DVec3::splat(2.0);
        for face in &faces {
            let [a, b, c] = face.vertices.map(|v| mesh.vertices[v.index()]);
            assert!((b - a).cross(c - a).dot(a - center) > 0.0, "outward at {a}");
        }
        assert!(cut.faces(&mesh, |_| false).is_empty(), "nothing kept, nothing shown");
    }

    #[test]
    fn half_a_mesh_shows_the_sheet_between() {
        let n = 4;
        let mesh = block(n);
        let cut = Cutaway::new(&mesh);
        for region in [1, 2] {
            let faces = cut.faces(&mesh, |t| mesh.tets[t].region.index() == region);
            assert_eq!(faces.len(), 2 * (2 * n * n + 4 * n * n / 2), "two squares and four halves");
            let marked = faces.iter().filter(|f| f.group == Some(0)).count();
            assert_eq!(marked, 2 * n * n, "the sheet is seen from the side of region {region}");
            check_closed(&faces, "half");
        }
    }

    #[test]
    fn any_choice_of_cells_has_a_closed_surface() {
        let mesh = block(3);
        let cut = Cutaway::new(&mesh);
        let mut rng = fastrand::Rng::with_seed(5);
        for case in 0..50 {
            let kept: Vec<bool> = mesh.tets.iter().map(|_| rng.bool()).collect();
            let faces = cut.faces(&mesh, |t| kept[t]);
            assert!(faces.iter().all(|f| kept[f.tet]), "of kept cells");
            check_closed(&faces, &format!("case {case}"));
            let flux = |f: &CutFace| {
                let [a, b, c] = f.vertices.map(|v| mesh.vertices[v.index()]);
                a.dot(b.cross(c)) / 6.0
            };
            let enclosed: f64 = faces.iter().map(flux).sum();
            let cells: f64 = (0..kept.len()).filter(|&t| kept[t]).map(|t| volume(mesh.corners(t))).sum();
            assert!((enclosed - cells).abs() < 1e-9, "case {case}: encloses {enclosed}, cells have {cells}");
        }
    }

    #[test]
    fn a_single_cell_shows_its_four_faces() {
        let mesh = block(2);
        let cut = Cutaway::new(&mesh);
        let faces = cut.faces(&mesh, |t| t == 17);
        assert_eq!(faces.iter().map(|f| f.vertices).collect::<Vec<_>>(), [0, 1, 2, 3].map(|i| mesh.tets[17].face(i)));
        let center = mesh.corners(17).iter().sum::<DVec3>() / 4.0;
        assert!(cut.centers()[17].distance(center) < 1e-12, "its center");
    }
}
