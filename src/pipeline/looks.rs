//! When a run stops, and how long that will take: what each look at its record says.

use super::solve::{Running, SolveSettings, StopRule};
use crate::results::{FeedLine, continued_sweep, fit, frequencies};
use crate::tlm::{Pulse, Record, Run};

/// Frequencies at which a look computes |S11|: a parabola finds the lowest place between them.
const FREQS: f64 = 100.0;
/// Looks in a row that must agree: two may do so by chance.
const AGREEING: usize = 3;
/// |S11| may differ by this many times what its frequency may.
const LOOSER: f64 = 10.0;
/// Decay to which the time is estimated where the stop rule names none, dB.
const USUAL_DB: f64 = 40.0;

/// What one look at a record found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    n_steps: usize,
    /// How far the reflected voltage had fallen, dB.
    pub(super) db: f64,
    /// Frequency, Hz, and value of the smallest |S11| of the continued record, where the rule asks for them.
    lowest: Option<[f64; 2]>,
}

/// The looks at a run since its pulse was over.
#[derive(Clone, Debug)]
pub(super) struct Looks<'a> {
    settings: &'a SolveSettings,
    line: FeedLine,
    /// Time over which the reflected voltage's peak is sought, s: one period at the lower end of the band.
    window: f64,
    /// Steps after which the pulse is over.
    pub(super) n_pulse: usize,
    n_window: usize,
    pub(super) n_most: usize,
    pub(super) looks: Vec<Look>,
}

impl<'a> Looks<'a> {
    pub(super) fn new(settings: &'a SolveSettings, line: FeedLine, pulse: Pulse, dt: f64) -> Self {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ten thousand steps")]
        let steps = |time: f64| (time / dt).ceil() as usize;
        let window = 1.0 / settings.band[0];
        Self {
            settings,
            line,
            window,
            n_pulse: steps(pulse.end()),
            n_window: steps(window),
            n_most: steps(settings.longest),
            looks: Vec::new(),
        }
    }

    /// Looks at the record so far.
    pub(super) fn look(&mut self, record: &Record) {
        let n_steps = record.total.len();
        if n_steps <= self.n_pulse + self.n_window {
            return;
        }
        let db = 20.0 * record.residual(self.window).log10();
        let lowest = match self.settings.stop {
            StopRule::Decay { .. } => None,
            StopRule::Settled { .. } => {
                // Looks at nearly the same record agree whether it has settled or not.
                let is_due = self.looks.iter().rev().find(|look| look.lowest.is_some());
                if is_due.is_some_and(|last| n_steps - last.n_steps < self.n_window / 2) {
                    return;
                }
                self.lowest(record)
            }
        };
        self.looks.push(Look { n_steps, db, lowest });
    }

    /// Frequency and value of the smallest |S11| of the record continued by its modes.
    fn lowest(&self, record: &Record) -> Option<[f64; 2]> {
        let [lo, hi] = self.settings.band;
        let modes = fit(record, self.n_pulse, hi)?;
        let sweep = continued_sweep(record, &modes, &self.line, &frequencies(lo, hi, (hi - lo) / FREQS));
        sweep.resonance().map(|found| [found.freq, 10_f64.powf(found.depth_db / 20.0)])
    }

    /// Whether the stop rule is met.
    pub(super) fn is_met(&self) -> bool {
        match self.settings.stop {
            StopRule::Decay { db } => self.looks.last().is_some_and(|look| look.db < -db),
            StopRule::Settled { tolerance } => {
                let first = self.looks.len().saturating_sub(AGREEING);
                let lowest: Option<Vec<[f64; 2]>> = self.looks[first..].iter().map(|look| look.lowest).collect();
                let Some(found) = lowest.filter(|found| found.len() == AGREEING) else { return false };
                let within = |k: usize, allowed: f64| found.iter().all(|v| (v[k] - found[0][k]).abs() <= allowed);
                within(0, tolerance * found[0][0]) && within(1, LOOSER * tolerance)
            }
        }
    }

