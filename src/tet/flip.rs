//! Local changes of the mesh: a face between two tetrahedra gives way to an edge between three, or an edge to the best
//! set of faces across its ring \[KLI80\]. Walls stay, and nothing turns inside out.

use super::delaunay::Triangulation;
use super::shape::{cubed_ratio, exact_ratio};
use super::store::FACE;
use crate::geometry::{TetId, VertexId};

/// Longest ring that is filled anew: the work grows like its cube, the gain falls.
const MAX_RING: usize = 12;
/// A flip must raise the smallest ratio by more than rounding, or two states could alternate for ever.
const GAIN: f64 = 1e-9;

/// When a change is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// Whenever it is valid.
    Always,
    /// When the smallest mean ratio of the tetrahedra concerned grows.
    IfBetter,
}

impl Triangulation {
    /// Mean ratio of a tetrahedron of the mesh.
    pub(super) fn ratio(&self, t: TetId) -> f64 {
        cubed_ratio(self.corner_points(t))
    }

    /// Removes the edge ab of `t` by filling its ring anew; the new tetrahedra are in `made`.
    pub(super) fn remove_edge(&mut self, t: TetId, a: VertexId, b: VertexId, wanted: Wanted) -> bool {
        let mut ring = std::mem::take(&mut self.ring);
        let removed = self.store.ring(t, a, b, &mut ring)
            && (3..=MAX_RING).contains(&ring.vertices.len())
            && !self.has_wall_at_edge(&ring.tets, a, b)
            && self.fill_ring(a, b, &ring.tets, &ring.vertices, wanted);
        self.ring = ring;
        removed
    }

    /// True if a face at the edge ab of one of the tetrahedra around it is a wall.
    pub(super) fn has_wall_at_edge(&self, around: &[TetId], a: VertexId, b: VertexId) -> bool {
        around.iter().any(|&t| {
            let corners = self.store.corners(t);
            (0..4).any(|i| self.store.is_wall(t, i) && corners[i] != a && corners[i] != b)
        })
    }

    fn fill_ring(&mut self, a: VertexId, b: VertexId, tets: &[TetId], ring: &[VertexId], wanted: Wanted) -> bool {
        let floor = match wanted {
            Wanted::Always => 0.0,
            Wanted::IfBetter => tets.iter().map(|&t| self.ratio(t)).fold(f64::INFINITY, f64::min) + GAIN,
        };
        let Some(filling) = self.best_filling(a, b, ring, floor) else { return false };
        self.is_delaunay = false;
        self.store.replace(tets, &filling, &mut self.made);
        self.last = self.made[0];
        true
    }

    /// The triangulation of the ring whose tetrahedra with a and b have the greatest smallest mean ratio, if that
    /// exceeds `floor`; by dynamic programming over the polygon.
    fn best_filling(&self, a: VertexId, b: VertexId, ring: &[VertexId], floor: f64) -> Option<Vec<[VertexId; 4]>> {
        let n = ring.len();
        let mut best = [[f64::INFINITY; MAX_RING]; MAX_RING];
        let mut apex = [[0_usize; MAX_RING]; MAX_RING];
        let [pa, pb] = [a, b].map(|v| self.point(v));
        for span in 2..n {
            for i in 0..n - span {
                let j = i + span;
                (best[i][j], apex[i][j]) = (-1.0, 0);
                for k in i + 1..j {
                    let bound = best[i][k].min(best[k][j]);
                    if bound <= best[i][j].max(floor) {
                        continue;
                    }
                    let [pi, pk, pj] = [i, k, j].map(|m| self.point(ring[m]));
                    let above = exact_ratio([pi, pk, pj, pb]);
                    let ratio = if above > 0.0 { bound.min(above).min(exact_ratio([pk, pi, pj, pa])) } else { -1.0 };
                    if ratio > best[i][j] {
                        (best[i][j], apex[i][j]) = (ratio, k);
                    }
                }
            }
        }
        if best[0][n - 1] <= floor {
            return None;
        }
        let mut filling = Vec::with_capacity(2 * (n - 2));
        let mut spans = vec![(0, n - 1)];
        while let Some((i, j)) = spans.pop() {
            if j - i >= 2 {
                let k = apex[i][j];
                filling.push([ring[i], ring[k], ring[j], b]);
                filling.push([ring[k], ring[i], ring[j], a]);
                spans.extend([(i, k), (k, j)]);
            }
        }
        Some(filling)
    }

    /// Replaces face i of `t` by the edge between the two corners off it: two tetrahedra become three.
    pub(super) fn remove_face(&mut self, t: TetId, i: usize, wanted: Wanted) -> bool {
        let beyond = self.store.neighbor(t, i);
        if beyond == TetId::NONE || self.store.is_wall(t, i) {
            return false;
        }
        let corners = self.store.corners(t);
        let [x, y, z] = FACE[i].map(|k| corners[k]);
        let near = corners[i];
        let far = self.store.corners(beyond)[self.store.face_beyond(t, i)];
        let filling = [[x, y, far, near], [y, z, far, near], [z, x, far, near]];
        let floor = match wanted {
            Wanted::Always => 0.0,
            Wanted::IfBetter => self.ratio(t).min(self.ratio(beyond)) + GAIN,
        };
        if filling.iter().any(|f| exact_ratio(f.map(|v| self.point(v))) <= floor) {
            return false;
        }
        self.is_delaunay = false;
        self.store.replace(&[t, beyond], &filling, &mut self.made);
        self.last = self.made[0];
        true
    }
}
