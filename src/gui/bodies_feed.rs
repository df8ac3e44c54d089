//! The feed of imported bodies: as it is typed, and placed by clicks on the antenna, flat or bent.

use super::outbox::Outbox;
use super::overlay;
use super::panel_bodies::place_feed;
use super::scene::{CREASE_DEG, to_picture};
use crate::geometry::{DVec3, Plc};
use crate::project::{BodiesSpec, FeedSpec};
use crate::render::pick::surface_at;
use crate::render::scene::crease_edges;
use crate::render::{Surface, Vec2, Vec3, View};
use crate::units::to_mm;
use egui::{Key, Modifiers, Rect, Ui};

/// How close to an edge a click still means the edge, points.
const SNAP: f32 = 8.0;

/// The feed of bodies as it is typed, and why it was not placed.
#[derive(Clone, Debug)]
pub(super) struct FeedUi {
    /// Whether its heights are found between metal above each other.
    pub(super) is_upright: bool,
    pub(super) ends_mm: [[f64; 3]; 2],
    pub(super) ohm: f64,
    pub(super) error: Option<String>,
    /// The end that the next click in the view places.
    pub(super) picks: Option<usize>,
    /// The feed that was taken over last.
    taken: Option<FeedSpec>,
}

impl FeedUi {
    /// Takes over the numbers of a feed once it is another one.
    pub(super) fn follow(&mut self, feed: Option<FeedSpec>) {
        if self.taken == feed {
            return;
        }
        self.taken = feed;
        if let Some(FeedSpec { from_mm, to_mm, ohm }) = feed {
            let is_upright = (0..2).all(|k| (from_mm[k] - to_mm[k]).abs() < 1e-9);
            *self = Self { is_upright, ends_mm: [from_mm, to_mm], ohm, error: None, ..*self };
        }
    }
}

impl Default for FeedUi {
    fn default() -> Self {
        Self { is_upright: true, ends_mm: [[0.0; 3]; 2], ohm: 50.0, error: None, picks: None, taken: None }
    }
}

/// Takes a click on the antenna for the next end of the feed; the last one places it.
///
/// * `surface`: the antenna as drawn; its vertices are those of the flat complex `flat`.
pub(super) fn click(
    (view, at): (&View, Vec2),
    surface: &Surface,
    flat: &Plc,
    spec: &BodiesSpec,
    feed: &mut FeedUi,
    out: &mut Outbox,
) {
    let (Some(end), Some(place)) = (feed.picks, flat_place(view, at, surface, flat, !feed.is_upright)) else { return };
    feed.ends_mm[end] = (place * to_mm(1.0)).to_array();
    if feed.is_upright {
        // Only its height must be exact, and that is found.
        feed.ends_mm[end] = feed.ends_mm[end].map(|x| (x * 1e3).round() / 1e3);
    }
    feed.picks = (!feed.is_upright && end == 0).then_some(1);
    if feed.picks.is_none() {
        place_feed(spec, feed, out);
    }
}

/// Says what the next click does, and ends it with Esc.
pub(super) fn hint(ui: &Ui, rect: Rect, feed: &mut FeedUi) {
    let text = match (feed.picks, feed.is_upright) {
        (Some(_), true) => "Click where the feed goes through; Esc gives up",
        (Some(0), false) => "Click the metal where the feed begins; Esc gives up",
        (Some(_), false) => "Click the metal where the feed ends; Esc gives up",
        (None, _) => return,
    };
    overlay::hint(ui, rect, text);
    if ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape)) {
        feed.picks = None;
    }
}

/// The place on the flat antenna that is seen at a place of the view, m.
///
/// * `snaps`: whether a place near an edge of a body is on the edge, from which a gap can be crossed.
fn flat_place(view: &View, at: Vec2, surface: &Surface, flat: &Plc, snaps: bool) -> Option<DVec3> {
    let hit = surface_at(view, surface, at)?;
    let triangles = &surface.parts[hit.part].triangles;
    let on_edge = if snaps { edge_near(view, at, hit.point, (surface, triangles), flat) } else { None };
    on_edge.or_else(|| {
        let weights = hit.weights.map(f64::from);
        let corners = triangles[hit.triangle].iter().zip(weights);
        let places = corners.map(|(&v, w)| Some(*flat.vertices.get(v as usize)? * w));
        Some(places.sum::<Option<DVec3>>()? / weights.iter().sum::<f64>())
    })
}

/// The place on the flat antenna of the nearest edge of a body, if that is seen close to a place of the view.
fn edge_near(
    view: &View,
    at: Vec2,
    point: Vec3,
    (surface, triangles): (&Surface, &[[u32; 3]]),
    flat: &Plc,
) -> Option<DVec3> {
    let nearest = |[a, b]: [u32; 2]| {
        let [p, q] = [a, b].map(|v| surface.positions[v as usize]);
        let along = q - p;
        let t = ((point - p).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (p + along * t, t, [a, b])
    };
    let edges = crease_edges(&to_picture(&flat.vertices), triangles, CREASE_DEG);
    let found = edges.into_iter().map(nearest).min_by(|a, b| a.0.distance(point).total_cmp(&b.0.distance(point)));
    let (seen, t, ends) = found?;
    let [a, b] = ends.map(|v| flat.vertices[v as usize]);
    (view.project(seen)?.at.distance(at) <= SNAP).then(|| a.lerp(b, f64::from(t)))
}
