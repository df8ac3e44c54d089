//! Damped modes of a port's late series: resonance and Q by fit, and S11 before the field has died away.
//!
//! Once the pulse is over the reflected voltage is a sum of damped oscillations, the resonances of antenna and line
//! with all that takes their power away:
//!
//! ```text
//! v(t) = sum Re(A exp((-alpha + j 2 pi f) t))        Q = pi f / alpha
//! ```
//!
//! The series is averaged over blocks to four samples per period at the top of the band (which changes no mode but for
//! its amplitude, by a known factor). The signal subspace of its Hankel matrix, from a singular value decomposition,
//! is shifted by one sample: the eigenvalues of that shift are the modes' factors per sample (ESPRIT, equivalently the
//! matrix pencil method). Amplitudes follow by least squares. With its modes the record can be continued to the end of
//! time in closed form, which gives S11 early. How far the resonance can be trusted shows in fits to parts of the same
//! series.
//!
//! Sources: \[HS90\], \[RK89\]. Not handled: series that are still driven; modes that grow or do not fall are left out.

use super::s_params::{FeedLine, Sweep, reflection, transform};
use crate::tlm::Record;
use nalgebra::{Complex, DMatrix, DVector, Schur, SymmetricEigen};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// A damped oscillation, `Re(amplitude exp((-decay + j 2 pi freq) t))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Frequency, Hz.
    pub freq: f64,
    /// Rate at which the amplitude falls, 1/s.
    pub decay: f64,
    /// Amplitude and phase at the first sample.
    pub amplitude: Complex<f64>,
}

impl Mode {
    /// Quality factor, of the resonance loaded by the line.
    #[must_use]
    pub fn q(&self) -> f64 {
        PI * self.freq / self.decay
    }

    /// `-decay + j 2 pi freq`, 1/s.
    fn rate(&self) -> Complex<f64> {
        Complex::new(-self.decay, TAU * self.freq)
    }

    /// The energy that is still to come.
    fn energy(&self) -> f64 {
        self.amplitude.norm_sqr() / self.decay
    }
}

/// The late part of a series as modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Step at which the modes' amplitudes are meant.
    pub start: usize,
    /// The modes, strongest first.
    pub modes: Vec<Mode>,
    /// Root mean square of what they leave over, relative to the series'.
    pub misfit: f64,
}

/// A resonance by fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedResonance {
    /// Frequency of the strongest mode in the band, Hz.
    pub freq: f64,
    /// Greatest difference of that frequency in fits to parts of the series, Hz.
    pub freq_error: f64,
    /// Quality factor, loaded by the line.
    pub q: f64,
    /// Its greatest difference in fits to parts of the series.
    pub q_error: f64,
}

/// Samples per period at the top of the band.
const SAMPLES: f64 = 4.0;
/// Singular values below this part of the greatest one are noise: ten times the single precision of the field, summed
/// over some hundred samples. Higher loses weak modes, lower fits noise.
const NOISE: f64 = 3e-5;
/// At least this many samples for each factor: with fewer there is no room to tell noise from modes.
const SAMPLES_PER_FACTOR: usize = 3;
/// Modes that fall by less over the whole series cannot be told from steady ones, whose rest would have no end.
const LEAST_FALL: f64 = 0.03;
/// Samples beyond this many say nothing new, and the decomposition's cost grows with their cube.
const MAX_SAMPLES: usize = 400;
/// Parts of the series that are fitted to see how far the resonance can be trusted: begin and end.
const PARTS: [[f64; 2]; 4] = [[0.0, 0.7], [0.15, 0.85], [0.3, 1.0], [0.0, 0.85]];
/// Iterations of the decompositions: tens are usual.
const ITERATIONS: usize = 2000;

/// Fits the record from a step on; `None` where it is too short or holds nothing.
///
/// * `top`: highest frequency of interest, Hz.
#[must_use]
pub fn fit(record: &Record, start: usize, top: f64) -> Option<Fit> {
    let late: Vec<f64> = record.reflected().skip(start).collect();
    fit_series(&late, record.dt, top).map(|(modes, misfit)| Fit { start, modes, misfit })
}

