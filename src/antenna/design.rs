//! Closed-form first guess of patch width, length and feed inset for a wanted frequency and substrate.
//!
//! The transmission-line model of the rectangular patch: width for good radiation, effective permittivity and edge
//! extension of a microstrip line, two radiating slots with mutual conductance for the edge resistance, and
//! cos²(π y₀/L) for the inset. Good to a few percent for thin substrates; the full-wave solve has the last word.
//!
//! Source: \[BAL16\] chapter 14, equations (14-1), (14-2), (14-6), (14-7), (14-12), (14-18a), (14-20a).

use super::Dielectric;
use crate::units::C0;
use std::f64::consts::PI;

/// A first guess of the patch, metres and ohms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstGuess {
    /// Patch width W, m.
    pub width: f64,
    /// Patch length L, m.
    pub length: f64,
    /// Feed inset y₀ from the radiating edge for the wanted resistance, m.
    pub inset: f64,
    /// Input resistance at the radiating edge, ohm.
    pub edge_resistance: f64,
    /// Effective permittivity of the patch as a microstrip line.
    pub eps_eff: f64,
}

/// Why no first guess can be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// An input is not a positive number.
    #[error("{field} must be a positive number, but is {value}")]
    NotPositive {
        /// What was given.
        field: &'static str,
        /// Its value, SI units.
        value: f64,
    },
    /// The substrate is too thick for the model.
    #[error(
        "the substrate is too thick for this frequency: h must be below {limit_mm:.3} mm (a tenth of a wavelength in it)"
    )]
    TooThick {
        /// Greatest height, mm.
        limit_mm: f64,
    },
}

/// Computes a first guess.
///
/// * `freq`: wanted resonance, Hz.
/// * `height`: substrate height, m.
/// * `resistance`: wanted input resistance at resonance, ohm (50 for a usual line).
///
/// # Errors
/// [`DesignError`] if an input is not positive or the substrate is thicker than a tenth of the wavelength in it.
pub fn first_guess(freq: f64, substrate: Dielectric, height: f64, resistance: f64) -> Result<FirstGuess, DesignError> {
    for (field, value) in
        [("frequency", freq), ("height", height), ("resistance", resistance), ("eps_r", substrate.eps_r)]
    {
        if !(value.is_finite() && value > 0.0) {
            return Err(DesignError::NotPositive { field, value });
        }
    }
    let eps_r = substrate.eps_r;
    let wavelength = C0 / freq;
    let limit = 0.1 * wavelength / eps_r.sqrt();
    if height > limit {
        return Err(DesignError::TooThick { limit_mm: crate::units::to_mm(limit) });
    }
    let width = wavelength / 2.0 * (2.0 / (eps_r + 1.0)).sqrt();
    let aspect = width / height;
    let eps_eff = (eps_r + 1.0) / 2.0 + (eps_r - 1.0) / 2.0 / (1.0 + 12.0 / aspect).sqrt();
    let extension = 0.412 * height * (eps_eff + 0.3) * (aspect + 0.264) / ((eps_eff - 0.258) * (aspect + 0.8));
    let length = wavelength / (2.0 * eps_eff.sqrt()) - 2.0 * extension;
    let k = 2.0 * PI / wavelength;
    let edge_resistance = 1.0 / (2.0 * (slot_conductance(k * width, 0.0) + slot_conductance(k * width, k * length)));
    // An edge resistance below the wanted one is matched best at the edge itself.
    let inset = length / PI * (resistance / edge_resistance).min(1.0).sqrt().acos();
    Ok(FirstGuess { width, length, inset, edge_resistance, eps_eff })
}

/// Self (`kl = 0`) or mutual conductance of two radiating slots of width `kw`/k at distance `kl`/k, siemens.
fn slot_conductance(kw: f64, kl: f64) -> f64 {
    let integrand = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        let half = kw / 2.0 * cos;
        let slot = if half.abs() < 1e-6 { kw / 2.0 } else { half.sin() / cos };
        slot * slot * bessel_j0(kl * sin) * sin.powi(3)
    };
    simpson(integrand, 0.0, PI) / (120.0 * PI * PI)
}

/// J₀ by its integral over a quarter period, where the trapezium rule converges faster than any power.
fn bessel_j0(x: f64) -> f64 {
    simpson(|t: f64| (x * t.sin()).cos(), 0.0, PI) / PI
}

/// Simpson's rule with a fixed 128 panels: both integrands are smooth on the scale of the interval.
fn simpson(f: impl Fn(f64) -> f64, lo: f64, hi: f64) -> f64 {
    const PANELS: u32 = 128;
    let step = (hi - lo) / f64::from(PANELS);
    let weight = |i: u32| if i == 0 || i == PANELS { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    (0..=PANELS).map(|i| weight(i) * f(lo + f64::from(i) * step)).sum::<f64>() * step / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{GHZ, from_mm, to_mm};

    #[test]
    fn the_textbook_design_is_reproduced() {
        // [BAL16] examples 14.1 and 14.2: eps_r 2.2, h 1.588 mm, 10 GHz: W 11.86, L 9.06 mm (edge 228 ohm, inset 3.1 mm).
        let duroid = Dielectric { eps_r: 2.2, tan_delta: 0.0 };
        let guess = first_guess(10.0 * GHZ, duroid, from_mm(1.588), 50.0).expect("valid input");
        assert!((to_mm(guess.width) - 11.86).abs() < 0.01, "W {}", to_mm(guess.width));
        assert!((to_mm(guess.length) - 9.06).abs() < 0.01, "L {}", to_mm(guess.length));
        assert!((guess.edge_resistance - 228.0).abs() < 10.0, "edge resistance {}", guess.edge_resistance);
        assert!((to_mm(guess.inset) - 3.126).abs() < 0.06, "inset {}", to_mm(guess.inset));
    }

    #[test]
    fn bessel_has_its_first_zero() {
        assert!((bessel_j0(0.0) - 1.0).abs() < 1e-14, "J0(0)");
        assert!(bessel_j0(2.404_825_557_695_773).abs() < 1e-12, "first zero");
    }

    #[test]
    fn impossible_wishes_are_refused() {
        let duroid = Dielectric { eps_r: 2.2, tan_delta: 0.0 };
        assert!(first_guess(-1.0, duroid, from_mm(1.5), 50.0).is_err(), "negative frequency");
        assert!(first_guess(60.0 * GHZ, duroid, from_mm(1.5), 50.0).is_err(), "thick substrate");
    }
}
