//! Undo and redo by snapshot: a project is small, so every step keeps a whole copy and none needs an inverse.
//!
//! A gesture (a drag, a slider) lies between [`History::begin`] and [`History::end`] and is one step however many
//! edits it makes; an edit outside a gesture is a step of its own. "Unsaved changes" compares with the project that
//! was saved last, so undoing back to it is clean again.

use super::{Edit, EditError, Project};
use std::collections::VecDeque;

/// Steps kept; a project takes a few kilobytes (half a megabyte with every vertex of the finest cage moved).
const MAX_STEPS: usize = 200;

/// A project with its past and its future.
#[derive(Clone, Debug)]
pub struct History {
    project: Project,
    saved: Project,
    /// Earlier projects, oldest first; at most [`MAX_STEPS`].
    past: VecDeque<Project>,
    /// Undone projects, next to redo last.
    future: Vec<Project>,
    /// The project at the start of the gesture under way.
    gesture: Option<Project>,
}

impl History {
    /// Starts a history in which `project` counts as saved.
    #[must_use]
    pub fn new(project: Project) -> Self {
        Self { saved: project.clone(), project, past: VecDeque::new(), future: Vec::new(), gesture: None }
    }

    /// The project as it is now.
    #[must_use]
    pub fn project(&self) -> &Project {
        &self.project
    }

    /// Begins a gesture; one that is under way goes on.
    pub fn begin(&mut self) {
        if self.gesture.is_none() {
            self.gesture = Some(self.project.clone());
        }
    }

    /// Ends the gesture under way, if any; it becomes one step unless it changed nothing.
    pub fn end(&mut self) {
        if let Some(start) = self.gesture.take() {
            self.push(start);
        }
    }

    /// Calls off the gesture under way, if any, and restores the project as it was at its start.
    pub fn cancel(&mut self) {
        if let Some(start) = self.gesture.take() {
            self.project = start;
        }
    }

    /// Applies an edit, as a step of its own unless a gesture is under way.
    ///
    /// # Errors
    /// [`EditError`]; nothing is changed then.
    pub fn apply(&mut self, edit: Edit) -> Result<(), EditError> {
        if self.gesture.is_some() {
            return edit.apply(&mut self.project);
        }
        let before = self.project.clone();
        edit.apply(&mut self.project)?;
        self.push(before);
        Ok(())
    }

    /// Starts over with another project, which counts as saved: it was opened or is new.
    pub fn replace(&mut self, project: Project) {
        *self = Self::new(project);
    }

    /// Goes one step back; false if there is none. A gesture under way ends first.
    pub fn undo(&mut self) -> bool {
        self.end();
        let Some(before) = self.past.pop_back() else { return false };
        self.future.push(std::mem::replace(&mut self.project, before));
        true
    }

    /// Goes one step forward again; false if there is none. A gesture under way ends first.
    pub fn redo(&mut self) -> bool {
        self.end();
        let Some(after) = self.future.pop() else { return false };
        self.past.push_back(std::mem::replace(&mut self.project, after));
        true
    }

