//! Undo and redo by snapshot: a project is small, so every step keeps a whole copy and none needs an inverse.
//!
//! The steps are a tree. A new edit after an undo begins a branch, and what was undone stays where it is and can be gone
//! back to ([`History::go_to`]); redo follows the branch that was on last. A gesture (a drag, a slider) lies between
//! [`History::begin`] and [`History::end`] and is one step however many edits it makes; an edit outside a gesture is a
//! step of its own. "Unsaved changes" compares with the project that was saved last, so undoing back to it is clean
//! again. When there are too many steps, the oldest tips of branches go first, then the beginning.

use super::name::step_name;
use super::{Edit, EditError, Project};
use std::collections::{BTreeMap, BTreeSet};

/// Steps kept; a project takes a few kilobytes (half a megabyte with every vertex of the finest cage moved).
const MAX_STEPS: usize = 400;

/// A project with its past, its future and what might have been.
#[derive(Clone, Debug)]
pub struct History {
    project: Project,
    saved: Project,
    /// All steps by their number, which counts up; the lowest is the root of the tree.
    steps: BTreeMap<u64, Step>,
    /// The step that the project is at, but for the gesture under way.
    current: u64,
    /// The step that was saved.
    saved_at: u64,
    in_gesture: bool,
}

#[derive(Clone, Debug)]
struct Step {
    /// The project after it.
    project: Project,
    name: String,
    parent: Option<u64>,
    /// The child that was on last; `None` at a tip.
    next: Option<u64>,
}

/// Where a step lies, seen from the present one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Undo leads there.
    Behind,
    /// The project is there.
    Here,
    /// Redo leads there.
    Ahead,
    /// On another branch.
    Aside,
}

/// A step as listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry<'a> {
    /// Its number, for [`History::go_to`].
    pub number: u64,
    /// What it did.
    pub name: &'a str,
    /// How many branches it lies off the line that redo follows from the beginning.
    pub depth: usize,
    /// Where it lies.
    pub place: Place,
    /// Whether the project was saved here last.
    pub is_saved: bool,
}

impl History {
    /// Starts a history in which `project` counts as saved.
    #[must_use]
    pub fn new(project: Project) -> Self {
        let root = Step { project: project.clone(), name: "Start".to_owned(), parent: None, next: None };
        let steps = BTreeMap::from([(0, root)]);
        Self { saved: project.clone(), project, steps, current: 0, saved_at: 0, in_gesture: false }
    }

    /// The project as it is now.
    #[must_use]
    pub fn project(&self) -> &Project {
        &self.project
    }

    /// Begins a gesture; one that is under way goes on.
    pub fn begin(&mut self) {
        self.in_gesture = true;
    }

    /// Ends the gesture under way, if any; it becomes one step unless it changed nothing.
    pub fn end(&mut self) {
        if std::mem::take(&mut self.in_gesture) {
            self.push();
        }
    }

    /// Calls off the gesture under way, if any, and restores the project as it was at its start.
    pub fn cancel(&mut self) {
        if std::mem::take(&mut self.in_gesture) {
            self.project.clone_from(&self.steps[&self.current].project);
        }
    }

    /// Applies an edit, as a step of its own unless a gesture is under way.
    ///
    /// # Errors
    /// [`EditError`]; nothing is changed then.
    pub fn apply(&mut self, edit: Edit) -> Result<(), EditError> {
        edit.apply(&mut self.project)?;
        if !self.in_gesture {
            self.push();
        }
        Ok(())
    }

    /// Starts over with another project, which counts as saved: it was opened or is new.
    pub fn replace(&mut self, project: Project) {
        *self = Self::new(project);
    }

    /// Goes one step back; false if there is none. A gesture under way ends first.
    pub fn undo(&mut self) -> bool {
        self.end();
        let parent = self.steps[&self.current].parent;
        parent.is_some_and(|parent| self.go_to(parent))
    }

    /// Goes one step forward again, on the branch that was on last; false if there is none. A gesture under way ends
    /// first.
    pub fn redo(&mut self) -> bool {
        self.end();
        let next = self.steps[&self.current].next;
        next.is_some_and(|next| self.go_to(next))
    }

