//! A project's checked values: cage, pose, and the cylinder aimed at.

use super::PipelineError;
use crate::antenna::PatchParams;
use crate::cage::{Cage, Preset, check_pose, pose};
use crate::deform::{GreenCage, GreenMap, Pose, RigidFeed};
use crate::distortion::{CompensationError, Cylinder};
use crate::geometry::{DVec2, DVec3};
use crate::project::Project;
use crate::units::{from_mm, to_mm};
use std::sync::Arc;

/// What a project describes, checked, before anything is deformed.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The rest cage.
    pub cage: Arc<Cage>,
    /// The rest cage prepared for Green coordinates.
    pub green: Arc<GreenCage>,
    /// Presets that are switched on.
    pub presets: Vec<Preset>,
    /// Offsets of single vertices, m.
    pub edits: Vec<(usize, DVec3)>,
    /// The cylinder of the bend, if that is the only preset; hand edits may lie on top.
    pub bend: Option<Cylinder>,
}

impl Scene {
    /// Checks a project and builds its cage.
    ///
    /// # Errors
    /// [`PipelineError`] naming the number to change.
    pub fn new(project: &Project) -> Result<Self, PipelineError> {
        if project.bodies.is_none() {
            let params = project.antenna.to_params();
            params.validate().map_err(crate::antenna::PatchError::from)?;
            let limit = params.thinnest_layer() / 3.0;
            let tolerance_mm = project.settings.tolerance_mm;
            if !(tolerance_mm > 0.0 && from_mm(tolerance_mm) <= limit) {
                return Err(PipelineError::Tolerance { value_mm: tolerance_mm, limit_mm: to_mm(limit) });
            }
        }
        let cage = project.rest_cage()?;
        let green = Arc::new(GreenCage::new(cage.mesh.clone())?);
        let rest = Self { cage: Arc::new(cage), green, presets: Vec::new(), edits: Vec::new(), bend: None };
        Self::pose_of(project, &rest)
    }

    /// The scene of a project whose antenna and rest cage are those of `rest`.
    ///
    /// # Errors
    /// [`PipelineError::HandEdit`].
    pub(super) fn pose_of(project: &Project, rest: &Self) -> Result<Self, PipelineError> {
        let n_handles = rest.cage.n_handles();
        let mut edits = Vec::with_capacity(project.hand_edits.len());
        for (&vertex, offset_mm) in &project.hand_edits {
            let index = vertex as usize;
            if index >= n_handles {
                return Err(PipelineError::HandEdit { vertex, n_handles });
            }
            edits.push((index, DVec3::from_array(offset_mm.map(from_mm))));
        }
        let presets = project.active_presets();
        let bend = match presets[..] {
            [Preset::Bend { axis, radius, kept_plane, .. }] => Some(Cylinder { axis, radius, kept_plane }),
            _ => None,
        };
        Ok(Self { presets, edits, bend, ..rest.clone() })
    }

    /// The exact cylinder aimed at: a bend with no hand edits on it.
    #[must_use]
    pub fn cylinder(&self) -> Option<Cylinder> {
        self.bend.filter(|_| self.edits.is_empty())
    }

    /// Posed cage vertices, m, with the bend radius multiplied by a factor where there is one; not yet checked.
    ///
    /// # Errors
    /// The preset that cannot be applied, and why.
    pub fn posed(&self, radius_factor: f64) -> Result<Vec<DVec3>, PipelineError> {
        let mut presets = self.presets.clone();
        if let (Some(_), [Preset::Bend { radius, .. }]) = (self.bend, &mut presets[..]) {
            *radius *= radius_factor;
        }
        let mut posed =
            pose(&self.cage, &presets).map_err(|(index, source)| PipelineError::Preset { index, source })?;
        for &(vertex, offset) in &self.edits {
            posed[vertex] += offset;
        }
        Ok(self.cage.with_centers(posed))
    }

    /// Posed cage vertices as asked for, checked.
    ///
    /// # Errors
    /// [`PipelineError::Preset`] or [`PipelineError::Pose`].
    pub fn checked_pose(&self) -> Result<Vec<DVec3>, PipelineError> {
        let posed = self.posed(1.0)?;
        check_pose(&self.cage, &posed)?;
        Ok(posed)
    }

    /// The Green map of a pose.
    ///
    /// # Errors
    /// [`PipelineError::Deform`] if a face is collapsed.
    pub fn map(&self, posed: &[DVec3]) -> Result<GreenMap, PipelineError> {
        Ok(GreenMap::new(Arc::clone(&self.green), Pose::new(&self.green, posed)?))
    }

    /// The map with a calibrated radius, as the isometric compensation asks for it.
    pub(super) fn map_at(&self, radius_factor: f64) -> Result<GreenMap, CompensationError> {
        let posed = self.posed(radius_factor).map_err(|error| match error {
            PipelineError::Preset { source, .. } => CompensationError::Cage(source),
            PipelineError::Deform(source) => CompensationError::Deform(source),
            other => unreachable!("posing a checked scene fails in its presets only: {other}"),
        })?;
        Ok(GreenMap::new(Arc::clone(&self.green), Pose::new(&self.green, &posed)?))
    }

    /// The feed of an antenna.
    pub(super) fn feed(params: &PatchParams) -> RigidFeed {
        let center = params.feed();
        let half = DVec2::new(params.ground_width, params.ground_length) / 2.0;
        let room = (half - center.abs()).min_element();
        let to_rim = match params.outline.is_empty() {
            true => params.inset.min(params.length - params.inset).min(params.width / 2.0 - center.x.abs()),
            false => params.inside_patch(center),
        };
        RigidFeed {
            center,
            pin_fade: 0.75 * (to_rim - params.pin_radius),
            coax_fade: 0.95 * (room - params.coax_radius),
            pin_radius: params.pin_radius,
            coax_radius: params.coax_radius,
            substrate_bottom: -params.height,
            line_top: params.ground_bottom(),
            port_plane: params.port_plane(),
        }
    }

    /// Polynomial degrees of the isometric warp: more along the direction that curves.
    pub(super) fn warp_degrees(&self) -> [usize; 2] {
        match self.cylinder() {
            Some(Cylinder { axis: crate::cage::Axis::X, .. }) => [9, 5],
            Some(_) => [5, 9],
            None => [9, 9],
        }
    }
}

/// True if the two projects differ in nothing but presets and hand edits: the rest cage and all flat points agree.
pub(super) fn same_rest(a: &Project, b: &Project) -> bool {
    a.antenna == b.antenna && a.bodies == b.bodies && a.cage == b.cage && a.settings == b.settings
}
