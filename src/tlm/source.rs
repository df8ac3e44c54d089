//! The exciting pulse: a Gaussian that modulates the middle of the band.

use super::TlmError;
use std::f64::consts::{LN_10, TAU};

/// A modulated Gaussian whose spectrum is 20 dB down at the ends of its band; amplitude 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// Middle of the band, Hz.
    pub center: f64,
    /// Half width of the band, Hz.
    pub half_width: f64,
}

/// Delay of the peak in pulse widths: at the start the pulse is 140 dB down.
const DELAY: f64 = 4.0;

impl Pulse {
    /// The pulse for a band, Hz.
    ///
    /// # Errors
    /// [`TlmError::Band`].
    pub fn new(lo: f64, hi: f64) -> Result<Self, TlmError> {
        if !(lo > 0.0 && hi > lo && hi.is_finite()) {
            return Err(TlmError::Band { lo, hi });
        }
        Ok(Self { center: (lo + hi) / 2.0, half_width: (hi - lo) / 2.0 })
    }

    /// Width of the Gaussian `exp(-(t / width)²)`, s.
    fn width(&self) -> f64 {
        2.0 * LN_10.sqrt() / (TAU * self.half_width)
    }

    /// Value at a time, s.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        let t = time - DELAY * self.width();
        (-(t / self.width()).powi(2)).exp() * (TAU * self.center * t).cos()
    }

    /// Time after which the pulse is over, s.
    #[must_use]
    pub fn end(&self) -> f64 {
        2.0 * DELAY * self.width()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spectrum_falls_by_20_db_at_the_ends_of_the_band() {
        let pulse = Pulse::new(8e9, 12e9).expect("a band");
        let dt = 1e-12;
        let spectrum = |f: f64| {
            let n = (pulse.end() / dt).ceil();
            let (mut re, mut im) = (0.0, 0.0);
            let mut t = 0.0;
            while t < n * dt {
                re += pulse.at(t) * (TAU * f * t).cos();
                im += pulse.at(t) * (TAU * f * t).sin();
                t += dt;
            }
            re.hypot(im)
        };
        for f in [8e9, 12e9] {
            let ratio = spectrum(f) / spectrum(10e9);
            assert!((ratio - 0.1).abs() < 0.003, "{ratio} at {f:e} Hz");
        }
        assert!(pulse.at(0.0).abs() < 1e-6 && pulse.at(pulse.end()).abs() < 1e-6, "begins and ends at nothing");
        assert!(Pulse::new(2e9, 1e9).is_err() && Pulse::new(f64::NAN, 1e9).is_err(), "no band");
    }
}
