//! The path of one file to write: its field, its checks, its buttons, and the writing on a thread of its own.

use super::dialogs::{PathField, Purpose, problem_with};
use super::export_dialog::{Outcome, answer, busy, work};
use super::outbox::{Action, Outbox};
use super::status::Weight;
use super::theme::Tokens;
use super::ui_state::UiState;
use egui::{RichText, Ui};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;

/// What the user pressed below a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Pressed {
    Nothing,
    Cancel,
    /// Write this file: it is not there yet, or may be replaced.
    Go(PathBuf),
}

/// The path of one file to write, with its checks: asks a second time before it replaces a file.
#[derive(Debug)]
pub(super) struct FileField {
    field: PathField,
    overwrite: Option<PathBuf>,
    /// Why the last attempt failed.
    pub(super) failed: Option<String>,
    /// What is being written, and where its outcome comes from.
    writing: Option<(PathBuf, Receiver<Outcome>)>,
}

impl FileField {
    /// Suggests a path.
    pub(super) fn new(path: &Path) -> Self {
        let field = PathField::new(Purpose::Data, path.display().to_string());
        Self { field, overwrite: None, failed: None, writing: None }
    }

    /// Whether a thread is at work.
    pub(super) fn is_working(&self) -> bool {
        self.writing.is_some()
    }

    /// Writes a file on a thread of its own; the job returns what is to be said at its end.
    pub(super) fn write(
        &mut self,
        ui: &Ui,
        path: PathBuf,
        job: impl FnOnce(&Path) -> anyhow::Result<Vec<String>> + Send + 'static,
    ) {
        let target = path.clone();
        self.failed = None;
        self.writing = Some((path, work(ui, move || job(&target))));
    }

    /// Shows that a file is being written; `None` if none is, else whether the dialog is to be closed.
    pub(super) fn working(&mut self, ui: &mut Ui, what: &str, state: &mut UiState, out: &mut Outbox) -> Option<bool> {
        let (path, receiver) = self.writing.as_ref()?;
        match answer(receiver) {
            None => busy(ui, what),
            Some(Ok(lines)) => {
                out.push(Action::Say(Weight::Good, lines.join(" ")));
                state.last_folder = path.parent().map(Path::to_owned);
                return Some(true);
            }
            Some(Err(error)) => (self.failed, self.writing) = (Some(error), None),
        }
        Some(false)
    }

    /// Changes the file's name before its ending, unless the user gave it one of their own; and its ending.
    pub(super) fn rename(&mut self, from: &str, to: &str, ending: &str) {
        let path = self.field.path();
        let Some(stem) = path.file_stem().map(|s| s.to_string_lossy().into_owned()) else { return };
        let stem = stem.strip_suffix(from).map_or(stem.clone(), |own| format!("{own}{to}"));
        self.field.text = path.with_file_name(format!("{stem}.{ending}")).display().to_string();
    }

    /// Draws field, warnings and buttons.
    pub(super) fn ui(&mut self, ui: &mut Ui, action: &str) -> Pressed {
        let mut go = self.field.ui(ui, "File");
        let path = self.field.path();
        let problem = problem_with(&path, true);
        let tokens = Tokens::here(ui);
        if let Some(problem) = problem {
            ui.label(RichText::new(problem).weak());
        } else if self.overwrite.as_ref() == Some(&path) {
            ui.colored_label(tokens.warning, "This file exists: press again to replace it.");
        }
        if let Some(failed) = &self.failed {
            ui.add(egui::Label::new(RichText::new(failed).color(tokens.error)).wrap());
        }
        ui.add_space(8.0);
        let mut close = false;
        ui.horizontal(|ui| {
            go |= ui.add_enabled(problem.is_none(), egui::Button::new(action)).clicked();
            close = ui.button("Cancel").clicked();
        });
        if close {
            Pressed::Cancel
        } else if !go || problem.is_some() {
            Pressed::Nothing
        } else if path.exists() && self.overwrite.as_ref() != Some(&path) {
            self.overwrite = Some(path);
            Pressed::Nothing
        } else {
            Pressed::Go(path)
        }
    }
}
