//! Brings the edges and faces of the surface back into the Delaunay mesh of its vertices.
//!
//! A missing edge is made by flipping away what its line crosses, a missing face by removing the edges that pierce it.
//! An edge that cannot be removed at once first loses neighbors (two levels deep). The whole goes round until nothing
//! is missing, within a budget of operations. Faces that resist get helper points on both sides; at last the edges of
//! what is still missing are halved, and whoever meshed the other side of them halves them too.

use super::delaunay::Triangulation;
use super::error::TetError;
use super::flip::Wanted;
use super::store::{EdgeKey, FACE, Ring, edge_key};
use super::surface::SurfaceFacet;
use crate::geometry::predicates::orient3d;
use crate::geometry::{DVec3, TetId, VertexId};
use crate::task::Task;
use std::collections::HashSet;

/// Rounds over everything that is missing; the first one brings nearly all of it.
const MAX_ROUNDS: usize = 32;
/// From this round on, helper points are put beside faces that resist.
const HELPERS_FROM: usize = 1;
/// From this round on, edges of the surface are halved.
const SPLITS_FROM: usize = 3;
/// Ways tried for one edge before it waits for the next round.
const EDGE_ATTEMPTS: usize = 60;
/// Attempts before an edge may remove others recursively, which costs more.
const DEEP_FROM: usize = 3;
/// Levels of edges removed to make room for the removal of another.
const DEPTH: usize = 2;
/// Operations spent on one edge or facet in one round: what has not come back by then needs another round, or a split.
const BUDGET_PER_ITEM: usize = 600;
/// Operations per facet of the surface, after which the surface is given up: usual ones need a few.
const BUDGET_PER_FACET: usize = 2000;

/// A surface edge that had to be halved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeSplit {
    /// Its ends.
    pub ends: [VertexId; 2],
    /// The new vertex at its middle.
    pub middle: VertexId,
}

/// What recovery took.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecoveryReport {
    /// Surface edges that the Delaunay mesh lacked.
    pub n_missing_edges: usize,
    /// Facets that it lacked.
    pub n_missing_facets: usize,
    /// Points added beside facets that resisted.
    pub n_helpers: usize,
    /// Surface edges that were halved, in this order.
    pub splits: Vec<EdgeSplit>,
}

/// The surface while it is being recovered.
pub(super) struct Recovery<'a> {
    mesh: &'a mut Triangulation,
    /// Facets, divided where edges were halved.
    pub(super) facets: Vec<SurfaceFacet>,
    /// Edges of the facets: never flipped away.
    edges: HashSet<EdgeKey>,
    /// Operations left for the whole surface, and for the edge or facet at hand.
    budget: usize,
    item_budget: usize,
    pub(super) report: RecoveryReport,
}

impl<'a> Recovery<'a> {
    pub(super) fn new(mesh: &'a mut Triangulation, facets: &[SurfaceFacet]) -> Self {
        let edges = facets.iter().flat_map(|f| edges_of(f.vertices)).collect();
        let budget = BUDGET_PER_FACET * facets.len() + 100_000;
        Self { mesh, facets: facets.to_vec(), edges, budget, item_budget: 0, report: RecoveryReport::default() }
    }

    /// Recovers everything.
    ///
    /// # Errors
    /// [`TetError::NotRecovered`] with places, or [`TetError::Cancelled`].
    pub(super) fn run(&mut self, task: &Task) -> Result<(), TetError> {
        let phase = task.phase("recovering the surface", MAX_ROUNDS);
        let mut missing_edges = Vec::new();
        let mut missing_facets = Vec::new();
        for round in 0..MAX_ROUNDS {
            task.check()?;
            let (n_edges, n_facets);
            (n_edges, missing_edges) = self.recover_edges(task)?;
            (n_facets, missing_facets) = self.recover_facets(task)?;
            if round == 0 {
                (self.report.n_missing_edges, self.report.n_missing_facets) = (n_edges, n_facets);
            }
            if n_edges == 0 && n_facets == 0 {
                return Ok(());
            }
            if self.budget == 0 {
                break;
            }
            if round >= SPLITS_FROM {
                self.split_edges(&missing_edges, &missing_facets);
            } else if round >= HELPERS_FROM {
                missing_facets.iter().for_each(|&f| self.add_helpers(f, round));
            }
            phase.advance(1);
        }
        let of_edge = missing_edges.iter().map(|e| (self.mesh.point(e[0]) + self.mesh.point(e[1])) / 2.0);
        let of_facet = missing_facets.iter().map(|&f| self.center(f));
        let places: Vec<DVec3> = of_edge.chain(of_facet).take(TetError::MAX_PLACES).collect();
        Err(TetError::NotRecovered { n_missing: missing_edges.len() + missing_facets.len(), places })
    }

