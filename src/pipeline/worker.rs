//! One background thread that deforms the antenna: newest request wins, results carry their generation.
//!
//! The thread owns the last full run and the preview that continues it. A request replaces whatever waits and cancels
//! what is under way, except that a preview in progress is finished: it takes milliseconds, and dropping it would
//! freeze the picture while the pointer moves. Dropping the handle cancels and joins.

use super::live::Live;
use super::stages::{Deformed, Stages};
use super::{PipelineError, retreat, run};
use crate::project::Project;
use crate::task::{Progress, Task};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::thread::JoinHandle;

/// How thorough an answer is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// While dragging: move the last surface through the new pose.
    Live,
    /// At rest: compensate, split and check anew.
    Full,
}

/// An answer of the worker.
#[derive(Debug)]
pub struct Reply {
    /// The generation that [`Worker::request`] returned.
    pub generation: u64,
    /// The deformed antenna, or why there is none.
    pub result: Result<Box<Deformed>, PipelineError>,
    /// For a refused full request: the furthest valid project on the way from the last good one.
    pub retreat: Option<Box<Project>>,
}

/// Handle of the background thread.
#[derive(Debug)]
pub struct Worker {
    shared: Arc<Shared>,
    generation: u64,
    thread: Option<JoinHandle<()>>,
}

struct Request {
    generation: u64,
    project: Project,
    quality: Quality,
    task: Task,
}

#[derive(Default)]
struct State {
    waiting: Option<Request>,
    /// What is under way, to be cancelled by a newer request.
    running: Option<(Quality, Task)>,
    reply: Option<Reply>,
    progress: Option<Progress>,
    closing: bool,
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

impl Worker {
    /// Starts the thread; `wake` is called whenever there is news.
    ///
    /// # Panics
    /// If the system cannot start a thread.
    #[must_use]
    pub fn spawn(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let shared = Arc::new(Shared { state: Mutex::default(), news: Condvar::new(), wake: Box::new(wake) });
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("deform".to_owned())
            .spawn(move || serve(&own))
            .expect("the system can start one thread");
        Self { shared, generation: 0, thread: Some(thread) }
    }

    /// Asks for a project to be deformed, cancelling what is under way; returns the request's generation.
    pub fn request(&mut self, project: Project, quality: Quality) -> u64 {
        self.generation += 1;
        let mut state = self.shared.lock();
        cancel_running(&state);
        state.waiting = Some(Request { generation: self.generation, project, quality, task: Task::default() });
        drop(state);
        self.shared.news.notify_one();
        self.generation
    }

    /// Takes the newest answer, if there is one.
    pub fn poll(&mut self) -> Option<Reply> {
        self.shared.lock().reply.take()
    }

    /// Cancels what waits and what is under way.
    pub fn cancel(&mut self) {
        let mut state = self.shared.lock();
        state.waiting = None;
        cancel_running(&state);
    }

    /// True while a request waits or is under way.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.waiting.is_some() || state.running.is_some()
    }

    /// What the thread is doing, or `None` when idle.
    #[must_use]
    pub fn progress(&self) -> Option<Progress> {
        self.shared.lock().progress
    }
}

fn cancel_running(state: &State) {
    if let Some((Quality::Full, task)) = &state.running {
        task.cancel();
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.closing = true;
        state.waiting = None;
        if let Some((_, task)) = &state.running {
            task.cancel();
        }
        drop(state);
        self.shared.news.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was printed there; there is nothing left to save here.
            let _ended = thread.join();
        }
    }
}

fn serve(shared: &Arc<Shared>) {
    let mut memory = Memory::default();
    while let Some(request) = next(shared) {
        let progress = Arc::clone(shared);
        let task = request.task.listening(move |p| {
            progress.lock().progress = Some(p);
            (progress.wake)();
        });
        let generation = request.generation;
        let (result, retreat) = memory.answer(request.project, request.quality, &task);
        let mut state = shared.lock();
        state.running = None;
        state.progress = None;
        if !matches!(result, Err(PipelineError::Cancelled(_))) {
            state.reply = Some(Reply { generation, result: result.map(Box::new), retreat });
        }
        drop(state);
        (shared.wake)();
    }
}

fn next(shared: &Shared) -> Option<Request> {
    let mut state = shared.lock();
    loop {
        if state.closing {
            return None;
        }
        if let Some(request) = state.waiting.take() {
            state.running = Some((request.quality, request.task.clone()));
            return Some(request);
        }
        state = shared.news.wait(state).unwrap_or_else(std::sync::PoisonError::into_inner);
    }
}

/// What the thread remembers between requests.
#[derive(Default)]
struct Memory {
    last_good: Option<(Project, Stages)>,
    live: Option<Live>,
}

type Answer = (Result<Deformed, PipelineError>, Option<Box<Project>>);

impl Memory {
    fn answer(&mut self, project: Project, quality: Quality, task: &Task) -> Answer {
        match quality {
            Quality::Live => {
                if let Some(result) = self.preview(&project, task) {
                    return (result, None);
                }
                self.full(project, task)
            }
            Quality::Full => self.full(project, task),
        }
    }

    /// A preview of the project, if the last full run can be continued to it.
    fn preview(&mut self, project: &Project, task: &Task) -> Option<Result<Deformed, PipelineError>> {
        let (good, stages) = self.last_good.as_ref()?;
        if self.live.is_none() {
            match Live::new(good.clone(), stages.clone(), task) {
                Ok(live) => self.live = Some(live),
                Err(error) => return Some(Err(error)),
            }
        }
        let live = self.live.as_mut().filter(|live| live.serves(project))?;
        Some(live.preview(project))
    }

    fn full(&mut self, project: Project, task: &Task) -> Answer {
        match run(&project, task) {
            Ok(stages) => {
                let deformed = stages.deformed.clone();
                self.last_good = Some((project, stages));
                self.live = None;
                (Ok(deformed), None)
            }
            Err(PipelineError::Cancelled(cancelled)) => (Err(cancelled.into()), None),
            Err(error) => {
                let back = self.last_good.as_ref().map(|(good, _)| retreat(good, &project, task));
                match back {
                    Some(Err(cancelled)) => (Err(cancelled.into()), None),
                    Some(Ok(valid)) => (Err(error), Some(Box::new(valid))),
                    None => (Err(error), None),
                }
            }
        }
    }
}
