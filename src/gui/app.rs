//! The window: collects replies, draws the panels, carries out what they ask for.

use super::bodies_dialog::BodiesDialog;
use super::command::{Command, Facts};
use super::compare_session::CompareSession;
use super::dialogs::{About, Dialog, Next};
use super::disk::Disk;
use super::edit_ui::Outline;
use super::export_dialog::ExportDialog;
use super::frame::set_scale;
use super::layout::Pane;
use super::mesh_export::MeshExport;
use super::mesh_session::{MeshNews, MeshSession, has_cylinder};
use super::outbox::{Action, Outbox};
use super::outline_dialog::OutlineDialog;
use super::palette::Palette;
use super::recovery::Recovery;
use super::result_export::ResultExport;
use super::session::{News, Session, first_project};
use super::solve_session::{SolveNews, SolveSession};
use super::status::{Messages, Weight};
use super::theme;
use super::ui_state::UiState;
use super::viewport::Viewport;
use super::{APP_ID, paint, palette};
use crate::pipeline::compare_job::CompareJob;
use crate::pipeline::mesh_job::MeshJob;
use crate::pipeline::solve_job::SolveJob;
use crate::pipeline::worker::Worker;
use crate::project::{CompensationMode, Edit, PresetEntry, Settings};
use crate::render::Projection;
use egui::{Rect, Ui, ViewportCommand};
use std::path::{Path, PathBuf};

const STATE_KEY: &str = "window";
/// Said of a command that nothing carries out: a fault of the program that a test looks for.
pub(super) const UNKNOWN: &str = "Nothing carries out this command";

/// The window's application.
#[derive(Debug)]
pub(super) struct App {
    pub(super) session: Session,
    pub(super) mesh: MeshSession,
    pub(super) solve: SolveSession,
    pub(super) compare: CompareSession,
    pub(super) state: UiState,
    pub(super) viewport: Viewport,
    pub(super) dialog: Dialog,
    pub(super) messages: Messages,
    /// Where the panels are, in the order in which a key goes through them.
    pub(super) areas: Vec<Rect>,
    pub(super) recovery: Recovery,
    pub(super) disk: Disk,
    /// Whether the window had the focus in the last frame.
    pub(super) has_focus: bool,
    /// Whether another program has changed the file and the user was not asked yet.
    pub(super) asks_to_reload: bool,
    /// Whether the window may close without asking.
    pub(super) may_close: bool,
    /// The window's title as last set.
    title: String,
}

impl App {
    /// Opens the window on a project file, or on the first project.
    pub(super) fn new(cc: &eframe::CreationContext<'_>, path: Option<&Path>) -> Self {
        theme::install(&cc.egui_ctx);
        if let Some(render) = &cc.wgpu_render_state {
            paint::install(render);
        }
        let mut state: UiState = cc.storage.and_then(|s| eframe::get_value(s, STATE_KEY)).unwrap_or_default();
        state.restore_camera();
        cc.egui_ctx.set_theme(state.theme);
        // The keys are commands of ours, and the size is remembered with the rest.
        cc.egui_ctx.options_mut(|options| options.zoom_with_keyboard = false);
        let scale = state.scale;
        set_scale(&cc.egui_ctx, &mut state, scale);
        let wake = || {
            let ctx = cc.egui_ctx.clone();
            move || ctx.request_repaint()
        };
        let worker = Worker::spawn(wake());
        let mut app = Self {
            session: Session::new(first_project(), None, worker),
            mesh: MeshSession::new(MeshJob::spawn(wake())),
            solve: SolveSession::new(SolveJob::spawn(wake())),
            compare: CompareSession::new(CompareJob::spawn(wake())),
            state,
            viewport: Viewport::default(),
            dialog: Dialog::None,
            messages: Messages::default(),
            areas: Vec::new(),
            recovery: Recovery::new(recovery_folder(cc)),
            disk: Disk::spawn(wake()),
            has_focus: true,
            asks_to_reload: false,
            may_close: false,
            title: String::new(),
        };
        if let Some(path) = path {
            app.open(path);
        } else if cc.storage.is_some() && app.state.recent_files.is_empty() && !app.state.is_welcomed {
            app.state.is_welcomed = true;
            app.dialog = Dialog::Welcome;
        }
        app.offer_recovery();
        app
    }

