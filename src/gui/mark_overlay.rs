//! Feed and resistors marked in the 3-D view, each with its value under the pointer.

use super::overlay::tag;
use super::theme::Tokens;
use crate::pipeline::{Mark, MarkKind};
use crate::render::View;
use crate::units::to_mm;
use egui::{Color32, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};

/// How far from a mark the pointer still reads it, points.
const REACH: f32 = 11.0;
/// Half the size of a resistor's symbol, points.
const HALF: egui::Vec2 = vec2(10.0, 4.0);
/// How much of a mark is seen from behind the antenna.
const BEHIND: f32 = 0.35;

/// Name and value of a mark.
fn text(kind: MarkKind) -> String {
    match kind {
        MarkKind::Feed => "Feed point".to_owned(),
        MarkKind::Resistor(index, ohm) => format!("Resistor {}: {ohm} Ω", index + 1),
        MarkKind::Source(ohm) => format!("Feed: {ohm} Ω across the gap"),
    }
}

/// Draws the marks, and reads the one under the pointer; true if there is one.
pub(super) fn draw(ui: &Ui, response: &Response, view: &View, marks: &[Mark], reads: bool) -> bool {
    let rect = response.rect;
    let painter = ui.painter().with_clip_rect(rect);
    let tokens = Tokens::here(ui);
    let to_eye = view.camera.axes()[2];
    let mut pointed: Option<(Pos2, MarkKind)> = None;
    for mark in marks {
        let Some(seen) = view.project((mark.at * to_mm(1.0)).as_vec3()) else { continue };
        let at = rect.min + vec2(seen.at.x, seen.at.y);
        if !rect.contains(at) {
            continue;
        }
        let strength = if mark.up.is_some_and(|up| up.as_vec3().dot(to_eye) < 0.0) { BEHIND } else { 1.0 };
        symbol(&painter, at, mark.kind, [tokens.viewport, tokens.text].map(|c| c.gamma_multiply(strength)));
        let place = Rect::from_center_size(at, vec2(2.0 * REACH, 2.0 * REACH));
        let named = ui.interact(place, response.id.with(text(mark.kind)), Sense::hover());
        named.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, text(mark.kind)));
        let pointer = response.hover_pos().filter(|_| reads && response.contains_pointer());
        if let Some(pointer) = pointer.filter(|p| p.distance(at) <= REACH) {
            pointed = Some((pointer, mark.kind));
        }
    }
    if let Some((pointer, kind)) = pointed {
        tag(ui, pointer, text(kind));
    }
    pointed.is_some()
}

/// A zigzag for a resistor, a ringed point for the feed, on a ground that keeps them readable.
fn symbol(painter: &Painter, at: Pos2, kind: MarkKind, [ground, ink]: [Color32; 2]) {
    match kind {
        MarkKind::Feed | MarkKind::Source(_) => {
            painter.circle(at, 5.0, ground, Stroke::new(1.4, ink));
            painter.circle_filled(at, 1.8, ink);
        }
        MarkKind::Resistor(..) => {
            painter.rect_filled(Rect::from_center_size(at, 2.0 * HALF + vec2(6.0, 4.0)), 3.0, ground);
            let knots = [-1.0, -0.75, -0.5, -0.17, 0.17, 0.5, 0.75, 1.0];
            let heights = [0.0, 0.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.0];
            let line = knots.iter().zip(heights).map(|(x, y)| at + vec2(x * HALF.x, y * HALF.y));
            painter.add(Shape::line(line.collect(), Stroke::new(1.4, ink)));
        }
    }
}
