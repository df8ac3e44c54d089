//! The status line, and the messages since the program began.

use super::command::Command;
use super::mesh_session::MeshSession;
use super::outbox::{Action, Outbox};
use super::session::Session;
use super::solve_session::SolveSession;
use super::theme::Tokens;
use crate::task::Progress;
use egui::{ProgressBar, RichText, ScrollArea, Ui};
use egui_notify::{Anchor, Toasts};
use std::time::Duration;

/// Messages kept.
const MAX_MESSAGES: usize = 200;
/// Letters of a line of a notification: longer lines would leave the window.
const TOAST_COLUMNS: usize = 60;

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weight {
    Good,
    Warning,
    Error,
}

/// Messages: shown once as a notification, then kept in a list.
pub(super) struct Messages {
    list: Vec<(Weight, String)>,
    toasts: Toasts,
}

impl Default for Messages {
    /// Notifications appear at the lower left, over the status line: there they hide no figures.
    fn default() -> Self {
        let toasts = Toasts::new().with_anchor(Anchor::BottomLeft);
        Self { list: Vec::new(), toasts }
    }
}

impl std::fmt::Debug for Messages {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Messages").field("list", &self.list).finish_non_exhaustive()
    }
}

impl Messages {
    /// Says something: what happened, where, what to try.
    pub(super) fn say(&mut self, weight: Weight, text: &str) {
        let broken = break_lines(text, TOAST_COLUMNS);
        let (toast, seconds) = match weight {
            Weight::Good => (self.toasts.success(broken), 5),
            Weight::Warning => (self.toasts.warning(broken), 8),
            Weight::Error => (self.toasts.error(broken), 12),
        };
        toast.duration(Some(Duration::from_secs(seconds))).closable(true);
        if self.list.len() == MAX_MESSAGES {
            self.list.remove(0);
        }
        self.list.push((weight, text.to_owned()));
    }

    /// Draws the notifications, `raised` points over the status line: above a panel that is there.
    pub(super) fn show_toasts(&mut self, ctx: &egui::Context, raised: f32) {
        let toasts = std::mem::take(&mut self.toasts);
        self.toasts = toasts.with_margin(egui::vec2(8.0, 34.0 + raised));
        self.toasts.show(ctx);
    }

    /// The list, oldest first.
    #[cfg(test)]
    pub(super) fn texts(&self) -> impl DoubleEndedIterator<Item = &str> {
        self.list.iter().map(|(_, text)| text.as_str())
    }

    /// Draws the list.
    pub(super) fn log(&self, ui: &mut Ui) {
        let tokens = Tokens::here(ui);
        ui.horizontal(|ui| {
            let tip = "Copy all messages, for a report";
            let button = ui.add_enabled(!self.list.is_empty(), egui::Button::new("Copy all").small());
            if button.on_hover_text(tip).clicked() {
                let lines: Vec<String> = self.list.iter().map(|(weight, text)| line(*weight, text)).collect();
                ui.ctx().copy_text(lines.join("\n"));
            }
        });
        if self.list.is_empty() {
            ui.label(RichText::new("No messages so far.").weak());
            return;
        }
        ScrollArea::vertical().stick_to_bottom(true).auto_shrink(false).show(ui, |ui| {
            for (weight, text) in &self.list {
                let color = match weight {
                    Weight::Good => tokens.good,
                    Weight::Warning => tokens.warning,
                    Weight::Error => tokens.error,
                };
                ui.label(RichText::new(line(*weight, text)).color(color));
            }
        });
    }
}

/// A message with its weight in words: a colour alone does not reach everybody.
fn line(weight: Weight, text: &str) -> String {
    match weight {
        Weight::Good => text.to_owned(),
        Weight::Warning => format!("Warning: {text}"),
        Weight::Error => format!("Error: {text}"),
    }
}

/// Breaks a text at spaces into lines of at most `columns` letters where its words allow.
fn break_lines(text: &str, columns: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        if !lines[last].is_empty() && lines[last].chars().count() + 1 + word.chars().count() > columns {
            lines.push(word.to_owned());
        } else {
            if !lines[last].is_empty() {
                lines[last].push(' ');
            }
            lines[last].push_str(word);
        }
    }
    lines.join("\n")
}

