//! The project without compensation, by WL and isometrically: computed beside it, looked at without changing it.
//!
//! Nothing here draws. A comparison stays until another one takes its place; whether it still fits is a comparison of
//! projects.

use super::app::App;
use super::heat::OnShow;
use super::session::{Pose, Session};
use super::status::Weight;
use crate::pipeline::compare_job::{CompareJob, CompareRequest, Compared, MODES};
use crate::project::{CompensationMode, Project};
use crate::task::Progress;
use std::sync::Arc;

/// Numbers of compared antennas begin here: those of the session are counted from 1.
const FIRST_SERIAL: u64 = 1 << 30;

/// A comparison that is done.
#[derive(Debug)]
struct Found {
    request: CompareRequest,
    compared: Compared,
    /// The posed cages, as drawn.
    poses: [Option<Pose>; 3],
    serial: u64,
}

/// The comparison of the open project.
#[derive(Debug)]
pub(super) struct CompareSession {
    job: CompareJob,
    found: Option<Found>,
    serial: u64,
}

fn place(mode: CompensationMode) -> usize {
    MODES.iter().position(|m| *m == mode).unwrap_or(0)
}

/// A way of compensation in a word.
pub(super) fn mode_text(mode: CompensationMode) -> &'static str {
    match mode {
        CompensationMode::None => "Raw",
        CompensationMode::Wl => "WL",
        CompensationMode::Isometric => "Isometric",
    }
}

impl CompareSession {
    /// Starts with nothing compared.
    pub(super) fn new(job: CompareJob) -> Self {
        Self { job, found: None, serial: 0 }
    }

    /// Begins to compare a project.
    pub(super) fn start(&mut self, project: &Project) {
        self.job.request(CompareRequest::new(project));
    }

    /// Calls it off; what was found stays.
    pub(super) fn cancel(&mut self) {
        self.job.cancel();
    }

    /// Forgets everything: another project was opened.
    pub(super) fn clear(&mut self) {
        self.job.cancel();
        self.found = None;
    }

    /// Whether a comparison is under way.
    pub(super) fn is_busy(&self) -> bool {
        self.job.is_busy()
    }

    /// What is being done.
    pub(super) fn progress(&self) -> Option<Progress> {
        self.job.progress()
    }

    /// What was found last.
    pub(super) fn compared(&self) -> Option<&Compared> {
        self.found.as_ref().map(|found| &found.compared)
    }

    /// Whether the project has changed since, in more than how it is compensated.
    pub(super) fn is_stale(&self, project: &Project) -> bool {
        self.found.as_ref().is_some_and(|found| found.request != CompareRequest::new(project))
    }

    /// The antenna by one way of compensation.
    pub(super) fn on_show(&self, mode: CompensationMode) -> Option<OnShow<'_>> {
        let found = self.found.as_ref()?;
        let deformed = found.compared[place(mode)].as_ref().ok()?;
        Some(OnShow { deformed, serial: found.serial + place(mode) as u64 })
    }

    /// The antenna on show: that of the way looked at, else the session's.
    pub(super) fn on_show_or<'a>(&'a self, session: &'a Session, mode: Option<CompensationMode>) -> Option<OnShow<'a>> {
        let own = || session.shown().map(|s| OnShow { deformed: &s.deformed, serial: s.serial });
        mode.and_then(|mode| self.on_show(mode)).or_else(own)
    }

    /// Its cage.
    pub(super) fn pose(&self, mode: CompensationMode) -> Option<&Pose> {
        self.found.as_ref()?.poses[place(mode)].as_ref()
    }

    /// Takes an answer, if there is one; why nothing could be compared.
    pub(super) fn sync(&mut self) -> Option<String> {
        let reply = self.job.poll()?;
        let compared = match reply.result {
            Ok(compared) => *compared,
            Err(error) => return Some(error.to_string()),
        };
        let serial = FIRST_SERIAL + 3 * self.serial;
        self.serial += 1;
        let pose = |k: usize| {
            let deformed = compared[k].as_ref().ok()?;
            // Out of the way of the poses of the session, which count from its answers.
            let serial = (serial + k as u64) << 32;
            Some(Pose { cage: Arc::clone(&deformed.cage), vertices: deformed.posed.clone(), serial })
        };
        let poses = [0, 1, 2].map(pose);
        self.found = Some(Found { request: reply.request, compared, poses, serial });
        None
    }
}

impl App {
    /// Takes what the comparing thread has to say; a look at something that is out of date ends.
    pub(super) fn sync_compare(&mut self) {
        if let Some(why) = self.compare.sync() {
            self.messages.say(Weight::Error, &format!("Nothing to compare: {why}"));
        }
        let has_found = self.state.preview.is_some_and(|mode| self.compare.on_show(mode).is_some());
        if !has_found || self.compare.is_stale(self.session.project()) {
            self.state.preview = None;
        }
    }
}
