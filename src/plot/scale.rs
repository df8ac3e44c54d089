//! A scale of colours as a picture of its own, to be laid over another one.

use super::canvas::{self, Anchor, Canvas, Font, failed};
use super::layout::{HEADING, TICK};
use super::{GRID, PlotError, averaged};
use plotters::prelude::{BitMapBackend, DrawingBackend, IntoDrawingArea};

const WIDTH: f64 = 190.0;
const TITLE: f64 = 24.0;
const BAR: [f64; 2] = [14.0, 240.0];
const MARGIN: f64 = 8.0;

/// A bar of colours with its title and ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorScale {
    /// What is shown, with its unit.
    pub title: String,
    /// Values in equal steps, from the top; at least two.
    pub ticks: Vec<String>,
    /// Colours from the top, in equal steps.
    pub colors: Vec<[u8; 3]>,
    /// Colour of the lettering.
    pub ink: [u8; 3],
}

/// Pixels with straight alpha, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overlay {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green, blue, alpha.
    pub pixels: Vec<[u8; 4]>,
}

impl ColorScale {
    /// The scale on nothing.
    ///
    /// * `per_unit`: pixels to a unit of the drawing, of which the whole is 190 wide: 1, 2 or 4.
    ///
    /// # Errors
    /// [`PlotError`] if the drawing library gives up.
    pub fn overlay(&self, per_unit: u32) -> Result<Overlay, PlotError> {
        canvas::register_fonts();
        let (wide, high) = (WIDTH as u32 * GRID, (TITLE + BAR[1] + 2.0 * MARGIN) as u32 * GRID);
        let on = |ground: [u8; 3]| -> Result<_, PlotError> {
            let mut pixels = vec![0; (wide * high * 3) as usize];
            {
                let area = BitMapBackend::with_buffer(&mut pixels, (wide, high)).into_drawing_area();
                self.draw(&Canvas::new(&area, canvas::PICTURE_DROP), ground)?;
                area.present().map_err(failed)?;
            }
            Ok(averaged(&pixels, wide, high, GRID / per_unit.clamp(1, GRID)))
        };
        let (black, width, height) = on([0; 3])?;
        let (white, ..) = on([255; 3])?;
        // What differs between the two grounds is what is seen of the ground.
        let pixels = black.as_chunks::<3>().0.iter().zip(white.as_chunks::<3>().0).map(|(b, w)| {
            let seen = (0..3).map(|c| w[c].saturating_sub(b[c])).min().unwrap_or(255);
            let alpha = 255 - seen;
            let straight = |c: u8| (u32::from(c) * 255 / u32::from(alpha.max(1))).min(255) as u8;
            [straight(b[0]), straight(b[1]), straight(b[2]), alpha]
        });
        Ok(Overlay { width, height, pixels: pixels.collect() })
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>, ground: [u8; 3]) -> Result<(), PlotError> {
        canvas.fill(ground)?;
        let right = WIDTH - MARGIN;
        let title = Font { size: 13.0, ..HEADING };
        canvas.text(&self.title, (right, MARGIN + 6.0), title, Anchor::Right, self.ink)?;
        let (left, top) = (right - 76.0, TITLE + MARGIN);
        let n = self.colors.len().max(1) as f64;
        for (k, &color) in self.colors.iter().enumerate() {
            let y = |k: usize| top + BAR[1] * k as f64 / n;
            canvas.bar((left, y(k)), (left + BAR[0], y(k + 1)), color)?;
        }
        let (x, bottom) = (left + BAR[0], top + BAR[1]);
        canvas.line(&[(left, top), (x, top), (x, bottom), (left, bottom), (left, top)], self.ink, 0.75)?;
        let last = self.ticks.len().saturating_sub(1).max(1) as f64;
        for (k, tick) in self.ticks.iter().enumerate() {
            let y = top + BAR[1] * k as f64 / last;
            canvas.line(&[(x, y), (x + 4.0, y)], self.ink, 0.75)?;
            canvas.text(tick, (x + 7.0, y), TICK, Anchor::Left, self.ink)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_is_opaque_its_surroundings_are_clear_and_the_lettering_has_its_ink() {
        let scale = ColorScale {
            title: "Strain (%)".to_owned(),
            ticks: ["+1", "0", "-1"].map(str::to_owned).into(),
            colors: vec![[200, 10, 20], [30, 40, 210]],
            ink: [10, 120, 30],
        };
        for per_unit in [1, 2, 4] {
            let Overlay { width, height, pixels } = scale.overlay(per_unit).unwrap();
            assert_eq!((width, height), (190 * per_unit, 280 * per_unit), "size");
            let at = |x: u32, y: u32| pixels[(y * per_unit * width + x * per_unit) as usize];
            assert_eq!(at(112, 60), [200, 10, 20, 255], "upper half");
            assert_eq!(at(112, 250), [30, 40, 210, 255], "lower half");
            assert_eq!(at(20, 200)[3], 0, "beside it");
            let ink = pixels.iter().filter(|p| p[3] > 200 && p[1] > 100 && p[0] < 30 && p[2] < 60).count();
            assert!(ink > 50 * per_unit as usize, "lettering: {ink}");
        }
    }
}
