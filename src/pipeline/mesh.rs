//! From a project to the tetrahedral mesh of its antenna in air.

use super::PipelineError;
use super::scene::Scene;
use super::solve::SolveSettings;
use super::stages::{Template, prepare};
use crate::antenna::PatchParams;
use crate::deform::{Carry, DeformError, SmoothMap, Warp};
use crate::geometry::{DVec2, DVec3, VertexId};
use crate::project::Project;
use crate::task::Task;
use crate::tet::{
    AirSettings, Block, BlockSettings, Metal, QualityReport, RecoveryReport, SizingSettings, TetMesh, block, enclose,
    quality,
};
use crate::units::{C0, from_mm};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::time::Instant;

/// Which of an antenna's shapes is meshed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Carried through the posed cage, compensated as the project says.
    #[default]
    Deformed,
    /// As drawn.
    Flat,
    /// On the exact cylinder of the project's bend.
    Cylinder,
}

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Density {
    /// For a first look.
    Coarse,
    /// For results.
    #[default]
    Default,
    /// To see what a finer mesh would change.
    Fine,
}

/// What a mesh is made like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshSettings {
    /// How fine.
    pub density: Density,
    /// What patch and ground are made of.
    pub metal: Metal,
}

/// A mesh with what is said of it.
#[derive(Clone, Debug)]
pub struct Meshed {
    /// The mesh.
    pub mesh: TetMesh,
    /// For each resistor its chain of edges through the substrate: vertices from the ground up to the patch.
    pub posts: Vec<Vec<VertexId>>,
    /// Its figures.
    pub quality: QualityReport,
    /// What it took to recover the antenna's skin.
    pub recovery: RecoveryReport,
    /// Greatest distance of the middles of the antenna's edges from the smooth map, m.
    pub map_distance: f64,
    /// Time spent, s.
    pub seconds: f64,
}

/// Smallest cells named in a report.
pub(super) const N_WORST: usize = 10;
/// Top of the band over the resonance of an ideal cavity under the patch, which lies above the patch's own.
const TOP_OVER_CAVITY: f64 = 1.2;
/// Growth of the edge length with the distance: less makes many cells, more makes long ones beside short ones.
pub(super) const GRADING: f64 = 0.35;
/// Times that the antenna is meshed finer where its edges leave the smooth map by more than the tolerance.
const RETRIES: usize = 4;

/// Edge lengths by density, as parts of the patch's length, and layers of the substrate.
pub(super) struct Fineness {
    pub(super) rim: f64,
    pub(super) inner: f64,
    pub(super) layers: usize,
    /// Edges per wavelength in air at the top of the band.
    pub(super) per_wavelength: f64,
}

impl Density {
    pub(super) fn fineness(self) -> Fineness {
        match self {
            Self::Coarse => Fineness { rim: 1.0 / 10.0, inner: 1.0 / 6.0, layers: 2, per_wavelength: 7.0 },
            Self::Default => Fineness { rim: 1.0 / 20.0, inner: 1.0 / 10.0, layers: 4, per_wavelength: 10.0 },
            Self::Fine => Fineness { rim: 1.0 / 32.0, inner: 1.0 / 16.0, layers: 6, per_wavelength: 14.0 },
        }
    }
}

/// Meshes an antenna and the air around it.
///
/// The antenna's edges follow the smooth map to the project's tolerance (at the coarse density to five times that).
///
/// # Errors
/// [`PipelineError`] naming what to change.
pub fn mesh(project: &Project, shape: Shape, settings: MeshSettings, task: &Task) -> Result<Meshed, PipelineError> {
    mesh_band(project, shape, settings, SolveSettings::usual_band(project), task)
}

/// [`mesh`] for a band, Hz; the template's mesh is made for its own resonance.
pub(super) fn mesh_band(
    project: &Project,
    shape: Shape,
    settings: MeshSettings,
    band: [f64; 2],
    task: &Task,
) -> Result<Meshed, PipelineError> {
    if let Some(bodies) = &project.bodies {
        return super::bodies::mesh((project, bodies), shape, settings, band, task);
    }
    let tolerance = from_mm(project.settings.tolerance_mm);
    match shape {
        Shape::Deformed => {
            let Template { compensated, built, .. } = prepare(project, task)?.template;
            let carry = Carry::new(&compensated.map, &compensated.warp, Scene::feed(&built))?;
            mesh_carried(&built, &carry, settings, tolerance, task)
        }
        Shape::Flat => {
            let params = project.antenna.to_params();
            mesh_map(&params, |p| Ok(p.to_vec()), settings, tolerance, task)
        }
        Shape::Cylinder => {
            let scene = Scene::new(project)?;
            let cylinder = scene.cylinder().ok_or(PipelineError::NoCylinder)?;
            let params = project.antenna.to_params();
            let identity = Warp::identity(DVec2::new(params.ground_width, params.ground_length) / 2.0);
            let carry = Carry::new(&cylinder, &identity, Scene::feed(&params))?;
            mesh_carried(&params, &carry, settings, tolerance, task)
        }
    }
}

