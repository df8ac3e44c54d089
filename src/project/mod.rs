//! The saved, undoable value: parameters, presets, hand edits and settings; nothing computed.
//!
//! A [`Project`] is what the user decided, in the units users think in (millimetres, degrees), so that a typed 10.83
//! stays 10.83. It is plain and comparable: undo keeps whole copies, and "unsaved changes" is `!=`. The conversions
//! to the core's checked SI values are the `to_…` methods. [`Edit`] is every way it changes, [`History`] its past,
//! [`mod@file`] its form on disk.

pub mod amount;
mod bodies;
pub mod check;
pub mod edit;
mod example;
pub mod file;
pub mod history;
pub mod materials;
mod name;
mod outline;

pub use bodies::{BodiesError, BodiesSpec, BodyKind, BodySpec, FeedSpec, LooseBody, Shape, WELD_MM};
pub use check::ProjectError;
pub use edit::{Edit, EditError};
pub use example::Example;
pub use history::History;

use crate::antenna::{Conductor, Dielectric, PatchParams, Resistor};
use crate::cage::{Axis, BendRule, CageParams, Preset, Section};
use crate::geometry::{DVec2, DVec3};
use crate::units::{from_mm, to_mm};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything the user decided about one antenna and its deformation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Project {
    /// The flat antenna by its template, which gives way to bodies of the user's own.
    pub antenna: AntennaSpec,
    /// The rest cage.
    pub cage: CageSpec,
    /// Presets, applied first to last.
    pub presets: Vec<PresetEntry>,
    /// Offsets of single cage vertices on top of the presets, by vertex number, mm.
    pub hand_edits: BTreeMap<u32, [f64; 3]>,
    /// How the deformed antenna is computed.
    pub settings: Settings,
    /// Materials of the user's own, to choose from by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialSpec>,
    /// Bodies of the user's own in place of the template.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bodies: Option<BodiesSpec>,
}

/// Dimensions and materials of the antenna; lengths in millimetres. See [`PatchParams`] for their meaning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the fields are those of PatchParams, documented there, with their unit in the name")]
pub struct AntennaSpec {
    pub width_mm: f64,
    pub length_mm: f64,
    /// Corners of a patch that is no rectangle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outline_mm: Vec<[f64; 2]>,
    pub patch_thickness_mm: f64,
    pub height_mm: f64,
    pub ground_width_mm: f64,
    pub ground_length_mm: f64,
    pub ground_thickness_mm: f64,
    pub inset_mm: f64,
    pub feed_offset_mm: f64,
    pub pin_radius_mm: f64,
    pub coax_radius_mm: f64,
    pub coax_length_mm: f64,
    pub pin_segments: usize,
    pub coax_segments: usize,
    pub substrate: MaterialSpec,
    pub sheath: MaterialSpec,
    #[serde(default, skip_serializing_if = "MetalSpec::is_perfect")]
    pub patch_metal: MetalSpec,
    #[serde(default, skip_serializing_if = "MetalSpec::is_perfect")]
    pub ground_metal: MetalSpec,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub resistors: Vec<ResistorSpec>,
}

/// What a sheet of metal is made of.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum MetalSpec {
    /// Without loss.
    #[default]
    Perfect,
    /// A lossy sheet, such as conductive fabric.
    Sheet {
        /// What it is called in the library; empty for a value typed by hand.
        #[serde(default, skip_serializing_if = "String::is_empty")]
        name: String,
        /// Ohm per square of the whole sheet, both of its sides together.
        ohm_per_square: f64,
    },
}

/// A resistor between ground and patch, at a place of the flat antenna.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResistorSpec {
    /// Across the width, from the patch's center, mm.
    pub x_mm: f64,
    /// Along the length, from the patch's center, mm.
    pub y_mm: f64,
    /// Ohm.
    pub ohm: f64,
}

/// A dielectric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// What it is called, in the library or by the user; empty for values typed by hand. It does not rule the values.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Relative permittivity.
    pub eps_r: f64,
    /// Loss tangent.
    pub tan_delta: f64,
}

/// Padding and segmentation of the cage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CageSpec {
    /// Padding along x, y and z, mm.
    pub padding_mm: [f64; 3],
    /// Segments along x and y.
    pub segments: [usize; 2],
}

/// A preset of the stack, which may be switched off without losing its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PresetEntry {
    /// Whether it is applied.
    pub enabled: bool,
    /// The preset.
    pub preset: PresetSpec,
}

/// The direction in which the sheet is bent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BendPlane {
    /// H-plane bending: x curves.
    H,
    /// E-plane bending: y curves.
    E,
}

/// How the stations of a bent cage are placed; see [`BendRule`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RuleSpec {
    /// Segments tangent to the cylinder.
    Tangent,
    /// Vertices on the cylinder.
    Arc,
}

/// One preset with its numbers as typed; see [`Preset`] for their meaning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
#[allow(missing_docs, reason = "the fields are those of Preset, documented there, with their unit in the name")]
pub enum PresetSpec {
    Bend { plane: BendPlane, radius_mm: f64, rule: RuleSpec, kept_plane_mm: f64 },
    Convex { radius_mm: f64, amplitude_mm: f64 },
    Concave { radius_mm: f64, amplitude_mm: f64 },
    Saddle { radius_mm: f64, amplitude_mm: f64 },
    Twist { amplitude_mm: f64, rate_deg_per_mm: f64 },
    Crumple { amplitude_mm: f64, waves: [f64; 2], phase_deg: f64 },
}

/// How the deformed antenna is computed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Greatest distance of a split edge from the smooth surface, mm.
    pub tolerance_mm: f64,
    /// Which compensation is applied.
    pub compensation: CompensationMode,
    /// What the WL compensation scales.
    pub scope: ScopeSpec,
    /// Degrees of the polynomials that measure width and length.
    pub fit_orders: [usize; 2],
}

