//! Makes the worst tetrahedra better: flips, moves of free vertices, and new vertices in slivers held by the surface.
//!
//! The measure is the mean ratio, cubed. Nothing touches the surface, and every step raises the smallest ratio of the
//! tetrahedra it changes, so the mesh never gets worse anywhere that counts. At the end the smallest tetrahedra, which
//! rule the time step of a field solver, are given room where that costs no shape.

use super::delaunay::Triangulation;
use super::error::TetError;
use super::flip::Wanted;
use super::shape::{cubed, cubed_ratio, exact_ratio, inradius};
use super::store::{EDGES, Ring};
use crate::geometry::{DVec3, TetId, VertexId};
use crate::task::Task;

/// Passes: the first ones over all vertices, then those at bad tetrahedra, with new vertices every second time.
const PASSES: usize = 14;
const SMOOTHING_PASSES: usize = 3;
/// Cubed ratio below which flips are tried, in the first passes and later.
const FLIP_BELOW: [f64; 2] = [cubed(0.6), cubed(0.5)];
/// Cubed ratio below which a vertex is moved by search.
const SEARCH_BELOW: f64 = cubed(0.55);
/// Cubed ratio below which a sliver's edge is divided.
const DIVIDE_BELOW: f64 = cubed(0.38);
/// A division must raise the cubed ratio by this factor: less would not pay for one more vertex.
const DIVISION_GAIN: f64 = 1.06;
/// Share of the tetrahedra whose inradius is raised at the end, and rounds of that.
const SMALLEST: f64 = 0.002;
const WIDENING_PASSES: usize = 4;
/// Cubed ratio that widening may fall to in a star that is better.
const WIDEN_ABOVE: f64 = cubed(0.6);
/// Steps of the search for a better place, halving where nothing helps.
const SEARCH_STEPS: usize = 6;
/// Shares of the way from the middle of a sliver's edge to its ring at which a new vertex is tried.
const LIFTS: [f64; 6] = [0.15, 0.3, 0.45, 0.6, 0.75, 0.9];

/// Directions of the search: the axes and four diagonals.
const DIRECTIONS: [DVec3; 10] = [
    DVec3::X,
    DVec3::NEG_X,
    DVec3::Y,
    DVec3::NEG_Y,
    DVec3::Z,
    DVec3::NEG_Z,
    DVec3::new(0.6, 0.6, 0.6),
    DVec3::new(-0.6, -0.6, -0.6),
    DVec3::new(0.6, -0.6, 0.6),
    DVec3::new(-0.6, 0.6, -0.6),
];

/// The mesh while it is optimised.
pub(super) struct Optimiser<'a> {
    mesh: &'a mut Triangulation,
    /// By region number: whether its tetrahedra count.
    is_filled: &'a [bool],
    /// By vertex: whether it may move.
    is_free: Vec<bool>,
}

impl<'a> Optimiser<'a> {
    /// * `is_fixed`: by vertex, true for those of the surface.
    pub(super) fn new(mesh: &'a mut Triangulation, is_filled: &'a [bool], is_fixed: impl Fn(VertexId) -> bool) -> Self {
        let mut is_free: Vec<bool> = (0..mesh.points.len()).map(|v| !is_fixed(VertexId::new(v))).collect();
        for t in mesh.store.tets() {
            if !is_filled[mesh.store.region(t).index()] {
                mesh.store.corners(t).iter().for_each(|v| is_free[v.index()] = false);
            }
        }
        Self { mesh, is_filled, is_free }
    }

    /// Runs all passes.
    ///
    /// # Errors
    /// [`TetError::Cancelled`]; the mesh is then half optimised, but valid.
    pub(super) fn run(&mut self, task: &Task) -> Result<(), TetError> {
        let phase = task.phase("optimising", PASSES);
        for pass in 0..PASSES {
            let smoothing = pass < SMOOTHING_PASSES;
            if !smoothing && pass % 2 == 1 && pass + 2 < PASSES {
                self.divide_slivers(task)?;
            }
            self.flip_bad(FLIP_BELOW[usize::from(!smoothing)], task)?;
            self.move_vertices((!smoothing).then_some(SEARCH_BELOW), task)?;
            phase.advance(1);
        }
        self.flip_bad(FLIP_BELOW[1], task)?;
        for _ in 0..WIDENING_PASSES {
            self.widen(task)?;
        }
        Ok(())
    }

