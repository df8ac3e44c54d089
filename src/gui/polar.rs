//! The polar plot of a cut through the far field: directivity in dBi over the angle from broadside.

use super::outbox::Outbox;
use super::panel_results::square;
use super::plot_export;
use super::plots::PlotKind;
use super::solve_session::{FinishedRun, SolveSession};
use super::theme::Tokens;
use super::ui_state::{Polarization, SolveUi};
use crate::pipeline::solve_job::Pattern;
use crate::results::Cut;
use crate::units::GHZ;
use egui::{Align2, Color32, FontId, Painter, Pos2, RichText, Sense, Shape, Stroke, Ui, vec2};

/// Decibels between two rings.
const RING: f64 = 10.0;
/// Room around the outer ring for its lettering, points.
const MARGIN: f32 = 18.0;
/// Frequencies this close are one, Hz.
const SAME: f64 = 1e5;

/// The frequencies that any run has a pattern at, ascending, Hz.
pub(super) fn frequencies(solve: &SolveSession) -> Vec<f64> {
    let mut all: Vec<f64> = solve.runs().iter().flat_map(|r| r.result.patterns.iter().map(|p| p.field.freq)).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < SAME);
    all
}

/// The frequency on show: the chosen one, else the one nearest to the newest run's resonance.
pub(super) fn frequency(solve: &SolveSession, chosen: &SolveUi) -> Option<f64> {
    let newest = solve.shown().next_back().and_then(|run| run.result.resonance).map(|r| r.freq);
    let wanted = chosen.pattern_freq.or(newest);
    let all = frequencies(solve);
    match wanted {
        Some(wanted) => all.into_iter().min_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs())),
        None => all.get(all.len() / 2).copied(),
    }
}

/// A frequency in writing.
pub(super) fn freq_text(freq: f64) -> String {
    format!("{:.3} GHz", freq / GHZ)
}

/// The pattern of a run at a frequency, if it has one there.
pub(super) fn pattern(run: &FinishedRun, freq: f64) -> Option<&Pattern> {
    run.result.patterns.iter().find(|p| (p.field.freq - freq).abs() < SAME)
}

/// Directivity at the rim: the next ring above the greatest of the patterns, dBi.
pub(super) fn rim(greatest: f64) -> f64 {
    (greatest / RING).ceil() * RING
}

/// The plot on the screen.
#[derive(Clone, Copy, Debug)]
struct Dial {
    center: Pos2,
    radius: f32,
    /// Directivity at the rim, dBi, and decibels from there to the middle.
    rim: f64,
    range: f64,
}

impl Dial {
    /// Place of a directivity at an angle from broadside, which is up; positive angles are to the right.
    fn place(self, psi: f64, dbi: f64) -> Pos2 {
        let r = ((dbi - self.rim) / self.range + 1.0).clamp(0.0, 1.0);
        self.center + vec2((psi.sin() * r) as f32, -(psi.cos() * r) as f32) * self.radius
    }
}

/// Draws the cut `plane` (0: E, 1: H) of all runs on show.
pub(super) fn ui(ui: &mut Ui, solve: &SolveSession, plane: usize, chosen: &SolveUi, out: &mut Outbox) {
    let area = ui.available_rect_before_wrap();
    let name = ["E plane (y z)", "H plane (x z)"][plane];
    let response = ui.allocate_rect(area, Sense::click());
    let freq = frequency(solve, chosen);
    let found: Vec<(&FinishedRun, &Pattern)> =
        solve.shown().filter_map(|run| Some((run, pattern(run, freq?)?))).collect();
    let what = format!("Polar plot of the {name}: {} runs", found.len());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &what));
    plot_export::menu(&response, PlotKind::Cuts, out);
    let tokens = Tokens::here(ui);
    let painter = ui.painter().with_clip_rect(area);
    if found.is_empty() {
        let text = "No far field: it comes with the next run";
        painter.text(area.center(), Align2::CENTER_CENTER, text, FontId::proportional(13.0), tokens.weak);
        return;
    }
    let greatest = found.iter().map(|(_, p)| p.max().0).fold(f64::NEG_INFINITY, f64::max);
    let square = square(area);
    let radius = (square.width() / 2.0 - MARGIN).max(10.0);
    let dial = Dial { center: square.center(), radius, rim: rim(greatest), range: chosen.range_db };
    grid(&painter, dial, tokens);
    painter.text(area.min, Align2::LEFT_TOP, name, FontId::proportional(12.0), tokens.text);
    for (run, pattern) in &found {
        curves(&painter, dial, &pattern.cuts()[plane], tokens.series[run.color], chosen.polarization);
    }
    read_out(&painter, dial, &found, plane, response, tokens);
}

