//! Small antennas for the tests: layered boxes with an imprinted patch and a pin through them, smoothly bent.

use crate::geometry::{DVec3, Facet, Plc, Region, RegionId, RegionRole, VertexId};
use crate::units::MM;
use std::collections::HashMap;

const GROUND: usize = 1;
const SUBSTRATE: usize = 2;
const PATCH: usize = 3;
const PIN: usize = 4;

/// A random valid complex of four solids, m: ground, substrate, patch on part of it, pin from the ground to the patch.
pub(super) fn stacked(rng: &mut fastrand::Rng) -> Plc {
    let ground_mm = 0.02 + 0.05 * rng.f64();
    stacked_on(ground_mm, rng)
}

/// As [`stacked`], with a ground of a given thickness.
pub(super) fn stacked_on(ground_mm: f64, rng: &mut fastrand::Rng) -> Plc {
    let n = [rng.usize(5..8), rng.usize(5..8), 3];
    let mut region = HashMap::new();
    let pin = [rng.usize(2..n[0] - 2), rng.usize(2..n[1] - 2)];
    for x in 0..n[0] {
        for y in 0..n[1] {
            let column = if [x, y] == pin { [PIN, PIN, PATCH] } else { [GROUND, SUBSTRATE, PATCH] };
            let on_patch = (1..n[0] - 1).contains(&x) && (1..n[1] - 1).contains(&y);
            for (z, &r) in column.iter().enumerate().filter(|&(z, _)| z < 2 || on_patch) {
                region.insert([x, y, z], RegionId::new(r));
            }
        }
    }
    let widths = |rng: &mut fastrand::Rng, n: usize| stations((0..n).map(|_| 0.3 + 2.0 * rng.f64()).collect());
    let (xs, ys) = (widths(rng, n[0]), widths(rng, n[1]));
    let zs = stations(vec![ground_mm, 0.4 + 2.0 * rng.f64(), 0.02 + 0.05 * rng.f64()]);
    let map = bend(rng);
    let place = |[i, j, k]: [usize; 3]| map(DVec3::new(xs[i], ys[j], zs[k] - zs[2])) * MM;
    facets_between(n, &region, place, rng)
}

fn stations(widths: Vec<f64>) -> Vec<f64> {
    let half = widths.iter().sum::<f64>() / 2.0;
    let mut at = -half;
    std::iter::once(at)
        .chain(widths.into_iter().map(|w| {
            at += w;
            at
        }))
        .collect()
}

/// A bend of random radius with ripples far smaller than its curvature allows, then a random shift (mm to mm).
fn bend(rng: &mut fastrand::Rng) -> impl Fn(DVec3) -> DVec3 + use<> {
    let radius = 12.0 + 60.0 * rng.f64();
    let (wave, phase) = (0.2 + 0.2 * rng.f64(), 6.0 * rng.f64());
    let shift = DVec3::from_array([(); 3].map(|()| 30.0 * (rng.f64() - 0.7)));
    move |p| {
        let (sin, cos) = (p.x / radius).sin_cos();
        let r = radius + p.z + 0.1 * (wave * p.x + phase).sin() * (wave * p.y).cos();
        DVec3::new(r * sin, p.y + 0.1 * (wave * p.x).sin(), r * cos - radius) + shift
    }
}

/// One pair of triangles wherever two cells of a grid belong to different regions.
fn facets_between(
    n: [usize; 3],
    region: &HashMap<[usize; 3], RegionId>,
    place: impl Fn([usize; 3]) -> DVec3,
    rng: &mut fastrand::Rng,
) -> Plc {
    let mut ids = HashMap::new();
    let mut plc = Plc { vertices: Vec::new(), facets: Vec::new(), regions: regions() };
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for at in 0..=n[axis] {
            for (i, j) in (0..n[u]).flat_map(|i| (0..n[v]).map(move |j| (i, j))) {
                let cell = |k: Option<usize>| {
                    let mut cell = [0; 3];
                    (cell[axis], cell[u], cell[v]) = (k?, i, j);
                    region.get(&cell).copied()
                };
                let [back, front] = [at.checked_sub(1), Some(at)].map(|k| cell(k).unwrap_or(RegionId::AIR));
                if back == front {
                    continue;
                }
                let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
                    let mut corner = [0; 3];
                    (corner[axis], corner[u], corner[v]) = (at, i, j);
                    *ids.entry(corner).or_insert_with(|| {
                        plc.vertices.push(place(corner));
                        VertexId::new(plc.vertices.len() - 1)
                    })
                });
                for vertices in [[a, b, c], [a, c, d]] {
                    let [x, y, z] = vertices;
                    let facet = Facet { vertices, back, front };
                    let reversed = Facet { vertices: [x, z, y], back: front, front: back };
                    plc.facets.push(if rng.bool() { facet } else { reversed });
                }
            }
        }
    }
    plc
}

fn regions() -> Vec<Region> {
    let region = |name: &str, role, eps_r, tan_delta| Region { name: name.to_owned(), role, eps_r, tan_delta };
    vec![
        region("air", RegionRole::Air, 1.0, 0.0),
        region("ground", RegionRole::Conductor, 1.0, 0.0),
        region("substrate", RegionRole::Dielectric, 2.33, 0.0012),
        region("patch", RegionRole::Conductor, 1.0, 0.0),
        region("pin", RegionRole::Conductor, 1.0, 0.0),
    ]
}
