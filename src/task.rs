//! Cancel and progress: the one thing that a long stage is handed besides its input.
//!
//! A stage calls [`Task::check`] every few thousand elements and reports how far it is through a [`Phase`]. Neither
//! costs more than an atomic operation, and a [`Task::default`] listens to nothing. Stages run on as many threads as
//! they like: everything here can be shared.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The work was called off; not a failure, and nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// How far one phase of a long stage is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, as a short phrase ("computing weights").
    pub phase: &'static str,
    /// Elements done so far, at most `total`.
    pub done: usize,
    /// Elements in this phase; 0 when not known beforehand.
    pub total: usize,
}

type Listener = dyn Fn(Progress) + Send + Sync;

/// Cancel flag and progress listener of one piece of work; clones share both.
#[derive(Clone, Default)]
pub struct Task {
    cancelled: Arc<AtomicBool>,
    listener: Option<Arc<Listener>>,
}

impl fmt::Debug for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Task").field("cancelled", &self.is_cancelled()).finish_non_exhaustive()
    }
}

impl Task {
    /// Makes a task whose progress goes to `listener` (called from any thread).
    pub fn with_progress(listener: impl Fn(Progress) + Send + Sync + 'static) -> Self {
        Self { cancelled: Arc::default(), listener: Some(Arc::new(listener)) }
    }

    /// A task that shares this one's cancel flag and reports to `listener`.
    #[must_use]
    pub fn listening(&self, listener: impl Fn(Progress) + Send + Sync + 'static) -> Self {
        Self { cancelled: Arc::clone(&self.cancelled), listener: Some(Arc::new(listener)) }
    }

    /// Asks whoever works on this task to stop soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// True once [`Self::cancel`] was called on this task or a clone of it.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Returns an error once the task is cancelled, for use with `?`.
    ///
    /// # Errors
    /// [`Cancelled`] after [`Self::cancel`].
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Begins a phase of `total` elements and reports it.
    #[must_use]
    pub fn phase(&self, name: &'static str, total: usize) -> Phase<'_> {
        let phase = Phase { task: self, name, total, done: AtomicUsize::new(0) };
        phase.advance(0);
        phase
    }
}

/// One phase of a [`Task`]; threads may share it.
#[derive(Debug)]
pub struct Phase<'a> {
    task: &'a Task,
    name: &'static str,
    total: usize,
    done: AtomicUsize,
}

impl Phase<'_> {
    /// Reports `count` more elements done.
    pub fn advance(&self, count: usize) {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        if let Some(listener) = &self.task.listener {
            listener(Progress { phase: self.name, done: done.min(self.total), total: self.total });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn a_clone_cancels_the_original() {
        let task = Task::default();
        assert_eq!(task.check(), Ok(()), "not yet cancelled");
        task.clone().cancel();
        assert_eq!(task.check(), Err(Cancelled), "cancelled through the clone");
    }

    #[test]
    fn progress_never_passes_the_total() {
        let seen = Arc::new(Mutex::new(Vec::new()));
        let sink = Arc::clone(&seen);
        let task = Task::with_progress(move |p| sink.lock().unwrap().push(p.done));
        let phase = task.phase("counting", 3);
        phase.advance(2);
        phase.advance(2);
        assert_eq!(*seen.lock().unwrap(), [0, 2, 3], "clamped at three");
    }
}
