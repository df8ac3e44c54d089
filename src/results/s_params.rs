//! S11 from the port's time series.
//!
//! `S11 = DFT(v - v_inc) / DFT(v_inc)` with the kernel exp(-jωt), relative to the port's own impedance as meshed. It is
//! moved along the line to the antenna (`exp(+2jβl)`) and renormalised to the reference impedance.

use crate::tlm::Record;
use crate::units::C0;
use nalgebra::Complex;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The line between port and antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedLine {
    /// Characteristic impedance as meshed, ohm.
    pub impedance: f64,
    /// Distance from the port to the reference plane, m.
    pub length: f64,
    /// Relative permittivity of the sheath.
    pub eps_r: f64,
    /// Impedance that S11 refers to, ohm.
    pub reference: f64,
}

/// S11 over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Frequencies, ascending, Hz.
    pub freqs: Vec<f64>,
    /// Reflection at each.
    pub s11: Vec<Complex<f64>>,
    /// Impedance that it refers to, ohm.
    pub reference: f64,
}

/// Where the antenna resonates, by the smallest reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Frequency of the smallest |S11|, by a parabola through the three lowest values of |S11|², Hz.
    pub freq: f64,
    /// The smallest |S11|, dB.
    pub depth_db: f64,
    /// Where |S11| is below -10 dB around it, Hz; none where it is not, or the band's ends lie outside the sweep.
    pub band: Option<[f64; 2]>,
}

/// Frequencies from `lo` to `hi`, about `step` apart, Hz.
#[must_use]
pub fn frequencies(lo: f64, hi: f64, step: f64) -> Vec<f64> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand")]
    let n = ((hi - lo) / step).round().clamp(1.0, 100_000.0) as usize;
    (0..=n).map(|k| lo + (hi - lo) * k as f64 / n as f64).collect()
}

/// S11 at some frequencies, Hz.
#[must_use]
pub fn sweep(record: &Record, line: &FeedLine, freqs: &[f64]) -> Sweep {
    let reflected: Vec<f64> = record.reflected().collect();
    let s11 = freqs.par_iter().map(|&f| {
        reflection(transform(&reflected, f * record.dt) / transform(&record.incident, f * record.dt), line, f)
    });
    Sweep { freqs: freqs.to_vec(), s11: s11.collect(), reference: line.reference }
}

/// S11 at the line's other end, for the reference impedance, from the reflection at the port.
pub(super) fn reflection(at_port: Complex<f64>, line: &FeedLine, f: f64) -> Complex<f64> {
    let turn = 2.0 * TAU * f * line.eps_r.sqrt() / C0 * line.length;
    renormalise(at_port * Complex::from_polar(1.0, turn), line.impedance, line.reference)
}

/// `sum x_n exp(-j 2 pi cycles n)`
pub(super) fn transform(series: &[f64], cycles: f64) -> Complex<f64> {
    series.iter().enumerate().map(|(n, &x)| Complex::from_polar(x, -TAU * (cycles * n as f64).fract())).sum()
}

/// The same reflection relative to another impedance.
fn renormalise(gamma: Complex<f64>, from: f64, to: f64) -> Complex<f64> {
    let one = Complex::from(1.0);
    let impedance = (one + gamma) / (one - gamma) * from;
    (impedance - to) / (impedance + to)
}

impl Sweep {
    /// |S11| in dB.
    #[must_use]
    pub fn db(&self) -> Vec<f64> {
        self.s11.iter().map(|s| 20.0 * s.norm().log10()).collect()
    }

    /// Input impedance at the reference plane, ohm.
    #[must_use]
    pub fn impedance(&self) -> Vec<Complex<f64>> {
        let one = Complex::from(1.0);
        self.s11.iter().map(|s| (one + s) / (one - s) * self.reference).collect()
    }

