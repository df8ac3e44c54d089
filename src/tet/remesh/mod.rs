//! New triangles for the flat parts of a surface complex: of a wanted size and well shaped, whatever they were.
//!
//! Facets in one plane between the same two regions are one part. Its rim is divided first, for all parts at it alike, more
//! finely where one of them is narrow; then the part is triangulated anew within its rim. Facets that lie in no plane with
//! others are parts of their own, so the shape stays what it was.
//!
//! Both sides of a plate get their points right above one another: a plate much thinner than its triangles is then filled
//! by flat prisms, whose faces a Delaunay mesh has of itself. With points that do not match it has few of them.

mod near;
mod part;
mod rim;

use super::store::edge_key;
use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{DVec3, Facet, Plc, RegionId, RegionRole, VertexId};
use near::Near;
use part::Part;
use rim::Rim;
use std::collections::HashMap;

/// Cosine of the angle between facets that may lie in one plane.
const SAME_NORMAL: f64 = 0.999;

/// Wanted length of edges, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Within parts, and of rims away from conductors.
    pub inner: f64,
    /// Of rims of conductors, where the field is strongest.
    pub at_metal: f64,
}

/// Triangulates a complex anew.
///
/// * `keep`: vertices that stay even within a part.
/// * `sizes`: wanted length of edges, m.
/// * `tolerance`: greatest distance of vertices from the plane of their part, m.
///
/// # Errors
/// A place where the rim of a part crosses itself, m.
pub fn remesh(plc: &Plc, keep: &[VertexId], sizes: Sizes, tolerance: f64) -> Result<Plc, DVec3> {
    let flats = Flats::new(plc, tolerance);
    // Farther from one another than an edge is long, parts need no matching points.
    let reach = sizes.inner;
    let rim = Rim::new(plc, &flats, sizes, reach);
    let mut new = Plc { vertices: rim.vertices.clone(), facets: Vec::new(), regions: plc.regions.clone() };
    let mut near = Near::new(reach);
    rim.used().for_each(|v| near.add(rim.vertices[v.index()]));
    keep.iter().for_each(|v| near.add(plc.vertices[v.index()]));
    for facets in flats.by_area(plc) {
        Part { plc, rim: &rim, facets: &facets, edge: sizes.inner, reach }.triangulate(keep, &mut near, &mut new)?;
    }
    Ok(compact(new))
}

fn sides(f: &Facet) -> [[VertexId; 2]; 3] {
    let [a, b, c] = f.vertices;
    [[a, b], [b, c], [c, a]]
}

/// Which facets lie in one plane.
struct Flats {
    /// For each facet its part.
    part_of: Vec<usize>,
    /// For each part its normal.
    normals: Vec<DVec3>,
    /// Greatest distance of vertices from the plane of their part, m.
    tolerance: f64,
}

impl Flats {
    fn new(plc: &Plc, tolerance: f64) -> Self {
        let mut at: HashMap<[VertexId; 2], Vec<usize>> = HashMap::new();
        for (f, facet) in plc.facets.iter().enumerate() {
            sides(facet).iter().for_each(|[a, b]| at.entry(edge_key(*a, *b)).or_default().push(f));
        }
        let mut flats = Self { part_of: vec![usize::MAX; plc.facets.len()], normals: Vec::new(), tolerance };
        for first in 0..plc.facets.len() {
            if flats.part_of[first] == usize::MAX {
                flats.grow(plc, first, &at);
            }
        }
        flats
    }

    /// Gathers the part of a facet.
    fn grow(&mut self, plc: &Plc, first: usize, at: &HashMap<[VertexId; 2], Vec<usize>>) {
        let part = self.normals.len();
        let corners = plc.corners(first);
        let normal = doubled_area_vector(corners).normalize_or_zero();
        self.normals.push(normal);
        let between = |f: usize| (plc.facets[f].back, plc.facets[f].front);
        let fits = |f: usize| {
            let own = plc.corners(f);
            own.iter().all(|p| (*p - corners[0]).dot(normal).abs() <= self.tolerance)
                && doubled_area_vector(own).normalize_or_zero().dot(normal) > SAME_NORMAL
                && between(f) == between(first)
        };
        let mut stack = vec![first];
        self.part_of[first] = part;
        while let Some(f) = stack.pop() {
            for [a, b] in sides(&plc.facets[f]) {
                let [p, q] = at[&edge_key(a, b)][..] else { continue };
                let other = if p == f { q } else { p };
                if self.part_of[other] == usize::MAX && fits(other) {
                    self.part_of[other] = part;
                    stack.push(other);
                }
            }
        }
    }

