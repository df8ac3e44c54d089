//! Why a cage, a pose or a point cannot be used.

use super::FeedError;
use crate::geometry::{DVec3, FaceId, SurfaceError, VertexId};
use crate::task::Cancelled;

/// Why Green coordinates cannot be computed or applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeformError {
    /// The rest cage is not a closed, outward-oriented surface.
    #[error("the cage at rest cannot be used: {0}")]
    Surface(#[from] SurfaceError),
    /// A point is outside the cage, where the weights do not reproduce it.
    #[error("point {point} at {position} is outside the cage: enlarge the cage's padding")]
    OutsideCage {
        /// Index of the point in the slice that was given.
        point: usize,
        /// Where it is, m.
        position: DVec3,
    },
    /// A coordinate of a point is NaN or infinite.
    #[error("point {point} has a coordinate that is not a finite number")]
    NotFinite {
        /// Index of the point in the slice that was given.
        point: usize,
    },
    /// The posed vertices are not as many as the cage has.
    #[error("the cage has {expected} vertices, but the pose has {got}")]
    WrongPose {
        /// Vertices of the cage at rest.
        expected: usize,
        /// Vertices of the pose.
        got: usize,
    },
    /// A posed coordinate is NaN or infinite.
    #[error("posed cage vertex {vertex} has a coordinate that is not a finite number")]
    PoseNotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// A posed face is collapsed to a line or a point, so that it has no normal.
    #[error("cage face {face} is collapsed in the pose: move one of its vertices off the line through the others")]
    DegeneratePose {
        /// The face.
        face: FaceId,
    },
    /// A point lies on a cage edge or vertex, where the map is continuous but its gradient is infinite.
    #[error(
        "point {point} at {position} is on an edge of the cage, where the map has no gradient: enlarge the padding"
    )]
    SingularGradient {
        /// Index of the point in the slice that was given.
        point: usize,
        /// Where it is, m.
        position: DVec3,
    },
    /// The rigid feed cannot follow the sheet.
    #[error(transparent)]
    Feed(#[from] FeedError),
    /// Edge splitting did not come to an end.
    #[error(
        "the surface still needs splitting after {passes} passes and {n_vertices} vertices: increase the tolerance, or \
         smooth the cage"
    )]
    SplitLimit {
        /// Passes taken.
        passes: usize,
        /// Vertices made.
        n_vertices: usize,
    },
    /// The work was called off.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