    /// Tries every missing edge; how many were missing, and which still are.
    fn recover_edges(&mut self, task: &Task) -> Result<(usize, Vec<EdgeKey>), TetError> {
        // In a fixed order: a set's own order changes from run to run.
        let mut edges: Vec<EdgeKey> = self.edges.iter().copied().collect();
        edges.sort_unstable();
        let (mut n_missing, mut left) = (0, Vec::new());
        for (k, edge) in edges.into_iter().enumerate() {
            if k.is_multiple_of(1024) {
                task.check()?;
            }
            if self.tet_with(&edge).is_none() {
                n_missing += 1;
                if !self.recover_edge(edge) {
                    left.push(edge);
                }
            }
        }
        Ok((n_missing, left))
    }

    /// Tries every missing facet; how many were missing, and which still are.
    fn recover_facets(&mut self, task: &Task) -> Result<(usize, Vec<usize>), TetError> {
        let (mut n_missing, mut left) = (0, Vec::new());
        for f in 0..self.facets.len() {
            if f.is_multiple_of(1024) {
                task.check()?;
            }
            let corners = self.facets[f].vertices;
            if self.tet_with(&corners).is_none() {
                n_missing += 1;
                if !self.recover_facet(corners) {
                    left.push(f);
                }
            }
        }
        Ok((n_missing, left))
    }

    fn tet_with(&mut self, vertices: &[VertexId]) -> Option<TetId> {
        let mut star = std::mem::take(&mut self.mesh.star);
        let found = self.mesh.store.tet_with(vertices, &mut star);
        self.mesh.star = star;
        found
    }

    fn spend(&mut self) -> bool {
        self.budget = self.budget.saturating_sub(1);
        self.item_budget = self.item_budget.saturating_sub(1);
        self.budget > 0 && self.item_budget > 0
    }

    fn recover_edge(&mut self, edge: EdgeKey) -> bool {
        self.item_budget = BUDGET_PER_ITEM;
        for attempt in 0..EDGE_ATTEMPTS {
            let [a, b] = if attempt % 2 == 0 { edge } else { [edge[1], edge[0]] };
            if self.tet_with(&[a, b]).is_some() {
                return true;
            }
            if !self.spend() {
                return false;
            }
            if !self.clear_way(a, b, attempt >= DEEP_FROM) && attempt % 4 == 3 {
                self.shake(a);
            }
        }
        false
    }

    /// Flips away the first face or edge that the segment from a to b meets.
    fn clear_way(&mut self, a: VertexId, b: VertexId, deep: bool) -> bool {
        let (pa, pb) = (self.mesh.point(a), self.mesh.point(b));
        // `tet_with` has left the star of a here.
        for k in 0..self.mesh.star.len() {
            let t = self.mesh.star[k];
            let Some(i) = self.mesh.store.corner_of(t, a) else { continue };
            if self.mesh.side(t, i, pb) >= 0.0 {
                continue;
            }
            let face = self.mesh.store.face(t, i);
            let turn = |k: usize| orient3d(self.mesh.point(face[k]), self.mesh.point(face[(k + 1) % 3]), pa, pb);
            let turns = [turn(0), turn(1), turn(2)];
            if turns.iter().any(|&s| s > 0.0) && turns.iter().any(|&s| s < 0.0) {
                continue;
            }
            let met: Vec<usize> = (0..3).filter(|&k| turns[k].abs() <= 0.0).collect();
            return match met[..] {
                [] => self.pierce(t, i, face, deep),
                // It meets an edge.
                [k] => self.drop_edge(face[k], face[(k + 1) % 3], deep),
                // It runs through a vertex: nothing that flips could change.
                _ => false,
            };
        }
        false
    }

