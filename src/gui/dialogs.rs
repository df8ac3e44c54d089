//! Dialogs: choose a path, unsaved changes, keys and mouse.
//!
//! A path can always be typed. Where the desktop has a session bus its own file dialog is offered too, on a thread of
//! its own, because it blocks; without a bus that dialog would answer "cancelled" at once.

use super::bodies_dialog::BodiesDialog;
use super::command::{Command, Facts};
use super::draft::Draft;
use super::export_dialog::ExportDialog;
use super::mesh_export::MeshExport;
use super::notices;
use super::outbox::{Action, Outbox};
use super::outline_dialog::OutlineDialog;
use super::palette::Palette;
use super::plot_export::PlotExport;
use super::recovery::Found;
use super::report_export::ReportExport;
use super::result_export::ResultExport;
use super::session::first_project;
use super::theme::Tokens;
use super::ui_state::UiState;
use super::view_export::ViewExport;
use crate::project::Example;
use egui::{Align2, Color32, Context, Id, Key, Modal, RichText, TextEdit, Ui, vec2};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Ending of project files.
pub(super) const ENDING: &str = "json";

/// Distance from the window's edge of a dialog that stands beside the view, points.
const BESIDE: f32 = 8.0;

/// What the chosen path is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Open,
    Save,
    Folder,
    /// A drawing to read an outline from.
    Drawing,
    /// A file to read bodies from.
    Bodies,
    /// A file to write a mesh or a table to.
    Data,
}

/// What to do once the unsaved changes are dealt with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Next {
    New,
    Open,
    File(PathBuf),
    Example(Example),
    Quit,
}

impl Next {
    /// What carries it out, when nothing needs to be asked any more.
    pub(super) fn action(self) -> Action {
        match self {
            Self::New => Action::Start(Box::new(first_project())),
            Self::Open => Action::AskOpen,
            Self::File(path) => Action::OpenPath(path),
            Self::Example(example) => Action::Start(Box::new(example.project())),
            Self::Quit => Action::CloseWindow,
        }
    }
}

/// What a dialog may have to say of the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct About<'a> {
    /// Name of the project.
    pub(super) name: &'a str,
    pub(super) is_dirty: bool,
    pub(super) facts: &'a Facts,
    /// Unsaved work of windows that are gone.
    pub(super) found: &'a [Found],
}

/// The dialog that is open; it stands before everything else.
#[derive(Debug, Default)]
pub(super) enum Dialog {
    #[default]
    None,
    Path(PathDialog),
    Unsaved(Next),
    Outline(Box<OutlineDialog>),
    Bodies(Box<BodiesDialog>),
    Export(Box<ExportDialog>),
    MeshExport(Box<MeshExport>),
    ResultExport(Box<ResultExport>),
    PlotExport(Box<PlotExport>),
    ViewExport(Box<ViewExport>),
    Report(Box<ReportExport>),
    Palette(Palette),
    Keys,
    Welcome,
    /// Unsaved work was found.
    Recovery,
    /// Another program has changed the open file.
    Changed,
    /// Saving would replace what another program wrote; what follows the saving.
    Overwrite(PathBuf, Option<Next>),
}

/// A field to type a path into, and the desktop's own dialog beside it.
#[derive(Debug)]
pub(super) struct PathField {
    pub(super) text: String,
    purpose: Purpose,
    browsing: Option<Receiver<Option<PathBuf>>>,
    focused: bool,
}

impl PathField {
    /// Starts with `text`.
    pub(super) fn new(purpose: Purpose, text: String) -> Self {
        Self { text, purpose, browsing: None, focused: false }
    }

    /// Draws the field; true when Enter was pressed in it.
    pub(super) fn ui(&mut self, ui: &mut Ui, label: &str) -> bool {
        self.collect();
        let label = ui.label(label);
        let mut entered = false;
        ui.horizontal(|ui| {
            let field = TextEdit::singleline(&mut self.text).desired_width(380.0).hint_text("/path/to/…");
            let response = ui.add(field).labelled_by(label.id);
            if !std::mem::replace(&mut self.focused, true) {
                response.request_focus();
            }
            entered = response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            if has_session_bus() {
                let button = ui.add_enabled(self.browsing.is_none(), egui::Button::new("Browse…"));
                if button.on_hover_text("Choose with the dialog of your desktop").clicked() {
                    self.browse(ui.ctx());
                }
            }
        });
        entered
    }

    /// The path, without the blanks around it; `~/` is the home folder.
    pub(super) fn path(&self) -> PathBuf {
        let text = self.text.trim();
        match (text.strip_prefix("~/"), std::env::var_os("HOME")) {
            (Some(rest), Some(home)) => Path::new(&home).join(rest),
            _ => PathBuf::from(text),
        }
    }

