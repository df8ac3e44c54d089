//! What a run of the field says of the antenna: reflection at its port over frequency, and what it radiates.
//!
//! ```text
//! tlm::Record --sweep--> Sweep (S11 at the ground's top, 50 ohm) --summary--> Resonance
//! ```

mod far_field;
mod s_params;
mod sphere;

pub use far_field::{Cut, CutPlane, FLOOR_DB, FarField, Powers};
pub use s_params::{FeedLine, Resonance, Sweep, frequencies, sweep};