    fn facts(&self) -> Facts {
        let project = self.session.project();
        let history = self.session.history();
        Facts {
            can_undo: history.can_undo(),
            can_redo: history.can_redo(),
            has_recent: !self.state.recent_files.is_empty(),
            has_selection: !self.state.selection.is_empty(),
            has_hand_edits: !project.hand_edits.is_empty(),
            has_mesh: self.mesh.shown().is_some(),
            shows_mesh: self.state.mesh.shows,
            is_solving: self.solve.is_busy(),
            has_results: !self.solve.runs().is_empty(),
            shows_results: self.state.layout.is_in_front(Pane::Results),
            has_pattern: self.solve.runs().iter().any(|run| !run.result.patterns.is_empty()),
            shows_pattern: self.state.solve.shows_pattern,
            has_bodies: project.bodies.is_some(),
            compensates: project.settings.compensation != CompensationMode::None,
            orthographic: self.state.camera.projection == Projection::Orthographic,
            heat: self.state.heat,
            is_comparing: self.compare.is_busy(),
            has_cylinder: has_cylinder(project),
            shows_ghost: self.state.shows_ghost,
            shows_cage: self.state.shows_cage,
            sees_through: self.state.sees_through,
            shows_log: self.state.layout.is_in_front(Pane::Messages),
            selects_by_box: self.state.editing.outline == Some(Outline::Box),
            selects_by_lasso: self.state.editing.outline == Some(Outline::Lasso),
            snaps: self.state.editing.snaps,
            is_proportional: self.state.editing.is_proportional,
            mirrors: self.state.editing.mirrors,
            can_play: self.session.can_play(),
            is_playing: self.session.play().is_on(),
            shows_history: self.state.layout.is_in_front(Pane::History),
            shows_left: self.state.shows_left,
            shows_right: self.state.shows_right,
            theme: Some(self.state.theme),
        }
    }

