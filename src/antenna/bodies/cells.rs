//! Faces cut along everything that lies in them, so that faces that touch are made of the same triangles.
//!
//! A face with nodes is triangulated in its own plane with its rim and all edges between its nodes as constraints. The
//! constraints divide it into cells. A cell in which two faces lie on each other has the same nodes in both, but its
//! triangles could differ (four nodes on a circle); so the triangles of a cell are those of the face that came first.

use super::imprint::{Nodes, key};
use super::inspect::add_place;
use super::{Body, BodyFault, Face, Soup, watched};
use crate::geometry::{DVec2, DVec3};
use crate::task::{Cancelled, Task};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, handles::FixedVertexHandle};
use std::collections::{BTreeMap, HashMap, HashSet};

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;
/// The triangles of a cell by its sorted nodes.
type Known = HashMap<Vec<usize>, Vec<[usize; 3]>>;

/// Faces cut at their nodes, and what cannot be cut.
type Pieces = (Vec<Face>, Vec<BodyFault>);

/// Cuts all faces at their nodes; which cannot be cut is a fault.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn cut(soup: &Soup, nodes: &Nodes, bodies: &[Body], task: &Task) -> Result<Pieces, Cancelled> {
    let neighbors = neighbors(soup, nodes);
    let (mut faces, mut known, mut unfit) = (Vec::new(), Known::new(), BTreeMap::new());
    for watched in watched("cutting faces", &soup.faces, task) {
        let (f, face) = watched?;
        let [a, b, c] = face.corners;
        let rim: Vec<usize> = [[a, b], [b, c], [c, a]].into_iter().flat_map(|[p, q]| nodes.along(p, q)).collect();
        if rim.len() == 3 && nodes.in_face[f].is_empty() {
            faces.push(*face);
            continue;
        }
        let rim = without_spikes(rim);
        if rim.len() < 3 {
            continue;
        }
        let corners = face.corners.map(|v| soup.vertices[v]);
        match (Cut { soup, neighbors: &neighbors, corners }).cells(&rim, &nodes.in_face[f]) {
            Some(cells) => {
                let triangles = cells.into_iter().flat_map(|cell| as_known(cell, &mut known, soup, corners));
                faces.extend(triangles.map(|corners| Face { corners, body: face.body }));
            }
            None => add_place(unfit.entry(face.body).or_default(), corners.iter().sum::<DVec3>() / 3.0),
        }
    }
    let fault = |(body, (count, places)): (usize, (usize, Vec<DVec3>))| BodyFault::Unfit {
        body: bodies[body].name.clone(),
        count,
        places,
    };
    Ok((faces, unfit.into_iter().map(fault).collect()))
}

/// For each vertex the others at the ends of pieces of edges.
fn neighbors(soup: &Soup, nodes: &Nodes) -> HashMap<usize, Vec<usize>> {
    let mut pieces = HashSet::new();
    for face in &soup.faces {
        for k in 0..3 {
            let (from, to) = (face.corners[k], face.corners[(k + 1) % 3]);
            let mut along = nodes.along(from, to);
            along.push(to);
            pieces.extend(along.windows(2).map(|w| key(w[0], w[1])));
        }
    }
    let mut neighbors: HashMap<usize, Vec<usize>> = HashMap::new();
    for [a, b] in pieces {
        neighbors.entry(a).or_default().push(b);
        neighbors.entry(b).or_default().push(a);
    }
    neighbors.values_mut().for_each(|list| list.sort_unstable());
    neighbors
}

/// A rim without pieces that are run there and back at once: what is left where a face is thinner than the tolerance.
fn without_spikes(rim: Vec<usize>) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(rim.len());
    for v in rim {
        if kept.len() >= 2 && kept[kept.len() - 2] == v {
            kept.pop();
        } else if kept.last() != Some(&v) {
            kept.push(v);
        }
    }
    loop {
        let n = kept.len();
        if n >= 2 && kept[0] == kept[n - 1] {
            kept.pop();
        } else if n >= 3 && kept[0] == kept[n - 2] {
            kept.truncate(n - 2);
        } else if n >= 3 && kept[1] == kept[n - 1] {
            kept.remove(0);
            kept.pop();
        } else {
            return kept;
        }
    }
}

/// The triangles of a cell as the first face had them that it belongs to, outward of this face.
fn as_known(cell: Vec<[usize; 3]>, known: &mut Known, soup: &Soup, corners: [DVec3; 3]) -> Vec<[usize; 3]> {
    let mut nodes: Vec<usize> = cell.iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let first = known.entry(nodes).or_insert(cell);
    let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let total: DVec3 = first.iter().map(|t| area(t.map(|v| soup.vertices[v]))).sum();
    let is_turned = total.dot(area(corners)) < 0.0;
    first.iter().map(|&[a, b, c]| if is_turned { [a, c, b] } else { [a, b, c] }).collect()
}