    /// Whether [`Self::undo`] would do something.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty() || self.gesture.as_ref().is_some_and(|start| *start != self.project)
    }

    /// Whether [`Self::redo`] would do something.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty() && self.gesture.as_ref().is_none_or(|start| *start == self.project)
    }

    /// Notes that the project as it is now has been saved.
    pub fn mark_saved(&mut self) {
        self.saved.clone_from(&self.project);
    }

    /// Whether the project differs from the one saved last.
    #[must_use]
    pub fn is_dirty(&self) -> bool {
        self.project != self.saved
    }

    fn push(&mut self, before: Project) {
        if before == self.project {
            return;
        }
        self.future.clear();
        if self.past.len() == MAX_STEPS {
            self.past.pop_front();
        }
        self.past.push_back(before);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lift(vertex: u32, z_mm: f64) -> Edit {
        Edit::MoveVertices(vec![(vertex, [0.0, 0.0, z_mm])])
    }

    /// Height of the hand edit of vertex 3, in whole millimetres.
    fn height_mm(history: &History) -> i64 {
        history.project().hand_edits[&3][2].to_string().parse().expect("a whole number")
    }

    #[test]
    fn a_gesture_is_one_step() {
        let mut history = History::new(Project::default());
        history.begin();
        for i in 1..=20 {
            history.apply(lift(3, f64::from(i))).expect("valid");
        }
        history.end();
        assert_eq!(height_mm(&history), 20, "the last edit holds");
        assert!(history.undo() && !history.can_undo(), "one step back is the start");
        assert_eq!(*history.project(), Project::default(), "as before the gesture");
        assert!(history.redo() && !history.redo(), "one step forward is the end");
        assert_eq!(height_mm(&history), 20, "as after the gesture");
    }

    #[test]
    fn a_cancelled_gesture_leaves_no_trace() {
        let mut history = History::new(Project::default());
        history.apply(lift(1, 1.0)).expect("valid");
        assert!(history.undo(), "one step to redo");
        history.begin();
        history.apply(lift(3, 1.0)).expect("valid");
        assert!(!history.can_redo(), "not while the gesture has changed something");
        history.cancel();
        assert_eq!(*history.project(), Project::default(), "as at the start");
        assert!(!history.can_undo() && history.can_redo(), "past and future are untouched");
        history.begin();
        history.end();
        assert!(!history.can_undo() && history.can_redo(), "a gesture that changes nothing is no step");
    }

    #[test]
    fn dirty_means_different_from_what_was_saved() {
        let mut history = History::new(Project::default());
        assert!(!history.is_dirty(), "new");
        history.apply(lift(3, 1.0)).expect("valid");
        assert!(history.is_dirty(), "changed");
        history.mark_saved();
        assert!(!history.is_dirty(), "saved");
        history.undo();
        assert!(history.is_dirty(), "undone past the save");
        history.redo();
        assert!(!history.is_dirty(), "back at the save");
        history.replace(Project::default());
        assert!(!history.is_dirty() && !history.can_undo(), "another project starts over");
    }

    #[test]
    fn a_refused_edit_makes_no_step() {
        let mut history = History::new(Project::default());
        assert!(history.apply(lift(100_000, 1.0)).is_err(), "no such vertex");
        assert!(!history.can_undo() && !history.is_dirty(), "nothing happened");
    }

    #[test]
    fn memory_is_bounded_and_keeps_the_newest_steps() {
        let mut history = History::new(Project::default());
        for i in 1..=MAX_STEPS + 50 {
            history.apply(lift(3, i as f64)).expect("valid");
        }
        let mut steps = 0;
        while history.undo() {
            steps += 1;
        }
        assert_eq!(steps, MAX_STEPS, "bounded");
        assert_eq!(height_mm(&history), 50, "the oldest were dropped");
    }

    #[test]
    fn random_walks_undo_and_redo_to_the_same_projects() {
        let mut rng = fastrand::Rng::with_seed(5);
        for _ in 0..20 {
            let mut history = History::new(Project::default());
            let mut seen = vec![history.project().clone()];
            for _ in 0..rng.usize(1..40) {
                let gesture = rng.bool();
                if gesture {
                    history.begin();
                }
                for _ in 0..if gesture { rng.usize(1..4) } else { 1 } {
                    history.apply(lift(rng.u32(0..242), 1.0 + rng.f64())).expect("valid");
                }
                history.end();
                seen.push(history.project().clone());
            }
            for project in seen.iter().rev().skip(1) {
                assert!(history.undo(), "a step back");
                assert_eq!(history.project(), project, "the same project");
            }
            for project in &seen[1..] {
                assert!(history.redo(), "a step forward");
                assert_eq!(history.project(), project, "the same project");
            }
        }
    }
}
