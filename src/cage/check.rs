//! What a posed cage must satisfy before anything is carried through it.

use super::build::Cage;
use crate::geometry::intersect::{self, Crossing};
use crate::geometry::{DVec3, VertexId};

/// Why a posed cage is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// A vertex is NaN or infinite.
    #[error("cage vertex {vertex} is not at a finite place")]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// The posed cage has no positive volume.
    #[error("the cage is inside out: increase the radius or undo the last edit")]
    InsideOut,
    /// The cage crosses itself.
    #[error("the cage crosses itself in {count} places, first at faces {} and {}: increase the radius, reduce the amplitude or move its vertices back", first.first, first.second)]
    SelfCrossing {
        /// One pair of faces.
        first: Crossing,
        /// Number of crossing pairs.
        count: usize,
    },
}

/// Checks a pose of the cage: finite, not inside out, not crossing itself. Closed and oriented it is by construction.
///
/// * `posed`: one position per vertex of the cage, m.
///
/// # Errors
/// The first [`PoseError`] found.
///
/// # Panics
/// If `posed` does not have one position per vertex.
pub fn check_pose(cage: &Cage, posed: &[DVec3]) -> Result<(), PoseError> {
    assert_eq!(posed.len(), cage.mesh.vertices.len(), "one position per cage vertex");
    if let Some(v) = posed.iter().position(|p| !p.is_finite()) {
        return Err(PoseError::NotFinite { vertex: VertexId::new(v) });
    }
    let crossings = intersect::crossings(posed, &cage.mesh.faces);
    if let Some(&first) = crossings.first() {
        return Err(PoseError::SelfCrossing { first, count: crossings.len() });
    }
    let volume = crate::geometry::TriMesh { vertices: posed.to_vec(), faces: cage.mesh.faces.clone() }.volume();
    if volume > 0.0 { Ok(()) } else { Err(PoseError::InsideOut) }
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::paper_cage;
    use super::super::preset::{Axis, BendRule, Preset, pose};
    use super::*;
    use crate::units::from_mm;

    #[test]
    fn rest_and_bends_pass() {
        let cage = paper_cage(1.0, [10, 1]);
        assert_eq!(check_pose(&cage, &cage.mesh.vertices), Ok(()), "rest");
        for radius in [4.2, 6.5, 10.0, 60.0] {
            for rule in [BendRule::Tangent, BendRule::Arc] {
                let bend = Preset::Bend { axis: Axis::X, radius: from_mm(radius), rule, kept_plane: 0.0 };
                let posed = pose(&cage, &[bend]).expect("valid bend");
                assert_eq!(check_pose(&cage, &posed), Ok(()), "R = {radius} {rule:?}");
            }
        }
    }

    #[test]
    fn faults_are_found() {
        let cage = paper_cage(1.0, [4, 1]);
        let mut crossing = cage.mesh.vertices.clone();
        let dragged = cage.lattice.iter().position(|p| *p == [2, 0, 1]).expect("station");
        crossing[dragged].z -= from_mm(30.0);
        assert!(matches!(check_pose(&cage, &crossing), Err(PoseError::SelfCrossing { .. })), "pierces the bottom");
        let mirrored: Vec<_> = cage.mesh.vertices.iter().map(|p| DVec3::new(p.x, p.y, -p.z)).collect();
        assert_eq!(check_pose(&cage, &mirrored), Err(PoseError::InsideOut), "mirrored");
        let mut nan = cage.mesh.vertices.clone();
        nan[3].x = f64::NAN;
        assert!(matches!(check_pose(&cage, &nan), Err(PoseError::NotFinite { .. })), "NaN");
    }
}
