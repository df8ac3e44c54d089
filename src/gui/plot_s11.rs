//! The plot of S11 over frequency: magnitude in dB with the -10 dB line and its markers, or phase.

use super::outbox::Outbox;
use super::plot_export;
use super::plots::PlotKind;
use super::theme::Tokens;
use super::trace::Trace;
use super::ui_state::Curve;
use crate::units::GHZ;
use egui::{Align2, Color32, RichText, Ui};
use egui_plot::{
    AxisHints, HLine, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, PlotUi, Points, Text, VLine,
};

/// The level that a band is measured at, dB.
const LEVEL: f64 = -10.0;
/// Lowest value that the axis of magnitudes shows at first, dB: deeper notches are rarely built.
const LOWEST: f64 = -30.0;
/// A phase that jumps by more goes around, degrees.
const JUMP: f64 = 180.0;
/// Labels of the axes fade in between these distances, points.
const LABEL_SPACING: egui::Rangef = egui::Rangef { min: 14.0, max: 22.0 };

/// Draws the plot into all the room there is.
pub(super) fn ui(ui: &mut Ui, traces: &[Trace<'_>], curve: Curve, out: &mut Outbox) {
    let tokens = Tokens::here(ui);
    let (name, ends) = match curve {
        Curve::Magnitude => ("|S11| (dB)", [LOWEST, 0.0]),
        Curve::Phase => ("Phase of S11 (°)", [-180.0, 180.0]),
    };
    let freqs = AxisHints::new_x().label("Frequency (GHz)").label_spacing(LABEL_SPACING);
    let values = AxisHints::new_y().label(name).label_spacing(LABEL_SPACING);
    let mut plot = Plot::new(("s11", curve == Curve::Phase))
        .custom_x_axes(vec![freqs])
        .custom_y_axes(vec![values])
        .include_y(ends[0])
        .include_y(ends[1])
        .grid_color(tokens.grid)
        .set_margin_fraction(egui::vec2(0.0, 0.03))
        .allow_scroll(false)
        .label_formatter(|_| None)
        .show_x(false)
        .show_y(false);
    if curve == Curve::Magnitude {
        // Room below the lowest marker for its lettering.
        let depths = traces.iter().filter_map(|t| t.resonance).map(|r| r.depth_db - 3.0);
        plot = plot.include_y(depths.fold(ends[0], f64::min));
    } else {
        plot = plot.y_grid_spacer(|_| (-4..=4).map(every_45).collect());
    }
    let shown = plot.show(ui, |plot| {
        if curve == Curve::Magnitude {
            plot.hline(
                HLine::new("-10 dB", LEVEL).color(tokens.weak).style(LineStyle::dashed_dense()).allow_hover(false),
            );
        }
        for trace in traces {
            line(plot, trace, curve);
        }
        let newest = traces.iter().rposition(|t| !t.is_live);
        for (k, trace) in traces.iter().enumerate().filter(|_| curve == Curve::Magnitude) {
            markers(plot, trace, newest == Some(k), tokens);
        }
        if let Some(at) = plot.pointer_coordinate().filter(|_| plot.response().hovered()) {
            plot.vline(VLine::new("pointer", at.x).color(tokens.weak).allow_hover(false));
        }
    });
    let response = shown.response;
    let kind = if curve == Curve::Phase { PlotKind::Phase } else { PlotKind::Magnitude };
    plot_export::menu(&response, kind, out);
    let what = format!("Plot of {name} over frequency: {} curves", traces.len());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &what));
    let Some(pointer) = response.hover_pos() else { return };
    let freq = shown.transform.value_from_position(pointer).x * GHZ;
    read_out(response, traces, freq);
}

fn every_45(k: i32) -> egui_plot::GridMark {
    egui_plot::GridMark { value: 45.0 * f64::from(k), step_size: if k % 2 == 0 { 90.0 } else { 45.0 } }
}

/// The values of all curves at the pointer's frequency.
fn read_out(response: egui::Response, traces: &[Trace<'_>], freq: f64) {
    let found: Vec<(&Trace<'_>, usize)> = traces.iter().filter_map(|t| Some((t, t.nearest(freq)?))).collect();
    if found.is_empty() {
        return;
    }
    response.on_hover_ui_at_pointer(|ui| {
        for (trace, k) in found {
            ui.label(RichText::new(trace.name).color(trace.color).strong());
            ui.label(trace.reading(k));
        }
        ui.label(RichText::new("Drag: move   Ctrl+wheel: zoom   double click: all").weak().small());
    });
}

fn line<'a>(plot: &mut PlotUi<'a>, trace: &Trace<'a>, curve: Curve) {
    let value = |k: usize| match curve {
        Curve::Magnitude => 20.0 * trace.sweep.s11[k].norm().max(1e-6).log10(),
        Curve::Phase => trace.sweep.s11[k].arg().to_degrees(),
    };
    let points: Vec<[f64; 2]> = (0..trace.sweep.freqs.len()).map(|k| [trace.sweep.freqs[k] / GHZ, value(k)]).collect();
    let style = if trace.is_live { LineStyle::dashed_loose() } else { LineStyle::Solid };
    // In pieces, or a phase would fall through the whole plot where it goes around.
    for piece in points.chunk_by(|a, b| (a[1] - b[1]).abs() < JUMP || curve == Curve::Magnitude) {
        let points = PlotPoints::from(piece.to_vec());
        plot.line(Line::new(trace.name, points).color(trace.color).width(1.8).style(style).allow_hover(false));
    }
}

/// Marks resonance and band; the newest run's are lettered.
fn markers(plot: &mut PlotUi<'_>, trace: &Trace<'_>, is_lettered: bool, tokens: &Tokens) {
    let Some(found) = trace.resonance else { return };
    let mark = |plot: &mut PlotUi<'_>, at: [f64; 2], shape: MarkerShape| {
        let points = Points::new(trace.name, PlotPoints::from(vec![at])).shape(shape).radius(4.5);
        plot.points(points.color(trace.color).filled(true).allow_hover(false));
    };
    let letter = |plot: &mut PlotUi<'_>, at: [f64; 2], anchor: Align2, text: String, color: Color32| {
        let text = RichText::new(text).size(11.5);
        plot.text(Text::new(trace.name, PlotPoint::from(at), text).anchor(anchor).color(color).allow_hover(false));
    };
    let lowest = [found.freq / GHZ, found.depth_db];
    mark(plot, lowest, MarkerShape::Diamond);
    if is_lettered {
        let text = format!("  {:.3} GHz, {:.1} dB", lowest[0], lowest[1]);
        letter(plot, lowest, Align2::LEFT_CENTER, text, tokens.text);
    }
    for (k, end) in found.band.into_iter().flatten().enumerate() {
        let at = [end / GHZ, LEVEL];
        mark(plot, at, if k == 0 { MarkerShape::Right } else { MarkerShape::Left });
        if is_lettered {
            let (anchor, text) = match k {
                0 => (Align2::RIGHT_TOP, format!("{:.3}  ", at[0])),
                _ => (Align2::LEFT_TOP, format!("  {:.3}", at[0])),
            };
            letter(plot, at, anchor, text, tokens.text);
        }
    }
}