/// Which compensation is applied to the flat antenna.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CompensationMode {
    /// None: the antenna as drawn.
    None,
    /// The paper's width-and-length scaling.
    Wl,
    /// Metric pre-warp, radius calibration and thickness.
    Isometric,
}

/// What the WL compensation scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScopeSpec {
    /// The whole flat antenna.
    Whole,
    /// The patch and its feed place alone.
    Patch,
}

impl Default for AntennaSpec {
    /// The paper's antenna.
    fn default() -> Self {
        let duroid = materials::DIELECTRICS[0].to_spec();
        Self {
            width_mm: 10.83,
            length_mm: 8.177,
            outline_mm: Vec::new(),
            patch_thickness_mm: 0.035,
            height_mm: 1.575,
            ground_width_mm: 20.0,
            ground_length_mm: 20.0,
            ground_thickness_mm: 0.035,
            inset_mm: 1.75,
            feed_offset_mm: 0.0,
            pin_radius_mm: 0.625,
            coax_radius_mm: 2.16,
            coax_length_mm: 3.0,
            pin_segments: 14,
            coax_segments: 28,
            substrate: duroid.clone(),
            sheath: duroid,
            patch_metal: MetalSpec::Perfect,
            ground_metal: MetalSpec::Perfect,
            resistors: Vec::new(),
        }
    }
}

impl Default for CageSpec {
    fn default() -> Self {
        Self { padding_mm: [3.0; 3], segments: [10, 10] }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance_mm: 0.01,
            compensation: CompensationMode::Isometric,
            scope: ScopeSpec::Whole,
            fit_orders: [5, 5],
        }
    }
}

impl MaterialSpec {
    fn to_dielectric(&self) -> Dielectric {
        Dielectric { eps_r: self.eps_r, tan_delta: self.tan_delta }
    }
}

impl MetalSpec {
    fn is_perfect(&self) -> bool {
        *self == Self::Perfect
    }

    fn to_conductor(&self) -> Conductor {
        match self {
            Self::Perfect => Conductor::Perfect,
            Self::Sheet { ohm_per_square, .. } => Conductor::Sheet(*ohm_per_square),
        }
    }
}

impl ResistorSpec {
    fn to_resistor(self) -> Resistor {
        Resistor { at: DVec2::new(from_mm(self.x_mm), from_mm(self.y_mm)), resistance: self.ohm }
    }
}

impl AntennaSpec {
    /// The same antenna in SI units, not yet validated.
    #[must_use]
    pub fn to_params(&self) -> PatchParams {
        PatchParams {
            width: from_mm(self.width_mm),
            length: from_mm(self.length_mm),
            outline: self.outline(),
            patch_thickness: from_mm(self.patch_thickness_mm),
            height: from_mm(self.height_mm),
            ground_width: from_mm(self.ground_width_mm),
            ground_length: from_mm(self.ground_length_mm),
            ground_thickness: from_mm(self.ground_thickness_mm),
            inset: from_mm(self.inset_mm),
            feed_offset: from_mm(self.feed_offset_mm),
            pin_radius: from_mm(self.pin_radius_mm),
            coax_radius: from_mm(self.coax_radius_mm),
            coax_length: from_mm(self.coax_length_mm),
            pin_segments: self.pin_segments,
            coax_segments: self.coax_segments,
            substrate: self.substrate.to_dielectric(),
            sheath: self.sheath.to_dielectric(),
            patch_metal: self.patch_metal.to_conductor(),
            ground_metal: self.ground_metal.to_conductor(),
            resistors: self.resistors.iter().map(|r| r.to_resistor()).collect(),
        }
    }
}

impl CageSpec {
    /// The same cage in SI units.
    #[must_use]
    pub fn to_params(self) -> CageParams {
        CageParams { padding: DVec3::from_array(self.padding_mm.map(from_mm)), segments: self.segments }
    }
}

impl PresetSpec {
    /// The same preset in SI units and radians.
    #[must_use]
    pub fn to_preset(self) -> Preset {
        let curved = |section, radius_mm, amplitude_mm| Preset::Curved {
            section,
            radius: from_mm(radius_mm),
            amplitude: from_mm(amplitude_mm),
        };
        match self {
            Self::Bend { plane, radius_mm, rule, kept_plane_mm } => Preset::Bend {
                axis: if plane == BendPlane::H { Axis::X } else { Axis::Y },
                radius: from_mm(radius_mm),
                rule: if rule == RuleSpec::Tangent { BendRule::Tangent } else { BendRule::Arc },
                kept_plane: from_mm(kept_plane_mm),
            },
            Self::Convex { radius_mm, amplitude_mm } => curved(Section::Convex, radius_mm, amplitude_mm),
            Self::Concave { radius_mm, amplitude_mm } => curved(Section::Concave, radius_mm, amplitude_mm),
            Self::Saddle { radius_mm, amplitude_mm } => curved(Section::Saddle, radius_mm, amplitude_mm),
            Self::Twist { amplitude_mm, rate_deg_per_mm } => {
                Preset::Twist { amplitude: from_mm(amplitude_mm), rate: to_mm(rate_deg_per_mm.to_radians()) }
            }
            Self::Crumple { amplitude_mm, waves, phase_deg } => {
                Preset::Crumple { amplitude: from_mm(amplitude_mm), waves, phase: phase_deg.to_radians() }
            }
        }
    }
}

impl Project {
    /// The presets that are switched on, in SI units, with their places in the stack.
    #[must_use]
    pub fn active_presets(&self) -> Vec<Preset> {
        self.presets.iter().filter(|e| e.enabled).map(|e| e.preset.to_preset()).collect()
    }
}
