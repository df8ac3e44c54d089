//! The mesh on show with the project that it belongs to, and the thread that makes the next one.
//!
//! Nothing here draws. A mesh stays on show until another one takes its place, even when its project has gone on or a
//! new attempt fails or is called off; whether it still fits is a comparison of projects.

use super::places::Refusal;
use super::ui_state::MeshUi;
use crate::pipeline::mesh_job::{MeshJob, MeshRequest, ReadyMesh};
use crate::pipeline::{Density, MeshSettings, Shape};
use crate::project::{PresetSpec, Project};
use crate::task::Progress;
use crate::tet::Metal;
use crate::units::to_mm;
use std::sync::Arc;

/// A mesh, what it was made of, and a number that tells it from others.
#[derive(Clone, Debug)]
pub(super) struct ShownMesh {
    pub(super) request: MeshRequest,
    pub(super) ready: Arc<ReadyMesh>,
    pub(super) serial: u64,
    /// Least and greatest coordinate along each axis, mm.
    pub(super) bounds_mm: [[f64; 2]; 3],
}

impl ShownMesh {
    fn new(request: MeshRequest, ready: ReadyMesh, serial: u64) -> Self {
        let ends = |axis: usize| {
            let along = ready.meshed.mesh.vertices.iter().map(|p| to_mm(p[axis]));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
        };
        let bounds_mm = [0, 1, 2].map(ends);
        Self { request, ready: Arc::new(ready), serial, bounds_mm }
    }

    /// Whether the project has changed since.
    pub(super) fn is_stale(&self, project: &Project) -> bool {
        self.request.project != *project
    }
}

/// Something that happened to the meshing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum MeshNews {
    /// There is a mesh.
    Made(String),
    /// There is none, and why.
    Failed(String),
}

/// The mesh of the open project.
#[derive(Debug)]
pub(super) struct MeshSession {
    job: MeshJob,
    shown: Option<ShownMesh>,
    error: Option<Refusal>,
    serial: u64,
}

impl MeshSession {
    /// Starts with no mesh.
    pub(super) fn new(job: MeshJob) -> Self {
        Self { job, shown: None, error: None, serial: 0 }
    }

    /// The last mesh made.
    pub(super) fn shown(&self) -> Option<&ShownMesh> {
        self.shown.as_ref()
    }

    /// Why the last attempt has no mesh.
    pub(super) fn error(&self) -> Option<&Refusal> {
        self.error.as_ref()
    }

    /// Whether a mesh is being made.
    pub(super) fn is_busy(&self) -> bool {
        self.job.is_busy()
    }

    /// What is being done.
    pub(super) fn progress(&self) -> Option<Progress> {
        self.job.progress()
    }

    /// Begins to mesh a project as chosen.
    pub(super) fn start(&mut self, project: &Project, chosen: &MeshUi) {
        let settings = MeshSettings { density: chosen.density, metal: chosen.metal };
        self.error = None;
        self.job.request(MeshRequest { project: project.clone(), shape: chosen.shape, settings });
    }

    /// Calls the meshing off; what is on show stays.
    pub(super) fn cancel(&mut self) {
        self.job.cancel();
    }

    /// Forgets everything: another project was opened.
    pub(super) fn clear(&mut self) {
        self.job.cancel();
        (self.shown, self.error) = (None, None);
    }

    /// Takes an answer, if there is one.
    pub(super) fn sync(&mut self) -> Option<MeshNews> {
        let reply = self.job.poll()?;
        match reply.result {
            Ok(ready) => {
                self.serial += 1;
                let meshed = &ready.meshed;
                let cells = grouped(meshed.mesh.tets.len());
                let news = MeshNews::Made(format!("Meshed: {cells} cells in {:.1} s", meshed.seconds));
                self.shown = Some(ShownMesh::new(reply.request, *ready, self.serial));
                Some(news)
            }
            Err(error) => {
                let refusal = Refusal::new(&error, reply.request.project, reply.request.shape);
                let text = self.error.insert(refusal).text.clone();
                Some(MeshNews::Failed(text))
            }
        }
    }
}

/// Whether the project is bent onto one exact cylinder.
pub(super) fn has_cylinder(project: &Project) -> bool {
    let mut active = project.presets.iter().filter(|p| p.enabled);
    let first = active.next().is_some_and(|p| matches!(p.preset, PresetSpec::Bend { .. }));
    first && active.next().is_none() && project.hand_edits.is_empty()
}

/// Name and tooltip of a shape.
pub(super) fn shape_text(shape: Shape) -> (&'static str, &'static str) {
    match shape {
        Shape::Deformed => ("Deformed", "Carried by the cage, compensated as chosen"),
        Shape::Flat => ("Flat", "As drawn, without deformation and compensation"),
        Shape::Cylinder => ("Exact cylinder", "As drawn, bent onto the exact cylinder: a reference"),
    }
}

/// Name and tooltip of a density.
pub(super) fn density_text(density: Density) -> (&'static str, &'static str) {
    match density {
        Density::Coarse => ("Coarse", "For a first look: 2 layers in the substrate, 10 edges along the patch"),
        Density::Default => ("Default", "For results: 4 layers in the substrate, 20 edges along the patch"),
        Density::Fine => ("Fine", "To see what a finer mesh changes: 6 layers, 32 edges along the patch"),
    }
}

/// Name and tooltip of what the metal is made of.
pub(super) fn metal_text(metal: Metal) -> (&'static str, &'static str) {
    match metal {
        Metal::Sheet => ("Sheets", "Patch and ground without thickness: fewer and better cells"),
        Metal::Solid => ("True thickness", "Patch and ground as bodies, left out of the mesh: many small cells"),
    }
}

/// A count with its thousands apart.
pub(super) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::session::first_project;

    #[test]
    fn counts_are_grouped_by_thousands() {
        let thin = |text: &str| text.replace(' ', "\u{2009}");
        for (count, text) in [(0, "0"), (999, "999"), (1000, "1 000"), (1_234_567, "1 234 567")] {
            assert_eq!(grouped(count), thin(text), "{count}");
        }
    }

    #[test]
    fn only_a_single_bend_has_a_cylinder() {
        let bent = first_project();
        assert!(has_cylinder(&bent), "one bend");
        let mut off = bent.clone();
        off.presets[0].enabled = false;
        assert!(!has_cylinder(&off), "switched off");
        let mut twice = bent.clone();
        twice.presets.push(twice.presets[0]);
        assert!(!has_cylinder(&twice), "bent twice");
        let mut moved = bent;
        moved.hand_edits.insert(3, [0.1, 0.0, 0.0]);
        assert!(!has_cylinder(&moved), "moved by hand");
    }
}
