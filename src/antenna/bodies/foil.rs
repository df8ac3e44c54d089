//! Thin metal plates as sheets: of each one face is left, which holds the whole current.
//!
//! A plate counts as thin by its thickness alone. The face that touches something stays, or of a plate in air the lower
//! one; the other face and the sides, which are in air, go. A plate that touches something with both faces, and one with
//! a place on it that must stay but would go, remains a body.

use crate::geometry::tri_mesh::doubled_area_vector;
use crate::geometry::{Facet, Plc, RegionId, RegionRole, VertexId};

/// Greatest part of the area by which the two faces of a plate may differ: walls may lean.
const UNEQUAL: f64 = 0.1;
/// Height of a face's vertices over the thickness: drawn plates are flat.
const FLAT: f64 = 0.01;

/// A complex some of whose conductors are sheets.
#[derive(Clone, Debug, PartialEq)]
pub struct WithSheets {
    /// Without the facets that went; regions and vertices are numbered as before.
    pub plc: Plc,
    /// For each region whether it is a sheet: its facets carry its condition, but nothing is within.
    pub is_sheet: Vec<bool>,
}

/// Takes thin plates as sheets.
///
/// * `thickest`: greatest thickness of a plate that is taken so, m.
/// * `keep`: vertices that must stay on metal.
#[must_use]
pub fn with_sheets(plc: &Plc, thickest: f64, keep: &[VertexId]) -> WithSheets {
    let mut is_kept = vec![true; plc.facets.len()];
    let mut is_sheet = vec![false; plc.regions.len()];
    for (id, _) in plc.solids().filter(|(_, r)| r.role == RegionRole::Conductor) {
        if let Some(gone) = Plate::of(plc, id, thickest).and_then(|plate| plate.gone(keep)) {
            is_sheet[id.index()] = true;
            gone.into_iter().for_each(|f| is_kept[f] = false);
        }
    }
    let facets = plc.facets.iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(f, _)| *f).collect();
    WithSheets { plc: Plc { facets, ..plc.clone() }, is_sheet }
}

/// A thin plate by its facets' numbers in the complex.
struct Plate<'a> {
    plc: &'a Plc,
    region: RegionId,
    /// The facets of the lower and the upper face.
    faces: [Vec<usize>; 2],
    walls: Vec<usize>,
}

impl<'a> Plate<'a> {
    fn of(plc: &'a Plc, region: RegionId, thickest: f64) -> Option<Self> {
        let own: Vec<usize> =
            (0..plc.facets.len()).filter(|&f| [plc.facets[f].back, plc.facets[f].front].contains(&region)).collect();
        let area = |f: usize| doubled_area_vector(plc.corners(f));
        let largest = own.iter().copied().max_by(|&f, &g| area(f).length().total_cmp(&area(g).length()))?;
        let mut normal = area(largest).normalize_or_zero();
        // The lower face is the lower one however the largest facet is turned.
        if normal[normal.abs().max_position()] < 0.0 {
            normal = -normal;
        }
        let heights = |f: usize| plc.corners(f).map(|p| p.dot(normal));
        let all = || own.iter().flat_map(|&f| heights(f));
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let is_at = |f: usize, level: f64| heights(f).iter().all(|h| (h - level).abs() <= FLAT * (high - low));
        let faces = [low, high].map(|level| own.iter().copied().filter(|&f| is_at(f, level)).collect::<Vec<_>>());
        let walls = own.iter().copied().filter(|&f| !is_at(f, low) && !is_at(f, high)).collect();
        let [lower, upper] = faces.each_ref().map(|face| face.iter().map(|&f| area(f).length()).sum::<f64>());
        let is_plate = high - low <= thickest && (lower - upper).abs() <= UNEQUAL * lower.max(upper);
        is_plate.then_some(Self { plc, region, faces, walls })
    }

