//! From a project to S11: mesh, network, run, sweep.

use super::PipelineError;
use super::mesh::{MeshSettings, Meshed, Shape, mesh};
use crate::project::Project;
use crate::results::{FeedLine, Sweep, frequencies, sweep};
use crate::task::Task;
use crate::tlm::{Network, NetworkSettings, Pulse, Record, Run, StepLimit};
use crate::units::from_mm;
use std::time::{Duration, Instant};

/// What is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveSettings {
    /// The mesh.
    pub mesh: MeshSettings,
    /// Lower and upper end of the band, Hz.
    pub band: [f64; 2],
    /// The run stops when the reflected voltage has fallen by this, dB (positive).
    pub decay_db: f64,
    /// It stops after this time at the latest, s.
    pub longest: f64,
}

impl SolveSettings {
    /// The usual stop rules.
    #[must_use]
    pub fn new(mesh: MeshSettings, band: [f64; 2]) -> Self {
        Self { mesh, band, decay_db: 40.0, longest: 4e-9 }
    }
}

/// A solved antenna.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Its mesh.
    pub meshed: Meshed,
    /// S11 at the ground's top, 50 ohm.
    pub sweep: Sweep,
    /// The port's time series.
    pub record: Record,
    /// The port's impedance as meshed, ohm: how well the line's circles are meshed.
    pub port_impedance: f64,
    /// Cells whose stubs were clipped for a longer step.
    pub n_clipped: usize,
    /// How far the reflected voltage had fallen, dB (negative).
    pub residual_db: f64,
    /// Cells times steps per second.
    pub speed: f64,
    /// Time spent, s.
    pub seconds: f64,
}

/// Impedance that S11 refers to, ohm.
const REFERENCE: f64 = 50.0;
/// Share of cells whose stubs are clipped: doubles the step, shifts no resonance visibly.
const CLIPPED: f64 = 0.003;
/// Steps between two looks at the decay.
const STRIDE: usize = 256;
/// Distance of the frequencies, Hz.
const RESOLUTION: f64 = 5e6;
/// Whoever watches is told at most this often.
const WATCH: Duration = Duration::from_millis(500);

/// A run under way, for whoever watches it.
#[derive(Clone, Copy, Debug)]
pub struct Running<'a> {
    /// The port's time series so far.
    pub record: &'a Record,
    /// The line between port and antenna.
    pub line: FeedLine,
    /// Lower and upper end of the band, Hz.
    pub band: [f64; 2],
    /// Number of cells.
    pub n_tets: usize,
    /// Steps at which the run stops at the latest.
    pub n_most: usize,
    /// How far the reflected voltage has fallen, dB (negative); `None` while the pulse still comes in.
    pub decay_db: Option<f64>,
    /// Cells times steps per second.
    pub speed: f64,
    /// Time until the stop rule is met, s, should the field go on to decay as it did; at most [`Self::seconds_most`].
    pub seconds_left: f64,
    /// Time until the last step there can be, s.
    pub seconds_most: f64,
}

impl Running<'_> {
    /// S11 of the record so far at a number of frequencies over the band: rippled until the field has decayed.
    #[must_use]
    pub fn sweep(&self, n_freqs: usize) -> Sweep {
        let [lo, hi] = self.band;
        sweep(self.record, &self.line, &frequencies(lo, hi, (hi - lo) / n_freqs.max(1) as f64))
    }
}

