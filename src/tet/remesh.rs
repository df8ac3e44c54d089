//! New triangles for the flat parts of a surface complex: of a wanted size and well shaped, whatever they were.
//!
//! Facets in one plane between the same two regions are one part. Its rim is divided first, for all parts at it alike, more
//! finely where one of them is narrow; then the part is triangulated anew within its rim. Facets that lie in no plane with
//! others are parts of their own, so the shape stays what it was.

use crate::geometry::{DVec2, DVec3, Facet, Plc, VertexId};
use spade::handles::FixedVertexHandle;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};
use std::collections::{BTreeSet, HashMap, HashSet};

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Longest edge of a rim over the width of a part at it: longer ones make flat cells, shorter ones many.
const ASPECT: f64 = 4.0;
/// Rims are not divided more finely than this part of the wanted edge for the sake of a narrow part.
const SHORTEST: f64 = 1.0 / 16.0;
/// Smallest angle asked for, degrees; the rim, which stays as it is, may have smaller ones.
const MIN_ANGLE_DEG: f64 = 25.0;
/// Most points added in a part.
const MOST_POINTS: usize = 100_000;
/// Cosine of the angle between facets that may lie in one plane.
const SAME_NORMAL: f64 = 0.999;

/// Triangulates a complex anew.
///
/// * `keep`: vertices that stay even within a part.
/// * `edge`: wanted length of edges, m.
/// * `tolerance`: greatest distance of vertices from the plane of their part, m.
///
/// # Errors
/// A place where the rim of a part crosses itself, m.
pub fn remesh(plc: &Plc, keep: &[VertexId], edge: f64, tolerance: f64) -> Result<Plc, DVec3> {
    let part_of = parts(plc, tolerance);
    let n_parts = part_of.iter().max().map_or(0, |p| p + 1);
    let mut members = vec![Vec::new(); n_parts];
    part_of.iter().enumerate().for_each(|(f, &part)| members[part].push(f));
    let rim = Rim::new(plc, &part_of, n_parts, edge);
    let mut new = Plc { vertices: rim.vertices.clone(), facets: Vec::new(), regions: plc.regions.clone() };
    for facets in &members {
        Part { plc, rim: &rim, facets, edge }.triangulate(keep, &mut new)?;
    }
    Ok(compact(new))
}

fn key(a: VertexId, b: VertexId) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

fn sides(f: &Facet) -> [[VertexId; 2]; 3] {
    let [a, b, c] = f.vertices;
    [[a, b], [b, c], [c, a]]
}

