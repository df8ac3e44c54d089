//! Transmission line modelling on tetrahedra: the field in time, by scattering in cells and connecting at edges.
//!
//! ```text
//! TetMesh --Network::new--> Network (coefficients, fixed) --Run (state, steps)--> port series
//!                                                          '--> Checkpoint, from which it goes on with the same bits
//! ```
//!
//! Each cell is a node with a port per edge; a port's voltage is the line integral of the electric field along the
//! edge. Scattering solves the cell's own circuit exactly; connecting makes all cells at an edge agree on its voltage.
//! As the time step goes to zero this is the lowest-order Whitney finite element method; for every time step up to the
//! largest one that the cells allow it is stable, provably, cell by cell. Second order where the field is smooth.
//!
//! Fields vary as exp(+jωt). Lengths are metres; inside, c = ε0 = µ0 = 1, so times are lengths.
//!
//! Sources: \[SEW05\] (unstructured TLM), \[JOH87\] (the condensed node on cubes).

mod assembly;
mod blocks;
mod cell;
mod checkpoint;
mod error;
mod huygens;
mod loads;
mod modes;
mod network;
mod outgoing;
mod port;
mod real;
mod recorder;
mod run;
mod sheet_edge;
mod slots;
mod source;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_cavity;

pub use checkpoint::Checkpoint;
pub use error::TlmError;
pub use huygens::{ClosedSurface, Huygens};
pub use loads::{Loads, LumpedPort, Resistor};
pub use network::{Network, NetworkSettings, StepLimit, orthogonality_error};
pub use real::Real;
pub use recorder::{FieldRecorder, SurfaceField};
pub use run::{Record, Run};
pub use source::Pulse;

/// Goes up when the same mesh and settings give another result, so that results kept from before are known as such.
pub const SOLVER_VERSION: u32 = 3;
