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
