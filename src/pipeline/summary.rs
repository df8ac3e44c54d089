//! What a saved geometry says of its making. The JSON keys are the field names here and stay.

use super::Deformed;
use crate::distortion::Figures;
use crate::project::Project;
use crate::units::to_mm;
use serde::Serialize;

/// Distortion figures as JSON: errors, strains and rho are fractions, lengths millimetres.
#[derive(Clone, Debug, Serialize)]
pub struct FiguresReport {
    /// Surface error of the patch.
    rho_patch: f64,
    /// Surface error of the substrate.
    rho_substrate: f64,
    /// Width of the deformed patch.
    width_mm: f64,
    /// Its relative error.
    width_error: f64,
    /// Length of the deformed patch.
    length_mm: f64,
    /// Its relative error.
    length_error: f64,
    /// Mean substrate thickness under the patch.
    thickness_mm: f64,
    /// Its relative error.
    thickness_error: f64,
    /// Largest strain of the patch.
    patch_strain: f64,
    /// Root mean square strain of the patch.
    patch_strain_rms: f64,
    /// Largest strain of the substrate's top.
    substrate_strain: f64,
    /// Fitted radius, where the antenna is bent onto a cylinder; else null.
    radius_mm: Option<f64>,
    /// Greatest distance from the exact cylinder; else null.
    cylinder_distance_mm: Option<f64>,
    /// Root mean square distance from the exact cylinder; else null.
    cylinder_distance_rms_mm: Option<f64>,
}

impl From<&Figures> for FiguresReport {
    fn from(f: &Figures) -> Self {
        Self {
            rho_patch: f.rho_patch,
            rho_substrate: f.rho_substrate,
            width_mm: to_mm(f.width),
            width_error: f.width_error,
            length_mm: to_mm(f.length),
            length_error: f.length_error,
            thickness_mm: to_mm(f.thickness),
            thickness_error: f.thickness_error,
            patch_strain: f.patch_strain,
            patch_strain_rms: f.patch_strain_rms,
            substrate_strain: f.substrate_strain,
            radius_mm: f.radius.map(to_mm),
            cylinder_distance_mm: f.cylinder_distance.map(|d| to_mm(d.greatest)),
            cylinder_distance_rms_mm: f.cylinder_distance.map(|d| to_mm(d.rms)),
        }
    }
}

/// What the certificate of an export says of the geometry's making: presets, hand edits, compensation, and figures where
/// the antenna is the patch's template.
///
/// # Panics
/// Never for a checked project: its numbers are finite.
#[must_use]
pub fn summary(project: &Project, deformed: &Deformed) -> serde_json::Map<String, serde_json::Value> {
    let part = |value: serde_json::Result<serde_json::Value>| value.expect("plain fields of finite numbers");
    [
        ("presets", part(serde_json::to_value(&project.presets))),
        ("hand_edits", project.hand_edits.len().into()),
        ("compensation", part(serde_json::to_value(project.settings.compensation))),
        ("figures", part(serde_json::to_value(deformed.figures.as_ref().map(FiguresReport::from)))),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into_iter()
    .collect()
}
