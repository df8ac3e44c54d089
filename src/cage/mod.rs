//! The cage: a segmented cuboid around the flat antenna, its presets, and the checks that a posed cage must pass.
//!
//! A [`Cage`] is the rest shape; a pose is one position per vertex. Presets are maps of space applied one after the
//! other to the rest vertices ([`preset::pose`]), hand edits are offsets of single vertices on top, and vertices in
//! the middle of a quad always follow their four corners. [`mod@select`] names sets of vertices by their place in the
//! lattice, [`mirror`] keeps edits symmetric.

pub mod build;
pub mod check;
pub mod mirror;
pub mod preset;
pub mod select;

pub use build::{Cage, CageError, CageParams};
pub use check::{PoseError, check_pose};
pub use mirror::{Mirror, Share};
pub use preset::{Axis, BendRule, Preset, PresetError, Section, pose};
pub use select::{Layer, Like, Selection};
