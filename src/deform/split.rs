//! Splits edges until the faceted surface follows the smooth map, conforming across every interface.
//!
//! An edge is marked when the map leaves the straight image of the edge by more than the tolerance at a quarter, half
//! or three quarters of it (the midpoint alone misses S-shaped edges); with it the longest edge of each facet at it, so
//! that facets do not get ever thinner \[RIV84\]. A marked edge gets one vertex at its flat midpoint, shared by all facets around it whatever parts they belong to, and each facet is divided by its number of
//! marked edges: one, bisect; two, cut the corner and divide the rest by the shorter posed diagonal; three, four
//! triangles. This repeats until no edge is marked.

use super::DeformError;
use crate::geometry::{DVec3, Facet, Plc, VertexId};
use crate::task::Task;
use std::collections::{HashMap, HashSet};

/// Limits of edge splitting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitSettings {
    /// Greatest distance of a straight edge from the smooth map, m.
    pub tolerance: f64,
    /// Passes after which the map is given up as not smooth enough; a bend needs about 5.
    pub max_passes: usize,
    /// Vertices after which the tolerance is given up as too small.
    pub max_vertices: usize,
}

impl SplitSettings {
    /// The given tolerance with the usual limits.
    #[must_use]
    pub fn with_tolerance(tolerance: f64) -> Self {
        Self { tolerance, max_passes: 24, max_vertices: 2_000_000 }
    }
}

/// What a map says of a point: its deformed position, and perhaps more that is worth keeping.
pub trait Image: Copy {
    /// The deformed position, m.
    fn position(self) -> DVec3;
}

impl Image for DVec3 {
    fn position(self) -> DVec3 {
        self
    }
}

/// A split surface with the images of its vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitSurface<P> {
    /// The flat surface with the vertices that splitting added at its end.
    pub flat: Plc,
    /// Images of its vertices.
    pub images: Vec<P>,
    /// Passes taken.
    pub passes: usize,
}

impl<P: Image> SplitSurface<P> {
    /// Deformed positions of the vertices, m.
    #[must_use]
    pub fn positions(&self) -> Vec<DVec3> {
        self.images.iter().map(|i| i.position()).collect()
    }
}

/// Where the edge is compared with the map; the midpoint first, since most marked edges show there.
const FRACTIONS: [f64; 3] = [0.5, 0.25, 0.75];

/// Splits `flat` until `map` is followed to the tolerance.
///
/// * `map`: images of flat points, m; it must be deterministic for each point alone.
///
/// # Errors
/// What `map` returns, [`DeformError::SplitLimit`] if the limits of `settings` are reached, or
/// [`DeformError::Cancelled`].
pub fn split<P: Image>(
    flat: Plc,
    map: impl Fn(&[DVec3]) -> Result<Vec<P>, DeformError>,
    settings: SplitSettings,
    task: &Task,
) -> Result<SplitSurface<P>, DeformError> {
    let images = map(&flat.vertices)?;
    let mut surface = SplitSurface { flat, images, passes: 0 };
    // Edges seen so far; true if they were straight enough. A split edge never comes back.
    let mut straight: HashMap<[VertexId; 2], bool> = HashMap::new();
    loop {
        task.check()?;
        let fresh = fresh_edges(&surface.flat.facets, &straight);
        let mut marked = Vec::new();
        for (edge, midpoint) in fresh.iter().zip(mark(&surface, &fresh, &map, settings.tolerance)?) {
            straight.insert(*edge, midpoint.is_none());
            marked.extend(midpoint.map(|(flat_point, image)| (*edge, flat_point, image)));
        }
        let longest = longest_edges(&surface.flat, marked.iter().map(|m| m.0).collect());
        let middles: Vec<DVec3> = longest.iter().map(|&e| middle_of(&surface.flat.vertices, e)).collect();
        marked.extend(longest.iter().zip(&middles).zip(map(&middles)?).map(|((e, p), x)| (*e, *p, x)));
        let mut middle: HashMap<[VertexId; 2], VertexId> = HashMap::new();
        for (edge, flat_point, image) in marked {
            middle.insert(edge, VertexId::new(surface.images.len()));
            surface.flat.vertices.push(flat_point);
            surface.images.push(image);
        }
        if middle.is_empty() {
            return Ok(surface);
        }
        surface.passes += 1;
        let n_vertices = surface.images.len();
        if surface.passes > settings.max_passes || n_vertices > settings.max_vertices {
            return Err(DeformError::SplitLimit { passes: surface.passes, n_vertices });
        }
        let facets = std::mem::take(&mut surface.flat.facets);
        surface.flat.facets = facets.iter().flat_map(|f| divide(f, &middle, &surface.images)).collect();
    }
}

