//! Bodies that are looked at before they are imported: their edges in the view, and where they are refused.

use super::overlay;
use super::theme::Tokens;
use crate::antenna::BodyFault;
use crate::geometry::{DVec3, TriMesh, VertexId};
use crate::render::{Vec3, View};
use crate::units::to_mm;
use egui::{Rect, Stroke, Ui, vec2};
use std::collections::BTreeMap;

/// Cosine of the angle between two faces from which the edge between them is drawn.
const SMOOTH: f64 = 0.94;
/// Edges drawn at most: more are no picture any more, and slow.
const MAX_EDGES: usize = 6000;

/// What is drawn of the bodies, in mm.
#[derive(Debug)]
pub(super) struct Draft {
    edges: Vec<[Vec3; 2]>,
    /// Least and greatest coordinates.
    pub(super) bounds: [Vec3; 2],
    /// Where they are refused.
    pub(super) places_mm: Vec<[f64; 3]>,
}

impl Draft {
    /// The bodies' surfaces, m.
    pub(super) fn new<'a>(surfaces: impl Iterator<Item = &'a TriMesh> + Clone) -> Self {
        let edges: Vec<[Vec3; 2]> = surfaces.clone().flat_map(edges).collect();
        let edges = edges.iter().copied().step_by(edges.len().div_ceil(MAX_EDGES).max(1)).collect();
        let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let vertices = surfaces.flat_map(|surface| &surface.vertices).map(|&p| in_mm(p));
        Self { edges, bounds: vertices.fold(start, |[lo, hi], p| [lo.min(p), hi.max(p)]), places_mm: Vec::new() }
    }

    /// Draws the edges over the view.
    pub(super) fn draw(&self, ui: &Ui, rect: Rect, view: &View) {
        let tokens = Tokens::here(ui);
        let painter = ui.painter().with_clip_rect(rect);
        let stroke = Stroke::new(1.0, tokens.text.gamma_multiply(0.8));
        for edge in &self.edges {
            if let [Some(from), Some(to)] = edge.map(|p| view.project(p)) {
                painter.line_segment([from, to].map(|seen| rect.min + vec2(seen.at.x, seen.at.y)), stroke);
            }
        }
        overlay::note(ui, rect, "To be imported; nothing is changed yet".to_owned(), tokens.weak);
    }
}

/// Where a fault is, mm.
pub(super) fn places_mm(fault: &BodyFault) -> Vec<[f64; 3]> {
    fault.places().iter().map(|place| place.to_array().map(to_mm)).collect()
}

fn in_mm(place: DVec3) -> Vec3 {
    (place * to_mm(1.0)).as_vec3()
}

/// The edges of a surface at which it is bent, or which have no two faces, mm; all of them where it is smooth.
fn edges(surface: &TriMesh) -> Vec<[Vec3; 2]> {
    let mut normals: BTreeMap<[VertexId; 2], Vec<DVec3>> = BTreeMap::new();
    for (f, face) in surface.faces.iter().enumerate() {
        let [a, b, c] = surface.corners(f);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for k in 0..3 {
            let (from, to) = (face[k], face[(k + 1) % 3]);
            normals.entry([from.min(to), from.max(to)]).or_default().push(normal);
        }
    }
    let is_drawn = |of: &[DVec3]| !matches!(of, [m, n] if m.dot(*n) > SMOOTH);
    let is_smooth = !normals.values().any(|of| is_drawn(of));
    let drawn = normals.into_iter().filter(|(_, of)| is_smooth || is_drawn(of));
    drawn.map(|(ends, _)| ends.map(|v| in_mm(surface.vertices[v.index()]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antenna::bodies::tests::cuboid;

    #[test]
    fn a_box_is_drawn_by_its_twelve_edges_and_a_hole_by_its_rim() {
        let mut body = cuboid("a", [0.0, 0.0, 0.0], [4.0, 2.0, 1.0], [1, 1, 1]).surface;
        // Each side has corners of its own: those of one place are one.
        let mut first = BTreeMap::new();
        let same: Vec<VertexId> = (0..body.vertices.len())
            .map(|v| *first.entry(body.vertices[v].to_array().map(f64::to_bits)).or_insert(VertexId::new(v)))
            .collect();
        body.faces.iter_mut().flatten().for_each(|v| *v = same[v.index()]);
        let draft = Draft::new([&body].into_iter());
        assert_eq!(draft.edges.len(), 12, "no diagonals");
        assert_eq!(draft.bounds, [Vec3::ZERO, Vec3::new(4.0, 2.0, 1.0)], "in mm");
        body.faces.pop();
        assert_eq!(Draft::new([&body].into_iter()).edges.len(), 13, "with the diagonal that has one face left");
    }
}
