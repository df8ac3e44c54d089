//! Why bodies cannot be welded, with the places.

use super::MAX_TRIANGLES;
use crate::geometry::{DVec3, PlcError};
use crate::task::Cancelled;
use crate::units::to_mm;

/// Places that a message spells out.
const N_SPELLED: usize = 3;
/// Places that are kept of one fault.
pub(super) const MAX_PLACES: usize = 100;

/// Why bodies cannot be welded. Places are in metres, the first ones of `count`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BodyFault {
    /// The tolerance is none.
    #[error("the weld tolerance must be above 0, but is {} mm", to_mm(*tolerance))]
    Tolerance {
        /// The tolerance, m.
        tolerance: f64,
    },
    /// Nothing, or too much.
    #[error(
        "{bodies} bodies with {triangles} triangles: there must be one body or more, of at most {MAX_TRIANGLES} triangles"
    )]
    Count {
        /// Number of bodies.
        bodies: usize,
        /// Number of triangles of all.
        triangles: usize,
    },
    /// A coordinate is none.
    #[error("\"{body}\" has a coordinate that is not a finite number")]
    NotFinite {
        /// The body.
        body: String,
    },
    /// No triangle is larger than the tolerance.
    #[error("\"{body}\" is smaller than the weld tolerance, or empty: check the unit")]
    Empty {
        /// The body.
        body: String,
    },
    /// Edges with a face on one side only.
    #[error("\"{body}\" is open at {}: close it", spell(*count, "edge", places))]
    Open {
        /// The body.
        body: String,
        /// Number of edges.
        count: usize,
        /// Their middles.
        places: Vec<DVec3>,
    },
    /// Edges where more than two faces of one body meet, or two that are turned against each other.
    #[error(
        "\"{body}\" has more than two faces, or faces turned against each other, at {}: mend it, or make two bodies of it",
        spell(*count, "edge", places)
    )]
    Branching {
        /// The body.
        body: String,
        /// Number of edges.
        count: usize,
        /// Their middles.
        places: Vec<DVec3>,
    },
    /// A body runs through itself.
    #[error("\"{body}\" crosses or touches itself at {}", spell(*count, "place", places))]
    SelfCrossing {
        /// The body.
        body: String,
        /// Number of places.
        count: usize,
        /// The places.
        places: Vec<DVec3>,
    },
    /// Two bodies fill the same room.
    #[error("\"{}\" and \"{}\" overlap at {}: cut one out of the other", bodies[0], bodies[1], spell(*count, "place", places))]
    Overlap {
        /// The bodies.
        bodies: [String; 2],
        /// Number of places.
        count: usize,
        /// The places.
        places: Vec<DVec3>,
    },
    /// Faces that cannot be cut so that they fit their neighbors.
    #[error(
        "\"{body}\" cannot be made to fit what touches it at {}: draw it more exactly, or change the weld tolerance",
        spell(*count, "place", places)
    )]
    Unfit {
        /// The body.
        body: String,
        /// Number of faces.
        count: usize,
        /// Their centers.
        places: Vec<DVec3>,
    },
    /// What came out is no complex.
    #[error("the welded bodies are no valid surface: {0}")]
    Complex(PlcError),
}

/// Why there is no complex of the bodies.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WeldError {
    /// Called off.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Everything that is wrong.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Faults(Vec<BodyFault>),
}

impl BodyFault {
    /// Where, m.
    #[must_use]
    pub fn places(&self) -> &[DVec3] {
        match self {
            Self::Open { places, .. }
            | Self::Branching { places, .. }
            | Self::SelfCrossing { places, .. }
            | Self::Overlap { places, .. }
            | Self::Unfit { places, .. } => places,
            _ => &[],
        }
    }
}

fn spell(count: usize, what: &str, places: &[DVec3]) -> String {
    let spelled = places.iter().take(N_SPELLED).map(|p| {
        let [x, y, z] = p.to_array().map(|c| to_mm(c) + 0.0);
        format!("({x:.3}, {y:.3}, {z:.3})")
    });
    let plural = if count == 1 { "" } else { "s" };
    let list: Vec<String> = spelled.collect();
    let more = if count > N_SPELLED { ", ..." } else { "" };
    format!("{count} {what}{plural}, {} mm{more}", list.join(", "))
}
