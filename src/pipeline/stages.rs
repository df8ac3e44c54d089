//! The stages of the whole job, and their result.

use super::PipelineError;
use super::fields::{Columns, Fields};
use super::marks::{Mark, marks, source_mark};
use super::scene::Scene;
use crate::antenna::{PATCH, PatchParams, Resistor, flat_complex};
use crate::cage::Cage;
use crate::deform::{
    Carry, DeformError, GreenCage, GreenWeights, Image, Placement, Pose, SmoothMap, SplitSettings, SplitSurface, Warp,
    split,
};
use crate::distortion::{
    Compensated, CompensationError, CompensationStep, Figures, IsometricProblem, Scope, Sheet, WlProblem,
    compensate_isometric, compensate_wl, measure,
};
use crate::geometry::{DVec2, DVec3, Plc, RegionId, TriMesh, intersect};
use crate::project::{BodiesSpec, CompensationMode, Project, ScopeSpec};
use crate::task::Task;
use crate::units::{from_mm, to_mm};
use std::sync::Arc;
use std::time::Instant;

/// The deformed antenna with all that is shown and saved of it.
#[derive(Clone, Debug)]
pub struct Deformed {
    /// The rest cage.
    pub cage: Arc<Cage>,
    /// Posed cage vertices, centers included, m (with the calibrated radius where that is on).
    pub posed: Vec<DVec3>,
    /// The split surface, flat; shared between replies until it is split anew.
    pub flat: Arc<Plc>,
    /// Deformed positions of the flat surface's vertices, m.
    pub positions: Vec<DVec3>,
    /// Where feed and resistors of the template meet the patch.
    pub marks: Vec<Mark>,
    /// Local distortion.
    pub fields: Fields,
    /// Distortion figures of the patch's template; none of imported bodies.
    pub figures: Option<Figures>,
    /// The exact cylinder's own figures, where the antenna is bent onto one.
    pub ideal: Option<Figures>,
    /// Compensation, iteration by iteration; empty where there is none.
    pub compensation: Vec<CompensationStep>,
    /// False for a preview made while dragging.
    pub is_final: bool,
    /// Time spent, s.
    pub seconds: f64,
}

impl Deformed {
    /// The deformed surface complex.
    #[must_use]
    pub fn surface(&self) -> Plc {
        self.flat.with_vertices(self.positions.clone())
    }
}

/// Everything that a full run found, beyond its [`Deformed`]: what a live preview continues from.
#[derive(Clone, Debug)]
pub struct Stages {
    /// The checked project.
    pub scene: Scene,
    /// What an antenna of the template has beyond imported bodies.
    pub template: Option<Template>,
    /// Rest points of the surface's vertices.
    pub placement: Placement,
    /// Flat places as drawn of the surface's vertices, against which distortion is measured, m.
    pub reference: Vec<DVec3>,
    /// The result.
    pub deformed: Deformed,
}

/// An antenna of the patch's template.
#[derive(Clone, Debug)]
pub struct Template {
    /// The antenna as drawn.
    pub params: PatchParams,
    /// Outcome of the compensation.
    pub compensated: Compensated,
    /// The antenna that was built: the one drawn, with the patch scaled where the patch alone is compensated.
    pub built: PatchParams,
}

/// Computes the deformed antenna of a project: cage, compensation, splitting, guard and figures.
///
/// # Errors
/// [`PipelineError`] naming what to change; the project is not touched.
pub fn deform(project: &Project, task: &Task) -> Result<Deformed, PipelineError> {
    run(project, task).map(|stages| stages.deformed)
}

/// [`deform`] with all that it found on the way.
///
/// # Errors
/// As [`deform`].
pub fn run(project: &Project, task: &Task) -> Result<Stages, PipelineError> {
    let started = Instant::now();
    let mut stages = match &project.bodies {
        None => run_template(project, task)?,
        Some(bodies) => run_bodies(project, bodies, task)?,
    };
    stages.deformed.seconds = started.elapsed().as_secs_f64();
    Ok(stages)
}