    /// Gives the smallest tetrahedra room: their free vertices go where the smallest inradius around them is largest.
    fn widen(&mut self, task: &Task) -> Result<(), TetError> {
        let mut sized: Vec<(f64, TetId)> = self
            .mesh
            .store
            .tets()
            .filter(|&t| self.counts(t))
            .map(|t| (inradius(self.mesh.corner_points(t)), t))
            .collect();
        sized.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a part of the length")]
        sized.truncate((SMALLEST * sized.len() as f64).ceil() as usize);
        let mut star = Vec::new();
        for (_, t) in sized {
            task.check()?;
            for v in self.mesh.store.corners(t) {
                if self.is_free[v.index()] {
                    self.mesh.store.star(v, &mut star);
                    self.widen_at(v, &star);
                }
            }
        }
        Ok(())
    }

    fn widen_at(&mut self, v: VertexId, star: &[TetId]) {
        let start = self.mesh.point(v);
        let floor = self.worst_at(v, star, start, cubed_ratio).min(WIDEN_ABOVE);
        let before = self.worst_at(v, star, start, inradius);
        let mut best = (before, start);
        let mut step = before;
        for _ in 0..SEARCH_STEPS {
            let from = best.0;
            for direction in DIRECTIONS {
                let p = best.1 + direction * step;
                let least = self.worst_at(v, star, p, inradius);
                if least > best.0 && self.worst_at(v, star, p, exact_ratio) >= floor {
                    best = (least, p);
                }
            }
            if best.0 <= from {
                step *= 0.5;
            }
        }
        self.mesh.points[v.index()] = best.1;
    }

    fn counts(&self, t: TetId) -> bool {
        self.is_filled[self.mesh.store.region(t).index()]
    }

    fn below(&self, ratio: f64) -> Vec<TetId> {
        self.mesh.store.tets().filter(|&t| self.counts(t) && self.mesh.ratio(t) < ratio).collect()
    }

    /// Flips edges and faces of bad tetrahedra away while that helps.
    fn flip_bad(&mut self, below: f64, task: &Task) -> Result<(), TetError> {
        let mut open = self.below(below);
        let mut budget = 40 * open.len() + 1000;
        while let Some(t) = open.pop() {
            if budget == 0 {
                break;
            }
            budget -= 1;
            if budget.is_multiple_of(4096) {
                task.check()?;
            }
            if !self.mesh.store.is_alive(t) || !self.counts(t) || self.mesh.ratio(t) >= below {
                continue;
            }
            let corners = self.mesh.store.corners(t);
            let by_edge =
                EDGES.iter().any(|&(i, j)| self.mesh.remove_edge(t, corners[i], corners[j], Wanted::IfBetter));
            if by_edge || (0..4).any(|i| self.mesh.remove_face(t, i, Wanted::IfBetter)) {
                let made = &self.mesh.made;
                open.extend(made.iter().copied().filter(|&m| self.mesh.ratio(m) < below));
            }
        }
        Ok(())
    }

    /// Moves free vertices: all of them, or those of tetrahedra below a ratio and then by search, too.
    fn move_vertices(&mut self, below: Option<f64>, task: &Task) -> Result<(), TetError> {
        let mut chosen: Vec<VertexId> = match below {
            None => (0..self.is_free.len()).map(VertexId::new).collect(),
            Some(ratio) => self.below(ratio).into_iter().flat_map(|t| self.mesh.store.corners(t)).collect(),
        };
        chosen.retain(|v| self.is_free[v.index()]);
        chosen.sort_unstable();
        chosen.dedup();
        let mut star = Vec::new();
        for (k, v) in chosen.into_iter().enumerate() {
            if k.is_multiple_of(4096) {
                task.check()?;
            }
            self.mesh.store.star(v, &mut star);
            if !star.is_empty() {
                self.move_vertex(v, &star, below.is_some());
            }
        }
        Ok(())
    }

    /// Smallest ratio of the tetrahedra at a vertex if it were at p.
    fn worst_at(&self, v: VertexId, star: &[TetId], p: DVec3, ratio: fn([DVec3; 4]) -> f64) -> f64 {
        let place = |c: VertexId| if c == v { p } else { self.mesh.point(c) };
        star.iter().map(|&t| ratio(self.mesh.store.corners(t).map(place))).fold(1.0, f64::min)
    }

