//! Green coordinates against independent implementations and a 50-digit evaluation (`tests/golden/green/ORIGIN.md`).
//!
//! The numbers are in millimetres; the code is scale-free.

#![allow(clippy::unwrap_used, reason = "a test says what is wrong by panicking")]

use conformant::deform::{GreenCage, GreenMap, GreenWeights, Pose};
use conformant::geometry::{DVec3, TriMesh, VertexId};
use conformant::task::Task;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const CASES: [&str; 2] = ["antenna_bend_R10", "ico_irregular"];

struct Case {
    folder: PathBuf,
    cage: GreenCage,
    pose: Pose,
    points: Vec<DVec3>,
}

impl Case {
    fn load(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/green").join(name);
        let faces = std::fs::read_to_string(folder.join("cage_faces.csv")).unwrap();
        let corner = |s: &str| VertexId::new(s.trim().parse().unwrap());
        let face = |line: &str| <[VertexId; 3]>::try_from(line.split(',').map(corner).collect::<Vec<_>>()).unwrap();
        let vertices = vectors(&folder, "cage_rest");
        let cage = GreenCage::new(TriMesh { vertices, faces: faces.lines().map(face).collect() }).unwrap();
        let pose = Pose::new(&cage, &vectors(&folder, "cage_deformed")).unwrap();
        Self { points: vectors(&folder, "points"), folder, cage, pose }
    }

    fn weights(&self, points: &[DVec3]) -> GreenWeights {
        self.cage.weights(points, &Task::default()).unwrap()
    }
}

fn table(folder: &Path, name: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(folder.join(name).with_extension("csv")).unwrap();
    text.lines().map(|line| line.split(',').map(|s| s.trim().parse().unwrap()).collect()).collect()
}

fn vectors(folder: &Path, name: &str) -> Vec<DVec3> {
    table(folder, name).into_iter().map(|row| DVec3::from_slice(&row)).collect()
}

/// Greatest differences of phi and psi from tables.
fn worst(weights: &GreenWeights, phi: &[Vec<f64>], psi: &[Vec<f64>]) -> (f64, f64) {
    assert_eq!((phi.len(), psi.len()), (weights.n_points(), weights.n_points()), "one row for each point");
    let greatest = |table: &[Vec<f64>], weight: &dyn Fn(usize, usize) -> f64| {
        let rows = table.iter().enumerate();
        let differences = rows.flat_map(|(p, row)| row.iter().enumerate().map(move |(c, w)| (weight(p, c) - w).abs()));
        differences.fold(0.0, f64::max)
    };
    (greatest(phi, &|p, v| weights.phi(p, v)), greatest(psi, &|p, f| weights.psi(p, f)))
}

fn farthest(a: &[DVec3], b: &[DVec3]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many positions");
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

#[test]
fn weights_agree_with_an_independent_implementation() {
    for name in CASES {
        let case = Case::load(name);
        let weights = case.weights(&case.points);
        let (phi, psi) = worst(&weights, &table(&case.folder, "phi_urago"), &table(&case.folder, "psi_urago"));
        assert!(phi < 1e-12 && psi < 1e-12, "{name}: phi {phi:e}, psi {psi:e}");
    }
}

#[test]
fn stretch_factors_agree_with_an_independent_implementation() {
    for name in CASES {
        let case = Case::load(name);
        for (s, expected) in case.pose.stretch().iter().zip(table(&case.folder, "stretch_urago").concat()) {
            assert!((s - expected).abs() < 1e-13, "{name}: {s} instead of {expected}");
        }
    }
}

#[test]
fn positions_agree_with_independent_implementations() {
    for name in CASES {
        let case = Case::load(name);
        let positions = case.weights(&case.points).apply(&case.pose);
        let exact = farthest(&positions, &vectors(&case.folder, "deformed_stretch_urago"));
        assert!(exact < 1e-11, "{name}: {exact:e} mm");
        let other = farthest(&positions, &vectors(&case.folder, "deformed_stretch_lipman"));
        assert!(other < 1e-2, "{name}: {other:e} mm from the less exact variant");
        let unstretched = farthest(&positions, &vectors(&case.folder, "deformed_nostretch_urago"));
        assert!(unstretched > 1e-2, "{name}: the stretch factors make a difference, {unstretched:e} mm");
        let map = GreenMap::new(Arc::new(case.cage), case.pose);
        let direct = farthest(&map.positions(&case.points).unwrap(), &positions);
        assert!(direct < 1e-13, "{name}: {direct:e} mm between the map and the weights");
    }
}

#[test]
fn weights_near_the_surface_agree_with_fifty_digits() {
    for name in CASES {
        let case = Case::load(name);
        let weights = case.weights(&vectors(&case.folder, "near_points"));
        let (phi, psi) = worst(&weights, &table(&case.folder, "near_phi_mp50"), &table(&case.folder, "near_psi_mp50"));
        assert!(phi < 1e-13 && psi < 1e-13, "{name}: phi {phi:e}, psi {psi:e}");
    }
}
