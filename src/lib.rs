//! Conformant carries a flat antenna through a cage of three-dimensional Green coordinates, gap-free.
//!
//! A wearable antenna gets bent, crumpled and twisted. Here it is drawn flat, enclosed in a coarse cage, and the cage
//! is deformed; the whole antenna follows, all parts through the same map, so that metal and substrate keep sharing
//! their interfaces bit for bit.
//!
//! ```text
//! PatchParams -antenna-> Plc (flat) --cage--> Cage (rest) --deform--> GreenWeights --posed cage--> Plc (deformed)
//!                                                |                                   |
//!                                                '------------ distortion <----------' rho, strain, compensation
//! PatchParams, compensated map -tet-> TetMesh -tlm-> Record -results-> Sweep (S11)
//! ```
//!
//! Every arrow is a pure function over checked values; nothing below [`pipeline`] knows of threads (beyond rayon
//! inside itself), files or windows. Modules appear here in the order of that flow, and a module may only name the
//! ones that `tests/architecture.rs` lists for it.

pub mod task;
pub mod units;

pub mod geometry;

pub mod antenna;
pub mod cage;

pub mod deform;

pub mod distortion;

pub mod tet;

pub mod tlm;

pub mod results;

pub mod io;
pub mod plot;
pub mod project;
#[cfg(feature = "gui")]
pub mod render;

pub mod pipeline;

pub mod report;

pub mod cli;
#[cfg(feature = "gui")]
pub mod gui;