struct Cut<'a> {
    soup: &'a Soup,
    neighbors: &'a HashMap<usize, Vec<usize>>,
    corners: [DVec3; 3],
}

impl Cut<'_> {
    /// The triangles within the rim, cell by cell; `None` if edges cross without a node.
    fn cells(&self, rim: &[usize], inner: &[usize]) -> Option<Vec<Vec<[usize; 3]>>> {
        let nodes: Vec<usize> = rim.iter().chain(inner).copied().collect();
        let mut cdt = Cdt::new();
        let mut handles: HashMap<usize, FixedVertexHandle> = HashMap::new();
        for (k, &v) in nodes.iter().enumerate() {
            let p = self.flat(self.soup.vertices[v]);
            let handle = cdt.insert(Point2::new(p.x, p.y)).ok()?;
            // Two nodes in one place, or one twice in the rim.
            if handle.index() != k || handles.insert(v, handle).is_some() {
                return None;
            }
        }
        let mut constrain = |from: usize, to: usize| {
            let (from, to) = (handles[&from], handles[&to]);
            let is_free = cdt.can_add_constraint(from, to);
            is_free && {
                cdt.add_constraint(from, to);
                true
            }
        };
        for k in 0..rim.len() {
            constrain(rim[k], rim[(k + 1) % rim.len()]).then_some(())?;
        }
        for &v in &nodes {
            let others = self.neighbors.get(&v).map_or(&[][..], |list| list);
            for &w in others.iter().filter(|w| **w > v && nodes.contains(w)) {
                constrain(v, w).then_some(())?;
            }
        }
        let cells = divide(&cdt, &nodes, rim);
        (!cells.is_empty()).then_some(cells)
    }

    /// In the plane of the two axes that the face is most upright to, counter-clockwise as the face is.
    fn flat(&self, p: DVec3) -> DVec2 {
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(c - a);
        let axis = normal.abs().max_position();
        let flat = DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
        if normal[axis] > 0.0 { flat } else { DVec2::new(flat.y, flat.x) }
    }
}

/// The triangles to the left of the rim, in cells that constraints bound.
fn divide(cdt: &Cdt, nodes: &[usize], rim: &[usize]) -> Vec<Vec<[usize; 3]>> {
    let triangles: Vec<[usize; 3]> = cdt.inner_faces().map(|f| f.vertices().map(|v| nodes[v.index()])).collect();
    let mut left: HashMap<[usize; 2], usize> = HashMap::new();
    for (t, corners) in triangles.iter().enumerate() {
        left.extend((0..3).map(|k| ([corners[k], corners[(k + 1) % 3]], t)));
    }
    let walls: HashSet<[usize; 2]> = cdt
        .undirected_edges()
        .filter(|e| e.is_constraint_edge())
        .map(|e| e.vertices().map(|v| nodes[v.index()]))
        .map(|[a, b]| key(a, b))
        .collect();
    let outline: HashSet<[usize; 2]> = (0..rim.len()).map(|k| key(rim[k], rim[(k + 1) % rim.len()])).collect();
    let mut cell_of: Vec<Option<usize>> = vec![None; triangles.len()];
    let mut cells: Vec<Vec<[usize; 3]>> = Vec::new();
    // Triangles to begin a cell with: those at the rim, then those behind a wall of a cell.
    let mut begin: Vec<usize> =
        (0..rim.len()).filter_map(|k| left.get(&[rim[k], rim[(k + 1) % rim.len()]]).copied()).collect();
    while let Some(first) = begin.pop() {
        if cell_of[first].is_some() {
            continue;
        }
        let mut stack = vec![first];
        cells.push(Vec::new());
        while let Some(t) = stack.pop() {
            if cell_of[t].is_some() {
                continue;
            }
            cell_of[t] = Some(cells.len() - 1);
            cells.last_mut().expect("just begun").push(triangles[t]);
            for k in 0..3 {
                let (from, to) = (triangles[t][k], triangles[t][(k + 1) % 3]);
                let Some(&next) = left.get(&[to, from]) else { continue };
                match (outline.contains(&key(from, to)), walls.contains(&key(from, to))) {
                    (true, _) => {}
                    (false, true) => begin.push(next),
                    (false, false) => stack.push(next),
                }
            }
        }
    }
    cells
}
