//! Why a mesh cannot be made.

use crate::geometry::DVec3;
use crate::task::Cancelled;
use crate::units::to_mm;

/// Why a surface cannot be filled with tetrahedra.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TetError {
    /// Facets of the surface cross each other.
    #[error(
        "the surface crosses itself at {count} places, first at {}: deform it less, or raise the cage's padding",
        place(places)
    )]
    Crossing {
        /// Number of crossing pairs.
        count: usize,
        /// Some of the places, m.
        places: Vec<DVec3>,
    },
    /// Parts of the surface could not be made faces of the mesh.
    #[error(
        "{n_missing} edges or facets of the surface could not be meshed, first at {}: choose a finer density",
        place(places)
    )]
    NotRecovered {
        /// How many are missing.
        n_missing: usize,
        /// Some of the places, m.
        places: Vec<DVec3>,
    },
    /// Two vertices of the surface coincide.
    #[error("two vertices of the surface coincide at {}: weld them", place(places))]
    Coincident {
        /// The place, m.
        places: Vec<DVec3>,
    },
    /// The facets around a part of space do not agree on its region.
    #[error(
        "the space at {} is said to be both \"{first}\" and \"{second}\": the surface is not closed there",
        place(places)
    )]
    Leak {
        /// A place on one of the facets, m.
        places: Vec<DVec3>,
        /// One region.
        first: String,
        /// The other.
        second: String,
    },
    /// The work was called off.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl TetError {
    /// Places kept with an error.
    pub(super) const MAX_PLACES: usize = 100;

    /// Where to look, m; empty where no place is to blame.
    #[must_use]
    pub fn places(&self) -> &[DVec3] {
        match self {
            Self::Crossing { places, .. }
            | Self::NotRecovered { places, .. }
            | Self::Coincident { places }
            | Self::Leak { places, .. } => places,
            Self::Cancelled(_) => &[],
        }
    }
}

fn place(places: &[DVec3]) -> String {
    places.first().map_or_else(
        || "an unknown place".to_owned(),
        |p| format!("({:.3}, {:.3}, {:.3}) mm", to_mm(p.x), to_mm(p.y), to_mm(p.z)),
    )
}
