//! Where points go inside the regions: corners and centers of the cells of an octree that follows the sizing field.
//!
//! A cell is divided while it is larger than 1.45 times the wanted edge length; corners and centers together make a
//! body-centered lattice whose shortest distance is then about that length. Points too near the surface's vertices are
//! left out, and all are moved by a thousandth of a cell, so that no five of them lie on one sphere. The octree's root
//! is a power of two times the largest cell, so that far from the surface cells have just the largest size.

use super::error::TetError;
use super::sizing::Sizing;
use super::surface::Surface;
use crate::geometry::bvh::{Aabb, Bvh};
use crate::geometry::{DVec3, RegionId, RegionRole};
use crate::task::Task;
use rayon::prelude::*;
use std::collections::HashSet;

/// Largest cell in wanted edge lengths; the lattice's shortest distance is 0.87 of the cell.
const CELL: f64 = 1.45;
/// Closest that a point may come to a vertex of the surface, in wanted edge lengths: nearer makes flat tetrahedra on
/// the surface, farther leaves large ones.
const CLEARANCE: f64 = 0.72;
/// Displacement of each point, in wanted edge lengths.
const JITTER: f64 = 1e-3;

/// Points inside the filled regions of a surface, in a fixed order.
pub(super) fn seeds(surface: &Surface, sizing: &Sizing, task: &Task) -> Result<Vec<DVec3>, TetError> {
    let bounds = Aabb::around(&surface.vertices);
    let center = (bounds.lo + bounds.hi) / 2.0;
    let largest = CELL * sizing.h_max() * (1.0 - 1e-9);
    let levels = ((bounds.hi - bounds.lo).max_element() / largest).log2().ceil().max(0.0);
    let mut open = vec![(center, largest * levels.exp2())];
    let mut seen: HashSet<[i64; 3]> = HashSet::new();
    let mut lattice: Vec<([i64; 3], DVec3)> = Vec::new();
    while let Some((middle, size)) = open.pop() {
        if lattice.len().is_multiple_of(1024) {
            task.check()?;
        }
        let corners =
            (0..8).map(|k| DVec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 0.5 } else { -0.5 })));
        if size > CELL * sizing.at(middle).size {
            open.extend(corners.map(|c| (middle + c * (size / 2.0), size / 2.0)));
            continue;
        }
        for p in corners.chain([DVec3::ZERO]).map(|c| middle + c * size) {
            // Corners of neighbors agree to rounding: their place in thousandths of the largest cell is their name.
            #[allow(clippy::cast_possible_truncation, reason = "a few million thousandths at most")]
            let name = ((p - center) / largest * 4096.0).to_array().map(|x| x.round() as i64);
            if seen.insert(name) {
                lattice.push((name, p));
            }
        }
    }
    let locator = Locator::new(surface);
    let keep = |(name, p): &([i64; 3], DVec3)| {
        let wanted = sizing.at(*p);
        let is_free = wanted.distance >= CLEARANCE * wanted.size && locator.is_filled(*p);
        is_free.then(|| *p + jitter(*name) * (JITTER * wanted.size))
    };
    Ok(lattice.par_iter().filter_map(keep).collect())
}

/// Up to half a unit along each axis, by a hash of the lattice place \[SLF14\].
fn jitter(name: [i64; 3]) -> DVec3 {
    let mut state = name.iter().fold(0_u64, |state, &x| mix(state ^ x.cast_unsigned()));
    let mut part = || {
        state = mix(state);
        (state >> 40) as f64 / f64::from(1_u32 << 24) - 0.5
    };
    DVec3::new(part(), part(), part())
}

/// Spreads every bit of the input over the output.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

/// Tells, to rounding, whether a point is in a region that is to be filled: the first facet on a ray says so. A point
/// misjudged next to the surface does no harm, since those are left out anyway.
struct Locator<'a> {
    surface: &'a Surface,
    bvh: Bvh,
    reach: f64,
}

impl<'a> Locator<'a> {
    fn new(surface: &'a Surface) -> Self {
        let corners = |f: usize| surface.facets[f].vertices.map(|v| surface.vertices[v.index()]);
        let boxes: Vec<Aabb> = (0..surface.facets.len()).map(|f| Aabb::around(&corners(f))).collect();
        let bounds = Aabb::around(&surface.vertices);
        Self { surface, bvh: Bvh::new(boxes), reach: 2.0 * (bounds.hi - bounds.lo).length() }
    }

    fn is_filled(&self, p: DVec3) -> bool {
        let region = self.region(p);
        region.index() != 0 && self.surface.regions[region.index()].role != RegionRole::Conductor
    }

    fn region(&self, p: DVec3) -> RegionId {
        let ray = Aabb { lo: p, hi: p + DVec3::X * self.reach };
        let mut nearest = (f64::INFINITY, RegionId::default());
        self.bvh.for_each_meeting(&ray, |f| {
            let facet = &self.surface.facets[f];
            let [a, b, c] = facet.vertices.map(|v| self.surface.vertices[v.index()] - p);
            // Where the projections onto the yz plane hold the point, the ray meets the facet.
            let area = |u: DVec3, v: DVec3| u.y * v.z - u.z * v.y;
            let parts = [area(b, c), area(c, a), area(a, b)];
            if parts.iter().all(|&x| x >= 0.0) || parts.iter().all(|&x| x <= 0.0) {
                let whole: f64 = parts.iter().sum();
                let x = (parts[0] * a.x + parts[1] * b.x + parts[2] * c.x) / whole;
                // The normal's x component has the sign of the doubled area.
                let here = if whole > 0.0 { facet.back } else { facet.front };
                if x >= 0.0 && x < nearest.0 {
                    nearest = (x, here);
                }
            }
        });
        nearest.1
    }
}
