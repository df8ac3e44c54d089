//! Green coordinates: weights, direct positions and Jacobians, and the products with a pose.
//!
//! One and all threads over cages of three sizes. `cargo bench --bench green`; items are point-face pairs where
//! weights are computed, points elsewhere.

use conformant::deform::{GreenCage, GreenMap, GreenWeights, Pose};
use conformant::geometry::{DVec3, TriMesh, VertexId};
use conformant::task::Task;
use divan::Bencher;
use divan::counter::ItemsCount;
use std::collections::HashMap;
use std::sync::{Arc, LazyLock};

/// Segments along x and y.
const CAGES: [(usize, usize); 3] = [(2, 1), (10, 1), (10, 10)];
const MANY: usize = 100_000;

fn main() {
    divan::main();
}

/// A cuboid of 26 by 26 by 7.6 mm around an antenna, two triangles to a quad.
fn cuboid(nx: usize, ny: usize) -> GreenCage {
    let n = [nx, ny, 1];
    let mut numbers = HashMap::new();
    let mut mesh = TriMesh::default();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in [0, n[axis]] {
            for quad in (0..n[u] * n[v]).map(|q| (q % n[u], q / n[u])) {
                let mut corner = |i: usize, j: usize| {
                    let mut at = [end; 3];
                    (at[u], at[v]) = (quad.0 + i, quad.1 + j);
                    *numbers.entry(at).or_insert_with(|| {
                        let unit = DVec3::from([0, 1, 2].map(|k| at[k] as f64 / n[k] as f64 - 0.5));
                        mesh.vertices.push(unit * DVec3::new(26e-3, 26e-3, 7.6e-3));
                        VertexId::new(mesh.vertices.len() - 1)
                    })
                };
                let mut quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                if end == 0 {
                    quad.reverse();
                }
                let [a, b, c, d] = quad;
                mesh.faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    GreenCage::new(mesh).expect("a cuboid is closed")
}

/// Points of an antenna of 20 by 20 by 1.6 mm in the middle of the cage.
fn antenna_points(n: usize) -> Vec<DVec3> {
    let mut rng = fastrand::Rng::with_seed(1);
    let mut unit = || rng.f64() - 0.5;
    (0..n).map(|_| DVec3::new(20e-3 * unit(), 20e-3 * unit(), 1.6e-3 * unit())).collect()
}

/// Bent about the y axis.
fn bent(cage: &GreenCage) -> Pose {
    let bend = |p: &DVec3| {
        let (sin, cos) = (p.x / 10e-3).sin_cos();
        let r = 10e-3 + p.z;
        DVec3::new(r * sin, p.y, r * cos - 10e-3)
    };
    Pose::new(cage, &cage.rest().vertices.iter().map(bend).collect::<Vec<_>>()).expect("no face collapses")
}

/// With one vertex moved a little.
fn dragged(cage: &GreenCage, pose: &Pose) -> Pose {
    let mut vertices = pose.vertices().to_vec();
    vertices[cage.n_vertices() / 2].z += 1e-4;
    Pose::new(cage, &vertices).expect("no face collapses")
}

/// A pool of so many threads; 0 is all.
fn pool(n: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads can be made")
}

fn pairs(cage: &GreenCage, n: usize) -> ItemsCount {
    ItemsCount::new(cage.n_faces() * n)
}

#[divan::bench(args = CAGES, consts = [1, 0])]
fn weights<const THREADS: usize>(bencher: Bencher<'_, '_>, (nx, ny): (usize, usize)) {
    let cage = cuboid(nx, ny);
    let points = antenna_points(8 * 520);
    let task = Task::default();
    let pool = pool(THREADS);
    bencher.counter(pairs(&cage, points.len())).bench(|| pool.install(|| cage.weights(&points, &task)));
}

#[divan::bench(args = CAGES, consts = [1, 0])]
fn positions<const THREADS: usize>(bencher: Bencher<'_, '_>, (nx, ny): (usize, usize)) {
    let cage = cuboid(nx, ny);
    let points = antenna_points(10_000);
    let counter = pairs(&cage, points.len());
    let pose = bent(&cage);
    let map = GreenMap::new(Arc::new(cage), pose);
    let pool = pool(THREADS);
    bencher.counter(counter).bench(|| pool.install(|| map.positions(&points)));
}

#[divan::bench(args = CAGES, consts = [1, 0])]
fn jacobians_of_500<const THREADS: usize>(bencher: Bencher<'_, '_>, (nx, ny): (usize, usize)) {
    let cage = cuboid(nx, ny);
    let points = antenna_points(500);
    let counter = pairs(&cage, points.len());
    let pose = bent(&cage);
    let map = GreenMap::new(Arc::new(cage), pose);
    let pool = pool(THREADS);
    bencher.counter(counter).bench(|| pool.install(|| map.jacobians(&points)));
}

static LARGE: LazyLock<(GreenCage, GreenWeights)> = LazyLock::new(|| {
    let cage = cuboid(10, 10);
    let weights = cage.weights(&antenna_points(MANY), &Task::default()).expect("the antenna is inside");
    (cage, weights)
});

#[divan::bench]
fn apply_f64(bencher: Bencher<'_, '_>) {
    let (cage, weights) = &*LARGE;
    let pose = bent(cage);
    bencher.counter(ItemsCount::new(MANY)).bench(|| weights.apply(&pose));
}

#[divan::bench]
fn apply_f32(bencher: Bencher<'_, '_>) {
    let (cage, weights) = &*LARGE;
    let (pose, weights) = (bent(cage), weights.to_preview());
    bencher.counter(ItemsCount::new(MANY)).bench(|| weights.apply(&pose));
}

#[divan::bench]
fn drag_one_vertex_f64(bencher: Bencher<'_, '_>) {
    let (cage, weights) = &*LARGE;
    let (from, mut positions) = (bent(cage), weights.apply(&bent(cage)));
    let to = dragged(cage, &from);
    bencher.counter(ItemsCount::new(MANY)).bench_local(|| weights.apply_change(&mut positions, &from, &to));
}

#[divan::bench]
fn drag_one_vertex_f32(bencher: Bencher<'_, '_>) {
    let (cage, weights) = &*LARGE;
    let weights = weights.to_preview();
    let (from, mut positions) = (bent(cage), weights.apply(&bent(cage)));
    let to = dragged(cage, &from);
    bencher.counter(ItemsCount::new(MANY)).bench_local(|| weights.apply_change(&mut positions, &from, &to));
}
