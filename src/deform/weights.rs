//! Stored weights of many points, for poses that change often.

use super::columns::{BLOCK, Columns, changes};
use super::evaluator::{Evaluator, WIDTH};
use super::{DeformError, GreenCage, Pose, PreviewWeights};
use crate::geometry::DVec3;
use crate::task::Task;
use rayon::prelude::{IndexedParallelIterator, ParallelIterator};

/// The Green coordinates of many points in one cage, in double precision.
///
/// Takes 8 bytes for each pair of a point and a vertex or face.
#[derive(Clone, Debug)]
pub struct GreenWeights {
    n_vertices: usize,
    points: Vec<DVec3>,
    /// Of all weights at rest: vertices, then normals.
    rest: Vec<DVec3>,
    columns: Columns<f64>,
}

impl GreenCage {
    /// Computes the weights of points in this cage.
    ///
    /// * `points`: m, inside the cage or on it. On the surface the weights are the limits from inside.
    ///
    /// Parallel over blocks of points; `task` is asked after each.
    ///
    /// # Errors
    /// [`DeformError::OutsideCage`] or [`DeformError::NotFinite`] for the first bad point,
    /// [`DeformError::Cancelled`] if the task is called off.
    pub fn weights(&self, points: &[DVec3], task: &Task) -> Result<GreenWeights, DeformError> {
        let rest = self.rest_pose().factors;
        let mut columns = Columns::zero(points.len(), rest.len());
        let phase = task.phase("computing weights", points.len());
        let done: Vec<Result<(), DeformError>> = columns
            .blocks_mut()
            .enumerate()
            .map_init(
                || Evaluator::new(self),
                |evaluator, (b, block)| {
                    task.check()?;
                    let start = b * BLOCK;
                    let points = &points[start..points.len().min(start + BLOCK)];
                    fill(evaluator, points, start, block)?;
                    phase.advance(points.len());
                    Ok(())
                },
            )
            .collect();
        // A cancelled block says nothing about the points of the blocks before it.
        task.check()?;
        done.into_iter().collect::<Result<(), _>>()?;
        Ok(GreenWeights { n_vertices: self.n_vertices(), points: points.to_vec(), rest, columns })
    }
}

/// Fills one block of the matrix.
fn fill(evaluator: &mut Evaluator<'_>, points: &[DVec3], start: usize, block: &mut [f64]) -> Result<(), DeformError> {
    for (g, group) in points.chunks(WIDTH).enumerate() {
        let at = g * WIDTH;
        let lanes = evaluator.evaluate(group, start + at)?;
        for (column, weights) in block.chunks_exact_mut(points.len()).zip(lanes.phi.iter().chain(&lanes.psi)) {
            column[at..at + group.len()].copy_from_slice(&weights[..group.len()]);
        }
    }
    Ok(())
}

impl GreenWeights {
    /// Number of points.
    #[must_use]
    pub fn n_points(&self) -> usize {
        self.columns.n_points()
    }

    /// The points at rest, m.
    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Weight of a cage vertex for a point, dimensionless; sums to 1 over the vertices.
    ///
    /// # Panics
    /// If there is no such point or vertex.
    #[must_use]
    pub fn phi(&self, point: usize, vertex: usize) -> f64 {
        assert!(vertex < self.n_vertices, "no vertex {vertex}");
        self.columns.get(point, vertex)
    }

    /// Weight of a cage face's normal for a point, m.
    ///
    /// # Panics
    /// If there is no such point or face.
    #[must_use]
    pub fn psi(&self, point: usize, face: usize) -> f64 {
        self.columns.get(point, self.n_vertices + face)
    }

    /// Positions of all points in a pose, m. Parallel; the same bits for any number of threads.
    ///
    /// # Panics
    /// If the pose is of a cage with other numbers of vertices or faces.
    #[must_use]
    pub fn apply(&self, pose: &Pose) -> Vec<DVec3> {
        assert_eq!(pose.factors.len(), self.columns.n_columns(), "pose of another cage");
        let terms: Vec<_> = pose.factors.iter().map(DVec3::to_array).enumerate().collect();
        let mut positions = vec![DVec3::ZERO; self.n_points()];
        self.columns.add(&terms, &mut positions);
        positions
    }

    /// Moves positions from one pose to another by the terms that differ only.
    ///
    /// Dragging a vertex changes one column of phi and one of psi for each of its faces. Equals [`Self::apply`] up to
    /// rounding, which adds up over many calls: take the full product at the end of a gesture.
    ///
    /// * `positions`: `[n_points]`, m, in the pose `from`; in the pose `to` afterwards.
    ///
    /// # Panics
    /// If the poses are of another cage or there is not one position for each point.
    pub fn apply_change(&self, positions: &mut [DVec3], from: &Pose, to: &Pose) {
        assert_eq!(from.factors.len(), self.columns.n_columns(), "pose of another cage");
        let terms: Vec<_> =
            changes(&from.factors, &to.factors).into_iter().map(|(c, change)| (c, change.to_array())).collect();
        if !terms.is_empty() {
            self.columns.add(&terms, positions);
        }
    }

