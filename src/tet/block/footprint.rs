//! The common triangulation of all outlines, seen from above.
//!
//! Seeds packed between the outlines are triangulated (constrained Delaunay), moved towards an even distribution for
//! the wanted lengths, thinned and filled where they crowd or leave holes, and at last moved one by one wherever that
//! opens the smallest angle around a point. Each step is deterministic.

use super::draft::Draft;
use super::outlines::Outlines;
use super::seeds;
use super::sizing::Sizing;
use super::{BlockError, BlockSettings};
use crate::antenna::PatchParams;
use crate::antenna::outline::contains;
use crate::geometry::DVec2;
use crate::geometry::predicates::orient2d;

/// Rounds of even spreading; the first few settle most, more than this changes nothing visible.
const SPREADING: usize = 40;
/// Rounds of spreading between two rounds of thinning and filling, and the last round that changes points.
const EDIT: (usize, usize) = (5, 25);
/// Rounds of opening angles; most are open after a few.
const OPENING: usize = 20;

/// Which parts lie over a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cover {
    pub(super) patch: bool,
    pub(super) pin: bool,
    /// Within the outer conductor's polygon but not the pin's.
    pub(super) sheath: bool,
}

/// Points in metres, triangles counter-clockwise.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    pub(super) points: Vec<DVec2>,
    pub(super) triangles: Vec<[usize; 3]>,
    pub(super) covers: Vec<Cover>,
    /// The point of each resistor.
    pub(super) posts: Vec<usize>,
}

/// Triangulates the outlines of valid parameters.
pub(super) fn triangulate(params: &PatchParams, settings: &BlockSettings) -> Result<Footprint, BlockError> {
    let sizing = Sizing::new(params, settings)?;
    let outlines = Outlines::new(params, &sizing)?;
    let mut points = outlines.points.clone();
    points.extend(seeds::pack(&outlines, &sizing, settings.inner));
    let mut print = Draft { points, n_fixed: outlines.points.len(), outlines: &outlines, sizing: &sizing };
    for round in 1..=SPREADING {
        let triangles = print.delaunay()?;
        if round % EDIT.0 == 0 && round <= EDIT.1 {
            print.thin_and_fill(&triangles, settings.inner);
        } else {
            print.spread(&triangles);
        }
    }
    for _ in 0..OPENING {
        let triangles = print.delaunay()?;
        print.open_angles(&triangles);
    }
    let triangles = print.delaunay()?;
    let points = print.points;
    let covers = triangles.iter().map(|t| cover(&outlines, t.map(|v| points[v]))).collect();
    Ok(Footprint { points, triangles, covers, posts: outlines.posts })
}

/// The parts over a triangle, which lies on one side of every outline.
fn cover(outlines: &Outlines, corners: [DVec2; 3]) -> Cover {
    let center = corners.iter().sum::<DVec2>() / 3.0;
    let within = |polygon: &Vec<DVec2>| {
        (0..polygon.len()).all(|k| orient2d(polygon[k], polygon[(k + 1) % polygon.len()], center) > 0.0)
    };
    let [pin, line] = [0, 1].map(|k| outlines.polygons.get(k).is_some_and(within));
    Cover { patch: contains(&outlines.patch, center), pin, sheath: line && !pin }
}
