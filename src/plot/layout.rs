//! Where everything stands in a figure: title, panels with axes and grid, legend.

use super::axes::Spread;
use super::canvas::{Anchor, Canvas, Font};
use super::{Figure, Panel, PlotError, Series, Style};
use plotters::prelude::DrawingBackend;

const PANEL: (f64, f64) = (390.0, 270.0);
const LEFT: f64 = 62.0;
const GAP: f64 = 26.0;
const TOP: f64 = 46.0;
const PANEL_TITLE: f64 = 24.0;
const BETWEEN_ROWS: f64 = 34.0;
const BOTTOM: f64 = 54.0;
const LEGEND: f64 = 172.0;
pub(super) const LEGEND_ROW: f64 = 20.0;
/// Room of a line's sample before its name, and of one letter of the name.
pub(super) const SAMPLE: f64 = 34.0;
const LETTER: f64 = 6.9;
/// Width of a bar over the distance of two of them.
const BAR: f64 = 0.88;

pub(super) const INK: [u8; 3] = [33, 37, 41];
pub(super) const SOFT: [u8; 3] = [90, 96, 102];
pub(super) const GRID_LINE: [u8; 3] = [228, 231, 234];
const ZERO_LINE: [u8; 3] = [150, 155, 160];
pub(super) const PAPER: [u8; 3] = [255, 255, 255];

pub(super) const TITLE: Font = Font { size: 16.0, bold: true };
pub(super) const HEADING: Font = Font { size: 13.0, bold: true };
const LABEL: Font = Font { size: 13.0, bold: false };
pub(super) const TICK: Font = Font { size: 12.0, bold: false };

/// Width and height of the figure.
pub(super) fn size(figure: &Figure) -> (u32, u32) {
    let rows = figure.panels.len().div_ceil(figure.columns);
    let names = figure.panels.iter().flat_map(|p| &p.series).map(|s| s.name.as_str());
    let width = LEFT + figure.columns as f64 * (PANEL.0 + GAP) + legend_width(names);
    let height = TOP + rows as f64 * (PANEL.1 + PANEL_TITLE + BETWEEN_ROWS) - BETWEEN_ROWS + BOTTOM;
    (width as u32, height as u32)
}

/// Room that the legend needs for its names.
pub(super) fn legend_width<'a>(names: impl Iterator<Item = &'a str>) -> f64 {
    let longest = names.map(|name| name.chars().count()).max().unwrap_or_default();
    LEGEND.max(SAMPLE + LETTER * longest as f64 + 12.0)
}

/// Draws the whole figure.
pub(super) fn draw<B: DrawingBackend>(figure: &Figure, canvas: &Canvas<'_, B>) -> Result<(), PlotError> {
    canvas.fill(PAPER)?;
    canvas.text(&figure.title, (LEFT, 14.0), TITLE, Anchor::Corner, INK)?;
    let all = || figure.panels.iter().flat_map(|p| &p.series);
    let x = figure.x.spread(all().flat_map(Series::abscissas));
    for (row, panels) in figure.panels.chunks(figure.columns).enumerate() {
        let values = panels.iter().flat_map(|p| &p.series).flat_map(Series::ordinates);
        let y = panels[0].y.spread(values);
        for (column, panel) in panels.iter().enumerate() {
            let frame = Frame {
                left: LEFT + column as f64 * (PANEL.0 + GAP),
                top: TOP + PANEL_TITLE + row as f64 * (PANEL.1 + PANEL_TITLE + BETWEEN_ROWS),
                x: &x,
                y: &y,
            };
            frame.grid(canvas, column == 0)?;
            frame.series(canvas, panel)?;
            frame.labels(canvas, panel, column == 0)?;
            if figure.panels.len() - (row * figure.columns + column) <= figure.columns {
                let middle = (frame.left + PANEL.0 / 2.0, frame.bottom() + 26.0);
                canvas.text(&figure.x.label, middle, LABEL, Anchor::Below, INK)?;
            }
        }
    }
    legend(figure, canvas)
}

fn legend<B: DrawingBackend>(figure: &Figure, canvas: &Canvas<'_, B>) -> Result<(), PlotError> {
    let left = LEFT + figure.columns as f64 * (PANEL.0 + GAP) + 2.0;
    let mut y = TOP + PANEL_TITLE + 8.0;
    canvas.text(&figure.legend, (left, y), HEADING, Anchor::Left, INK)?;
    let mut named: Vec<&str> = Vec::new();
    let all = || figure.panels.iter().flat_map(|p| &p.series);
    // References stand last, whatever panel a line first appears in.
    for series in all().filter(|s| s.style != Style::Dashed).chain(all().filter(|s| s.style == Style::Dashed)) {
        if named.contains(&series.name.as_str()) {
            continue;
        }
        named.push(&series.name);
        y += LEGEND_ROW;
        series.stroke(canvas, &[(left, y), (left + 26.0, y)])?;
        if series.style == Style::Marked {
            canvas.mark((left + 13.0, y), MARK, series.color)?;
        }
        canvas.text(&series.name, (left + SAMPLE, y), TICK, Anchor::Left, INK)?;
    }
    Ok(())
}

