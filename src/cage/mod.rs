//! The cage: a segmented cuboid around the flat antenna, its presets, and the checks that a posed cage must pass.
//!
//! A [`Cage`] is the rest shape; a pose is one position per vertex. Presets are maps of space applied one after the
//! other to the rest vertices ([`preset::pose`]), hand edits are offsets of single vertices on top, and vertices in
//! the middle of a quad always follow their four corners.

pub mod build;
pub mod check;
pub mod preset;

pub use build::{Cage, CageError, CageParams};
pub use check::{PoseError, check_pose};
pub use preset::{Axis, BendRule, Preset, PresetError, Section, pose};