/// The resonance in a band by fits to the record from a step on, with its uncertainty; `None` where there is none.
///
/// * `band`: lower and upper end, Hz.
#[must_use]
pub fn fitted_resonance(record: &Record, start: usize, band: [f64; 2]) -> Option<FittedResonance> {
    let late: Vec<f64> = record.reflected().skip(start).collect();
    let strongest = |part: &[f64]| {
        let (modes, _) = fit_series(part, record.dt, band[1])?;
        modes.into_iter().find(|m| (band[0]..=band[1]).contains(&m.freq))
    };
    let whole = strongest(&late)?;
    let (mut freq_error, mut q_error) = (0.0_f64, 0.0_f64);
    for ends in PARTS {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "parts of a length")]
        let [from, to] = ends.map(|part| (part * late.len() as f64) as usize);
        let part = strongest(&late[from..to])?;
        freq_error = freq_error.max((part.freq - whole.freq).abs());
        q_error = q_error.max((part.q() - whole.q()).abs());
    }
    Some(FittedResonance { freq: whole.freq, freq_error, q: whole.q(), q_error })
}

/// S11 at some frequencies, Hz, of the record continued by its modes without end.
#[must_use]
pub fn continued_sweep(record: &Record, fit: &Fit, line: &FeedLine, freqs: &[f64]) -> Sweep {
    let reflected: Vec<f64> = record.reflected().collect();
    let n = reflected.len();
    let s11 = freqs.par_iter().map(|&f| {
        let cycles = f * record.dt;
        let known = transform(&reflected, cycles);
        let rest: Complex<f64> = fit.modes.iter().map(|m| tail(m, n - fit.start, record.dt, f)).sum();
        let turn = Complex::from_polar(1.0, -TAU * (cycles * n as f64).fract());
        reflection((known + rest * turn) / transform(&record.incident, cycles), line, f)
    });
    Sweep { freqs: freqs.to_vec(), s11: s11.collect(), reference: line.reference }
}

/// `sum over n >= 0 of v((first + n) dt) exp(-j 2 pi f n dt)` of a mode.
fn tail(mode: &Mode, first: usize, dt: f64, f: f64) -> Complex<f64> {
    let one = Complex::from(1.0);
    let kernel = Complex::from_polar(1.0, -TAU * f * dt);
    let step = (mode.rate() * dt).exp();
    let there = mode.amplitude * (mode.rate() * (first as f64 * dt)).exp();
    // The oscillation and its conjugate, a half each.
    (there / (one - step * kernel) + there.conj() / (one - step.conj() * kernel)) * 0.5
}

/// The modes of a series, strongest first, and the relative root mean square of what they leave over.
fn fit_series(series: &[f64], dt: f64, top: f64) -> Option<(Vec<Mode>, f64)> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of steps")]
    let block = ((1.0 / (SAMPLES * top * dt)) as usize).max(1);
    let samples: Vec<f64> =
        series.chunks_exact(block).take(MAX_SAMPLES).map(|c| c.iter().sum::<f64>() / block as f64).collect();
    let interval = block as f64 * dt;
    let factors = factors(&samples)?;
    let amplitudes = amplitudes(&samples, &factors)?;
    let power: f64 = samples.iter().map(|y| y * y).sum();
    let left: f64 =
        samples.iter().zip(series_of(&factors, &amplitudes, samples.len())).map(|(y, x)| (y - x).powi(2)).sum();
    let one = Complex::from(1.0);
    let mode = |(factor, amplitude): (&Complex<f64>, Complex<f64>)| {
        let step = factor.powf(1.0 / block as f64);
        // What averaging a block does to the mode; of a block of one sample, nothing.
        let average = if block == 1 { one } else { (one - factor) / (one - step) / block as f64 };
        Mode {
            freq: factor.arg() / (TAU * interval),
            decay: -factor.norm().ln() / interval,
            amplitude: amplitude / average,
        }
    };
    let mut modes: Vec<Mode> = factors.iter().zip(amplitudes).map(mode).collect();
    modes.sort_by(|a, b| b.energy().total_cmp(&a.energy()));
    Some((modes, (left / power).sqrt()))
}