    fn browse(&mut self, ctx: &Context) {
        let (sender, receiver) = channel();
        let (purpose, path, ctx) = (self.purpose, self.path(), ctx.clone());
        let work = move || {
            let folder = path.parent().map(Path::to_owned).unwrap_or_default();
            let dialog = rfd::FileDialog::new().set_directory(folder);
            let dialog = match purpose {
                Purpose::Folder | Purpose::Data => dialog,
                Purpose::Drawing => dialog.add_filter("Drawing", &["dxf", "svg", "DXF", "SVG"]),
                Purpose::Bodies => dialog.add_filter("Bodies", &["stl", "obj", "glb", "STL", "OBJ", "GLB"]),
                _ => dialog.add_filter("Conformant project", &[ENDING]),
            };
            let chosen = match purpose {
                Purpose::Open | Purpose::Drawing | Purpose::Bodies => dialog.pick_file(),
                Purpose::Save | Purpose::Data => dialog.save_file(),
                Purpose::Folder => dialog.pick_folder(),
            };
            // The window may be gone by now.
            let _ = sender.send(chosen);
            ctx.request_repaint();
        };
        let started = std::thread::Builder::new().name("file dialog".to_owned()).spawn(work);
        self.browsing = started.is_ok().then_some(receiver);
    }

    fn collect(&mut self) {
        match self.browsing.as_ref().map(Receiver::try_recv) {
            Some(Ok(chosen)) => {
                if let Some(path) = chosen {
                    self.text = path.display().to_string();
                }
                self.browsing = None;
            }
            Some(Err(TryRecvError::Disconnected)) => self.browsing = None,
            Some(Err(TryRecvError::Empty)) | None => {}
        }
    }
}

/// Whether the desktop's own dialogs can be asked.
fn has_session_bus() -> bool {
    let named = std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some_and(|v| !v.is_empty());
    let in_runtime = std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|dir| Path::new(&dir).join("bus").exists());
    cfg!(not(target_os = "linux")) || named || in_runtime
}

/// Asks for the file to open or to save to.
#[derive(Debug)]
pub(super) struct PathDialog {
    field: PathField,
    /// What follows the saving.
    then: Option<Next>,
    overwrite: Option<PathBuf>,
}

impl PathDialog {
    /// Asks for a path, with a suggestion.
    pub(super) fn new(purpose: Purpose, suggestion: &Path, then: Option<Next>) -> Self {
        let text = suggestion.display().to_string();
        Self { field: PathField::new(purpose, text), then, overwrite: None }
    }

    fn ui(&mut self, ui: &mut Ui, out: &mut Outbox) -> bool {
        let saves = self.field.purpose == Purpose::Save;
        ui.heading(if saves { "Save project" } else { "Open project" });
        ui.add_space(6.0);
        let mut go = self.field.ui(ui, if saves { "Save to file" } else { "Project file" });
        let mut path = self.field.path();
        if saves && path.extension().is_none() && path.file_name().is_some() {
            path.set_extension(ENDING);
        }
        let problem = problem_with(&path, saves);
        if let Some(problem) = problem {
            ui.label(RichText::new(problem).weak());
        } else if self.overwrite.as_ref() == Some(&path) {
            let text = "This file exists: press again to replace it.";
            ui.colored_label(Tokens::here(ui).warning, text);
        }
        ui.add_space(8.0);
        let mut close = false;
        ui.horizontal(|ui| {
            let name = if saves { "Save" } else { "Open" };
            go |= ui.add_enabled(problem.is_none(), egui::Button::new(name)).clicked();
            close = ui.button("Cancel").clicked();
        });
        if go && problem.is_none() {
            if saves && path.exists() && self.overwrite.as_ref() != Some(&path) {
                self.overwrite = Some(path);
                return close;
            }
            out.push(if saves { Action::SavePath(path, self.then.clone()) } else { Action::OpenPath(path) });
            return true;
        }
        close
    }
}

/// Why a path cannot be used, to be shown below it.
pub(super) fn problem_with(path: &Path, saves: bool) -> Option<&'static str> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    if path.as_os_str().is_empty() {
        Some("Type the path of a file.")
    } else if path.is_dir() {
        Some("This is a folder: add the name of a file.")
    } else if saves && folder.is_some_and(|f| !f.is_dir()) {
        Some("This folder does not exist.")
    } else if !saves && !path.exists() {
        Some("There is no such file.")
    } else {
        None
    }
}

