//! Where vertices and edges of bodies lie on edges and faces of others: nodes that both must have.

use super::{Soup, watched};
use crate::geometry::DVec3;
use crate::geometry::bvh::{Aabb, Bvh};
use crate::task::{Cancelled, Task};
use std::collections::HashMap;

/// Sine of the angle below which two edges count as parallel: their ends tell then where they meet.
const PARALLEL: f64 = 1e-6;

/// Vertices found so far, none within the tolerance of another.
#[derive(Debug)]
pub(super) struct Merge {
    tolerance: f64,
    /// Vertices by the cell, one tolerance wide, that they lie in.
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl Merge {
    pub(super) fn new(tolerance: f64) -> Self {
        Self { tolerance, cells: HashMap::new() }
    }

    /// The vertex within the tolerance of a place, which is made where there is none.
    pub(super) fn vertex(&mut self, p: DVec3, vertices: &mut Vec<DVec3>) -> usize {
        #[allow(
            clippy::cast_possible_truncation,
            reason = "saturates far from any antenna, where cells merely fill up"
        )]
        let cell = (p / self.tolerance).floor().to_array().map(|c| c as i64);
        let around = (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]);
        let near = around
            .filter_map(|d| self.cells.get(&[0, 1, 2].map(|k| cell[k].saturating_add(d[k]))))
            .flatten()
            .copied()
            .filter(|&v| vertices[v].distance(p) <= self.tolerance)
            .min_by(|&a, &b| vertices[a].distance(p).total_cmp(&vertices[b].distance(p)).then(a.cmp(&b)));
        near.unwrap_or_else(|| {
            vertices.push(p);
            self.cells.entry(cell).or_default().push(vertices.len() - 1);
            vertices.len() - 1
        })
    }
}

/// Nodes on edges and in faces.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    /// By edge, smaller vertex first: the nodes on it, from the first to the second.
    on_edge: HashMap<[usize; 2], Vec<usize>>,
    /// By face.
    pub(super) in_face: Vec<Vec<usize>>,
}

impl Nodes {
    /// The vertices along an edge, its first but not its last.
    pub(super) fn along(&self, from: usize, to: usize) -> Vec<usize> {
        let between = self.on_edge.get(&key(from, to)).map_or(&[][..], |n| n);
        let mut along = vec![from];
        if from < to {
            along.extend(between);
        } else {
            along.extend(between.iter().rev());
        }
        along
    }
}

pub(super) fn key(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

fn sides([a, b, c]: [usize; 3]) -> [[usize; 2]; 3] {
    [key(a, b), key(b, c), key(c, a)]
}

/// Finds all nodes; where edges cross there are new vertices.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn imprint(soup: &mut Soup, mut merge: Merge, tolerance: f64, task: &Task) -> Result<Nodes, Cancelled> {
    let mut edges: Vec<[usize; 2]> = soup.faces.iter().flat_map(|f| sides(f.corners)).collect();
    edges.sort_unstable();
    edges.dedup();
    let ends = |soup: &Soup, e: usize| edges[e].map(|v| soup.vertices[v]);
    let boxes: Vec<Aabb> = (0..edges.len()).map(|e| wide(&ends(soup, e), tolerance)).collect();
    let tree = Bvh::new(boxes.clone());
    let mut on_edge: Vec<Vec<usize>> = vec![Vec::new(); edges.len()];
    for watched in watched("finding crossings", &edges, task) {
        let (e, _) = watched?;
        let mut met = Vec::new();
        tree.for_each_meeting(&boxes[e], |f| {
            if f > e && !edges[f].iter().any(|v| edges[e].contains(v)) {
                met.push(f);
            }
        });
        met.sort_unstable();
        for f in met {
            if let Some(place) = crossing(ends(soup, e), ends(soup, f), tolerance) {
                let v = merge.vertex(place, &mut soup.vertices);
                [e, f].into_iter().filter(|&e| !edges[e].contains(&v)).for_each(|e| on_edge[e].push(v));
            }
        }
    }
    for watched in watched("finding contacts", &soup.vertices, task) {
        let (v, &p) = watched?;
        tree.for_each_meeting(&wide(&[p], tolerance), |e| {
            if !edges[e].contains(&v) && is_on_edge(p, ends(soup, e), tolerance) {
                on_edge[e].push(v);
            }
        });
    }
    for (nodes, &[a, b]) in on_edge.iter_mut().zip(&edges) {
        let direction = soup.vertices[b] - soup.vertices[a];
        let along = |v: &usize| (soup.vertices[*v] - soup.vertices[a]).dot(direction);
        nodes.sort_by(|v, w| along(v).total_cmp(&along(w)).then(v.cmp(w)));
        nodes.dedup();
    }
    let on_edge = edges.iter().copied().zip(on_edge).filter(|(_, nodes)| !nodes.is_empty()).collect();
    let mut nodes = Nodes { on_edge, in_face: Vec::new() };
    nodes.in_face = inner_nodes(soup, &nodes, tolerance, task)?;
    Ok(nodes)
}

