//! Which compensation is applied, and how its iterations converge.

use super::field::{Choices, Number, Refused, rows};
use super::outbox::Outbox;
use super::panel_distortion::ROW_HEIGHT;
use super::session::Session;
use super::theme::Tokens;
use crate::distortion::CompensationStep;
use crate::project::{CompensationMode, Edit, ScopeSpec, Settings};
use egui::{Color32, ComboBox, DragValue, Grid, RichText, Ui};
use egui_plot::{AxisHints, Line, Plot, PlotPoints, Points};

/// Errors below this are not drawn: they are far below every tolerance and would squeeze the others together.
const LEAST_DRAWN: f64 = 1e-7;

/// Labels of the axes fade in between these distances, points.
const LABEL_SPACING: egui::Rangef = egui::Rangef { min: 10.0, max: 14.0 };

const MODES: [(CompensationMode, &str, &str); 3] = [
    (CompensationMode::None, "None", "Deform the antenna as drawn"),
    (CompensationMode::Wl, "WL", "Scale the flat antenna until width and length are kept on average, as in the paper"),
    (
        CompensationMode::Isometric,
        "Isometric",
        "Warp the flat antenna until it keeps its lengths everywhere, its radius and its thickness",
    ),
];

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, session: &Session, refused: Refused<'_>, out: &mut Outbox) {
    let settings = session.project().settings;
    let mut new = settings;
    let has_bodies = session.project().bodies.is_some();
    if has_bodies {
        let text = "Imported bodies are deformed as drawn: compensation needs the patch's template.";
        ui.add(egui::Label::new(RichText::new(text).weak()).wrap());
    } else {
        ui.horizontal(|ui| {
            for (mode, text, tip) in MODES {
                ui.selectable_value(&mut new.compensation, mode, text).on_hover_text(tip);
            }
        });
    }
    rows(ui, "compensation", |ui| {
        if settings.compensation == CompensationMode::Wl {
            scope(ui, &mut new);
        }
        if !has_bodies {
            orders(ui, &mut new);
        }
        let tip = "Greatest distance of a straight edge from the smooth surface; at most a third of the thinnest layer";
        let tolerance = Number::new("tolerance", "Split tolerance", "mm", 0.0002).tip(tip);
        tolerance.row(ui, settings.tolerance_mm, refused, out, |v| {
            Edit::SetSettings(Settings { tolerance_mm: v, ..settings })
        });
    });
    if new != settings {
        out.edit("compensation", Edit::SetSettings(new));
    }
    if settings.compensation == CompensationMode::None {
        return;
    }
    let shown = session.shown().filter(|s| s.project.settings.compensation == settings.compensation);
    match shown.map(|s| s.deformed.compensation.as_slice()) {
        Some([]) | None if session.is_busy() => {
            ui.label(RichText::new("Computing…").weak());
        }
        None => {
            ui.label(RichText::new("No result: see the message below the view.").weak());
        }
        Some([]) => {
            ui.label(RichText::new("Nothing to compensate: the antenna is flat.").weak());
        }
        Some(steps) => {
            plot(ui, steps, settings.compensation);
            ui.add_space(4.0);
            table(ui, steps);
        }
    }
}

fn scope(ui: &mut Ui, settings: &mut Settings) {
    let label = ui.label("Scale");
    let text = |scope| if scope == ScopeSpec::Whole { "Whole antenna" } else { "Patch alone" };
    let combo = ComboBox::from_id_salt("scope").selected_text(text(settings.scope)).show_list(ui, |ui| {
        for scope in [ScopeSpec::Whole, ScopeSpec::Patch] {
            ui.selectable_value(&mut settings.scope, scope, text(scope));
        }
    });
    combo.response.labelled_by(label.id).on_hover_text("What is scaled: everything, or the patch and its feed place");
    ui.end_row();
}

fn orders(ui: &mut Ui, settings: &mut Settings) {
    let tip = "Degrees of the polynomials that measure width and length; the paper uses 3 and 3";
    let label = ui.label("Fit orders").on_hover_text(tip);
    ui.horizontal(|ui| {
        for (order, name) in settings.fit_orders.iter_mut().zip(["Fit order along x", "Fit order along y"]) {
            let input = DragValue::new(order).range(1..=9).speed(0.05).update_while_editing(false);
            let response = ui.add(input).labelled_by(label.id);
            response.on_hover_text(format!("{name}. {tip}"));
        }
    });
    ui.end_row();
}

/// One error that a compensation drives to zero.
struct Measure {
    name: &'static str,
    tip: &'static str,
    of: fn(&CompensationStep) -> f64,
    /// Only the isometric compensation works on it.
    isometric_only: bool,
}

