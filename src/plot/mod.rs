//! Line plots for print: a grid of panels with shared axes and one legend, as SVG, PNG and CSV of what is drawn.
//!
//! Enters: a [`Figure`] of named series. Leaves: three files of the same stem. SVG and PNG come from the same drawing
//! on a fine pixel grid, so they look alike; the CSV has one row per point, with the reason where there is none. Text
//! is set in the font in assets/fonts, so that no font of the system is needed.
//!
//! Patterns over an angle are drawn as [`Polar`] figures by the same means.
//!
//! Not handled: anything but lines over one abscissa or angle.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "pixel positions of a figure of known size"
)]

mod axes;
mod canvas;
mod layout;
mod polar;

use anyhow::{Context, Result, anyhow};
use canvas::Canvas;
use plotters::prelude::{BitMapBackend, DrawingBackend, IntoDrawingArea, SVGBackend};
use std::path::Path;

pub(super) use axes::Axis;
pub(super) use polar::{Curve, Dial, Polar};

/// Drawing grid points per unit of the figure's size: SVG coordinates are whole grid points.
const GRID: u32 = 4;
/// Grid points averaged into one pixel of the PNG, along each side, which smooths its edges.
const PER_PIXEL: u32 = 2;

/// One figure.
pub(super) struct Figure {
    /// Stem of the files.
    pub(super) name: &'static str,
    pub(super) title: String,
    /// Heading of the legend.
    pub(super) legend: String,
    /// Row by row.
    pub(super) panels: Vec<Panel>,
    /// Panels in a row.
    pub(super) columns: usize,
    /// Shared by all panels.
    pub(super) x: Axis,
}

/// One panel; those of a row share the range of y.
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) y: Axis,
    pub(super) series: Vec<Series>,
}

/// One line.
pub(super) struct Series {
    /// Name in the legend; equal names in several panels stand there once.
    pub(super) name: String,
    pub(super) color: [u8; 3],
    pub(super) style: Style,
    pub(super) points: Vec<Point>,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    /// A solid line with its points marked.
    Marked,
    /// A solid line: many points.
    Plain,
    /// A dashed line: a reference.
    Dashed,
}

/// A value over its abscissa, or why there is none.
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: Result<f64, String>,
}

impl Figure {
    /// Writes `<name>.svg`, `<name>.png` and `<name>.csv` into a folder that exists.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(super) fn write(&self, folder: &Path) -> Result<()> {
        let to = |extension: &str| folder.join(format!("{}.{extension}", self.name));
        crate::io::write_atomic(&to("csv"), self.csv().as_bytes())?;
        crate::io::write_atomic(&to("svg"), self.svg()?.as_bytes())?;
        crate::io::write_atomic(&to("png"), &self.png()?)?;
        Ok(())
    }

    fn csv(&self) -> String {
        let mut text = format!("panel,series,{},value,refused\n", csv_name(&self.x.label));
        for panel in &self.panels {
            for series in &panel.series {
                for point in &series.points {
                    let (value, refused) = match &point.y {
                        Ok(y) => (y.to_string(), String::new()),
                        Err(reason) => (String::new(), quoted(reason)),
                    };
                    let (panel, name) = (quoted(&panel.title), quoted(&series.name));
                    text.push_str(&format!("{panel},{name},{},{value},{refused}\n", point.x));
                }
            }
        }
        text
    }
}

impl Drawing for Figure {
    fn name(&self) -> &str {
        self.name
    }

    fn size(&self) -> (u32, u32) {
        layout::size(self)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<()> {
        layout::draw(self, canvas)
    }
}

/// What can be drawn on any backend, and so written as SVG and PNG.
trait Drawing {
    fn name(&self) -> &str;

    /// Width and height in units of the figure.
    fn size(&self) -> (u32, u32);

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<()>;

