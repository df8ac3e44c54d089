//! The user's work is safe: unsaved changes outlive a crash, and no file changed by another program is replaced unasked.

use super::app::App;
use super::dialogs::Dialog;
use super::disk::Change;
use super::outbox::Action;
use super::recovery::Moment;
use super::status::Weight;
use crate::project::{Edit, file};
use std::time::Instant;

impl App {
    /// Keeps unsaved work, and looks at what other programs did to the file.
    pub(super) fn guard(&mut self, ctx: &egui::Context) {
        let moment = Moment {
            now: Instant::now(),
            project: self.session.project(),
            file: self.session.path.as_deref(),
            is_dirty: self.session.history().is_dirty(),
            in_gesture: self.session.in_gesture(),
        };
        let (wait, said) = self.recovery.tick(moment);
        if let Some(wait) = wait {
            ctx.request_repaint_after(wait);
        }
        if let Some(text) = said {
            self.messages.say(Weight::Error, &text);
        }
        let has_focus = ctx.input(|i| i.viewport().focused.unwrap_or(i.focused));
        if std::mem::replace(&mut self.has_focus, has_focus) != has_focus {
            self.disk.set_focus(has_focus);
        }
        match self.disk.poll() {
            Some(Change::Changed) => self.asks_to_reload = true,
            Some(Change::Gone) => {
                let name = self.session.name();
                let text = format!("The file of \"{name}\" was deleted or moved: save to write it again");
                self.messages.say(Weight::Warning, &text);
            }
            None => {}
        }
        // What is not being decided on any more is free for other windows.
        if !matches!(self.dialog, Dialog::Recovery) {
            self.recovery.found.clear();
        }
        // Not over another dialog, and not in the middle of a drag.
        if self.asks_to_reload && matches!(self.dialog, Dialog::None) && !self.session.in_gesture() {
            self.asks_to_reload = false;
            self.dialog = Dialog::Changed;
        }
    }

    /// Takes over what is in the file now, as one step of the history.
    pub(super) fn reload(&mut self) {
        let Some(path) = self.session.path.clone() else { return };
        match file::read(&path) {
            Ok(project) => {
                self.edit("reload", Edit::Restore(Box::new(project)));
                self.session.mark_saved(&path);
                self.disk.note(Some(&path));
                self.messages.say(Weight::Good, &format!("Reloaded {}; Undo brings yours back", path.display()));
            }
            Err(error) => self.messages.say(Weight::Error, &format!("Not reloaded: {error}")),
        }
    }

    /// Opens what a window that is gone has left: its file, and the unsaved changes as one step.
    pub(super) fn recover(&mut self, ctx: &egui::Context, index: usize) {
        self.dialog = Dialog::None;
        if index >= self.recovery.found.len() {
            return;
        }
        let found = self.recovery.found.remove(index);
        let project = match found.project() {
            Ok(project) => project,
            Err(error) => {
                self.messages.say(Weight::Error, &format!("The unsaved changes cannot be read: {error}"));
                return;
            }
        };
        match found.file.as_deref().filter(|path| file::read(path).is_ok()) {
            Some(path) => self.open(path),
            None => self.carry_out(ctx, Action::Start(Box::default())),
        }
        self.edit("recover", Edit::Restore(Box::new(project)));
        let what = if found.file.is_some() { found.name() } else { "the project".to_owned() };
        self.messages.say(Weight::Good, &format!("Recovered {what}: save it to keep it"));
        self.recovery.adopt(found);
    }

    /// Tells of unsaved work that was found, if any was.
    pub(super) fn offer_recovery(&mut self) {
        if !self.recovery.found.is_empty() {
            self.dialog = Dialog::Recovery;
        }
    }

    /// Deletes what a window that is gone has left.
    pub(super) fn discard_found(&mut self, index: usize) {
        if index < self.recovery.found.len()
            && let Err(error) = self.recovery.found.remove(index).discard()
        {
            self.messages.say(Weight::Error, &format!("The unsaved changes cannot be deleted: {error}"));
        }
    }
}
