//! What the 3-D view shows of editing: the operator at work, mirror planes and partners, names of the gizmo's parts,
//! hints for outlines.

use super::edit_ui::{EditUi, Outline};
use super::operating::Operating;
use super::overlay::hint;
use super::session::Pose;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::render::gizmo::grip;
use crate::render::{Bound, Gizmo, GizmoPart, Vec3, View};
use egui::{Color32, Id, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};

/// Half length of the line that shows an axis, in heights of the view.
const AXIS_REACH: f32 = 2.0;
/// Pieces of that line: one behind the eye is left out.
const AXIS_PIECES: i8 = 40;
/// Radius of the ring around the partner of a selected vertex, points.
const PARTNER_RADIUS: f32 = 6.5;

/// Where a point is seen in the window.
fn seen(view: &View, rect: Rect, point: Vec3) -> Option<Pos2> {
    view.project(point).map(|p| rect.min + vec2(p.at.x, p.at.y))
}

/// Draws what an operator is bound to and reaches, and says what it does.
pub(super) fn operator(ui: &Ui, rect: Rect, view: &View, operating: &Operating, editing: &EditUi) {
    let tokens = Tokens::here(ui);
    let painter = ui.painter().with_clip_rect(rect);
    let pivot = operating.pivot.as_vec3();
    let length = AXIS_REACH * rect.height() * view.length_per_point(pivot);
    let axes = if operating.bound == Bound::Free { Vec::new() } else { operating.bound.axes() };
    for axis in axes {
        let at = |k: i8| seen(view, rect, pivot + f32::from(k) / f32::from(AXIS_PIECES) * length * Vec3::AXES[axis]);
        for k in -AXIS_PIECES..AXIS_PIECES {
            if let (Some(a), Some(b)) = (at(k), at(k + 1)) {
                painter.line_segment([a, b], Stroke::new(1.2, tokens.axes[axis]));
            }
        }
    }
    if let (Some(radius), Some(center)) = (editing.radius(), seen(view, rect, pivot)) {
        let points = radius as f32 / view.length_per_point(pivot);
        painter.circle_stroke(center, points, Stroke::new(1.2, tokens.text));
    }
    let what = operating.text(editing);
    let end = if operating.is_held { "let go" } else { "Enter or click" };
    let absolute = if operating.may_be_absolute() { "   = target" } else { "" };
    let keys = format!(
        "X, Y, Z axis (Shift: plane)   digits: exact{absolute}   Ctrl steps   O near ones   {end}: apply   Esc: give up"
    );
    hint(ui, rect, &format!("{what}\n{keys}"));
    let told = ui.interact(rect, Id::unique("operator text"), Sense::hover());
    told.widget_info(|| WidgetInfo::labeled(Role::Label, true, what.clone()));
}

/// Draws the mirror planes through the cage, and rings around the partners of selected vertices.
pub(super) fn mirrors(ui: &Ui, rect: Rect, view: &View, (pose, handles): (&Pose, &[Vec3]), state: &UiState) {
    let mirror = state.editing.mirror();
    if mirror == Default::default() || handles.is_empty() {
        return;
    }
    let tokens = Tokens::here(ui);
    let painter = ui.painter().with_clip_rect(rect);
    let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = handles.iter().fold(start, |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let room = 0.05 * (high - low).max_element();
    for axis in (0..2).filter(|&a| mirror.axes[a]) {
        let across = Vec3::AXES[1 - axis];
        let [from, to] = [(low - room).dot(across), (high + room).dot(across)];
        let [bottom, top] = [low.z - room, high.z + room];
        let corners = [(from, bottom), (to, bottom), (to, top), (from, top)];
        let corners = corners.map(|(along, z)| seen(view, rect, along * across + z * Vec3::Z));
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            let color = tokens.axes[axis];
            let fill = color.gamma_multiply(0.08);
            painter.add(Shape::convex_polygon(vec![a, b, c, d], fill, Stroke::new(1.0, color.gamma_multiply(0.7))));
        }
    }
    let all = mirror.with_partners(&pose.cage, &state.selection);
    for vertex in all.difference(&state.selection) {
        if let Some(at) = handles.get(*vertex as usize).and_then(|p| seen(view, rect, *p)) {
            let color: Color32 = tokens.handles[2];
            painter.circle_stroke(at, PARTNER_RADIUS, Stroke::new(1.5, color));
        }
    }
}

/// What a drag of a part of the gizmo does.
pub(super) fn part_text(part: GizmoPart) -> String {
    let name = |axis: usize| ["x", "y", "z"][axis];
    match part {
        GizmoPart::Center => "Move in the plane of the screen".to_owned(),
        GizmoPart::Arrow(axis) => format!("Move along {}", name(axis)),
        GizmoPart::Ring(axis) => format!("Turn about {}", name(axis)),
        GizmoPart::Knob(axis) => format!("Scale along {}", name(axis)),
    }
}

/// Gives each vertex a name for screen readers and tests; the view itself handles the pointer.
///
/// * `handles`: in picture units.
pub(super) fn name_vertices(ui: &Ui, response: &Response, view: &View, handles: &[Vec3], state: &UiState) {
    for (i, &handle) in handles.iter().enumerate() {
        let Some(at) = seen(view, response.rect, handle).filter(|at| response.rect.contains(*at)) else { continue };
        let named = ui.interact(Rect::from_center_size(at, vec2(12.0, 12.0)), response.id.with(i), Sense::hover());
        let selected = u32::try_from(i).is_ok_and(|v| state.selection.contains(&v));
        named.widget_info(|| WidgetInfo::selected(Role::GraphicsSymbol, true, selected, format!("Cage vertex {i}")));
    }
}

/// Gives each part of the gizmo a name for screen readers and tests; the view itself handles the pointer.
pub(super) fn name_gizmo(ui: &Ui, response: &Response, view: &View, gizmo: &Gizmo) {
    let of_axis = |axis| [GizmoPart::Arrow(axis), GizmoPart::Ring(axis), GizmoPart::Knob(axis)];
    for part in (0..3).flat_map(of_axis).chain([GizmoPart::Center]) {
        let Some(at) = grip(view, gizmo, part) else { continue };
        let place = Rect::from_center_size(response.rect.min + vec2(at.x, at.y), vec2(12.0, 12.0));
        if response.rect.contains_rect(place) {
            let named = ui.interact(place, response.id.with(part), Sense::hover());
            named.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, part_text(part)));
        }
    }
}

/// Says what the next drag does.
pub(super) fn outline_hint(ui: &Ui, rect: Rect, outline: Outline) {
    let text = match outline {
        Outline::Box => "Drag a box around vertices; Shift adds, Alt takes away; B ends",
        Outline::Lasso => "Draw a line around vertices; Shift adds, Alt takes away; Shift+L ends",
    };
    hint(ui, rect, text);
}