    /// The drawing on the fine grid, to be shown at the figure's own size.
    fn svg(&self) -> Result<String> {
        canvas::register_fonts();
        let (width, height) = self.size();
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, (width * GRID, height * GRID)).into_drawing_area();
            self.draw(&Canvas::new(&area, canvas::SVG_DROP))?;
            area.present().map_err(|e| anyhow!("drawing {}: {e}", self.name()))?;
        }
        let grid = format!("width=\"{}\" height=\"{}\"", width * GRID, height * GRID);
        Ok(svg.replacen(&grid, &format!("width=\"{width}\" height=\"{height}\""), 1))
    }

    fn png(&self) -> Result<Vec<u8>> {
        canvas::register_fonts();
        let (width, height) = self.size();
        let (wide, high) = (width * GRID, height * GRID);
        let mut pixels = vec![255; (wide * high * 3) as usize];
        {
            let area = BitMapBackend::with_buffer(&mut pixels, (wide, high)).into_drawing_area();
            self.draw(&Canvas::new(&area, canvas::PICTURE_DROP))?;
            area.present().map_err(|e| anyhow!("drawing {}: {e}", self.name()))?;
        }
        let (small, width, height) = averaged(&pixels, wide, high);
        encode(&small, width, height).with_context(|| format!("encoding {}.png", self.name()))
    }
}

/// Writes an RGB picture as PNG.
fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// Means of squares of [`PER_PIXEL`] grid points.
fn averaged(pixels: &[u8], wide: u32, high: u32) -> (Vec<u8>, u32, u32) {
    let (width, height) = (wide / PER_PIXEL, high / PER_PIXEL);
    let mut small = Vec::with_capacity((width * height * 3) as usize);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let at = |dx, dy| pixels[(((y * PER_PIXEL + dy) * wide + x * PER_PIXEL + dx) * 3 + channel) as usize];
                let sum: u32 = (0..PER_PIXEL).flat_map(|dy| (0..PER_PIXEL).map(move |dx| u32::from(at(dx, dy)))).sum();
                small.push((sum / (PER_PIXEL * PER_PIXEL)) as u8);
            }
        }
    }
    (small, width, height)
}

/// A label with its unit as a column name: "bend radius R (mm)" becomes `bend_radius_R_mm`.
fn csv_name(label: &str) -> String {
    let words = label.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty());
    words.collect::<Vec<_>>().join("_")
}

/// A text as a CSV cell.
pub(super) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> Figure {
        let points = |f: fn(f64) -> f64| [4.0, 10.0, 40.0].map(|x| Point { x, y: Ok(f(x)) }).into_iter().collect();
        let mut broken: Vec<Point> = points(|x| -1.0 / x);
        broken[0].y = Err("too tight, \"4 mm\"".to_owned());
        let series = |name: &str, style, points| Series { name: name.to_owned(), color: [0, 90, 180], style, points };
        let panel = Panel {
            title: "left, right".to_owned(),
            y: Axis::linear("error (%)"),
            series: vec![series("a", Style::Marked, broken), series("b", Style::Dashed, points(|x| 1.0 / x))],
        };
        Figure {
            name: "test",
            title: "A test".to_owned(),
            legend: "series".to_owned(),
            panels: vec![panel],
            columns: 1,
            x: Axis::log("bend radius R (mm)", &[4.0, 10.0, 40.0]),
        }
    }

    #[test]
    fn the_table_holds_every_point_and_why_one_is_missing() {
        let csv = figure().csv();
        let rows: Vec<&str> = csv.lines().collect();
        assert_eq!(rows[0], "panel,series,bend_radius_R_mm,value,refused", "header");
        assert_eq!(rows[1], "\"left, right\",a,4,,\"too tight, \"\"4 mm\"\"\"", "a refused point");
        assert_eq!(rows[2], "\"left, right\",a,10,-0.1,", "a point");
        assert_eq!(rows.len(), 7, "all points");
    }

    #[test]
    fn svg_and_png_are_drawn_and_the_same_each_time() {
        let folder = tempfile::tempdir().unwrap();
        figure().write(folder.path()).unwrap();
        let svg = std::fs::read_to_string(folder.path().join("test.svg")).unwrap();
        for text in ["A test", "error (%)", "bend radius R (mm)", "left, right"] {
            assert!(svg.contains(text), "{text} stands in the drawing");
        }
        let png = std::fs::read(folder.path().join("test.png")).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
        decoder.next_frame(&mut pixels).unwrap();
        let blue = pixels.chunks(3).filter(|p| p[2] > 120 && p[0] < 40).count();
        assert!(blue > 100, "the lines are there: {blue} blue pixels");
        assert_eq!(figure().png().unwrap(), png, "deterministic");
    }
}