/// By face, the vertices that lie in it and not on its edges.
fn inner_nodes(soup: &Soup, nodes: &Nodes, tolerance: f64, task: &Task) -> Result<Vec<Vec<usize>>, Cancelled> {
    let corners = |f: usize| soup.faces[f].corners.map(|v| soup.vertices[v]);
    let boxes = (0..soup.faces.len()).map(|f| wide(&corners(f), tolerance)).collect();
    let tree = Bvh::new(boxes);
    let mut in_face = vec![Vec::new(); soup.faces.len()];
    for watched in watched("finding contacts", &soup.vertices, task) {
        let (v, &p) = watched?;
        tree.for_each_meeting(&wide(&[p], 0.0), |f| {
            let face = soup.faces[f].corners;
            let is_on_rim = || sides(face).iter().any(|e| nodes.on_edge.get(e).is_some_and(|n| n.contains(&v)));
            if !face.contains(&v) && is_in_face(p, corners(f), tolerance) && !is_on_rim() {
                in_face[f].push(v);
            }
        });
    }
    Ok(in_face)
}

fn wide(points: &[DVec3], by: f64) -> Aabb {
    let Aabb { lo, hi } = Aabb::around(points);
    Aabb { lo: lo - by, hi: hi + by }
}

/// Where two edges cross: the middle of their shortest connection, if both have it between their ends.
fn crossing([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], tolerance: f64) -> Option<DVec3> {
    let (u, v, w) = (b - a, d - c, a - c);
    let normal = u.cross(v);
    let square = normal.length_squared();
    if square <= PARALLEL * PARALLEL * u.length_squared() * v.length_squared() {
        return None;
    }
    let (s, t) = (v.cross(w).dot(normal) / square, u.cross(w).dot(normal) / square);
    let (p, q) = (a + u * s, c + v * t);
    let is_between = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    let is_at_end =
        [a, b].iter().any(|e| e.distance(p) <= tolerance) || [c, d].iter().any(|e| e.distance(q) <= tolerance);
    (is_between && !is_at_end && p.distance(q) <= tolerance).then(|| p.midpoint(q))
}

fn is_on_edge(p: DVec3, [a, b]: [DVec3; 2], tolerance: f64) -> bool {
    let along = b - a;
    let part = (p - a).dot(along) / along.length_squared();
    (0.0..=1.0).contains(&part) && (a + along * part).distance(p) <= tolerance
}

fn is_in_face(p: DVec3, [a, b, c]: [DVec3; 3], tolerance: f64) -> bool {
    let normal = (b - a).cross(c - a);
    let is_left = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal) > 0.0;
    (p - a).dot(normal).abs() <= tolerance * normal.length() && is_left(a, b) && is_left(b, c) && is_left(c, a)
}