fn key(a: VertexId, b: VertexId) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

fn middle_of(points: &[DVec3], [a, b]: [VertexId; 2]) -> DVec3 {
    points[a.index()].midpoint(points[b.index()])
}

/// The longest flat edges that must be split beside the marked ones, ascending: wherever a facet is divided, its longest
/// edge is too \[RIV84\]. Bisecting shorter edges alone would leave ever thinner facets, and never come to an end where
/// such a facet's long edge keeps being marked.
fn longest_edges(flat: &Plc, mut marked: HashSet<[VertexId; 2]>) -> Vec<[VertexId; 2]> {
    let length = |[a, b]: [VertexId; 2]| flat.vertices[a.index()].distance_squared(flat.vertices[b.index()]);
    let edges = |f: &Facet| {
        let [a, b, c] = f.vertices;
        [key(a, b), key(b, c), key(c, a)]
    };
    let mut added = Vec::new();
    loop {
        let before = added.len();
        for facet in &flat.facets {
            let sides = edges(facet);
            if sides.iter().any(|e| marked.contains(e)) {
                // Ties go to the smaller key, so that both facets at an edge agree.
                let longest = sides.into_iter().max_by(|p, q| length(*p).total_cmp(&length(*q)).then(q.cmp(p)));
                added.extend(longest.filter(|&e| marked.insert(e)));
            }
        }
        if added.len() == before {
            added.sort_unstable();
            return added;
        }
    }
}

