//! Why a project cannot be computed.

use crate::antenna::PatchError;
use crate::cage::{CageError, PoseError, PresetError};
use crate::deform::DeformError;
use crate::distortion::CompensationError;
use crate::geometry::DVec3;
use crate::project::BodiesError;
use crate::task::Cancelled;
use crate::tet::{BlockError, EncloseError, TetError};
use crate::tlm::TlmError;
use crate::units::to_mm;

/// Why a project could not be computed; the message says what to change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PipelineError {
    /// A dimension of the antenna is wrong.
    #[error("antenna: {0}")]
    Antenna(#[from] PatchError),
    /// The cage cannot be built.
    #[error("cage: {0}")]
    Cage(#[from] CageError),
    /// A preset's numbers are impossible.
    #[error("preset {}: {source}", index + 1)]
    Preset {
        /// Place among the presets that are switched on, from 0.
        index: usize,
        /// What is wrong.
        source: PresetError,
    },
    /// A hand edit names a vertex that the cage does not have.
    #[error(
        "hand edits name cage vertex {vertex}, but the cage has {n_handles}: clear the hand edits or restore the segments"
    )]
    HandEdit {
        /// The vertex.
        vertex: u32,
        /// Vertices that can be moved.
        n_handles: usize,
    },
    /// The posed cage is not usable.
    #[error("cage: {0}")]
    Pose(#[from] PoseError),
    /// The splitting tolerance does not fit the antenna.
    #[error(
        "the tolerance is {value_mm} mm, but must be above 0 and at most {limit_mm:.4} mm: a third of the thinnest layer"
    )]
    Tolerance {
        /// The tolerance, mm.
        value_mm: f64,
        /// Greatest allowed, mm.
        limit_mm: f64,
    },
    /// Compensation has no result.
    #[error("compensation: {0}")]
    Compensation(CompensationError),
    /// The map or the surface fails.
    #[error(transparent)]
    Deform(DeformError),
    /// The map folds over.
    #[error(
        "the map folds the antenna over near x = {x_mm:.2} mm, y = {y_mm:.2} mm: bend less sharply there or use more cage segments"
    )]
    Folded {
        /// x of the flat place, mm.
        x_mm: f64,
        /// y of the flat place, mm.
        y_mm: f64,
        /// Where the map carries it, mm.
        at_mm: [f64; 3],
    },
    /// The deformed surface crosses itself.
    #[error(
        "the deformed antenna crosses itself in {count} places, first {what} near ({:.2}, {:.2}, {:.2}) mm: bend less, or shorten the coaxial line",
        places_mm[0][0], places_mm[0][1], places_mm[0][2]
    )]
    Crossing {
        /// Number of crossing pairs of triangles.
        count: usize,
        /// The parts that meet there.
        what: String,
        /// The places, mm: at least one, and not all where there are many.
        places_mm: Vec<[f64; 3]>,
    },
    /// The antenna or the air around it cannot be meshed.
    #[error("mesh: {0}")]
    Mesh(EncloseError),
    /// The field cannot be solved.
    #[error("solver: {0}")]
    Solver(TlmError),
    /// Imported bodies cannot be solved without a feed.
    #[error("the imported bodies have no feed: place one between two metal bodies")]
    NoFeed,
    /// The feed does not belong to the bodies.
    #[error("bodies: {0}")]
    Feed(BodiesError),
    /// The surface of imported bodies cannot be triangulated anew.
    #[error("the bodies cannot be meshed near ({:.3}, {:.3}, {:.3}) mm: draw them more exactly there", place_mm[0], place_mm[1], place_mm[2])]
    Unmeshable {
        /// The place, mm.
        place_mm: [f64; 3],
    },
    /// Nothing of the feed's line is in the mesh.
    #[error("there is no room beside the feed's line: move the feed away from edges of metal")]
    NoRoomForFeed,
    /// A cylinder was asked for where there is none.
    #[error("there is no exact cylinder: only a single bend without hand edits has one")]
    NoCylinder,
    /// Called off.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl PipelineError {
    /// Where to look in the deformed antenna, mm; empty where no place is to blame.
    #[must_use]
    pub fn places_mm(&self) -> Vec<[f64; 3]> {
        let in_mm = |places: &[DVec3]| places.iter().map(|p| p.to_array().map(to_mm)).collect();
        match self {
            Self::Crossing { places_mm, .. } => places_mm.clone(),
            Self::Folded { at_mm: place_mm, .. } | Self::Unmeshable { place_mm } => vec![*place_mm],
            Self::Mesh(EncloseError::Air(error)) => in_mm(error.places()),
            Self::Mesh(EncloseError::Block(BlockError::Folded { at, .. })) => in_mm(&[*at]),
            _ => Vec::new(),
        }
    }
}

impl From<EncloseError> for PipelineError {
    fn from(error: EncloseError) -> Self {
        match error {
            EncloseError::Air(TetError::Cancelled(cancelled)) => Self::Cancelled(cancelled),
            other => Self::Mesh(other),
        }
    }
}

impl From<TlmError> for PipelineError {
    fn from(error: TlmError) -> Self {
        match error {
            TlmError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Solver(other),
        }
    }
}

impl From<BlockError> for PipelineError {
    fn from(error: BlockError) -> Self {
        Self::Mesh(error.into())
    }
}

impl From<DeformError> for PipelineError {
    fn from(error: DeformError) -> Self {
        match error {
            DeformError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            // A point outside the cage can only be a warped one: the antenna as drawn is inside.
            outside @ DeformError::OutsideCage { .. } => Self::Compensation(outside.into()),
            other => Self::Deform(other),
        }
    }
}

impl From<CompensationError> for PipelineError {
    fn from(error: CompensationError) -> Self {
        match error {
            CompensationError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Compensation(other),
        }
    }
}
