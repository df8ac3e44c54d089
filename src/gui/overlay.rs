//! Lettering over the 3-D view: view name, axes, scale bar, colour bar, and hints while something is dragged.

use super::heat::Bar;
use super::mesh_scene::{ANGLE_RANGE, Look};
use super::session::Pose;
use super::theme::Tokens;
use super::ui_state::{Heat, MeshPaint};
use crate::render::pick::surface_at;
use crate::render::{ColorMap, Paint, Projection, StandardView, Surface, Vec2, Vec3, View, colormap, round_length};
use crate::units::to_mm;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, Ui, pos2, vec2};

/// Distance of the lettering from the border, points.
const MARGIN: f32 = 14.0;
/// Height of hints over the bottom, points: above the scale bar.
const HINT_HEIGHT: f32 = 48.0;
/// Longest scale bar, points.
const LONGEST_BAR: f32 = 130.0;

fn font() -> FontId {
    FontId::proportional(12.0)
}

/// A ground that lettering stays readable on where it lies over a picture; on empty ground it is not seen.
fn ground(painter: &Painter, area: Rect, tokens: &Tokens) {
    painter.rect_filled(area.expand(4.0), 4.0, tokens.viewport.gamma_multiply(0.8));
}

/// A line of text with the ground it needs.
fn lettering(painter: &Painter, at: Pos2, anchor: Align2, text: impl Into<String>, color: Color32, tokens: &Tokens) {
    let galley = painter.layout_no_wrap(text.into(), font(), color);
    let area = anchor.anchor_size(at, galley.size());
    ground(painter, area, tokens);
    painter.galley(area.min, galley, color);
}

/// Draws what is always there.
pub(super) fn draw(ui: &Ui, rect: Rect, view: &View) {
    let painter = ui.painter().with_clip_rect(rect);
    let tokens = Tokens::here(ui);
    let place = rect.min + vec2(MARGIN, MARGIN - 2.0);
    lettering(&painter, place, Align2::LEFT_TOP, view_name(view), tokens.weak, tokens);
    axes(&painter, rect, view, tokens);
    scale_bar(&painter, rect, view, tokens);
}

/// Says something of the view, below its name.
pub(super) fn note(ui: &Ui, rect: Rect, text: String, color: Color32) {
    let painter = ui.painter().with_clip_rect(rect);
    let place = rect.min + vec2(MARGIN, MARGIN + 20.0);
    lettering(&painter, place, Align2::LEFT_TOP, text, color, Tokens::here(ui));
}

/// Draws scales of colours side by side, the first at the right.
pub(super) fn bars(ui: &Ui, rect: Rect, bars: &[Bar]) {
    let painter = ui.painter().with_clip_rect(rect);
    for (k, bar) in bars.iter().enumerate() {
        draw_bar(bar, &painter, rect.with_max_x(rect.right() - 130.0 * k as f32), Tokens::here(ui));
    }
}

/// The scale of the pattern of a run, dBi from `ends`.
pub(super) fn pattern_bar(freq: f64, [low, high]: [f32; 2]) -> Bar {
    // Adding zero turns -0 round.
    let tick = |k: u8| format!("{:.1}", ((high + (low - high) * f32::from(k) / 4.0) * 10.0).round() / 10.0 + 0.0);
    let title = format!("Directivity (dBi), {}", super::polar::freq_text(freq));
    Bar { map: ColorMap::Viridis, title, ticks: [0, 1, 2, 3, 4].map(tick) }
}

/// The scale of the smallest dihedral angle.
pub(super) fn angle_bar() -> Bar {
    let [low, high] = ANGLE_RANGE;
    let tick = |k: usize| format!("{:.0}°", high + (low - high) * k as f32 / 4.0);
    let mut ticks = [0, 1, 2, 3, 4].map(tick);
    ticks[0].insert_str(0, "≥ ");
    Bar { map: ColorMap::Viridis, title: "Smallest dihedral angle".to_owned(), ticks }
}

/// Marks the places where what was refused fails.
pub(super) fn places(ui: &Ui, rect: Rect, view: &View, places: impl Iterator<Item = Vec3>) {
    let painter = ui.painter().with_clip_rect(rect);
    let tokens = Tokens::here(ui);
    for seen in places.filter_map(|place| view.project(place)) {
        let at = rect.min + vec2(seen.at.x, seen.at.y);
        painter.circle_stroke(at, 7.0, Stroke::new(3.5, tokens.viewport));
        painter.circle_stroke(at, 7.0, Stroke::new(1.8, tokens.signal));
        painter.circle_filled(at, 2.0, tokens.signal);
    }
}

