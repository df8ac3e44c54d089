//! Choosing cage vertices: the commands of the Select menu, and outlines drawn around them.

use super::edit_ui::Outline;
use super::keys::{plain, shift};
use super::session::Pose;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::cage::{Axis, Layer, Like, Selection};
use crate::project::{BendPlane, PresetSpec, Project};
use crate::render::pick::{handles_in, handles_within};
use crate::render::{Vec2, Vec3, View};
use egui::{Key, KeyboardShortcut, Modifiers, Rect, Shape, Stroke, Ui, vec2};

/// Distance between the points of a lasso, points: nearer ones add nothing that can be seen.
const LASSO_STEP: f32 = 3.0;

/// A set of vertices to be selected, most of them by what is selected already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pick {
    Inverse,
    Station,
    Row,
    Column,
    Top,
    Bottom,
    More,
    Less,
}

impl Pick {
    /// Text and tooltip of the command.
    pub(super) fn text_and_tip(self) -> (&'static str, &'static str) {
        match self {
            Self::Inverse => ("Invert selection", "Select what is not selected, and nothing else"),
            Self::Station => ("Select stations", "Add all vertices at the same place along the bent axis"),
            Self::Row => ("Select rows", "Add the lines of vertices along x, in the same layer"),
            Self::Column => ("Select columns", "Add the lines of vertices along y, in the same layer"),
            Self::Top => ("Select upper layer", "Select all vertices above the antenna"),
            Self::Bottom => ("Select lower layer", "Select all vertices below the antenna"),
            Self::More => ("Grow selection", "Add the neighbors of the selected vertices"),
            Self::Less => ("Shrink selection", "Take away the vertices at the border of the selection"),
        }
    }

    /// Keys of the command.
    pub(super) fn keys(self) -> Vec<KeyboardShortcut> {
        match self {
            Self::Inverse => vec![KeyboardShortcut::new(Modifiers::COMMAND, Key::I)],
            Self::Station => vec![shift(Key::S)],
            Self::Row => vec![shift(Key::R)],
            Self::Column => vec![shift(Key::C)],
            Self::Top => vec![shift(Key::T)],
            Self::Bottom => vec![shift(Key::B)],
            Self::More => vec![plain(Key::Plus), plain(Key::Equals)],
            Self::Less => vec![plain(Key::Minus)],
        }
    }

    /// Whether it starts from what is selected.
    pub(super) fn needs_selection(self) -> bool {
        !matches!(self, Self::Inverse | Self::Top | Self::Bottom)
    }

    /// The new selection.
    pub(super) fn applied(self, chosen: &Selection, pose: &Pose, project: &Project) -> Selection {
        let cage = &pose.cage;
        match self {
            Self::Inverse => cage.select_inverse(chosen),
            Self::Station => cage.select_like(chosen, Like::Station(bent_axis(project))),
            Self::Row => cage.select_like(chosen, Like::Row),
            Self::Column => cage.select_like(chosen, Like::Column),
            Self::Top => cage.select_layer(Layer::Top),
            Self::Bottom => cage.select_layer(Layer::Bottom),
            Self::More => cage.select_more(chosen),
            Self::Less => cage.select_less(chosen),
        }
    }
}

/// The axis that the first bend curves; x where there is none.
fn bent_axis(project: &Project) -> Axis {
    let planes = project.presets.iter().filter(|entry| entry.enabled).filter_map(|entry| match entry.preset {
        PresetSpec::Bend { plane, .. } => Some(plane),
        _ => None,
    });
    if planes.take(1).any(|plane| plane == BendPlane::E) { Axis::Y } else { Axis::X }
}

/// An outline that is being drawn, in points of the view.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    outline: Outline,
    /// The first corner of a box, or the line so far.
    line: Vec<Vec2>,
}

impl Drawn {
    /// Begins at a place.
    pub(super) fn new(outline: Outline, from: Vec2) -> Self {
        Self { outline, line: vec![from] }
    }

    /// Goes on to a place.
    pub(super) fn extend(&mut self, to: Vec2) {
        let is_far = self.line.last().is_none_or(|last| last.distance(to) >= LASSO_STEP);
        if self.outline == Outline::Lasso && is_far {
            self.line.push(to);
        }
    }

    /// Selects the handles inside: with Shift besides what was selected, with Alt they are taken away.
    pub(super) fn select(&self, view: &View, handles: &[Vec3], to: Vec2, modifiers: Modifiers, state: &mut UiState) {
        let found = match self.outline {
            Outline::Box => handles_in(view, handles, self.line[0], to),
            Outline::Lasso => handles_within(view, handles, &self.line),
        };
        let found: Selection = found.into_iter().filter_map(|v| u32::try_from(v).ok()).collect();
        if modifiers.alt {
            state.selection = &state.selection - &found;
        } else if modifiers.shift {
            state.selection.extend(found);
        } else {
            state.selection = found;
        }
    }

    /// Draws it.
    pub(super) fn draw(&self, ui: &Ui, rect: Rect, to: Vec2) {
        let tokens = Tokens::here(ui);
        let (fill, stroke) = (tokens.accent.gamma_multiply(0.15), Stroke::new(1.0, tokens.accent));
        let place = |p: Vec2| rect.min + vec2(p.x, p.y);
        let painter = ui.painter().with_clip_rect(rect);
        match self.outline {
            Outline::Box => {
                let area = Rect::from_two_pos(place(self.line[0]), place(to));
                painter.rect(area, 0.0, fill, stroke, egui::StrokeKind::Inside);
            }
            Outline::Lasso => {
                let line: Vec<_> = self.line.iter().chain([&to]).map(|p| place(*p)).collect();
                painter.add(Shape::closed_line(line, stroke));
            }
        }
    }
}
