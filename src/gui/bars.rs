//! Menus and toolbar.

use super::command::{Command, Facts};
use super::notices::recent_item;
use super::outbox::{Action, Outbox};
use super::selecting::Pick;
use super::ui_state::Heat;
use crate::project::Example;
use crate::render::{Operator, StandardView};
use Command as C;
use egui::{ThemePreference, Ui};
use std::path::PathBuf;

/// A menu: its title, and its commands in groups with a line between them.
pub(super) type Menu = (&'static str, &'static [&'static [Command]]);

/// The menus from left to right. Every command stands in exactly one of them.
pub(super) const MENUS: [Menu; 9] = [
    (
        "File",
        &[
            &[C::New, C::Open, C::Save, C::SaveAs, C::ClearRecent],
            &[C::ImportOutline, C::ImportBodies],
            &[C::Export, C::ExportMesh, C::ExportResults],
            &[C::SavePlot, C::SavePicture, C::Report],
            &[C::Quit],
        ],
    ),
    ("Edit", &[&[C::Undo, C::Redo, C::ShowHistory], &[C::Palette]]),
    (
        "Select",
        &[
            &[C::SelectAll, C::SelectNone, C::Select(Pick::Inverse)],
            &[C::BoxSelect, C::LassoSelect],
            &[
                C::Select(Pick::Station),
                C::Select(Pick::Row),
                C::Select(Pick::Column),
                C::Select(Pick::Top),
                C::Select(Pick::Bottom),
            ],
            &[C::Select(Pick::More), C::Select(Pick::Less)],
        ],
    ),
    (
        "Cage",
        &[
            &[C::Operate(Operator::Move), C::Operate(Operator::Rotate), C::Operate(Operator::Scale)],
            &[C::Proportional, C::Snap, C::Mirror(0), C::Mirror(1)],
            &[C::ResetSelected, C::ResetAll],
            &[C::Play],
        ],
    ),
    ("Antenna", &[&[C::Compensate, C::CompensateNot, C::Compare], &[C::Mesh, C::Solve]]),
    (
        "View",
        &[
            &[C::Fit],
            &[
                C::LookFrom(StandardView::Front),
                C::LookFrom(StandardView::Back),
                C::LookFrom(StandardView::Right),
                C::LookFrom(StandardView::Left),
                C::LookFrom(StandardView::Top),
                C::LookFrom(StandardView::Bottom),
                C::LookFrom(StandardView::Isometric),
                C::Orthographic,
            ],
            &[C::ShowCage, C::SeeThrough, C::ShowGhost, C::ShowMesh, C::ShowPattern],
            &[C::ShowResults, C::ShowLog, C::ShowLeft, C::ShowRight, C::ResetLayout],
            &[C::ZoomIn, C::ZoomOut, C::ZoomReset],
            &[C::NextPanel, C::PreviousPanel],
        ],
    ),
    (
        "Heatmap",
        &[
            &[C::Paint(Heat::None)],
            &[
                C::Paint(Heat::Area),
                C::Paint(Heat::MaxStrain),
                C::Paint(Heat::MinStrain),
                C::Paint(Heat::Thickness),
                C::Paint(Heat::Distance),
            ],
        ],
    ),
    (
        "Theme",
        &[&[C::Theme(ThemePreference::System), C::Theme(ThemePreference::Light), C::Theme(ThemePreference::Dark)]],
    ),
    (
        "Help",
        &[
            &[C::Keys, C::Welcome],
            &[
                C::Example(Example::Flat),
                C::Example(Example::BentH),
                C::Example(Example::BentE),
                C::Example(Example::Saddle),
                C::Example(Example::Twist),
            ],
        ],
    ),
];

/// The title of the menu that a command stands in.
pub(super) fn menu_of(command: Command) -> &'static str {
    let holds = |(_, groups): &&Menu| groups.iter().any(|group| group.contains(&command));
    MENUS.iter().find(holds).map_or("", |(title, _)| title)
}

/// Draws the menus.
pub(super) fn menus(ui: &mut Ui, facts: &Facts, recent: &[PathBuf], out: &mut Outbox) {
    egui::MenuBar::new().ui(ui, |ui| {
        for (title, groups) in MENUS {
            ui.menu_button(title, |ui| {
                for (number, group) in groups.iter().enumerate() {
                    if number > 0 {
                        ui.separator();
                    }
                    for &command in *group {
                        if command == C::ClearRecent {
                            recent_menu(ui, facts, recent, out);
                        } else if command.menu_item(ui, facts) {
                            out.push(Action::Run(command));
                        }
                    }
                }
            });
        }
    });
}

/// The files used last, and the command that forgets them.
fn recent_menu(ui: &mut Ui, facts: &Facts, recent: &[PathBuf], out: &mut Outbox) {
    ui.menu_button("Open recent", |ui| {
        for path in recent {
            if recent_item(ui, path) {
                out.push(Action::AskRecent(path.clone()));
            }
        }
        if !recent.is_empty() {
            ui.separator();
        }
        if C::ClearRecent.menu_item(ui, facts) {
            out.push(Action::Run(C::ClearRecent));
        }
    });
}

/// Draws the buttons below the menus.
pub(super) fn toolbar(ui: &mut Ui, facts: &Facts, out: &mut Outbox) {
    let groups: [&[Command]; 7] = [
        &[C::Open, C::Save, C::Export],
        &[C::Undo, C::Redo],
        &[C::Compensate, C::CompensateNot],
        &[C::Mesh, C::ShowMesh],
        &[C::Solve, C::ShowResults],
        &[C::BoxSelect, C::SelectNone],
        &[C::Fit, C::Orthographic, C::ShowCage],
    ];
    ui.horizontal_wrapped(|ui| {
        for (number, group) in groups.into_iter().enumerate() {
            if number > 0 {
                ui.separator();
            }
            for &command in group {
                if command.tool_button(ui, facts) {
                    out.push(Action::Run(command));
                }
            }
        }
    });
}
