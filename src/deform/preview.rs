//! Single-precision weights, for what is only looked at.

use super::Pose;
use super::columns::{Columns, changes};
use crate::geometry::DVec3;

/// The Green coordinates of many points in single precision: half the memory, twice the speed.
///
/// What is applied is the change from the rest pose, less the vertices' mean displacement, so that a small change has
/// a small error wherever the cage is moved. Measured on points up to the surface, cage vertices scattered by a
/// twentieth of the cage's size: within 5e-7 of the size. For display only: everything saved or solved takes
/// [`GreenWeights`](super::GreenWeights).
#[derive(Clone, Debug)]
pub struct PreviewWeights {
    n_vertices: usize,
    points: Vec<[f32; 3]>,
    rest: Vec<DVec3>,
    columns: Columns<f32>,
}

#[allow(clippy::cast_possible_truncation, reason = "single precision is what this is for")]
fn single(v: DVec3) -> [f32; 3] {
    v.to_array().map(|x| x as f32)
}

impl PreviewWeights {
    #[allow(clippy::cast_possible_truncation, reason = "single precision is what this is for")]
    pub(super) fn new(points: &[DVec3], rest: &[DVec3], n_vertices: usize, columns: &Columns<f64>) -> Self {
        let points = points.iter().map(|&p| single(p)).collect();
        Self { n_vertices, points, rest: rest.to_vec(), columns: columns.map(|weight| weight as f32) }
    }

    /// Number of points.
    #[must_use]
    pub fn n_points(&self) -> usize {
        self.points.len()
    }

    /// Positions of all points in a pose, m. Parallel; the same bits for any number of threads.
    ///
    /// # Panics
    /// If the pose is of a cage with other numbers of vertices or faces.
    #[must_use]
    pub fn apply(&self, pose: &Pose) -> Vec<[f32; 3]> {
        let mut positions = self.points.clone();
        self.add(&mut positions, &self.rest, &pose.factors);
        positions
    }

    /// Moves positions from one pose to another by the terms that differ only; rounding adds up over many calls.
    ///
    /// * `positions`: `[n_points]`, m, in the pose `from`; in the pose `to` afterwards.
    ///
    /// # Panics
    /// If the poses are of another cage or there is not one position for each point.
    pub fn apply_change(&self, positions: &mut [[f32; 3]], from: &Pose, to: &Pose) {
        self.add(positions, &from.factors, &to.factors);
    }

    fn add(&self, positions: &mut [[f32; 3]], from: &[DVec3], to: &[DVec3]) {
        assert_eq!(from.len(), self.columns.n_columns(), "pose of another cage");
        let mut terms = changes(from, to);
        if terms.is_empty() {
            return;
        }
        // A common displacement needs no weights, as phi sums to 1; taking it out pays where every vertex moves.
        let moved: Vec<DVec3> = terms.iter().filter(|(c, _)| *c < self.n_vertices).map(|&(_, d)| d).collect();
        if moved.len() == self.n_vertices {
            #[allow(clippy::cast_precision_loss, reason = "a cage has few vertices")]
            let mean = moved.iter().sum::<DVec3>() / moved.len() as f64;
            terms.iter_mut().filter(|(c, _)| *c < self.n_vertices).for_each(|(_, d)| *d -= mean);
            let mean = single(mean);
            for position in positions.iter_mut() {
                for (x, shift) in position.iter_mut().zip(mean) {
                    *x += shift;
                }
            }
        }
        let terms: Vec<_> = terms.into_iter().map(|(c, change)| (c, single(change))).collect();
        self.columns.add(&terms, positions);
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cuboid, interior_points, scattered};
    use super::super::{GreenCage, Pose};
    use super::*;
    use crate::task::Task;

    fn farthest(a: &[[f32; 3]], b: &[DVec3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| DVec3::from(a.map(f64::from)).distance(*b)).fold(0.0, f64::max)
    }

    #[test]
    fn the_preview_follows_the_exact_positions() {
        let cage = GreenCage::new(cuboid(5, 4)).unwrap();
        let points = interior_points(&cage, 1000, 1);
        let weights = cage.weights(&points, &Task::default()).unwrap();
        let preview = weights.to_preview();
        let pose = Pose::new(&cage, &scattered(&cage, 0.05, 2)).unwrap();
        let error = farthest(&preview.apply(&pose), &weights.apply(&pose)) / cage.size();
        // A dozen roundings of 6e-8 each on sums that are of the order of the size, for points up to the surface.
        assert!(error < 1e-6, "{error:e} of the size off");
        let rest = farthest(&preview.apply(&cage.rest_pose()), &points);
        assert!(rest < 1e-7 * cage.size(), "only the points' rounding at rest: {rest:e}");
    }

    #[test]
    fn a_moved_cage_moves_the_preview_without_noise() {
        let cage = GreenCage::new(cuboid(5, 4)).unwrap();
        let points = interior_points(&cage, 300, 3);
        let preview = cage.weights(&points, &Task::default()).unwrap().to_preview();
        let shift = DVec3::new(100.0, 0.0, 0.0);
        let moved: Vec<_> = cage.rest().vertices.iter().map(|&v| v + shift).collect();
        let expected: Vec<_> = points.iter().map(|&p| p + shift).collect();
        let error = farthest(&preview.apply(&Pose::new(&cage, &moved).unwrap()), &expected);
        assert!(error < 1e-5, "about an ulp of the distance: {error:e}");
    }

    #[test]
    fn an_incremental_change_equals_the_full_product() {
        let cage = GreenCage::new(cuboid(4, 4)).unwrap();
        let points = interior_points(&cage, 600, 4);
        let weights = cage.weights(&points, &Task::default()).unwrap();
        let preview = weights.to_preview();
        let from = Pose::new(&cage, &scattered(&cage, 0.02, 6)).unwrap();
        let mut vertices = from.vertices().to_vec();
        vertices[7] += DVec3::new(0.01, 0.02, -0.03);
        let to = Pose::new(&cage, &vertices).unwrap();
        let mut positions = preview.apply(&from);
        preview.apply_change(&mut positions, &from, &to);
        let error = farthest(&positions, &weights.apply(&to)) / cage.size();
        assert!(error < 1e-6, "{error:e} of the size off");
    }
}
