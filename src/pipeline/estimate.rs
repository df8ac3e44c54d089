//! What a run will take, before it starts.
//!
//! Counts rather than meshes: the antenna's footprint in triangles of the wanted edges (finer where the map's curvature
//! asks for it, sampled at some hundred places), times the layers; the air as what grows from that surface and what
//! fills the sphere. The time step follows the smallest edges, and the time until the field has decayed the patch's
//! quality factor by the cavity model. The factors are fitted to meshes of the paper's antenna at the three densities.
//! No compensation is computed: an isometric bend counts as its exact cylinder, all else as uncompensated.
//!
//! Source of the quality factor: \[BAL16\] section 14.2 (bandwidth of a rectangular patch).

use super::PipelineError;
use super::bodies_edges::{edges, thinnest};
use super::mesh::{Density, Shape, longest_air_edge};
use super::scene::Scene;
use super::solve::{SolveSettings, StopRule};
use crate::antenna::PatchParams;
use crate::deform::SmoothMap;
use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{DVec2, DVec3, RegionRole};
use crate::project::{BodiesSpec, CompensationMode, Project};
use crate::tlm::Pulse;
use crate::units::{C0, from_mm};
use std::f64::consts::{LN_10, PI};

/// What a run will take, within about a fifth in cells and a half in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Number of cells.
    pub n_tets: usize,
    /// Time step, s.
    pub dt: f64,
    /// Steps until the stop rule is met.
    pub n_steps: usize,
    /// Memory, bytes.
    pub bytes: usize,
    /// Time of meshing and solving, s.
    pub seconds: f64,
}

impl Estimate {
    /// * `dt`: time step, s; `speed`: cells times steps per second.
    fn new(n_tets: f64, dt: f64, n_steps: f64, speed: f64) -> Self {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, and saturating")]
        let count = |x: f64| x as usize;
        Self {
            n_tets: count(n_tets),
            dt,
            n_steps: count(n_steps),
            bytes: count(BYTES_PER_TET * n_tets),
            seconds: n_tets * (n_steps / speed.max(1.0) + SECONDS_PER_TET),
        }
    }
}

/// Triangles along a unit of outline, in edges of the rim.
const RIM_TRIANGLES: f64 = 3.75;
/// Tetrahedra of air that grow from a triangle of the antenna's footprint, both sides together.
const AIR_PER_TRIANGLE: f64 = 27.0;
/// Part of the sphere that edges of full length fill.
const FILLED: f64 = 0.4;
/// How much shorter edges become than their curvature alone asks for.
const SHORTENED: f64 = 0.87;
/// Path of light in a time step over the shortest edges of substrate and pin.
const STEP_OVER_LAYER: f64 = 0.127;
const STEP_OVER_PIN: f64 = 0.165;
/// The same for imported bodies: over the edges at rims of metal, and over the thickness of the thinnest body.
const STEP_OVER_RIM: f64 = 0.15;
const STEP_OVER_SIDE: f64 = 0.25;
/// Bytes for each cell: coefficients and state of the field, and the mesh beside them.
const BYTES_PER_TET: f64 = 800.0;
/// Meshing and preparing one cell, s.
const SECONDS_PER_TET: f64 = 20e-6;
/// Places along each side of the ground where the map's curvature is sampled.
const PLACES: usize = 9;

