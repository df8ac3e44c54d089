//! Patterns over an angle: dials side by side with one scale and one legend.
//!
//! Zero is up, positive angles run to the right; the radius is in decibels, from a chosen depth below the rim at the center.

use super::canvas::{Anchor, Canvas};
use super::layout::{GRID_LINE, HEADING, INK, LEGEND_ROW, PAPER, SAMPLE, SOFT, TICK, TITLE, legend_width};
use super::{Drawing, GRID, PlotError, quoted};
use plotters::prelude::DrawingBackend;

/// A figure of dials.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar {
    /// Stem of the files.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// Unit of the values, written at the scale.
    pub unit: &'static str,
    /// Decibels from the rim to the center.
    pub depth: f64,
    /// Two to a row.
    pub dials: Vec<Dial>,
}

/// One dial.
#[derive(Clone, Debug, PartialEq)]
pub struct Dial {
    /// Heading.
    pub title: String,
    /// Its lines.
    pub curves: Vec<Curve>,
}

/// One line.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend, which the first dial gives.
    pub name: String,
    /// Red, green, blue.
    pub color: [u8; 3],
    /// A dashed line: drawn over others that it may hide.
    pub dashed: bool,
    /// Angle, rad, and value, dB.
    pub points: Vec<(f64, f64)>,
}

/// Decibels between two circles.
const RING: f64 = 10.0;
const RADIUS: f64 = 150.0;
const MARGIN: f64 = 46.0;
const TOP: f64 = 46.0;
const DIAL_TITLE: f64 = 26.0;
const COLUMNS: usize = 2;
const WIDTH: f64 = 2.0 * (RADIUS + MARGIN);
const HEIGHT: f64 = WIDTH + DIAL_TITLE;

impl Polar {
    fn names(&self) -> impl Iterator<Item = &str> {
        self.dials.iter().take(1).flat_map(|d| &d.curves).map(|c| c.name.as_str())
    }

    /// Value at the rim: the next whole ring above all of them.
    fn rim(&self) -> f64 {
        let values = self.dials.iter().flat_map(|d| &d.curves).flat_map(|c| &c.points).map(|(_, v)| *v);
        (values.fold(f64::NEG_INFINITY, f64::max) / RING).ceil().clamp(-1e3, 1e3) * RING
    }
}

impl Drawing for Polar {
    fn size(&self) -> (u32, u32) {
        let rows = self.dials.len().div_ceil(COLUMNS);
        ((COLUMNS as f64 * WIDTH + legend_width(self.names())) as u32, (TOP + rows as f64 * HEIGHT) as u32)
    }

    fn csv(&self) -> String {
        let mut text = format!("dial,curve,angle_deg,value_{}\n", self.unit);
        for (dial, curve) in self.dials.iter().flat_map(|d| d.curves.iter().map(move |c| (d, c))) {
            let (dial, name) = (quoted(&dial.title), quoted(&curve.name));
            for (angle, value) in &curve.points {
                text.push_str(&format!("{dial},{name},{},{value}\n", angle.to_degrees()));
            }
        }
        text
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), PlotError> {
        canvas.fill(PAPER)?;
        canvas.text(&self.title, (MARGIN / 2.0, 14.0), TITLE, Anchor::Corner, INK)?;
        let rim = self.rim();
        for (k, dial) in self.dials.iter().enumerate() {
            let left = (k % COLUMNS) as f64 * WIDTH;
            let top = TOP + (k / COLUMNS) as f64 * HEIGHT;
            let center = (left + WIDTH / 2.0, top + DIAL_TITLE + WIDTH / 2.0);
            canvas.text(&dial.title, (left + MARGIN / 2.0, top), HEADING, Anchor::Corner, INK)?;
            self.scale(canvas, center, rim)?;
            for curve in &dial.curves {
                let at = |&(angle, value): &(f64, f64)| place(center, angle, 1.0 - (rim - value) / self.depth);
                curve.stroke(canvas, &curve.points.iter().map(at).collect::<Vec<_>>())?;
            }
        }
        let left = COLUMNS as f64 * WIDTH;
        for (k, curve) in self.dials.iter().take(1).flat_map(|d| &d.curves).enumerate() {
            let y = TOP + DIAL_TITLE + MARGIN + LEGEND_ROW * k as f64;
            curve.stroke(canvas, &[(left, y), (left + 26.0, y)])?;
            canvas.text(&curve.name, (left + SAMPLE, y), TICK, Anchor::Left, INK)?;
        }
        Ok(())
    }
}

