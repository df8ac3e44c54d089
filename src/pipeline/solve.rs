//! From a project to S11 and patterns: mesh, network, run, sweep, far fields.

use super::PipelineError;
use super::mesh::{MeshSettings, Meshed, Shape, mesh};
use crate::project::Project;
use crate::results::{FarField, FeedLine, Sweep, far_fields, frequencies, sweep};
use crate::task::Task;
use crate::tlm::{FieldRecorder, Huygens, Network, NetworkSettings, Pulse, Record, Run, StepLimit, TlmError};
use crate::units::from_mm;
use std::time::Instant;

/// What is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveSettings {
    /// The mesh.
    pub mesh: MeshSettings,
    /// Lower and upper end of the band, Hz.
    pub band: [f64; 2],
    /// The run stops when the reflected voltage has fallen by this, dB (positive).
    pub decay_db: f64,
    /// It stops after this time at the latest, s.
    pub longest: f64,
    /// Frequencies whose far fields are found, Hz.
    pub pattern_freqs: Vec<f64>,
}

/// Far fields over a band.
const N_PATTERNS: f64 = 41.0;

impl SolveSettings {
    /// The usual stop rules.
    #[must_use]
    pub fn new(mesh: MeshSettings, band: [f64; 2]) -> Self {
        let [lo, hi] = band;
        let pattern_freqs = frequencies(lo, hi, (hi - lo) / (N_PATTERNS - 1.0));
        Self { mesh, band, decay_db: 40.0, longest: 4e-9, pattern_freqs }
    }
}

/// A solved antenna.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Its mesh.
    pub meshed: Meshed,
    /// S11 at the ground's top, 50 ohm.
    pub sweep: Sweep,
    /// Far fields by ascending frequency, for an incident wave of 1 W.
    pub far_fields: Vec<FarField>,
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
/// Steps between two looks at the decay.
const STRIDE: usize = 256;
/// Distance of the frequencies, Hz.
const RESOLUTION: f64 = 5e6;

/// Meshes and solves an antenna.
///
/// # Errors
/// [`PipelineError`] naming what to change.
pub fn solve(project: &Project, shape: Shape, settings: &SolveSettings, task: &Task) -> Result<Solved, PipelineError> {
    let started = Instant::now();
    let [lo, hi] = settings.band;
    let pulse = Pulse::new(lo, hi)?;
    let meshed = mesh(project, shape, settings.mesh, task)?;
    let how = NetworkSettings { step: StepLimit::Clip(CLIPPED), ..NetworkSettings::new(pulse.center) };
    let network = Network::<f32>::new(&meshed.mesh, &how, task)?;
    let port_impedance = network.port_impedance.ok_or(TlmError::NoPort)?;
    let huygens = Huygens::new(&meshed.mesh)?;
    let fields = FieldRecorder::new(&meshed.mesh, &network, &huygens, &settings.pattern_freqs)?;
    let mut run = Run::new(&network, pulse).with_fields(fields);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ten thousand steps")]
    let steps = |time: f64| (time / network.dt).ceil() as usize;
    let n_most = steps(settings.longest);
    let phase = task.phase("running the field", n_most);
    // One period at the lower end of the band holds every oscillation's peak.
    let window = 1.0 / lo;
    let mut residual_db = 0.0;
    while run.record().total.len() < n_most {
        run.advance(STRIDE, task)?;
        phase.advance(STRIDE);
        if run.record().total.len() > steps(pulse.end() + window) {
            residual_db = 20.0 * run.record().residual(window).log10();
            if residual_db < -settings.decay_db {
                break;
            }
        }
    }
    let params = project.antenna.to_params();
    let line = FeedLine {
        impedance: port_impedance,
        length: from_mm(project.antenna.coax_length_mm + project.antenna.ground_thickness_mm),
        eps_r: params.sheath.eps_r,
        reference: REFERENCE,
    };
    let fields = run.fields().map(FieldRecorder::fields).unwrap_or_default();
    Ok(Solved {
        far_fields: far_fields(&huygens.surface, &fields, run.record(), port_impedance),
        sweep: sweep(run.record(), &line, &frequencies(lo, hi, RESOLUTION)),
        record: run.record().clone(),
        port_impedance,
        n_clipped: network.n_clipped,
        residual_db,
        speed: run.speed(),
        seconds: started.elapsed().as_secs_f64(),
        meshed,
    })
}