/// Estimates what a run will take; takes some milliseconds.
///
/// * `speed`: cells times steps per second, as earlier runs had.
///
/// # Errors
/// [`PipelineError`] if the project cannot be posed.
pub fn estimate(
    project: &Project,
    shape: Shape,
    settings: &SolveSettings,
    speed: f64,
) -> Result<Estimate, PipelineError> {
    if let Some(bodies) = &project.bodies {
        return estimate_bodies(bodies, settings, speed);
    }
    let [lo, hi] = settings.band;
    let pulse = Pulse::new(lo, hi)?;
    let params = project.antenna.to_params();
    params.validate().map_err(crate::antenna::PatchError::from)?;
    let (curvature, reach) = sampled(project, shape, &params)?;
    let fineness = settings.mesh.density.fineness();
    let tolerance = from_mm(project.settings.tolerance_mm);
    let allowed = if settings.mesh.density == Density::Coarse { 5.0 * tolerance } else { tolerance };
    let inner = (fineness.inner * params.length).min(SHORTENED * (8.0 * allowed / curvature.max(1e-9)).sqrt());
    let rim = (fineness.rim * params.length).min(inner);
    let outline = params.perimeter() + 2.0 * (params.ground_width + params.ground_length);
    let triangles =
        params.ground_width * params.ground_length / (0.433 * inner * inner) + RIM_TRIANGLES * outline / rim;
    let sphere = 4.0 / 3.0 * PI * reach.powi(3) / (0.118 * longest_air_edge(&params, settings.mesh.density).powi(3));
    let n_tets = triangles * (3.0 * fineness.layers as f64 + AIR_PER_TRIANGLE) + FILLED * sphere;
    let pin = 2.0 * PI * params.pin_radius / params.pin_segments as f64;
    let layer = rim.min(params.height / fineness.layers as f64);
    let dt = (STEP_OVER_LAYER * layer).min(STEP_OVER_PIN * pin) / C0;
    let time = duration(&params, settings, &pulse);
    Ok(Estimate::new(n_tets, dt, time / dt, speed))
}

/// A rough guess for imported bodies, flat or bent: cells within a factor of two, time of three.
fn estimate_bodies(bodies: &BodiesSpec, settings: &SolveSettings, speed: f64) -> Result<Estimate, PipelineError> {
    bodies.feed.ok_or(PipelineError::NoFeed)?;
    let [lo, hi] = settings.band;
    let pulse = Pulse::new(lo, hi)?;
    let edges = edges(bodies, settings.mesh, settings.band);
    let edge = f64::midpoint(edges.sizes.inner, edges.sizes.at_metal);
    let plc = bodies.to_plc();
    let area: f64 = (0..plc.facets.len()).map(|f| doubled_area_vector(plc.corners(f)).length() / 2.0).sum();
    let (low, high) = bodies.bounds();
    let reach = (high - low).length() / 2.0 + C0 / (lo + hi);
    let sphere = 4.0 / 3.0 * PI * reach.powi(3) / (0.118 * edges.in_air.powi(3));
    // Outlines of metal as if all were plates along the axes.
    let metal = plc.solids().filter(|(_, r)| r.role == RegionRole::Conductor);
    let outlines: f64 = metal
        .map(|(id, _)| {
            let (lo, hi) = plc.boundary(id).bounds();
            2.0 * ((hi - lo).element_sum() - (hi - lo).min_element())
        })
        .sum();
    let triangles = area / (2.0 * 0.433 * edge * edge) + RIM_TRIANGLES * outlines / edges.sizes.at_metal;
    let n_tets = AIR_PER_TRIANGLE * triangles + FILLED * sphere;
    let shortest = (STEP_OVER_RIM * edges.sizes.at_metal).min(STEP_OVER_SIDE * thinnest(bodies, &edges));
    let dt = shortest / C0;
    let time = (pulse.end() + 10.0 / lo).min(settings.longest);
    Ok(Estimate::new(n_tets, dt, time / dt, speed))
}

