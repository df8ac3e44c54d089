//! Plots for print: lines over an abscissa, bars, patterns over an angle and Smith charts, as SVG, PNG and CSV.
//!
//! Enters: a [`Figure`] of named series, a [`Polar`] or a [`Smith`]; [`charts`] makes them of results. Leaves: the bytes
//! of a file ([`Plot::bytes`]); who writes it is the program's edge. SVG and PNG come from the same drawing on a fine
//! pixel grid, so they look alike; the CSV has one row per point, with the reason where there is none. Text is set in
//! the font in assets/fonts, so that no font of the system is needed. The ground is white: this is for paper.
//!
//! Not handled: surfaces, and several ordinates in one panel.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "pixel positions of a figure of known size"
)]

mod axes;
mod canvas;
pub mod charts;
mod layout;
pub mod palette;
mod polar;
mod scale;
mod smith;

use canvas::{Canvas, failed};
use plotters::prelude::{BitMapBackend, DrawingBackend, IntoDrawingArea, SVGBackend};

pub use axes::Axis;
pub use polar::{Curve, Dial, Polar};
pub use scale::{ColorScale, Overlay};
pub use smith::{ARC_POINTS, MARKS, Smith, Trace, arc, reflection};

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlotError {
    /// The drawing library gave up.
    #[error("the plot cannot be drawn: {reason}")]
    Drawing {
        /// What the library says.
        reason: String,
    },
}

/// The form of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Vectors, to be scaled at will.
    Svg,
    /// Pixels, two to a unit of the figure.
    Png,
    /// The numbers.
    Csv,
}

impl Format {
    /// All forms.
    pub const ALL: [Self; 3] = [Self::Svg, Self::Png, Self::Csv];

    /// Ending of the file's name.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Csv => "csv",
        }
    }
}

/// Any plot.
#[derive(Clone, Debug, PartialEq)]
pub enum Plot {
    /// Lines or bars over an abscissa.
    Figure(Figure),
    /// Lines over an angle.
    Polar(Polar),
    /// Reflections in the unit disc.
    Smith(Smith),
}

impl From<Figure> for Plot {
    fn from(figure: Figure) -> Self {
        Self::Figure(figure)
    }
}

impl From<Polar> for Plot {
    fn from(polar: Polar) -> Self {
        Self::Polar(polar)
    }
}

impl Plot {
    /// Stem of its files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Figure(figure) => figure.name,
            Self::Polar(polar) => polar.name,
            Self::Smith(_) => "smith",
        }
    }

    /// The contents of its file.
    ///
    /// # Errors
    /// [`PlotError`] if the drawing library gives up.
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        match self {
            Self::Figure(figure) => figure.bytes(format),
            Self::Polar(polar) => polar.bytes(format),
            Self::Smith(smith) => smith.bytes(format),
        }
    }
}

/// Drawing grid points per unit of the figure's size: SVG coordinates are whole grid points.
const GRID: u32 = 4;
/// Grid points averaged into one pixel of the PNG, along each side, which smooths its edges.
const PER_PIXEL: u32 = 2;

/// Panels with shared axes and one legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Stem of the files.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// Heading of the legend.
    pub legend: String,
    /// Row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
    /// Shared by all panels.
    pub x: Axis,
}

/// One panel; those of a row share the range of y.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Heading.
    pub title: String,
    /// Its ordinate.
    pub y: Axis,
    /// Its lines.
    pub series: Vec<Series>,
}

/// One line, or a row of bars.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; equal names in several panels stand there once.
    pub name: String,
    /// Red, green, blue.
    pub color: [u8; 3],
    /// How it is drawn.
    pub style: Style,
    /// Its points, by ascending abscissa.
    pub points: Vec<Point>,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A solid line with its points marked.
    Marked,
    /// A solid line: many points.
    Plain,
    /// A dashed line: a reference.
    Dashed,
    /// Bars that stand on zero, evenly spaced.
    Bars,
}

/// A value over its abscissa, or why there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Abscissa.
    pub x: f64,
    /// Ordinate.
    pub y: Result<f64, String>,
}

impl Drawing for Figure {
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

    fn size(&self) -> (u32, u32) {
        layout::size(self)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), PlotError> {
        layout::draw(self, canvas)
    }
}

/// What can be drawn on any backend, and so written as SVG and PNG.
trait Drawing {
    /// Every point as a row.
    fn csv(&self) -> String;

    /// Width and height in units of the figure.
    fn size(&self) -> (u32, u32);

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), PlotError>;

    fn bytes(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        match format {
            Format::Svg => self.svg().map(String::into_bytes),
            Format::Png => self.png(),
            Format::Csv => Ok(self.csv().into_bytes()),
        }
    }

    /// The drawing on the fine grid, to be shown at the figure's own size.
    fn svg(&self) -> Result<String, PlotError> {
        canvas::register_fonts();
        let (width, height) = self.size();
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, (width * GRID, height * GRID)).into_drawing_area();
            self.draw(&Canvas::new(&area, canvas::SVG_DROP))?;
            area.present().map_err(failed)?;
        }
        let grid = format!("width=\"{}\" height=\"{}\"", width * GRID, height * GRID);
        Ok(svg.replacen(&grid, &format!("width=\"{width}\" height=\"{height}\""), 1))
    }

    fn png(&self) -> Result<Vec<u8>, PlotError> {
        canvas::register_fonts();
        let (width, height) = self.size();
        let (wide, high) = (width * GRID, height * GRID);
        let mut pixels = vec![255; (wide * high * 3) as usize];
        {
            let area = BitMapBackend::with_buffer(&mut pixels, (wide, high)).into_drawing_area();
            self.draw(&Canvas::new(&area, canvas::PICTURE_DROP))?;
            area.present().map_err(failed)?;
        }
        let (small, width, height) = averaged(&pixels, wide, high, PER_PIXEL);
        encode(&small, width, height).map_err(failed)
    }
}

/// Writes an RGB picture as PNG.
fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// Means of squares of so many grid points on a side.
fn averaged(pixels: &[u8], wide: u32, high: u32, side: u32) -> (Vec<u8>, u32, u32) {
    let (width, height) = (wide / side, high / side);
    let mut small = Vec::with_capacity((width * height * 3) as usize);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let at = |dx, dy| pixels[(((y * side + dy) * wide + x * side + dx) * 3 + channel) as usize];
                let sum: u32 = (0..side).flat_map(|dy| (0..side).map(move |dx| u32::from(at(dx, dy)))).sum();
                small.push((sum / (side * side)) as u8);
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
#[must_use]
pub fn quoted(text: &str) -> String {
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
        let svg = figure().svg().unwrap();
        for text in ["A test", "error (%)", "bend radius R (mm)", "left, right"] {
            assert!(svg.contains(text), "{text} stands in the drawing");
        }
        let png = Plot::from(figure()).bytes(Format::Png).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let mut pixels = vec![0; decoder.output_buffer_size().unwrap()];
        decoder.next_frame(&mut pixels).unwrap();
        let blue = pixels.chunks(3).filter(|p| p[2] > 120 && p[0] < 40).count();
        assert!(blue > 100, "the lines are there: {blue} blue pixels");
        assert_eq!(figure().png().unwrap(), png, "deterministic");
    }
}
