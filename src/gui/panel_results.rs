//! The results: reflection with Smith chart, or patterns, and the figures of all runs on show.

use super::command::{Command, Facts};
use super::field::{Choices, symbol_button};
use super::outbox::{Action, Outbox};
use super::solve_session::SolveSession;
use super::theme::Tokens;
use super::trace::traces;
use super::ui_state::{Curve, Polarization, ResultTab, SolveUi};
use super::{plot_s11, polar, readouts, smith};
use crate::project::Project;
use egui::{Align, Button, Color32, ComboBox, Layout, Rect, RichText, ScrollArea, Ui, UiBuilder, pos2, vec2};

/// Room between the parts of the panel, points.
const GAP: f32 = 12.0;
/// Width from which choices, runs and buttons stand in one line, points.
const WIDE: f32 = 900.0;
/// Part of the height for the figures where all lies upon each other.
const TABLE: f32 = 0.26;
/// Greatest part of the room of both plots for the Smith chart, side by side and upon each other.
const SMITH: [f32; 2] = [0.45, 0.53];

/// Draws the panel.
pub(super) fn ui(
    ui: &mut Ui,
    project: &Project,
    solve: &SolveSession,
    facts: &Facts,
    chosen: &mut SolveUi,
    out: &mut Outbox,
) {
    ui.add_space(2.0);
    header(ui, project, solve, facts, chosen, out);
    ui.add_space(2.0);
    let traces = traces(solve, Tokens::here(ui));
    if traces.is_empty() {
        empty(ui, solve, facts, out);
        return;
    }
    let area = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(area);
    let [first, second, table] = places(area, readouts::width(solve.shown().count()), chosen.tab);
    let part = |ui: &mut Ui, rect: Rect, name: &str, content: &mut dyn FnMut(&mut Ui)| {
        content(&mut ui.new_child(UiBuilder::new().id_salt(name).max_rect(rect)));
    };
    match chosen.tab {
        ResultTab::Reflection => {
            part(ui, first, "curves", &mut |ui| plot_s11::ui(ui, &traces, chosen.curve, out));
            part(ui, second, "smith", &mut |ui| smith::ui(ui, &traces, out));
        }
        ResultTab::Pattern => {
            for (k, rect) in [first, second].into_iter().enumerate() {
                part(ui, rect, ["E plane", "H plane"][k], &mut |ui| polar::ui(ui, solve, k, chosen, out));
            }
        }
    }
    part(ui, table, "figures", &mut |ui| {
        ScrollArea::both().auto_shrink(false).show(ui, |ui| readouts::ui(ui, solve, chosen));
    });
}

/// Places of the two plots and of the figures, which are `columns` points wide: side by side, or upon each other where
/// there is more height than width.
fn places(area: Rect, columns: f32, tab: ResultTab) -> [Rect; 3] {
    let is_tall = area.height() > area.width();
    let split = |rect: Rect, last: f32| {
        let (first, second) = if is_tall {
            rect.split_top_bottom_at_y(rect.bottom() - last)
        } else {
            rect.split_left_right_at_x(rect.right() - last)
        };
        let end = if is_tall { first.max - vec2(0.0, GAP) } else { first.max - vec2(GAP, 0.0) };
        (Rect::from_min_max(first.min, end.max(first.min)), second)
    };
    let table = if is_tall { TABLE * area.height() } else { columns.min(0.36 * area.width()) };
    let (plots, table) = split(area, table);
    let (along, across) = if is_tall { (plots.height(), plots.width()) } else { (plots.width(), plots.height()) };
    let last = match tab {
        ResultTab::Reflection => across.min(SMITH[usize::from(is_tall)] * along),
        ResultTab::Pattern => (along - GAP) / 2.0,
    };
    let (first, second) = split(plots, last);
    [first, second, table]
}

fn header(ui: &mut Ui, project: &Project, solve: &SolveSession, facts: &Facts, chosen: &mut SolveUi, out: &mut Outbox) {
    let is_wide = ui.available_width() > WIDE;
    if is_wide {
        ui.horizontal(|ui| {
            tabs(ui, chosen);
            ui.separator();
            choices(ui, solve, chosen);
            around(ui, facts, chosen, out);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                close(ui, out);
                exports(ui, facts, out);
                ui.separator();
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| legend(ui, project, solve, out));
            });
        });
    } else {
        ui.horizontal(|ui| {
            tabs(ui, chosen);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| close(ui, out));
        });
        ui.horizontal_wrapped(|ui| {
            around(ui, facts, chosen, out);
            exports(ui, facts, out);
        });
        ui.horizontal_wrapped(|ui| choices(ui, solve, chosen));
        legend(ui, project, solve, out);
    }
}

fn tabs(ui: &mut Ui, chosen: &mut SolveUi) {
    let tip = "S11 over frequency and in the Smith chart";
    ui.selectable_value(&mut chosen.tab, ResultTab::Reflection, "Reflection").on_hover_text(tip);
    ui.selectable_value(&mut chosen.tab, ResultTab::Pattern, "Pattern").on_hover_text("The far field");
}

/// How it is shown.
fn choices(ui: &mut Ui, solve: &SolveSession, chosen: &mut SolveUi) {
    match chosen.tab {
        ResultTab::Reflection => {
            let tip = "Magnitude of S11 in decibels";
            ui.selectable_value(&mut chosen.curve, Curve::Magnitude, "Magnitude").on_hover_text(tip);
            let tip = "Phase of S11 in degrees, at the ground's top";
            ui.selectable_value(&mut chosen.curve, Curve::Phase, "Phase").on_hover_text(tip);
        }
        ResultTab::Pattern => pattern_choices(ui, solve, chosen),
    }
}

