//! What every smooth map of space can be asked.

use super::{DeformError, GreenMap};
use crate::geometry::{DMat3, DVec3};

/// A smooth map of points with its derivatives.
pub trait SmoothMap {
    /// Images of points, m.
    ///
    /// # Errors
    /// [`DeformError`] where the map is not defined.
    fn positions(&self, points: &[DVec3]) -> Result<Vec<DVec3>, DeformError>;

    /// Images of points with the Jacobian there; column k is the derivative along axis k.
    ///
    /// # Errors
    /// [`DeformError`] where the map is not defined.
    fn jacobians(&self, points: &[DVec3]) -> Result<Vec<(DVec3, DMat3)>, DeformError>;
}

impl SmoothMap for GreenMap {
    fn positions(&self, points: &[DVec3]) -> Result<Vec<DVec3>, DeformError> {
        Self::positions(self, points)
    }

    fn jacobians(&self, points: &[DVec3]) -> Result<Vec<(DVec3, DMat3)>, DeformError> {
        Self::jacobians(self, points)
    }
}
