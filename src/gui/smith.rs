//! The Smith chart: circles of constant resistance and reactance in the unit disc, curves, and what the pointer is at.

use super::outbox::Outbox;
use super::plot_export;
use super::plots::PlotKind;
use super::theme::Tokens;
use super::trace::{Trace, ohms};
use crate::plot::{MARKS, arc, reflection};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, RichText, Sense, Stroke, Ui, pos2, vec2};
use nalgebra::Complex;

/// Room around the disc for its lettering, points.
const MARGIN: f32 = 24.0;
/// How far from a curve the pointer still reads it, points.
const REACH: f32 = 14.0;

/// The disc on the screen.
#[derive(Clone, Copy, Debug)]
struct Disc {
    center: Pos2,
    radius: f32,
}

impl Disc {
    fn place(self, gamma: Complex<f64>) -> Pos2 {
        self.center + vec2(gamma.re as f32, -gamma.im as f32) * self.radius
    }
}

/// Draws the chart into all the room there is.
pub(super) fn ui(ui: &mut Ui, traces: &[Trace<'_>], out: &mut Outbox) {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click());
    let what = format!("Smith chart: {} curves", traces.len());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &what));
    plot_export::menu(&response, PlotKind::Smith, out);
    let tokens = Tokens::here(ui);
    let disc = Disc { center: rect.center(), radius: (rect.size().min_elem() / 2.0 - MARGIN).max(10.0) };
    let painter = ui.painter().with_clip_rect(rect);
    grid(&painter, disc, tokens);
    for trace in traces {
        let places: Vec<Pos2> = trace.sweep.s11.iter().map(|&s| disc.place(s)).collect();
        let stroke = Stroke::new(1.8, trace.color);
        if trace.is_live {
            painter.extend(egui::Shape::dashed_line(&places, stroke, 6.0, 4.0));
        } else {
            painter.line(places, stroke);
        }
        if let Some(k) = trace.resonance.and_then(|r| trace.nearest(r.freq)) {
            dot(&painter, disc.place(trace.sweep.s11[k]), trace.color, tokens);
        }
    }
    read_out(&painter, rect, disc, traces, response, tokens);
}

fn dot(painter: &Painter, at: Pos2, color: Color32, tokens: &Tokens) {
    painter.circle(at, 4.5, color, Stroke::new(1.5, tokens.field));
}

fn grid(painter: &Painter, disc: Disc, tokens: &Tokens) {
    painter.circle(disc.center, disc.radius, tokens.field, Stroke::new(1.2, tokens.weak));
    let thin = Stroke::new(0.8, tokens.grid.gamma_multiply(0.55));
    let font = FontId::proportional(10.0);
    let draw = |line: Vec<Complex<f64>>| {
        painter.line(line.into_iter().map(|g| disc.place(g)).collect(), thin);
    };
    painter.line_segment([disc.place(Complex::from(-1.0)), disc.place(Complex::from(1.0))], thin);
    for mark in MARKS {
        for sign in [1.0, -1.0] {
            draw(arc(|x| Complex::new(mark, sign * x)));
            draw(arc(|r| Complex::new(r, sign * mark)));
            let rim = reflection(Complex::new(0.0, sign * mark));
            let text = format!("{}j{mark}", if sign < 0.0 { "−" } else { "" });
            // Letterings are wider than high.
            let away = 8.0 + 7.0 * rim.re.abs();
            let out = disc.place(rim * (1.0 + away / f64::from(disc.radius)));
            painter.text(out, Align2::CENTER_CENTER, text, font.clone(), tokens.weak);
        }
        let place = disc.place(reflection(Complex::from(mark)));
        painter.text(place - vec2(1.0, 1.0), Align2::RIGHT_BOTTOM, format!("{mark}"), font.clone(), tokens.weak);
    }
}

/// Reads the point of a curve nearest to the pointer, else the impedance at the pointer itself.
fn read_out(
    painter: &Painter,
    rect: Rect,
    disc: Disc,
    traces: &[Trace<'_>],
    response: egui::Response,
    tokens: &Tokens,
) {
    let reference = traces.first().map_or(50.0, |t| t.sweep.reference);
    let corner = pos2(rect.left() + 4.0, rect.bottom() - 3.0);
    painter.text(corner, Align2::LEFT_BOTTOM, format!("{reference} Ω"), FontId::proportional(11.0), tokens.weak);
    let Some(pointer) = response.hover_pos() else { return };
    let all = traces.iter().flat_map(|t| (0..t.sweep.s11.len()).map(move |k| (t, k)));
    let measured = all.map(|(t, k)| (disc.place(t.sweep.s11[k]).distance(pointer), t, k));
    match measured.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(distance, ..)| *distance < REACH) {
        Some((_, trace, k)) => {
            dot(painter, disc.place(trace.sweep.s11[k]), trace.color, tokens);
            response.on_hover_ui_at_pointer(|ui| {
                ui.label(RichText::new(trace.name).color(trace.color).strong());
                ui.label(trace.reading(k));
            });
        }
        None => {
            let v = (pointer - disc.center) / disc.radius;
            if v.length() < 1.0 {
                let gamma = Complex::new(f64::from(v.x), -f64::from(v.y));
                response.on_hover_text_at_pointer(ohms(super::trace::impedance(gamma, reference)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_match_is_in_the_middle_and_a_coil_above() {
        let disc = Disc { center: pos2(100.0, 100.0), radius: 50.0 };
        assert_eq!(disc.place(reflection(Complex::from(1.0))), pos2(100.0, 100.0), "matched");
        let coil = disc.place(reflection(Complex::new(0.0, 1.0)));
        assert!(coil.distance(pos2(100.0, 50.0)) < 1e-4, "inductive is up: {coil}");
    }
}
