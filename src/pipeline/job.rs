//! A thread that does one kind of long work: newest request wins, and each answer says what was asked.
//!
//! A request that can be worked on ([`Work`]) replaces whatever waits and cancels what is under way. While it is worked
//! on there is its progress, and whatever the work shows of itself meanwhile, the newest only. Dropping the handle
//! cancels and joins. A panic of the work is caught and becomes an answer.
//!
//! Not handled: work that remembers something between requests, as the [`Worker`](super::worker::Worker) does.

use super::PipelineError;
use crate::task::{Progress, Task};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::thread::JoinHandle;

/// A request with the work that answers it.
pub trait Work: Clone + Send + 'static {
    /// What comes of it.
    type Output: Send + 'static;
    /// What it shows of itself while it is under way.
    type Live: Send + 'static;
    /// Name of the thread.
    const NAME: &'static str;

    /// Does the work; what it hands to `show` is to be had from [`Job::live`].
    ///
    /// # Errors
    /// [`PipelineError`] naming what to change.
    fn work(&self, task: &Task, show: &dyn Fn(Self::Live)) -> Result<Self::Output, PipelineError>;
}

/// Why there is no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// The project cannot be computed as asked.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// A fault of the program.
    #[error("it broke off by a fault of this program: try another density, or change the shape a little")]
    BrokeOff,
}

impl JobError {
    /// Where to look in the deformed antenna, mm; empty where no place is to blame.
    #[must_use]
    pub fn places_mm(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Pipeline(error) => error.places_mm(),
            Self::BrokeOff => Vec::new(),
        }
    }
}

/// An answer.
#[derive(Debug)]
pub struct Reply<W: Work> {
    /// What was asked.
    pub request: W,
    /// What came of it, or why nothing did.
    pub result: Result<Box<W::Output>, JobError>,
}

/// Handle of the background thread.
#[derive(Debug)]
pub struct Job<W: Work> {
    shared: Arc<Shared<W>>,
    thread: Option<JoinHandle<()>>,
}

struct State<W: Work> {
    waiting: Option<(W, Task)>,
    running: Option<Task>,
    reply: Option<Reply<W>>,
    progress: Option<Progress>,
    live: Option<W::Live>,
    closing: bool,
}

impl<W: Work> State<W> {
    fn cancel(&mut self) {
        (self.waiting, self.progress, self.live, self.reply) = (None, None, None, None);
        if let Some(task) = self.running.take() {
            task.cancel();
        }
    }
}

struct Shared<W: Work> {
    state: Mutex<State<W>>,
    news: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl<W: Work> std::fmt::Debug for Shared<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").finish_non_exhaustive()
    }
}

impl<W: Work> Shared<W> {
    fn lock(&self) -> MutexGuard<'_, State<W>> {
        // A thread that panicked left plain values behind, all of them valid.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Changes the state on behalf of a task, unless it belongs to a newer request by now, or to none.
    fn update(&self, task: &Task, change: impl FnOnce(&mut State<W>)) {
        let mut state = self.lock();
        if !task.is_cancelled() {
            change(&mut state);
            drop(state);
            (self.wake)();
        }
    }
}

impl<W: Work> Job<W> {
    /// Starts the thread; `wake` is called whenever there is news.
    ///
    /// # Panics
    /// If the system cannot start a thread.
    #[must_use]
    pub fn spawn(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let state = State { waiting: None, running: None, reply: None, progress: None, live: None, closing: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), news: Condvar::new(), wake: Box::new(wake) });
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name(W::NAME.to_owned())
            .spawn(move || serve(&own))
            .expect("the system can start one thread");
        Self { shared, thread: Some(thread) }
    }

    /// Asks for something, cancelling what is under way and forgetting an answer that was not fetched.
    pub fn request(&mut self, request: W) {
        let mut state = self.shared.lock();
        state.cancel();
        state.waiting = Some((request, Task::default()));
        drop(state);
        self.shared.news.notify_one();
    }

    /// Takes the answer, if there is one. What was cancelled has none.
    pub fn poll(&mut self) -> Option<Reply<W>> {
        self.shared.lock().reply.take()
    }

    /// Cancels what waits and what is under way, and forgets an answer that was not fetched.
    pub fn cancel(&mut self) {
        self.shared.lock().cancel();
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

    /// Takes the newest that the work under way has shown of itself.
    #[must_use]
    pub fn live(&self) -> Option<W::Live> {
        self.shared.lock().live.take()
    }
}

