//! A feed across a gap: a straight line between two places on metal through one dielectric or the air.

use crate::geometry::intersect::segment_meets_triangle;
use crate::geometry::{DVec2, DVec3, Facet, Plc, RegionId, RegionRole, VertexId, inside};
use crate::units::to_mm;

/// The gap of a feed in a welded complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// Its ends, on metal.
    pub ends: [VertexId; 2],
    /// What it runs through.
    pub region: RegionId,
}

/// Why there is no gap.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GapError {
    /// An end is not on metal.
    #[error("the feed's end at {} mm does not lie on a metal body: move it onto its surface", place(*at))]
    OffMetal {
        /// The end, m.
        at: DVec3,
    },
    /// The line runs through the surface of a body.
    #[error("the feed runs through the surface of \"{body}\" near {} mm: it must stay within one dielectric or the air", place(*at))]
    Crosses {
        /// The body.
        body: String,
        /// Middle of the facet, m.
        at: DVec3,
    },
    /// The line runs through metal.
    #[error("the feed runs within the metal of \"{body}\": its ends must face each other across a gap")]
    InMetal {
        /// The body.
        body: String,
    },
    /// No gap between metal above a place.
    #[error("there is no gap between two metal bodies above each other at ({:.3}, {:.3}) mm: move the feed", to_mm(at.x), to_mm(at.y))]
    NoUpright {
        /// The place, m.
        at: DVec2,
    },
}

fn place(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(to_mm);
    format!("({x:.3}, {y:.3}, {z:.3})")
}

fn is_metal(plc: &Plc, region: RegionId) -> bool {
    plc.regions[region.index()].role == RegionRole::Conductor
}

/// The gap between two places that are vertices of the complex to within the tolerance, m.
///
/// # Errors
/// [`GapError`].
pub fn gap(plc: &Plc, ends: [DVec3; 2], tolerance: f64) -> Result<Gap, GapError> {
    let bounds_metal = |f: &&Facet| is_metal(plc, f.back) || is_metal(plc, f.front);
    let on_metal = |at: DVec3| {
        let distance = |v: &VertexId| plc.vertices[v.index()].distance(at);
        let vertices = plc.facets.iter().filter(bounds_metal).flat_map(|f| f.vertices);
        let nearest = vertices.min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
        nearest.filter(|v| distance(v) <= tolerance).ok_or(GapError::OffMetal { at })
    };
    let [from, to] = [on_metal(ends[0])?, on_metal(ends[1])?];
    let [p, q] = [from, to].map(|v| plc.vertices[v.index()]);
    for (f, facet) in plc.facets.iter().enumerate() {
        let touches = facet.vertices.iter().any(|v| [from, to].contains(v));
        if !touches && segment_meets_triangle(p, q, plc.corners(f)) {
            let body = if facet.back == RegionId::AIR { facet.front } else { facet.back };
            let at = plc.corners(f).iter().sum::<DVec3>() / 3.0;
            return Err(GapError::Crosses { body: plc.regions[body.index()].name.clone(), at });
        }
    }
    let middle = p.midpoint(q);
    let region = plc.solids().map(|(id, _)| id).find(|&id| inside::contains(&plc.boundary(id), middle));
    let region = region.unwrap_or(RegionId::AIR);
    if is_metal(plc, region) {
        return Err(GapError::InMetal { body: plc.regions[region.index()].name.clone() });
    }
    Ok(Gap { ends: [from, to], region })
}

/// The ends of the lowest gap between metal above each other at a place, m.
///
/// # Errors
/// [`GapError::NoUpright`].
pub fn upright(plc: &Plc, at: DVec2) -> Result<[DVec3; 2], GapError> {
    // Where the upright line meets facets: its height, and whether there is metal below and above.
    let mut hits: Vec<(f64, [bool; 2])> = Vec::new();
    for (f, facet) in plc.facets.iter().enumerate() {
        let [a, b, c] = plc.corners(f);
        let area = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
        let [p, q, r] = [a, b, c].map(DVec3::truncate);
        let whole = area(p, q, r);
        let weights = [area(q, r, at), area(r, p, at), area(p, q, at)].map(|w| w / whole);
        // NaN, of a facet that stands upright, is not in it either.
        if weights.iter().all(|w| *w >= 0.0) {
            let sides = [facet.back, facet.front].map(|r| is_metal(plc, r));
            let [below, above] = if whole > 0.0 { sides } else { [sides[1], sides[0]] };
            hits.push((a.z * weights[0] + b.z * weights[1] + c.z * weights[2], [below, above]));
        }
    }
    hits.retain(|(_, [below, above])| below != above);
    hits.sort_by(|p, q| p.0.total_cmp(&q.0));
    let pair = hits.windows(2).find(|w| w[0].1 == [true, false] && w[1].1 == [false, true] && w[0].0 < w[1].0);
    pair.map(|w| [at.extend(w[0].0), at.extend(w[1].0)]).ok_or(GapError::NoUpright { at })
}
