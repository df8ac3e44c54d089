//! The map of the flat antenna as drawn: scale, pre-warp, Green coordinates.

use crate::deform::{DeformError, GreenMap, SmoothMap, Warp};
use crate::geometry::{DMat3, DVec2, DVec3};

/// A scale of x and y, then the pre-warp, then Green coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<'a> {
    /// Factors on x and y before the warp: 1 for the whole antenna, [`super::Compensated::patch_scale`] for the patch.
    pub scale: DVec2,
    /// The pre-warp.
    pub warp: &'a Warp,
    /// Green coordinates.
    pub map: &'a GreenMap,
}

impl Sheet<'_> {
    fn rest(&self, flat: &[DVec3]) -> Vec<DVec3> {
        flat.iter().map(|p| self.warp.map((p.truncate() * self.scale).extend(p.z))).collect()
    }
}

impl SmoothMap for Sheet<'_> {
    fn positions(&self, flat: &[DVec3]) -> Result<Vec<DVec3>, DeformError> {
        self.map.positions(&self.rest(flat))
    }

    fn jacobians(&self, flat: &[DVec3]) -> Result<Vec<(DVec3, DMat3)>, DeformError> {
        let images = self.map.jacobians(&self.rest(flat))?;
        let chain = |(p, (image, green)): (&DVec3, (DVec3, DMat3))| {
            let plane = self.warp.plane(p.truncate() * self.scale).1;
            let [x, y] = [0, 1].map(|axis| plane.col(axis) * self.scale[axis]);
            let warp = DMat3::from_cols(x.extend(0.0), y.extend(0.0), DVec3::Z * self.warp.z_scale);
            (image, green * warp)
        };
        Ok(flat.iter().zip(images).map(chain).collect())
    }
}