impl<W: Work> Drop for Job<W> {
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

fn serve<W: Work>(shared: &Arc<Shared<W>>) {
    while let Some((request, task)) = next(shared) {
        let (sink, own) = (Arc::clone(shared), task.clone());
        let listened = task.listening(move |p| sink.update(&own, |state| state.progress = Some(p)));
        let show = |live| shared.update(&task, |state| state.live = Some(live));
        // The work leaves nothing behind but its result, so that nothing half done can be seen after a panic.
        let result = match catch_unwind(AssertUnwindSafe(|| request.work(&listened, &show))) {
            Ok(result) => result.map(Box::new).map_err(JobError::from),
            Err(_) => Err(JobError::BrokeOff),
        };
        shared.update(&task, |state| {
            (state.running, state.progress, state.live) = (None, None, None);
            state.reply = Some(Reply { request, result });
        });
    }
}

fn next<W: Work>(shared: &Shared<W>) -> Option<(W, Task)> {
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

/// Waits for an answer; generous, because machines are slow and busy.
#[cfg(test)]
pub(super) fn answer<W: Work>(job: &mut Job<W>) -> Reply<W> {
    let start = std::time::Instant::now();
    loop {
        if let Some(reply) = job.poll() {
            return reply;
        }
        assert!(start.elapsed().as_secs() < 300, "no answer");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts to its number, or panics at once.
    #[derive(Clone, Debug, PartialEq)]
    enum Count {
        To(usize),
        /// Until it is cancelled.
        Forever,
        Panic,
    }

    impl Work for Count {
        type Output = usize;
        type Live = usize;
        const NAME: &'static str = "count";

        fn work(&self, task: &Task, show: &dyn Fn(usize)) -> Result<usize, PipelineError> {
            let end = match self {
                Self::To(end) => *end,
                Self::Forever => usize::MAX,
                Self::Panic => panic!("on purpose"),
            };
            let phase = task.phase("counting", end);
            for k in 0..end {
                task.check()?;
                phase.advance(1);
                show(k);
            }
            Ok(end)
        }
    }

    #[test]
    fn work_shows_itself_until_it_is_cancelled() {
        let mut job = Job::spawn(|| ());
        job.request(Count::Forever);
        let start = std::time::Instant::now();
        let mut seen = Vec::new();
        while seen.len() < 3 {
            assert!(start.elapsed().as_secs() < 60, "nothing is shown");
            seen.extend(job.live());
        }
        assert!(seen.is_sorted() && job.progress().is_some(), "one after the other: {seen:?}");
        job.cancel();
        assert!(!job.is_busy() && job.live().is_none() && job.progress().is_none(), "nothing is left over");
        job.request(Count::To(5));
        assert_eq!(answer(&mut job).result, Ok(Box::new(5)), "the next one is answered");
        assert!(job.live().is_none() && job.progress().is_none() && job.poll().is_none(), "and leaves nothing over");
    }

    #[test]
    fn a_panic_is_an_answer_and_the_thread_goes_on() {
        let mut job = Job::spawn(|| ());
        job.request(Count::Panic);
        let reply = answer(&mut job);
        assert_eq!((reply.request, reply.result), (Count::Panic, Err(JobError::BrokeOff)), "said");
        job.request(Count::To(2));
        assert_eq!(answer(&mut job).result, Ok(Box::new(2)), "still at work");
    }

    #[test]
    fn dropping_the_handle_ends_the_work() {
        let mut job = Job::spawn(|| ());
        job.request(Count::Forever);
        while job.progress().is_none() {
            std::thread::yield_now();
        }
        drop(job);
    }
}
