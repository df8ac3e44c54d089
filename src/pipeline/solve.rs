//! From a project to S11 and patterns: mesh, network, run, sweep, far fields.

use super::PipelineError;
use super::loads::loads;
use super::looks::Looks;
use super::mesh::{MeshSettings, Meshed, Shape, mesh_band};
use crate::project::Project;
use crate::results::{
    FarField, FeedLine, FittedResonance, Sweep, continued_sweep, far_fields, fit, fitted_resonance, frequencies, sweep,
};
use crate::task::Task;
use crate::tlm::{
    Checkpoint, FieldRecorder, Huygens, Loads, Network, NetworkSettings, Pulse, Record, Run, StepLimit, TlmError,
};
use crate::units::{C0, from_mm};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// What is solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolveSettings {
    /// The mesh.
    pub mesh: MeshSettings,
    /// Lower and upper end of the band, Hz.
    pub band: [f64; 2],
    /// When the run stops.
    pub stop: StopRule,
    /// It stops after this time at the latest, s.
    pub longest: f64,
    /// Frequencies whose far fields are found, Hz.
    pub pattern_freqs: Vec<f64>,
    /// Whether the cells at the edges of sheets hold the energy of the singular field there.
    pub edge_correction: bool,
}

/// Far fields over a band.
const N_PATTERNS: f64 = 41.0;

impl SolveSettings {
    /// The usual stop rule: the reflected voltage 40 dB down.
    #[must_use]
    pub fn new(mesh: MeshSettings, band: [f64; 2]) -> Self {
        let [lo, hi] = band;
        let pattern_freqs = frequencies(lo, hi, (hi - lo) / (N_PATTERNS - 1.0));
        Self { mesh, band, stop: StopRule::Decay { db: 40.0 }, longest: 4e-9, pattern_freqs, edge_correction: true }
    }

    /// From a third below to a third above the resonance of an ideal cavity under the patch, Hz; of imported bodies,
    /// around half a wave along the fed metal.
    #[must_use]
    pub fn usual_band(project: &Project) -> [f64; 2] {
        if let Some(bodies) = &project.bodies {
            return super::bodies_edges::usual_band(bodies);
        }
        let params = project.antenna.to_params();
        let cavity = C0 / (2.0 * params.length * params.substrate.eps_r.sqrt());
        [cavity * 2.0 / 3.0, cavity * 4.0 / 3.0]
    }
}

/// When a run stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum StopRule {
    /// The reflected voltage has fallen by this, dB (positive).
    Decay {
        /// How far, dB.
        db: f64,
    },
    /// The smallest |S11| of the record continued by its fitted modes stays where it is over some looks.
    Settled {
        /// Greatest difference of its frequency, relative; ten times as much is allowed to |S11| itself.
        tolerance: f64,
    },
}

impl StopRule {
    /// The usual tolerance of a settled resonance. Ten times as much already cuts coarse runs off before weak modes
    /// show; a tenth waits longer than the decay by 40 dB does.
    pub const SETTLED: Self = Self::Settled { tolerance: 5e-4 };
}

/// A solved antenna.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Its mesh.
    pub meshed: Meshed,
    /// S11 at the ground's top, 50 ohm, of the record continued by its modes.
    pub sweep: Sweep,
    /// Far fields by ascending frequency, for an incident wave of 1 W.
    pub far_fields: Vec<FarField>,
    /// The port's time series.
    pub record: Record,
    /// The port's impedance as meshed, ohm: how well the line's circles are meshed.
    pub port_impedance: f64,
    /// The strongest resonance in the band by fit to the late record, where there is one.
    pub fitted: Option<FittedResonance>,
    /// Whether the stop rule was met; else the run ended at its longest.
    pub is_settled: bool,
    /// Cells whose stubs were clipped for a longer step.
    pub n_clipped: usize,
    /// How far the reflected voltage had fallen, dB (negative).
    pub residual_db: f64,
    /// Cells times steps per second.
    pub speed: f64,
    /// Time spent, s.
    pub seconds: f64,
}

impl Solved {
    /// The far field at the frequency nearest to the resonance, or to the middle of the band where there is none.
    #[must_use]
    pub fn at_resonance(&self) -> Option<&FarField> {
        let middle = || self.sweep.freqs.get(self.sweep.freqs.len() / 2).copied();
        let wanted = self.sweep.resonance().map(|r| r.freq).or_else(middle)?;
        self.far_fields.iter().min_by(|a, b| (a.freq - wanted).abs().total_cmp(&(b.freq - wanted).abs()))
    }
}

/// Impedance that S11 refers to, ohm.
const REFERENCE: f64 = 50.0;
/// Share of cells whose stubs are clipped: doubles the step, shifts no resonance visibly.
const CLIPPED: f64 = 0.003;
/// A record whose modes leave over more than this part of it is not continued.
const MISFIT: f64 = 0.02;
/// Steps between two looks at the stop rule.
const STRIDE: usize = 256;
/// Distance of the frequencies, Hz.
const RESOLUTION: f64 = 5e6;
/// Whoever watches is told at most this often.
const WATCH: Duration = Duration::from_millis(500);

