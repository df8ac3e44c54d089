//! The rims of flat parts, divided so that rims which lie above one another get their points above one another.

use super::near::Near;
use super::{Flats, Sizes, sides};
use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{DVec3, Plc, VertexId};
use crate::tet::store::edge_key;
use std::collections::{BTreeSet, HashMap};

/// Longest edge of a rim over the width of the narrowest part at it, which is the side of a thin plate or layer: longer
/// ones make flat cells, shorter ones many.
const OVER_SIDE: f64 = 10.0;
/// The same over the width of the others.
const OVER_FACE: f64 = 1.5;
/// Rims are not divided more finely than this part of the wanted edge for the sake of a narrow part.
const SHORTEST: f64 = 1.0 / 8.0;
/// Least distance between points that are taken from another rim, in wanted edges.
const CLOSEST: f64 = 0.25;

/// The edges between parts, divided.
pub(super) struct Rim {
    /// Vertices of the complex, then those on edges.
    pub(super) vertices: Vec<DVec3>,
    /// By edge, smaller vertex first: the vertices on it, from the first to the second.
    on_edge: HashMap<[VertexId; 2], Vec<VertexId>>,
    /// How many vertices the complex has.
    n_given: usize,
}

/// An edge of a rim before it is divided.
struct Bare {
    ends: [VertexId; 2],
    /// Parts at it.
    parts: Vec<usize>,
    /// Wanted length of its pieces, m.
    wanted: f64,
}

impl Rim {
    /// * `reach`: how far above one another rims are aligned, m.
    pub(super) fn new(plc: &Plc, flats: &Flats, sizes: Sizes, reach: f64) -> Self {
        let mut rim = Self { vertices: plc.vertices.clone(), on_edge: HashMap::new(), n_given: plc.vertices.len() };
        let mut near = Near::new(reach);
        let edges = bare_edges(plc, flats, sizes);
        let corners: BTreeSet<VertexId> = edges.iter().flat_map(|e| e.ends).collect();
        corners.iter().for_each(|v| near.add(plc.vertices[v.index()]));
        for bare in &edges {
            let [a, b] = bare.ends.map(|v| plc.vertices[v.index()]);
            let mut stops = taken(bare, [a, b], flats, &near, reach);
            stops.retain({
                let mut last = 0.0;
                let least = CLOSEST * bare.wanted / a.distance(b);
                move |&t| {
                    let is_far = t - last >= least && 1.0 - t >= least;
                    last = if is_far { t } else { last };
                    is_far
                }
            });
            stops.push(1.0);
            let mut places = Vec::new();
            let mut from = 0.0;
            for to in stops {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of pieces")]
                let n = (a.distance(b) * (to - from) / bare.wanted - 1e-6).ceil().max(1.0) as usize;
                places.extend((1..=n).map(|k| from + (to - from) * k as f64 / n as f64));
                from = to;
            }
            places.pop();
            let first = rim.vertices.len();
            rim.vertices.extend(places.iter().map(|&t| a.lerp(b, t)));
            rim.vertices[first..].iter().for_each(|&p| near.add(p));
            rim.on_edge.insert(bare.ends, (first..rim.vertices.len()).map(VertexId::new).collect());
        }
        rim
    }

    /// The vertices of all rims.
    pub(super) fn used(&self) -> impl Iterator<Item = VertexId> {
        let corners: BTreeSet<VertexId> = self.on_edge.keys().flatten().copied().collect();
        corners.into_iter().chain((self.n_given..self.vertices.len()).map(VertexId::new))
    }

    /// The pieces of an edge in its direction; none if it is no edge between parts.
    pub(super) fn pieces(&self, [from, to]: [VertexId; 2]) -> Vec<[VertexId; 2]> {
        let Some(between) = self.on_edge.get(&edge_key(from, to)) else { return Vec::new() };
        let mut along = vec![from];
        if from < to {
            along.extend(between);
        } else {
            along.extend(between.iter().rev());
        }
        along.push(to);
        along.windows(2).map(|w| [w[0], w[1]]).collect()
    }
}

/// The edges between parts, those with the shortest pieces first: the others follow them.
fn bare_edges(plc: &Plc, flats: &Flats, sizes: Sizes) -> Vec<Bare> {
    let mut at: HashMap<[VertexId; 2], Vec<usize>> = HashMap::new();
    let mut area = vec![0.0; flats.n_parts()];
    for (f, facet) in plc.facets.iter().enumerate() {
        area[flats.part_of[f]] += doubled_area_vector(plc.corners(f)).length() / 2.0;
        sides(facet).iter().for_each(|[a, b]| at.entry(edge_key(*a, *b)).or_default().push(flats.part_of[f]));
    }
    at.retain(|_, parts| !matches!(parts[..], [p, q] if p == q));
    let mut edges: Vec<Bare> = at.into_iter().map(|(ends, parts)| Bare { ends, parts, wanted: sizes.inner }).collect();
    edges.sort_unstable_by_key(|e| e.ends);
    let length = |[a, b]: [VertexId; 2]| plc.vertices[a.index()].distance(plc.vertices[b.index()]);
    let mut perimeter = vec![0.0; flats.n_parts()];
    edges.iter().for_each(|e| e.parts.iter().for_each(|&p| perimeter[p] += length(e.ends)));
    let is_metal = flats.at_metal(plc);
    for bare in &mut edges {
        let edge = if bare.parts.iter().any(|&p| is_metal[p]) { sizes.at_metal } else { sizes.inner };
        let mut widths: Vec<f64> = bare.parts.iter().map(|&p| 2.0 * area[p] / perimeter[p]).collect();
        widths.sort_by(f64::total_cmp);
        let limits = std::iter::once(OVER_SIDE).chain(std::iter::repeat(OVER_FACE));
        let narrow = widths.iter().zip(limits).map(|(width, limit)| width * limit).fold(edge, f64::min);
        bare.wanted = narrow.max(SHORTEST * edge);
    }
    edges.sort_by(|p, q| p.wanted.total_cmp(&q.wanted));
    edges
}

/// Where points lie right above or below an edge as seen from a part at it: parts of the edge, ascending.
fn taken(bare: &Bare, [a, b]: [DVec3; 2], flats: &Flats, near: &Near, reach: f64) -> Vec<f64> {
    let along = b - a;
    let stop = |p: DVec3| {
        let t = (p - a).dot(along) / along.length_squared();
        let off = p - a - along * t;
        let height = off.length();
        let is_above = |&part: &usize| {
            let normal = flats.normals[part];
            (off - normal * off.dot(normal)).length() <= flats.tolerance
        };
        let is_own = height <= flats.tolerance;
        (0.0 < t && t < 1.0 && !is_own && height <= reach && bare.parts.iter().any(is_above)).then_some((t, height))
    };
    let mut stops: Vec<(f64, f64)> = near.around(a.min(b), a.max(b)).into_iter().filter_map(stop).collect();
    // The nearest of several at one place counts.
    stops.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1)));
    stops.into_iter().map(|s| s.0).collect()
}
