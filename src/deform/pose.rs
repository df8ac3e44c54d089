//! One pose of a cage: what multiplies the weights.

use super::{DeformError, GreenCage};
use crate::geometry::{DVec3, FaceId, VertexId, tri_mesh};

/// Posed doubled area over the squared longest posed side, below which the normal is rounding only. Greater values
/// would refuse thin faces whose normal still has several digits.
const COLLAPSED: f64 = 1e-12;

/// The posed vertices and the stretched normals of a cage.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// The factors of all weights: vertices, then stretched normals.
    pub(super) factors: Vec<DVec3>,
    stretch: Vec<f64>,
}

impl Pose {
    /// Computes the stretch factors and normals of a posed cage.
    ///
    /// * `posed`: `[n_vertices]`, m, in the order of the cage at rest.
    ///
    /// With the sides u, v of a face at rest and u', v' posed,
    /// `s = √(|u'|²|v|² - 2(u'·v')(u·v) + |v'|²|u|²) / (√8 area)`: the root mean square of the two principal stretches.
    ///
    /// # Errors
    /// [`DeformError::WrongPose`], [`DeformError::PoseNotFinite`], or [`DeformError::DegeneratePose`] for a face that
    /// is collapsed to a line or a point: it has no normal, and the map would jump there.
    ///
    /// Source: \[LLC08\], the stretch factor in three dimensions.
    pub fn new(cage: &GreenCage, posed: &[DVec3]) -> Result<Self, DeformError> {
        let rest = cage.rest();
        if posed.len() != rest.vertices.len() {
            return Err(DeformError::WrongPose { expected: rest.vertices.len(), got: posed.len() });
        }
        if let Some(v) = posed.iter().position(|p| !p.is_finite()) {
            return Err(DeformError::PoseNotFinite { vertex: VertexId::new(v) });
        }
        let mut factors = posed.to_vec();
        let mut stretch = Vec::with_capacity(cage.n_faces());
        for (f, face) in cage.faces.iter().enumerate() {
            let now = face.corners.map(|v| posed[v]);
            let degenerate = DeformError::DegeneratePose { face: FaceId::new(f) };
            let normal = unit_normal(now).ok_or(degenerate)?;
            let s = stretch_factor(rest.corners(f), now, face.double_area);
            factors.push(normal * s);
            stretch.push(s);
        }
        Ok(Self { factors, stretch })
    }

    pub(super) fn at_rest(cage: &GreenCage) -> Self {
        let normals = cage.faces.iter().map(|face| face.normal);
        let factors = cage.rest().vertices.iter().copied().chain(normals).collect();
        Self { factors, stretch: vec![1.0; cage.n_faces()] }
    }

    /// The posed vertices, m.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.factors[..self.factors.len() - self.stretch.len()]
    }

    /// Stretch factor of each face, dimensionless.
    #[must_use]
    pub fn stretch(&self) -> &[f64] {
        &self.stretch
    }

    /// Posed outward unit normal of each face times its stretch factor.
    #[must_use]
    pub fn stretched_normals(&self) -> &[DVec3] {
        &self.factors[self.factors.len() - self.stretch.len()..]
    }
}

fn unit_normal(corners: [DVec3; 3]) -> Option<DVec3> {
    let [a, b, c] = corners;
    let longest = [b - a, c - b, a - c].iter().map(|side| side.length_squared()).fold(0.0, f64::max);
    let cross = tri_mesh::doubled_area_vector(corners);
    if cross.length() > COLLAPSED * longest { cross.try_normalize() } else { None }
}

fn stretch_factor(rest: [DVec3; 3], posed: [DVec3; 3], double_area: f64) -> f64 {
    let sides = |[a, b, c]: [DVec3; 3]| (b - a, c - a);
    let ((u, v), (u_now, v_now)) = (sides(rest), sides(posed));
    let square = u_now.length_squared() * v.length_squared() - 2.0 * u_now.dot(v_now) * u.dot(v)
        + v_now.length_squared() * u.length_squared();
    square.max(0.0).sqrt() / (2f64.sqrt() * double_area)
}

#[cfg(test)]
mod tests {
    use super::super::samples::cuboid;
    use super::*;

    #[test]
    fn the_rest_pose_is_the_pose_of_the_rest_vertices() {
        let cage = GreenCage::new(cuboid(3, 2)).unwrap();
        let pose = Pose::new(&cage, &cage.rest().vertices).unwrap();
        let rest = cage.rest_pose();
        assert_eq!(pose.vertices(), rest.vertices(), "vertices");
        for (a, b) in pose.stretched_normals().iter().zip(rest.stretched_normals()) {
            assert!(a.distance(*b) < 1e-14, "normal {a} instead of {b}");
        }
        assert!(pose.stretch().iter().all(|s| (s - 1.0).abs() < 1e-14), "no stretch at rest");
    }

    #[test]
    fn stretch_is_the_root_mean_square_of_the_principal_stretches() {
        let cage = GreenCage::new(cuboid(1, 1)).unwrap();
        let posed: Vec<_> = cage.rest().vertices.iter().map(|v| *v * DVec3::new(3.0, 0.5, 2.0)).collect();
        let pose = Pose::new(&cage, &posed).unwrap();
        for (face, s) in cage.faces.iter().zip(pose.stretch()) {
            let in_plane = DVec3::ONE - face.normal.abs();
            let expected = ((in_plane * DVec3::new(9.0, 0.25, 4.0)).element_sum() / 2.0).sqrt();
            assert!((s - expected).abs() < 1e-13, "{s} instead of {expected}");
        }
    }

    #[test]
    fn unusable_poses_are_refused() {
        let cage = GreenCage::new(cuboid(2, 2)).unwrap();
        let mut posed = cage.rest().vertices.clone();
        posed.pop();
        assert!(matches!(Pose::new(&cage, &posed), Err(DeformError::WrongPose { .. })), "one vertex too few");
        posed.push(DVec3::NAN);
        assert!(matches!(Pose::new(&cage, &posed), Err(DeformError::PoseNotFinite { .. })), "NaN");
        let flat: Vec<_> = cage.rest().vertices.iter().map(|v| DVec3::splat(v.x)).collect();
        assert!(matches!(Pose::new(&cage, &flat), Err(DeformError::DegeneratePose { .. })), "all on a line");
    }
}
