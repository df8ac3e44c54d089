//! The usual plots of results: reflection, phase, Smith chart, cuts through patterns, histograms.

use super::smith::Trace;
use super::{Axis, Curve, Dial, Figure, Panel, Plot, Point, Polar, Series, Smith, Style, palette};
use crate::results::{Cut, Sweep};
use crate::units::GHZ;

/// The level that a band is measured at, dB.
const LEVEL_DB: f64 = -10.0;
/// A phase that jumps by more goes around, degrees.
const JUMP_DEG: f64 = 180.0;

/// A solved antenna: its name, its colour (red, green, blue) and S11.
#[derive(Clone, Copy, Debug)]
pub struct Reflection<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// Red, green, blue.
    pub color: [u8; 3],
    /// S11 over frequency.
    pub sweep: &'a Sweep,
}

impl Reflection<'_> {
    fn series(&self, points: Vec<Point>) -> Series {
        Series { name: self.name.to_owned(), color: self.color, style: Style::Plain, points }
    }
}

fn over_frequency(name: &'static str, title: &str, panel: &str, y: &str, series: Vec<Series>) -> Plot {
    let panel = Panel { title: panel.to_owned(), y: Axis::linear(y), series };
    Figure {
        name,
        title: title.to_owned(),
        legend: String::new(),
        panels: vec![panel],
        columns: 1,
        x: Axis::linear("frequency (GHz)"),
    }
    .into()
}