fn mesh_carried<M: SmoothMap>(
    params: &PatchParams,
    carry: &Carry<'_, M>,
    settings: MeshSettings,
    tolerance: f64,
    task: &Task,
) -> Result<Meshed, PipelineError> {
    let positions = |flat: &[DVec3]| Ok(carry.carry(flat)?.into_iter().map(|c| c.position).collect());
    mesh_map(params, positions, settings, tolerance, task)
}

fn mesh_map(
    params: &PatchParams,
    carry: impl Fn(&[DVec3]) -> Result<Vec<DVec3>, DeformError>,
    settings: MeshSettings,
    tolerance: f64,
    task: &Task,
) -> Result<Meshed, PipelineError> {
    let started = Instant::now();
    let carry = |flat: &[DVec3]| carry(flat).map_err(PipelineError::from);
    let (block, map_distance) = fine_block(params, carry, settings, tolerance, task)?;
    let enclosed = enclose(&block, &air(params, &block, settings), task)?;
    Ok(Meshed {
        quality: quality(&enclosed.mesh, Some(&|p| enclosed.sizing.at(p).size), N_WORST),
        mesh: enclosed.mesh,
        posts: enclosed.posts,
        recovery: enclosed.recovery,
        map_distance,
        seconds: started.elapsed().as_secs_f64(),
    })
}

/// The antenna's block, finer until its edges follow the map; with how far they leave it, m.
fn fine_block(
    params: &PatchParams,
    carry: impl Fn(&[DVec3]) -> Result<Vec<DVec3>, PipelineError>,
    settings: MeshSettings,
    tolerance: f64,
    task: &Task,
) -> Result<(Block, f64), PipelineError> {
    let fineness = settings.density.fineness();
    let allowed = if settings.density == Density::Coarse { 5.0 * tolerance } else { tolerance };
    let (rim, inner) = (fineness.rim * params.length, fineness.inner * params.length);
    let mut sizes = BlockSettings { rim, inner, layers: fineness.layers, metal: settings.metal, coax: true };
    let phase = task.phase("meshing the antenna", RETRIES + 1);
    let mut attempt = 0;
    loop {
        task.check()?;
        let block = block::build(params, &sizes, &carry)?;
        let distance = map_distance(&block, &carry)?;
        phase.advance(1);
        if distance <= allowed || attempt == RETRIES {
            return Ok((block, distance));
        }
        // The distance falls with the square of the edge length.
        let part = (allowed / distance).sqrt().clamp(0.5, 0.95);
        sizes.inner *= part;
        sizes.rim = sizes.rim.min(sizes.inner);
        attempt += 1;
    }
}

/// Greatest distance of the middles of edges on the antenna's material boundaries from the images of their flat places.
fn map_distance(
    block: &Block,
    carry: impl Fn(&[DVec3]) -> Result<Vec<DVec3>, PipelineError>,
) -> Result<f64, PipelineError> {
    let faces = block.skin().into_iter().chain(block.faces.iter().map(|f| f.vertices));
    let of_face = |[a, b, c]: [VertexId; 3]| [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]);
    let edges: BTreeSet<[VertexId; 2]> = faces.flat_map(of_face).collect();
    let middle = |points: &[DVec3], [a, b]: &[VertexId; 2]| points[a.index()].midpoint(points[b.index()]);
    let flat: Vec<DVec3> = edges.iter().map(|e| middle(&block.flat, e)).collect();
    let images = carry(&flat)?;
    Ok(edges.iter().zip(images).map(|(e, p)| middle(&block.vertices, e).distance(p)).fold(0.0, f64::max))
}

/// First resonance of an ideal cavity under the patch, Hz.
fn cavity(params: &PatchParams) -> f64 {
    C0 / (2.0 * params.length * params.substrate.eps_r.sqrt())
}

/// Longest edges in the air, m: a tenth or so of the wavelength at the top of the band.
pub(super) fn longest_air_edge(params: &PatchParams, density: Density) -> f64 {
    C0 / (TOP_OVER_CAVITY * cavity(params)) / density.fineness().per_wavelength
}

/// The air: half a wavelength of room.
fn air(params: &PatchParams, block: &Block, settings: MeshSettings) -> AirSettings {
    let h_max = longest_air_edge(params, settings.density);
    let (lo, hi) =
        block.vertices.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let center = (lo + hi) / 2.0;
    let reach = block.vertices.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
    AirSettings { radius: reach + C0 / cavity(params) / 2.0, sizing: SizingSettings { h_max, grading: GRADING } }
}
