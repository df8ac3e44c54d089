//! The map of one posed cage, evaluated point by point without storing weights.

use super::evaluator::{Evaluator, WIDTH};
use super::gradient::Gradient;
use super::{DeformError, GreenCage, Pose};
use crate::geometry::{DMat3, DVec3};
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSlice};
use std::sync::Arc;

/// Points to a piece of parallel work: a few vectors of points; more would leave threads idle for a few hundred points.
const PIECE: usize = 4 * WIDTH;

/// The map that a posed cage makes of its inside.
#[derive(Clone, Debug)]
pub struct GreenMap {
    cage: Arc<GreenCage>,
    pose: Pose,
    gradient: Gradient,
}

impl GreenMap {
    /// Joins a cage and a pose of it.
    ///
    /// # Panics
    /// If the pose is of a cage with other numbers of vertices or faces.
    #[must_use]
    pub fn new(cage: Arc<GreenCage>, pose: Pose) -> Self {
        assert_eq!(pose.factors.len(), cage.n_vertices() + cage.n_faces(), "pose of another cage");
        let gradient = Gradient::new(&cage, &pose);
        Self { cage, pose, gradient }
    }

    /// The cage at rest.
    #[must_use]
    pub fn cage(&self) -> &Arc<GreenCage> {
        &self.cage
    }

    /// The pose.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Where a point goes, m.
    ///
    /// # Errors
    /// As [`Self::positions`].
    pub fn position(&self, point: DVec3) -> Result<DVec3, DeformError> {
        let mut evaluator = Evaluator::new(&self.cage);
        evaluator.evaluate(&[point], 0)?;
        Ok(evaluator.product(&self.pose.factors)[0])
    }

    /// Where points go, m; inside the cage or on it. Parallel; the same bits for any number of threads or points.
    ///
    /// # Errors
    /// [`DeformError::OutsideCage`] or [`DeformError::NotFinite`] for the first bad point.
    pub fn positions(&self, points: &[DVec3]) -> Result<Vec<DVec3>, DeformError> {
        self.collect(points, |evaluator, group, first| {
            evaluator.evaluate(group, first)?;
            Ok(evaluator.product(&self.pose.factors))
        })
    }

    /// Where points go, m, and the Jacobian of the map there: column k is the derivative along axis k.
    ///
    /// On a face the Jacobian is the limit from inside. Towards an edge of the cage it grows like the logarithm of the
    /// distance, unless the pose is a similarity.
    ///
    /// # Errors
    /// As [`Self::positions`], and [`DeformError::SingularGradient`] on an edge or a vertex.
    pub fn jacobians(&self, points: &[DVec3]) -> Result<Vec<(DVec3, DMat3)>, DeformError> {
        self.collect(points, |evaluator, group, first| {
            evaluator.evaluate(group, first)?;
            let jacobians = evaluator.jacobians(&self.gradient, group, first)?;
            let positions = evaluator.product(&self.pose.factors);
            Ok(std::array::from_fn(|w| (positions[w], jacobians[w])))
        })
    }

