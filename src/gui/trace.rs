//! A curve of reflection over frequency as the plots take it: finished runs, and the one under way.

use super::solve_session::SolveSession;
use super::theme::Tokens;
use crate::results::{Resonance, Sweep};
use crate::units::GHZ;
use egui::Color32;
use nalgebra::Complex;

/// One curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trace<'a> {
    pub(super) name: &'a str,
    pub(super) color: Color32,
    pub(super) sweep: &'a Sweep,
    pub(super) resonance: Option<Resonance>,
    /// Under way: dashed, without markers.
    pub(super) is_live: bool,
}

impl Trace<'_> {
    /// The place of the frequency nearest to one, Hz.
    pub(super) fn nearest(&self, freq: f64) -> Option<usize> {
        let freqs = &self.sweep.freqs;
        let within = freqs.first().is_some_and(|lo| freq >= *lo) && freqs.last().is_some_and(|hi| freq <= *hi);
        let distance = |k: &usize| (freqs[*k] - freq).abs();
        (0..freqs.len()).filter(|_| within).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// What there is to say of one frequency: frequency, |S11|, impedance, standing wave ratio.
    pub(super) fn reading(&self, k: usize) -> String {
        let s = self.sweep.s11[k];
        let size = s.norm();
        let ratio = if size < 1.0 { format!("{:.2}", (1.0 + size) / (1.0 - size)) } else { "∞".to_owned() };
        format!(
            "{:.3} GHz   {:.2} dB\n{}   VSWR {ratio}",
            self.sweep.freqs[k] / GHZ,
            20.0 * size.log10(),
            ohms(impedance(s, self.sweep.reference))
        )
    }
}

/// The impedance of a reflection.
pub(super) fn impedance(s: Complex<f64>, reference: f64) -> Complex<f64> {
    let one = Complex::from(1.0);
    (one + s) / (one - s) * reference
}

/// An impedance in writing.
pub(super) fn ohms(z: Complex<f64>) -> String {
    let sign = if z.im < 0.0 { "−" } else { "+" };
    format!("{:.1} {sign} j{:.1} Ω", z.re, z.im.abs())
}

/// The curves on show, the one under way last.
pub(super) fn traces<'a>(solve: &'a SolveSession, tokens: &Tokens) -> Vec<Trace<'a>> {
    let finished = solve.shown().map(|run| Trace {
        name: &run.name,
        color: tokens.series[run.color],
        sweep: &run.result.sweep,
        resonance: run.result.resonance,
        is_live: false,
    });
    let live = solve.live().and_then(|run| run.sweep.as_ref()).map(|sweep| Trace {
        name: "Under way",
        color: tokens.series[solve.next_color()],
        sweep,
        resonance: None,
        is_live: true,
    });
    finished.chain(live).collect()
}