    fn n_parts(&self) -> usize {
        self.normals.len()
    }

    /// Whether each part bounds a conductor.
    fn at_metal(&self, plc: &Plc) -> Vec<bool> {
        let is_metal = |r: RegionId| plc.regions[r.index()].role == RegionRole::Conductor;
        let mut at_metal = vec![false; self.n_parts()];
        for (facet, &part) in plc.facets.iter().zip(&self.part_of) {
            at_metal[part] = is_metal(facet.back) != is_metal(facet.front);
        }
        at_metal
    }

    /// Facets of each part, the smallest part first: the larger ones take its points.
    fn by_area(&self, plc: &Plc) -> Vec<Vec<usize>> {
        let mut members = vec![(0.0, Vec::new()); self.n_parts()];
        for (f, &part) in self.part_of.iter().enumerate() {
            members[part].0 += doubled_area_vector(plc.corners(f)).length();
            members[part].1.push(f);
        }
        members.sort_by(|p, q| p.0.total_cmp(&q.0));
        members.into_iter().map(|m| m.1).collect()
    }
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
    use std::collections::BTreeSet;

    const EVEN: Sizes = Sizes { inner: 1e-3, at_metal: 1e-3 };

    #[test]
    fn a_complex_keeps_its_shape_and_gets_edges_of_the_wanted_size() {
        let plc = flat_complex(&params::tests::paper()).expect("the paper's antenna");
        let new = remesh(&plc, &[], EVEN, 1e-9).expect("flat parts");
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

    /// A patch over a ground, both foils of the given thickness, with triangles along the longest edges only.
    fn foils(thickness: f64) -> Plc {
        let (t, h) = (thickness, 1.575e-3);
        let blocks = [([-0.01, -0.01, -h - t], [0.01, 0.01, -h]), ([-5e-3, -4e-3, 0.0], [5e-3, 4e-3, t])];
        let mut plc = flat_complex(&params::tests::paper()).expect("the paper's antenna");
        plc.regions.retain(|r| r.role != RegionRole::Dielectric);
        plc.regions.truncate(3);
        (plc.vertices, plc.facets) = (Vec::new(), Vec::new());
        for (k, (lo, hi)) in blocks.into_iter().enumerate() {
            let first = plc.vertices.len();
            let corner =
                |c: usize| DVec3::from_array([0, 1, 2].map(|a: usize| if c >> a & 1 == 1 { hi[a] } else { lo[a] }));
            plc.vertices.extend((0..8).map(corner));
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            for [a, b, c, d] in quads.map(|q| q.map(|v| VertexId::new(first + v))) {
                let facet = |vertices| Facet { vertices, back: RegionId::new(k + 1), front: RegionId::new(0) };
                plc.facets.extend([facet([a, b, c]), facet([a, c, d])]);
            }
        }
        plc
    }

    #[test]
    fn both_sides_of_a_foil_get_the_same_points() {
        let plc = foils(35e-6);
        assert_eq!(plc.check(), Ok(()), "closed");
        let new = remesh(&plc, &[], EVEN, 1e-6).expect("flat parts");
        assert_eq!(new.check(), Ok(()), "closed");
        #[allow(clippy::cast_possible_truncation, reason = "a few thousand micrometers")]
        let micrometers = |v: VertexId| (new.vertices[v.index()] * 1e6).to_array().map(|x| x.round() as i64);
        for low in [0, -1610] {
            let on = |level: i64| {
                let corners = new.facets.iter().map(|f| f.vertices.map(micrometers));
                let flat = corners.filter(move |c| c.iter().all(|p| p[2] == level));
                flat.map(|c| BTreeSet::from(c.map(|[x, y, _]| [x, y]))).collect::<BTreeSet<_>>()
            };
            let points = |level: i64| on(level).into_iter().flatten().collect::<BTreeSet<_>>();
            assert!(points(low).len() > 100, "divided");
            assert_eq!(points(low), points(low + 35), "points at {low} um");
            // Four points on a circle may be joined either way.
            let (below, above) = (on(low), on(low + 35));
            assert!(below.intersection(&above).count() > above.len() * 9 / 10, "triangles at {low} um");
        }
    }
}
