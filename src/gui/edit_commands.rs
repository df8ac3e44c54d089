//! The commands that select cage vertices, move them and show the deformation.

use super::app::App;
use super::command::Command;
use super::edit_ui::Outline;
use super::play::Play;
use crate::cage::Selection;
use crate::project::Edit;

impl App {
    /// Carries out a command of editing; false if it is another one.
    pub(super) fn run_edit(&mut self, command: Command) -> bool {
        let state = &mut self.state;
        match command {
            Command::SelectAll => {
                state.selection = self.session.pose().map_or_else(Selection::new, |p| p.cage.select_all());
            }
            Command::SelectNone => state.selection.clear(),
            Command::Select(pick) => {
                if let Some(pose) = self.session.pose().cloned() {
                    state.selection = pick.applied(&state.selection, &pose, self.session.project());
                }
            }
            Command::BoxSelect => state.editing.toggle_outline(Outline::Box),
            Command::LassoSelect => state.editing.toggle_outline(Outline::Lasso),
            Command::Operate(operator) => self.viewport.begin(operator),
            Command::Proportional => state.editing.is_proportional = !state.editing.is_proportional,
            Command::Snap => state.editing.snaps = !state.editing.snaps,
            Command::Mirror(axis) => state.editing.mirrors[axis] = !state.editing.mirrors[axis],
            Command::ResetSelected => {
                let mirror = state.editing.mirror();
                let all = self.session.pose().map(|p| mirror.with_partners(&p.cage, &state.selection));
                let zero = all.unwrap_or_default().into_iter().map(|v| (v, [0.0; 3])).collect();
                self.edit("hand edits", Edit::MoveVertices(zero));
            }
            Command::Play => {
                let stops = self.session.play().is_on();
                self.session.show(if stops { Play::default() } else { Play::START });
            }
            Command::ResetAll => self.edit("hand edits", Edit::ClearHandEdits),
            _ => return false,
        }
        true
    }
}
