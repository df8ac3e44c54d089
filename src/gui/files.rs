//! The project's file: opened, saved, and the results that are kept beside it.

use super::app::App;
use super::dialogs::{Dialog, Next, PathDialog, Purpose};
use super::status::Weight;
use crate::project::file;
use std::path::{Path, PathBuf};

impl App {
    /// The folder that a dialog begins with.
    pub(super) fn folder(&self) -> PathBuf {
        let own = self.session.path.as_ref().and_then(|p| p.parent().map(Path::to_owned));
        let home = || std::env::var_os("HOME").map(PathBuf::from);
        own.or_else(|| self.state.last_folder.clone()).or_else(home).unwrap_or_default()
    }

    /// Asks for the file to open.
    pub(super) fn ask_open(&mut self) {
        self.dialog = Dialog::Path(PathDialog::new(Purpose::Open, &self.folder().join(""), None));
    }

    /// Asks for the file to save to.
    pub(super) fn ask_save(&mut self, then: Option<Next>) {
        let suggestion = match &self.session.path {
            Some(path) => path.clone(),
            None => self.folder().join("antenna.json"),
        };
        self.dialog = Dialog::Path(PathDialog::new(Purpose::Save, &suggestion, then));
    }

    /// Saves, asking for the file where there is none yet.
    pub(super) fn save_then(&mut self, ctx: &egui::Context, then: Option<Next>) {
        match self.session.path.clone() {
            Some(path) => self.save(ctx, &path, then),
            None => self.ask_save(then),
        }
    }

    /// Writes the project and goes on; asks first where another program has changed the file.
    pub(super) fn save(&mut self, ctx: &egui::Context, path: &Path, then: Option<Next>) {
        if self.disk.has_changed(path) {
            self.dialog = Dialog::Overwrite(path.to_owned(), then);
        } else {
            self.save_over(ctx, path, then);
        }
    }

    /// Writes the project, whatever the file holds, and goes on; says so where that is not possible.
    pub(super) fn save_over(&mut self, ctx: &egui::Context, path: &Path, then: Option<Next>) {
        self.dialog = Dialog::None;
        match file::write(path, self.session.project()) {
            Ok(()) => {
                self.session.mark_saved(path);
                self.note_file(path);
                self.messages.say(Weight::Good, &format!("Saved {}", path.display()));
                self.keep_results();
                if let Some(next) = then {
                    self.carry_out(ctx, next.action());
                }
            }
            Err(error) => self.messages.say(Weight::Error, &error.to_string()),
        }
    }

    /// Opens a project file with the results kept beside it.
    pub(super) fn open(&mut self, path: &Path) {
        self.dialog = Dialog::None;
        match file::read(path) {
            Ok(project) => {
                self.session.replace(project, Some(path.to_owned()));
                self.forget_computed();
                if let Err(error) = self.solve.add_kept(self.session.project(), path) {
                    self.messages.say(Weight::Error, &format!("An earlier result is not shown: {error}"));
                }
                self.note_file(path);
                self.state.selection.clear();
                self.state.fit = true;
            }
            Err(error) => self.messages.say(Weight::Error, &error.to_string()),
        }
    }

    /// Notes that the window and this file now hold the same.
    fn note_file(&mut self, path: &Path) {
        self.disk.note(Some(path));
        self.asks_to_reload = false;
        self.state.last_folder = path.parent().map(Path::to_owned);
        self.state.note_recent(path);
    }

    /// Keeps the results beside the project's file, once it has one.
    pub(super) fn keep_results(&mut self) {
        if let Some(Err(error)) = self.session.path.as_deref().map(|path| self.solve.keep(path)) {
            self.messages.say(Weight::Error, &format!("The results were not kept: {error}"));
        }
    }
}
