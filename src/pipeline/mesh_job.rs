//! The thread that meshes in the background: newest request wins, and each answer says what was asked.
//!
//! It shares nothing with the [`Worker`](super::worker::Worker), so that the antenna follows the pointer while a mesh
//! is made. A request replaces whatever waits and cancels what is under way; dropping the handle cancels and joins.
//! A mesh is handed over ready to be looked at: with the angles of its cells and prepared for being cut open.

use super::{MeshSettings, Meshed, PipelineError, Shape, mesh};
use crate::project::Project;
use crate::task::{Progress, Task};
use crate::tet::{Cutaway, TetQuality, tet_qualities};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::thread::JoinHandle;

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

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshJobError {
    /// The project cannot be meshed.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// A fault of the program.
    #[error("meshing broke off by a fault of this program: try another density, or change the shape a little")]
    BrokeOff,
}

/// An answer.
#[derive(Debug)]
pub struct MeshReply {
    /// What was asked.
    pub request: MeshRequest,
    /// The mesh, or why there is none.
    pub result: Result<Box<ReadyMesh>, MeshJobError>,
}

/// Handle of the background thread.
#[derive(Debug)]
pub struct MeshJob {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct State {
    waiting: Option<(MeshRequest, Task)>,
    running: Option<Task>,
    reply: Option<MeshReply>,
    progress: Option<Progress>,
    closing: bool,
}

impl State {
    fn cancel(&mut self) {
        self.waiting = None;
        self.progress = None;
        if let Some(task) = self.running.take() {
            task.cancel();
        }
    }
}

struct Shared {
    state: Mutex<State>,
    news: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").finish_non_exhaustive()
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // A thread that panicked left plain values behind, all of them valid.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl MeshJob {
    /// Starts the thread; `wake` is called whenever there is news.
    ///
    /// # Panics
    /// If the system cannot start a thread.
    #[must_use]
    pub fn spawn(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let shared = Arc::new(Shared { state: Mutex::default(), news: Condvar::new(), wake: Box::new(wake) });
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("mesh".to_owned())
            .spawn(move || serve(&own))
            .expect("the system can start one thread");
        Self { shared, thread: Some(thread) }
    }

    /// Asks for a mesh, cancelling what is under way and forgetting an answer that was not fetched.
    pub fn request(&mut self, request: MeshRequest) {
        let mut state = self.shared.lock();
        state.cancel();
        state.reply = None;
        state.waiting = Some((request, Task::default()));
        drop(state);
        self.shared.news.notify_one();
    }

    /// Takes the answer, if there is one. What was cancelled has none.
    pub fn poll(&mut self) -> Option<MeshReply> {
        self.shared.lock().reply.take()
    }

    /// Cancels what waits and what is under way, and forgets an answer that was not fetched.
    pub fn cancel(&mut self) {
        let mut state = self.shared.lock();
        state.cancel();
        state.reply = None;
    }

    /// True until the newest request is answered or cancelled.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.waiting.is_some() || state.running.is_some()
    }

    /// What the thread is doing for the newest request.
    #[must_use]
    pub fn progress(&self) -> Option<Progress> {
        self.shared.lock().progress
    }
}

impl Drop for MeshJob {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.closing = true;
        state.cancel();
        drop(state);
        self.shared.news.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic outside of the work was printed there; there is nothing left to save here.
            let _ended = thread.join();
        }
    }
}

fn serve(shared: &Arc<Shared>) {
    while let Some((request, task)) = next(shared) {
        let (sink, own) = (Arc::clone(shared), task.clone());
        let listened = task.listening(move |p| {
            let mut state = sink.lock();
            // The state belongs to a newer request by now, or to none.
            if !own.is_cancelled() {
                state.progress = Some(p);
                drop(state);
                (sink.wake)();
            }
        });
        // The work leaves nothing behind but its result, so that nothing half done can be seen after a panic.
        let result =
            catch_unwind(AssertUnwindSafe(|| work(&request, &listened))).unwrap_or(Err(MeshJobError::BrokeOff));
        let mut state = shared.lock();
        if !task.is_cancelled() {
            state.running = None;
            state.progress = None;
            state.reply = Some(MeshReply { request, result: result.map(Box::new) });
        }
        drop(state);
        (shared.wake)();
    }
}

fn next(shared: &Shared) -> Option<(MeshRequest, Task)> {
    let mut state = shared.lock();
    loop {
        if state.closing {
            return None;
        }
        if let Some((request, task)) = state.waiting.take() {
            state.running = Some(task.clone());
            return Some((request, task));
        }
        state = shared.news.wait(state).unwrap_or_else(std::sync::PoisonError::into_inner);
    }
}

fn work(request: &MeshRequest, task: &Task) -> Result<ReadyMesh, MeshJobError> {
    let meshed = mesh(&request.project, request.shape, request.settings, task)?;
    let phase = task.phase("preparing the picture", 2);
    let cells = tet_qualities(&meshed.mesh);
    phase.advance(1);
    let cutaway = Cutaway::new(&meshed.mesh);
    phase.advance(1);
    Ok(ReadyMesh { meshed, cells, cutaway })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::Density;
    use std::time::{Duration, Instant};

    fn request(shape: Shape) -> MeshRequest {
        let settings = MeshSettings { density: Density::Coarse, ..MeshSettings::default() };
        MeshRequest { project: Project::default(), shape, settings }
    }

    fn answer(job: &mut MeshJob) -> MeshReply {
        let start = Instant::now();
        loop {
            if let Some(reply) = job.poll() {
                return reply;
            }
            assert!(start.elapsed() < Duration::from_secs(300), "no answer");
            std::thread::sleep(Duration::from_millis(2));
        }
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