    /// Removes face i of `t`, or one of its edges.
    fn pierce(&mut self, t: TetId, i: usize, face: [VertexId; 3], deep: bool) -> bool {
        if self.mesh.remove_face(t, i, Wanted::Always) {
            return true;
        }
        let first = self.mesh.pick(3);
        (0..3).map(|k| (first + k) % 3).any(|k| self.drop_edge(face[k], face[(k + 1) % 3], deep))
    }

    fn drop_edge(&mut self, x: VertexId, y: VertexId, deep: bool) -> bool {
        self.remove_deep(x, y, if deep { DEPTH } else { 0 })
    }

    /// Removes an edge; where its ring cannot be filled, first lowers its degree by flipping its faces away or by
    /// removing edges from its ends to the ring. True when the edge is gone.
    fn remove_deep(&mut self, x: VertexId, y: VertexId, depth: usize) -> bool {
        if self.edges.contains(&edge_key(x, y)) {
            return false;
        }
        for _ in 0..12 {
            let Some(t) = self.tet_with(&[x, y]) else { return true };
            if self.mesh.remove_edge(t, x, y, Wanted::Always) {
                return true;
            }
            if depth == 0 || !self.spend() {
                return false;
            }
            let mut ring = Ring::default();
            if !self.mesh.store.ring(t, x, y, &mut ring) {
                return false;
            }
            if !self.lower_degree(x, y, &ring, depth) {
                return false;
            }
        }
        false
    }

    fn lower_degree(&mut self, x: VertexId, y: VertexId, ring: &Ring, depth: usize) -> bool {
        let n = ring.vertices.len();
        let first = self.mesh.pick(n);
        let turn = |k: usize| (first + k) % n;
        if n > 3 {
            for k in (0..n).map(turn) {
                // The face (x, y, ring[k]) of tets[k] is opposite ring[k + 1].
                let t = ring.tets[k];
                let Some(i) = self.mesh.store.corner_of(t, ring.vertices[(k + 1) % n]) else { continue };
                if self.mesh.remove_face(t, i, Wanted::Always) {
                    return true;
                }
            }
        }
        (0..n).map(turn).any(|k| {
            let r = ring.vertices[k];
            self.remove_deep(x, r, depth - 1) || self.remove_deep(y, r, depth - 1)
        })
    }

    /// A random flip at a vertex, to get out of a dead end.
    fn shake(&mut self, a: VertexId) {
        let Some(_) = self.tet_with(&[a]) else { return };
        let k = self.mesh.pick(self.mesh.star.len());
        let (t, i) = (self.mesh.star[k], self.mesh.pick(4));
        self.mesh.remove_face(t, i, Wanted::Always);
    }

    fn recover_facet(&mut self, facet: [VertexId; 3]) -> bool {
        self.item_budget = BUDGET_PER_ITEM;
        for _ in 0..20 {
            if self.tet_with(&facet).is_some() {
                return true;
            }
            if !self.spend() {
                return false;
            }
            let [a, b, c] = facet;
            if ![[a, b, c], [b, c, a], [c, a, b]].into_iter().any(|f| self.remove_piercing(f)) {
                return false;
            }
        }
        false
    }

    /// Removes the edge of the ring around ab that pierces the triangle abc.
    fn remove_piercing(&mut self, [a, b, c]: [VertexId; 3]) -> bool {
        let Some(t) = self.tet_with(&[a, b]) else { return false };
        let mut ring = Ring::default();
        if !self.mesh.store.ring(t, a, b, &mut ring) {
            return false;
        }
        let side =
            |v: VertexId| orient3d(self.mesh.point(a), self.mesh.point(b), self.mesh.point(v), self.mesh.point(c));
        let n = ring.vertices.len();
        let pierced = (0..n).find(|&k| side(ring.vertices[k]) > 0.0 && side(ring.vertices[(k + 1) % n]) < 0.0);
        pierced.is_some_and(|k| self.remove_deep(ring.vertices[k], ring.vertices[(k + 1) % n], DEPTH))
    }

