//! The outer boundary: a sphere of nearly equal triangles.

use crate::geometry::DVec3;
use std::collections::HashMap;

/// Points and outward triangles of a sphere about `center`, its edges at most about `edge` long.
///
/// An icosahedron whose faces are divided into n² triangles each and moved onto the sphere.
#[must_use]
pub fn sphere(center: DVec3, radius: f64, edge: f64) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let (corners, faces) = icosahedron();
    // The edge of the icosahedron of radius 1 is 1.05; in the middle of a face the projection stretches it by 1.18.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and a few hundred")]
    let n = (1.05 * radius / edge).ceil().clamp(2.0, 400.0) as usize;
    let mut names: HashMap<[(usize, usize); 3], usize> = HashMap::new();
    let mut points: Vec<DVec3> = Vec::new();
    let mut triangles = Vec::new();
    for face in faces {
        let mut id = |i: usize, j: usize| {
            // Barycentric weights by corner: the same for the faces that share an edge.
            let mut name = [(face[0], n - i - j), (face[1], i), (face[2], j)];
            name.iter_mut().filter(|w| w.1 == 0).for_each(|w| w.0 = usize::MAX);
            name.sort_unstable();
            *names.entry(name).or_insert_with(|| {
                let used = name.iter().filter(|w| w.1 > 0);
                let p: DVec3 = used.map(|&(c, w)| corners[c] * w as f64).sum();
                points.push(center + p.try_normalize().unwrap_or(DVec3::X) * radius);
                points.len() - 1
            })
        };
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([id(i, j), id(i + 1, j), id(i, j + 1)]);
                if i + j + 2 <= n {
                    triangles.push([id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
                }
            }
        }
    }
    (points, triangles)
}

/// Corners on the unit sphere and outward faces.
fn icosahedron() -> ([DVec3; 12], [[usize; 3]; 20]) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let length = golden.hypot(1.0);
    let corner = |k: usize| {
        let (short, long) = (if k & 1 == 0 { 1.0 } else { -1.0 }, if k & 2 == 0 { golden } else { -golden });
        let p = [DVec3::new(0.0, short, long), DVec3::new(short, long, 0.0), DVec3::new(long, 0.0, short)][k / 4];
        p / length
    };
    let corners: [DVec3; 12] = std::array::from_fn(corner);
    let edge = 2.0 / length * 1.001;
    let near = |i: usize, j: usize| corners[i].distance(corners[j]) < edge;
    let mut faces = [[0; 3]; 20];
    let triples = (0..12).flat_map(|i| (i + 1..12).flat_map(move |j| (j + 1..12).map(move |k| [i, j, k])));
    let adjacent = triples.filter(|&[i, j, k]| near(i, j) && near(j, k) && near(i, k));
    for (face, [i, j, k]) in faces.iter_mut().zip(adjacent) {
        let outward = (corners[j] - corners[i]).cross(corners[k] - corners[i]).dot(corners[i]) > 0.0;
        *face = if outward { [i, j, k] } else { [i, k, j] };
    }
    (corners, faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{TriMesh, VertexId};

    #[test]
    fn a_sphere_is_closed_and_outward() {
        let (points, triangles) = sphere(DVec3::X, 2.0, 0.3);
        let faces = triangles.iter().map(|t| t.map(VertexId::new)).collect();
        let mesh = TriMesh { vertices: points.clone(), faces };
        assert_eq!(mesh.check(), Ok(()), "closed and outward");
        assert_eq!(points.len() + triangles.len(), 2 + 3 * triangles.len() / 2, "Euler");
        let edge = |t: &[usize; 3]| (0..3).map(|k| points[t[k]].distance(points[t[(k + 1) % 3]])).fold(0.0, f64::max);
        let longest = triangles.iter().map(edge).fold(0.0, f64::max);
        assert!(longest < 0.37 && longest > 0.25, "longest edge {longest}");
    }
}
