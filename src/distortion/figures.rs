//! The numbers by which a deformed antenna is judged.

use super::quadrature::{gauss_legendre, plane_points, uniform};
use super::strain::rectangle_strain;
use super::{CompensationError, Cylinder, RhoGrid, patch_size};
use crate::antenna::PatchParams;
use crate::deform::SmoothMap;
use crate::geometry::{DVec2, DVec3};

/// Distance of the patch's bottom plane from the exact cylinder's, after the best shift along z, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylinderDistance {
    /// Greatest distance.
    pub greatest: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// The shift along z by which the deformed antenna lies above the cylinder, m.
    pub shift: f64,
}

/// Distortion of one deformed antenna against the flat one as drawn. Relative figures are fractions, not percent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Surface error rho of the patch: its total surface over the flat one's, minus 1.
    pub rho_patch: f64,
    /// Surface error rho of the substrate.
    pub rho_substrate: f64,
    /// Width of the deformed patch along its surface, m.
    pub width: f64,
    /// Length of the deformed patch along its surface, m.
    pub length: f64,
    /// Relative error of the width.
    pub width_error: f64,
    /// Relative error of the length.
    pub length_error: f64,
    /// Mean substrate thickness under the patch, m.
    pub thickness: f64,
    /// Relative error of the mean thickness.
    pub thickness_error: f64,
    /// Largest strain (principal stretch minus 1, in magnitude) of the patch's bottom plane.
    pub patch_strain: f64,
    /// Root mean square strain of the patch's bottom plane.
    pub patch_strain_rms: f64,
    /// Largest strain of the substrate's top plane.
    pub substrate_strain: f64,
    /// Radius of the circle fitted to the patch's bottom plane, m; only where the antenna is bent onto a cylinder.
    pub radius: Option<f64>,
    /// Distance from the exact cylinder; only where the antenna is bent onto a cylinder.
    pub cylinder_distance: Option<CylinderDistance>,
}

/// One iteration of a compensation, as reported while it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompensationStep {
    /// Relative error of the width before this step.
    pub width_error: f64,
    /// Relative error of the length before this step.
    pub length_error: f64,
    /// Relative error of the substrate's mean thickness before this step (0 where it is not compensated).
    pub thickness_error: f64,
    /// Relative error of the fitted radius before this step (0 where it is not calibrated).
    pub radius_error: f64,
    /// Largest strain of the patch's bottom plane before this step.
    pub patch_strain: f64,
}

/// Samples along each side of a rectangle whose largest strain is asked for.
const STRAIN_SAMPLES: usize = 21;

/// Measures a deformed antenna against the one drawn.
///
/// * `patch`, `substrate`: maps of the flat antenna as drawn; they differ where the patch alone was scaled.
/// * `cylinder`: the cylinder aimed at, if the antenna is bent onto one.
/// * `orders`: polynomial degrees of the width and length fit.
///
/// # Errors
/// [`CompensationError`] where a map is not defined or the orders cannot be fitted.
pub fn measure<M: SmoothMap>(
    params: &PatchParams,
    patch: &M,
    substrate: &M,
    cylinder: Option<&Cylinder>,
    orders: [usize; 2],
) -> Result<Figures, CompensationError> {
    let half = DVec2::new(params.width, params.length) / 2.0;
    let ground = DVec2::new(params.ground_width, params.ground_length) / 2.0;
    let [rho_patch, rho_substrate] = RhoGrid::new(params).rho_of(patch, substrate)?;
    let size = patch_size(patch, half, orders)?;
    let thickness = mean_thickness(patch, half, params.height)?;
    let patch_strain = rectangle_strain(patch, half, 0.0, STRAIN_SAMPLES)?;
    let bottom = bottom_points(half);
    let images = patch.positions(&bottom)?;
    Ok(Figures {
        rho_patch,
        rho_substrate,
        width: size.x,
        length: size.y,
        width_error: size.x / params.width - 1.0,
        length_error: size.y / params.length - 1.0,
        thickness,
        thickness_error: thickness / params.height - 1.0,
        patch_strain: patch_strain.largest,
        patch_strain_rms: patch_strain.rms,
        substrate_strain: rectangle_strain(substrate, ground, 0.0, STRAIN_SAMPLES)?.largest,
        radius: cylinder.map(|c| c.fitted_radius(&images)),
        cylinder_distance: cylinder.map(|c| c.distance(&bottom, &images)),
    })
}

/// Flat points of the patch's bottom plane where radius and distance from the cylinder are judged, rim included.
fn bottom_points(half: DVec2) -> Vec<DVec3> {
    plane_points(&uniform(21), &uniform(15), half, 0.0)
}

/// Mean distance (m) between the images of the patch's footprint on the substrate's top and bottom.
pub(super) fn mean_thickness(map: &impl SmoothMap, half: DVec2, height: f64) -> Result<f64, CompensationError> {
    let rule = gauss_legendre(12);
    let nodes: Vec<f64> = rule.iter().map(|r| r.0).collect();
    let top = map.positions(&plane_points(&nodes, &nodes, half, 0.0))?;
    let bottom = map.positions(&plane_points(&nodes, &nodes, half, -height))?;
    let weights = rule.iter().flat_map(|a| rule.iter().map(move |b| a.1 * b.1 / 4.0));
    Ok(top.iter().zip(&bottom).zip(weights).map(|((t, b), w)| w * t.distance(*b)).sum())
}
