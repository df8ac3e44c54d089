//! What a run of the field says of the antenna: reflection at its port over frequency, and what it radiates.
//!
//! ```text
//! tlm::Record --sweep--> Sweep (S11 at the ground's top, 50 ohm) --summary--> Resonance
//! tlm::SurfaceField --far_fields--> FarField (patterns, powers) --cut--> Cut (E and H plane)
//! ```

mod far_field;
mod radiation;
mod s_params;
mod sphere;

pub use far_field::{Cut, CutPlane, FLOOR_DB, FarField, Powers};
pub use radiation::{far_field, far_fields};
pub use s_params::{FeedLine, Resonance, Sweep, frequencies, sweep};
