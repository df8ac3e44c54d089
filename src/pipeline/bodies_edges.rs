//! How finely imported bodies are meshed, and in which band they are looked at first: by the metal that is fed.

use super::mesh::MeshSettings;
use crate::antenna::bodies::with_sheets;
use crate::geometry::{DVec3, Plc, RegionRole, VertexId};
use crate::project::BodiesSpec;
use crate::tet::{Metal, Sizes};
use crate::units::C0;
use std::collections::BTreeSet;

/// Greatest extent of a resonator over the one that its edges are measured by, at the most.
const SLENDER: f64 = 2.5;
/// Thickness of a metal plate that may be taken as a sheet over the extent that edges are measured by.
const FOIL: f64 = 1.0 / 40.0;

/// What is resonant about bodies: of the two pieces of metal that are fed the smaller one, and what the gap is made of.
///
/// A piece is metal that hangs together, but for the largest body, which is the ground if there is one. Without a feed
/// it is the largest piece but one, and the greatest permittivity.
#[derive(Clone, Copy, Debug)]
struct Resonator {
    /// Greatest extent and the next one, m.
    along: f64,
    across: f64,
    eps_r: f64,
}

fn resonator(bodies: &BodiesSpec) -> Resonator {
    let plc = bodies.to_plc();
    let gap = bodies.gap().ok().flatten();
    let mut pieces = pieces(&plc);
    let eps_r = match gap {
        Some(gap) => {
            pieces.retain(|(vertices, _)| gap.ends.iter().any(|v| vertices.contains(v)));
            plc.regions[gap.region.index()].eps_r
        }
        None => {
            if pieces.len() > 2 {
                pieces.drain(..pieces.len() - 2);
            }
            plc.regions.iter().map(|r| r.eps_r).fold(1.0, f64::max)
        }
    };
    let (lo, hi) = bodies.bounds();
    let [_, across, along] = pieces.first().map_or_else(|| ascending(hi - lo), |p| p.1);
    Resonator { along, across, eps_r }
}

fn ascending(extents: DVec3) -> [f64; 3] {
    let mut extents = extents.to_array();
    extents.sort_by(f64::total_cmp);
    extents
}

/// The pieces of metal, the smallest first: their vertices, and their extents, ascending, m.
fn pieces(plc: &Plc) -> Vec<(BTreeSet<VertexId>, [f64; 3])> {
    let metal = plc.solids().filter(|(_, r)| r.role == RegionRole::Conductor);
    let mut bodies: Vec<BTreeSet<VertexId>> =
        metal.map(|(id, _)| plc.boundary_faces(id).into_iter().flatten().collect()).collect();
    let extents = |vertices: &BTreeSet<VertexId>| {
        let places = vertices.iter().map(|v| plc.vertices[v.index()]);
        let (lo, hi) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        ascending(hi - lo)
    };
    bodies.sort_by(|a, b| extents(a)[2].total_cmp(&extents(b)[2]));
    let largest = bodies.pop();
    let mut pieces: Vec<BTreeSet<VertexId>> = Vec::new();
    for mut body in bodies {
        let (joined, apart): (Vec<_>, Vec<_>) = pieces.into_iter().partition(|piece| !piece.is_disjoint(&body));
        body.extend(joined.into_iter().flatten());
        pieces = apart;
        pieces.push(body);
    }
    let mut pieces: Vec<_> = pieces.into_iter().chain(largest).map(|p| (extents(&p), p)).map(|(e, p)| (p, e)).collect();
    pieces.sort_by(|a, b| a.1[2].total_cmp(&b.1[2]));
    pieces
}

/// A band to begin with: around the half-wave resonance of the fed metal, Hz.
pub(super) fn usual_band(bodies: &BodiesSpec) -> [f64; 2] {
    let Resonator { along, eps_r, .. } = resonator(bodies);
    let half_wave = C0 / (2.0 * along * eps_r.sqrt());
    [half_wave * 2.0 / 3.0, half_wave * 4.0 / 3.0]
}

/// Lengths by which bodies are meshed, m.
pub(super) struct Edges {
    pub(super) sizes: Sizes,
    /// Longest edges in the air.
    pub(super) in_air: f64,
    /// Greatest thickness of a metal plate that is taken as a sheet.
    pub(super) thickest: f64,
}

pub(super) fn edges(bodies: &BodiesSpec, settings: MeshSettings, band: [f64; 2]) -> Edges {
    let fineness = settings.density.fineness();
    let in_air = C0 / band[1] / fineness.per_wavelength;
    let Resonator { along, across, .. } = resonator(bodies);
    let extent = across.max(along / SLENDER);
    let size = |part: f64| (part * extent).min(in_air);
    let thickest = if settings.metal == Metal::Sheet { FOIL * extent } else { 0.0 };
    Edges { sizes: Sizes { inner: size(fineness.inner), at_metal: size(fineness.rim) }, in_air, thickest }
}

/// Smallest extent of a body that is no sheet, m.
pub(super) fn thinnest(bodies: &BodiesSpec, edges: &Edges) -> f64 {
    let plc = bodies.to_plc();
    let kept: Vec<VertexId> = bodies.gap().ok().flatten().iter().flat_map(|gap| gap.ends).collect();
    let is_sheet = with_sheets(&plc, edges.thickest, &kept).is_sheet;
    let bodies = plc.solids().filter(|(id, _)| !is_sheet[id.index()]).map(|(id, _)| plc.boundary(id).bounds());
    bodies.map(|(lo, hi)| (hi - lo).min_element()).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::antenna::bodies::tests::cuboid;
    use crate::pipeline::Density;
    use crate::project::{BodyKind, BodySpec, LooseBody, WELD_MM};
    use crate::task::Task;

    #[test]
    fn a_patch_with_its_pin_is_what_resonates_over_the_ground_and_its_foil_is_thin() {
        let bodies = [
            ("ground", [-10.0, -10.0, -2.0], [10.0, 10.0, -1.6]),
            ("patch", [-5.0, -4.0, 0.0], [5.0, 4.0, 0.1]),
            ("pin", [1.0, 1.0, -1.0], [1.5, 1.5, 0.0]),
        ];
        let loose = bodies.map(|(name, lo, hi)| LooseBody {
            spec: BodySpec { name: name.to_owned(), kind: BodyKind::Metal },
            surface: cuboid(name, lo, hi, [2, 2, 1]).surface,
        });
        let bodies = BodiesSpec::weld(&loose, WELD_MM, &Task::default()).expect("they touch or are apart");
        // The feed is under the pin, the smallest body of all.
        let fed = bodies.with_upright_feed([1.25, 1.25], 50.0).expect("under the pin");
        for bodies in [&bodies, &fed] {
            let found = resonator(bodies);
            assert!((found.along - 0.010).abs() < 1e-9 && (found.across - 0.008).abs() < 1e-9, "{found:?}");
            let [lo, hi] = usual_band(bodies);
            assert!(lo < 15e9 && 15e9 < hi, "half a wave of 10 mm: {lo:e} to {hi:e} Hz");
        }
        let settings = |metal| MeshSettings { density: Density::Coarse, metal };
        for (metal, thinnest_mm) in [(Metal::Sheet, 0.4), (Metal::Solid, 0.1)] {
            let edges = edges(&fed, settings(metal), [10e9, 20e9]);
            let found = thinnest(&fed, &edges) * 1e3;
            // The patch is a sheet unless all is solid; ground and pin are too thick.
            assert!((found - thinnest_mm).abs() < 1e-6, "{metal:?}: {found} mm");
        }
    }
}