impl Dialog {
    /// Draws the dialog that is open, if any.
    pub(super) fn ui(&mut self, ctx: &Context, about: About<'_>, state: &mut UiState, out: &mut Outbox) {
        if matches!(self, Self::None) {
            return;
        }
        let frame = egui::Frame::window(&ctx.global_style()).inner_margin(16);
        let id = Id::unique("dialog");
        let mut modal = Modal::new(id).frame(frame);
        if matches!(self, Self::Bodies(_)) {
            // Beside what the view shows of the bodies.
            let area = Modal::default_area(id).anchor(Align2::LEFT_CENTER, vec2(BESIDE, 0.0));
            modal = modal.area(area).backdrop_color(Color32::from_black_alpha(40));
        }
        let modal = modal.show(ctx, |ui| {
            ui.set_width(480.0);
            match self {
                Self::None => true,
                Self::Path(dialog) => dialog.ui(ui, out),
                Self::Unsaved(next) => unsaved(ui, next, about.name, out),
                Self::Outline(dialog) => dialog.ui(ui, state, out),
                Self::Bodies(dialog) => dialog.ui(ui, state, out),
                Self::Export(dialog) => dialog.ui(ui, state),
                Self::MeshExport(dialog) => dialog.ui(ui, state, out),
                Self::ResultExport(dialog) => dialog.ui(ui, state, out),
                Self::PlotExport(dialog) => dialog.ui(ui, state, out),
                Self::ViewExport(dialog) => dialog.ui(ui, state, out),
                Self::Report(dialog) => dialog.ui(ui, state, out),
                Self::Palette(palette) => palette.ui(ui, about.facts, &state.recent_commands, out),
                Self::Keys => keys(ui),
                Self::Welcome => notices::welcome(ui, &state.recent_files, out),
                Self::Recovery => notices::recovery(ui, about.found, out),
                Self::Changed => notices::changed(ui, about.name, about.is_dirty, out),
                Self::Overwrite(path, then) => notices::overwrite(ui, path, then.as_ref(), out),
            }
        });
        // A path dialog that was answered may already have been followed by another dialog.
        if modal.inner || (modal.should_close() && !self.is_working()) {
            if let Self::Bodies(dialog) = self {
                dialog.give_back(state);
            }
            *self = Self::None;
        }
    }

    /// Bodies that are looked at before they are imported.
    pub(super) fn draft(&self) -> Option<&Draft> {
        match self {
            Self::Bodies(dialog) => dialog.draft(),
            _ => None,
        }
    }

    fn is_working(&self) -> bool {
        match self {
            Self::Export(dialog) => dialog.is_working(),
            Self::MeshExport(dialog) => dialog.is_working(),
            Self::ViewExport(dialog) => dialog.is_working(),
            Self::Report(dialog) => dialog.is_working(),
            _ => false,
        }
    }
}

fn unsaved(ui: &mut Ui, next: &Next, name: &str, out: &mut Outbox) -> bool {
    ui.heading("Unsaved changes");
    ui.add_space(6.0);
    ui.label(format!("\"{name}\" has changes that are not saved."));
    ui.add_space(8.0);
    let mut close = false;
    ui.horizontal(|ui| {
        if ui.button("Save").on_hover_text("Save, then go on").clicked() {
            out.push(Action::SaveThen(next.clone()));
            close = true;
        }
        if ui.button("Discard changes").on_hover_text("Go on without saving").clicked() {
            out.push(next.clone().action());
            close = true;
        }
        close |= ui.button("Cancel").on_hover_text("Stay here").clicked();
    });
    close
}

fn keys(ui: &mut Ui) -> bool {
    ui.heading("Keys and mouse");
    ui.add_space(6.0);
    let mouse = [
        ("Drag a cage vertex", "Move it, or all selected ones, in the plane of the screen"),
        ("Drag an arrow, a ring, a knob", "Move, turn or scale the selection along or about an axis"),
        ("Click, Shift+click", "Select a vertex; add or remove one"),
        ("Ctrl+drag (Cmd on a Mac)", "Select by a lasso; Shift adds, Alt takes away"),
        ("Left drag on empty ground", "Turn the view"),
        ("Middle, right or Shift+drag", "Slide the view"),
        ("Wheel, pinch", "Zoom to the pointer"),
        ("While vertices move:", ""),
        ("X, Y, Z", "Bind the motion to an axis; with Shift to the plane across it; again: free"),
        ("Digits . -", "Move by exactly so many mm, degrees or times; Tab: the next axis"),
        ("=", "The number is where the vertex is to be, not how far it goes"),
        ("Ctrl, Shift", "Whole steps (or not, where they are on); a tenth of the speed"),
        ("O, wheel, Page up and down", "Let near vertices follow; their radius"),
        ("G, R, S", "Go on moving, turning or scaling from the same beginning"),
        ("Enter or click; Esc or right click", "Apply; put everything back"),
    ];
    egui::ScrollArea::vertical().max_height(460.0).show(ui, |ui| {
        egui::Grid::new("keys").num_columns(2).striped(true).show(ui, |ui| {
            for (what, does) in mouse {
                ui.label(RichText::new(what).strong());
                ui.label(does);
                ui.end_row();
            }
            for &command in Command::ALL {
                let keys = command.keys(ui.ctx().os());
                let Some(first) = keys.first() else { continue };
                ui.label(RichText::new(ui.ctx().format_shortcut(first)).strong());
                ui.label(command.text_and_tip().1);
                ui.end_row();
            }
        });
    });
    ui.add_space(8.0);
    ui.button("Close").clicked()
}
