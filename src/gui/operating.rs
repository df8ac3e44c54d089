//! An operator at work on the selected vertices: pointer and keys in, edits of the project out.
//!
//! It begins with a key (the pointer then drives it until a click or Enter) or with a drag of a vertex or of the gizmo (it
//! ends when the button comes up). Everything is measured from the cage as it was at the beginning; the edits lie
//! between `Begin` and `End` or `Cancel`, so that an operator is one undo step or none. What an operator does to a
//! place is [`crate::render::operator`]'s; the partners of mirrored vertices are [`crate::cage::mirror`]'s.

use super::edit_ui::EditUi;
use super::hand_edits::{Offsets, displaced};
use super::outbox::{Action, Outbox};
use super::session::Pose;
use crate::cage::{Cage, Mirror, Selection, Share};
use crate::geometry::DVec3;
use crate::project::{Edit, Project};
use crate::render::operator::{Stage, weights};
use crate::render::{Bound, Change, Operator, Typed, Vec2, Vec3, View};
use crate::units::to_mm;
use egui::{Event, Key, Modifiers, PointerButton, Ui};
use std::sync::Arc;

/// The radius of proportional editing changes by this factor with a page key, and per point scrolled.
const RADIUS_PER_PAGE: f64 = 1.1;
const RADIUS_PER_POINT: f64 = 0.002;
/// Part of the pointer's way that counts while Shift is down.
const FINE: f32 = 0.1;

/// How an operator went on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Running,
    Applied,
    GivenUp,
}

/// An operator at work.
#[derive(Clone, Debug)]
pub(super) struct Operating {
    pub(super) operator: Operator,
    pub(super) bound: Bound,
    pub(super) typed: Typed,
    /// Whether it ends when the button comes up.
    pub(super) is_held: bool,
    /// Middle of the selection, mm.
    pub(super) pivot: DVec3,
    /// What it does at present.
    pub(super) change: Option<Change>,
    /// What stays under the pointer in a move, mm.
    grabbed: Vec3,
    /// The pointer at the beginning and now (slowed down while Shift is held), points, and its turns about the pivot.
    from: Vec2,
    at: Vec2,
    pointer: Vec2,
    turned: f64,
    /// Whether Shift came up since the beginning: at a drag's beginning it means something else.
    shift_is_free: bool,
    cage: Arc<Cage>,
    mirror: Mirror,
    /// Places of all handles at the beginning, mm.
    places: Vec<DVec3>,
    selection: Selection,
    start: Offsets,
    /// What was asked for last.
    asked: Offsets,
}

impl Operating {
    /// Begins on the selected vertices, at a place of the pointer; `None` if there are none.
    pub(super) fn begin(
        operator: Operator,
        (pose, project): (&Pose, &Project),
        selection: &Selection,
        mirror: Mirror,
        at: Vec2,
        out: &mut Outbox,
    ) -> Option<Self> {
        let handles = &pose.vertices[..pose.cage.n_handles().min(pose.vertices.len())];
        let places: Vec<DVec3> = handles.iter().map(|p| *p * to_mm(1.0)).collect();
        let chosen: Vec<DVec3> = selection.iter().filter_map(|&v| places.get(v as usize).copied()).collect();
        if chosen.is_empty() {
            return None;
        }
        let pivot = chosen.iter().sum::<DVec3>() / chosen.len() as f64;
        out.push(Action::Begin);
        Some(Self {
            operator,
            bound: Bound::Free,
            typed: Typed::default(),
            is_held: false,
            pivot,
            change: None,
            grabbed: pivot.as_vec3(),
            from: at,
            at,
            pointer: at,
            turned: 0.0,
            shift_is_free: false,
            cage: Arc::clone(&pose.cage),
            mirror,
            places,
            selection: selection.clone(),
            start: project.hand_edits.clone(),
            asked: Offsets::new(),
        })
    }

    /// As begun by a drag of something at `grabbed` (mm).
    pub(super) fn held(mut self, grabbed: Vec3, bound: Bound) -> Self {
        (self.is_held, self.grabbed, self.bound) = (true, grabbed, bound);
        self
    }

    /// Whether typed numbers may be the target itself: one vertex has one.
    pub(super) fn may_be_absolute(&self) -> bool {
        self.operator == Operator::Move && self.selection.len() == 1
    }