    /// Steps until the field has decayed, by the later half of the looks; `None` while it does not.
    fn steps_left(&self) -> Option<f64> {
        let (last, before) = (self.looks.last()?, self.looks.get(self.looks.len() / 2)?);
        let per_step = (before.db - last.db) / last.n_steps.saturating_sub(before.n_steps).max(1) as f64;
        let wanted = match self.settings.stop {
            StopRule::Decay { db } => db,
            StopRule::Settled { .. } => USUAL_DB,
        };
        (per_step > 0.0).then(|| (last.db + wanted) / per_step)
    }

    /// The run as whoever watches sees it.
    pub(super) fn running<'r>(&self, run: &'r Run<'r, f32>, goes_on: bool) -> Running<'r> {
        let record = run.record();
        let seconds = |n_steps: f64| n_steps * run.n_tets() as f64 / run.speed().max(1.0);
        let n_most_left = self.n_most.saturating_sub(record.total.len()) as f64;
        let n_left = self.steps_left().unwrap_or(n_most_left).clamp(0.0, n_most_left);
        Running {
            run,
            record,
            line: self.line,
            band: self.settings.band,
            n_tets: run.n_tets(),
            n_most: self.n_most,
            decay_db: self.looks.last().map(|look| look.db),
            speed: run.speed(),
            seconds_left: seconds(n_left),
            seconds_most: seconds(n_most_left),
            goes_on,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::MeshSettings;
    use std::f64::consts::{PI, TAU};

    const DT: f64 = 2e-13;
    const BAND: [f64; 2] = [8e9, 16e9];

    /// A matched resonance of 11 GHz with loaded Q 20, driven by the pulse: the reflection is `s / (s + half width)`.
    fn record(pulse: Pulse, n: usize) -> Record {
        let rate = nalgebra::Complex::new(-PI * 11e9 / 20.0, TAU * 11e9);
        let mut stored = nalgebra::Complex::from(0.0);
        let (mut incident, mut total) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for step in 0..n {
            let wave = pulse.at(step as f64 * DT);
            stored = stored * (rate * DT).exp() + wave * DT;
            incident.push(wave);
            // The incident wave, and the wave reflected at once less what the resonance radiates back.
            total.push(2.0 * wave + (stored * 2.0 * rate.re).re);
        }
        Record { dt: DT, incident, total }
    }

    /// Steps at which a rule is met, and the frequency of the smallest |S11| by then.
    fn stopped(stop: StopRule) -> (usize, f64) {
        let settings = SolveSettings { stop, ..SolveSettings::new(MeshSettings::default(), BAND) };
        let line = FeedLine { impedance: 50.0, length: 0.0, eps_r: 1.0, reference: 50.0 };
        let pulse = Pulse::new(BAND[0], BAND[1]).expect("a band");
        let whole = record(pulse, 20_000);
        let mut looks = Looks::new(&settings, line, pulse, DT);
        let n = (256..whole.total.len()).step_by(256).find(|&n| {
            looks.look(&whole.until(n));
            looks.is_met()
        });
        let n = n.expect("it is met");
        (n, looks.lowest(&whole.until(n)).expect("a resonance")[0])
    }

    #[test]
    fn the_usual_band_lies_around_the_cavity() {
        let [lo, hi] = SolveSettings::usual_band(&crate::project::Project::default());
        assert!((lo..hi).contains(&10.8e9) && (hi / lo - 2.0).abs() < 1e-12, "{lo} to {hi} Hz");
    }

    #[test]
    fn settled_stops_well_before_the_decay_and_at_the_same_resonance() {
        let (n_decay, at_decay) = stopped(StopRule::Decay { db: 40.0 });
        let (n_settled, at_settled) = stopped(StopRule::SETTLED);
        assert!(n_settled < n_decay * 3 / 4, "{n_settled} of {n_decay} steps");
        assert!((at_settled / at_decay - 1.0).abs() < 5e-4, "{at_settled:e} {at_decay:e}");
        assert!((at_settled / 11e9 - 1.0).abs() < 0.005, "{at_settled:e}");
    }
}