    fn move_vertex(&mut self, v: VertexId, star: &[TetId], search: bool) {
        let start = self.mesh.point(v);
        let before = self.worst_at(v, star, start, cubed_ratio);
        let (mut volume, mut sum) = (0.0, DVec3::ZERO);
        for &t in star {
            let [a, b, c, d] = self.mesh.corner_points(t);
            let part = (b - a).cross(c - a).dot(d - a);
            volume += part;
            sum += (a + b + c + d) * (part / 4.0);
        }
        let target = sum / volume;
        let mut best = (before, start);
        for part in [1.0, 0.5] {
            let p = start + (target - start) * part;
            let worst = self.worst_at(v, star, p, cubed_ratio);
            if worst > best.0 {
                best = (worst, p);
                break;
            }
        }
        if search || best.0 < FLIP_BELOW[1] {
            let mut step = target.distance(start).max(0.05 * (volume / star.len() as f64).abs().cbrt());
            for _ in 0..SEARCH_STEPS {
                let from = best.0;
                for direction in DIRECTIONS {
                    let p = best.1 + direction * step;
                    let worst = self.worst_at(v, star, p, cubed_ratio);
                    if worst > best.0 {
                        best = (worst, p);
                    }
                }
                if best.0 <= from {
                    step *= 0.5;
                }
            }
        }
        if best.0 > before && self.worst_at(v, star, best.1, exact_ratio) > 0.0 {
            self.mesh.points[v.index()] = best.1;
        }
    }

    /// Divides the free edge of tetrahedra that the surface holds flat, by a vertex lifted towards the edge's ring.
    fn divide_slivers(&mut self, task: &Task) -> Result<(), TetError> {
        for t in self.below(DIVIDE_BELOW) {
            task.check()?;
            if !self.mesh.store.is_alive(t) || !self.counts(t) || self.mesh.ratio(t) >= DIVIDE_BELOW {
                continue;
            }
            let before = self.mesh.ratio(t);
            let corners = self.mesh.store.corners(t);
            let mut best: Option<(f64, DVec3, [VertexId; 2])> = None;
            for (i, j) in EDGES {
                let ends = [corners[i], corners[j]];
                let floor = best.map_or(before * DIVISION_GAIN, |b| b.0);
                if let Some((ratio, p)) = self.best_division(t, ends, floor) {
                    best = Some((ratio, p, ends));
                }
            }
            if let Some((_, p, ends)) = best {
                self.divide(t, ends, p);
            }
        }
        Ok(())
    }

    /// The best place for a vertex that divides an edge, if all the halves then exceed `floor`.
    fn best_division(&mut self, t: TetId, [a, b]: [VertexId; 2], floor: f64) -> Option<(f64, DVec3)> {
        let mut ring = Ring::default();
        if !self.mesh.store.ring(t, a, b, &mut ring) || self.mesh.has_wall_at_edge(&ring.tets, a, b) {
            return None;
        }
        let own = self.mesh.store.corners(t);
        let far: Vec<DVec3> = ring.vertices.iter().filter(|v| !own.contains(v)).map(|&v| self.mesh.point(v)).collect();
        let middle = (self.mesh.point(a) + self.mesh.point(b)) / 2.0;
        let target = far.iter().sum::<DVec3>() / far.len().max(1) as f64;
        let mut best = None;
        let mut floor = floor;
        for lift in LIFTS {
            let p = middle + (target - middle) * lift;
            let halves = ring.tets.iter().flat_map(|&t| {
                let corners = self.mesh.store.corners(t);
                [a, b].map(|end| corners.map(|c| if c == end { p } else { self.mesh.point(c) }))
            });
            let worst = halves.map(exact_ratio).fold(1.0, f64::min);
            if worst > floor {
                floor = worst;
                best = Some((worst, p));
            }
        }
        best.filter(|_| !far.is_empty())
    }

    fn divide(&mut self, t: TetId, [a, b]: [VertexId; 2], p: DVec3) {
        let mut ring = Ring::default();
        if !self.mesh.store.ring(t, a, b, &mut ring) {
            return;
        }
        let v = VertexId::new(self.mesh.points.len());
        self.mesh.points.push(p);
        self.mesh.store.add_vertex();
        self.is_free.push(true);
        let halves: Vec<[VertexId; 4]> = ring
            .tets
            .iter()
            .flat_map(|&t| {
                let corners = self.mesh.store.corners(t);
                [a, b].map(|end| corners.map(|c| if c == end { v } else { c }))
            })
            .collect();
        let mut made = std::mem::take(&mut self.mesh.made);
        self.mesh.store.replace(&ring.tets, &halves, &mut made);
        self.mesh.made = made;
    }
}
