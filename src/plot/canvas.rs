//! Lines, marks and text in the figure's own units, drawn on the fine grid of any plotters backend.

use super::{GRID, PlotError};
use plotters::coord::Shift;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{DrawingArea, DrawingBackend, RGBColor};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoFont, TextStyle, register_font};
use std::sync::Once;

/// Makes the fonts known to the drawing library.
pub(super) fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let regular: &[u8] = include_bytes!("../../assets/fonts/Inter-Regular.ttf");
        let bold: &[u8] = include_bytes!("../../assets/fonts/Inter-SemiBold.ttf");
        for (style, bytes) in [(FontStyle::Normal, regular), (FontStyle::Bold, bold)] {
            assert!(register_font(FAMILY, style, bytes).is_ok(), "the fonts in assets/fonts are intact");
        }
    });
}

/// The family's name in SVG: whatever the reader has, if not ours.
const FAMILY: &str = "sans-serif";

/// Where a text hangs at its point.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    /// Begins at the point, centered in height.
    Left,
    /// Ends at the point, centered in height.
    Right,
    /// Centered below the point.
    Below,
    /// Begins at the point, below it.
    Corner,
    /// Reads upwards, centered at the point.
    Upwards,
}

/// Size and weight of a text.
#[derive(Clone, Copy)]
pub(super) struct Font {
    pub(super) size: f64,
    pub(super) bold: bool,
}

/// A drawing area with coordinates in figure units from the upper left corner.
pub(super) struct Canvas<'a, B: DrawingBackend> {
    area: &'a DrawingArea<B, Shift>,
    /// How much lower a text must be asked for than it shall stand, in parts of its size.
    text_drop: f64,
}

/// [`Canvas`] of a picture: plotters centers the font's box, whose capitals stand in the upper half.
pub(super) const PICTURE_DROP: f64 = 0.19;
/// [`Canvas`] of an SVG file, which is centered by the height of small letters.
pub(super) const SVG_DROP: f64 = 0.06;

type Place = (f64, f64);

impl<'a, B: DrawingBackend> Canvas<'a, B> {
    pub(super) fn new(area: &'a DrawingArea<B, Shift>, text_drop: f64) -> Self {
        Self { area, text_drop }
    }

    fn at((x, y): Place) -> (i32, i32) {
        ((x * f64::from(GRID)).round() as i32, (y * f64::from(GRID)).round() as i32)
    }

    fn width(width: f64) -> u32 {
        (width * f64::from(GRID)).round().max(1.0) as u32
    }

    pub(super) fn fill(&self, color: [u8; 3]) -> Result<(), PlotError> {
        self.area.fill(&rgb(color)).map_err(failed)
    }

    pub(super) fn line(&self, points: &[Place], color: [u8; 3], width: f64) -> Result<(), PlotError> {
        let path: Vec<_> = points.iter().map(|&p| Self::at(p)).collect();
        let element = PathElement::new(path, rgb(color).stroke_width(Self::width(width)));
        self.area.draw(&element).map_err(failed)
    }

    /// A polyline with dashes whose rhythm runs on around its corners.
    pub(super) fn dashed(&self, points: &[Place], color: [u8; 3], width: f64) -> Result<(), PlotError> {
        const RHYTHM: [f64; 2] = [6.0, 4.0];
        let (mut phase, mut left) = (0, RHYTHM[0]);
        for pair in points.windows(2) {
            let ((ax, ay), (bx, by)) = (pair[0], pair[1]);
            let length = (bx - ax).hypot(by - ay);
            let on_line = |s: f64| (ax + (bx - ax) * s / length, ay + (by - ay) * s / length);
            let mut done = 0.0;
            while done < length {
                let step = left.min(length - done);
                if phase == 0 {
                    self.line(&[on_line(done), on_line(done + step)], color, width)?;
                }
                done += step;
                left -= step;
                if left <= 0.0 {
                    phase = 1 - phase;
                    left = RHYTHM[phase];
                }
            }
        }
        Ok(())
    }

    pub(super) fn mark(&self, center: Place, radius: f64, color: [u8; 3]) -> Result<(), PlotError> {
        let radius = (radius * f64::from(GRID)).round() as i32;
        self.area.draw(&Circle::new(Self::at(center), radius, rgb(color).filled())).map_err(failed)
    }

    /// A filled rectangle between two corners.
    pub(super) fn bar(&self, from: Place, to: Place, color: [u8; 3]) -> Result<(), PlotError> {
        self.area.draw(&Rectangle::new([Self::at(from), Self::at(to)], rgb(color).filled())).map_err(failed)
    }

    pub(super) fn text(
        &self,
        text: &str,
        at: Place,
        font: Font,
        anchor: Anchor,
        color: [u8; 3],
    ) -> Result<(), PlotError> {
        let (h, v, transform) = match anchor {
            Anchor::Left => (HPos::Left, VPos::Center, FontTransform::None),
            Anchor::Right => (HPos::Right, VPos::Center, FontTransform::None),
            Anchor::Below => (HPos::Center, VPos::Top, FontTransform::None),
            Anchor::Corner => (HPos::Left, VPos::Top, FontTransform::None),
            Anchor::Upwards => (HPos::Center, VPos::Center, FontTransform::Rotate270),
        };
        let drop = self.text_drop * font.size;
        let at = if matches!(anchor, Anchor::Upwards) { (at.0 + drop, at.1) } else { (at.0, at.1 + drop) };
        let weight = if font.bold { FontStyle::Bold } else { FontStyle::Normal };
        let desc = (FAMILY, font.size * f64::from(GRID), weight).into_font().transform(transform);
        let color = rgb(color);
        let style = TextStyle::from(desc).color(&color).pos(Pos::new(h, v));
        self.area.draw(&Text::new(text.to_owned(), Self::at(at), style)).map_err(failed)
    }
}

/// What the drawing library says.
pub(super) fn failed(error: impl std::fmt::Display) -> PlotError {
    PlotError::Drawing { reason: error.to_string() }
}

fn rgb([r, g, b]: [u8; 3]) -> RGBColor {
    RGBColor(r, g, b)
}
