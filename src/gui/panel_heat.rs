//! What is painted on the antenna: quantity, part, range, and its histogram.

use super::field::Choices;
use super::heat::{Heated, N_BINS};
use super::outbox::Outbox;
use super::plot_export;
use super::plots::PlotKind;
use super::theme::Tokens;
use super::ui_state::{Heat, HeatPart, UiState};
use crate::render::{colormap, round_length};
use egui::{Color32, ComboBox, DragValue, RichText, Ui};
use egui_plot::{AxisHints, Bar, BarChart, GridMark, Plot};

/// Height of the histogram, points.
const PLOT_HEIGHT: f32 = 110.0;
/// Labels of the axes fade in between these distances, points.
const LABEL_SPACING: egui::Rangef = egui::Rangef { min: 10.0, max: 14.0 };

/// Draws the choices and the histogram.
///
/// * `heated`: what is painted, if anything is.
/// * `has_cylinder`: whether the antenna on show is bent onto an exact cylinder.
pub(super) fn ui(ui: &mut Ui, heated: Option<&Heated>, has_cylinder: bool, state: &mut UiState, out: &mut Outbox) {
    choices(ui, has_cylinder, state);
    let tip = "Draw the exact cylinder through the antenna: what the bend aims at, shifted along z to lie nearest";
    let ghost = egui::Checkbox::new(&mut state.shows_ghost, "Exact cylinder");
    let why_not = "Only a single bend without hand edits has one";
    ui.add_enabled(has_cylinder, ghost).on_hover_text(tip).on_disabled_hover_text(why_not);
    if state.heat == Heat::None {
        return;
    }
    let Some(heated) = heated else {
        ui.label(RichText::new("This quantity is not known of this shape.").weak());
        return;
    };
    range(ui, heated, state);
    histogram(ui, heated, state, out);
}

fn choices(ui: &mut Ui, has_cylinder: bool, state: &mut UiState) {
    ui.horizontal(|ui| {
        let label = ui.label("Paint");
        let combo = ComboBox::from_id_salt("heat").width(132.0).selected_text(state.heat.text()).show_list(ui, |ui| {
            for heat in Heat::ALL {
                let button = egui::Button::selectable(state.heat == heat, heat.text());
                let response = ui.add_enabled(heat != Heat::Distance || has_cylinder, button).on_hover_text(heat.tip());
                if response.on_disabled_hover_text("Only a single bend without hand edits has a cylinder").clicked() {
                    state.paint(heat);
                }
            }
        });
        combo.response.labelled_by(label.id).on_hover_text("What the colours of the antenna show");
        if state.heat == Heat::None {
            return;
        }
        let label = ui.label("on");
        let part = ComboBox::from_id_salt("heat part").width(76.0).selected_text(state.heat_part.text());
        let part = part.show_list(ui, |ui| {
            for part in HeatPart::ALL {
                ui.selectable_value(&mut state.heat_part, part, part.text());
            }
        });
        part.response.labelled_by(label.id).on_hover_text("Which parts are painted, and rule the range");
    });
}

fn range(ui: &mut Ui, heated: &Heated, state: &mut UiState) {
    let unit = state.heat.unit();
    ui.horizontal(|ui| {
        let mut locked = state.heat_ends.is_some();
        let tip = "Keep the ends of the colour bar; without it they follow the greatest value";
        if ui.checkbox(&mut locked, "Fixed range").on_hover_text(tip).changed() {
            // Numbers that read well, to begin with.
            let round = |v: f32| (v * 100.0).round() / 100.0;
            state.heat_ends = locked.then_some(heated.auto.map(round));
        }
        let Some([lo, hi]) = &mut state.heat_ends else { return };
        for (end, name) in [(lo, "Lower end of the range"), (hi, "Upper end of the range")] {
            let response = ui.add(DragValue::new(end).speed(0.02).max_decimals(3).suffix(format!(" {unit}")));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name));
            response.on_hover_text(name);
        }
    });
    if let Some([lo, hi]) = state.heat_ends.filter(|[lo, hi]| hi <= lo) {
        let text =
            format!("The lower end, {lo} {unit}, is not below the upper, {hi} {unit}: the range follows the values.");
        ui.add(egui::Label::new(RichText::new(text).color(Tokens::here(ui).error).small()).wrap());
    }
}

/// Some round marks between two values.
fn marks([lo, hi]: [f64; 2]) -> Vec<GridMark> {
    let step = f64::from(round_length(((hi - lo) / 3.0) as f32));
    let first = (lo / step).ceil();
    (0..=8_u8)
        .map(|k| GridMark { value: step * (first + f64::from(k)), step_size: step })
        .filter(|mark| mark.value <= hi)
        .collect()
}

fn histogram(ui: &mut Ui, heated: &Heated, state: &UiState, out: &mut Outbox) {
    let heat = state.heat;
    let [lo, hi] = state.heat_range(heated.auto);
    let bins = heated.bins([lo, hi]);
    let width = f64::from(hi - lo) / N_BINS as f64;
    let bar = |(k, &percent): (usize, &f64)| {
        let [r, g, b] = colormap::color(heat.map(), (k as f32 + 0.5) / N_BINS as f32);
        let middle = f64::from(lo) + (k as f64 + 0.5) * width;
        Bar::new(middle, percent).width(width).fill(Color32::from_rgb(r, g, b))
    };
    let greatest = bins.iter().copied().fold(0.0, f64::max);
    let bars: Vec<Bar> = bins.iter().enumerate().map(bar).collect();
    let values = AxisHints::new_x().label(heat.axis()).label_spacing(LABEL_SPACING);
    let areas = AxisHints::new_y().label("Area (%)").label_spacing(LABEL_SPACING);
    let plot = Plot::new("painted")
        .height(PLOT_HEIGHT)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .include_x(f64::from(lo))
        .include_x(f64::from(hi))
        .include_y(0.0)
        .x_grid_spacer(move |_| marks([lo, hi].map(f64::from)))
        .y_grid_spacer(move |_| marks([0.0, greatest]))
        .custom_x_axes(vec![values])
        .custom_y_axes(vec![areas])
        .show_x(false)
        .show_y(false)
        .show(ui, |plot| plot.bar_chart(BarChart::new("area", bars)));
    plot.response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Histogram of {}", heat.text().to_lowercase()))
    });
    plot_export::menu(&plot.response, PlotKind::Distortion, out);
    let [mean, least, most] = heated.summary().map(|v| heat.value_text(v));
    let text = RichText::new(format!("Mean {mean}, from {least} to {most}")).small();
    ui.label(text).on_hover_text("Over the area of the painted planes; the thin walls do not count");
    let Some(pointer) = plot.response.hover_pos() else { return };
    let bin = (plot.transform.value_from_position(pointer).x - f64::from(lo)) / width;
    if let Some(percent) = (bin >= 0.0).then(|| bins.get(bin as usize)).flatten() {
        let from = lo + (bin.floor() * width) as f32;
        let [from, to] = [from, from + width as f32].map(|v| heat.value_text(v));
        plot.response.on_hover_text_at_pointer(format!("{from} to {to}: {percent:.1} % of the area"));
    }
}
