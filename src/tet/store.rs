//! Tetrahedra and their neighbors. Connectivity only: this file never sees a coordinate.
//!
//! Every change of the mesh, insertion or flip, is one [`Store::replace`]: some tetrahedra give way to others that fill
//! the same polyhedron. Faces are matched by their corners; walls (faces of the surface) and the region are inherited.

use crate::geometry::{RegionId, TetId, VertexId};

/// Corners of face i (opposite corner i) of a positive tetrahedron: with corner i as fourth they are positive again.
pub(super) const FACE: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// The six edges of a tetrahedron by its corners.
pub(super) const EDGES: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

/// A face by its corners in ascending order.
type FaceKey = [VertexId; 3];

/// An edge by its ends, the smaller first.
pub(super) type EdgeKey = [VertexId; 2];

pub(super) fn edge_key(a: VertexId, b: VertexId) -> EdgeKey {
    if a < b { [a, b] } else { [b, a] }
}

fn face_key(corners: [VertexId; 4], i: usize) -> FaceKey {
    let [mut a, mut b, mut c] = FACE[i].map(|k| corners[k]);
    if a > b {
        std::mem::swap(&mut a, &mut b);
    }
    if b > c {
        std::mem::swap(&mut b, &mut c);
    }
    if a > b {
        std::mem::swap(&mut a, &mut b);
    }
    [a, b, c]
}

/// The tetrahedra around an edge ab, and the vertices around it: (a, b, `vertices[k]`, `vertices[k + 1]`) is `tets[k]`,
/// positively oriented.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    pub(super) tets: Vec<TetId>,
    pub(super) vertices: Vec<VertexId>,
}

/// One side of a face, while [`Store::replace`] matches them.
#[derive(Clone, Copy, Debug)]
struct Side {
    key: FaceKey,
    tet: TetId,
    face: usize,
    /// Some for the tetrahedron beyond the polyhedron: whether the face is a wall.
    outer: Option<bool>,
}

/// The tetrahedra.
#[derive(Clone, Debug, Default)]
pub(super) struct Store {
    /// Corners; the first is `NONE` for a free slot.
    corners: Vec<[VertexId; 4]>,
    /// Neighbor beyond each face; `NONE` on the hull.
    neighbors: Vec<[TetId; 4]>,
    /// Bit i: face i belongs to the surface.
    walls: Vec<u8>,
    regions: Vec<RegionId>,
    free: Vec<TetId>,
    /// A tetrahedron at each vertex; `NONE` for a vertex that is not in the mesh.
    at_vertex: Vec<TetId>,
    marks: Vec<u32>,
    stamp: u32,
    sides: Vec<Side>,
}

impl Store {
    /// A store for vertices `0..n`, holding one tetrahedron.
    pub(super) fn new(n_vertices: usize, first: [VertexId; 4]) -> Self {
        let mut store = Self { at_vertex: vec![TetId::NONE; n_vertices], ..Self::default() };
        let t = store.allocate(first, RegionId::default());
        first.iter().for_each(|v| store.at_vertex[v.index()] = t);
        store
    }

    /// Makes room for one more vertex.
    pub(super) fn add_vertex(&mut self) {
        self.at_vertex.push(TetId::NONE);
    }

    /// Takes the vertex added last back; it must not be in the mesh.
    pub(super) fn drop_vertex(&mut self) {
        self.at_vertex.pop();
    }

    pub(super) fn corners(&self, t: TetId) -> [VertexId; 4] {
        self.corners[t.index()]
    }

    pub(super) fn neighbor(&self, t: TetId, i: usize) -> TetId {
        self.neighbors[t.index()][i]
    }

    pub(super) fn is_alive(&self, t: TetId) -> bool {
        self.corners[t.index()][0] != VertexId::NONE
    }

    pub(super) fn is_wall(&self, t: TetId, i: usize) -> bool {
        self.walls[t.index()] >> i & 1 == 1
    }

    pub(super) fn region(&self, t: TetId) -> RegionId {
        self.regions[t.index()]
    }

    pub(super) fn set_region(&mut self, t: TetId, region: RegionId) {
        self.regions[t.index()] = region;
    }