/// A point of a dial: zero up, a share of the radius from the center.
fn place(center: (f64, f64), angle: f64, share: f64) -> (f64, f64) {
    let radius = RADIUS * share.clamp(0.0, 1.0);
    (center.0 + radius * angle.sin(), center.1 - radius * angle.cos())
}

impl Polar {
    fn scale<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>, center: (f64, f64), rim: f64) -> Result<(), PlotError> {
        let n_rings = (self.depth / RING) as usize;
        for ring in 1..=n_rings {
            let share = ring as f64 / n_rings as f64;
            let circle: Vec<_> = (0..=180).map(|k| place(center, f64::from(k * 2).to_radians(), share)).collect();
            canvas.line(&circle, if ring == n_rings { SOFT } else { GRID_LINE }, 0.75)?;
        }
        for degree in (0_i32..360).step_by(30) {
            let angle = f64::from(degree).to_radians();
            canvas.line(&[center, place(center, angle, 1.0)], GRID_LINE, 0.75)?;
            let shown = if degree > 180 { degree - 360 } else { degree };
            let (x, y) = place(center, angle, 1.0);
            let (x, y) = (x + 20.0 * angle.sin(), y - 14.0 * angle.cos());
            canvas.text(&format!("{shown}"), (x, y - 6.0), TICK, Anchor::Below, SOFT)?;
        }
        for ring in 1..=n_rings {
            let share = ring as f64 / n_rings as f64;
            let unit = if ring == n_rings { format!(" {}", self.unit) } else { String::new() };
            let text = format!("{:.0}{unit}", rim - self.depth * (1.0 - share));
            let (x, y) = place(center, 0.26, share);
            canvas.text(&text, (x + 2.0, y), TICK, Anchor::Left, SOFT)?;
        }
        Ok(())
    }
}

impl Curve {
    fn stroke<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>, path: &[(f64, f64)]) -> Result<(), PlotError> {
        // Points that fall together have no direction to draw along.
        let mut path = path.to_vec();
        path.dedup_by(|p, q| (p.0 - q.0).hypot(p.1 - q.1) < 0.5 / f64::from(GRID));
        match self.dashed {
            true => canvas.dashed(&path, self.color, 1.6),
            false => canvas.line(&path, self.color, 1.6),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dial_holds_its_scale_and_curves() {
        let points = (-180..=180).map(|k| f64::from(k).to_radians()).map(|a| (a, 7.0 + 20.0 * a.cos().abs().log10()));
        let curve = Curve { name: "total".to_owned(), color: [0, 90, 180], dashed: false, points: points.collect() };
        let dial = Dial { title: "E plane".to_owned(), curves: vec![curve] };
        let polar = Polar { name: "test", title: "A pattern".to_owned(), unit: "dBi", depth: 40.0, dials: vec![dial] };
        let svg = polar.svg().unwrap();
        for text in ["A pattern", "E plane", "10 dBi", "-20", "-150", "total"] {
            assert!(svg.contains(text), "{text} stands in the drawing");
        }
        assert!((polar.rim() - 10.0).abs() < 1e-12, "the next ring above 7 dBi");
        let csv = polar.csv();
        assert_eq!(csv.lines().next(), Some("dial,curve,angle_deg,value_dBi"), "header");
        assert_eq!(csv.lines().count(), 362, "every point");
        assert_eq!(polar.png().unwrap(), polar.png().unwrap(), "deterministic");
    }
}
