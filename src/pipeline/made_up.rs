//! Made-up results, for tests of what shows them.

use super::RunFigures;
use super::solve_job::RunResult;
use crate::results::{FarField, FittedResonance, Powers, Sweep, frequencies};
use crate::units::{ETA0, GHZ};
use nalgebra::Complex;
use std::f64::consts::PI;

/// A resonator at `freq` of the loaded quality 12 with some of its line, and the pattern of a small dipole on a ground.
pub(crate) fn made_up(freq: f64) -> RunResult {
    let freqs = frequencies(8.0 * GHZ, 14.0 * GHZ, 10e6);
    let s11 = freqs.iter().map(|f| {
        let detuning = Complex::new(0.1, 12.0 * (f / freq - freq / f));
        detuning / (Complex::from(1.0) + detuning) * Complex::from_polar(1.0, -f / freq)
    });
    let sweep = Sweep { s11: s11.collect(), freqs, reference: 50.0 };
    RunResult {
        resonance: sweep.resonance(),
        fitted: Some(FittedResonance { freq: 1.001 * freq, freq_error: 1e6, q: 12.3, q_error: 0.1 }),
        sweep,
        figures: RunFigures {
            port_impedance_ohm: 49.87,
            tets: 12_345,
            clipped_cells: 12,
            dt_s: 1.7e-13,
            steps: 6789,
            residual_db: -40.3,
            is_settled: true,
            tet_steps_per_second: 5e7,
            seconds: 4.2,
        },
        patterns: vec![lobe(freq).into()],
    }
}

/// E along y, more to the front than to the back.
fn lobe(freq: f64) -> FarField {
    let n = 24_u32;
    let theta: Vec<f64> = (0..=n).map(|k| PI * f64::from(k) / f64::from(n)).collect();
    let phi: Vec<f64> = (0..2 * n).map(|k| PI * f64::from(k) / f64::from(n)).collect();
    let all = theta.iter().flat_map(|&t| phi.iter().map(move |&p| (t, p)));
    let size = |t: f64| Complex::new((1.2 + t.cos()) / 2.2, 0.0);
    let (e_theta, e_phi): (Vec<_>, Vec<_>) = all.map(|(t, p)| (size(t) * p.sin(), size(t) * t.cos() * p.cos())).unzip();
    let step = PI / f64::from(n);
    let rows = e_theta.chunks(phi.len()).zip(e_phi.chunks(phi.len())).zip(&theta);
    let radiated = rows.map(|((a, b), t)| {
        let sum: f64 = a.iter().zip(b).map(|(a, b)| a.norm_sqr() + b.norm_sqr()).sum();
        sum * t.sin() * step * step / (2.0 * ETA0)
    });
    let radiated: f64 = radiated.sum();
    let powers = Powers {
        incident: 1.05 * radiated,
        accepted: 1.04 * radiated,
        lost: 0.03 * radiated,
        crossing: radiated,
        radiated,
    };
    FarField { freq, theta, phi, e_theta, e_phi, powers }
}
