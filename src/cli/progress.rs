//! The progress line and Ctrl-C.

use super::CANCELLED;
use crate::task::{Progress as Step, Task};
use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The line is rewritten at most this often: faster cannot be read and costs time over slow connections.
const INTERVAL: Duration = Duration::from_millis(100);
/// Back to the line's start, and erase it.
const CLEAR: &str = "\r\x1b[2K";

/// The task of one command: cancelled by Ctrl-C, with its progress on the standard error if that is a terminal.
pub(super) struct Progress {
    task: Task,
    line: Option<Arc<Mutex<Line>>>,
}

#[derive(Default)]
struct Line {
    written: Option<Instant>,
}

impl Progress {
    pub(super) fn start() -> Self {
        let line = std::io::stderr().is_terminal().then(Arc::<Mutex<Line>>::default);
        let task = match &line {
            None => Task::default(),
            Some(line) => {
                let line = Arc::clone(line);
                Task::with_progress(move |step| Line::show(&line, step))
            }
        };
        let on_interrupt = task.clone();
        // Without a handler Ctrl-C ends the process at once, which leaves no broken file either; so does a second one,
        // for whoever does not want to wait.
        let _ = ctrlc::set_handler(move || {
            if on_interrupt.is_cancelled() {
                std::process::exit(i32::from(CANCELLED));
            }
            on_interrupt.cancel();
        });
        Self { task, line }
    }

    pub(super) fn task(&self) -> &Task {
        &self.task
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        let wrote = self.line.as_ref().and_then(|line| line.lock().ok()?.written);
        if wrote.is_some() {
            eprint!("{CLEAR}");
        }
    }
}

impl Line {
    fn show(line: &Mutex<Self>, step: Step) {
        // A thread that finds the line in use skips it: progress never waits.
        let Ok(mut line) = line.try_lock() else { return };
        if line.written.is_some_and(|last| last.elapsed() < INTERVAL) {
            return;
        }
        line.written = Some(Instant::now());
        let mut err = std::io::stderr().lock();
        // Not being able to show progress is no reason to stop.
        let _ = match step.total {
            0 => write!(err, "{CLEAR}{} ...", step.phase),
            total => write!(err, "{CLEAR}{} {:3} %", step.phase, 100 * step.done / total),
        };
        let _ = err.flush();
    }
}
