//! Gauss-Legendre nodes and grids over a rectangle.

use crate::geometry::{DVec2, DVec3};
use std::f64::consts::PI;

/// Nodes in (-1, 1), ascending, and weights of the `n`-point Gauss-Legendre rule (weights sum to 2).
pub(super) fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        // Value and derivative of P_n by the three-term recurrence.
        let (mut older, mut value) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (older, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * older) / k);
        }
        (value, n as f64 * (x * value - older) / (x * x - 1.0))
    };
    let node = |i: usize| {
        let mut x = -(PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        // The starting value is good to 1e-3, so Newton's method reaches rounding in four steps.
        for _ in 0..6 {
            let (value, slope) = legendre(x);
            x -= value / slope;
        }
        let slope = legendre(x).1;
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// Values spread evenly over [-1, 1], ends included.
pub(super) fn uniform(n: usize) -> Vec<f64> {
    (0..n).map(|i| 2.0 * i as f64 / (n - 1) as f64 - 1.0).collect()
}

/// All pairs of two lists of relative coordinates over a rectangle about the origin, at one height; the second runs
/// fastest.
pub(super) fn plane_points(u: &[f64], v: &[f64], half: DVec2, z: f64) -> Vec<DVec3> {
    u.iter().flat_map(|&u| v.iter().map(move |&v| DVec3::new(u * half.x, v * half.y, z))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_up_to_its_degree() {
        for n in 2..26_usize {
            let rule = gauss_legendre(n);
            for degree in [0, 1, 2, 2 * n - 2, 2 * n - 1] {
                let power = i32::try_from(degree).unwrap();
                let found: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert!((found - exact).abs() < 1e-13, "{n} points, degree {degree}: {found}");
            }
        }
    }
}