/// A run under way, for whoever watches it.
#[derive(Clone, Copy, Debug)]
pub struct Running<'a> {
    pub(super) run: &'a Run<'a, f32>,
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
    /// Time until the reflected voltage is 40 dB down or as far as the stop rule says, s, should the field go on to
    /// decay as it did; at most [`Self::seconds_most`].
    pub seconds_left: f64,
    /// Time until the last step there can be, s.
    pub seconds_most: f64,
    /// Whether the run goes on; false as it ends or is called off.
    pub goes_on: bool,
}

impl Running<'_> {
    /// S11 of the record so far at a number of frequencies over the band: rippled until the field has decayed.
    #[must_use]
    pub fn sweep(&self, n_freqs: usize) -> Sweep {
        let [lo, hi] = self.band;
        sweep(self.record, &self.line, &frequencies(lo, hi, (hi - lo) / n_freqs.max(1) as f64))
    }

    /// What it takes to go on later.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint {
        self.run.checkpoint()
    }
}

/// Meshes and solves an antenna.
///
/// * `resume`: the state of an earlier run of the same to go on from.
/// * `watch`: told of the run under way, about twice a second and once at its end, also when it is called off.
///
/// # Errors
/// [`PipelineError`] naming what to change.
pub fn solve(
    project: &Project,
    shape: Shape,
    settings: &SolveSettings,
    resume: Option<&Checkpoint>,
    watch: &mut dyn FnMut(&Running<'_>),
    task: &Task,
) -> Result<Solved, PipelineError> {
    let started = Instant::now();
    let [lo, hi] = settings.band;
    let pulse = Pulse::new(lo, hi)?;
    let feed = match &project.bodies {
        Some(bodies) => Some(bodies.feed.ok_or(PipelineError::NoFeed)?),
        None => None,
    };
    let meshed = mesh_band(project, shape, settings.mesh, settings.band, task)?;
    let how = NetworkSettings {
        step: StepLimit::Clip(CLIPPED),
        edge_correction: settings.edge_correction,
        loads: match feed {
            Some(feed) => Loads { port: super::bodies::port(&meshed, feed.ohm), ..Loads::default() },
            None => loads(&project.antenna.to_params(), &meshed, settings.mesh.metal),
        },
        ..NetworkSettings::new(pulse.center)
    };
    let network = Network::<f32>::new(&meshed.mesh, &how, task)?;
    let port_impedance = network.port_impedance.ok_or(TlmError::NoPort)?;
    let line = match feed {
        Some(_) => FeedLine { impedance: port_impedance, length: 0.0, eps_r: 1.0, reference: REFERENCE },
        None => feed_line(project, port_impedance),
    };
    let huygens = Huygens::new(&meshed.mesh)?;
    let fields = FieldRecorder::new(&meshed.mesh, &network, &huygens, &settings.pattern_freqs)?;
    let mut run = Run::new(&network, pulse).with_fields(fields);
    if let Some(checkpoint) = resume {
        run = run.resumed(checkpoint)?;
    }
    let mut progress = Looks::new(settings, line, pulse, network.dt);
    drive(&mut run, &mut progress, watch, task)?;
    let record = run.record();
    let freqs = frequencies(lo, hi, RESOLUTION);
    // Without its rest a record cut off at 40 dB shifts the resonance by up to 0.05 %.
    let modes = fit(record, progress.n_pulse, hi).filter(|modes| modes.misfit < MISFIT);
    let fields = run.fields().map(FieldRecorder::fields).unwrap_or_default();
    Ok(Solved {
        far_fields: far_fields(&huygens.surface, &fields, record, port_impedance),
        sweep: modes.map_or_else(|| sweep(record, &line, &freqs), |m| continued_sweep(record, &m, &line, &freqs)),
        fitted: fitted_resonance(record, progress.n_pulse, settings.band),
        record: record.clone(),
        port_impedance,
        is_settled: progress.is_met(),
        n_clipped: network.n_clipped,
        residual_db: progress.looks.last().map_or(0.0, |look| look.db),
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

/// Runs until the stop rule is met.
fn drive(
    run: &mut Run<'_, f32>,
    progress: &mut Looks<'_>,
    watch: &mut dyn FnMut(&Running<'_>),
    task: &Task,
) -> Result<(), PipelineError> {
    // What a resumed run has seen before counts as in one that was never interrupted.
    let n_before = run.record().total.len();
    for n in (STRIDE..=n_before).step_by(STRIDE) {
        progress.look(&run.record().until(n));
    }
    let phase = task.phase("running the field", progress.n_most);
    phase.advance(n_before);
    let mut told: Option<Instant> = None;
    loop {
        let n_done = run.record().total.len();
        let is_over = progress.is_met() || n_done >= progress.n_most;
        let advanced = if is_over { Ok(()) } else { run.advance(STRIDE - n_done % STRIDE, task) };
        let goes_on = !is_over && advanced.is_ok();
        if !goes_on || told.is_none_or(|last| last.elapsed() >= WATCH) {
            told = Some(Instant::now());
            watch(&progress.running(run, goes_on));
        }
        advanced?;
        if is_over {
            return Ok(());
        }
        phase.advance(run.record().total.len() - n_done);
        progress.look(run.record());
    }
}