    /// Evaluates groups of [`WIDTH`] points in parallel, and reports the first error in the order of the points.
    fn collect<T: Copy + Send>(
        &self,
        points: &[DVec3],
        evaluate: impl Fn(&mut Evaluator<'_>, &[DVec3], usize) -> Result<[T; WIDTH], DeformError> + Sync,
    ) -> Result<Vec<T>, DeformError> {
        let pieces: Vec<Result<Vec<T>, DeformError>> = points
            .par_chunks(PIECE)
            .enumerate()
            .map_init(
                || Evaluator::new(&self.cage),
                |evaluator, (p, piece)| {
                    let mut values = Vec::with_capacity(piece.len());
                    for (g, group) in piece.chunks(WIDTH).enumerate() {
                        let lanes = evaluate(evaluator, group, p * PIECE + g * WIDTH)?;
                        values.extend_from_slice(&lanes[..group.len()]);
                    }
                    Ok(values)
                },
            )
            .collect();
        let mut all = Vec::with_capacity(points.len());
        for piece in pieces {
            all.extend(piece?);
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{bumpy_sphere, cuboid, interior_points, random_rotation, scattered};
    use super::*;
    use crate::task::Task;

    fn maps() -> Vec<GreenMap> {
        let pose = |mesh, seed| {
            let cage = GreenCage::new(mesh).unwrap();
            let pose = Pose::new(&cage, &scattered(&cage, 0.05, seed)).unwrap();
            GreenMap::new(Arc::new(cage), pose)
        };
        vec![pose(cuboid(1, 1), 1), pose(cuboid(4, 3), 2), pose(bumpy_sphere(1, 3), 3), pose(bumpy_sphere(2, 4), 4)]
    }

    /// Five-point central difference along each axis; exact to h^4.
    fn differences(map: &GreenMap, p: DVec3, h: f64) -> DMat3 {
        let column = |axis: DVec3| {
            let at = |k: f64| map.position(p + axis * (k * h)).unwrap();
            (at(-2.0) - at(2.0) + (at(1.0) - at(-1.0)) * 8.0) / (12.0 * h)
        };
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }

    fn difference(a: DMat3, b: DMat3) -> f64 {
        (a - b).to_cols_array().iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    #[test]
    fn jacobians_are_the_central_differences() {
        for map in maps() {
            let h = 1e-3 * map.cage().size();
            let points: Vec<_> = interior_points(map.cage(), 400, 7)
                .into_iter()
                .filter(|&p| {
                    (0..27).all(|i| {
                        let corner = DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64) - DVec3::ONE;
                        map.cage().contains(p + corner * (30.0 * h))
                    })
                })
                .take(60)
                .collect();
            assert!(points.len() > 10, "points away from the surface");
            for (&p, (position, jacobian)) in points.iter().zip(map.jacobians(&points).unwrap()) {
                assert_eq!(position, map.position(p).unwrap(), "the position that comes with it");
                // The fifth derivative grows like the fourth power of the distance; 30 h away it leaves about 1e-6.
                let error = difference(jacobian, differences(&map, p, h));
                assert!(error < 1e-6, "{error:e} at {p}");
            }
        }
    }

    #[test]
    fn the_jacobian_of_a_similarity_is_its_matrix_everywhere() {
        let mut rng = fastrand::Rng::with_seed(2);
        for mesh in [cuboid(3, 2), bumpy_sphere(2, 1)] {
            let cage = Arc::new(GreenCage::new(mesh).unwrap());
            let matrix = random_rotation(&mut rng) * 1.7;
            let posed: Vec<_> = cage.rest().vertices.iter().map(|&v| matrix * v + DVec3::X).collect();
            let map = GreenMap::new(Arc::clone(&cage), Pose::new(&cage, &posed).unwrap());
            for (_, jacobian) in map.jacobians(&interior_points(&cage, 200, 3)).unwrap() {
                assert!(difference(jacobian, matrix) < 1e-12, "{jacobian}");
            }
        }
    }

    #[test]
    fn the_jacobian_is_continuous_up_to_a_face() {
        for map in maps() {
            let cage = map.cage();
            for (f, face) in cage.faces.iter().enumerate().take(12) {
                let [a, b, c] = cage.rest().corners(f);
                let place = a * 0.2 + b * 0.3 + c * 0.5;
                if !cage.contains(place) {
                    continue;
                }
                let below = |share: f64| place - face.normal * (share * cage.size());
                let at = map.jacobians(&[place, below(1e-13), below(1e-10), below(1e-7)]).unwrap();
                for (_, jacobian) in &at[1..] {
                    let step = difference(*jacobian, at[0].1);
                    assert!(step < 1e-4, "face {f} jumps by {step:e}");
                }
            }
        }
    }

    #[test]
    fn jacobians_near_an_edge_are_accurate_and_on_it_refused() {
        for map in maps() {
            let cage = map.cage();
            let edge = &cage.edges[0];
            let [a, b] = edge.ends.map(|v| cage.rest().vertices[v]);
            let normals = edge.faces.map(|(f, _)| cage.faces[f].normal);
            let inwards = -(normals[0] + normals[1]).try_normalize().unwrap();
            let middle = a * 0.4 + b * 0.6;
            for share in [1e-2, 1e-4, 1e-6] {
                let p = middle + inwards * (share * cage.size());
                let (_, jacobian) = map.jacobians(&[p]).unwrap()[0];
                let error = difference(jacobian, differences(&map, p, 0.02 * share * cage.size()));
                // The differences lose digits in proportion to the step.
                assert!(error < 1e-5 + 1e-13 / share, "{error:e} at {share:e} from an edge");
            }
            let on_vertex = map.jacobians(&[a]);
            assert_eq!(on_vertex, Err(DeformError::SingularGradient { point: 0, position: a }), "on a vertex");
        }
        let map = &maps()[0];
        let [a, b] = map.cage().edges[0].ends.map(|v| map.cage().rest().vertices[v]);
        let on_edge = map.jacobians(&[(a + b) / 2.0]);
        assert!(matches!(on_edge, Err(DeformError::SingularGradient { .. })), "on an edge");
    }

    #[test]
    fn the_map_is_the_product_of_stored_weights() {
        for map in maps() {
            let points = interior_points(map.cage(), 300, 9);
            let stored = map.cage().weights(&points, &Task::default()).unwrap().apply(map.pose());
            assert_eq!(map.positions(&points).unwrap(), stored, "bit for bit");
        }
    }

    #[test]
    fn thread_counts_give_equal_bits() {
        let map = &maps()[3];
        let points = interior_points(map.cage(), 500, 10);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| (map.positions(&points).unwrap(), map.jacobians(&points).unwrap()))
        };
        assert_eq!(run(1), run(2), "one and two threads");
    }

    #[test]
    fn outside_points_are_refused() {
        let map = &maps()[1];
        let mut points = interior_points(map.cage(), 100, 11);
        points[70] = DVec3::splat(5.0);
        let expected = DeformError::OutsideCage { point: 70, position: points[70] };
        assert_eq!(map.positions(&points).err(), Some(expected.clone()), "positions");
        assert_eq!(map.jacobians(&points).err(), Some(expected), "jacobians");
    }
}
