//! Cages and points for the tests.

use crate::geometry::{DMat3, DVec3, TriMesh, VertexId};
use glam::DQuat;
use std::collections::HashMap;

/// A cuboid of 2 by 1.6 by 0.3 about the origin, `nx` by `ny` by 1 segments, two triangles to a quad.
pub(super) fn cuboid(nx: usize, ny: usize) -> TriMesh {
    let n = [nx, ny, 1];
    let mut numbers = HashMap::new();
    let mut mesh = TriMesh::default();
    let mut vertex = |mesh: &mut TriMesh, at: [usize; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            let unit = DVec3::from([0, 1, 2].map(|k| at[k] as f64 / n[k] as f64 - 0.5));
            mesh.vertices.push(unit * DVec3::new(2.0, 1.6, 0.3));
            VertexId::new(mesh.vertices.len() - 1)
        })
    };
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (end, i, j) in [0, n[axis]]
            .iter()
            .flat_map(|&e| (0..n[u]).map(move |i| (e, i)))
            .flat_map(|(e, i)| (0..n[v]).map(move |j| (e, i, j)))
        {
            let mut corner = |i: usize, j: usize| {
                let mut at = [end; 3];
                (at[u], at[v]) = (i, j);
                vertex(&mut mesh, at)
            };
            let mut quad = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            if end == 0 {
                quad.reverse();
            }
            let [a, b, c, d] = quad;
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// An octahedron subdivided `depth` times onto the unit sphere, its radii scattered by a fifth.
pub(super) fn bumpy_sphere(depth: usize, seed: u64) -> TriMesh {
    let mut vertices = vec![DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let mut faces = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for _ in 0..depth {
        let mut middles = HashMap::new();
        let mut next = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |i: usize, j: usize| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    vertices.push((vertices[i] + vertices[j]).try_normalize().unwrap());
                    vertices.len() - 1
                })
            };
            let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
        }
        faces = next;
    }
    let mut rng = fastrand::Rng::with_seed(seed);
    let rotation = random_rotation(&mut rng);
    let vertices = vertices.into_iter().map(|v| rotation * v * (0.8 + 0.4 * rng.f64())).collect();
    TriMesh { vertices, faces: faces.into_iter().map(|f| f.map(VertexId::new)).collect() }
}

/// Uniform in the cube from -1 to 1.
pub(super) fn random_point(rng: &mut fastrand::Rng) -> DVec3 {
    DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - DVec3::ONE
}

pub(super) fn random_rotation(rng: &mut fastrand::Rng) -> DMat3 {
    let axis = (random_point(rng) + DVec3::splat(1e-3)).try_normalize().unwrap();
    DMat3::from_quat(DQuat::from_axis_angle(axis, 6.0 * rng.f64()))
}

/// `n` random points of a cage.
pub(super) fn interior_points(cage: &super::GreenCage, n: usize, seed: u64) -> Vec<DVec3> {
    let mut rng = fastrand::Rng::with_seed(seed);
    let (lo, hi) = cage.rest().bounds();
    let mut draw = || (lo + hi) / 2.0 + random_point(&mut rng) * (hi - lo) / 2.0;
    std::iter::repeat_with(&mut draw).filter(|&p| cage.contains(p)).take(n).collect()
}

/// The cage's vertices, scattered by a fraction of its size.
pub(super) fn scattered(cage: &super::GreenCage, amount: f64, seed: u64) -> Vec<DVec3> {
    let mut rng = fastrand::Rng::with_seed(seed);
    cage.rest().vertices.iter().map(|&v| v + random_point(&mut rng) * (amount * cage.size())).collect()
}