fn run_template(project: &Project, task: &Task) -> Result<Stages, PipelineError> {
    let Prepared { scene, template } = prepare(project, task)?;
    let Template { params, compensated, built } = &template;
    let posed = compensated.map.pose().vertices().to_vec();
    let sheet = |scale| Sheet { scale, warp: &compensated.warp, map: &compensated.map };
    let carry = Carry::new(&compensated.map, &compensated.warp, Scene::feed(built))?;
    let surface = guarded_split(&flat_complex(built)?, |p| carry.carry(p), splitting(project), task)?;
    let positions = surface.positions();
    let placement: Placement = surface.images.iter().copied().collect();
    let reference = reference(&surface.flat, &placement, compensated);
    task.check()?;
    let orders = project.settings.fit_orders;
    let cylinder = scene.cylinder();
    let cylinder = cylinder.as_ref();
    let patch = sheet(compensated.patch_scale);
    let figures = measure(params, &patch, &sheet(DVec2::ONE), cylinder, orders)?;
    let ideal = cylinder.map(|c| measure(params, c, c, Some(c), orders)).transpose()?;
    let mut fields = Fields::new(&surface.flat, &reference, &positions);
    let columns = Columns::new(&reference, params.height);
    fields.thickness = columns.ratios(&sheet(DVec2::ONE).positions(&columns.points)?);
    if let (Some(cylinder), Some(distance)) = (cylinder, &figures.cylinder_distance) {
        fields = fields.with_cylinder(cylinder, distance.shift, &reference);
    }
    let deformed = Deformed {
        cage: Arc::clone(&scene.cage),
        posed,
        fields,
        marks: marks(built, &surface.flat, &positions),
        flat: Arc::new(surface.flat),
        positions,
        figures: Some(figures),
        ideal,
        compensation: compensated.steps.clone(),
        is_final: true,
        seconds: 0.0,
    };
    Ok(Stages { scene, template: Some(template), placement, reference, deformed })
}

/// Bodies go through the cage as drawn; nothing of them is rigid.
fn run_bodies(project: &Project, bodies: &BodiesSpec, task: &Task) -> Result<Stages, PipelineError> {
    let scene = Scene::new(project)?;
    let posed = scene.checked_pose()?;
    let map = scene.map(&posed)?;
    check_folds(&map, bodies.bounds())?;
    let surface = guarded_split(&bodies.to_plc(), |p| map.positions(p), splitting(project), task)?;
    let reference = surface.flat.vertices.clone();
    let placement = Placement { sweep: vec![0.0; reference.len()], rest: reference.clone() };
    let deformed = Deformed {
        cage: Arc::clone(&scene.cage),
        posed,
        marks: source_mark(bodies, &surface.images).into_iter().collect(),
        fields: Fields::new(&surface.flat, &reference, &surface.images),
        flat: Arc::new(surface.flat),
        positions: surface.images,
        figures: None,
        ideal: None,
        compensation: Vec::new(),
        is_final: true,
        seconds: 0.0,
    };
    Ok(Stages { scene, template: None, placement, reference, deformed })
}

/// A project's checked and compensated map, before any surface is carried by it.
#[derive(Clone, Debug)]
pub(super) struct Prepared {
    pub(super) scene: Scene,
    pub(super) template: Template,
}

/// Checks a project of the template, compensates it, and refuses a map that folds.
pub(super) fn prepare(project: &Project, task: &Task) -> Result<Prepared, PipelineError> {
    let scene = Scene::new(project)?;
    scene.checked_pose()?;
    let params = project.antenna.to_params();
    let compensated = compensate(project, &scene, &params, task)?;
    crate::cage::check_pose(&scene.cage, compensated.map.pose().vertices())?;
    let built = scaled(&params, compensated.patch_scale);
    let sheet = Sheet { scale: DVec2::ONE, warp: &compensated.warp, map: &compensated.map };
    check_folds(&sheet, params.bounds())?;
    Ok(Prepared { scene, template: Template { params, compensated, built } })
}

/// The flat surface complex of a project, as drawn.
///
/// # Errors
/// [`PipelineError::Antenna`].
pub fn flat(project: &Project) -> Result<Plc, PipelineError> {
    match &project.bodies {
        Some(bodies) => Ok(bodies.to_plc()),
        None => Ok(flat_complex(&project.antenna.to_params())?),
    }
}