const MEASURES: [Measure; 5] = [
    Measure { name: "W", tip: "Error of the width", of: |s| s.width_error, isometric_only: false },
    Measure { name: "L", tip: "Error of the length", of: |s| s.length_error, isometric_only: false },
    Measure {
        name: "h",
        tip: "Error of the substrate's mean thickness",
        of: |s| s.thickness_error,
        isometric_only: true,
    },
    Measure { name: "R", tip: "Error of the fitted radius", of: |s| s.radius_error, isometric_only: true },
    Measure { name: "Strain", tip: "Largest strain of the patch", of: |s| s.patch_strain, isometric_only: false },
];

fn measures(isometric: bool) -> impl Iterator<Item = (usize, &'static Measure)> {
    MEASURES.iter().enumerate().filter(move |(_, m)| isometric || !m.isometric_only)
}

fn table(ui: &mut Ui, steps: &[CompensationStep]) {
    let tokens = Tokens::here(ui);
    let isometric = steps.iter().any(|s| s.thickness_error.abs() > 0.0 || s.radius_error.abs() > 0.0);
    Grid::new("iterations").striped(true).spacing([9.0, 3.0]).min_col_width(16.0).min_row_height(ROW_HEIGHT).show(
        ui,
        |ui| {
            ui.label(RichText::new("No.").color(tokens.weak)).on_hover_text("Iteration: 0 is the antenna as drawn");
            for (index, measure) in measures(isometric) {
                // These are the legend of the plot above, too.
                let heading = RichText::new(format!("• {}", measure.name)).color(colors(tokens)[index]);
                ui.label(heading).on_hover_text(format!("{}, %", measure.tip));
            }
            ui.end_row();
            for (number, step) in steps.iter().enumerate() {
                ui.label(number.to_string());
                for (_, measure) in measures(isometric) {
                    ui.label(signed((measure.of)(step)));
                }
                ui.end_row();
            }
        },
    );
}

/// Colours of the measures, in their order.
fn colors(tokens: &Tokens) -> [Color32; 5] {
    [tokens.axes[0], tokens.axes[1], tokens.warning, tokens.text, tokens.accent]
}

fn whole<'a>(label: &str, axis: AxisHints<'a>) -> AxisHints<'a> {
    axis.label(label).label_spacing(LABEL_SPACING).formatter(|mark, _| format!("{:.0}", mark.value))
}

fn percents<'a>(label: &str, axis: AxisHints<'a>) -> AxisHints<'a> {
    axis.label(label).label_spacing(LABEL_SPACING).formatter(|mark, _| power_of_ten(mark.value))
}

fn plot(ui: &mut Ui, steps: &[CompensationStep], mode: CompensationMode) {
    let colors = colors(Tokens::here(ui));
    let isometric = mode == CompensationMode::Isometric;
    let last = steps.len().saturating_sub(1) as f64;
    let shown = Plot::new("convergence")
        .height(140.0)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .include_x(-0.2)
        .include_x(last.max(1.0) + 0.2)
        .custom_x_axes(vec![whole("Iteration", AxisHints::new_x())])
        .custom_y_axes(vec![percents("Error (%)", AxisHints::new_y())])
        .x_grid_spacer(|input| whole_marks(input.bounds))
        .y_grid_spacer(|input| whole_marks(input.bounds))
        .label_formatter(|_| None)
        .show(ui, |plot| {
            for (index, measure) in measures(isometric) {
                // Exactly zero stands for "not measured in this step", and has no logarithm.
                let measured = steps.iter().map(measure.of).enumerate().filter(|(_, error)| error.abs() > LEAST_DRAWN);
                let points: Vec<[f64; 2]> = measured.map(|(i, e)| [i as f64, (100.0 * e.abs()).log10()]).collect();
                let color = colors[index];
                plot.line(Line::new(measure.name, PlotPoints::from(points.clone())).color(color).width(1.5));
                plot.points(Points::new(measure.name, PlotPoints::from(points)).color(color).radius(2.5));
            }
        });
    let name = "Errors over the iterations";
    shown.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
}

/// A fraction as signed percent without the sign of percent, which stands over the table.
fn signed(fraction: f64) -> String {
    format!("{:+.3}", (1e5 * fraction).round() / 1e3 + 0.0)
}

/// A grid line at every whole number.
fn whole_marks((low, high): (f64, f64)) -> Vec<egui_plot::GridMark> {
    let (low, high) = (low.ceil() as i64, high.floor() as i64);
    let mark = |value: i64| egui_plot::GridMark { value: value as f64, step_size: 1.0 };
    (low..=high.min(low + 100)).map(mark).collect()
}

/// The percentage whose logarithm is given, in as few letters as possible.
fn power_of_ten(logarithm: f64) -> String {
    if (-3.5..=2.5).contains(&logarithm) {
        let digits = (-logarithm).max(0.0).round() as usize;
        format!("{:.digits$}", 10.0_f64.powf(logarithm))
    } else {
        format!("1e{logarithm:.0}")
    }
}
