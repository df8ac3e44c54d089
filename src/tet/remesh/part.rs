//! A flat part, triangulated anew within its rim.

use super::near::Near;
use super::rim::Rim;
use super::sides;
use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{DVec2, DVec3, Facet, Plc, VertexId};
use crate::tet::store::edge_key;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};
use std::collections::{BTreeSet, HashMap, HashSet};

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Smallest angle asked for, degrees; the rim, which stays as it is, may have smaller ones.
const MIN_ANGLE_DEG: f64 = 25.0;
/// Most points added in a part.
const MOST_POINTS: usize = 100_000;

pub(super) struct Part<'a> {
    pub(super) plc: &'a Plc,
    pub(super) rim: &'a Rim,
    pub(super) facets: &'a [usize],
    /// Wanted length of edges, m.
    pub(super) edge: f64,
    /// How far above or below it points are taken from, m.
    pub(super) reach: f64,
}

/// The plane of a part with directions in it.
struct Plane {
    origin: DVec3,
    normal: DVec3,
    u: DVec3,
    v: DVec3,
}

impl Plane {
    fn new(corners: [DVec3; 3]) -> Self {
        let normal = doubled_area_vector(corners).normalize_or_zero();
        let (u, v) = axes(normal);
        Self { origin: corners[0], normal, u, v }
    }

    fn flat(&self, p: DVec3) -> DVec2 {
        DVec2::new((p - self.origin).dot(self.u), (p - self.origin).dot(self.v))
    }

    fn height(&self, p: DVec3) -> f64 {
        (p - self.origin).dot(self.normal)
    }

    fn place(&self, p: DVec2) -> DVec3 {
        self.origin + self.u * p.x + self.v * p.y
    }
}

impl Part<'_> {
    /// Adds the part's triangles to `new`, and its new vertices also to `near`, where those of other parts are.
    ///
    /// * `keep`: vertices that stay even within the part.
    ///
    /// # Errors
    /// A place where the rim crosses itself, m.
    pub(super) fn triangulate(&self, keep: &[VertexId], near: &mut Near, new: &mut Plc) -> Result<(), DVec3> {
        let model = self.plc.facets[self.facets[0]];
        let own = self.facets.iter().map(|&f| &self.plc.facets[f]);
        let rim: Vec<[VertexId; 2]> = own.clone().flat_map(sides).flat_map(|e| self.rim.pieces(e)).collect();
        let mut nodes: BTreeSet<VertexId> = rim.iter().flatten().copied().collect();
        nodes.extend(own.flat_map(|f| f.vertices).filter(|v| keep.contains(v)));
        let mut nodes: Vec<VertexId> = nodes.into_iter().collect();
        let plane = Plane::new(self.plc.corners(self.facets[0]));
        let mut cdt = Cdt::new();
        let mut handles = HashMap::new();
        for (k, &node) in nodes.iter().enumerate() {
            let p = plane.flat(new.vertices[node.index()]);
            let handle = cdt.insert(Point2::new(p.x, p.y)).ok().filter(|h| h.index() == k);
            handles.insert(node, handle.ok_or(new.vertices[node.index()])?);
        }
        for [a, b] in &rim {
            if !cdt.can_add_constraint(handles[a], handles[b]) {
                return Err(new.vertices[a.index()]);
            }
            cdt.add_constraint(handles[a], handles[b]);
        }
        let fixed: Vec<DVec2> = nodes.iter().map(|n| plane.flat(new.vertices[n.index()])).collect();
        let outline: Vec<[DVec2; 2]> = rim.iter().map(|e| e.map(|v| plane.flat(new.vertices[v.index()]))).collect();
        for p in self.taken(&plane, &fixed, &outline, near) {
            // A point that the triangulation cannot take is one less.
            let _ = cdt.insert(Point2::new(p.x, p.y));
        }
        let parameters = RefinementParameters::new()
            .keep_constraint_edges()
            .exclude_outer_faces(true)
            .with_angle_limit(AngleLimit::from_deg(MIN_ANGLE_DEG))
            .with_max_allowed_area(3.0_f64.sqrt() / 4.0 * self.edge * self.edge)
            .with_max_additional_vertices(MOST_POINTS);
        cdt.refine(parameters);
        for vertex in cdt.vertices().skip(nodes.len()) {
            let [x, y]: [f64; 2] = vertex.position().into();
            let p = plane.place(DVec2::new(x, y));
            new.vertices.push(p);
            near.add(p);
            nodes.push(VertexId::new(new.vertices.len() - 1));
        }
        let triangles: Vec<[VertexId; 3]> =
            cdt.inner_faces().map(|f| f.vertices().map(|v| nodes[v.fix().index()])).collect();
        new.facets.extend(within(&triangles, &rim).into_iter().map(|vertices| Facet { vertices, ..model }));
        Ok(())
    }

    /// Points of other parts that lie above or below this one, brought into its plane, the nearest first: what lies
    /// closely above one another must match. Those are left out that are nearer to another point than half of what
    /// they are away from the plane, or so near to the rim that they would call for a point on it.
    fn taken(&self, plane: &Plane, fixed: &[DVec2], outline: &[[DVec2; 2]], near: &Near) -> Vec<DVec2> {
        let corners = self.facets.iter().flat_map(|&f| self.plc.corners(f));
        let (lo, hi) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let mut above: Vec<(f64, DVec2)> =
            near.around(lo, hi).into_iter().map(|p| (plane.height(p).abs(), plane.flat(p))).collect();
        above.retain(|(height, p)| *height <= self.reach && is_inside(*p, outline));
        above.sort_by(|p, q| {
            let by_place = || p.1.x.total_cmp(&q.1.x).then(p.1.y.total_cmp(&q.1.y));
            p.0.total_cmp(&q.0).then_with(by_place)
        });
        let mut all = Near::new(self.reach);
        fixed.iter().for_each(|p| all.add(p.extend(0.0)));
        let mut taken = Vec::new();
        for (height, p) in above {
            let is_near = |q: DVec3| q.truncate().distance(p) <= (height / 2.0).max(1e-6 * self.edge);
            let encroaches = |[a, b]: &[DVec2; 2]| (*a - p).dot(*b - p) < 0.0;
            let place = p.extend(0.0);
            if !all.around(place, place).into_iter().any(is_near) && !outline.iter().any(encroaches) {
                all.add(place);
                taken.push(p);
            }
        }
        taken
    }
}

/// Whether a point is inside an outline, by how often a ray leaves it.
fn is_inside(p: DVec2, outline: &[[DVec2; 2]]) -> bool {
    let crosses =
        |[a, b]: &&[DVec2; 2]| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    outline.iter().filter(crosses).count() % 2 == 1
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
    let walls: HashSet<[VertexId; 2]> = rim.iter().map(|[a, b]| edge_key(*a, *b)).collect();
    let mut stack: Vec<usize> = rim.iter().filter_map(|e| left.get(e).copied()).collect();
    let mut is_within = vec![false; triangles.len()];
    while let Some(k) = stack.pop() {
        if std::mem::replace(&mut is_within[k], true) {
            continue;
        }
        for [a, b] in turns(triangles[k]) {
            if !walls.contains(&edge_key(a, b)) {
                stack.extend(left.get(&[b, a]));
            }
        }
    }
    triangles.iter().zip(is_within).filter(|(_, within)| *within).map(|(t, _)| *t).collect()
}