    /// The facets that go; `None` where it remains a body.
    fn gone(&self, keep: &[VertexId]) -> Option<Vec<usize>> {
        let facet = |f: &usize| &self.plc.facets[*f];
        let own = || self.faces.iter().flatten().chain(&self.walls);
        let is_free = |k: usize| self.faces[k].iter().all(|f| self.other(facet(f)) == RegionId::AIR);
        let stays = |k: usize| {
            let holds = |v: &VertexId| self.faces[k].iter().any(|f| facet(f).vertices.contains(v));
            let touches = |v: &VertexId| own().any(|f| facet(f).vertices.contains(v));
            is_free(1 - k) && keep.iter().all(|v| holds(v) || !touches(v))
        };
        let face = match [stays(0), stays(1)] {
            // Both would do: what touches something is the antenna's plane.
            [true, true] => usize::from(is_free(0) && !is_free(1)),
            [true, false] => 0,
            [false, true] => 1,
            [false, false] => return None,
        };
        let bounds_air = |f: &&usize| self.other(facet(f)) == RegionId::AIR;
        Some(self.faces[1 - face].iter().chain(self.walls.iter().filter(bounds_air)).copied().collect())
    }

    fn other(&self, facet: &Facet) -> RegionId {
        if facet.back == self.region { facet.front } else { facet.back }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::cuboid;
    use super::super::{Body, weld};
    use super::*;
    use crate::geometry::DVec3;
    use crate::task::Task;

    fn metal(name: &str, lo: [f64; 3], hi: [f64; 3]) -> Body {
        Body { role: RegionRole::Conductor, ..cuboid(name, lo, hi, [1, 1, 1]) }
    }

    fn area_mm2(plc: &Plc, name: &str) -> f64 {
        let id = plc.region(name).expect("a region");
        let own = (0..plc.facets.len()).filter(|&f| [plc.facets[f].back, plc.facets[f].front].contains(&id));
        own.map(|f| doubled_area_vector(plc.corners(f)).length() / 2.0 * 1e6).sum()
    }

    #[test]
    fn a_foil_leaves_the_face_that_touches_something_and_a_block_stays() {
        let bodies = [
            cuboid("base", [0.0, 0.0, 0.0], [10.0, 10.0, 1.0], [2, 2, 1]),
            metal("patch", [2.0, 2.0, 1.0], [8.0, 7.0, 1.1]),
            metal("ground", [-1.0, -1.0, -0.1], [11.0, 11.0, 0.0]),
            metal("director", [2.0, 2.0, 3.0], [8.0, 7.0, 3.1]),
            metal("block", [20.0, 0.0, 0.0], [22.0, 2.0, 0.5]),
        ];
        let plc = weld(&bodies, &[], 1e-6, &Task::default()).expect("they touch or are apart");
        let thin = with_sheets(&plc, 0.2e-3, &[]);
        assert_eq!(thin.is_sheet, [false, false, true, true, true, false], "the air, the base, foils, the block");
        for (name, area) in [("patch", 30.0), ("ground", 144.0), ("director", 30.0), ("block", 12.0)] {
            let found = area_mm2(&thin.plc, name);
            assert!((found / area - 1.0).abs() < 1e-9, "{name}: {found} mm2");
        }
        let level = |name: &str| {
            let id = thin.plc.region(name).expect("a region");
            let own = thin.plc.facets.iter().filter(|f| [f.back, f.front].contains(&id));
            own.flat_map(|f| f.vertices.map(|v| thin.plc.vertices[v.index()].z)).fold(f64::NEG_INFINITY, f64::max)
        };
        for (name, z) in [("patch", 1e-3), ("ground", 0.0), ("director", 3e-3)] {
            assert!((level(name) - z).abs() < 1e-9, "{name} at {} m", level(name));
        }
        assert_eq!(with_sheets(&plc, 0.05e-3, &[]).plc, plc, "thicker ones are bodies");
    }

    #[test]
    fn a_place_that_must_stay_chooses_the_face() {
        let bodies = [metal("strip", [0.0, 0.0, 0.0], [5.0, 1.0, 0.1])];
        let (top, side) = (DVec3::new(1.0, 0.5, 0.1) * 1e-3, DVec3::new(5.0, 0.5, 0.05) * 1e-3);
        let plc = weld(&bodies, &[top, side], 1e-6, &Task::default()).expect("one body");
        let at = |p: DVec3| VertexId::new(plc.vertices.iter().position(|q| q.distance(p) < 1e-9).expect("a vertex"));
        let above = with_sheets(&plc, 0.2e-3, &[at(top)]);
        assert!(above.plc.facets.iter().all(|f| f.vertices.iter().all(|v| plc.vertices[v.index()].z > 0.9e-4)));
        assert_eq!(with_sheets(&plc, 0.2e-3, &[at(side)]).plc, plc, "a feed at its side keeps the body");
    }
}