/// |S11| in dB with the -10 dB line.
#[must_use]
pub fn magnitude(title: &str, runs: &[Reflection<'_>]) -> Plot {
    let mut series: Vec<Series> = runs
        .iter()
        .map(|run| {
            let points = run.sweep.freqs.iter().zip(run.sweep.db());
            run.series(points.map(|(f, db)| Point { x: f / GHZ, y: Ok(db.max(-120.0)) }).collect())
        })
        .collect();
    let freqs = || runs.iter().flat_map(|run| run.sweep.freqs.iter().map(|f| f / GHZ));
    let ends = [freqs().fold(f64::INFINITY, f64::min), freqs().fold(f64::NEG_INFINITY, f64::max)];
    if ends[0] < ends[1] {
        series.push(Series {
            name: "\u{2212}10 dB".to_owned(),
            color: palette::REFERENCE,
            style: Style::Dashed,
            points: ends.map(|x| Point { x, y: Ok(LEVEL_DB) }).into(),
        });
    }
    over_frequency("s11", title, "At the ground's top", "|S11| (dB)", series)
}

/// The phase of S11 in degrees, in pieces where it goes around.
#[must_use]
pub fn phase(title: &str, runs: &[Reflection<'_>]) -> Plot {
    let mut series = Vec::new();
    for run in runs {
        let points: Vec<[f64; 2]> =
            run.sweep.freqs.iter().zip(&run.sweep.s11).map(|(f, s)| [f / GHZ, s.arg().to_degrees()]).collect();
        for piece in points.chunk_by(|a, b| (a[1] - b[1]).abs() < JUMP_DEG) {
            series.push(run.series(piece.iter().map(|&[x, y]| Point { x, y: Ok(y) }).collect()));
        }
    }
    over_frequency("s11_phase", title, "At the ground's top", "phase of S11 (\u{b0})", series)
}

/// The Smith chart, with the frequency of the smallest |S11| marked.
#[must_use]
pub fn smith(title: &str, runs: &[Reflection<'_>]) -> Plot {
    let trace = |run: &Reflection<'_>| Trace {
        name: run.name.to_owned(),
        color: run.color,
        freqs_ghz: run.sweep.freqs.iter().map(|f| f / GHZ).collect(),
        marked: (0..run.sweep.s11.len()).min_by(|&a, &b| run.sweep.s11[a].norm().total_cmp(&run.sweep.s11[b].norm())),
        s11: run.sweep.s11.clone(),
    };
    Plot::Smith(Smith {
        title: title.to_owned(),
        reference: runs.first().map_or(50.0, |run| run.sweep.reference),
        traces: runs.iter().map(trace).collect(),
    })
}

/// Name, colour, and the cuts around the E and the H plane of a solved antenna.
pub type Cuts<'a> = (&'a str, [u8; 3], &'a [Cut; 2]);

/// Directivity around the E and the H plane, over each other.
///
/// * `depth`: decibels from the rim to the center.
/// * `in_parts`: co-polarization, and cross-polarization dashed, instead of both together.
#[must_use]
pub fn cuts(title: &str, runs: &[Cuts<'_>], depth: f64, in_parts: bool) -> Plot {
    let dial = |plane: usize| {
        let curves = runs.iter().flat_map(|&(name, color, cuts)| {
            let cut = &cuts[plane];
            let curve = |name: String, dashed, values: &[f64]| Curve {
                name,
                color,
                dashed,
                points: cut.psi.iter().copied().zip(values.iter().copied()).collect(),
            };
            if in_parts {
                vec![curve(format!("{name}, co"), false, &cut.co), curve(format!("{name}, cross"), true, &cut.cross)]
            } else {
                vec![curve(name.to_owned(), false, &cut.total)]
            }
        });
        Dial { title: ["E plane (y z)", "H plane (x z)"][plane].to_owned(), curves: curves.collect() }
    };
    Polar { name: "pattern", title: title.to_owned(), unit: "dBi", depth, dials: [0, 1].map(dial).into() }.into()
}

/// A histogram of evenly wide bins.
///
/// * `start`, `step`: lower end of the first bin, and the width of each.
#[must_use]
pub fn histogram(name: &'static str, title: &str, [x, y]: [&str; 2], [start, step]: [f64; 2], bins: &[f64]) -> Plot {
    let points = bins.iter().enumerate().map(|(k, &v)| Point { x: start + (k as f64 + 0.5) * step, y: Ok(v) });
    let series =
        Series { name: y.to_owned(), color: palette::DISTINCT[0], style: Style::Bars, points: points.collect() };
    let panel = Panel { title: String::new(), y: Axis::linear(y), series: vec![series] };
    Figure { name, title: title.to_owned(), legend: String::new(), panels: vec![panel], columns: 1, x: Axis::linear(x) }
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Format;
    use crate::results::CutPlane;
    use nalgebra::Complex;

    fn text(plot: &Plot, format: Format) -> String {
        String::from_utf8(plot.bytes(format).unwrap()).unwrap()
    }

    #[test]
    fn every_chart_names_all_runs_and_its_table_holds_their_points() {
        let freqs: Vec<f64> = (0..50).map(|k| (8.0 + 0.1 * f64::from(k)) * GHZ).collect();
        let s11 = freqs.iter().map(|f| Complex::from_polar(0.7, -3e-9 * f)).collect();
        let sweep = Sweep { freqs, s11, reference: 50.0 };
        let names = ["flat & thin", "bent <10>"];
        let runs = names.map(|name| Reflection { name, color: [0, 90, 180], sweep: &sweep });
        for (plot, rows) in [(magnitude("A", &runs), 103), (phase("A", &runs), 101), (smith("A", &runs), 101)] {
            let svg = text(&plot, Format::Svg);
            assert!(svg.contains("flat &amp; thin") && svg.contains("bent &lt;10&gt;"), "{}: legend", plot.name());
            assert!(!svg.contains("<10>"), "{}: names are escaped", plot.name());
            assert_eq!(text(&plot, Format::Csv).lines().count(), rows, "{}: a row per point", plot.name());
            assert!(plot.bytes(Format::Png).unwrap().starts_with(b"\x89PNG"), "{}", plot.name());
        }
        let psi: Vec<f64> = (-180..=180).map(|k| f64::from(k).to_radians()).collect();
        let values: Vec<f64> = psi.iter().map(|p| 7.0 + 20.0 * p.cos().abs().max(1e-3).log10()).collect();
        let cut = |plane| Cut {
            plane,
            psi: psi.clone(),
            total: values.clone(),
            co: values.clone(),
            cross: vec![-30.0; psi.len()],
        };
        let both = [cut(CutPlane::E), cut(CutPlane::H)];
        let plot = cuts("A", &[(names[0], [0, 0, 0], &both), (names[1], [9, 9, 9], &both)], 30.0, true);
        let csv = text(&plot, Format::Csv);
        assert_eq!(csv.lines().count(), 1 + 2 * 2 * 2 * 361, "planes, runs, polarizations");
        assert!(csv.contains("\"bent <10>, cross\""), "named");
    }

    #[test]
    fn bars_stand_on_zero_and_fill_their_bins() {
        let plot = histogram("h", "Areas", ["strain (%)", "area (%)"], [-1.0, 0.5], &[10.0, 60.0, 30.0]);
        let csv = text(&plot, Format::Csv);
        assert!(csv.contains(",-0.75,10,"), "centers: {csv}");
        let Plot::Figure(figure) = plot else { panic!("a figure") };
        let png = Plot::from(figure).bytes(Format::Png).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
        decoder.next_frame(&mut pixels).unwrap();
        let blue = pixels.chunks(3).filter(|p| *p == palette::DISTINCT[0]).count();
        assert!(blue > 50_000, "filled: {blue}");
    }
}
