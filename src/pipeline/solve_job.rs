//! Solving in the background, with the curve as it comes.
//!
//! While the field runs, about once a second S11 of the record so far can be had ([`LiveRun`]), with the time left.

use super::job::{Job, Work};
use super::stored;
use super::{PipelineError, RunFigures, Shape, SolveSettings, Solved, Stored, solve};
use crate::project::Project;
use crate::results::{Cut, CutPlane, FarField, FittedResonance, Resonance, Sweep};
use crate::task::Task;
use crate::tlm::Checkpoint;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};
use std::time::{Duration, Instant};

/// What is to be solved.
#[derive(Clone, Debug)]
pub struct SolveRequest {
    /// The project that the result will belong to.
    pub project: Project,
    /// Which of its shapes.
    pub shape: Shape,
    /// How.
    pub settings: SolveSettings,
    /// Where the run leaves its state when it is called off, and goes on from when it is asked for again.
    pub kept: Arc<Mutex<Option<Checkpoint>>>,
}

impl SolveRequest {
    /// A request for a run from the start.
    #[must_use]
    pub fn new(project: Project, shape: Shape, settings: SolveSettings) -> Self {
        Self { project, shape, settings, kept: Arc::default() }
    }

    /// Whether another request asks for the same result.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        (&self.project, self.shape, &self.settings) == (&other.project, other.shape, &other.settings)
    }

    /// What the result is kept as.
    #[must_use]
    pub fn job(&self) -> stored::Job {
        stored::Job::new(&self.project, self.shape, &self.settings)
    }

    fn state(&self) -> MutexGuard<'_, Option<Checkpoint>> {
        // Whole or not there, also after a panic.
        self.kept.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// A run under way.
#[derive(Clone, Debug)]
pub struct LiveRun {
    /// S11 of the record so far: rippled until the field has decayed; `None` while the pulse still comes in.
    pub sweep: Option<Sweep>,
    /// Number of cells.
    pub n_tets: usize,
    /// Steps done.
    pub n_done: usize,
    /// How far the reflected voltage has fallen, dB (negative); `None` while the pulse still comes in.
    pub decay_db: Option<f64>,
    /// Cells times steps per second.
    pub speed: f64,
    /// Time that is left, s, should the field go on to decay as it did.
    pub seconds_left: f64,
}

/// What is kept of a solved antenna: the mesh is not.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// S11 at the ground's top, 50 ohm.
    pub sweep: Sweep,
    /// Resonance and band by the smallest |S11|.
    pub resonance: Option<Resonance>,
    /// The strongest resonance by fit to the late record.
    pub fitted: Option<FittedResonance>,
    /// Figures of the run.
    pub figures: RunFigures,
    /// Far fields, by ascending frequency; of a result that was kept in a file those that it held.
    pub patterns: Vec<Pattern>,
}

impl RunResult {
    /// As it is kept in a file.
    #[must_use]
    pub fn stored(&self, job: stored::Job) -> Stored {
        Stored::new(job, &self.sweep, self.fitted, self.figures, self.patterns.iter().map(|p| &p.field))
    }
}

impl From<Solved> for RunResult {
    fn from(solved: Solved) -> Self {
        Self {
            resonance: solved.sweep.resonance(),
            fitted: solved.fitted,
            figures: RunFigures::of(&solved),
            sweep: solved.sweep,
            patterns: solved.far_fields.into_iter().map(Pattern::from).collect(),
        }
    }
}

impl From<&Stored> for RunResult {
    fn from(stored: &Stored) -> Self {
        let sweep = stored.sweep();
        Self {
            resonance: sweep.resonance(),
            fitted: stored.fitted,
            figures: stored.figures,
            sweep,
            patterns: stored.fields.iter().cloned().map(Pattern::from).collect(),
        }
    }
}

/// A far field with what a picture of it needs, found when it is asked for first: some milliseconds each.
#[derive(Clone, Debug)]
pub struct Pattern {
    /// The field.
    pub field: FarField,
    cuts: OnceLock<[Cut; 2]>,
    max: OnceLock<(f64, [f64; 2])>,
}

impl Pattern {
    /// Directivity around the E and the H plane.
    #[must_use]
    pub fn cuts(&self) -> &[Cut; 2] {
        self.cuts.get_or_init(|| [CutPlane::E, CutPlane::H].map(|plane| self.field.cut(plane)))
    }

