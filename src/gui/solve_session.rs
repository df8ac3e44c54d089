//! The runs of the field solver: those that are done, the one under way, and the thread that does it.
//!
//! Nothing here draws. Finished runs stay until they are removed or another project is opened, even when the project
//! has gone on or a new run fails or is called off; whether one still fits is a comparison of projects.

use super::mesh_session::grouped;
use super::places::Refusal;
use super::theme::N_SERIES;
use super::ui_state::{SolveUi, Stop};
use crate::io::IoError;
use crate::pipeline::solve_job::{LiveRun, RunResult, SolveJob, SolveRequest};
use crate::pipeline::{Estimate, Job, MeshSettings, SolveSettings, StopRule, Stored, estimate, results_dir};
use crate::project::Project;
use crate::report::job_name as name;
use crate::task::Progress;
use crate::tet::Metal;
use crate::units::GHZ;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Instant;

/// Cells times steps per second before any run has said how fast this machine is.
const USUAL_SPEED: f64 = 4e7;

/// A finished run, a number that tells it from others, and how it is shown.
#[derive(Clone, Debug)]
pub(super) struct FinishedRun {
    pub(super) serial: u64,
    pub(super) job: Job,
    pub(super) result: RunResult,
    pub(super) name: String,
    /// Place among the theme's colours of curves.
    pub(super) color: usize,
    pub(super) is_shown: bool,
}

impl FinishedRun {
    /// Whether what was solved has changed since: the flat antenna does not change with the cage.
    pub(super) fn is_stale(&self, project: &Project) -> bool {
        self.job.is_stale(project)
    }
}

/// Something that happened to the solving.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum SolveNews {
    /// There is a result.
    Done(String),
    /// There is none, and why.
    Failed(String),
}

/// The runs of the open project.
#[derive(Debug)]
pub(super) struct SolveSession {
    job: SolveJob,
    runs: Vec<FinishedRun>,
    live: Option<LiveRun>,
    /// The last request, while it is under way and after it was called off.
    asked: Option<SolveRequest>,
    /// Whether the field of the last request has run, so that it can go on after it is called off.
    has_run: bool,
    /// What the last estimate was for, and the estimate.
    estimate: Option<(SolveRequest, Result<Estimate, String>)>,
    started: Option<Instant>,
    error: Option<Refusal>,
    serial: u64,
}

impl SolveSession {
    /// Starts with no run.
    pub(super) fn new(job: SolveJob) -> Self {
        Self {
            job,
            runs: Vec::new(),
            live: None,
            asked: None,
            has_run: false,
            estimate: None,
            started: None,
            error: None,
            serial: 0,
        }
    }

    /// The finished runs, oldest first.
    pub(super) fn runs(&self) -> &[FinishedRun] {
        &self.runs
    }

    /// The runs whose curves are to be seen.
    pub(super) fn shown(&self) -> impl DoubleEndedIterator<Item = &FinishedRun> {
        self.runs.iter().filter(|run| run.is_shown)
    }

    /// The run under way, once the field runs.
    pub(super) fn live(&self) -> Option<&LiveRun> {
        self.live.as_ref()
    }

    /// Why the last attempt has no result.
    pub(super) fn error(&self) -> Option<&Refusal> {
        self.error.as_ref()
    }

    /// Whether a run is under way.
    pub(super) fn is_busy(&self) -> bool {
        self.job.is_busy()
    }

    /// What is being done.
    pub(super) fn progress(&self) -> Option<Progress> {
        self.job.progress()
    }

    /// Seconds since the run under way was begun.
    pub(super) fn elapsed(&self) -> f64 {
        self.started.map_or(0.0, |start| start.elapsed().as_secs_f64())
    }

    /// Begins to solve a project as chosen.
    pub(super) fn start(&mut self, project: &Project, chosen: &SolveUi) {
        self.has_run = false;
        self.ask(request(project, chosen));
    }

    /// Goes on with the run that was called off.
    pub(super) fn resume(&mut self) {
        if let Some(request) = self.asked.take() {
            self.ask(request);
        }
    }

    /// The run that was called off and can go on.
    pub(super) fn interrupted(&self) -> Option<String> {
        self.asked.as_ref().filter(|_| !self.is_busy()).map(|request| name(&request.job()))
    }

    fn ask(&mut self, request: SolveRequest) {
        (self.error, self.live) = (None, None);
        self.started = Some(Instant::now());
        self.asked = Some(request.clone());
        self.job.request(request);
    }

    /// What a run of a project as chosen would take, or why it cannot be.
    pub(super) fn estimate(&mut self, project: &Project, chosen: &SolveUi) -> Result<Estimate, String> {
        let request = request(project, chosen);
        if let Some((_, estimate)) = self.estimate.as_ref().filter(|(of, _)| of.is_same(&request)) {
            return estimate.clone();
        }
        let speed = self.runs.last().map_or(USUAL_SPEED, |run| run.result.figures.tet_steps_per_second);
        let found = estimate(project, request.shape, &request.settings, speed).map_err(|e| e.to_string());
        self.estimate = Some((request, found.clone()));
        found
    }

    /// Calls the run off; what is on show stays.
    ///
    /// It can go on later if the field ran already.
    pub(super) fn cancel(&mut self) {
        self.job.cancel();
        self.live = None;
        if !self.has_run {
            self.asked = None;
        }
    }

    /// Forgets everything: another project was opened.
    pub(super) fn clear(&mut self) {
        self.cancel();
        self.runs.clear();
        (self.asked, self.estimate, self.error) = (None, None, None);
    }

