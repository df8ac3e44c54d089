//! Words that arguments of the command line choose among, and what they mean.

use crate::pipeline::{Density, Shape};
use crate::project::{BendPlane, CompensationMode, RuleSpec, ScopeSpec};
use crate::tet::Metal;
use clap::ValueEnum;

/// Plane of a bend.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Plane {
    H,
    E,
}

/// Rule of a bend.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Rule {
    /// Segments tangent to the cylinder
    Tangent,
    /// Vertices on the cylinder
    Arc,
}

/// A shape other than a bend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Section {
    Convex,
    Concave,
    Saddle,
    Twist,
    Crumple,
}

/// Which compensation.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Mode {
    /// The antenna as drawn
    None,
    /// Width-and-length scaling
    Wl,
    /// Metric pre-warp, radius calibration and thickness
    Isometric,
}

/// What WL scales.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ScopeChoice {
    /// The whole flat antenna
    Whole,
    /// The patch and its feed place alone
    Patch,
}

/// Which geometry is exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ExportShape {
    /// Carried through the posed cage, compensated as the project says
    Deformed,
    /// As drawn
    Flat,
    /// On the exact cylinder of the project's bend
    Cylinder,
}

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum DensityChoice {
    /// For a first look
    Coarse,
    /// For results
    Default,
    /// To see what a finer mesh would change
    Fine,
}

/// When a run stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum StopChoice {
    /// The reflected voltage is 40 dB down
    Decay,
    /// S11 of the record continued by its resonances stays where it is
    Settled,
}

/// Which of the paper's antennas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PaperChoice {
    /// Figures 10 to 13: bends
    Bends,
    /// Figures 14 to 16: convex, concave, saddle and twist
    Shapes,
    All,
}

/// What patch and ground are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MetalChoice {
    /// Sheets without thickness
    Sheet,
    /// Bodies of their true thickness
    Solid,
}

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Stl,
    Obj,
    Gltf,
}

impl From<Plane> for BendPlane {
    fn from(plane: Plane) -> Self {
        match plane {
            Plane::H => Self::H,
            Plane::E => Self::E,
        }
    }
}

impl From<Rule> for RuleSpec {
    fn from(rule: Rule) -> Self {
        match rule {
            Rule::Tangent => Self::Tangent,
            Rule::Arc => Self::Arc,
        }
    }
}

impl From<Mode> for CompensationMode {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::None => Self::None,
            Mode::Wl => Self::Wl,
            Mode::Isometric => Self::Isometric,
        }
    }
}

impl From<ScopeChoice> for ScopeSpec {
    fn from(scope: ScopeChoice) -> Self {
        match scope {
            ScopeChoice::Whole => Self::Whole,
            ScopeChoice::Patch => Self::Patch,
        }
    }
}

impl From<ExportShape> for Shape {
    fn from(shape: ExportShape) -> Self {
        match shape {
            ExportShape::Deformed => Self::Deformed,
            ExportShape::Flat => Self::Flat,
            ExportShape::Cylinder => Self::Cylinder,
        }
    }
}

impl From<DensityChoice> for Density {
    fn from(density: DensityChoice) -> Self {
        match density {
            DensityChoice::Coarse => Self::Coarse,
            DensityChoice::Default => Self::Default,
            DensityChoice::Fine => Self::Fine,
        }
    }
}

impl From<MetalChoice> for Metal {
    fn from(metal: MetalChoice) -> Self {
        match metal {
            MetalChoice::Sheet => Self::Sheet,
            MetalChoice::Solid => Self::Solid,
        }
    }
}
