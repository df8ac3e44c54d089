//! The Smith chart: circles of constant resistance and reactance in the unit disc, with curves of reflection over them.

use super::canvas::{Anchor, Canvas};
use super::layout::{INK, LEGEND_ROW, PAPER, SAMPLE, SOFT, TICK, TITLE, legend_width};
use super::{Drawing, PlotError, quoted};
use nalgebra::Complex;
use plotters::prelude::DrawingBackend;

/// Resistances and reactances that are drawn, parts of the reference.
pub const MARKS: [f64; 5] = [0.2, 0.5, 1.0, 2.0, 5.0];
/// Intervals of an arc.
pub const ARC_POINTS: u8 = 48;

const RADIUS: f64 = 210.0;
const MARGIN: f64 = 44.0;
const TOP: f64 = 40.0;
const MARK: f64 = 3.4;
/// Points of a curve that are drawn at once: too few to come round.
const PIECE: usize = 12;
/// Thin lines are many here, and need more weight than those of a grid.
const THIN: [u8; 3] = [202, 207, 212];

/// A Smith chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Smith {
    /// Heading.
    pub title: String,
    /// Impedance in the middle, ohm.
    pub reference: f64,
    /// Its curves.
    pub traces: Vec<Trace>,
}

/// One curve of reflection.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Name in the legend.
    pub name: String,
    /// Red, green, blue.
    pub color: [u8; 3],
    /// Frequencies, GHz.
    pub freqs_ghz: Vec<f64>,
    /// Reflection at each.
    pub s11: Vec<Complex<f64>>,
    /// The one that is marked: the resonance.
    pub marked: Option<usize>,
}

/// The reflection of an impedance relative to the reference.
#[must_use]
pub fn reflection(z: Complex<f64>) -> Complex<f64> {
    (z - 1.0) / (z + 1.0)
}

/// The part of a reflection's line inside the disc where the resistance or the reactance is constant.
///
/// The other one runs through all values that passive loads have, so that nothing lies outside of the disc.
pub fn arc(at: impl Fn(f64) -> Complex<f64>) -> Vec<Complex<f64>> {
    // From 0 to infinity, evenly in reflection.
    let places = (0..=ARC_POINTS).map(|k| f64::from(k) / f64::from(ARC_POINTS));
    places.map(|t| reflection(at(t / (1.0 - t).max(1e-9)))).collect()
}

fn place(gamma: Complex<f64>) -> (f64, f64) {
    (MARGIN + RADIUS * (1.0 + gamma.re), TOP + MARGIN + RADIUS * (1.0 - gamma.im))
}

impl Drawing for Smith {
    fn csv(&self) -> String {
        let mut text = "curve,freq_ghz,s11_re,s11_im,z_re_ohm,z_im_ohm\n".to_owned();
        for trace in &self.traces {
            let name = quoted(&trace.name);
            for (freq, s) in trace.freqs_ghz.iter().zip(&trace.s11) {
                let z = (Complex::from(1.0) + s) / (Complex::from(1.0) - s) * self.reference;
                text.push_str(&format!("{name},{freq},{},{},{},{}\n", s.re, s.im, z.re, z.im));
            }
        }
        text
    }

    fn size(&self) -> (u32, u32) {
        let side = 2.0 * (RADIUS + MARGIN);
        ((side + legend_width(self.traces.iter().map(|t| t.name.as_str()))) as u32, (side + TOP) as u32)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), PlotError> {
        canvas.fill(PAPER)?;
        canvas.text(&self.title, (MARGIN / 2.0, 14.0), TITLE, Anchor::Corner, INK)?;
        grid(canvas)?;
        let foot = TOP + 2.0 * (RADIUS + MARGIN) - 16.0;
        canvas.text(&format!("{} \u{3a9}", self.reference), (MARGIN / 2.0, foot), TICK, Anchor::Left, SOFT)?;
        let left = 2.0 * (RADIUS + MARGIN);
        for (k, trace) in self.traces.iter().enumerate() {
            let mut path: Vec<(f64, f64)> = trace.s11.iter().map(|&s| place(s)).collect();
            path.dedup_by(|p, q| (p.0 - q.0).hypot(p.1 - q.1) < 0.3);
            // In short pieces: a line that crosses itself would be hollow there.
            for k in (0..path.len().saturating_sub(1)).step_by(PIECE) {
                canvas.line(&path[k..(k + PIECE + 1).min(path.len())], trace.color, 1.6)?;
            }
            if let Some(&s) = trace.marked.and_then(|m| trace.s11.get(m)) {
                canvas.mark(place(s), MARK, trace.color)?;
            }
            let y = TOP + MARGIN + LEGEND_ROW * k as f64;
            canvas.line(&[(left, y), (left + 26.0, y)], trace.color, 1.6)?;
            canvas.text(&trace.name, (left + SAMPLE, y), TICK, Anchor::Left, INK)?;
        }
        Ok(())
    }
}

fn grid<B: DrawingBackend>(canvas: &Canvas<'_, B>) -> Result<(), PlotError> {
    let line = |points: Vec<Complex<f64>>| canvas.line(&points.into_iter().map(place).collect::<Vec<_>>(), THIN, 0.75);
    line(vec![Complex::from(-1.0), Complex::from(1.0)])?;
    for mark in MARKS {
        for sign in [1.0, -1.0] {
            line(arc(|x| Complex::new(mark, sign * x)))?;
            line(arc(|r| Complex::new(r, sign * mark)))?;
            let rim = reflection(Complex::new(0.0, sign * mark));
            let (x, y) = place(rim * (1.0 + 18.0 / RADIUS));
            let text = format!("{}j{mark}", if sign < 0.0 { "\u{2212}" } else { "" });
            canvas.text(&text, (x, y - 7.0), TICK, Anchor::Below, SOFT)?;
        }
        let (x, y) = place(reflection(Complex::from(mark)));
        canvas.text(&format!("{mark}"), (x - 3.0, y - 8.0), TICK, Anchor::Right, SOFT)?;
    }
    let rim: Vec<(f64, f64)> =
        (0..=180).map(|k| place(Complex::from_polar(1.0, f64::from(2 * k).to_radians()))).collect();
    canvas.line(&rim, SOFT, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_constant_impedance_stay_in_the_disc_and_meet_at_its_right() {
        for mark in MARKS {
            for line in [arc(|x| Complex::new(mark, -x)), arc(|r| Complex::new(r, mark))] {
                assert!(line.iter().all(|g| g.norm() < 1.0 + 1e-12), "{mark}: inside");
                assert!((line[usize::from(ARC_POINTS)] - 1.0).norm() < 1e-6, "{mark}: an open end");
            }
            // The circle of resistance r has its center at r / (1 + r).
            let center = Complex::from(mark / (1.0 + mark));
            let off = |g: &Complex<f64>| ((g - center).norm() - 1.0 / (1.0 + mark)).abs();
            assert!(arc(|x| Complex::new(mark, x)).iter().all(|g| off(g) < 1e-12), "{mark}: a circle");
        }
    }
}