    /// Greatest directivity, dBi, with its theta and phi.
    #[must_use]
    pub fn max(&self) -> (f64, [f64; 2]) {
        *self.max.get_or_init(|| self.field.max_directivity())
    }
}

impl From<FarField> for Pattern {
    fn from(field: FarField) -> Self {
        Self { field, cuts: OnceLock::new(), max: OnceLock::new() }
    }
}

/// The thread that solves.
pub type SolveJob = Job<SolveRequest>;

/// Frequencies of a live curve: as many as a plot has room for.
const N_LIVE: usize = 200;
/// A live curve is made at most this often: it costs a few steps of the field.
const PAUSE: Duration = Duration::from_secs(1);

impl Work for SolveRequest {
    type Output = RunResult;
    type Live = LiveRun;
    const NAME: &'static str = "solve";

    fn work(&self, task: &Task, show: &dyn Fn(LiveRun)) -> Result<RunResult, PipelineError> {
        let mut shown: Option<Instant> = None;
        let mut watch = |running: &super::Running<'_>| {
            if !running.goes_on && task.is_cancelled() {
                *self.state() = Some(running.checkpoint());
            }
            if !running.goes_on || shown.is_some_and(|last| last.elapsed() < PAUSE) {
                return;
            }
            show(LiveRun {
                sweep: running.decay_db.map(|_| running.sweep(N_LIVE)),
                n_tets: running.n_tets,
                n_done: running.record.total.len(),
                decay_db: running.decay_db,
                speed: running.speed,
                seconds_left: running.seconds_left,
            });
            shown = Some(Instant::now());
        };
        let before = self.state().take();
        let solved = solve(&self.project, self.shape, &self.settings, before.as_ref(), &mut watch, task);
        if solved.is_err() {
            // Called off before the field went on: nothing is lost.
            let mut state = self.state();
            *state = state.take().or(before);
        }
        Ok(solved?.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::job::answer;
    use crate::pipeline::{Density, MeshSettings, StopRule};
    use crate::units::GHZ;

    #[test]
    fn a_run_shows_its_curve_and_a_cancelled_one_is_not_answered() {
        let mesh = MeshSettings { density: Density::Coarse, ..MeshSettings::default() };
        // A wide band has a short pulse.
        let usual = SolveSettings::new(mesh, [8.0 * GHZ, 40.0 * GHZ]);
        let endless = StopRule::Decay { db: 200.0 };
        let settings = SolveSettings { longest: 1e-6, stop: endless, pattern_freqs: vec![11.0 * GHZ], ..usual };
        let request = SolveRequest::new(Project::default(), Shape::Flat, settings.clone());
        let mut job = SolveJob::spawn(|| ());
        job.request(request.clone());
        let start = Instant::now();
        let sweep = loop {
            assert!(start.elapsed() < Duration::from_secs(300), "no curve");
            if let Some(LiveRun { sweep: Some(sweep), .. }) = job.live() {
                break sweep;
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        assert_eq!(sweep.freqs.len(), N_LIVE + 1, "over the band");
        assert!(sweep.s11.iter().all(|s| s.norm().is_finite()), "numbers");
        job.cancel();
        assert!(!job.is_busy() && job.live().is_none(), "idle at once");
        let impossible = SolveRequest::new(Project::default(), Shape::Cylinder, settings);
        job.request(impossible.clone());
        assert_eq!(answer(&mut job).result.unwrap_err(), PipelineError::NoCylinder.into(), "the next one is answered");
        let n_kept = || request.state().as_ref().map(|state| state.record.total.len()).expect("it left its state");
        let n_before = n_kept();
        // Called off again before the field goes on.
        job.request(request.clone());
        while job.progress().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        job.cancel();
        job.request(impossible);
        assert!(answer(&mut job).result.is_err() && n_kept() == n_before, "nothing is lost");
        job.request(request.clone());
        let n_after = loop {
            assert!(start.elapsed() < Duration::from_secs(300), "it does not go on");
            if let Some(live) = job.live() {
                break live.n_done;
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        assert!(n_after > n_before && request.state().is_none(), "{n_after} steps, called off after {n_before}");
    }
}