    fn center(&self, facet: usize) -> DVec3 {
        self.facets[facet].vertices.iter().map(|&v| self.mesh.point(v)).sum::<DVec3>() / 3.0
    }

    /// Puts a point on either side of a facet that resists, a little nearer or farther each round.
    fn add_helpers(&mut self, facet: usize, round: usize) {
        let corners = self.facets[facet].vertices;
        let [a, b, c] = corners.map(|v| self.mesh.point(v));
        let doubled_area = (b - a).cross(c - a);
        let Some(normal) = doubled_area.try_normalize() else { return };
        let height = (0.35 + 0.1 * (round % 3) as f64) * 1.3 * doubled_area.length().sqrt();
        for side in [1.0, -1.0] {
            if self.insert(self.center(facet) + normal * (side * height), corners[0]).is_some() {
                self.report.n_helpers += 1;
            }
        }
    }

    /// Puts a new point into the mesh, searching from a vertex near it.
    fn insert(&mut self, p: DVec3, near: VertexId) -> Option<VertexId> {
        let v = VertexId::new(self.mesh.points.len());
        self.mesh.points.push(p);
        self.mesh.store.add_vertex();
        self.mesh.last = self.mesh.store.at_vertex(near).unwrap_or(self.mesh.last);
        self.mesh.is_delaunay = false;
        if self.mesh.insert(v) {
            return Some(v);
        }
        self.mesh.points.pop();
        self.mesh.store.drop_vertex();
        None
    }

    /// Halves the missing edges, and of each missing facet without one its longest edge.
    fn split_edges(&mut self, missing_edges: &[EdgeKey], missing_facets: &[usize]) {
        let mut chosen: Vec<EdgeKey> = missing_edges.to_vec();
        for &f in missing_facets {
            let edges = edges_of(self.facets[f].vertices);
            if !edges.iter().any(|e| chosen.contains(e)) {
                let length = |e: &EdgeKey| self.mesh.point(e[0]).distance_squared(self.mesh.point(e[1]));
                chosen.extend(edges.into_iter().max_by(|p, q| length(p).total_cmp(&length(q))));
            }
        }
        chosen.sort_unstable();
        chosen.dedup();
        for edge in chosen {
            let middle = (self.mesh.point(edge[0]) + self.mesh.point(edge[1])) / 2.0;
            let Some(v) = self.insert(middle, edge[0]) else { continue };
            self.report.splits.push(EdgeSplit { ends: edge, middle: v });
            self.edges.remove(&edge);
            for f in 0..self.facets.len() {
                let facet = self.facets[f];
                if edge.iter().all(|e| facet.vertices.contains(e)) {
                    // Each half takes over orientation, regions and group.
                    let half = |end: VertexId| SurfaceFacet {
                        vertices: facet.vertices.map(|c| if c == end { v } else { c }),
                        ..facet
                    };
                    let halves = edge.map(half);
                    self.edges.extend(halves.iter().flat_map(|h| edges_of(h.vertices)));
                    self.facets[f] = halves[0];
                    self.facets.push(halves[1]);
                }
            }
        }
    }
}

fn edges_of([a, b, c]: [VertexId; 3]) -> [EdgeKey; 3] {
    [edge_key(a, b), edge_key(b, c), edge_key(c, a)]
}

/// Makes every facet a wall.
///
/// # Errors
/// [`TetError::NotRecovered`] if one is not a face of the mesh.
pub(super) fn raise_walls(mesh: &mut Triangulation, facets: &[SurfaceFacet]) -> Result<(), TetError> {
    let mut star = std::mem::take(&mut mesh.star);
    for facet in facets {
        let found = mesh.store.tet_with(&facet.vertices, &mut star);
        let t = found.ok_or_else(|| TetError::NotRecovered {
            n_missing: 1,
            places: vec![facet.vertices.iter().map(|&v| mesh.point(v)).sum::<DVec3>() / 3.0],
        })?;
        let opposite = FACE.iter().position(|f| f.iter().all(|&k| facet.vertices.contains(&mesh.store.corners(t)[k])));
        if let Some(i) = opposite {
            mesh.store.set_wall(t, i);
        }
    }
    mesh.star = star;
    Ok(())
}