/// Radius of the mark at a point.
const MARK: f64 = 2.4;
/// Width of a line.
const STROKE: f64 = 1.6;

impl Series {
    /// The points that have a value.
    fn values(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points.iter().filter_map(|p| p.y.as_ref().ok().map(|&y| (p.x, y)))
    }

    /// Distance of two bars.
    fn step(&self) -> f64 {
        let gaps = self.points.windows(2).map(|p| (p[1].x - p[0].x).abs());
        if self.style == Style::Bars { gaps.fold(f64::INFINITY, f64::min).min(1e300) } else { 0.0 }
    }

    /// What the abscissa must reach: bars are as wide as they are apart.
    fn abscissas(&self) -> impl Iterator<Item = f64> {
        let half = if self.points.len() > 1 { self.step() / 2.0 } else { 0.0 };
        self.points.iter().flat_map(move |p| [p.x - half, p.x + half])
    }

    /// What the ordinate must reach: bars stand on zero.
    fn ordinates(&self) -> impl Iterator<Item = f64> {
        let zero = (self.style == Style::Bars).then_some(0.0);
        self.values().map(|(_, y)| y).chain(zero)
    }

    fn stroke<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>, path: &[(f64, f64)]) -> Result<(), PlotError> {
        match self.style {
            Style::Marked | Style::Plain | Style::Bars => canvas.line(path, self.color, STROKE),
            Style::Dashed => canvas.dashed(path, self.color, STROKE),
        }
    }
}

/// One panel's place and ranges.
struct Frame<'a> {
    left: f64,
    top: f64,
    x: &'a Spread,
    y: &'a Spread,
}

impl Frame<'_> {
    fn bottom(&self) -> f64 {
        self.top + PANEL.1
    }

    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.left + PANEL.0 * self.x.place(x), self.bottom() - PANEL.1 * self.y.place(y))
    }

    fn grid<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>, with_numbers: bool) -> Result<(), PlotError> {
        let (right, bottom) = (self.left + PANEL.0, self.bottom());
        for &tick in &self.x.ticks {
            let x = self.at((tick, self.y.lo)).0;
            canvas.line(&[(x, self.top), (x, bottom)], GRID_LINE, 0.75)?;
            canvas.line(&[(x, bottom), (x, bottom + 4.0)], SOFT, 0.75)?;
            canvas.text(&self.x.text(tick), (x, bottom + 8.0), TICK, Anchor::Below, SOFT)?;
        }
        for &tick in &self.y.ticks {
            let y = self.at((self.x.lo, tick)).1;
            let is_zero = !self.y.log && tick.abs() < 1e-9 * (self.y.hi - self.y.lo);
            let color = if is_zero { ZERO_LINE } else { GRID_LINE };
            canvas.line(&[(self.left, y), (right, y)], color, 0.75)?;
            if with_numbers {
                canvas.text(&self.y.text(tick), (self.left - 8.0, y), TICK, Anchor::Right, SOFT)?;
            }
        }
        canvas.line(&[(self.left, self.top), (self.left, bottom), (right, bottom)], SOFT, 1.0)
    }

    fn series<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>, panel: &Panel) -> Result<(), PlotError> {
        for series in &panel.series {
            if series.style == Style::Bars {
                let half = BAR * series.step() / 2.0;
                for (x, y) in series.values() {
                    canvas.bar(self.at((x - half, 0.0)), self.at((x + half, y)), series.color)?;
                }
                continue;
            }
            // A refused point breaks the line.
            for run in series.points.split(|p| p.y.is_err()) {
                let path: Vec<_> = run.iter().filter_map(|p| Some(self.at((p.x, *p.y.as_ref().ok()?)))).collect();
                if path.len() > 1 {
                    series.stroke(canvas, &path)?;
                }
                if series.style == Style::Marked {
                    path.iter().try_for_each(|&p| canvas.mark(p, MARK, series.color))?;
                }
            }
        }
        Ok(())
    }

    fn labels<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
        panel: &Panel,
        with_label: bool,
    ) -> Result<(), PlotError> {
        canvas.text(&panel.title, (self.left, self.top - 18.0), HEADING, Anchor::Corner, INK)?;
        if with_label {
            let middle = (self.left - 48.0, self.top + PANEL.1 / 2.0);
            canvas.text(&panel.y.label, middle, LABEL, Anchor::Upwards, INK)?;
        }
        Ok(())
    }
}
