//! What panels and the viewport ask for: they draw from plain values and change nothing themselves.

use super::command::Command;
use super::dialogs::Next;
use super::play::Play;
use super::plots::PlotKind;
use super::status::Weight;
use crate::project::{Edit, PresetSpec, Project};
use std::path::PathBuf;

/// A wish, carried out after all panels are drawn.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "a few per frame")]
pub(super) enum Action {
    /// A gesture begins: what follows is one undo step.
    Begin,
    /// A change of the project; the place where a refusal is shown.
    Edit(&'static str, Edit),
    /// The gesture ends.
    End,
    /// The gesture is called off.
    Cancel,
    /// Goes to a step of the history, by its number.
    GoTo(u64),
    /// A command.
    Run(Command),
    /// Adds a preset at the end of the stack.
    AddPreset(PresetSpec),
    /// Shows a part of the deformation.
    Show(Play),
    /// Stops the computation under way.
    StopWork,
    /// Calls the comparison off.
    CancelCompare,
    /// Calls the meshing off.
    CancelMesh,
    /// Calls the solver off.
    CancelSolve,
    /// Goes on with the run that was called off.
    ResumeSolve,
    /// Shows or hides the curves of a run, by its number.
    ShowRun(u64, bool),
    /// Gives the curves of a run another colour of the theme.
    ColorRun(u64, usize),
    /// Forgets a run.
    RemoveRun(u64),
    /// Asks where to save a plot; the one on show where none is named.
    SavePlot(Option<PlotKind>),
    /// Tells the user something.
    Say(Weight, String),
    /// Opens a project file.
    OpenPath(PathBuf),
    /// Saves to a project file, and goes on.
    SavePath(PathBuf, Option<Next>),
    /// Replaces the project by another one that has no file yet.
    Start(Box<Project>),
    /// Saves, and goes on with what was asked for.
    SaveThen(Next),
    /// Saves to a file although another program has changed it, and goes on.
    SaveOver(PathBuf, Option<Next>),
    /// Asks for the file to save to, and goes on.
    AskSave(Option<Next>),
    /// Opens a project file, asking about unsaved changes first.
    AskRecent(PathBuf),
    /// Takes over what another program wrote to the open file.
    Reload,
    /// Opens unsaved work that was found, by its place in the list.
    Recover(usize),
    /// Deletes unsaved work that was found, by its place in the list.
    DiscardFound(usize),
    /// Asks for the file to open.
    AskOpen,
    /// Closes the window without asking again.
    CloseWindow,
}

/// The wishes of one frame, in order.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    pub(super) actions: Vec<Action>,
}

impl Outbox {
    /// Adds a wish.
    pub(super) fn push(&mut self, action: Action) {
        self.actions.push(action);
    }

    /// Asks for a change of the project; `place` is the field that shows a refusal.
    pub(super) fn edit(&mut self, place: &'static str, edit: Edit) {
        self.push(Action::Edit(place, edit));
    }

    /// Marks begin and end of a gesture on a widget around the change it asks for.
    pub(super) fn gesture(&mut self, response: &egui::Response, change: Option<(&'static str, Edit)>) {
        if response.drag_started() {
            self.push(Action::Begin);
        }
        if let Some((place, edit)) = change {
            self.edit(place, edit);
        }
        if response.drag_stopped() {
            self.push(Action::End);
        }
    }
}