/// Meshes and solves an antenna.
///
/// * `watch`: told of the run under way, about twice a second and once at its end.
///
/// # Errors
/// [`PipelineError`] naming what to change.
pub fn solve(
    project: &Project,
    shape: Shape,
    settings: &SolveSettings,
    watch: &mut dyn FnMut(&Running<'_>),
    task: &Task,
) -> Result<Solved, PipelineError> {
    let started = Instant::now();
    let [lo, hi] = settings.band;
    let pulse = Pulse::new(lo, hi)?;
    let meshed = mesh(project, shape, settings.mesh, task)?;
    let network =
        Network::new(&meshed.mesh, &NetworkSettings { loss_freq: pulse.center, step: StepLimit::Clip(CLIPPED) }, task)?;
    let line = feed_line(project, network.port_impedance);
    let mut run = Run::new(&network, pulse);
    let mut watched = Watched { settings, line, n_tets: network.n_tets, looks: Vec::new(), told: None, watch };
    watched.run(&mut run, pulse, task)?;
    Ok(Solved {
        sweep: sweep(run.record(), &line, &frequencies(lo, hi, RESOLUTION)),
        record: run.record().clone(),
        port_impedance: network.port_impedance,
        n_clipped: network.n_clipped,
        residual_db: watched.looks.last().map_or(0.0, |&(_, db)| db),
        speed: run.speed(),
        seconds: started.elapsed().as_secs_f64(),
        meshed,
    })
}

fn feed_line(project: &Project, impedance: f64) -> FeedLine {
    FeedLine {
        impedance,
        length: from_mm(project.antenna.coax_length_mm + project.antenna.ground_thickness_mm),
        eps_r: project.antenna.to_params().sheath.eps_r,
        reference: REFERENCE,
    }
}

/// A run with its stop rule and its listener.
struct Watched<'a> {
    settings: &'a SolveSettings,
    line: FeedLine,
    n_tets: usize,
    /// Steps done and how far the reflected voltage had fallen by then, dB, since the pulse was over.
    looks: Vec<(usize, f64)>,
    told: Option<Instant>,
    watch: &'a mut dyn FnMut(&Running<'_>),
}

impl Watched<'_> {
    /// Runs until the stop rule is met.
    fn run(&mut self, run: &mut Run<'_>, pulse: Pulse, task: &Task) -> Result<(), PipelineError> {
        // One period at the lower end of the band holds every oscillation's peak.
        let window = 1.0 / self.settings.band[0];
        let dt = run.record().dt;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ten thousand steps")]
        let steps = |time: f64| (time / dt).ceil() as usize;
        let n_most = steps(self.settings.longest);
        let phase = task.phase("running the field", n_most);
        let mut is_over = false;
        while !is_over {
            let advanced = run.advance(STRIDE, task);
            phase.advance(STRIDE);
            let n_done = run.record().total.len();
            if n_done > steps(pulse.end() + window) {
                self.looks.push((n_done, 20.0 * run.record().residual(window).log10()));
            }
            let has_decayed = self.looks.last().is_some_and(|&(_, db)| db < -self.settings.decay_db);
            is_over = has_decayed || n_done >= n_most || advanced.is_err();
            if is_over || self.told.is_none_or(|last| last.elapsed() >= WATCH) {
                self.tell(run, n_most);
            }
            advanced?;
        }
        Ok(())
    }

    fn tell(&mut self, run: &Run<'_>, n_most: usize) {
        self.told = Some(Instant::now());
        let record = run.record();
        let seconds = |n_steps: f64| n_steps * self.n_tets as f64 / run.speed().max(1.0);
        let n_most_left = n_most.saturating_sub(record.total.len()) as f64;
        let n_left = self.steps_left().unwrap_or(n_most_left).clamp(0.0, n_most_left);
        (self.watch)(&Running {
            record,
            line: self.line,
            band: self.settings.band,
            n_tets: self.n_tets,
            n_most,
            decay_db: self.looks.last().map(|&(_, db)| db),
            speed: run.speed(),
            seconds_left: seconds(n_left),
            seconds_most: seconds(n_most_left),
        });
    }

    /// Steps until the stop rule is met, by the decay over the later half of the looks; `None` while it does not fall.
    fn steps_left(&self) -> Option<f64> {
        let &(n_done, db) = self.looks.last()?;
        let &(n_before, db_before) = self.looks.get(self.looks.len() / 2)?;
        let per_step = (db_before - db) / n_done.saturating_sub(n_before).max(1) as f64;
        (per_step > 0.0).then(|| (db + self.settings.decay_db) / per_step)
    }
}