/// The exact cylinder's surface complex for a project bent onto one cylinder (`None` for other shapes).
///
/// # Errors
/// As [`deform`].
pub fn exact_cylinder(project: &Project, task: &Task) -> Result<Option<Plc>, PipelineError> {
    let scene = Scene::new(project)?;
    let Some(cylinder) = scene.cylinder() else { return Ok(None) };
    let flat = flat(project)?;
    if project.bodies.is_some() {
        let surface = guarded_split(&flat, |p| cylinder.positions(p), splitting(project), task)?;
        return Ok(Some(surface.flat.with_vertices(surface.images)));
    }
    let params = project.antenna.to_params();
    let identity = Warp::identity(DVec2::new(params.ground_width, params.ground_length) / 2.0);
    let carry = Carry::new(&cylinder, &identity, Scene::feed(&params))?;
    let surface = guarded_split(&flat, |p| carry.carry(p), splitting(project), task)?;
    Ok(Some(surface.flat.with_vertices(surface.positions())))
}

/// Carries points through any closed triangle cage; numbers as they stand, no unit.
///
/// Returns the carried points and the weights they were carried with.
///
/// # Errors
/// [`PipelineError::Deform`] for an unusable cage or pose, or a point outside the cage.
pub fn apply_cage(
    rest: TriMesh,
    posed: &[DVec3],
    points: &[DVec3],
    task: &Task,
) -> Result<(Vec<DVec3>, GreenWeights), PipelineError> {
    // Whoever gives points to carry has drawn them: outside is their place, not a compensation's.
    let cage = GreenCage::new(rest).map_err(PipelineError::Deform)?;
    let pose = Pose::new(&cage, posed).map_err(PipelineError::Deform)?;
    let weights = cage.weights(points, task).map_err(PipelineError::Deform)?;
    Ok((weights.apply(&pose), weights))
}

/// Runs the compensation that the project asks for.
fn compensate(
    project: &Project,
    scene: &Scene,
    params: &PatchParams,
    task: &Task,
) -> Result<Compensated, PipelineError> {
    let settings = &project.settings;
    match settings.compensation {
        CompensationMode::None => {
            let half = DVec2::new(params.ground_width, params.ground_length) / 2.0;
            let map = scene.map(&scene.posed(1.0)?)?;
            let warp = Warp::identity(half);
            Ok(Compensated { warp, patch_scale: DVec2::ONE, radius_factor: 1.0, map, steps: Vec::new() })
        }
        CompensationMode::Wl => {
            let map = scene.map(&scene.posed(1.0)?)?;
            let scope = if settings.scope == ScopeSpec::Whole { Scope::Whole } else { Scope::Patch };
            let problem = WlProblem { params, map: &map, scope, orders: settings.fit_orders };
            Ok(compensate_wl(&problem, task)?)
        }
        CompensationMode::Isometric => Ok(compensate_metric(scene, params, task)?),
    }
}

/// Isometric compensation. Hand edits are laid onto the bend as calibrated without them, so that the first edit does
/// not let the bend spring back.
fn compensate_metric(scene: &Scene, params: &PatchParams, task: &Task) -> Result<Compensated, CompensationError> {
    let solve = |scene: &Scene, factor: f64| {
        let map_at = |f: f64| scene.map_at(factor * f);
        let problem =
            IsometricProblem { params, degrees: scene.warp_degrees(), cylinder: scene.cylinder(), map_at: &map_at };
        let solved = compensate_isometric(&problem, task)?;
        Ok(Compensated { radius_factor: factor * solved.radius_factor, ..solved })
    };
    if scene.bend.is_none() || scene.edits.is_empty() {
        return solve(scene, 1.0);
    }
    let plain = Scene { edits: Vec::new(), ..scene.clone() };
    solve(scene, solve(&plain, 1.0)?.radius_factor)
}

/// The antenna with its patch, feed place and resistors' places scaled.
fn scaled(params: &PatchParams, scale: DVec2) -> PatchParams {
    PatchParams {
        width: params.width * scale.x,
        length: params.length * scale.y,
        outline: params.outline.iter().map(|p| *p * scale).collect(),
        inset: params.inset * scale.y,
        feed_offset: params.feed_offset * scale.x,
        resistors: params.resistors.iter().map(|r| Resistor { at: r.at * scale, ..*r }).collect(),
        ..params.clone()
    }
}

/// Samples across the antenna where the map must not fold.
const FOLD_SAMPLES: [usize; 3] = [21, 21, 3];

