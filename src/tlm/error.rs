//! Why a mesh cannot be solved.

/// Why a mesh cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TlmError {
    /// There is nowhere to put energy in.
    #[error("the mesh has no port: mark the faces of a coaxial line's end as a group of role port")]
    NoPort,
    /// The port is no coaxial line's end.
    #[error(
        "the port \"{port}\" is not the end of a coaxial line: its faces must lie between two conductors, one inside the other"
    )]
    NotCoaxial {
        /// Name of the port's group.
        port: String,
    },
    /// The lumped port's chain is not there.
    #[error("the lumped port does not lie along edges of the mesh between two conductors")]
    NoGap,
    /// A lossy sheet that the mesh does not have.
    #[error("the mesh has no conductor named \"{name}\" that could be a lossy sheet")]
    NoSheet {
        /// The name asked for.
        name: String,
    },
    /// A load that is no passive one.
    #[error("{what} is {value}, but must be a positive number")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// No closed surface fits between the antenna and the outer boundary.
    #[error("no closed surface fits into the {room_mm:.3} mm of air between the antenna and the outer boundary: leave more room, or mesh the air finer", room_mm = room * 1e3)]
    NoRoom {
        /// Distance of the two, m.
        room: f64,
    },
    /// The frequencies make no sense.
    #[error("the band from {lo_ghz} to {hi_ghz} GHz is none: both must be positive, the first one smaller", lo_ghz = lo / 1e9, hi_ghz = hi / 1e9)]
    Band {
        /// Lower end, Hz.
        lo: f64,
        /// Upper end, Hz.
        hi: f64,
    },
    /// The checkpoint was taken of another run.
    #[error(
        "the checkpoint belongs to another run: antenna, mesh density, band and version of the program must be the same; solve without it"
    )]
    ForeignCheckpoint,
    /// The work was called off.
    #[error(transparent)]
    Cancelled(#[from] crate::task::Cancelled),
}