fn curves(painter: &Painter, dial: Dial, cut: &Cut, color: Color32, polarization: Polarization) {
    let places =
        |values: &[f64]| -> Vec<Pos2> { cut.psi.iter().zip(values).map(|(&psi, &dbi)| dial.place(psi, dbi)).collect() };
    let stroke = Stroke::new(1.8, color);
    match polarization {
        Polarization::Total => {
            painter.line(places(&cut.total), stroke);
        }
        Polarization::Parts => {
            painter.line(places(&cut.co), stroke);
            painter.extend(Shape::dashed_line(&places(&cut.cross), Stroke::new(1.4, color), 6.0, 4.0));
        }
    }
}

fn grid(painter: &Painter, dial: Dial, tokens: &Tokens) {
    painter.circle(dial.center, dial.radius, tokens.field, Stroke::new(1.2, tokens.weak));
    let thin = Stroke::new(0.8, tokens.grid.gamma_multiply(0.55));
    let font = FontId::proportional(10.0);
    for k in 0_i32..12 {
        let psi = f64::from(30 * k - 180).to_radians();
        painter.line_segment([dial.center, dial.place(psi, dial.rim)], thin);
        let out = dial.center + vec2(psi.sin() as f32, -psi.cos() as f32) * (dial.radius + 10.0);
        let text = format!("{}°", if k == 0 { 180 } else { 30 * k - 180 });
        painter.text(out, Align2::CENTER_CENTER, text, font.clone(), tokens.weak);
    }
    let n_rings = (dial.range / RING).round() as usize;
    for k in 0..n_rings {
        let dbi = dial.rim - RING * k as f64;
        let r = dial.radius * (1.0 - k as f32 / n_rings as f32);
        if k > 0 {
            painter.circle_stroke(dial.center, r, thin);
        }
        let unit = if k == 0 { " dBi" } else { "" };
        // Towards the back, where the curves of most antennas are small.
        let at = dial.place(std::f64::consts::PI, dbi);
        let galley = painter.layout_no_wrap(format!("{dbi:.0}{unit}"), font.clone(), tokens.weak);
        let area = Align2::LEFT_BOTTOM.anchor_size(at + vec2(3.0, -1.0), galley.size());
        painter.rect_filled(area, 2.0, tokens.field.gamma_multiply(0.8));
        painter.galley(area.min, galley, tokens.weak);
    }
}

fn read_out(
    painter: &Painter,
    dial: Dial,
    found: &[(&FinishedRun, &Pattern)],
    plane: usize,
    response: egui::Response,
    tokens: &Tokens,
) {
    let Some(pointer) = response.hover_pos().filter(|p| p.distance(dial.center) < dial.radius + MARGIN) else { return };
    let v = pointer - dial.center;
    let degree = f64::from(v.x.atan2(-v.y)).to_degrees().round();
    let psi = degree.to_radians();
    let ray = [dial.center, dial.place(psi, dial.rim)];
    painter.line_segment(ray, Stroke::new(1.0, tokens.weak));
    // One value per degree, from -180.
    let index = (degree + 180.0).clamp(0.0, 360.0) as usize;
    response.on_hover_ui_at_pointer(|ui| {
        ui.label(format!("{degree:.0}° from broadside"));
        for (run, pattern) in found {
            let cut = &pattern.cuts()[plane];
            let Some(total) = cut.total.get(index) else { continue };
            ui.label(RichText::new(&run.name).color(tokens.series[run.color]).strong());
            ui.label(format!("{total:.2} dBi   co {:.1}   cross {:.1} dBi", cut.co[index], cut.cross[index]));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn broadside_is_up_and_the_middle_is_the_end_of_the_range() {
        let dial = Dial { center: pos2(100.0, 100.0), radius: 50.0, rim: 10.0, range: 30.0 };
        assert_eq!(dial.place(0.0, 10.0), pos2(100.0, 50.0), "the rim, up");
        assert!(dial.place(90_f64.to_radians(), -5.0).distance(pos2(125.0, 100.0)) < 1e-3, "half the range, right");
        assert_eq!(dial.place(1.0, -50.0), pos2(100.0, 100.0), "below the range");
        assert!((rim(7.6) - 10.0).abs() < 1e-12 && (rim(-0.5)).abs() < 1e-12, "the next ring");
    }
}
