//! Incremental Delaunay tetrahedralisation: walk, cavity, star \[BOW81\], \[WAT81\].
//!
//! All points lie within a first tetrahedron of four far vertices, so there is no hull to look after. With the exact
//! in-sphere sign and a strict comparison the cavity is always star-shaped, also for cospherical and coplanar points.
//! Once the surface has been recovered the mesh is no longer Delaunay; [`Triangulation::insert`] then keeps within the
//! walls and shrinks the cavity until it is star-shaped.

use super::store::{FACE, Ring, Store};
use crate::geometry::predicates::{insphere, orient3d};
use crate::geometry::{DVec3, TetId, VertexId};

/// Distance of the four far vertices in radii of the points' bounding sphere: so far that every face of the points'
/// hull is in the triangulation, not so far that digits are lost.
const FAR: f64 = 60.0;

/// Steps of a walk, after which the mesh must be broken.
const MAX_WALK: usize = 1_000_000;

/// A triangulation with its points.
#[derive(Clone, Debug)]
pub(super) struct Triangulation {
    /// Positions, m; the last four of the first call are the far vertices.
    pub(super) points: Vec<DVec3>,
    pub(super) store: Store,
    /// True until the first flip: cavities are then star-shaped by themselves.
    pub(super) is_delaunay: bool,
    /// Where the next walk begins.
    pub(super) last: TetId,
    /// State of the generator that decides between equal ways: the same for every run.
    random: u64,
    cavity: Vec<TetId>,
    filling: Vec<[VertexId; 4]>,
    pub(super) made: Vec<TetId>,
    pub(super) star: Vec<TetId>,
    pub(super) ring: Ring,
}

impl Triangulation {
    /// Prepares for points `0..n`, none of which is in the mesh yet.
    pub(super) fn new(mut points: Vec<DVec3>) -> Self {
        let n = points.len();
        let (lo, hi) =
            points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let (center, radius) = ((lo + hi) / 2.0, FAR * (hi - lo).length() / 2.0);
        let far = [
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(-1.0, 1.0, -1.0),
            DVec3::new(1.0, -1.0, -1.0),
            DVec3::new(-1.0, -1.0, 1.0),
        ];
        points.extend(far.map(|d| center + d * radius));
        let mut first = [0, 1, 2, 3].map(|k| VertexId::new(n + k));
        if orient3d(points[n], points[n + 1], points[n + 2], points[n + 3]) < 0.0 {
            first.swap(0, 1);
        }
        Self {
            store: Store::new(points.len(), first),
            points,
            is_delaunay: true,
            last: TetId::new(0),
            random: 0x2545_f491_4f6c_dd1d,
            cavity: Vec::new(),
            filling: Vec::new(),
            made: Vec::new(),
            star: Vec::new(),
            ring: Ring::default(),
        }
    }

    pub(super) fn point(&self, v: VertexId) -> DVec3 {
        self.points[v.index()]
    }

    pub(super) fn corner_points(&self, t: TetId) -> [DVec3; 4] {
        self.store.corners(t).map(|v| self.point(v))
    }

    /// A number below `n` (xorshift).
    pub(super) fn pick(&mut self, n: usize) -> usize {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        usize::try_from((self.random >> 16) % n as u64).unwrap_or(0)
    }

    /// Exact sign: positive if `p` is on the side of face i that corner i is on.
    pub(super) fn side(&self, t: TetId, i: usize, p: DVec3) -> f64 {
        let [a, b, c] = self.store.face(t, i).map(|v| self.point(v));
        orient3d(a, b, c, p)
    }

