//! The robust path: one point, every term from the corner nearest to it, and the interior limit at the surface.
//!
//! Differs from the fast path in three things, all of which matter only near the surface: heights and distances are
//! taken from the nearest corner; a face in whose plane the point lies has no solid angle; and the solid angle that is
//! then missing goes to the closest point of the surface. On a face, an edge or a vertex that gives the limit from
//! inside, where phi is continuous. Agrees with an evaluation to 50 digits to 2e-15, at any distance.

use super::block::Block;
use super::cage::{Face, GreenCage};
use super::elementary::atan2;
use crate::geometry::DVec3;
use std::f64::consts::PI;

/// Height over a face, relative to the cage's size, that is rounding only.
const IN_PLANE: f64 = 4e-16;
/// Distance from the surface, relative to the cage's size, up to which a missing solid angle is the surface's doing.
/// Rounding needs far less; beyond it a deficit would be our own fault and must show.
const CORRECTED: f64 = 1e-3;

/// Nearest place on the surface.
struct Closest {
    distance: f64,
    face: usize,
    barycentric: [f64; 3],
}

impl Block<1> {
    /// Computes the weights of one point that is inside the cage or on it.
    pub(super) fn evaluate_robustly(&mut self, cage: &GreenCage, point: DVec3) {
        self.measure(cage, &[point]);
        self.phi.fill([0.0]);
        let mut closest = Closest { distance: f64::INFINITY, face: 0, barycentric: [0.0; 3] };
        for (f, face) in cage.faces.iter().enumerate() {
            self.weigh_face(cage, f);
            let (distance, barycentric) = self.closest_point(face, self.heights[f][0]);
            if distance < closest.distance {
                closest = Closest { distance, face: f, barycentric };
            }
        }
        let deficit = 1.0 - self.phi.iter().map(|phi| phi[0]).sum::<f64>();
        if closest.distance < CORRECTED * cage.size() {
            for (b, &corner) in closest.barycentric.iter().zip(&cage.faces[closest.face].corners) {
                self.phi[corner][0] += deficit * b;
            }
            self.angles[closest.face][0] += 4.0 * PI * deficit;
        }
    }

    /// Height, solid angle, psi of one face, and what it adds to phi.
    fn weigh_face(&mut self, cage: &GreenCage, f: usize) {
        const SCALE: f64 = 0.25 / PI;
        let face = &cage.faces[f];
        let [ra, rb, rc] = face.corners.map(|v| self.radii[v][0]);
        let [ab, bc, ca] = face.edges.map(|e| self.products[e][0]);
        let logs = face.edges.map(|e| self.logs[e][0]);
        let nearest = self.nearer(face.corners[0], self.nearer(face.corners[1], face.corners[2]));
        let height = face.normal.dot(self.spoke(nearest));
        let angle = if height.abs() <= IN_PLANE * cage.size() {
            0.0
        } else {
            2.0 * atan2(height * face.double_area, ra * rb * rc + ab * rc + bc * ra + ca * rb)
        };
        let mut single_layer = -height * angle;
        for (k, log) in logs.iter().enumerate() {
            let end = self.nearer(face.corners[k], face.corners[(k + 1) % 3]);
            single_layer += face.edge_normals[k].dot(self.spoke(end)) * log;
        }
        self.heights[f] = [height];
        self.angles[f] = [angle];
        self.psi[f] = [SCALE * single_layer];
        for (i, hat) in self.hats(face).into_iter().enumerate() {
            let line: f64 = face.slopes[i].iter().zip(&logs).map(|(slope, log)| slope * log).sum();
            self.phi[face.corners[i]][0] += SCALE * (hat * angle - height * line);
        }
    }

    fn spoke(&self, vertex: usize) -> DVec3 {
        DVec3::from(self.spokes[vertex].map(|lane| lane[0]))
    }

    fn nearer(&self, a: usize, b: usize) -> usize {
        if self.radii[a][0] <= self.radii[b][0] { a } else { b }
    }

    /// The hat functions of a face at the point's foot on its plane: barycentric coordinates.
    fn hats(&self, face: &Face) -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let other = self.nearer(face.corners[(i + 1) % 3], face.corners[(i + 2) % 3]);
            -face.gradients[i].dot(self.spoke(other))
        })
    }

    /// Distance from the point to a face and barycentric coordinates of the closest point.
    fn closest_point(&self, face: &Face, height: f64) -> (f64, [f64; 3]) {
        let hats = self.hats(face);
        if hats.iter().all(|&hat| hat >= 0.0) {
            return (height.abs(), hats);
        }
        let mut best = (f64::INFINITY, [0.0; 3]);
        for k in 0..3 {
            let next = (k + 1) % 3;
            let (a, b) = (self.spoke(face.corners[k]), self.spoke(face.corners[next]));
            let run = b - a;
            let share = (-a.dot(run) / run.length_squared()).clamp(0.0, 1.0);
            let distance = (a + run * share).length();
            if distance < best.0 {
                let mut barycentric = [0.0; 3];
                (barycentric[k], barycentric[next]) = (1.0 - share, share);
                best = (distance, barycentric);
            }
        }
        best
    }
}