fn doubled_area([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// For each facet the part that it belongs to.
fn parts(plc: &Plc, tolerance: f64) -> Vec<usize> {
    let mut at: HashMap<[VertexId; 2], Vec<usize>> = HashMap::new();
    for (f, facet) in plc.facets.iter().enumerate() {
        sides(facet).iter().for_each(|[a, b]| at.entry(key(*a, *b)).or_default().push(f));
    }
    let mut part_of = vec![usize::MAX; plc.facets.len()];
    let mut n_parts = 0;
    for first in 0..plc.facets.len() {
        if part_of[first] != usize::MAX {
            continue;
        }
        let corners = plc.corners(first);
        let normal = doubled_area(corners).normalize_or_zero();
        let fits = |f: usize| {
            let own = plc.corners(f);
            own.iter().all(|p| (*p - corners[0]).dot(normal).abs() <= tolerance)
                && doubled_area(own).normalize_or_zero().dot(normal) > SAME_NORMAL
                && (plc.facets[f].back, plc.facets[f].front) == (plc.facets[first].back, plc.facets[first].front)
        };
        let mut stack = vec![first];
        part_of[first] = n_parts;
        while let Some(f) = stack.pop() {
            for [a, b] in sides(&plc.facets[f]) {
                let [p, q] = at[&key(a, b)][..] else { continue };
                let other = if p == f { q } else { p };
                if part_of[other] == usize::MAX && fits(other) {
                    part_of[other] = n_parts;
                    stack.push(other);
                }
            }
        }
        n_parts += 1;
    }
    part_of
}

/// The edges between parts, divided.
struct Rim {
    /// Those of the complex, then those on edges.
    vertices: Vec<DVec3>,
    /// By edge, smaller vertex first: the vertices on it, from the first to the second.
    on_edge: HashMap<[VertexId; 2], Vec<VertexId>>,
}

impl Rim {
    fn new(plc: &Plc, part_of: &[usize], n_parts: usize, edge: f64) -> Self {
        let mut at: HashMap<[VertexId; 2], Vec<usize>> = HashMap::new();
        let mut area = vec![0.0; n_parts];
        for (f, facet) in plc.facets.iter().enumerate() {
            area[part_of[f]] += doubled_area(plc.corners(f)).length() / 2.0;
            sides(facet).iter().for_each(|[a, b]| at.entry(key(*a, *b)).or_default().push(part_of[f]));
        }
        at.retain(|_, parts| !matches!(parts[..], [p, q] if p == q));
        let length = |[a, b]: &[VertexId; 2]| plc.vertices[a.index()].distance(plc.vertices[b.index()]);
        let mut perimeter = vec![0.0; n_parts];
        at.iter().for_each(|(e, parts)| parts.iter().for_each(|&p| perimeter[p] += length(e)));
        let mut edges: Vec<_> = at.into_iter().collect();
        edges.sort_unstable();
        let mut rim = Self { vertices: plc.vertices.clone(), on_edge: HashMap::with_capacity(edges.len()) };
        for (ends, parts) in edges {
            let narrow = parts.iter().map(|&p| ASPECT * 2.0 * area[p] / perimeter[p]).fold(edge, f64::min);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of pieces")]
            let n = (length(&ends) / narrow.max(SHORTEST * edge)).ceil() as usize;
            let [a, b] = ends.map(|v| plc.vertices[v.index()]);
            let between = (1..n).map(|k| {
                rim.vertices.push(a.lerp(b, k as f64 / n as f64));
                VertexId::new(rim.vertices.len() - 1)
            });
            let between = between.collect();
            rim.on_edge.insert(ends, between);
        }
        rim
    }

    /// The pieces of an edge in its direction; none if it is no edge between parts.
    fn pieces(&self, [from, to]: [VertexId; 2]) -> Vec<[VertexId; 2]> {
        let Some(between) = self.on_edge.get(&key(from, to)) else { return Vec::new() };
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

struct Part<'a> {
    plc: &'a Plc,
    rim: &'a Rim,
    facets: &'a [usize],
    edge: f64,
}

impl Part<'_> {
    fn triangulate(&self, keep: &[VertexId], new: &mut Plc) -> Result<(), DVec3> {
        let model = self.plc.facets[self.facets[0]];
        let own = self.facets.iter().map(|&f| &self.plc.facets[f]);
        let rim: Vec<[VertexId; 2]> = own.clone().flat_map(sides).flat_map(|e| self.rim.pieces(e)).collect();
        let mut nodes: BTreeSet<VertexId> = rim.iter().flatten().copied().collect();
        nodes.extend(own.flat_map(|f| f.vertices).filter(|v| keep.contains(v)));
        let mut nodes: Vec<VertexId> = nodes.into_iter().collect();
        let [origin, ..] = self.plc.corners(self.facets[0]);
        let normal = doubled_area(self.plc.corners(self.facets[0])).normalize_or_zero();
        let (u, v) = axes(normal);
        let flat = |p: DVec3| DVec2::new((p - origin).dot(u), (p - origin).dot(v));
        let mut cdt = Cdt::new();
        let mut handles: HashMap<VertexId, FixedVertexHandle> = HashMap::new();
        for (k, &node) in nodes.iter().enumerate() {
            let p = flat(new.vertices[node.index()]);
            let handle = cdt.insert(Point2::new(p.x, p.y)).ok().filter(|h| h.index() == k);
            handles.insert(node, handle.ok_or(new.vertices[node.index()])?);
        }
        for [a, b] in &rim {
            if !cdt.can_add_constraint(handles[a], handles[b]) {
                return Err(new.vertices[a.index()]);
            }
            cdt.add_constraint(handles[a], handles[b]);
        }
        let parameters = RefinementParameters::new()
            .keep_constraint_edges()
            .with_angle_limit(AngleLimit::from_deg(MIN_ANGLE_DEG))
            .with_max_allowed_area(3.0_f64.sqrt() / 4.0 * self.edge * self.edge)
            .with_max_additional_vertices(MOST_POINTS);
        cdt.refine(parameters);
        for vertex in cdt.vertices().skip(nodes.len()) {
            let p = vertex.position();
            new.vertices.push(origin + u * p.x + v * p.y);
            nodes.push(VertexId::new(new.vertices.len() - 1));
        }
        let triangles: Vec<[VertexId; 3]> =
            cdt.inner_faces().map(|f| f.vertices().map(|v| nodes[v.fix().index()])).collect();
        new.facets.extend(within(&triangles, &rim).into_iter().map(|vertices| Facet { vertices, ..model }));
        Ok(())
    }
}

/// Two directions across a normal, counter-clockwise about it; coordinate axes where it is one.
fn axes(normal: DVec3) -> (DVec3, DVec3) {
    let axis = normal.abs().max_position();
    let mut along = DVec3::ZERO;
    along[(axis + 1) % 3] = 1.0;
    let u = (along - normal * normal.dot(along)).normalize_or_zero();
    (u, normal.cross(u))
}

/// The triangles to the left of a rim.
fn within(triangles: &[[VertexId; 3]], rim: &[[VertexId; 2]]) -> Vec<[VertexId; 3]> {
    let turns = |t: [VertexId; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let left: HashMap<[VertexId; 2], usize> =
        triangles.iter().enumerate().flat_map(|(k, &t)| turns(t).map(|e| (e, k))).collect();
    let walls: HashSet<[VertexId; 2]> = rim.iter().map(|[a, b]| key(*a, *b)).collect();
    let mut stack: Vec<usize> = rim.iter().filter_map(|e| left.get(e).copied()).collect();
    let mut is_within = vec![false; triangles.len()];
    while let Some(k) = stack.pop() {
        if std::mem::replace(&mut is_within[k], true) {
            continue;
        }
        for [a, b] in turns(triangles[k]) {
            if !walls.contains(&key(a, b)) {
                stack.extend(left.get(&[b, a]));
            }
        }
    }
    triangles.iter().zip(is_within).filter(|(_, within)| *within).map(|(t, _)| *t).collect()
}

/// Leaves out vertices that no facet has.
fn compact(plc: Plc) -> Plc {
    let mut number = vec![None; plc.vertices.len()];
    let mut vertices = Vec::new();
    let facet = |f: &Facet| Facet {
        vertices: f.vertices.map(|v| {
            *number[v.index()].get_or_insert_with(|| {
                vertices.push(plc.vertices[v.index()]);
                VertexId::new(vertices.len() - 1)
            })
        }),
        ..*f
    };
    let facets = plc.facets.iter().map(facet).collect();
    Plc { vertices, facets, regions: plc.regions }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antenna::{flat_complex, params};

    #[test]
    fn a_complex_keeps_its_shape_and_gets_edges_of_the_wanted_size() {
        let plc = flat_complex(&params::tests::paper()).expect("the paper's antenna");
        let new = remesh(&plc, &[], 1e-3, 1e-9).expect("flat parts");
        assert_eq!(new.check(), Ok(()), "closed");
        for (id, region) in plc.solids() {
            let ratio = new.boundary(id).volume() / plc.boundary(id).volume();
            assert!((ratio - 1.0).abs() < 1e-9, "{}: {ratio}", region.name);
        }
        let longest = new.facets.iter().flat_map(sides).map(|e| {
            let [a, b] = e.map(|v| new.vertices[v.index()]);
            a.distance(b)
        });
        let longest = longest.fold(0.0, f64::max);
        assert!(longest < 2e-3, "{longest:e}");
    }
}