    /// The tetrahedron that holds a point, by a walk from the last one; `None` outside the far vertices.
    pub(super) fn locate(&mut self, p: DVec3) -> Option<TetId> {
        let mut t = if self.store.is_alive(self.last) { self.last } else { self.store.tets().next()? };
        for _ in 0..MAX_WALK {
            let first = self.pick(4);
            match (0..4).map(|k| (first + k) % 4).find(|&i| self.side(t, i, p) < 0.0) {
                None => return Some(t),
                Some(i) => t = self.store.neighbor(t, i),
            }
            if t == TetId::NONE {
                return None;
            }
        }
        None
    }

    /// Puts a vertex into the mesh. Walls are not crossed; the new tetrahedra have the region of the one it falls into.
    ///
    /// Returns false, with the mesh as it was, where the vertex coincides with another or cannot be reached by a
    /// star-shaped cavity within the walls.
    pub(super) fn insert(&mut self, v: VertexId) -> bool {
        let p = self.point(v);
        let Some(home) = self.locate(p) else { return false };
        self.last = home;
        if self.store.corners(home).iter().any(|&c| self.point(c) == p) {
            return false;
        }
        self.collect_cavity(home, |mesh, t| insphere(mesh.corner_points(t), p) > 0.0);
        if !self.is_delaunay && (!self.shrink_to_star(home, p) || self.loses_a_vertex()) {
            return false;
        }
        self.filling.clear();
        for k in 0..self.cavity.len() {
            let t = self.cavity[k];
            for i in 0..4 {
                if self.is_rim(t, i) {
                    let [a, b, c] = self.store.face(t, i);
                    self.filling.push([a, b, c, v]);
                }
            }
        }
        self.store.replace(&self.cavity, &self.filling, &mut self.made);
        self.last = self.made[0];
        true
    }

    /// Makes the cavity of the tetrahedra that hang together with the first one and belong to it, and marks them. Walls
    /// are not crossed.
    fn collect_cavity(&mut self, home: TetId, belongs: impl Fn(&Self, TetId) -> bool) {
        self.store.fresh_marks();
        self.store.mark(home);
        self.cavity.clear();
        self.cavity.push(home);
        let mut at = 0;
        while at < self.cavity.len() {
            let t = self.cavity[at];
            at += 1;
            for i in 0..4 {
                let beyond = self.store.neighbor(t, i);
                if beyond == TetId::NONE || self.store.is_wall(t, i) || self.store.is_marked(beyond) {
                    continue;
                }
                if belongs(self, beyond) {
                    self.store.mark(beyond);
                    self.cavity.push(beyond);
                }
            }
        }
    }

    /// True if face i of a tetrahedron of the cavity is on the cavity's boundary.
    fn is_rim(&self, t: TetId, i: usize) -> bool {
        let beyond = self.store.neighbor(t, i);
        beyond == TetId::NONE || !self.store.is_marked(beyond)
    }

    /// Drops tetrahedra with a boundary face that does not see p until there are none; false if the one that holds p
    /// would have to go, or a wall stands inside the cavity.
    fn shrink_to_star(&mut self, home: TetId, p: DVec3) -> bool {
        loop {
            let blind = |t: &TetId| (0..4).any(|i| self.is_rim(*t, i) && self.side(*t, i, p) <= 0.0);
            let Some(dropped) = self.cavity.iter().copied().find(blind) else { break };
            if dropped == home {
                return false;
            }
            let kept: Vec<TetId> = self.cavity.iter().copied().filter(|&t| t != dropped).collect();
            // Only what still hangs together with the first one stays.
            self.collect_cavity(home, |_, t| kept.contains(&t));
        }
        let inner_wall = |t: &TetId| (0..4).any(|i| self.store.is_wall(*t, i) && !self.is_rim(*t, i));
        !self.cavity.iter().any(inner_wall)
    }

