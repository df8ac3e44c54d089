//! What a run of the field says of the antenna: reflection at its port over frequency, and what it radiates.
//!
//! ```text
//! tlm::Record --sweep--> Sweep (S11 at the ground's top, 50 ohm) --resonance--> Resonance
//!      '-----fit--> Fit (damped modes) --continued_sweep--> Sweep, before the field has died away
//! ```

mod far_field;
mod fit;
mod s_params;
mod sphere;

pub use far_field::{Cut, CutPlane, FLOOR_DB, FarField, Powers};
pub use fit::{Fit, FittedResonance, Mode, continued_sweep, fit, fitted_resonance};
pub use s_params::{FeedLine, Resonance, Sweep, frequencies, sweep};
