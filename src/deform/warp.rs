//! The pre-warp of the flat antenna: a smooth map of the plane, with a scale of the heights.
//!
//! Compensation moves the flat antenna within its cage before the Green coordinates carry it, so that it comes out
//! right: `(x, y, z) -> (a(x, y), b(x, y), k z)`. `a` and `b` are tensor products of Chebyshev polynomials over the
//! substrate's rectangle; every part goes through the same map, so interfaces stay shared.

use crate::geometry::{DMat2, DVec2, DVec3, chebyshev};

/// A map of the flat antenna into the rest cage.
#[derive(Clone, Debug, PartialEq)]
pub struct Warp {
    /// Half extents of the rectangle that the polynomials are scaled to, m.
    half: DVec2,
    degrees: [usize; 2],
    /// Coefficients of `(a, b)`, m: `[(p + 1) (q + 1)]`, y's degree running fastest.
    coefficients: Vec<DVec2>,
    /// Factor on heights about z = 0.
    pub z_scale: f64,
}

impl Warp {
    /// The map that scales x and y about the origin.
    ///
    /// * `half`: half extents of the substrate, m.
    #[must_use]
    pub fn scale(half: DVec2, factors: DVec2) -> Self {
        Self::scale_with_degrees(half, factors, [1, 1])
    }

    /// [`Self::scale`] with room for higher degrees, as the start of a fit.
    #[must_use]
    pub fn scale_with_degrees(half: DVec2, factors: DVec2, degrees: [usize; 2]) -> Self {
        let mut coefficients = vec![DVec2::ZERO; (degrees[0] + 1) * (degrees[1] + 1)];
        coefficients[degrees[1] + 1].x = half.x * factors.x;
        coefficients[1].y = half.y * factors.y;
        Self { half, degrees, coefficients, z_scale: 1.0 }
    }

    /// The identity.
    #[must_use]
    pub fn identity(half: DVec2) -> Self {
        Self::scale(half, DVec2::ONE)
    }

    /// Number of basis functions.
    #[must_use]
    pub fn n_terms(&self) -> usize {
        self.coefficients.len()
    }

    /// Adds an increment to the coefficients of `(a, b)`, m.
    ///
    /// # Panics
    /// If there is not one increment per basis function.
    pub fn add(&mut self, increments: &[DVec2]) {
        assert_eq!(increments.len(), self.coefficients.len(), "one increment per basis function");
        self.coefficients.iter_mut().zip(increments).for_each(|(c, d)| *c += *d);
    }

    /// Values and derivatives of all basis functions at a point: `[n_terms]` triples (value, d/dx, d/dy).
    pub fn basis(&self, p: DVec2) -> impl Iterator<Item = [f64; 3]> {
        let [nx, ny] = self.degrees.map(|d| d + 1);
        let t = p / self.half;
        let slope = self.half.recip();
        chebyshev(t.x).take(nx).flat_map(move |(x, dx)| {
            chebyshev(t.y).take(ny).map(move |(y, dy)| [x * y, dx * slope.x * y, x * dy * slope.y])
        })
    }

    /// The plane part of the map and its Jacobian (columns: derivatives along x and y).
    #[must_use]
    pub fn plane(&self, p: DVec2) -> (DVec2, DMat2) {
        let mut image = DVec2::ZERO;
        let mut jacobian = DMat2::ZERO;
        for (&c, [value, dx, dy]) in self.coefficients.iter().zip(self.basis(p)) {
            image += c * value;
            jacobian += DMat2::from_cols(c * dx, c * dy);
        }
        (image, jacobian)
    }

    /// Maps a point of the flat antenna into the rest cage.
    #[must_use]
    pub fn map(&self, p: DVec3) -> DVec3 {
        self.plane(p.truncate()).0.extend(self.z_scale * p.z)
    }

    /// The flat point whose image is `p`, by Newton's method.
    ///
    /// * `guess`: a place near it; a compensating warp is so smooth that a few steps reach rounding from any place.
    ///
    /// Where the warp cannot be inverted (a fold), the last iterate is returned.
    #[must_use]
    pub fn inverse(&self, p: DVec3, guess: DVec2) -> DVec3 {
        const STEPS: usize = 12;
        let target = p.truncate();
        let mut q = guess;
        for _ in 0..STEPS {
            let (image, jacobian) = self.plane(q);
            let step = jacobian.inverse() * (target - image);
            if !step.is_finite() {
                break;
            }
            q += step;
            if step.length_squared() <= (1e-14 * self.half).length_squared() {
                break;
            }
        }
        q.extend(p.z / self.z_scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bumpy() -> Warp {
        let mut warp = Warp::scale_with_degrees(DVec2::new(0.01, 0.012), DVec2::new(1.2, 0.95), [5, 3]);
        let mut rng = fastrand::Rng::with_seed(5);
        let bumps: Vec<_> = (0..warp.n_terms()).map(|_| DVec2::new(rng.f64(), rng.f64()) * 2e-5).collect();
        warp.add(&bumps);
        warp.z_scale = 1.07;
        warp
    }

    #[test]
    fn identity_and_scale_are_what_they_say() {
        let half = DVec2::new(0.01, 0.02);
        let p = DVec3::new(0.003, -0.011, -0.001);
        assert!(Warp::identity(half).map(p).distance(p) < 1e-17, "identity");
        let scaled = Warp::scale(half, DVec2::new(1.5, 0.5)).map(p);
        assert!(scaled.distance(DVec3::new(0.0045, -0.0055, -0.001)) < 1e-17, "{scaled}");
    }

    #[test]
    fn derivatives_match_differences() {
        let warp = bumpy();
        let p = DVec2::new(0.004, -0.007);
        let step = 1e-6;
        let jacobian = warp.plane(p).1;
        for (axis, unit) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
            let difference = (warp.plane(p + unit * step).0 - warp.plane(p - unit * step).0) / (2.0 * step);
            assert!(difference.distance(jacobian.col(axis)) < 1e-6, "axis {axis}");
        }
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        let warp = bumpy();
        for p in [DVec3::ZERO, DVec3::new(0.009, 0.011, 1e-4), DVec3::new(-0.01, 0.012, -1e-3)] {
            assert!(warp.inverse(warp.map(p), DVec2::ZERO).distance(p) < 1e-15, "{p}");
        }
    }
}