    /// True if a vertex of the cavity lies on none of its boundary faces: it would vanish from the mesh.
    fn loses_a_vertex(&self) -> bool {
        let mut inner: Vec<VertexId> = self.cavity.iter().flat_map(|&t| self.store.corners(t)).collect();
        let mut rim: Vec<VertexId> = Vec::with_capacity(inner.len());
        for &t in &self.cavity {
            for (i, corners) in FACE.iter().enumerate() {
                if self.is_rim(t, i) {
                    rim.extend(corners.map(|k| self.store.corners(t)[k]));
                }
            }
        }
        for list in [&mut inner, &mut rim] {
            list.sort_unstable();
            list.dedup();
        }
        inner.len() != rim.len()
    }

    /// Checks adjacency and exact orientation of every tetrahedron.
    #[cfg(test)]
    pub(super) fn check(&self) -> Result<(), String> {
        self.store.check()?;
        let inverted = |t: &TetId| {
            let [a, b, c, d] = self.corner_points(*t);
            orient3d(a, b, c, d) <= 0.0
        };
        self.store.tets().find(inverted).map_or(Ok(()), |t| Err(format!("{t} is inside out")))
    }

    /// Faces whose opposite vertex beyond lies in the circumsphere: none in a Delaunay mesh.
    #[cfg(test)]
    pub(super) fn n_not_delaunay(&self) -> usize {
        let violates = |t: TetId, i: usize| {
            let beyond = self.store.neighbor(t, i);
            beyond != TetId::NONE && {
                let apex = self.store.corners(beyond)[self.store.face_beyond(t, i)];
                insphere(self.corner_points(t), self.point(apex)) > 0.0
            }
        };
        self.store.tets().map(|t| (0..4).filter(|&i| violates(t, i)).count()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(points: &[DVec3]) -> Triangulation {
        let mut mesh = Triangulation::new(points.to_vec());
        for v in 0..points.len() {
            assert!(mesh.insert(VertexId::new(v)), "point {v} is refused");
        }
        assert_eq!(mesh.check(), Ok(()), "adjacency and orientation");
        assert_eq!(mesh.n_not_delaunay(), 0, "empty circumspheres");
        mesh
    }

    #[test]
    fn random_points_make_a_delaunay_mesh() {
        let mut rng = fastrand::Rng::with_seed(1);
        let points: Vec<DVec3> = (0..3000).map(|_| DVec3::new(rng.f64(), rng.f64(), rng.f64())).collect();
        let mesh = triangulate(&points);
        // Euler's formula for a ball: V - E + F - T = 1.
        let mut edges = std::collections::HashSet::new();
        let (mut tets, mut inner) = (0, 0);
        for t in mesh.store.tets() {
            tets += 1;
            let corners = mesh.store.corners(t);
            for (i, j) in super::super::store::EDGES {
                edges.insert(super::super::store::edge_key(corners[i], corners[j]));
            }
            inner += (0..4).filter(|&i| mesh.store.neighbor(t, i) != TetId::NONE).count();
        }
        let faces = inner / 2 + 4;
        assert_eq!(points.len() + 4 + faces, 1 + edges.len() + tets, "V + F = 1 + E + T");
    }

    #[test]
    fn cospherical_and_coplanar_points_are_no_trouble() {
        let grid =
            |n: usize| (0..n * n * n).map(move |i| DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64));
        triangulate(&grid(7).collect::<Vec<_>>());
        let circle =
            (0..60).map(|k| DVec3::new((f64::from(k) * 0.3).cos(), (f64::from(k) * 0.3).sin(), f64::from(k % 3)));
        triangulate(&circle.collect::<Vec<_>>());
        let flat: Vec<DVec3> = grid(9).filter(|p| p.z < 0.5).collect();
        triangulate(&flat);
    }

    #[test]
    fn a_point_given_twice_is_refused_and_leaves_the_mesh_whole() {
        let mut mesh = Triangulation::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::X]);
        for v in 0..4 {
            assert!(mesh.insert(VertexId::new(v)), "point {v}");
        }
        assert!(!mesh.insert(VertexId::new(4)), "it coincides with another");
        assert_eq!(mesh.check(), Ok(()), "still whole");
    }
}