    /// A tetrahedron at a vertex, if the vertex is in the mesh.
    pub(super) fn at_vertex(&self, v: VertexId) -> Option<TetId> {
        Some(self.at_vertex[v.index()]).filter(|&t| t != TetId::NONE)
    }

    /// All tetrahedra.
    pub(super) fn tets(&self) -> impl Iterator<Item = TetId> + '_ {
        (0..self.corners.len()).map(TetId::new).filter(|&t| self.is_alive(t))
    }

    /// Position of a vertex among a tetrahedron's corners.
    pub(super) fn corner_of(&self, t: TetId, v: VertexId) -> Option<usize> {
        self.corners[t.index()].iter().position(|&c| c == v)
    }

    /// Corners of face i, which are positive with corner i.
    pub(super) fn face(&self, t: TetId, i: usize) -> [VertexId; 3] {
        FACE[i].map(|k| self.corners[t.index()][k])
    }

    /// The number that the face i of `t` has in the tetrahedron beyond it.
    pub(super) fn face_beyond(&self, t: TetId, i: usize) -> usize {
        let neighbor = self.neighbor(t, i);
        let key = face_key(self.corners(t), i);
        let back = |j: usize| self.neighbor(neighbor, j) == t && face_key(self.corners(neighbor), j) == key;
        (0..4).find(|&j| back(j)).expect("neighbors are mutual")
    }

    /// Makes face i of `t` a wall, on both sides.
    pub(super) fn set_wall(&mut self, t: TetId, i: usize) {
        self.walls[t.index()] |= 1 << i;
        let neighbor = self.neighbor(t, i);
        if neighbor != TetId::NONE {
            let j = self.face_beyond(t, i);
            self.walls[neighbor.index()] |= 1 << j;
        }
    }

    /// A fresh stamp: no tetrahedron is marked with it.
    pub(super) fn fresh_marks(&mut self) {
        self.stamp += 1;
    }

    pub(super) fn mark(&mut self, t: TetId) {
        self.marks[t.index()] = self.stamp;
    }

    pub(super) fn is_marked(&self, t: TetId) -> bool {
        self.marks[t.index()] == self.stamp
    }

    fn allocate(&mut self, corners: [VertexId; 4], region: RegionId) -> TetId {
        let t = self.free.pop().unwrap_or_else(|| {
            self.corners.push(corners);
            self.neighbors.push([TetId::NONE; 4]);
            self.walls.push(0);
            self.regions.push(region);
            self.marks.push(0);
            TetId::new(self.corners.len() - 1)
        });
        let i = t.index();
        self.corners[i] = corners;
        self.neighbors[i] = [TetId::NONE; 4];
        self.walls[i] = 0;
        self.regions[i] = region;
        self.marks[i] = 0;
        t
    }

    /// Replaces tetrahedra by others that fill the same polyhedron; the new ones are left in `made`.
    ///
    /// # Panics
    /// If the two fillings do not have the same boundary.
    pub(super) fn replace(&mut self, old: &[TetId], new: &[[VertexId; 4]], made: &mut Vec<TetId>) {
        let mut sides = std::mem::take(&mut self.sides);
        sides.clear();
        self.fresh_marks();
        old.iter().for_each(|&t| self.mark(t));
        for &t in old {
            for i in 0..4 {
                let beyond = self.neighbor(t, i);
                if beyond == TetId::NONE {
                    sides.push(Side {
                        key: face_key(self.corners(t), i),
                        tet: beyond,
                        face: 0,
                        outer: Some(self.is_wall(t, i)),
                    });
                } else if !self.is_marked(beyond) {
                    let face = self.face_beyond(t, i);
                    sides.push(Side {
                        key: face_key(self.corners(t), i),
                        tet: beyond,
                        face,
                        outer: Some(self.is_wall(t, i)),
                    });
                }
            }
        }
        let region = self.region(old[0]);
        for &t in old {
            self.corners[t.index()][0] = VertexId::NONE;
            self.free.push(t);
        }
        made.clear();
        for &corners in new {
            let t = self.allocate(corners, region);
            made.push(t);
            for (i, v) in corners.into_iter().enumerate() {
                sides.push(Side { key: face_key(corners, i), tet: t, face: i, outer: None });
                self.at_vertex[v.index()] = t;
            }
        }
        sides.sort_unstable_by_key(|s| s.key);
        for pair in sides.chunks(2) {
            assert!(pair.len() == 2 && pair[0].key == pair[1].key, "the fillings differ in their boundary");
            self.join(pair[0], pair[1]);
        }
        self.sides = sides;
    }

    fn join(&mut self, p: Side, q: Side) {
        for (from, to) in [(p, q), (q, p)] {
            if from.tet != TetId::NONE {
                self.neighbors[from.tet.index()][from.face] = to.tet;
                if from.outer.is_none() && to.outer == Some(true) {
                    self.walls[from.tet.index()] |= 1 << from.face;
                }
            }
        }
    }

    /// The tetrahedra at a vertex of the mesh, into `star`.
    pub(super) fn star(&mut self, v: VertexId, star: &mut Vec<TetId>) {
        star.clear();
        let Some(first) = self.at_vertex(v) else { return };
        self.fresh_marks();
        self.mark(first);
        star.push(first);
        let mut at = 0;
        while at < star.len() {
            let t = star[at];
            at += 1;
            for i in 0..4 {
                let beyond = self.neighbor(t, i);
                if self.corners(t)[i] != v && beyond != TetId::NONE && !self.is_marked(beyond) {
                    self.mark(beyond);
                    star.push(beyond);
                }
            }
        }
    }

    /// A tetrahedron with all the given vertices (an edge or a face).
    pub(super) fn tet_with(&mut self, vertices: &[VertexId], star: &mut Vec<TetId>) -> Option<TetId> {
        self.star(vertices[0], star);
        star.iter().copied().find(|&t| vertices[1..].iter().all(|&v| self.corner_of(t, v).is_some()))
    }

    /// The ring around the edge ab of `t`; false if it meets the hull, or `t` lacks the edge.
    pub(super) fn ring(&self, t: TetId, a: VertexId, b: VertexId, ring: &mut Ring) -> bool {
        ring.tets.clear();
        ring.vertices.clear();
        let (Some(i), Some(j)) = (self.corner_of(t, a), self.corner_of(t, b)) else { return false };
        let corners = self.corners(t);
        let mut others = (0..4).filter(|&k| k != i && k != j);
        let (Some(k), Some(l)) = (others.next(), others.next()) else { return false };
        let first = if is_even([i, j, k, l]) { [corners[k], corners[l]] } else { [corners[l], corners[k]] };
        let (mut back, mut ahead) = (first[0], first[1]);
        let mut at = t;
        loop {
            ring.tets.push(at);
            ring.vertices.push(back);
            let Some(face) = self.corner_of(at, back) else { return false };
            let next = self.neighbor(at, face);
            if next == TetId::NONE {
                return false;
            }
            if next == t {
                return true;
            }
            let beyond = self.corners(next).into_iter().find(|&v| v != a && v != b && v != ahead);
            (back, ahead) = (ahead, beyond.unwrap_or(ahead));
            at = next;
        }
    }

    /// Checks that neighbors are mutual and walls agree on both sides.
    #[cfg(test)]
    pub(super) fn check(&self) -> Result<(), String> {
        for t in self.tets() {
            for i in 0..4 {
                let beyond = self.neighbor(t, i);
                if beyond == TetId::NONE {
                    continue;
                }
                let key = face_key(self.corners(t), i);
                let back = (0..4).find(|&j| self.neighbor(beyond, j) == t && face_key(self.corners(beyond), j) == key);
                let Some(j) = back.filter(|_| self.is_alive(beyond)) else {
                    return Err(format!("face {i} of {t} leads to {beyond}, which does not lead back"));
                };
                if self.is_wall(t, i) != self.is_wall(beyond, j) {
                    return Err(format!("face {i} of {t} is a wall on one side"));
                }
            }
        }
        Ok(())
    }
}

fn is_even(order: [usize; 4]) -> bool {
    let inversions = EDGES.iter().filter(|&&(i, j)| order[i] > order[j]).count();
    inversions % 2 == 0
}