    /// The finished run of a number, to change how it is shown.
    pub(super) fn run_mut(&mut self, serial: u64) -> Option<&mut FinishedRun> {
        self.runs.iter_mut().find(|run| run.serial == serial)
    }

    /// Forgets a finished run.
    pub(super) fn remove(&mut self, serial: u64) {
        self.runs.retain(|run| run.serial != serial);
    }

    /// The colour that the next run will have: the first that no other one has.
    pub(super) fn next_color(&self) -> usize {
        let used: BTreeSet<usize> = self.runs.iter().map(|run| run.color).collect();
        (0..N_SERIES).find(|color| !used.contains(color)).unwrap_or(self.runs.len() % N_SERIES)
    }

    /// Adds a finished run; one of the very same job takes the place of the older.
    pub(super) fn add(&mut self, job: Job, result: RunResult) {
        self.serial += 1;
        if let Some(same) = self.runs.iter_mut().find(|run| run.job == job) {
            (same.serial, same.result, same.is_shown) = (self.serial, result, true);
            return;
        }
        let (color, plain) = (self.next_color(), name(&job));
        let is_taken = |name: &str| self.runs.iter().any(|run| run.name == name);
        let numbered = (2..).map(|n| format!("{plain} ({n})"));
        let name = std::iter::once(plain.clone()).chain(numbered).find(|n| !is_taken(n)).unwrap_or_default();
        self.runs.push(FinishedRun { serial: self.serial, job, result, name, color, is_shown: true });
    }

    /// Keeps the results beside a project file, but for those that are kept there as they are.
    pub(super) fn keep(&self, project_file: &Path) -> Result<(), IoError> {
        let dir = results_dir(project_file);
        for run in &self.runs {
            let ours = run.result.stored(run.job.clone());
            if !matches!(Stored::find(&run.job, &dir), Ok(Some(kept)) if kept == ours) {
                ours.save(&dir)?;
            }
        }
        Ok(())
    }

    /// Adds the newest results kept beside a project file, and shows those of the project as it is, or else the last;
    /// says why one of them cannot be read.
    pub(super) fn add_kept(&mut self, project: &Project, project_file: &Path) -> Result<(), IoError> {
        let mut outcome = Ok(());
        for found in Stored::newest(&results_dir(project_file), N_SERIES) {
            match found {
                Ok(stored) => self.add(stored.job().clone(), RunResult::from(&stored)),
                Err(error) => outcome = Err(error),
            }
        }
        self.runs.iter_mut().for_each(|run| run.is_shown = !run.is_stale(project));
        if self.shown().next().is_none()
            && let Some(last) = self.runs.last_mut()
        {
            last.is_shown = true;
        }
        outcome
    }

    /// Takes what the thread has to say.
    pub(super) fn sync(&mut self) -> Option<SolveNews> {
        if let Some(live) = self.job.live() {
            (self.live, self.has_run) = (Some(live), true);
        }
        let reply = self.job.poll()?;
        (self.live, self.asked, self.estimate) = (None, None, None);
        match reply.result {
            Ok(result) => {
                let cells = grouped(result.figures.tets);
                let found = match &result.resonance {
                    Some(r) => format!("{:.1} dB at {:.3} GHz", r.depth_db, r.freq / GHZ),
                    None => "no resonance in the band".to_owned(),
                };
                let news =
                    SolveNews::Done(format!("Solved: {found}, {cells} cells in {:.0} s", result.figures.seconds));
                self.add(reply.request.job(), *result);
                Some(news)
            }
            Err(error) => {
                let refusal = Refusal::new(&error, reply.request.project, reply.request.shape);
                let text = self.error.insert(refusal).text.clone();
                Some(SolveNews::Failed(text))
            }
        }
    }
}

/// What is to be solved of a project, as chosen.
pub(super) fn request(project: &Project, chosen: &SolveUi) -> SolveRequest {
    let mesh = MeshSettings { density: chosen.density, metal: Metal::Sheet };
    let typed = chosen.band_ghz.map(|band| band.map(|f| f * GHZ));
    let band = typed.unwrap_or_else(|| SolveSettings::usual_band(project));
    let stop = match chosen.stop {
        Stop::Decayed => StopRule::Decay { db: chosen.decay_db },
        Stop::Settled => StopRule::SETTLED,
    };
    let settings = SolveSettings { stop, longest: chosen.longest_ns * 1e-9, ..SolveSettings::new(mesh, band) };
    SolveRequest::new(project.clone(), chosen.shape, settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::session::first_project;
    use crate::pipeline::{Density, Shape};
    use crate::project::CompensationMode;

    #[test]
    fn a_run_is_named_after_what_was_solved() {
        let chosen = SolveUi::default();
        let of = |project: &Project, chosen: &SolveUi| name(&request(project, chosen).job());
        let mut project = first_project();
        assert_eq!(of(&project, &chosen), "R 10 H, raw", "one bend");
        assert_eq!(of(&project, &SolveUi { shape: Shape::Cylinder, ..chosen.clone() }), "Cylinder R 10 H", "exact");
        project.settings.compensation = CompensationMode::Isometric;
        project.hand_edits.insert(3, [0.1, 0.0, 0.0]);
        let coarse = SolveUi { density: Density::Coarse, ..chosen };
        assert_eq!(of(&project, &coarse), "Deformed, isometric, coarse", "moved by hand");
        assert_eq!(of(&project, &SolveUi { shape: Shape::Flat, ..coarse }), "Flat, coarse", "flat");
    }
}
