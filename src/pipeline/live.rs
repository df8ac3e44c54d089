//! The preview while dragging: the last surface's vertices moved through a new pose.
//!
//! Split surface, rest points and pre-warp are those of the gesture's start; weights are computed once, at the first
//! preview, and equation (2) is applied anew as a difference for the vertices that moved, or as a whole product where
//! all did. Figures are measured on few samples and on the faceted surface, and relative to the full run's where that
//! is finer, so that nothing jumps when the gesture begins.

use super::PipelineError;
use super::fields::{Columns, Fields};
use super::marks::{marks, source_mark};
use super::scene::{Scene, same_rest};
use super::stages::{Deformed, Stages, Template};
use crate::antenna::{PATCH, SUBSTRATE};
use crate::deform::{GreenMap, GreenWeights, Pose, PreviewWeights, feed_frame, sweep_line};
use crate::distortion::{Figures, facet_strain, fitted_size, sample_points};
use crate::geometry::{DVec2, DVec3, Plc, RegionId};
use crate::project::Project;
use crate::task::Task;
use std::sync::Arc;
use std::time::Instant;

/// What a sequence of previews keeps.
#[derive(Debug)]
pub struct Live {
    project: Project,
    stages: Stages,
    /// Weights of the surface's vertices: f32, for the picture only.
    vertices: PreviewWeights,
    /// What is measured of an antenna of the template.
    gauges: Option<Gauges>,
    posed: Option<(Pose, Vec<[f32; 3]>)>,
}

/// Places of an antenna of the template where something is measured, and their weights.
#[derive(Debug)]
struct Gauges {
    template: Template,
    /// Places where the substrate's thickness is measured.
    columns: Columns,
    thickness: PreviewWeights,
    /// The figures' samples: the patch's bottom plane, then the substrate's bottom under it.
    samples: GreenWeights,
}

impl Gauges {
    fn new(template: Template, stages: &Stages, task: &Task) -> Result<Self, PipelineError> {
        let half = DVec2::new(template.built.width, template.built.length) / 2.0;
        let bottom = DVec3::Z * template.built.height;
        let top = sample_points(half);
        let warped = |p: DVec3| template.compensated.warp.map(p);
        let rest: Vec<DVec3> = top.iter().copied().chain(top.iter().map(|p| *p - bottom)).map(warped).collect();
        let samples = stages.scene.green.weights(&rest, task)?;
        let columns = Columns::new(&stages.reference, template.params.height);
        let rest: Vec<DVec3> = columns.points.iter().map(|&p| warped(p)).collect();
        let thickness = stages.scene.green.weights(&rest, task)?.to_preview();
        Ok(Self { template, columns, thickness, samples })
    }
}

impl Live {
    /// Prepares previews that start from a full run of a project.
    ///
    /// # Errors
    /// [`PipelineError::Cancelled`], or what the weights refuse.
    pub fn new(project: Project, stages: Stages, task: &Task) -> Result<Self, PipelineError> {
        let vertices = stages.scene.green.weights(&stages.placement.rest, task)?.to_preview();
        let gauges = stages.template.clone().map(|template| Gauges::new(template, &stages, task)).transpose()?;
        Ok(Self { project, stages, vertices, gauges, posed: None })
    }

    /// True if this preview can show the project: it differs in presets and hand edits only.
    #[must_use]
    pub fn serves(&self, project: &Project) -> bool {
        same_rest(&self.project, project)
    }

    /// Moves the surface through the pose of `project`.
    ///
    /// # Errors
    /// [`PipelineError`] if the pose is refused; the next call continues from the last good one.
    pub fn preview(&mut self, project: &Project) -> Result<Deformed, PipelineError> {
        let started = Instant::now();
        let scene = Scene::pose_of(project, &self.stages.scene)?;
        let posed = scene.posed(self.gauges.as_ref().map_or(1.0, |g| g.template.compensated.radius_factor))?;
        crate::cage::check_pose(&scene.cage, &posed)?;
        let pose = Pose::new(&scene.green, &posed)?;
        let moved = self.moved(&pose);
        let mut positions: Vec<DVec3> = moved.iter().map(|p| glam::Vec3::from_array(*p).as_dvec3()).collect();
        self.posed = Some((pose.clone(), moved));
        let mut figures = None;
        let mut thickness = Vec::new();
        let mut placed: Vec<_> = project.bodies.iter().filter_map(|b| source_mark(b, &positions)).collect();
        if let Some(gauges) = &self.gauges {
            let Template { built, compensated, .. } = &gauges.template;
            let feed = Scene::feed(built);
            let map = GreenMap::new(Arc::clone(&scene.green), pose.clone());
            let frame = feed_frame(&map, &compensated.warp, &feed)?;
            sweep_line(&feed, &frame, &self.stages.placement, &mut positions)?;
            placed = marks(built, &self.stages.deformed.flat, &positions);
            figures = self.figures(&scene, gauges, &pose, &positions, project.settings.fit_orders);
            let images = gauges.thickness.apply(&pose);
            let images: Vec<DVec3> = images.into_iter().map(|p| glam::Vec3::from_array(p).as_dvec3()).collect();
            thickness = gauges.columns.ratios(&images);
        }
        let mut fields = Fields::new(&self.stages.deformed.flat, &self.stages.reference, &positions);
        fields.thickness = thickness;
        let distance = figures.as_ref().and_then(|f| f.cylinder_distance);
        if let (Some(cylinder), Some(distance)) = (scene.cylinder(), distance) {
            fields = fields.with_cylinder(&cylinder, distance.shift, &self.stages.reference);
        }
        Ok(Deformed {
            cage: Arc::clone(&scene.cage),
            posed,
            marks: placed,
            flat: Arc::clone(&self.stages.deformed.flat),
            positions,
            fields,
            figures,
            ideal: self.stages.deformed.ideal.filter(|_| scene.cylinder() == self.stages.scene.cylinder()),
            compensation: self.stages.deformed.compensation.clone(),
            is_final: false,
            seconds: started.elapsed().as_secs_f64(),
        })
    }

