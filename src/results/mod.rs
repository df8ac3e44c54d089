//! What a run of the field says of the antenna: reflection at its port over frequency.
//!
//! ```text
//! tlm::Record --sweep--> Sweep (S11 at the ground's top, 50 ohm) --resonance--> Resonance
//!      '-----fit--> Fit (damped modes) --continued_sweep--> Sweep, before the field has died away
//! ```

mod fit;
mod s_params;

pub use fit::{Fit, FittedResonance, Mode, continued_sweep, fit, fitted_resonance};
pub use s_params::{FeedLine, Resonance, Sweep, frequencies, sweep};