/// Factors per sample of the decaying modes of a series, one of each conjugate pair.
fn factors(samples: &[f64]) -> Option<Vec<Complex<f64>>> {
    let n = samples.len();
    if n < 8 || !samples.iter().all(|y| y.is_finite()) || samples.iter().all(|y| y.abs() <= 0.0) {
        return None;
    }
    let columns = n / 2;
    let hankel = DMatrix::from_fn(n - columns + 1, columns, |i, j| samples[i + j]);
    // Squares of the singular values: the noise of single precision is still far above the rounding of the squares.
    let eigen = SymmetricEigen::try_new(hankel.tr_mul(&hankel), f64::EPSILON, ITERATIONS)?;
    let limit = NOISE * NOISE * eigen.eigenvalues.max();
    let mut places: Vec<usize> = (0..columns).filter(|&k| eigen.eigenvalues[k] > limit).collect();
    places.sort_unstable_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    places.truncate(n / SAMPLES_PER_FACTOR);
    let signal = eigen.eigenvectors.select_columns(&places);
    let (head, moved) = (signal.rows(0, columns - 1), signal.rows(1, columns - 1));
    // The pseudo-inverse of `head`, whose Gram matrix is the identity less the dropped row's.
    let last = signal.row(columns - 1);
    let product = head.tr_mul(&moved);
    let shift = &product + last.transpose() * (last * &product) / (1.0 - last.norm_squared());
    let all = Schur::try_new(shift, f64::EPSILON, ITERATIONS)?.complex_eigenvalues();
    // Oscillations that fall: what grows or does not swing is no resonance, nor can it be continued.
    let wanted = |z: &Complex<f64>| z.im > 1e-6 && -z.norm().ln() * n as f64 > LEAST_FALL;
    Some(all.iter().copied().filter(wanted).collect())
}

/// Amplitudes of the modes by least squares.
fn amplitudes(samples: &[f64], factors: &[Complex<f64>]) -> Option<Vec<Complex<f64>>> {
    let n = factors.len();
    if n == 0 {
        return None;
    }
    let mut powers = DMatrix::zeros(samples.len(), 2 * n);
    for (k, factor) in factors.iter().enumerate() {
        let mut power = Complex::from(1.0);
        for row in 0..samples.len() {
            (powers[(row, k)], powers[(row, n + k)]) = (power.re, -power.im);
            power *= factor;
        }
    }
    let qr = powers.qr();
    let solved = qr.r().solve_upper_triangular(&qr.q().tr_mul(&DVector::from_column_slice(samples)))?;
    Some((0..n).map(|k| Complex::new(solved[k], solved[n + k])).collect())
}

