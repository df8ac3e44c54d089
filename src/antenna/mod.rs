//! The flat antenna: a coax-fed patch, its parameters, a first guess of them, and its surface complex; or bodies of the
//! user's own, welded into such a complex ([`bodies`]).
//!
//! Frame: the patch's bottom plane is z = 0 with the patch above it and substrate and ground below; x runs across the
//! width W, y along the resonant length L, the patch's center is the origin. The feed is a coaxial line from below
//! whose inner conductor (the pin) passes through ground and substrate to the patch.

pub mod bodies;
pub mod design;
mod footprint;
pub mod loads;
pub mod outline;
pub mod params;
pub mod patch;

pub use bodies::{Body, BodyFault, WeldError};
pub use design::{DesignError, FirstGuess, first_guess};
pub use loads::{Conductor, MAX_RESISTORS, Resistor};
pub use outline::OutlineError;
pub use params::{Dielectric, ParamError, PatchParams};
pub use patch::{PatchError, flat_complex};

/// Name of the substrate's region.
pub const SUBSTRATE: &str = "substrate";
/// Name of the patch's region.
pub const PATCH: &str = "patch";
/// Name of the ground plane's region.
pub const GROUND: &str = "ground";
/// Name of the region of the feed pin, from the port plane to the patch.
pub const PIN: &str = "pin";
/// Name of the region between pin and outer conductor of the coaxial line.
pub const COAX: &str = "coax";
