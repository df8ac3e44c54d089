//! The whole mesh of an antenna: the block, and the air around it up to a sphere.
//!
//! The block's skin and the sphere bound the air, which is filled by itself; the block's own vertices only help to
//! recover the skin. Where an edge of the skin had to be halved, the block's tetrahedra at it are halved too. Then both
//! are put together, and the tetrahedra of conductors are left out.

use super::block::{Block, BlockError};
use super::error::TetError;
use super::fill::{Filled, fill};
use super::mesh::{MarkedFace, Tet, TetMesh, face_key};
use super::recover::{EdgeSplit, RecoveryReport};
use super::sizing::{Sizing, SizingSettings};
use super::sphere::sphere;
use super::surface::{Surface, SurfaceFacet};
use crate::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use crate::task::Task;
use std::collections::{HashMap, HashSet};

/// Number of the air among a block's regions.
const AIR_ID: usize = 1;

/// The air around an antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirSettings {
    /// Radius of the outer sphere about the middle of the antenna's bounding box, m.
    pub radius: f64,
    /// Edge lengths.
    pub sizing: SizingSettings,
}

/// Why an antenna cannot be meshed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EncloseError {
    /// The sphere would cut the antenna.
    #[error("the outer sphere of radius {radius_mm:.3} mm does not hold the antenna: it must be more than {needed_mm:.3} mm", radius_mm = radius * 1e3, needed_mm = needed * 1e3)]
    Radius {
        /// The radius, m.
        radius: f64,
        /// Smallest radius, m.
        needed: f64,
    },
    /// The air cannot be meshed.
    #[error(transparent)]
    Air(#[from] TetError),
    /// The antenna itself cannot be meshed.
    #[error(transparent)]
    Block(#[from] BlockError),
}

/// The mesh of an antenna in air.
#[derive(Clone, Debug)]
pub struct Enclosed {
    /// The mesh.
    pub mesh: TetMesh,
    /// For each resistor a chain of edges through the substrate: its vertices from the ground up to the patch.
    pub posts: Vec<Vec<VertexId>>,
    /// What it took to recover the antenna's skin.
    pub recovery: RecoveryReport,
    /// The edge lengths that were wanted.
    pub sizing: Sizing,
}

/// Meshes the air around a block and puts both together.
///
/// # Errors
/// [`EncloseError`].
pub fn enclose(block: &Block, settings: &AirSettings, task: &Task) -> Result<Enclosed, EncloseError> {
    let hull = Hull::new(block, settings)?;
    let filled = fill(&hull.surface, &hull.inner, settings.sizing, task)?;
    let (mesh, posts) = merge(block, &hull, &filled);
    Ok(Enclosed { mesh, posts, recovery: filled.recovery, sizing: filled.sizing })
}

/// The surface of the air, and which of its vertices is which of the block's.
struct Hull {
    surface: Surface,
    /// Vertices of the block on its skin, by vertex of the surface.
    on_skin: Vec<VertexId>,
    /// The block's other vertices, m.
    inner: Vec<DVec3>,
}

impl Hull {
    fn new(block: &Block, settings: &AirSettings) -> Result<Self, EncloseError> {
        let skin = block.skin();
        let mut number = vec![VertexId::NONE; block.vertices.len()];
        skin.iter().flatten().for_each(|v| number[v.index()] = VertexId::default());
        let mut on_skin = Vec::new();
        let mut inner = Vec::new();
        for (v, number) in number.iter_mut().enumerate() {
            if *number == VertexId::NONE {
                inner.push(block.vertices[v]);
            } else {
                *number = VertexId::new(on_skin.len());
                on_skin.push(VertexId::new(v));
            }
        }
        let mut vertices: Vec<DVec3> = on_skin.iter().map(|v| block.vertices[v.index()]).collect();
        let (lo, hi) =
            vertices.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let center = (lo + hi) / 2.0;
        let needed = vertices.iter().map(|p| p.distance(center)).fold(0.0, f64::max) + settings.sizing.h_max;
        if settings.radius.is_nan() || settings.radius <= needed {
            return Err(EncloseError::Radius { radius: settings.radius, needed });
        }
        let (sphere_points, sphere_faces) = sphere(center, settings.radius, settings.sizing.h_max);
        let n_skin = vertices.len();
        vertices.extend(sphere_points);
        let (outside, air, inside) = (RegionId::new(0), RegionId::new(AIR_ID), RegionId::new(AIR_ID + 1));
        let outer = block.groups.iter().position(|g| g.role == super::FaceRole::Outer);
        let of_skin = skin.iter().map(|f| SurfaceFacet {
            vertices: f.map(|v| number[v.index()]),
            back: inside,
            front: air,
            group: None,
        });
        let of_sphere = sphere_faces.iter().map(|f| SurfaceFacet {
            vertices: f.map(|v| VertexId::new(n_skin + v)),
            back: air,
            front: outside,
            group: outer,
        });
        let facets = of_skin.chain(of_sphere).collect();
        // What the block is made of does not matter to the air: it is not filled.
        let block_region =
            Region { name: "block".to_owned(), role: RegionRole::Conductor, ..block.regions[AIR_ID].clone() };
        let regions = block.regions[..=AIR_ID].iter().cloned().chain([block_region]).collect();
        Ok(Self { surface: Surface { vertices, facets, regions, groups: block.groups.clone() }, on_skin, inner })
    }
}

/// One mesh of the block's cells and the air's, and the block's chains of edges in it.
fn merge(block: &Block, hull: &Hull, filled: &Filled) -> (TetMesh, Vec<Vec<VertexId>>) {
    // Every vertex of the air in the numbering of the block, new ones after it.
    let mut number = vec![VertexId::NONE; filled.mesh.vertices.len()];
    for (v, in_block) in hull.on_skin.iter().enumerate() {
        number[filled.vertex_of[v].index()] = *in_block;
    }
    let mut vertices = block.vertices.clone();
    for (v, number) in number.iter_mut().enumerate().filter(|(_, n)| **n == VertexId::NONE) {
        *number = VertexId::new(vertices.len());
        vertices.push(filled.mesh.vertices[v]);
    }
    let in_mesh = |v: VertexId| number[v.index()];
    let mut cells = Cells { tets: block.tets.clone(), faces: block.faces.clone() };
    let n_surface = hull.surface.vertices.len();
    for (k, split) in filled.recovery.splits.iter().enumerate() {
        // Ends and middle are numbered as the surface's vertices; middles follow them.
        let middle = in_mesh(filled.vertex_of[n_surface + k]);
        let end = |v: VertexId| {
            let earlier = filled.recovery.splits.iter().position(|s| s.middle == v);
            in_mesh(filled.vertex_of[earlier.map_or(v.index(), |e| n_surface + e)])
        };
        cells.halve(&EdgeSplit { ends: split.ends.map(end), middle });
    }
    let of_air = filled.mesh.tets.iter().map(|t| Tet { vertices: t.vertices.map(in_mesh), region: t.region });
    let is_kept = |t: &Tet| block.regions[t.region.index()].role != RegionRole::Conductor;
    let tets: Vec<Tet> = cells.tets.into_iter().filter(is_kept).chain(of_air).collect();
    let of_air = filled.mesh.faces.iter().map(|f| MarkedFace { vertices: f.vertices.map(in_mesh), ..*f });
    let present: HashSet<_> = tets.iter().flat_map(|t| (0..4).map(|i| face_key(t.face(i)))).collect();
    // A face between two conductors bounds nothing.
    let faces = cells.faces.into_iter().chain(of_air).filter(|f| present.contains(&face_key(f.vertices))).collect();
    let mesh = TetMesh { vertices, tets, faces, regions: block.regions.clone(), groups: block.groups.clone() };
    compact(mesh, &block.posts)
}

/// The block's cells while edges are halved.
struct Cells {
    tets: Vec<Tet>,
    faces: Vec<MarkedFace>,
}

impl Cells {
    /// Halves every tetrahedron and marked face at an edge.
    fn halve(&mut self, split: &EdgeSplit) {
        let has_edge = |vertices: &[VertexId]| split.ends.iter().all(|e| vertices.contains(e));
        let moved = |v: VertexId, end: VertexId| if v == end { split.middle } else { v };
        for t in 0..self.tets.len() {
            let tet = self.tets[t];
            if has_edge(&tet.vertices) {
                let [p, q] = split.ends.map(|end| Tet { vertices: tet.vertices.map(|v| moved(v, end)), ..tet });
                self.tets[t] = p;
                self.tets.push(q);
            }
        }
        for f in 0..self.faces.len() {
            let face = self.faces[f];
            if has_edge(&face.vertices) {
                let [p, q] =
                    split.ends.map(|end| MarkedFace { vertices: face.vertices.map(|v| moved(v, end)), ..face });
                self.faces[f] = p;
                self.faces.push(q);
            }
        }
    }
}

/// Leaves out vertices that no tetrahedron uses; gives the new numbers of chains of those that one does.
fn compact(mesh: TetMesh, chains: &[Vec<VertexId>]) -> (TetMesh, Vec<Vec<VertexId>>) {
    let mut number: HashMap<VertexId, VertexId> = HashMap::new();
    let mut used: Vec<VertexId> = mesh.tets.iter().flat_map(|t| t.vertices).collect();
    used.sort_unstable();
    used.dedup();
    for (k, v) in used.iter().enumerate() {
        number.insert(*v, VertexId::new(k));
    }
    let new = |v: VertexId| number[&v];
    let chains = chains.iter().map(|chain| chain.iter().map(|&v| new(v)).collect()).collect();
    let mesh = TetMesh {
        vertices: used.iter().map(|v| mesh.vertices[v.index()]).collect(),
        tets: mesh.tets.iter().map(|t| Tet { vertices: t.vertices.map(new), ..*t }).collect(),
        faces: mesh.faces.iter().map(|f| MarkedFace { vertices: f.vertices.map(new), ..*f }).collect(),
        ..mesh
    };
    (mesh, chains)
}