    /// Positions through `pose`, as a difference from the last pose where few cage vertices moved.
    fn moved(&mut self, pose: &Pose) -> Vec<[f32; 3]> {
        if let Some((from, mut positions)) = self.posed.take() {
            let n_moved = from.vertices().iter().zip(pose.vertices()).filter(|(a, b)| a != b).count();
            if 4 * n_moved <= pose.vertices().len() {
                self.vertices.apply_change(&mut positions, &from, pose);
                return positions;
            }
        }
        self.vertices.apply(pose)
    }

    fn figures(
        &self,
        scene: &Scene,
        gauges: &Gauges,
        pose: &Pose,
        positions: &[DVec3],
        orders: [usize; 2],
    ) -> Option<Figures> {
        let full = &self.stages.deformed;
        let measured = full.figures.as_ref()?;
        let params = &gauges.template.params;
        let flat = &full.flat;
        let samples = gauges.samples.apply(pose);
        let (top, bottom) = samples.split_at(samples.len() / 2);
        let size = fitted_size(top, orders);
        let thickness = top.iter().zip(bottom).map(|(t, b)| t.distance(*b)).sum::<f64>() / top.len() as f64;
        let area =
            |name: &str, positions: &[DVec3]| flat.region(name).map_or(1.0, |region| area_of(flat, region, positions));
        // The full run's rho is of the smooth surface; the preview changes it as the facets change.
        let rho = |name: &str, rho: f64| (1.0 + rho) * area(name, positions) / area(name, &full.positions) - 1.0;
        let [patch_strain, substrate_strain] = self.strains(positions);
        let cylinder = scene.cylinder();
        let half = DVec2::new(params.width, params.length) / 2.0;
        Some(Figures {
            rho_patch: rho(PATCH, measured.rho_patch),
            rho_substrate: rho(SUBSTRATE, measured.rho_substrate),
            width: size.x,
            length: size.y,
            width_error: size.x / params.width - 1.0,
            length_error: size.y / params.length - 1.0,
            thickness,
            thickness_error: thickness / params.height - 1.0,
            patch_strain: patch_strain[0],
            patch_strain_rms: patch_strain[1],
            substrate_strain: substrate_strain[0],
            radius: cylinder.map(|c| c.fitted_radius(top)),
            cylinder_distance: cylinder.map(|c| c.distance(&sample_points(half), top)),
        })
    }

    /// Largest and root-mean-square strain of the facets of the patch's bottom and of the substrate's top.
    fn strains(&self, positions: &[DVec3]) -> [[f64; 2]; 2] {
        let flat = &self.stages.deformed.flat;
        let (patch, substrate) = (flat.region(PATCH), flat.region(SUBSTRATE));
        let mut sums = [[0.0_f64; 3]; 2];
        for facet in &flat.facets {
            let sides = [Some(facet.back), Some(facet.front)];
            let at = |points: &[DVec3]| facet.vertices.map(|v| points[v.index()]);
            let drawn = at(&self.stages.reference);
            let on_top = drawn.iter().all(|p| p.z.abs() < 1e-9);
            if !(on_top && sides.contains(&substrate)) {
                continue;
            }
            let strains = facet_strain(drawn, at(positions)).map(|s| (s - 1.0).abs());
            let kind = usize::from(!sides.contains(&patch));
            for sum in &mut sums[kind..] {
                for strain in strains {
                    *sum = [sum[0].max(strain), sum[1] + strain * strain, sum[2] + 1.0];
                }
            }
        }
        sums.map(|s| [s[0], (s[1] / s[2].max(1.0)).sqrt()])
    }
}

fn area_of(flat: &Plc, region: RegionId, positions: &[DVec3]) -> f64 {
    let bounds = flat.facets.iter().filter(|f| f.back == region || f.front == region);
    bounds
        .map(|f| {
            let [a, b, c] = f.vertices.map(|v| positions[v.index()]);
            (b - a).cross(c - a).length() / 2.0
        })
        .sum()
}