/// Whether the pattern is drawn around the antenna.
fn around(ui: &mut Ui, facts: &Facts, chosen: &SolveUi, out: &mut Outbox) {
    if chosen.tab == ResultTab::Pattern && Command::ShowPattern.tool_button(ui, facts) {
        out.push(Action::Run(Command::ShowPattern));
    }
}

fn exports(ui: &mut Ui, facts: &Facts, out: &mut Outbox) {
    for command in [Command::ExportResults, Command::SavePlot] {
        if command.tool_button(ui, facts) {
            out.push(Action::Run(command));
        }
    }
}

fn close(ui: &mut Ui, out: &mut Outbox) {
    if symbol_button(ui, "✖", "Close the results", true) {
        out.push(Action::Run(Command::ShowResults));
    }
}

/// The runs in a line.
fn legend(ui: &mut Ui, project: &Project, solve: &SolveSession, out: &mut Outbox) {
    ScrollArea::horizontal().id_salt("legend").show(ui, |ui| {
        ui.horizontal(|ui| {
            for run in solve.runs() {
                entry(ui, project, run, out);
            }
            if solve.live().is_some_and(|run| run.sweep.is_some()) {
                let color = Tokens::here(ui).series[solve.next_color()];
                ui.label(RichText::new("--- under way").color(color));
            }
        });
    });
}

fn pattern_choices(ui: &mut Ui, solve: &SolveSession, chosen: &mut SolveUi) {
    let freqs = polar::frequencies(solve);
    let freq = polar::frequency(solve, chosen);
    ui.add_enabled_ui(!freqs.is_empty(), |ui| {
        let label = ui.label("At");
        let text = freq.map_or("no frequency".to_owned(), polar::freq_text);
        let combo = ComboBox::from_id_salt("pattern frequency").width(96.0).selected_text(text).show_list(ui, |ui| {
            for f in freqs {
                ui.selectable_value(&mut chosen.pattern_freq, Some(f), polar::freq_text(f));
            }
        });
        combo.response.labelled_by(label.id).on_hover_text("Frequency of the patterns");
        let tip = "Both polarizations together";
        ui.selectable_value(&mut chosen.polarization, Polarization::Total, "Total").on_hover_text(tip);
        let tip = "Co-polarization (along the patch's resonant length), and cross-polarization dashed";
        ui.selectable_value(&mut chosen.polarization, Polarization::Parts, "Co and cross").on_hover_text(tip);
        for range in [30.0, 40.0] {
            let tip = "Decibels from the rim to the middle";
            ui.selectable_value(&mut chosen.range_db, range, format!("{range:.0} dB")).on_hover_text(tip);
        }
    });
}

fn empty(ui: &mut Ui, solve: &SolveSession, facts: &Facts, out: &mut Outbox) {
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() / 2.0 - 30.0).max(4.0));
        if solve.is_busy() {
            ui.label(RichText::new("The first curve appears when the pulse is over…").weak());
        } else if solve.runs().is_empty() {
            ui.label(RichText::new("No results yet.").weak());
            if Command::Solve.tool_button(ui, facts) {
                out.push(Action::Run(Command::Solve));
            }
        } else {
            ui.label(RichText::new("All runs are hidden: tick one above.").weak());
        }
    });
}

/// The runs in a list, for the launcher.
pub(super) fn run_list(ui: &mut Ui, project: &Project, solve: &SolveSession, out: &mut Outbox) {
    for run in solve.runs() {
        ui.horizontal(|ui| entry(ui, project, run, out));
    }
}

/// One run: its colour, whether it is shown, and a button to forget it.
fn entry(ui: &mut Ui, project: &Project, run: &super::solve_session::FinishedRun, out: &mut Outbox) {
    ui.spacing_mut().item_spacing.x = 4.0;
    let tokens = Tokens::here(ui);
    let swatch = Button::new("").fill(tokens.series[run.color]).min_size(vec2(14.0, 14.0)).small();
    let menu = egui::containers::menu::MenuButton::from_button(swatch);
    let (response, _) = menu.ui(ui, |ui| {
        ui.horizontal(|ui| {
            for (k, color) in tokens.series.into_iter().enumerate() {
                if swatch_button(ui, color, k) {
                    out.push(Action::ColorRun(run.serial, k));
                    ui.close();
                }
            }
        });
    });
    let name = format!("Colour of {}", run.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    response.on_hover_text(name);
    let is_stale = run.is_stale(project);
    let text = if is_stale { format!("⚠ {}", run.name) } else { run.name.clone() };
    let mut is_shown = run.is_shown;
    let tip = if is_stale { "Show it; the geometry has changed since this run" } else { "Show its curves and figures" };
    if ui.checkbox(&mut is_shown, text).on_hover_text(tip).changed() {
        out.push(Action::ShowRun(run.serial, is_shown));
    }
    if symbol_button(ui, "✖", &format!("Remove {}", run.name), true) {
        out.push(Action::RemoveRun(run.serial));
    }
    ui.add_space(8.0);
}

fn swatch_button(ui: &mut Ui, color: Color32, k: usize) -> bool {
    let response = ui.add(Button::new("").fill(color).min_size(vec2(18.0, 18.0)).small());
    let name = format!("Colour {}", k + 1);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    response.on_hover_text(name).clicked()
}

/// A square as large as fits into the middle of an area, moved to its top.
pub(super) fn square(area: Rect) -> Rect {
    let side = area.size().min_elem();
    Rect::from_min_size(pos2(area.center().x - side / 2.0, area.top()), vec2(side, side))
}
