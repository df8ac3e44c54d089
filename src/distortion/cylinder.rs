//! The exact cylinder: the reference geometry that a bend aims at, and how far a deformed patch is from it.

use super::CylinderDistance;
use crate::cage::Axis;
use crate::deform::{DeformError, SmoothMap};
use crate::geometry::{DMat3, DVec3};

/// The arc map onto a circular cylinder, applied to the antenna itself: no Green coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Axis that curves.
    pub axis: Axis,
    /// Radius of the patch's bottom plane, m; negative bends the other way.
    pub radius: f64,
    /// Height of the plane whose length is kept, m.
    pub kept_plane: f64,
}

impl Cylinder {
    fn angle(&self, along: f64) -> f64 {
        along / (self.radius + self.kept_plane)
    }

    /// Coordinate along the curve, coordinate along the axis.
    fn along_across(&self, p: DVec3) -> (f64, f64) {
        if self.axis == Axis::X { (p.x, p.y) } else { (p.y, p.x) }
    }

    fn point(&self, along: f64, across: f64, z: f64) -> DVec3 {
        if self.axis == Axis::X { DVec3::new(along, across, z) } else { DVec3::new(across, along, z) }
    }

    /// Image of one flat point, m.
    #[must_use]
    pub fn position(&self, p: DVec3) -> DVec3 {
        let (along, across) = self.along_across(p);
        let (sin, cos) = self.angle(along).sin_cos();
        let r = self.radius + p.z;
        self.point(r * sin, across, r * cos - self.radius)
    }

    fn jacobian(&self, p: DVec3) -> DMat3 {
        let (along, _) = self.along_across(p);
        let (sin, cos) = self.angle(along).sin_cos();
        let growth = (self.radius + p.z) / (self.radius + self.kept_plane);
        let curve = self.point(growth * cos, 0.0, -growth * sin);
        let straight = self.point(0.0, 1.0, 0.0);
        let up = self.point(sin, 0.0, cos);
        if self.axis == Axis::X { DMat3::from_cols(curve, straight, up) } else { DMat3::from_cols(straight, curve, up) }
    }

    /// Radius (m, positive) of the circle fitted to some points in the plane of the bend.
    ///
    /// Algebraic least squares: the circle `|q|² = 2 c·q + d` in coordinates about the points' mean.
    #[must_use]
    pub fn fitted_radius(&self, points: &[DVec3]) -> f64 {
        let plane: Vec<DVec3> = points.iter().map(|p| DVec3::new(self.along_across(*p).0, p.z, 1.0)).collect();
        let mean = plane.iter().sum::<DVec3>() / plane.len() as f64;
        // Centered, and scaled to order 1 so that the normal equations keep their digits.
        let size = plane.iter().map(|q| (*q - mean).length()).fold(f64::MIN_POSITIVE, f64::max);
        let centered = plane.iter().map(|q| ((*q - mean) / size).with_z(1.0));
        let mut normal = DMat3::ZERO;
        let mut right = DVec3::ZERO;
        for q in centered {
            normal += DMat3::from_cols(q * q.x, q * q.y, q);
            right += q * (q.x * q.x + q.y * q.y);
        }
        let solution = normal.inverse() * right;
        (solution.z + (solution.x * solution.x + solution.y * solution.y) / 4.0).sqrt() * size
    }

    /// Distance of the images of some flat points from this cylinder's, after the best shift along z.
    #[must_use]
    pub fn distance(&self, flat: &[DVec3], images: &[DVec3]) -> CylinderDistance {
        let gaps: Vec<DVec3> = flat.iter().zip(images).map(|(&p, &image)| image - self.position(p)).collect();
        let n = gaps.len() as f64;
        let shift = gaps.iter().map(|g| g.z).sum::<f64>() / n;
        let squares = || gaps.iter().map(|&g| (g - DVec3::Z * shift).length_squared());
        CylinderDistance {
            greatest: squares().fold(0.0, f64::max).sqrt(),
            rms: (squares().sum::<f64>() / n).sqrt(),
            shift,
        }
    }
}

impl SmoothMap for Cylinder {
    fn positions(&self, flat: &[DVec3]) -> Result<Vec<DVec3>, DeformError> {
        Ok(flat.iter().map(|&p| self.position(p)).collect())
    }

    fn jacobians(&self, flat: &[DVec3]) -> Result<Vec<(DVec3, DMat3)>, DeformError> {
        Ok(flat.iter().map(|&p| (self.position(p), self.jacobian(p))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_finds_the_radius_and_the_distance_is_zero() {
        for (axis, radius) in [(Axis::X, 4.2e-3), (Axis::Y, 10e-3), (Axis::X, -6.5e-3), (Axis::Y, 0.3)] {
            let cylinder = Cylinder { axis, radius, kept_plane: 0.0 };
            let flat: Vec<DVec3> =
                (0..60).map(|i| DVec3::new(f64::from(i % 9) - 4.0, f64::from(i / 9) - 3.0, 0.0) * 1e-3).collect();
            let images: Vec<DVec3> = flat.iter().map(|&p| cylinder.position(p) + DVec3::Z * 0.01).collect();
            let fitted = cylinder.fitted_radius(&images);
            assert!((fitted / radius.abs() - 1.0).abs() < 1e-9, "{axis:?} {radius}: {fitted}");
            assert!(cylinder.distance(&flat, &images).greatest < 1e-15, "shifted along z only");
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        let cylinder = Cylinder { axis: Axis::Y, radius: 5e-3, kept_plane: -1e-3 };
        let p = DVec3::new(1e-3, 2e-3, -0.5e-3);
        let jacobian = cylinder.jacobian(p);
        for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
            let step = 1e-7;
            let difference = (cylinder.position(p + unit * step) - cylinder.position(p - unit * step)) / (2.0 * step);
            assert!(difference.distance(jacobian.col(axis)) < 1e-7, "axis {axis}");
        }
    }
}