    pub(super) fn carry_out(&mut self, ctx: &egui::Context, action: Action) {
        match action {
            Action::Begin => self.session.begin(),
            Action::End => {
                if let Some(news) = self.session.end() {
                    self.tell(news);
                }
            }
            Action::Cancel => self.session.cancel(),
            Action::Edit(place, edit) => self.edit(place, edit),
            Action::GoTo(step) => self.session.go_to(step),
            Action::AddPreset(preset) => {
                let index = self.session.project().presets.len();
                let entry = PresetEntry { enabled: true, preset };
                self.edit("presets", Edit::InsertPreset { index, entry });
            }
            Action::Run(command) => self.run(ctx, command),
            Action::Show(play) => self.session.show(play),
            Action::StopWork => self.session.stop_work(),
            Action::CancelCompare => self.compare.cancel(),
            Action::CancelMesh => self.mesh.cancel(),
            Action::CancelSolve => self.solve.cancel(),
            Action::ResumeSolve => self.solve.resume(),
            Action::ShowRun(serial, shows) => {
                if let Some(run) = self.solve.run_mut(serial) {
                    run.is_shown = shows;
                }
            }
            Action::ColorRun(serial, color) => {
                if let Some(run) = self.solve.run_mut(serial) {
                    run.color = color;
                }
            }
            Action::RemoveRun(serial) => self.solve.remove(serial),
            Action::SavePlot(kind) => self.ask_plot(kind),
            Action::Say(weight, text) => self.messages.say(weight, &text),
            Action::OpenPath(path) => self.open(&path),
            Action::SavePath(path, then) => self.save(ctx, &path, then),
            Action::SaveThen(next) => self.save_then(ctx, Some(next)),
            Action::SaveOver(path, then) => self.save_over(ctx, &path, then),
            Action::AskSave(then) => self.ask_save(then),
            Action::AskRecent(path) => self.ask_unsaved(ctx, Next::File(path)),
            Action::Reload => self.reload(),
            Action::Recover(index) => self.recover(ctx, index),
            Action::DiscardFound(index) => self.discard_found(index),
            Action::AskOpen => self.ask_open(),
            Action::Start(project) => {
                self.session.replace(*project, None);
                self.disk.note(None);
                self.forget_computed();
                self.state.fit = true;
                self.state.selection.clear();
            }
            Action::CloseWindow => {
                self.may_close = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }

    pub(super) fn edit(&mut self, place: &'static str, edit: Edit) {
        self.state.refused = match self.session.apply(edit) {
            Ok(()) => None,
            Err(error) => Some((place, error.to_string())),
        };
    }

    fn run(&mut self, ctx: &egui::Context, command: Command) {
        let state = &mut self.state;
        palette::note(&mut state.recent_commands, command);
        match command {
            Command::New => self.ask_unsaved(ctx, Next::New),
            Command::Open => self.ask_unsaved(ctx, Next::Open),
            Command::Quit => self.ask_unsaved(ctx, Next::Quit),
            Command::Save => self.save_then(ctx, None),
            Command::SaveAs => self.ask_save(None),
            Command::ClearRecent => state.recent_files.clear(),
            Command::Welcome => self.dialog = Dialog::Welcome,
            Command::Example(example) => self.ask_unsaved(ctx, Next::Example(example)),
            Command::ImportOutline => {
                let dialog = OutlineDialog::new(self.session.project(), &self.folder());
                self.dialog = Dialog::Outline(Box::new(dialog));
            }
            Command::ImportBodies => {
                let dialog = BodiesDialog::new(&self.session.project().materials, &self.folder());
                self.dialog = Dialog::Bodies(Box::new(dialog));
            }
            Command::Export => {
                let folder = self.folder().join(format!("{}-export", self.session.name()));
                let finished = self.session.finished();
                let dialog = ExportDialog::new(self.session.project().clone(), finished, &folder);
                self.dialog = Dialog::Export(Box::new(dialog));
            }
            Command::Undo => self.session.undo(),
            Command::Redo => self.session.redo(),
            Command::Compensate => self.compensate(CompensationMode::Isometric),
            Command::CompensateNot => self.compensate(CompensationMode::None),
            Command::Mesh => {
                state.show_pane(Pane::Mesh);
                self.mesh.start(self.session.project(), &state.mesh);
            }
            Command::ExportMesh => {
                if let Some(mesh) = self.mesh.shown() {
                    let is_stale = mesh.is_stale(self.session.project());
                    let dialog = MeshExport::new(mesh, is_stale, &self.folder(), &self.session.name());
                    self.dialog = Dialog::MeshExport(Box::new(dialog));
                }
            }
            Command::ShowMesh => state.show_mesh(!state.mesh.shows),
            Command::Solve => {
                state.show_pane(Pane::Results);
                state.show_pane(Pane::Solve);
                self.solve.start(self.session.project(), &state.solve);
            }
            Command::ShowPattern => {
                state.solve.shows_pattern = !state.solve.shows_pattern;
                state.show_mesh(false);
                state.fit = true;
            }
            Command::ExportResults => {
                if let Some(dialog) = ResultExport::new(&self.solve, &self.folder(), &self.session.name()) {
                    self.dialog = Dialog::ResultExport(Box::new(dialog));
                }
            }
            Command::SavePlot => self.ask_plot(None),
            Command::SavePicture => self.ask_picture(),
            Command::Report => self.ask_report(),
            Command::Compare => self.compare.start(self.session.project()),
            Command::Palette => self.dialog = Dialog::Palette(Palette::default()),
            Command::Keys => self.dialog = Dialog::Keys,
            _ if self.run_edit(command) || self.run_view(ctx, command) => {}
            _ => self.messages.say(Weight::Error, &format!("{UNKNOWN}: \"{}\"", command.text_and_tip().0)),
        }
    }

    /// Forgets what was computed for another project.
    pub(super) fn forget_computed(&mut self) {
        self.solve.clear();
        self.compare.clear();
        self.mesh.clear();
        self.state.forget_mesh();
    }

    /// Shows a little more of the deformation while it is played.
    fn go_on_playing(&mut self, ctx: &egui::Context) {
        let play = self.session.play();
        if play.is_running {
            // A frame that took long, as the first one does, is no reason to jump.
            let seconds = ctx.input(|i| i.stable_dt).min(0.1);
            self.session.show(play.after(f64::from(seconds)));
            ctx.request_repaint();
        }
        (self.state.play, self.state.can_play) = (self.session.play(), self.session.can_play());
    }

    /// Takes what the meshing thread has to say; the first mesh is shown at once.
    fn sync_mesh(&mut self) {
        match self.mesh.sync() {
            None => {}
            Some(MeshNews::Made(text)) => {
                self.state.mesh.chosen = None;
                if let Some(mesh) = self.mesh.shown() {
                    self.state.mesh.keep_within(&mesh.bounds_mm);
                }
                self.state.show_mesh(true);
                self.messages.say(Weight::Good, &text);
            }
            Some(MeshNews::Failed(text)) => self.messages.say(Weight::Error, &format!("No mesh: {text}")),
        }
    }

    /// Takes what the solving thread has to say.
    fn sync_solve(&mut self) {
        match self.solve.sync() {
            None => {}
            Some(SolveNews::Done(text)) => {
                self.messages.say(Weight::Good, &text);
                self.keep_results();
            }
            Some(SolveNews::Failed(text)) => self.messages.say(Weight::Error, &format!("No result: {text}")),
        }
    }

    /// Switches the compensation on or off; one that is on already stays as chosen.
    fn compensate(&mut self, mode: CompensationMode) {
        let settings = self.session.project().settings;
        if mode == CompensationMode::None || settings.compensation == CompensationMode::None {
            self.edit("compensation", Edit::SetSettings(Settings { compensation: mode, ..settings }));
        }
    }

    fn ask_unsaved(&mut self, ctx: &egui::Context, next: Next) {
        if self.session.history().is_dirty() {
            self.dialog = Dialog::Unsaved(next);
        } else {
            self.carry_out(ctx, next.action());
        }
    }

    fn tell(&mut self, news: News) {
        match news {
            News::Refused(message) => self.messages.say(Weight::Error, &format!("Not possible: {message}")),
            News::TakenBack(message) => {
                self.messages.say(Weight::Warning, &format!("Not possible that far, taken back: {message}"));
            }
        }
    }

    /// Asks before a window with unsaved changes closes, and keeps the title true.
    fn watch_window(&mut self, ctx: &egui::Context) {
        let is_dirty = self.session.history().is_dirty();
        if ctx.input(|i| i.viewport().close_requested()) && is_dirty && !self.may_close {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.dialog = Dialog::Unsaved(Next::Quit);
        }
        let title = format!("{}{} - Conformant", self.session.name(), if is_dirty { "*" } else { "" });
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}

/// Where unsaved work is kept: beside what the window remembers, so nowhere if it remembers nothing.
fn recovery_folder(cc: &eframe::CreationContext<'_>) -> Option<PathBuf> {
    cc.storage.and_then(|_| eframe::storage_dir(APP_ID)).map(|folder| folder.join("recovery"))
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.guard(ctx);
    }

    fn on_exit(&mut self) {
        self.recovery.close(self.session.history().is_dirty() && !self.may_close);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        for news in self.session.sync() {
            self.tell(news);
        }
        self.sync_mesh();
        self.sync_solve();
        self.sync_compare();
        self.go_on_playing(&ctx);
        let facts = self.facts();
        let mut out = Outbox::default();
        let is_modal = !matches!(self.dialog, Dialog::None);
        if !is_modal && !self.viewport.is_dragging() {
            out.actions.extend(Command::pressed(&ctx, &facts).into_iter().map(Action::Run));
        }
        let raised = self.panels(ui, &facts, &mut out);
        let about = About {
            name: &self.session.name(),
            is_dirty: self.session.history().is_dirty(),
            facts: &facts,
            found: &self.recovery.found,
        };
        self.dialog.ui(&ctx, about, &mut self.state, &mut out);
        self.messages.show_toasts(&ctx, raised);
        for action in out.actions {
            self.carry_out(&ctx, action);
        }
        self.watch_window(&ctx);
        // Whatever this frame changed goes to the worker at once.
        for news in self.session.sync() {
            self.tell(news);
        }
        // For the progress: rarely while the solver needs the processor.
        let pause =
            match (self.session.is_busy() || self.mesh.is_busy() || self.compare.is_busy(), self.solve.is_busy()) {
                (true, _) => Some(100),
                (false, true) => Some(500),
                (false, false) => None,
            };
        if let Some(pause) = pause {
            ctx.request_repaint_after(std::time::Duration::from_millis(pause));
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.state.keep_camera();
        eframe::set_value(storage, STATE_KEY, &self.state);
    }
}