/// Refuses a map that turns a sample of the antenna inside out: needed for a valid surface, not sufficient.
pub(super) fn check_folds(map: &impl SmoothMap, (lo, hi): (DVec3, DVec3)) -> Result<(), PipelineError> {
    let [nx, ny, nz] = FOLD_SAMPLES;
    let at = |i: usize, n: usize| i as f64 / (n - 1) as f64;
    let points: Vec<DVec3> = (0..nx * ny * nz)
        .map(|s| lo + (hi - lo) * DVec3::new(at(s / (ny * nz), nx), at(s / nz % ny, ny), at(s % nz, nz)))
        .collect();
    for (point, (image, jacobian)) in points.iter().zip(map.jacobians(&points)?) {
        if jacobian.determinant() <= 0.0 {
            let at_mm = image.to_array().map(to_mm);
            return Err(PipelineError::Folded { x_mm: to_mm(point.x), y_mm: to_mm(point.y), at_mm });
        }
    }
    Ok(())
}

/// Finer tolerances tried when the split surface crosses itself although the map does not fold.
const RETRIES: usize = 2;

/// How finely a project's surfaces are split.
pub(super) fn splitting(project: &Project) -> SplitSettings {
    SplitSettings::with_tolerance(from_mm(project.settings.tolerance_mm))
}

/// Splits a flat surface, and finer where its image crosses itself.
pub(super) fn guarded_split<P: Image>(
    flat: &Plc,
    carry: impl Fn(&[DVec3]) -> Result<Vec<P>, DeformError>,
    mut settings: SplitSettings,
    task: &Task,
) -> Result<SplitSurface<P>, PipelineError> {
    for attempt in 0..=RETRIES {
        let phase = task.phase("splitting edges", 0);
        let surface = split(flat.clone(), &carry, settings, task)?;
        phase.advance(surface.images.len());
        let faces: Vec<_> = surface.flat.facets.iter().map(|f| f.vertices).collect();
        let crossings = intersect::crossings(&surface.positions(), &faces);
        if crossings.is_empty() {
            return Ok(surface);
        }
        if attempt == RETRIES {
            return Err(crossing_error(&surface, &crossings));
        }
        settings.tolerance /= 2.0;
    }
    unreachable!("the last attempt returns")
}

/// Most places that are told of a surface that crosses itself.
const MAX_PLACES: usize = 100;

fn crossing_error<P: Image>(surface: &SplitSurface<P>, crossings: &[intersect::Crossing]) -> PipelineError {
    let first = crossings[0];
    let posed = surface.flat.with_vertices(surface.positions());
    let place = |c: &intersect::Crossing| posed.corners(c.first.index()).iter().sum::<DVec3>() / 3.0;
    let part = |f: usize| {
        let facet = &surface.flat.facets[f];
        let region = if facet.back == RegionId::AIR { facet.front } else { facet.back };
        surface.flat.regions[region.index()].name.clone()
    };
    PipelineError::Crossing {
        count: crossings.len(),
        what: format!("{} with {}", part(first.first.index()), part(first.second.index())),
        places_mm: crossings.iter().take(MAX_PLACES).map(|c| place(c).to_array().map(to_mm)).collect(),
    }
}

/// Where each vertex of the surface sits on the antenna as drawn: its rest point without the compensation. The shift
/// that keeps the feed round slides points along the sheet; it is no distortion and does not count.
fn reference(flat: &Plc, placement: &Placement, compensated: &Compensated) -> Vec<DVec3> {
    let patch = flat.region(PATCH);
    let mut on_patch = vec![false; flat.vertices.len()];
    for facet in flat.facets.iter().filter(|f| Some(f.back) == patch || Some(f.front) == patch) {
        facet.vertices.iter().for_each(|v| on_patch[v.index()] = true);
    }
    let unscale = compensated.patch_scale.recip();
    flat.vertices
        .iter()
        .enumerate()
        .map(|(v, point)| {
            if placement.sweep[v] > 0.0 {
                return *point;
            }
            let drawn = compensated.warp.inverse(placement.rest[v], point.truncate());
            if on_patch[v] { (drawn.truncate() * unscale).extend(drawn.z) } else { drawn }
        })
        .collect()
}