/// Draws what a picture of a mesh needs: a legend, and whether the mesh is out of date.
pub(super) fn mesh(ui: &Ui, rect: Rect, looks: impl Iterator<Item = Look>, paint: MeshPaint, is_stale: bool) {
    let painter = ui.painter().with_clip_rect(rect);
    let tokens = Tokens::here(ui);
    if is_stale {
        let place = rect.min + vec2(MARGIN, MARGIN + 20.0);
        let text = "⚠ Out of date: the geometry has changed since";
        lettering(&painter, place, Align2::LEFT_TOP, text, tokens.warning, tokens);
    }
    let below_bar = 22.0 + (rect.height() * 0.4).clamp(80.0, 240.0) + 18.0;
    let top = if paint == MeshPaint::Angle { below_bar } else { 0.0 };
    legend(&painter, rect, top, looks.map(|look| (look.text(), look.color(tokens))), tokens);
}

/// What the camera shows, in words.
pub(super) fn view_name(view: &View) -> String {
    let camera = &view.camera;
    let near = |v: &StandardView| {
        let (yaw, pitch) = v.angles();
        let turn = (camera.yaw - yaw).rem_euclid(std::f32::consts::TAU);
        turn.min(std::f32::consts::TAU - turn) < 1e-3 && (camera.pitch - pitch).abs() < 1e-3
    };
    let direction = StandardView::ALL.iter().find(|v| near(v)).map(|v| super::command::Command::LookFrom(*v));
    let projection = if camera.projection == Projection::Orthographic { "orthographic" } else { "perspective" };
    match direction {
        Some(command) => format!("{}, {projection}", command.text_and_tip().0),
        None => format!("Free view, {projection}"),
    }
}

fn axes(painter: &Painter, rect: Rect, view: &View, tokens: &Tokens) {
    let center = pos2(rect.left() + 44.0, rect.bottom() - 44.0);
    let [right, up, back] = view.camera.axes();
    let mut arrows: Vec<(f32, egui::Vec2, usize)> = (0..3)
        .map(|i| {
            let axis = Vec3::AXES[i];
            (axis.dot(back), vec2(axis.dot(right), -axis.dot(up)) * 26.0, i)
        })
        .collect();
    painter.circle_filled(center, 42.0, tokens.viewport.gamma_multiply(0.6));
    arrows.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, along, i) in arrows {
        let color = tokens.axes[i];
        painter.line_segment([center, center + along], Stroke::new(2.0, color));
        let name = ["x", "y", "z"][i];
        let reach = if along.length() < 4.0 { vec2(7.0, -7.0) } else { along * (1.0 + 9.0 / along.length()) };
        painter.text(center + reach, Align2::CENTER_CENTER, name, FontId::proportional(13.0), color);
    }
}

fn scale_bar(painter: &Painter, rect: Rect, view: &View, tokens: &Tokens) {
    let per_point = view.length_per_point(view.camera.target);
    let length = round_length(per_point * LONGEST_BAR);
    let width = length / per_point;
    let right = pos2(rect.right() - MARGIN, rect.bottom() - MARGIN - 4.0);
    let left = right - vec2(width, 0.0);
    let stroke = Stroke::new(1.5, tokens.text);
    ground(painter, Rect::from_min_max(left - vec2(0.0, 18.0), right + vec2(0.0, 4.0)), tokens);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 4.0), end + vec2(0.0, 4.0)], stroke);
    }
    let text = if length < 0.1 { format!("{} µm", length * 1e3) } else { format!("{length} mm") };
    painter.text(left.lerp(right, 0.5) - vec2(0.0, 4.0), Align2::CENTER_BOTTOM, text, font(), tokens.text);
}

