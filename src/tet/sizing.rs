//! How long edges should be: `h(x) = min(h_max, min over the surface's vertices of h_i + g |x - s_i|)`.
//!
//! `h_i` is the mean length of the surface's edges at vertex i, g the grading. A k-d tree answers for a point with the
//! distance to the nearest vertex at once.

use super::surface::Surface;
use crate::geometry::DVec3;
use crate::geometry::bvh::Aabb;

/// Limits of the edge length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizingSettings {
    /// Longest edge wanted, m: a tenth of the wavelength at the top frequency.
    pub h_max: f64,
    /// Growth of the edge length with the distance from the surface.
    pub grading: f64,
}

/// A vertex with the edge length wanted there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Site {
    place: DVec3,
    size: f64,
    /// Smallest size in the site's part of the tree, and the box around that part.
    smallest: f64,
    bounds: Aabb,
}

/// The sizing field.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizing {
    settings: SizingSettings,
    /// A k-d tree: the median of each range is its node, axes alternate.
    sites: Vec<Site>,
}

/// The field's answer at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Edge length, m.
    pub size: f64,
    /// Distance to the nearest vertex of the surface, m; `h_max` where it is farther.
    pub distance: f64,
}

impl Sizing {
    /// The field around a surface.
    #[must_use]
    pub fn new(surface: &Surface, settings: SizingSettings) -> Self {
        let mut sums = vec![(0.0, 0_u32); surface.vertices.len()];
        for facet in &surface.facets {
            let places = facet.vertices.map(|v| surface.vertices[v.index()]);
            for k in 0..3 {
                let length = places[k].distance(places[(k + 1) % 3]);
                for v in [facet.vertices[k], facet.vertices[(k + 1) % 3]] {
                    sums[v.index()].0 += length;
                    sums[v.index()].1 += 1;
                }
            }
        }
        let mut sites: Vec<Site> = surface
            .vertices
            .iter()
            .zip(sums)
            .filter(|(_, (_, n))| *n > 0)
            .map(|(&place, (sum, n))| Site {
                place,
                size: sum / f64::from(n),
                smallest: 0.0,
                bounds: Aabb::around(&[place]),
            })
            .collect();
        sort(&mut sites, 0);
        Self { settings, sites }
    }

    /// The longest edge wanted anywhere, m.
    #[must_use]
    pub fn h_max(&self) -> f64 {
        self.settings.h_max
    }

    /// The edge length wanted at a point.
    #[must_use]
    pub fn at(&self, p: DVec3) -> Wanted {
        let mut best = Wanted { size: self.settings.h_max, distance: self.settings.h_max };
        self.search(&self.sites, 0, p, &mut best);
        best
    }

    fn search(&self, sites: &[Site], axis: usize, p: DVec3, best: &mut Wanted) {
        let middle = sites.len() / 2;
        let Some(site) = sites.get(middle) else { return };
        let away = (site.bounds.lo - p).max(p - site.bounds.hi).max(DVec3::ZERO).length();
        if away >= best.distance && site.smallest + self.settings.grading * away >= best.size {
            return;
        }
        let distance = site.place.distance(p);
        best.distance = best.distance.min(distance);
        best.size = best.size.min(site.size + self.settings.grading * distance);
        let (left, right) = (&sites[..middle], &sites[middle + 1..]);
        let (near, far) = if p[axis] < site.place[axis] { (left, right) } else { (right, left) };
        self.search(near, (axis + 1) % 3, p, best);
        self.search(far, (axis + 1) % 3, p, best);
    }
}

/// Makes the tree.
fn sort(sites: &mut [Site], axis: usize) {
    if sites.is_empty() {
        return;
    }
    let middle = sites.len() / 2;
    let key = |s: &Site| (s.place[axis], s.place.x, s.place.y, s.place.z);
    sites.select_nth_unstable_by(middle, |p, q| {
        let (p, q) = (key(p), key(q));
        p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1)).then(p.2.total_cmp(&q.2)).then(p.3.total_cmp(&q.3))
    });
    let (left, right) = sites.split_at_mut(middle);
    sort(left, (axis + 1) % 3);
    sort(&mut right[1..], (axis + 1) % 3);
    let parts = [left.get(left.len() / 2).copied(), right[1..].get((right.len() - 1) / 2).copied()];
    let whole = &mut right[0];
    whole.smallest = whole.size;
    for part in parts.into_iter().flatten() {
        whole.smallest = whole.smallest.min(part.smallest);
        whole.bounds = Aabb { lo: whole.bounds.lo.min(part.bounds.lo), hi: whole.bounds.hi.max(part.bounds.hi) };
    }
}