/// Those whose doings the status line tells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Workers<'a> {
    pub(super) session: &'a Session,
    pub(super) mesh: &'a MeshSession,
    pub(super) solve: &'a SolveSession,
}

/// Draws the status line.
pub(super) fn ui(ui: &mut Ui, workers: Workers<'_>, messages: &Messages, shows_log: bool, out: &mut Outbox) {
    let session = workers.session;
    ui.horizontal(|ui| {
        deformation(ui, session, out);
        if workers.mesh.is_busy() {
            ui.separator();
            busy(ui, "Meshing", workers.mesh.progress(), Action::CancelMesh, out);
        }
        if workers.solve.is_busy() {
            ui.separator();
            busy(ui, "Solving", workers.solve.progress(), Action::CancelSolve, out);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let count = messages.list.len();
            let text = if count == 1 { "1 message".to_owned() } else { format!("{count} messages") };
            if ui.selectable_label(shows_log, text).on_hover_text(Command::ShowLog.text_and_tip().1).clicked() {
                out.push(Action::Run(Command::ShowLog));
            }
            if let Some(shown) = session.shown() {
                let deformed = &shown.deformed;
                ui.separator();
                ui.label(duration(deformed.seconds)).on_hover_text("Time that the last computation took");
                ui.separator();
                let (vertices, triangles) = (deformed.positions.len(), deformed.flat.facets.len());
                let tip = "The deformed surface: a triangle between two parts counts once";
                ui.label(format!("{vertices} vertices, {triangles} triangles")).on_hover_text(tip);
            }
        });
    });
}

/// What the thread that deforms the antenna does.
fn deformation(ui: &mut Ui, session: &Session, out: &mut Outbox) {
    let tokens = Tokens::here(ui);
    let play = session.play();
    if session.is_busy() && !session.in_gesture() && !play.is_on() {
        busy(ui, "Deforming", session.progress(), Action::StopWork, out);
    } else if let Some(message) = session.refusal() {
        let text = RichText::new(format!("⚠ {message}")).color(tokens.error);
        ui.add(egui::Label::new(text).truncate()).on_hover_text(message);
    } else if play.is_on() {
        let text = format!("{:.0} % of the deformation, for looking only", 100.0 * play.amount);
        ui.label(RichText::new(text).color(tokens.warning));
    } else if session.in_gesture() {
        ui.label(RichText::new("Preview: computed in full at the end").color(tokens.weak));
    } else if session.finished().is_some() {
        ui.label(RichText::new("Ready").color(tokens.good));
    } else {
        ui.label(RichText::new("Stopped: change something to compute again").color(tokens.warning));
    }
}

/// What a worker does, how far it is, and a button that stops it; nothing that moves by itself and so costs frames.
fn busy(ui: &mut Ui, name: &str, progress: Option<Progress>, stop: Action, out: &mut Outbox) {
    if let Some(p) = progress.filter(|p| p.total > 0) {
        let bar = ProgressBar::new(p.done as f32 / p.total as f32).desired_width(110.0).desired_height(12.0);
        let response = ui.add(bar);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, name));
    }
    match progress {
        Some(p) => ui.label(format!("{name}: {}…", p.phase)),
        None => ui.label(format!("{name}…")),
    };
    let response = ui.small_button("Stop");
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Stop {}", name.to_lowercase())));
    if response.on_hover_text("Stop this; what is shown stays").clicked() {
        out.push(stop);
    }
}

fn duration(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.0} ms", seconds * 1e3) } else { format!("{seconds:.1} s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_messages_are_broken_between_words() {
        let text = "radius 2.0000 mm turns the cage inside out: choose more than 4.6100 mm";
        let broken = break_lines(text, 30);
        assert!(broken.lines().all(|l| l.len() <= 30), "{broken}");
        assert_eq!(broken.replace('\n', " "), text, "nothing is lost");
        assert_eq!(break_lines("averyveryverylongword", 5), "averyveryverylongword", "words stay whole");
    }
}
