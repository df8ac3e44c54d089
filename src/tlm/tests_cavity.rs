//! Resonances of cavities, empty and half filled, on this project's meshes and on those of another program.

use super::tests::{CAVITY, Closed, layered_box, mean_edge, order};
use crate::geometry::{DVec3, Region, RegionId, RegionRole, VertexId};
use crate::tet::{FaceGroup, FaceRole, MarkedFace, Tet, TetMesh, face_key};
use flate2::read::GzDecoder;
use serde::Deserialize;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::ops::Range;

const SIZES: [f64; 5] = [0.155, 0.128, 0.106, 0.088, 0.072];

/// The second order on irregular meshes.
const SECOND: Range<f64> = 1.8..2.3;

/// Orders that count as the second on our meshes: on their regular cells the leading term nearly cancels, and what is left
/// falls faster.
const SECOND_OR_BETTER: Range<f64> = 1.8..2.8;

/// Greatest error of a resonance in units of (k h)² that Whitney functions on good meshes have shown elsewhere.
const SECOND_ORDER: f64 = 0.013;

/// Fields of the modes 110, 101 and 011 of the cavity.
pub(super) fn cavity_mode(mode: usize, p: DVec3) -> DVec3 {
    let k = DVec3::new(PI, PI, PI) / CAVITY;
    let sin = (k * p).map(f64::sin);
    match mode {
        0 => DVec3::Z * sin.x * sin.y,
        1 => DVec3::Y * sin.x * sin.z,
        _ => DVec3::X * sin.y * sin.z,
    }
}

/// Errors of the first three modes of the empty cavity, in units of (k h)² at the worst, and their mean square.
fn empty_errors(mesh: &TetMesh) -> (f64, f64) {
    let k = DVec3::new(PI, PI, PI) / CAVITY;
    let exact = [k.with_z(0.0), k.with_y(0.0), k.with_x(0.0)].map(DVec3::length);
    let h = mean_edge(mesh);
    let closed = Closed::<f64>::new(mesh, true);
    let errors = [0, 1, 2].map(|m| closed.wave_number(|p| cavity_mode(m, p), exact[m]) / exact[m] - 1.0);
    let worst = errors.iter().zip(exact).map(|(e, k)| e.abs() / (k * h).powi(2)).fold(0.0, f64::max);
    (worst, (errors.iter().map(|e| e * e).sum::<f64>() / 3.0).sqrt())
}

#[test]
fn resonances_of_a_cavity_are_of_second_order() {
    let own = SIZES.map(|size| {
        let mesh = layered_box(CAVITY, &[1.0], size);
        let (worst, error) = empty_errors(&mesh);
        assert!(worst < SECOND_ORDER, "edges of {size}: {worst} (k h)²");
        (mean_edge(&mesh), error)
    });
    assert!(SECOND_OR_BETTER.contains(&order(&own)), "order {}: {own:?}", order(&own));
    let foreign: Vec<_> = foreign_meshes([1.0, 1.0]).iter().map(|(edge, mesh)| (*edge, empty_errors(mesh).1)).collect();
    assert!(SECOND.contains(&order(&foreign)), "order {}: {foreign:?}", order(&foreign));
}

/// Wave number of the lowest mode of the cavity whose lower half is filled, and the axial ones in both halves: the root
/// of `k1 tan(k1 d) / eps_r = q tanh(q d)`.
fn half_filled(eps_r: f64) -> (f64, f64, f64) {
    let d = CAVITY.z / 2.0;
    let across = (PI / CAVITY.x).powi(2) + (PI / CAVITY.y).powi(2);
    let parts = |k: f64| ((eps_r * k * k - across).max(0.0).sqrt(), (across - k * k).max(0.0).sqrt());
    let (mut lo, mut hi) = ((across / eps_r).sqrt(), across.sqrt());
    while hi - lo > 1e-14 * hi {
        let k = (lo + hi) / 2.0;
        let (k1, q) = parts(k);
        if k1 * (k1 * d).tan() / eps_r < q * (q * d).tanh() { lo = k } else { hi = k }
    }
    let (k1, q) = parts(lo);
    (lo, k1, q)
}