/// The samples that modes make.
fn series_of<'a>(
    factors: &'a [Complex<f64>],
    amplitudes: &'a [Complex<f64>],
    n: usize,
) -> impl Iterator<Item = f64> + 'a {
    let mut now = amplitudes.to_vec();
    (0..n).map(move |_| {
        let value = now.iter().map(|a| a.re).sum();
        now.iter_mut().zip(factors).for_each(|(a, f)| *a *= f);
        value
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{frequencies, sweep};

    const DT: f64 = 1.5e-13;
    const BAND: [f64; 2] = [7e9, 14e9];

    fn mode(freq: f64, q: f64, amplitude: Complex<f64>) -> Mode {
        Mode { freq, decay: PI * freq / q, amplitude }
    }

    /// A series of modes with noise of single precision's size.
    fn series(modes: &[Mode], n: usize, noise: f64) -> Vec<f64> {
        let mut rng = fastrand::Rng::with_seed(11);
        let at = |n: usize| modes.iter().map(|m| (m.amplitude * (m.rate() * (n as f64 * DT)).exp()).re).sum::<f64>();
        (0..n).map(|n| at(n) + noise * (rng.f64() - 0.5)).collect()
    }

    fn patch() -> [Mode; 3] {
        [
            mode(10.03e9, 4.8, Complex::new(0.3, -0.2)),
            mode(12.4e9, 7.0, Complex::new(-0.02, 0.01)),
            mode(16.0e9, 2.4, Complex::new(0.01, 0.03)),
        ]
    }

    /// A series after half a nanosecond's pulse.
    fn record(late: &[f64]) -> (Record, usize) {
        let start = 3000;
        let pulse = |n: usize| (-((n as f64 - 1500.0) / 350.0).powi(2)).exp() * (TAU * 10.5e9 * n as f64 * DT).cos();
        let incident: Vec<f64> = (0..start + late.len()).map(pulse).collect();
        let total =
            (0..start).map(|n| 0.5 * incident[n]).chain(late.iter().zip(&incident[start..]).map(|(v, i)| v + i));
        (Record { dt: DT, total: total.collect(), incident }, start)
    }

    #[test]
    fn frequency_and_q_of_damped_modes_are_found_in_noise() {
        for (noise, within) in [(0.0, 1e-7), (1e-6, 2e-4), (1e-5, 2e-3)] {
            let (record, start) = record(&series(&patch(), 4000, noise));
            let found = fitted_resonance(&record, start, BAND).expect("a resonance");
            let [strongest, ..] = patch();
            assert!((found.freq / strongest.freq - 1.0).abs() < within, "noise {noise:e}: {found:?}");
            assert!((found.q / strongest.q() - 1.0).abs() < 10.0 * within, "noise {noise:e}: {found:?}");
            // The uncertainty that is stated covers the truth, and is no idle guess.
            assert!((found.freq - strongest.freq).abs() <= found.freq_error + 1.0, "noise {noise:e}: {found:?}");
            assert!(found.freq_error < 20.0 * within * found.freq, "noise {noise:e}: {found:?}");
        }
    }

    #[test]
    fn a_high_q_is_found_long_before_it_has_rung_out() {
        let truth = mode(9.2e9, 300.0, Complex::new(0.1, 0.05));
        let (record, start) = record(&series(&[truth, patch()[2]], 8000, 1e-7));
        let found = fitted_resonance(&record, start, BAND).expect("a resonance");
        // Over this window the amplitude falls by a tenth only.
        assert!((found.q / 300.0 - 1.0).abs() < 0.01 && (found.freq / truth.freq - 1.0).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn a_continued_record_has_the_spectrum_of_the_whole_one() {
        let (whole, start) = record(&series(&patch(), 20_000, 0.0));
        let early = Record {
            dt: DT,
            incident: whole.incident[..start + 2500].to_vec(),
            total: whole.total[..start + 2500].to_vec(),
        };
        let line = FeedLine { impedance: 49.5, length: 3e-3, eps_r: 2.2, reference: 50.0 };
        let freqs = frequencies(BAND[0], BAND[1], 0.5e9);
        let found = fit(&early, start, BAND[1]).expect("modes");
        assert_eq!(found.modes.len(), 3, "{found:?}");
        assert!(found.misfit < 1e-6, "{found:?}");
        let distance = |a: &Sweep, b: &Sweep| a.s11.iter().zip(&b.s11).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        let (truth, cut) = (sweep(&whole, &line, &freqs), sweep(&early, &line, &freqs));
        let continued = continued_sweep(&early, &found, &line, &freqs);
        assert!(distance(&continued, &truth) < 1e-5, "{:e}", distance(&continued, &truth));
        assert!(distance(&cut, &truth) > 0.02, "without the rest it is off: {:e}", distance(&cut, &truth));
    }

    #[test]
    fn what_holds_no_resonance_is_refused() {
        let none = |late: &[f64]| {
            let (record, start) = record(late);
            fitted_resonance(&record, start, BAND).is_none()
        };
        assert!(none(&[]) && none(&[1.0; 50]) && none(&vec![0.0; 4000]), "too short, or nothing");
        assert!(none(&vec![f64::NAN; 4000]), "no numbers");
        assert!(none(&series(&[mode(20e9, 5.0, Complex::from(1.0))], 4000, 0.0)), "outside of the band");
        let growing = Mode { decay: -1e9, ..patch()[0] };
        assert!(none(&series(&[growing], 4000, 0.0)), "growing");
    }
}
