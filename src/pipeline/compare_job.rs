//! A project deformed without compensation, by WL and isometrically, in the background: what compensation does.

use super::PipelineError;
use super::job::{Job, Work};
use super::stages::{Deformed, deform};
use crate::project::{CompensationMode, Project};
use crate::task::Task;

/// The ways of compensation, in the order in which they are compared.
pub const MODES: [CompensationMode; 3] = [CompensationMode::None, CompensationMode::Wl, CompensationMode::Isometric];

/// A project to be compared; its own compensation does not matter.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareRequest {
    /// The project.
    pub project: Project,
}

impl CompareRequest {
    /// The comparison of a project.
    #[must_use]
    pub fn new(project: &Project) -> Self {
        let mut project = project.clone();
        project.settings.compensation = CompensationMode::None;
        Self { project }
    }
}

/// The deformed antenna for each of [`MODES`], or why there is none.
pub type Compared = [Result<Box<Deformed>, PipelineError>; 3];

/// The thread that compares.
pub type CompareJob = Job<CompareRequest>;

impl Work for CompareRequest {
    type Output = Compared;
    type Live = ();
    const NAME: &'static str = "compare";

    fn work(&self, task: &Task, _show: &dyn Fn(())) -> Result<Compared, PipelineError> {
        let of = |mode| {
            let mut project = self.project.clone();
            project.settings.compensation = mode;
            match deform(&project, task) {
                Err(PipelineError::Cancelled(cancelled)) => Err(PipelineError::Cancelled(cancelled)),
                found => Ok(found.map(Box::new)),
            }
        };
        let [raw, wl, isometric] = MODES;
        Ok([of(raw)?, of(wl)?, of(isometric)?])
    }
}