    /// Resonance and band; `None` for a sweep of fewer than three frequencies.
    #[must_use]
    pub fn resonance(&self) -> Option<Resonance> {
        let db = self.db();
        let lowest = (0..db.len()).min_by(|&a, &b| db[a].total_cmp(&db[b]))?;
        let k = lowest.clamp(1, db.len().checked_sub(2).filter(|&last| last >= 1)?);
        let [left, middle, right] = [k - 1, k, k + 1].map(|k| self.s11[k].norm_sqr());
        let bend = left - 2.0 * middle + right;
        let shift = if bend > 0.0 { (0.5 * (left - right) / bend).clamp(-1.0, 1.0) } else { 0.0 };
        let freq = self.freqs[k] + shift * (self.freqs[k + 1] - self.freqs[k]);
        // The parabola of a deep notch may dip below zero.
        let depth_db = db[lowest].min(10.0 * (middle - 0.25 * (left - right) * shift).max(1e-8).log10());
        Some(Resonance { freq, depth_db, band: self.band(&db, lowest) })
    }

    /// The stretch below -10 dB around a place, its ends interpolated.
    fn band(&self, db: &[f64], place: usize) -> Option<[f64; 2]> {
        const LEVEL: f64 = -10.0;
        if db[place] > LEVEL {
            return None;
        }
        let crossing = |inside: usize, outside: usize| {
            let part = (LEVEL - db[inside]) / (db[outside] - db[inside]);
            self.freqs[inside] + part * (self.freqs[outside] - self.freqs[inside])
        };
        let below = (0..place).rev().find(|&k| db[k] > LEVEL)?;
        let above = (place + 1..db.len()).find(|&k| db[k] > LEVEL)?;
        Some([crossing(below + 1, below), crossing(above - 1, above)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of 40 ohm with its end open after 3 mm of permittivity 2.25: the pulse returns unchanged, later.
    fn delayed(delay: f64) -> Record {
        let dt = 1e-12;
        let pulse = |t: f64| (-((t - 200e-12) / 40e-12_f64).powi(2)).exp();
        let times: Vec<f64> = (0..2000).map(|n| f64::from(n) * dt).collect();
        let incident: Vec<f64> = times.iter().map(|&t| pulse(t)).collect();
        let total = times.iter().map(|&t| pulse(t) + pulse(t - delay)).collect();
        Record { dt, incident, total }
    }

    #[test]
    fn moving_the_plane_to_an_open_end_gives_plus_one() {
        let line = FeedLine { impedance: 40.0, length: 3e-3, eps_r: 2.25, reference: 40.0 };
        let record = delayed(2.0 * 3e-3 * 1.5 / C0);
        for s in sweep(&record, &line, &frequencies(2e9, 8e9, 1e9)).s11 {
            assert!((s - Complex::from(1.0)).norm() < 1e-6, "{s}");
        }
        let at_port = sweep(&record, &FeedLine { length: 0.0, ..line }, &[5e9]).s11[0];
        assert!((at_port.arg() + TAU * 5e9 * 30e-12 * 9.0 / 8.994).abs() < 0.02, "the delay is a phase: {at_port}");
    }

    #[test]
    fn renormalising_keeps_the_impedance() {
        let gamma = Complex::new(0.3, -0.2);
        let there = renormalise(gamma, 40.0, 50.0);
        assert!((renormalise(there, 50.0, 40.0) - gamma).norm() < 1e-15, "and back");
        assert!(renormalise(Complex::from(0.25), 30.0, 50.0).norm() < 1e-15, "50 ohm are matched to 50 ohm");
    }

    #[test]
    fn a_resonance_is_found_between_the_frequencies() {
        let freqs = frequencies(9e9, 12e9, 50e6);
        let (f0, half) = (10.517e9, 0.4e9);
        // |S11| of a matched resonator: at 1/sqrt(10) the detuning is a third of the half width's.
        let s11 = freqs.iter().map(|f| {
            let detuning = Complex::new(0.005, (f - f0) / half);
            detuning / (Complex::from(1.0) + detuning)
        });
        let sweep = Sweep { s11: s11.collect(), freqs, reference: 50.0 };
        let found = sweep.resonance().expect("enough frequencies");
        assert!((found.freq / f0 - 1.0).abs() < 2e-4 && found.depth_db < -25.0, "{found:?}");
        let [lo, hi] = found.band.expect("it falls below -10 dB");
        assert!(((hi - lo) / (2.0 * half / 3.0) - 1.0).abs() < 0.02 && lo < f0 && f0 < hi, "{found:?}");
    }
}
