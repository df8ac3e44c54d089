//! Functions on the sphere of directions by their samples: interpolation and integrals.
//!
//! The samples of one component of a far field lie at `theta_i = i π/n`, i = 0..=n, and `phi_j = j π/n`, j = 0..2n, rows
//! by theta. A source within a sphere of radius a radiates spherical waves up to a degree N little above ka; along each
//! great circle through the poles, and along each circle of latitude, its spherical components are trigonometric
//! polynomials of degree N + 1. For N + 1 < n the samples hold all there is, and the trigonometric interpolation of
//! them is exact; for N + 1 <= n/2 so is the quadrature of |E|² (Clenshaw-Curtis in theta, the trapezium rule in phi).
//!
//! Along a great circle the unit vectors of theta and phi turn round at the poles: a component at -theta is minus the
//! one at theta on the other side.

use nalgebra::Complex;
use std::f64::consts::PI;

/// Which samples a grid has: n intervals from pole to pole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    n: usize,
}

impl Grid {
    /// * `n`: intervals from pole to pole, even, at least 2.
    pub(super) fn new(n: usize) -> Self {
        assert!(n >= 2 && n.is_multiple_of(2), "an even number of intervals, not {n}");
        Self { n }
    }

    pub(super) fn theta(self) -> Vec<f64> {
        (0..=self.n).map(|i| PI * i as f64 / self.n as f64).collect()
    }

    pub(super) fn phi(self) -> Vec<f64> {
        (0..2 * self.n).map(|j| PI * j as f64 / self.n as f64).collect()
    }

    /// The place of the sample `i` steps along the great circle that begins at the pole towards `phi_j`, and its sign.
    fn on_circle(self, i: usize, j: usize) -> (usize, f64) {
        let columns = 2 * self.n;
        if i <= self.n { (i * columns + j, 1.0) } else { ((columns - i) * columns + (j + self.n) % columns, -1.0) }
    }

    /// Weights of the samples of each polygon `x - k π/n`, k = 0..2n: a trigonometric polynomial's value at x.
    fn weights(self, x: f64) -> Vec<f64> {
        let n = self.n as f64;
        let weight = |k: usize| {
            let d = x - PI * k as f64 / n;
            let tangent = (d / 2.0).tan();
            // At a sample the kernel is 1.
            if tangent.abs() < 1e-9 { 1.0 } else { (n * d).sin() / (2.0 * n * tangent) }
        };
        (0..2 * self.n).map(weight).collect()
    }

    /// Values of components at one theta and every `phi_j`.
    fn latitude(self, samples: &[Complex<f64>], theta: f64) -> Vec<Complex<f64>> {
        let weights = self.weights(theta);
        let column = |j: usize| {
            let terms = weights.iter().enumerate().map(|(i, w)| {
                let (place, sign) = self.on_circle(i, j);
                samples[place] * (w * sign)
            });
            terms.sum()
        };
        (0..2 * self.n).map(column).collect()
    }

    /// The components at the crossings of some latitudes and longitudes, rows by theta.
    pub(super) fn interpolate(self, samples: &[Complex<f64>], thetas: &[f64], phis: &[f64]) -> Vec<Complex<f64>> {
        let along: Vec<Vec<f64>> = phis.iter().map(|&phi| self.weights(phi)).collect();
        let mut values = Vec::with_capacity(thetas.len() * phis.len());
        for &theta in thetas {
            let row = self.latitude(samples, theta);
            values.extend(along.iter().map(|w| row.iter().zip(w).map(|(v, w)| v * *w).sum::<Complex<f64>>()));
        }
        values
    }

    /// `∫ f dΩ` from samples.
    pub(super) fn integral(self, samples: impl Iterator<Item = f64>) -> f64 {
        let columns = 2 * self.n;
        let weights: Vec<f64> = (0..=self.n).map(|i| self.polar_weight(i) * PI / self.n as f64).collect();
        samples.enumerate().map(|(place, f)| f * weights[place / columns]).sum()
    }

    /// Weight of `theta_i` in `∫ f sin(theta) dtheta`, by Clenshaw and Curtis.
    fn polar_weight(self, i: usize) -> f64 {
        let n = self.n as f64;
        let theta = PI * i as f64 / n;
        let half = self.n / 2;
        let terms = (1..=half).map(|k| {
            let share = if k == half { 1.0 } else { 2.0 };
            let k = k as f64;
            share * (2.0 * k * theta).cos() / (4.0 * k * k - 1.0)
        });
        let ends = if i == 0 || i == self.n { 1.0 } else { 2.0 };
        ends / n * (1.0 - terms.sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The spherical components of a vector that is a polynomial of the direction.
    fn sample(theta: f64, phi: f64) -> Complex<f64> {
        let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
        let (x, y, z) = (st * cp, st * sp, ct);
        let vector = [Complex::new(x * x * y, z), Complex::new(y * z, x * x * x), Complex::new(1.0 + z * z * z, x * y)];
        vector[0] * (ct * cp) + vector[1] * (ct * sp) - vector[2] * st
    }

    #[test]
    fn interpolation_is_exact_for_few_spherical_waves() {
        let grid = Grid::new(6);
        let samples: Vec<_> =
            grid.theta().iter().flat_map(|&t| grid.phi().into_iter().map(move |p| sample(t, p))).collect();
        let (thetas, phis) = ([0.0, 0.3, 1.0, PI / 2.0, 3.1, PI], [0.0, 0.1, 2.0, PI, 5.0]);
        let found = grid.interpolate(&samples, &thetas, &phis);
        let wanted = thetas.iter().flat_map(|&t| phis.iter().map(move |&p| sample(t, p)));
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((found - wanted).norm() < 1e-13, "{found} instead of {wanted}");
        }
    }

    #[test]
    fn integrals_of_polynomials_are_exact() {
        let grid = Grid::new(8);
        let integral = |f: fn(f64, f64, f64) -> f64| {
            let at = |t: f64, p: f64| f(t.sin() * p.cos(), t.sin() * p.sin(), t.cos());
            grid.integral(grid.theta().iter().flat_map(|&t| grid.phi().into_iter().map(move |p| at(t, p))))
        };
        assert!((integral(|_, _, _| 1.0) / (4.0 * PI) - 1.0).abs() < 1e-14, "area");
        assert!((integral(|x, _, _| x * x) / (4.0 * PI / 3.0) - 1.0).abs() < 1e-14, "x²");
        assert!((integral(|_, y, z| (y * z).powi(2)) / (4.0 * PI / 15.0) - 1.0).abs() < 1e-13, "y² z²");
        assert!((integral(|_, _, z| z.powi(8)) / (4.0 * PI / 9.0) - 1.0).abs() < 1e-13, "z to the eighth");
        assert!(integral(|x, _, z| x + z.powi(3)).abs() < 1e-14, "odd");
    }
}