    /// Goes on by one frame.
    pub(super) fn go_on(
        &mut self,
        ui: &Ui,
        view: &View,
        pointer: Option<Vec2>,
        editing: &mut EditUi,
        out: &mut Outbox,
    ) -> Outcome {
        let outcome = self.keys(ui, editing).max_with(self.buttons(ui));
        if outcome == Outcome::GivenUp {
            out.push(Action::Cancel);
            return outcome;
        }
        let modifiers = ui.input(|i| i.modifiers);
        if let Some(pointer) = pointer {
            self.follow(view, pointer, modifiers);
        }
        if editing.is_proportional {
            let scrolled = f64::from(ui.input(|i| i.smooth_scroll_delta().y));
            editing.scale_radius((-RADIUS_PER_POINT * scrolled).exp());
        }
        if let Some(change) = self.present(view, editing, modifiers) {
            self.change = Some(change);
            self.ask(change, editing, out);
        }
        if outcome == Outcome::Applied {
            out.push(Action::End);
        }
        outcome
    }

    /// Takes all keys of this frame: while an operator runs they mean nothing else.
    fn keys(&mut self, ui: &Ui, editing: &mut EditUi) -> Outcome {
        let is_key = |e: &Event| matches!(e, Event::Key { .. } | Event::Text(_));
        let events: Vec<Event> = ui.input_mut(|i| {
            let (keys, others) = std::mem::take(&mut i.events).into_iter().partition(is_key);
            i.events = others;
            keys
        });
        let mut outcome = Outcome::Running;
        for event in events {
            match event {
                Event::Text(text) => text.chars().for_each(|letter| self.letter(letter)),
                Event::Key { key, pressed: true, modifiers, .. } => {
                    outcome = outcome.max_with(self.key(key, modifiers, editing));
                }
                _ => {}
            }
        }
        outcome
    }

    fn letter(&mut self, letter: char) {
        if letter != '=' || self.may_be_absolute() {
            self.typed.push(letter);
        }
    }

    fn key(&mut self, key: Key, modifiers: Modifiers, editing: &mut EditUi) -> Outcome {
        let mut bind = |axis| self.bound = self.bound.pressed(axis, modifiers.shift);
        match key {
            Key::X => bind(0),
            Key::Y => bind(1),
            Key::Z => bind(2),
            Key::G => self.switch(Operator::Move),
            Key::R => self.switch(Operator::Rotate),
            Key::S => self.switch(Operator::Scale),
            Key::O => editing.is_proportional = !editing.is_proportional,
            Key::PageUp => editing.scale_radius(RADIUS_PER_PAGE),
            Key::PageDown => editing.scale_radius(1.0 / RADIUS_PER_PAGE),
            Key::Tab => self.typed.next_field(Stage::n_numbers(self.operator, self.bound)),
            Key::Backspace => {
                self.typed.back();
            }
            Key::Enter => return Outcome::Applied,
            Key::Escape => return Outcome::GivenUp,
            _ => {}
        }
        Outcome::Running
    }

    fn buttons(&self, ui: &Ui) -> Outcome {
        let (primary, secondary, is_down) = ui.input(|i| {
            let pressed = |button| i.pointer.button_pressed(button);
            (pressed(PointerButton::Primary), pressed(PointerButton::Secondary), i.pointer.primary_down())
        });
        match self.is_held {
            _ if secondary => Outcome::GivenUp,
            true if !is_down => Outcome::Applied,
            false if primary => Outcome::Applied,
            _ => Outcome::Running,
        }
    }

    /// Does something else from now on, from the same beginning.
    fn switch(&mut self, operator: Operator) {
        if self.operator != operator {
            self.operator = operator;
            self.typed.clear();
            (self.from, self.turned) = (self.at, 0.0);
        }
    }

    fn follow(&mut self, view: &View, pointer: Vec2, modifiers: Modifiers) {
        self.shift_is_free |= !modifiers.shift;
        let pace = if modifiers.shift && self.shift_is_free { FINE } else { 1.0 };
        let before = self.at;
        self.at += pace * (pointer - self.pointer);
        self.pointer = pointer;
        let stage = Stage { view, pivot: self.pivot };
        self.turned += match self.bound {
            // A ring follows the pointer.
            Bound::Axis(axis) if self.is_held => stage.turn_about(axis, before, self.at),
            _ => stage.turn(before, self.at),
        };
    }

    /// What pointer and numbers ask for now; `None` keeps what it was.
    fn present(&self, view: &View, editing: &EditUi, modifiers: Modifiers) -> Option<Change> {
        let stage = Stage { view, pivot: self.pivot };
        if !self.typed.is_empty() {
            let target = self.selection.first().filter(|_| self.typed.is_absolute && self.may_be_absolute());
            let place = target.and_then(|&v| self.places.get(v as usize).copied());
            return Some(stage.typed(self.operator, self.bound, self.typed.numbers(), place).unwrap_or(STILL));
        }
        let change = stage.pointed(self.operator, self.bound, self.grabbed, [self.from, self.at], self.turned)?;
        Some(if editing.snaps == modifiers.command { change } else { change.snapped(editing.steps()) })
    }