    /// Goes to a step, on whatever branch; false if there is none of that number. A gesture under way ends first.
    pub fn go_to(&mut self, number: u64) -> bool {
        self.end();
        let Some(step) = self.steps.get(&number) else { return false };
        self.project.clone_from(&step.project);
        self.current = number;
        for child in self.path() {
            if let Some(parent) = self.steps[&child].parent {
                self.step_mut(parent).next = Some(child);
            }
        }
        true
    }

    /// Goes one step back and forgets the step left, as if it had not been; false if there is none, or if others follow.
    pub fn withdraw(&mut self) -> bool {
        self.end();
        let left = self.current;
        if self.steps[&left].next.is_some() || !self.undo() {
            return false;
        }
        self.forget_tip(left);
        true
    }

    /// Whether [`Self::undo`] would do something.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.steps[&self.current].parent.is_some() || self.has_moved()
    }

    /// Whether [`Self::redo`] would do something.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.steps[&self.current].next.is_some() && !self.has_moved()
    }

    /// Notes that the project as it is now has been saved.
    pub fn mark_saved(&mut self) {
        self.saved.clone_from(&self.project);
        self.saved_at = self.current;
    }

    /// Whether the project differs from the one saved last.
    #[must_use]
    pub fn is_dirty(&self) -> bool {
        self.project != self.saved
    }

    /// All steps, oldest first; a branch that was left stands indented after the step that it leaves from.
    #[must_use]
    pub fn entries(&self) -> Vec<Entry<'_>> {
        let mut children: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
        for (&number, step) in &self.steps {
            if let Some(parent) = step.parent {
                children.entry(parent).or_default().push(number);
            }
        }
        let behind = self.path();
        let ahead: BTreeSet<u64> =
            std::iter::successors(self.steps[&self.current].next, |n| self.steps[n].next).collect();
        let place = |number: u64| match number {
            n if n == self.current => Place::Here,
            n if behind.contains(&n) => Place::Behind,
            n if ahead.contains(&n) => Place::Ahead,
            _ => Place::Aside,
        };
        let mut entries = Vec::with_capacity(self.steps.len());
        // Tips of lines still to be listed; the last one is next.
        let mut waiting: Vec<(u64, usize)> = self.steps.keys().next().map(|&root| (root, 0)).into_iter().collect();
        while let Some((number, depth)) = waiting.pop() {
            let step = &self.steps[&number];
            let (name, is_saved) = (step.name.as_str(), number == self.saved_at);
            entries.push(Entry { number, name, depth, place: place(number), is_saved });
            waiting.extend(step.next.map(|next| (next, depth)));
            let others = children.get(&number).into_iter().flatten().filter(|&&c| Some(c) != step.next);
            waiting.extend(others.rev().map(|&child| (child, depth + 1)));
        }
        entries
    }

    /// The steps from the present one to the root.
    fn path(&self) -> BTreeSet<u64> {
        std::iter::successors(Some(self.current), |n| self.steps[n].parent).collect()
    }

    /// Whether the gesture under way has changed something.
    fn has_moved(&self) -> bool {
        self.in_gesture && self.project != self.steps[&self.current].project
    }

    fn step_mut(&mut self, number: u64) -> &mut Step {
        self.steps.get_mut(&number).expect("steps name only steps that are there")
    }

    /// Makes the project a step after the present one, unless nothing has changed.
    fn push(&mut self) {
        let before = &self.steps[&self.current];
        if before.project == self.project {
            return;
        }
        let name = step_name(&before.project, &self.project);
        let number = self.steps.keys().next_back().map_or(0, |last| last + 1);
        let step = Step { project: self.project.clone(), name, parent: Some(self.current), next: None };
        self.steps.insert(number, step);
        let parent = std::mem::replace(&mut self.current, number);
        self.step_mut(parent).next = Some(number);
        while self.steps.len() > MAX_STEPS + 1 {
            self.forget_oldest();
        }
    }

    fn forget_oldest(&mut self) {
        let behind = self.path();
        let tip = self.steps.iter().find(|(n, step)| step.next.is_none() && !behind.contains(n)).map(|(&n, _)| n);
        if let Some(tip) = tip {
            self.forget_tip(tip);
        } else if let Some((_, root)) = self.steps.pop_first()
            && let Some(next) = root.next
        {
            self.step_mut(next).parent = None;
        }
    }

    /// Removes a step that none follows; its parent goes on with its newest other child.
    fn forget_tip(&mut self, tip: u64) {
        let parent = self.steps.remove(&tip).and_then(|step| step.parent);
        if let Some(parent) = parent
            && self.steps[&parent].next == Some(tip)
        {
            let newest = self.steps.iter().rev().find(|(_, step)| step.parent == Some(parent)).map(|(&n, _)| n);
            self.step_mut(parent).next = newest;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl History {
        fn check(&self) {
            assert!(self.steps.len() <= MAX_STEPS + 1, "bounded");
            let root = self.steps.keys().next().expect("never empty");
            for (number, step) in &self.steps {
                assert_eq!(step.parent.is_none(), number == root, "one root, the oldest");
                assert!(step.parent.is_none_or(|p| p < *number), "parents are older");
                let child = |n: &u64| self.steps[n].parent == Some(*number);
                assert!(step.next.as_ref().is_none_or(child), "the next step is a child");
                assert_eq!(step.next.is_none(), !self.steps.keys().any(child), "only tips have none");
            }
            if !self.in_gesture {
                assert_eq!(self.project, self.steps[&self.current].project, "the project is that of its step");
            }
            let entries = self.entries();
            let numbers: BTreeSet<u64> = entries.iter().map(|e| e.number).collect();
            assert_eq!((entries.len(), numbers.len()), (self.steps.len(), self.steps.len()), "each is listed once");
            assert_eq!(entries.iter().filter(|e| e.place == Place::Here).count(), 1, "one is here");
        }
    }

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
                history.check();
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

    #[test]
    fn a_new_edit_after_an_undo_keeps_the_old_branch() {
        let mut history = History::new(Project::default());
        for i in 1..=3 {
            history.apply(lift(3, f64::from(i))).expect("valid");
        }
        let old = history.entries().last().expect("a tip").number;
        assert!(history.undo() && history.undo(), "two steps back");
        history.apply(lift(3, 9.0)).expect("valid");
        history.check();
        assert!(!history.can_redo(), "nothing follows the new step");
        let depths: Vec<(usize, Place)> = history.entries().iter().map(|e| (e.depth, e.place)).collect();
        let expected = [(0, Place::Behind), (0, Place::Behind), (1, Place::Aside), (1, Place::Aside), (0, Place::Here)];
        assert_eq!(depths, expected, "the old branch stands aside");
        assert!(history.go_to(old), "it can be gone to");
        assert_eq!(height_mm(&history), 3, "and holds what it held");
        history.check();
        assert!(history.undo() && history.undo() && history.redo() && history.redo(), "back and forth on that branch");
        assert_eq!(height_mm(&history), 3, "redo follows the branch that was on last");
        assert!(!history.go_to(99), "no such step");
    }

    #[test]
    fn a_withdrawn_step_leaves_no_trace() {
        let mut history = History::new(Project::default());
        history.apply(lift(3, 1.0)).expect("valid");
        history.undo();
        history.apply(lift(3, 2.0)).expect("valid");
        assert!(history.withdraw(), "the last step");
        history.check();
        assert_eq!((history.entries().len(), history.can_redo()), (2, true), "only the branch before it is left");
        assert!(!history.withdraw(), "the beginning stays");
    }

    #[test]
    fn random_trees_stay_sound_and_every_step_keeps_its_project() {
        let mut rng = fastrand::Rng::with_seed(11);
        let mut history = History::new(Project::default());
        let mut seen = BTreeMap::new();
        for _ in 0..1500 {
            match rng.u32(0..10) {
                0..=5 => history.apply(lift(rng.u32(0..242), 1.0 + rng.f64())).expect("valid"),
                6 | 7 => drop(history.undo()),
                8 => drop(history.redo()),
                _ => {
                    let entries = history.entries();
                    let number = entries[rng.usize(0..entries.len())].number;
                    assert!(history.go_to(number), "it is listed");
                }
            }
            let here = history.entries().iter().find(|e| e.place == Place::Here).expect("one is here").number;
            let first = seen.entry(here).or_insert_with(|| history.project().clone());
            assert_eq!(first, history.project(), "the same step, the same project");
        }
        history.check();
        assert_eq!(history.entries().len(), MAX_STEPS + 1, "the test reaches the limit");
    }
}