    /// A single-precision copy, half the size and twice as fast to apply.
    #[must_use]
    pub fn to_preview(&self) -> PreviewWeights {
        PreviewWeights::new(&self.points, &self.rest, self.n_vertices, &self.columns)
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{bumpy_sphere, cuboid, interior_points, random_rotation, scattered};
    use super::*;
    use crate::geometry::{DMat3, TriMesh};
    use crate::task::Cancelled;

    fn cages() -> Vec<GreenCage> {
        let turned = |mut mesh: TriMesh, seed| {
            let rotation = random_rotation(&mut fastrand::Rng::with_seed(seed));
            mesh.vertices.iter_mut().for_each(|v| *v = rotation * *v + DVec3::new(0.3, -0.2, 0.1));
            mesh
        };
        let meshes = [cuboid(1, 1), turned(cuboid(5, 3), 8), bumpy_sphere(1, 2), turned(bumpy_sphere(2, 3), 9)];
        meshes.into_iter().map(|mesh| GreenCage::new(mesh).unwrap()).collect()
    }

    fn farthest(a: &[DVec3], b: &[DVec3]) -> f64 {
        assert_eq!(a.len(), b.len(), "as many positions");
        a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
    }

    /// Points next to and on faces, edges and vertices of a cage.
    fn surface_points(cage: &GreenCage) -> Vec<DVec3> {
        let offset = 1e-12 * cage.size();
        let mut points = Vec::new();
        for (f, face) in cage.faces.iter().enumerate() {
            let [a, b, c] = cage.rest().corners(f);
            // Inwards from the face; off the edge and the vertex towards its middle.
            for (place, inwards) in [
                (a * 0.2 + b * 0.3 + c * 0.5, -face.normal),
                ((a + b) / 2.0, -face.normal + (c - (a + b) / 2.0) / (c - a).length()),
                (a, -face.normal + (b + c - a * 2.0) / (b + c - a * 2.0).length()),
            ] {
                points.extend([place, place + inwards * offset]);
            }
        }
        points.retain(|&p| cage.contains(p));
        points
    }

    #[test]
    fn the_rest_pose_reproduces_every_point_and_phi_sums_to_one() {
        for (i, cage) in cages().iter().enumerate() {
            let points = [interior_points(cage, 600, 11), surface_points(cage)].concat();
            assert!(points.len() > 600, "some surface points are inside");
            let weights = cage.weights(&points, &Task::default()).unwrap();
            let error = farthest(&weights.apply(&cage.rest_pose()), &points) / cage.size();
            assert!(error < 1e-13, "cage {i}: {error:e} of the size off");
            for p in 0..points.len() {
                let sum: f64 = (0..cage.n_vertices()).map(|v| weights.phi(p, v)).sum();
                assert!((sum - 1.0).abs() < 1e-13, "cage {i}, point {p}: phi sums to {sum}");
            }
        }
    }

    #[test]
    fn weights_are_continuous_up_to_the_surface() {
        for cage in cages() {
            let weigh = |p: DVec3| cage.weights(&[p], &Task::default()).unwrap();
            for (f, face) in cage.faces.iter().enumerate().take(12) {
                let [a, b, c] = cage.rest().corners(f);
                let place = a * 0.2 + b * 0.3 + c * 0.5;
                if !cage.contains(place) {
                    continue;
                }
                let (on, near) = (weigh(place), weigh(place - face.normal * (1e-9 * cage.size())));
                for v in 0..cage.n_vertices() {
                    let step = (on.phi(0, v) - near.phi(0, v)).abs();
                    assert!(step < 1e-7, "phi jumps by {step:e} at face {f}");
                }
            }
        }
    }

    #[test]
    fn a_similarity_is_reproduced_with_its_scale_as_stretch() {
        let mut rng = fastrand::Rng::with_seed(21);
        for cage in cages() {
            let points = [interior_points(&cage, 100, 12), surface_points(&cage)].concat();
            let weights = cage.weights(&points, &Task::default()).unwrap();
            let (scale, rotation, shift) =
                (0.5 + 2.0 * rng.f64(), random_rotation(&mut rng), DVec3::new(1.0, 2.0, -1.0));
            let map = |p: &DVec3| rotation * *p * scale + shift;
            let pose = Pose::new(&cage, &cage.rest().vertices.iter().map(map).collect::<Vec<_>>()).unwrap();
            assert!(pose.stretch().iter().all(|s| (s / scale - 1.0).abs() < 1e-12), "stretch is the scale");
            let expected: Vec<_> = points.iter().map(map).collect();
            let error = farthest(&weights.apply(&pose), &expected) / (scale * cage.size());
            assert!(error < 1e-12, "{error:e} of the size off");
        }
    }

    #[test]
    fn an_anisotropic_map_is_not_reproduced() {
        for cage in cages() {
            let points = interior_points(&cage, 50, 13);
            let weights = cage.weights(&points, &Task::default()).unwrap();
            let map = |p: &DVec3| DMat3::from_diagonal(DVec3::new(1.5, 1.0, 0.8)) * *p;
            let pose = Pose::new(&cage, &cage.rest().vertices.iter().map(map).collect::<Vec<_>>()).unwrap();
            let expected: Vec<_> = points.iter().map(map).collect();
            let error = farthest(&weights.apply(&pose), &expected) / cage.size();
            assert!(error > 1e-3, "only {error:e} of the size off");
        }
    }

    #[test]
    fn outside_points_and_bad_numbers_are_refused_in_order() {
        let cage = GreenCage::new(cuboid(3, 3)).unwrap();
        let (_, hi) = cage.rest().bounds();
        let mut points = interior_points(&cage, 1200, 14);
        points[1100] = DVec3::NAN;
        let result = cage.weights(&points, &Task::default());
        assert_eq!(result.err(), Some(DeformError::NotFinite { point: 1100 }), "NaN");
        for outside in [hi * 1.5, DVec3::new(0.1, 0.2, hi.z + 1e-15), hi + DVec3::splat(1e-13)] {
            points[700] = outside;
            let result = cage.weights(&points, &Task::default());
            assert_eq!(result.err(), Some(DeformError::OutsideCage { point: 700, position: outside }), "first");
        }
    }

    #[test]
    fn a_cancelled_task_stops_the_work() {
        let cage = GreenCage::new(cuboid(2, 2)).unwrap();
        let task = Task::default();
        task.cancel();
        let result = cage.weights(&interior_points(&cage, 10, 15), &task);
        assert_eq!(result.err(), Some(DeformError::Cancelled(Cancelled)), "cancelled");
    }

    #[test]
    fn thread_counts_give_equal_bits() {
        let cage = GreenCage::new(bumpy_sphere(2, 6)).unwrap();
        let points = [interior_points(&cage, 1500, 16), surface_points(&cage)].concat();
        let pose = Pose::new(&cage, &scattered(&cage, 0.05, 5)).unwrap();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let weights = cage.weights(&points, &Task::default()).unwrap();
                (weights.apply(&pose), weights.columns)
            })
        };
        assert_eq!(run(1), run(2), "one and two threads");
    }

    #[test]
    fn a_point_alone_has_the_bits_it_has_among_others() {
        let cage = GreenCage::new(bumpy_sphere(2, 6)).unwrap();
        let points = [interior_points(&cage, 600, 17), surface_points(&cage)].concat();
        let all = cage.weights(&points, &Task::default()).unwrap();
        for p in (0..points.len()).step_by(37) {
            let alone = cage.weights(&points[p..=p], &Task::default()).unwrap();
            for c in 0..alone.columns.n_columns() {
                assert_eq!(all.columns.get(p, c).to_bits(), alone.columns.get(0, c).to_bits(), "point {p}, column {c}");
            }
        }
    }

    #[test]
    fn an_incremental_change_equals_the_full_product() {
        let cage = GreenCage::new(cuboid(4, 4)).unwrap();
        let points = interior_points(&cage, 1100, 18);
        let weights = cage.weights(&points, &Task::default()).unwrap();
        let from = Pose::new(&cage, &scattered(&cage, 0.02, 6)).unwrap();
        let mut vertices = from.vertices().to_vec();
        vertices[7] += DVec3::new(0.01, 0.02, -0.03);
        let to = Pose::new(&cage, &vertices).unwrap();
        assert!(changes(&from.factors, &to.factors).len() < 10, "one vertex and its faces");
        let mut positions = weights.apply(&from);
        weights.apply_change(&mut positions, &from, &to);
        let error = farthest(&positions, &weights.apply(&to));
        assert!(error < 1e-14 * cage.size(), "{error:e} off");
    }

    #[test]
    fn no_points_are_no_trouble() {
        let cage = GreenCage::new(cuboid(1, 1)).unwrap();
        let weights = cage.weights(&[], &Task::default()).unwrap();
        assert!(weights.apply(&cage.rest_pose()).is_empty(), "no positions");
        assert!(weights.to_preview().apply(&cage.rest_pose()).is_empty(), "no preview positions");
    }
}
