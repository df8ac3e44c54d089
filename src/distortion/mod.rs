//! What the map does to the antenna, and how the flat antenna is changed beforehand to undo it.
//!
//! Everything here is measured on the smooth map, not on the faceted surface, relative to the antenna as drawn. A
//! [`SmoothMap`](crate::deform::SmoothMap) is any map with its derivatives: [`Sheet`] is ours (pre-warp, then Green
//! coordinates), [`Cylinder`] the exact cylinder that a bend aims at; both are judged by the same [`measure`].
//!
//! [`compensate_wl`] is the paper's width-and-length scaling; [`compensate_isometric`] restores the metric locally,
//! the radius and the substrate's thickness.

pub mod cylinder;
pub mod figures;
mod isometric;
mod patch_size;
mod quadrature;
mod sheet;
mod strain;
mod surface;
mod wl;

pub use cylinder::Cylinder;
pub use figures::{CompensationStep, CylinderDistance, Figures, measure};
pub use isometric::{IsometricProblem, compensate_isometric};
pub use patch_size::{fitted_size, patch_size, sample_points};
pub use sheet::Sheet;
pub use strain::{facet_strain, principal_stretches};
pub use surface::RhoGrid;
pub use wl::{Scope, TOLERANCE as WL_TOLERANCE, WlProblem, compensate_wl};

use crate::deform::{DeformError, GreenMap, Warp};
use crate::geometry::DVec2;
use crate::task::Cancelled;

/// A compensation's outcome: what to do to the flat antenna and the cage.
#[derive(Clone, Debug)]
pub struct Compensated {
    /// Pre-warp of the whole flat antenna.
    pub warp: Warp,
    /// Factors on the patch's width, length and feed place, where the patch alone is scaled; else 1.
    pub patch_scale: DVec2,
    /// Factor on the bend radius of the cage; 1 where it is not calibrated.
    pub radius_factor: f64,
    /// The map of the cage with that radius.
    pub map: GreenMap,
    /// Iterations, each with the errors found before it and at last those that remain.
    pub steps: Vec<CompensationStep>,
}

/// Why a compensation has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompensationError {
    /// The iteration runs away or does not settle.
    #[error(
        "the compensation does not converge: after {iterations} iterations the width is off by {width_percent:.2} % and \
         the length by {length_percent:.2} %; use higher fit orders, a smaller padding or a larger bend radius"
    )]
    Diverged {
        /// Iterations done.
        iterations: usize,
        /// Remaining error of the width, percent.
        width_percent: f64,
        /// Remaining error of the length, percent.
        length_percent: f64,
    },
    /// The compensated antenna does not fit into its cage.
    #[error(
        "the compensated antenna leaves its cage near x = {x_mm:.2} mm, y = {y_mm:.2} mm: increase the padding along \
         that axis, or the bend radius"
    )]
    LeavesCage {
        /// x of the warped point, mm.
        x_mm: f64,
        /// y of the warped point, mm.
        y_mm: f64,
    },
    /// Polynomial orders that cannot be fitted.
    #[error("fit orders {0} and {1} are out of range: choose 1 to {MAX_FIT_ORDER} each")]
    FitOrders(usize, usize),
    /// The cage with a calibrated radius is not possible.
    #[error("the cage cannot be calibrated: {0}")]
    Cage(#[from] crate::cage::PresetError),
    /// The map cannot be evaluated.
    #[error(transparent)]
    Deform(DeformError),
    /// Called off.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Higher orders than this cannot be told apart by the 17 samples across the patch.
pub const MAX_FIT_ORDER: usize = 12;

impl From<DeformError> for CompensationError {
    fn from(error: DeformError) -> Self {
        match error {
            DeformError::OutsideCage { position, .. } => {
                Self::LeavesCage { x_mm: position.x * 1e3, y_mm: position.y * 1e3 }
            }
            DeformError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Deform(other),
        }
    }
}