const EPS_R: f64 = 2.2;

/// Mean edge and error of the lowest mode of the half-filled cavity.
fn half_filled_error(mesh: &TetMesh) -> (f64, f64) {
    let (exact, k1, q) = half_filled(EPS_R);
    let d = CAVITY.z / 2.0;
    let k = DVec3::new(PI, PI, 0.0) / CAVITY;
    // E = curl curl (z psi) / eps, with psi = sin sin phi(z).
    let field = |p: DVec3| {
        let (phi, slope, eps_r) = if p.z < d {
            let scale = (k1 * d).cos();
            ((k1 * p.z).cos() / scale, -k1 * (k1 * p.z).sin() / scale, EPS_R)
        } else {
            let (scale, z) = ((q * d).cosh(), CAVITY.z - p.z);
            ((q * z).cosh() / scale, -q * (q * z).sinh() / scale, 1.0)
        };
        let (sin, cos) = ((k * p).map(f64::sin), (k * p).map(f64::cos));
        let along = k.x * cos.x * sin.y * slope;
        DVec3::new(along, k.y * sin.x * cos.y * slope, k.length_squared() * sin.x * sin.y * phi) / eps_r
    };
    let h = mean_edge(mesh);
    let error = Closed::<f64>::new(mesh, true).wave_number(field, exact) / exact - 1.0;
    // The wave is shorter in the filled half.
    assert!(error.abs() < SECOND_ORDER * EPS_R * (exact * h).powi(2), "h {h}: {error:e}");
    (h, error)
}

#[test]
fn a_half_filled_cavity_is_of_second_order_too() {
    let errors = SIZES.map(|size| half_filled_error(&layered_box(CAVITY, &[EPS_R, 1.0], size)));
    assert!(SECOND_OR_BETTER.contains(&order(&errors)), "order {}: {errors:?}", order(&errors));
    let errors: Vec<_> =
        foreign_meshes([EPS_R, 1.0]).iter().map(|(edge, mesh)| (*edge, half_filled_error(mesh).1)).collect();
    assert!(SECOND.contains(&order(&errors)), "order {}: {errors:?}", order(&errors));
}

/// A mesh of the cavity by another program.
#[derive(Deserialize)]
struct Foreign {
    /// Length of edges that was asked for, m.
    edge: f64,
    vertices: Vec<[f64; 3]>,
    tets: Vec<[usize; 4]>,
    /// 1 for cells of the upper half.
    upper: Vec<usize>,
}

/// The meshes with the edges that were asked for, m.
///
/// * `eps_r`: of the lower and the upper half.
fn foreign_meshes(eps_r: [f64; 2]) -> Vec<(f64, TetMesh)> {
    let data: &[u8] = include_bytes!("../../tests/golden/cavity/half_filled.json.gz");
    let all: Vec<Foreign> = serde_json::from_reader(GzDecoder::new(data)).expect("a list of meshes");
    let region = |eps_r| Region { name: String::new(), role: RegionRole::Dielectric, eps_r, tan_delta: 0.0 };
    let mesh = |foreign: Foreign| {
        let cells = foreign.tets.iter().zip(foreign.upper);
        let tets: Vec<Tet> =
            cells.map(|(v, upper)| Tet { vertices: v.map(VertexId::new), region: RegionId::new(1 + upper) }).collect();
        let mut walls: HashMap<[VertexId; 3], [VertexId; 3]> = HashMap::new();
        for face in tets.iter().flat_map(|t| (0..4).map(|i| t.face(i))) {
            if walls.remove(&face_key(face)).is_none() {
                walls.insert(face_key(face), face);
            }
        }
        let mesh = TetMesh {
            vertices: foreign.vertices.into_iter().map(DVec3::from_array).collect(),
            tets,
            faces: walls.into_values().map(|vertices| MarkedFace { vertices, group: 0 }).collect(),
            regions: [1.0, eps_r[0], eps_r[1]].map(region).to_vec(),
            groups: vec![FaceGroup { name: "walls".to_owned(), role: FaceRole::Conductor }],
        };
        (foreign.edge, mesh)
    };
    all.into_iter().map(mesh).collect()
}
