//! What a run of the field says of the antenna: reflection at its port over frequency.
//!
//! ```text
//! tlm::Record --sweep--> Sweep (S11 at the ground's top, 50 ohm) --summary--> Resonance
//! ```

mod s_params;

pub use s_params::{FeedLine, Resonance, Sweep, frequencies, sweep};