    /// Asks for the offsets that a change leads to, if they are others than before.
    fn ask(&mut self, change: Change, editing: &EditUi, out: &mut Outbox) {
        let is_selected = |i: usize| u32::try_from(i).is_ok_and(|v| self.selection.contains(&v));
        let shares = weights(&self.places, is_selected, editing.radius()).into_iter().filter_map(|(i, weight)| {
            let by = change.displacement(self.pivot, self.places[i], weight);
            u32::try_from(i).ok().filter(|_| by.is_finite()).map(|vertex| Share { vertex, weight, by })
        });
        let shares = self.mirror.applied(&self.cage, shares.collect());
        // Vertices that a smaller radius leaves behind go back to where they were.
        let mut offsets: Offsets =
            self.asked.keys().map(|v| (*v, self.start.get(v).copied().unwrap_or_default())).collect();
        offsets.extend(displaced(&self.start, &shares));
        let is_first = self.asked.is_empty();
        let bits = |offset: [f64; 3]| offset.map(f64::to_bits);
        let is_still =
            |(v, offset): (&u32, &[f64; 3])| bits(self.start.get(v).copied().unwrap_or_default()) == bits(*offset);
        if offsets != self.asked && !(is_first && offsets.iter().all(is_still)) {
            out.edit("hand edits", Edit::MoveVertices(offsets.iter().map(|(v, o)| (*v, *o)).collect()));
            self.asked = offsets;
        }
    }

    /// What it does, in words and numbers.
    pub(super) fn text(&self, editing: &EditUi) -> String {
        let mut text = match self.operator {
            Operator::Move => "Move",
            Operator::Rotate => "Rotate",
            Operator::Scale => "Scale",
        }
        .to_owned();
        text += &match (self.operator, self.bound) {
            (_, Bound::Free) => String::new(),
            (Operator::Rotate, Bound::Axis(a) | Bound::Plane(a)) => format!(" about {}", NAMES[a]),
            (_, Bound::Axis(a)) => format!(" along {}", NAMES[a]),
            (_, Bound::Plane(a)) => format!(" in the plane {}", ["y z", "x z", "x y"][a]),
        };
        text += &format!(": {}", self.amount());
        if let Some(radius) = editing.radius() {
            text += &format!("   radius {radius:.2} mm");
        }
        if editing.snaps {
            text += &match self.operator {
                Operator::Move => format!("   steps of {} mm", editing.step_mm),
                Operator::Rotate => format!("   steps of {}°", editing.step_deg),
                Operator::Scale => "   steps of 0.1".to_owned(),
            };
        }
        let mirrored: Vec<&str> = (0..2).filter(|&a| self.mirror.axes[a]).map(|a| NAMES[a]).collect();
        if !mirrored.is_empty() {
            text += &format!("   mirrored in {}", mirrored.join(" and "));
        }
        text
    }

    fn amount(&self) -> String {
        let unit = match self.operator {
            Operator::Move => " mm",
            Operator::Rotate => "°",
            Operator::Scale => "",
        };
        if !self.typed.is_empty() || self.typed.is_absolute {
            let target = if self.typed.is_absolute { "to " } else { "" };
            return format!("{target}{}{unit}", self.typed.text(1));
        }
        let parts = |v: DVec3, show: &dyn Fn(f64) -> String| {
            let part = |a: usize| format!("{} {}", NAMES[a], show(v[a] + 0.0));
            self.bound.axes().into_iter().map(part).collect::<Vec<_>>().join("  ")
        };
        match self.change {
            None => format!("0{unit}"),
            Some(Change::Move(by)) => parts(by, &|v| format!("{v:+.3}")) + unit,
            Some(Change::Rotate { angle, .. }) => format!("{:+.2}°", angle.to_degrees() + 0.0),
            Some(Change::Scale(f)) if self.bound == Bound::Free => format!("{:.3}", f.x),
            Some(Change::Scale(factors)) => parts(factors, &|v| format!("{v:.3}")),
        }
    }
}

/// Names of the axes.
const NAMES: [&str; 3] = ["x", "y", "z"];
/// No change at all.
const STILL: Change = Change::Move(DVec3::ZERO);

impl Outcome {
    /// The one that ends, if one does; giving up wins.
    fn max_with(self, other: Self) -> Self {
        match (self, other) {
            (Self::GivenUp, _) | (_, Self::GivenUp) => Self::GivenUp,
            (Self::Applied, _) | (_, Self::Applied) => Self::Applied,
            _ => Self::Running,
        }
    }
}
