//! Meshing in the background, beside the worker, so that the antenna follows the pointer while a mesh is made.
//!
//! A mesh is handed over ready to be looked at: with the angles of its cells and prepared for being cut open.

use super::job::{Job, Work};
use super::{MeshSettings, Meshed, PipelineError, Shape, mesh};
use crate::project::Project;
use crate::task::Task;
use crate::tet::{Cutaway, TetQuality, tet_qualities};

/// What is to be meshed.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshRequest {
    /// The project that the mesh will belong to.
    pub project: Project,
    /// Which of its shapes.
    pub shape: Shape,
    /// How.
    pub settings: MeshSettings,
}

/// A mesh with what a picture of it needs.
#[derive(Clone, Debug)]
pub struct ReadyMesh {
    /// The mesh and its figures.
    pub meshed: Meshed,
    /// Figures of each cell.
    pub cells: Vec<TetQuality>,
    /// The mesh prepared for being cut open.
    pub cutaway: Cutaway,
}

/// The thread that meshes.
pub type MeshJob = Job<MeshRequest>;

impl Work for MeshRequest {
    type Output = ReadyMesh;
    type Live = ();
    const NAME: &'static str = "mesh";

    fn work(&self, task: &Task, _show: &dyn Fn(())) -> Result<ReadyMesh, PipelineError> {
        let meshed = mesh(&self.project, self.shape, self.settings, task)?;
        let phase = task.phase("preparing the picture", 2);
        let cells = tet_qualities(&meshed.mesh);
        phase.advance(1);
        let cutaway = Cutaway::new(&meshed.mesh);
        phase.advance(1);
        Ok(ReadyMesh { meshed, cells, cutaway })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::Density;
    use crate::pipeline::job::answer;

    fn request(shape: Shape) -> MeshRequest {
        let settings = MeshSettings { density: Density::Coarse, ..MeshSettings::default() };
        MeshRequest { project: Project::default(), shape, settings }
    }

    #[test]
    fn the_newest_request_is_the_one_answered() {
        let mut job = MeshJob::spawn(|| ());
        job.request(MeshRequest {
            settings: MeshSettings { density: Density::Fine, ..MeshSettings::default() },
            ..request(Shape::Flat)
        });
        job.request(request(Shape::Flat));
        let reply = answer(&mut job);
        assert_eq!(reply.request, request(Shape::Flat), "says what was asked");
        let ready = reply.result.expect("the default antenna");
        let n_tets = ready.meshed.mesh.tets.len();
        assert_eq!((ready.cells.len(), ready.cutaway.centers().len()), (n_tets, n_tets), "ready to be shown");
        assert!(!job.is_busy() && job.poll().is_none() && job.progress().is_none(), "nothing is left over");
    }

    #[test]
    fn what_is_cancelled_has_no_answer() {
        let mut job = MeshJob::spawn(|| ());
        job.request(request(Shape::Flat));
        while job.progress().is_none() && job.is_busy() {
            std::thread::yield_now();
        }
        job.cancel();
        assert!(!job.is_busy() && job.progress().is_none(), "idle at once");
        job.request(request(Shape::Cylinder));
        let reply = answer(&mut job);
        assert_eq!(reply.request.shape, Shape::Cylinder, "the cancelled one is not answered");
        assert_eq!(reply.result.unwrap_err(), PipelineError::NoCylinder.into(), "the flat antenna lies on no cylinder");
        job.request(request(Shape::Flat));
        drop(job);
    }
}