/// The edges that were not judged yet, ascending, each once.
fn fresh_edges(facets: &[Facet], known: &HashMap<[VertexId; 2], bool>) -> Vec<[VertexId; 2]> {
    let of_facet = |f: &Facet| {
        let [a, b, c] = f.vertices;
        [key(a, b), key(b, c), key(c, a)]
    };
    let mut edges: Vec<_> = facets.iter().flat_map(of_facet).filter(|e| !known.contains_key(e)).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// For each edge that must be split, its flat midpoint and the midpoint's image.
fn mark<P: Image>(
    surface: &SplitSurface<P>,
    edges: &[[VertexId; 2]],
    map: &impl Fn(&[DVec3]) -> Result<Vec<P>, DeformError>,
    tolerance: f64,
) -> Result<Vec<Option<(DVec3, P)>>, DeformError> {
    let at = |fraction: f64, edge: [VertexId; 2]| {
        let [a, b] = edge.map(|v| surface.flat.vertices[v.index()]);
        a.lerp(b, fraction)
    };
    let leaves = |fraction: f64, edge: [VertexId; 2], image: P| {
        let [a, b] = edge.map(|v| surface.images[v.index()].position());
        image.position().distance(a.lerp(b, fraction)) > tolerance
    };
    let halves: Vec<DVec3> = edges.iter().map(|&e| at(FRACTIONS[0], e)).collect();
    let images = map(&halves)?;
    let mut marked: Vec<bool> = edges.iter().zip(&images).map(|(&e, &x)| leaves(FRACTIONS[0], e, x)).collect();
    for fraction in &FRACTIONS[1..] {
        let open: Vec<usize> = (0..edges.len()).filter(|&e| !marked[e]).collect();
        let points: Vec<DVec3> = open.iter().map(|&e| at(*fraction, edges[e])).collect();
        for (&e, image) in open.iter().zip(map(&points)?) {
            marked[e] = leaves(*fraction, edges[e], image);
        }
    }
    Ok((0..edges.len()).map(|e| marked[e].then(|| (halves[e], images[e]))).collect())
}

/// Divides one facet by the midpoints of its marked edges, keeping orientation and regions.
fn divide<P: Image>(facet: &Facet, middle: &HashMap<[VertexId; 2], VertexId>, images: &[P]) -> Vec<Facet> {
    let v = facet.vertices;
    let mid: [Option<VertexId>; 3] = [0, 1, 2].map(|k| middle.get(&key(v[k], v[(k + 1) % 3])).copied());
    let part = |vertices| Facet { vertices, ..*facet };
    let apart = |a: VertexId, b: VertexId| images[a.index()].position().distance_squared(images[b.index()].position());
    match mid {
        [None, None, None] => vec![*facet],
        [Some(ab), Some(bc), Some(ca)] => {
            let [a, b, c] = v;
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(part).to_vec()
        }
        _ => {
            // Turn the facet so that its first edge is marked and, of two marked edges, they are the first two.
            let turn = (0..3).find(|&k| mid[k].is_some() && mid[(k + 2) % 3].is_none()).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|k| v[(turn + k) % 3]);
            match (mid[turn], mid[(turn + 1) % 3]) {
                (Some(ab), Some(bc)) => {
                    let corner = [ab, b, bc];
                    let rest = if apart(a, bc) <= apart(ab, c) {
                        [[a, ab, bc], [a, bc, c]]
                    } else {
                        [[a, ab, c], [ab, bc, c]]
                    };
                    vec![part(corner), part(rest[0]), part(rest[1])]
                }
                (Some(ab), None) => vec![part([a, ab, c]), part([ab, b, c])],
                _ => vec![*facet],
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antenna::{flat_complex, params};

    fn paper_complex() -> Plc {
        flat_complex(&params::tests::paper()).expect("the paper's antenna")
    }

    #[test]
    fn a_flat_map_splits_nothing() {
        let plc = paper_complex();
        let n = plc.facets.len();
        let turned = |p: &[DVec3]| Ok(p.iter().map(|q| DVec3::new(-q.y, q.x, q.z) * 1.5).collect());
        let split = split(plc, turned, SplitSettings::with_tolerance(1e-5), &Task::default()).expect("smooth");
        assert_eq!((split.flat.facets.len(), split.passes), (n, 0), "untouched");
    }

    #[test]
    fn a_wavy_map_stays_conforming_and_within_tolerance() {
        let wavy = |p: &[DVec3]| -> Result<Vec<DVec3>, DeformError> {
            Ok(p.iter()
                .map(|q| *q + DVec3::Z * 2e-3 * (q.x * 400.0).sin() * (q.y * 300.0 + q.x * 100.0).cos())
                .collect())
        };
        let settings = SplitSettings::with_tolerance(2e-5);
        let split = split(paper_complex(), wavy, settings, &Task::default()).expect("smooth");
        let deformed = split.flat.with_vertices(split.positions());
        assert_eq!(split.flat.check(), Ok(()), "flat surface closed");
        assert_eq!(deformed.check(), Ok(()), "deformed surface closed");
        for facet in &split.flat.facets {
            for k in 0..3 {
                let (a, b) = (facet.vertices[k].index(), facet.vertices[(k + 1) % 3].index());
                let middle = split.flat.vertices[a].midpoint(split.flat.vertices[b]);
                let gap = wavy(&[middle]).unwrap()[0].distance(split.images[a].midpoint(split.images[b]));
                assert!(gap <= settings.tolerance, "edge {a}-{b} leaves the map by {gap:e}");
            }
        }
    }

    #[test]
    fn a_map_with_a_jump_ends_in_an_error() {
        let torn = |p: &[DVec3]| Ok(p.iter().map(|q| if q.x > 1e-4 { *q + DVec3::Z } else { *q }).collect());
        let settings = SplitSettings { max_passes: 5, ..SplitSettings::with_tolerance(1e-5) };
        let result = split(paper_complex(), torn, settings, &Task::default());
        assert!(matches!(result, Err(DeformError::SplitLimit { .. })), "a jump cannot be followed");
    }
}