fn draw_bar(bar: &Bar, painter: &Painter, rect: Rect, tokens: &Tokens) {
    let height = (rect.height() * 0.4).clamp(80.0, 240.0);
    let top = pos2(rect.right() - MARGIN - 60.0, rect.top() + MARGIN + 22.0);
    let area = Rect::from_min_size(top, vec2(14.0, height));
    let title = pos2(rect.right() - MARGIN, rect.top() + MARGIN - 2.0);
    lettering(painter, title, Align2::RIGHT_TOP, bar.title.as_str(), tokens.text, tokens);
    ground(painter, Rect::from_min_max(area.min - vec2(2.0, 4.0), area.max + vec2(62.0, 4.0)), tokens);
    let mut mesh = egui::Mesh::default();
    const STEPS: u32 = 64;
    for k in 0..=STEPS {
        let t = k as f32 / STEPS as f32;
        let [r, g, b] = colormap::color(bar.map, 1.0 - t);
        let y = area.top() + t * height;
        mesh.colored_vertex(pos2(area.left(), y), Color32::from_rgb(r, g, b));
        mesh.colored_vertex(pos2(area.right(), y), Color32::from_rgb(r, g, b));
        if k > 0 {
            mesh.add_triangle(2 * k - 2, 2 * k - 1, 2 * k);
            mesh.add_triangle(2 * k - 1, 2 * k + 1, 2 * k);
        }
    }
    painter.add(mesh);
    painter.rect_stroke(area, 0.0, Stroke::new(1.0, tokens.text), StrokeKind::Outside);
    for (k, text) in bar.ticks.iter().enumerate() {
        let y = area.top() + k as f32 / 4.0 * height;
        painter.line_segment([pos2(area.right(), y), pos2(area.right() + 4.0, y)], Stroke::new(1.0, tokens.text));
        painter.text(pos2(area.right() + 7.0, y), Align2::LEFT_CENTER, text, font(), tokens.text);
    }
}

/// Names beside fields of their colours, at the top right below `top` points.
pub(super) fn legend<'a>(
    painter: &Painter,
    rect: Rect,
    top: f32,
    entries: impl Iterator<Item = (&'a str, Color32)>,
    tokens: &Tokens,
) {
    let lines: Vec<_> =
        entries.map(|(n, color)| (painter.layout_no_wrap(n.to_owned(), font(), tokens.text), color)).collect();
    let width = lines.iter().map(|(text, _)| text.size().x).fold(0.0, f32::max);
    let left = rect.right() - MARGIN - width;
    let first = pos2(left - 20.0, rect.top() + MARGIN - 1.0 + top);
    if !lines.is_empty() {
        let last = pos2(rect.right() - MARGIN, first.y + 19.0 * lines.len() as f32 - 4.0);
        ground(painter, Rect::from_min_max(first, last), tokens);
    }
    for (k, (text, color)) in lines.into_iter().enumerate() {
        let middle = rect.top() + MARGIN + 6.0 + top + 19.0 * k as f32;
        let field = Rect::from_center_size(pos2(left - 14.0, middle), vec2(13.0, 13.0));
        painter.rect(field, 2.0, color, Stroke::new(1.0, tokens.weak), StrokeKind::Outside);
        let at = pos2(left, middle - text.size().y / 2.0);
        painter.galley(at, text, tokens.text);
    }
}

/// Number and place of the vertex under the pointer.
pub(super) fn vertex_hint(ui: &Ui, rect: Rect, vertex: u32, pose: &Pose) {
    if let Some(at) = pose.vertices.get(vertex as usize) {
        let [x, y, z] = at.to_array().map(to_mm);
        hint(ui, rect, &format!("Cage vertex {vertex} at {x:.3}, {y:.3}, {z:.3} mm: drag or G moves, Shift adds"));
    }
}

/// A few words at the bottom of the view, above the scale bar.
pub(super) fn hint(ui: &Ui, rect: Rect, text: &str) {
    let tokens = Tokens::here(ui);
    let width = (rect.width() - 2.0 * MARGIN - 16.0).max(60.0);
    let galley = ui.painter().layout(text.to_owned(), font(), tokens.text, width);
    let at = pos2(rect.center().x - galley.size().x / 2.0, rect.bottom() - HINT_HEIGHT - galley.size().y);
    let back = Rect::from_min_size(at, galley.size()).expand2(vec2(8.0, 4.0));
    ui.painter().rect_filled(back, 4.0, tokens.panel);
    ui.painter().galley(at, galley, tokens.text);
}

/// The painted value under the pointer.
pub(super) fn value_hint(ui: &Ui, view: &View, surface: &Surface, pointer: Pos2, at: Vec2, heat: Heat) {
    if surface.scalars.is_none() || ui.input(|i| i.pointer.any_down()) {
        return;
    }
    let hit = surface_at(view, surface, at).filter(|hit| surface.parts[hit.part].paint == Paint::Heat);
    let Some(value) = hit.and_then(|hit| hit.value) else { return };
    tag(ui, pointer, format!("{} {}", heat.text(), heat.value_text(value)));
}

/// A few words beside the pointer.
pub(super) fn tag(ui: &Ui, pointer: Pos2, text: String) {
    let tokens = Tokens::here(ui);
    let galley = ui.painter().layout_no_wrap(text, font(), tokens.text);
    let place = pointer + vec2(14.0, 10.0);
    ui.painter().rect_filled(Rect::from_min_size(place, galley.size()).expand(4.0), 3.0, tokens.panel);
    ui.painter().galley(place, galley, tokens.text);
}