/// Greatest curvature of the antenna's sheets, 1/m, and the radius of the sphere around it, m.
fn sampled(project: &Project, shape: Shape, params: &PatchParams) -> Result<(f64, f64), PipelineError> {
    let half_wave = params.length * params.substrate.eps_r.sqrt();
    let half = DVec2::new(params.ground_width, params.ground_length) / 2.0;
    let step = half.min_element() / 8.0;
    let at = |k: usize| 2.0 * k as f64 / (PLACES - 1) as f64 - 1.0;
    let inside = half - DVec2::splat(step);
    let planes = [params.ground_bottom(), 0.0];
    let centers = planes.into_iter().flat_map(|z| {
        (0..PLACES * PLACES).map(move |k| (inside * DVec2::new(at(k / PLACES), at(k % PLACES))).extend(z))
    });
    let around = [DVec3::ZERO, DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y];
    let flat: Vec<DVec3> = centers.flat_map(|c| around.map(|d| c + d * step)).collect();
    let images = match shape {
        Shape::Flat => flat,
        Shape::Cylinder => Scene::new(project)?.cylinder().ok_or(PipelineError::NoCylinder)?.positions(&flat)?,
        Shape::Deformed => {
            let scene = Scene::new(project)?;
            let cylinder = scene.cylinder().filter(|_| project.settings.compensation == CompensationMode::Isometric);
            match cylinder {
                Some(cylinder) => cylinder.positions(&flat)?,
                None => scene.map(&scene.checked_pose()?)?.positions(&flat)?,
            }
        }
    };
    let bend = |p: &[DVec3], a: usize| p[0].distance(p[a].midpoint(p[a + 1]));
    let curvature =
        images.chunks_exact(around.len()).map(|p| bend(p, 1).max(bend(p, 3))).fold(0.0, f64::max) * 2.0 / (step * step);
    let (lo, hi) = images.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    // The coaxial line hangs below.
    let lo = lo - DVec3::Z * (params.ground_bottom() - params.port_plane());
    Ok((curvature, (hi - lo).length() / 2.0 + half_wave))
}

/// Time until the stop rule is met, s.
fn duration(params: &PatchParams, settings: &SolveSettings, pulse: &Pulse) -> f64 {
    let db = match settings.stop {
        StopRule::Decay { db } => db,
        // Where the modes of the late record begin to be seen well.
        StopRule::Settled { .. } => 30.0,
    };
    let cavity = C0 / (2.0 * params.length * params.substrate.eps_r.sqrt());
    let freq = 0.85 * cavity;
    let eps_r = params.substrate.eps_r;
    let contrast = ((eps_r - 1.0) / (eps_r * eps_r)).max(0.1);
    let bandwidth = 3.77 * contrast * params.width / params.length * params.height * freq / C0;
    // Matched, half of the power leaves through the line.
    let loaded_q = 1.0 / bandwidth / 2.0_f64.sqrt() / 2.0;
    let decay = db / 20.0 * LN_10 * loaded_q / (PI * freq);
    let earliest = pulse.end() + 1.0 / settings.band[0];
    (0.7 * pulse.end() + decay).max(earliest).min(settings.longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{MeshSettings, mesh};
    use crate::project::{BendPlane, PresetEntry, PresetSpec, RuleSpec};
    use crate::task::Task;

    #[test]
    fn cells_are_estimated_within_a_fifth() {
        let preset =
            PresetSpec::Bend { plane: BendPlane::E, radius_mm: 6.5, rule: RuleSpec::Tangent, kept_plane_mm: 0.0 };
        let bent = Project { presets: vec![PresetEntry { enabled: true, preset }], ..Project::default() };
        let settings = |density| SolveSettings::new(MeshSettings { density, ..MeshSettings::default() }, [8e9, 16e9]);
        // Numbers of cells of the three densities, flat and on the cylinder, as meshed once.
        let known = [
            (&Project::default(), Shape::Flat, [50_112, 134_710, 320_268]),
            (&bent, Shape::Cylinder, [48_751, 179_126, 307_986]),
            (&bent, Shape::Deformed, [48_457, 175_967, 310_356]),
        ];
        for (project, shape, counts) in known {
            for (density, count) in [Density::Coarse, Density::Default, Density::Fine].into_iter().zip(counts) {
                let found = estimate(project, shape, &settings(density), 50e6).expect("can be posed");
                let error = found.n_tets as f64 / f64::from(count) - 1.0;
                assert!(error.abs() < 0.2, "{shape:?} {density:?}: {error:+.3} of {count}, {found:?}");
            }
        }
        let coarse = settings(Density::Coarse);
        let meshed = mesh(&bent, Shape::Cylinder, coarse.mesh, &Task::default()).expect("can be meshed");
        let found = estimate(&bent, Shape::Cylinder, &coarse, 50e6).expect("can be posed");
        assert!((found.n_tets as f64 / meshed.mesh.tets.len() as f64 - 1.0).abs() < 0.2, "and as meshed now");
        assert!(estimate(&Project::default(), Shape::Cylinder, &coarse, 50e6).is_err(), "there is no cylinder");
    }
}
