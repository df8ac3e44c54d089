//! The far field at one frequency and what is read from it.
//!
//! E is `r E(r) exp(+jkr)` for r to infinity, in volts, peak phasors; scaled so that the wave that enters the port
//! carries 1 W (`powers.incident`; an antenna without a port keeps the scale of what drives it). Angles are radians,
//! theta from +z, phi from +x; decibels are of power.
//!
//! Directivity compares with the power found in the far field itself, efficiency the radiated power with the lost one,
//! so that neither depends on how well the powers add up: [`FarField::balance`] says that.
//!
//! Sources: \[BAL16\] chapter 2 (directivity, gain, efficiency), \[LUD73\] (third definition of co and cross polarization).

use super::sphere::Grid;
use crate::units::ETA0;
use nalgebra::Complex;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// Mean powers at one frequency, W.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Powers {
    /// Carried to the port by the incident wave.
    pub incident: f64,
    /// Taken in at the port: incident minus reflected.
    pub accepted: f64,
    /// Lost in dielectrics and lossy sheets within the closed surface, from the fields in them.
    pub lost: f64,
    /// Through the closed surface around the antenna, from the fields on it.
    pub crossing: f64,
    /// In the far field, by quadrature over the sphere.
    pub radiated: f64,
}

/// The far field at one frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct FarField {
    /// Frequency, Hz.
    pub freq: f64,
    /// From 0 to π, evenly spaced, `[n_theta]`.
    pub theta: Vec<f64>,
    /// From 0 to less than 2π, evenly spaced by the same step, `[n_phi]`.
    pub phi: Vec<f64>,
    /// Component along theta, V, `[n_theta x n_phi]`, rows by theta.
    pub e_theta: Vec<Complex<f64>>,
    /// Component along phi, V, `[n_theta x n_phi]`, rows by theta.
    pub e_phi: Vec<Complex<f64>>,
    /// The powers.
    pub powers: Powers,
}

/// A principal plane of the flat patch, whose resonant length lies along y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutPlane {
    /// The plane x = 0, which holds the electric field: psi towards +y.
    E,
    /// The plane y = 0: psi towards +x.
    H,
}

/// Directivity around one plane, dBi.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// The plane.
    pub plane: CutPlane,
    /// Angle from broadside (+z), from -π to π, rad.
    pub psi: Vec<f64>,
    /// Of both polarizations, dBi.
    pub total: Vec<f64>,
    /// Of the polarization along y (Ludwig's third definition), dBi.
    pub co: Vec<f64>,
    /// Of the polarization along x (Ludwig's third definition), dBi.
    pub cross: Vec<f64>,
}

/// Decibels below which nothing is told apart from nothing.
pub const FLOOR_DB: f64 = -120.0;

/// Most intervals from pole to pole of a field that is read: ten times those of any antenna that can be solved.
const MAX_INTERVALS: usize = 4096;

/// Decibels of a ratio of powers, at least [`FLOOR_DB`].
fn decibels(ratio: f64) -> f64 {
    10.0 * ratio.max(1e-12).log10()
}

impl FarField {
    /// The far field from its components on a grid; finds the radiated power.
    ///
    /// * `n`: even; theta in n steps from 0 to π, phi in 2n steps.
    /// * `powers`: but for the radiated one.
    pub(super) fn new(freq: f64, n: usize, [e_theta, e_phi]: [Vec<Complex<f64>>; 2], powers: Powers) -> Self {
        let grid = Grid::new(n);
        let density = e_theta.iter().zip(&e_phi).map(|(a, b)| (a.norm_sqr() + b.norm_sqr()) / (2.0 * ETA0));
        let powers = Powers { radiated: grid.integral(density), ..powers };
        Self { freq, theta: grid.theta(), phi: grid.phi(), e_theta, e_phi, powers }
    }

    /// A far field that was kept; `None` if the numbers are none.
    ///
    /// * `n`: even; theta in n steps from 0 to π, phi in 2n steps.
    /// * `e`: the components along theta and phi, V, `[n_theta x n_phi]` each, rows by theta.
    #[must_use]
    pub fn from_samples(freq: f64, n: usize, e: [Vec<Complex<f64>>; 2], powers: Powers) -> Option<Self> {
        let has_grid = (2..=MAX_INTERVALS).contains(&n) && n.is_multiple_of(2);
        let is_whole = |e: &Vec<Complex<f64>>| {
            e.len() == 2 * n * (n + 1) && e.iter().all(|e| e.re.is_finite() && e.im.is_finite())
        };
        let is_field = has_grid && freq > 0.0 && freq.is_finite() && e.iter().all(is_whole);
        let [e_theta, e_phi] = e;
        is_field.then(|| {
            let grid = Grid::new(n);
            Self { freq, theta: grid.theta(), phi: grid.phi(), e_theta, e_phi, powers }
        })
    }

    /// The field of a source larger by a factor; what the port takes is left as it is.
    pub(super) fn scaled(mut self, by: Complex<f64>) -> Self {
        self.e_theta.iter_mut().chain(&mut self.e_phi).for_each(|e| *e *= by);
        let Powers { lost, crossing, radiated, .. } = &mut self.powers;
        [lost, crossing, radiated].into_iter().for_each(|p| *p *= by.norm_sqr());
        self
    }

    fn grid(&self) -> Grid {
        Grid::new(self.theta.len() - 1)
    }

    /// The components along theta and phi in any direction, V.
    #[must_use]
    pub fn at(&self, theta: f64, phi: f64) -> [Complex<f64>; 2] {
        [&self.e_theta, &self.e_phi].map(|e| self.grid().interpolate(e, &[theta], &[phi])[0])
    }

    /// The same field on another grid.
    ///
    /// * `n`: intervals from pole to pole, even.
    #[must_use]
    pub fn resampled(&self, n: usize) -> Self {
        let (theta, phi) = (Grid::new(n).theta(), Grid::new(n).phi());
        let [e_theta, e_phi] = [&self.e_theta, &self.e_phi].map(|e| self.grid().interpolate(e, &theta, &phi));
        Self { theta, phi, e_theta, e_phi, ..*self }
    }

    /// Directivity of components of the field, a ratio of powers.
    fn directivity_of(&self, e: [Complex<f64>; 2]) -> f64 {
        let intensity = (e[0].norm_sqr() + e[1].norm_sqr()) / (2.0 * ETA0);
        4.0 * PI * intensity / self.powers.radiated.max(f64::MIN_POSITIVE)
    }

    /// Directivity on the grid, dBi, `[n_theta x n_phi]`.
    #[must_use]
    pub fn directivity(&self) -> Vec<f64> {
        self.e_theta.iter().zip(&self.e_phi).map(|(&a, &b)| decibels(self.directivity_of([a, b]))).collect()
    }

    /// Gain on the grid, dBi: directivity less what is lost within the antenna, `[n_theta x n_phi]`.
    #[must_use]
    pub fn gain(&self) -> Vec<f64> {
        let loss = decibels(self.efficiency());
        self.directivity().into_iter().map(|d| d + loss).collect()
    }

    /// Directivity in one direction, dBi.
    #[must_use]
    pub fn directivity_at(&self, theta: f64, phi: f64) -> f64 {
        decibels(self.directivity_of(self.at(theta, phi)))
    }

    /// Directivity towards +z, dBi.
    #[must_use]
    pub fn boresight(&self) -> f64 {
        self.directivity_at(0.0, 0.0)
    }

    /// Greatest directivity, dBi, with its theta and phi: to a tenth of a degree.
    #[must_use]
    pub fn max_directivity(&self) -> (f64, [f64; 2]) {
        let fine = self.resampled(90);
        let directivity = fine.directivity();
        let greatest = (0..directivity.len()).max_by(|&a, &b| directivity[a].total_cmp(&directivity[b])).unwrap_or(0);
        let mut best = (directivity[greatest], [fine.theta[greatest / 180], fine.phi[greatest % 180]]);
        // Five times closer around the best one, twice.
        for step in [0.4_f64, 0.1].map(f64::to_radians) {
            let around = |x: f64| (-5..=5).map(move |k| x + f64::from(k) * step);
            let [theta, phi] = best.1;
            for (t, p) in around(theta).flat_map(|t| around(phi).map(move |p| (t, p))) {
                let found = self.directivity_at(t, p);
                if (0.0..=PI).contains(&t) && found > best.0 {
                    best = (found, [t, p.rem_euclid(2.0 * PI)]);
                }
            }
        }
        best
    }

    /// Directivity towards +z over the one towards -z, dB.
    #[must_use]
    pub fn front_to_back(&self) -> f64 {
        self.boresight() - self.directivity_at(PI, 0.0)
    }

    /// Radiation efficiency: radiated power over the radiated and lost one.
    #[must_use]
    pub fn efficiency(&self) -> f64 {
        self.powers.radiated / (self.powers.radiated + self.powers.lost).max(f64::MIN_POSITIVE)
    }

    /// Total efficiency: radiation efficiency times accepted over incident power; `None` without a port.
    #[must_use]
    pub fn total_efficiency(&self) -> Option<f64> {
        (self.powers.incident > 0.0).then(|| self.efficiency() * self.powers.accepted / self.powers.incident)
    }

    /// Radiated and lost power over the accepted one: 1 for a perfect solution; `None` where nothing is accepted.
    #[must_use]
    pub fn balance(&self) -> Option<f64> {
        (self.powers.accepted > 0.0).then(|| (self.powers.radiated + self.powers.lost) / self.powers.accepted)
    }

    /// The same with the power through the closed surface for that in the far field; `None` where nothing is accepted.
    ///
    /// Cells and the line's end balance it exactly, so what is missing was cut off at the end of the run or is due to the
    /// lossy cells' voltages, taken at their edges.
    #[must_use]
    pub fn near_balance(&self) -> Option<f64> {
        (self.powers.accepted > 0.0).then(|| (self.powers.crossing + self.powers.lost) / self.powers.accepted)
    }

    /// The directivity around a plane, every degree.
    #[must_use]
    pub fn cut(&self, plane: CutPlane) -> Cut {
        let side = match plane {
            CutPlane::E => FRAC_PI_2,
            CutPlane::H => 0.0,
        };
        let mut cut = Cut { plane, psi: Vec::new(), total: Vec::new(), co: Vec::new(), cross: Vec::new() };
        for degree in -180_i32..=180 {
            let psi = f64::from(degree).to_radians();
            let phi = if degree < 0 { side + PI } else { side };
            let [e_theta, e_phi] = self.at(psi.abs(), phi);
            let (sin, cos) = phi.sin_cos();
            let zero = Complex::from(0.0);
            cut.psi.push(psi);
            cut.total.push(decibels(self.directivity_of([e_theta, e_phi])));
            cut.co.push(decibels(self.directivity_of([e_theta * sin + e_phi * cos, zero])));
            cut.cross.push(decibels(self.directivity_of([e_theta * cos - e_phi * sin, zero])));
        }
        cut
    }
}

impl Cut {
    /// Angle between the directions around the greatest directivity where it has fallen by half, rad; `None` where it
    /// falls so far on one side only, or on none.
    #[must_use]
    pub fn half_power_width(&self) -> Option<f64> {
        let n = self.psi.len() - 1;
        let peak = (0..n).max_by(|&a, &b| self.total[a].total_cmp(&self.total[b]))?;
        let level = self.total[peak] - 10.0 * 2.0_f64.log10();
        // The first and the last value are the same direction.
        let at = |k: usize| self.total[(peak + k) % n];
        let fall = |step: &dyn Fn(usize) -> f64| -> Option<f64> {
            let k = (1..n).find(|&k| step(k) < level)?;
            Some(k as f64 - (level - step(k)) / (step(k - 1) - step(k)))
        };
        let steps = fall(&at)? + fall(&|k| at(n - k))?;
        (steps < n as f64).then(|| steps * 2.0 * PI / n as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field from its components by direction.
    fn field(e: impl Fn(f64, f64) -> [f64; 2]) -> FarField {
        let grid = Grid::new(24);
        let all = grid.theta().into_iter().flat_map(|t| grid.phi().into_iter().map(move |p| (t, p)));
        let (e_theta, e_phi) =
            all.map(|(t, p)| e(t, p)).map(|[a, b]| (Complex::new(0.0, a), Complex::new(0.0, b))).unzip();
        FarField::new(10e9, 24, [e_theta, e_phi], Powers::default())
    }

    #[test]
    fn a_small_dipole_has_its_directivity_and_width() {
        // Along y: E is the part of y across the direction.
        let dipole = field(|t, p| [t.cos() * p.sin(), p.cos()]);
        let power = 8.0 * PI / 3.0 / (2.0 * ETA0);
        assert!((dipole.powers.radiated / power - 1.0).abs() < 1e-13, "{} W", dipole.powers.radiated);
        assert!((dipole.boresight() - 10.0 * 1.5_f64.log10()).abs() < 1e-9, "1.76 dBi, found {}", dipole.boresight());
        assert!(dipole.front_to_back().abs() < 1e-9, "the same both ways");
        let (e, h) = (dipole.cut(CutPlane::E), dipole.cut(CutPlane::H));
        let width = e.half_power_width().expect("it falls to nothing").to_degrees();
        assert!((width - 90.0).abs() < 0.05, "half-power width {width}");
        assert_eq!(h.half_power_width(), None, "all round");
        assert!(e.total[90] < -100.0, "nothing along the dipole");
        for cut in [&e, &h] {
            assert!(cut.co.iter().zip(&cut.total).all(|(a, b)| (a - b).abs() < 1e-6), "one polarization");
            assert!(cut.cross.iter().all(|x| *x < -100.0), "none across it");
        }
    }

    #[test]
    fn the_greatest_directivity_is_found_between_the_samples() {
        // A cardioid towards theta 40, phi 200 degrees, of a fixed polarization on both sides.
        let (theta, phi) = (40.0_f64.to_radians(), 200.0_f64.to_radians());
        let along = |t: f64, p: f64| t.sin() * theta.sin() * (p - phi).cos() + t.cos() * theta.cos();
        // Components of the vector (1 + cos) times the part of a fixed vector across the direction.
        let tilted = field(|t, p| {
            let a = [-theta.cos() * phi.cos(), -theta.cos() * phi.sin(), theta.sin()];
            let u = 1.0 + along(t, p);
            let e_theta = a[0] * t.cos() * p.cos() + a[1] * t.cos() * p.sin() - a[2] * t.sin();
            [u * e_theta, u * (a[1] * p.cos() - a[0] * p.sin())]
        });
        let (greatest, [t, p]) = tilted.max_directivity();
        assert!((t - theta).abs() < 2e-3 && (p - phi).abs() < 3e-3, "theta {} phi {}", t.to_degrees(), p.to_degrees());
        assert!((greatest - tilted.directivity_at(theta, phi)).abs() < 1e-4, "{greatest} dBi");
        let again = tilted.resampled(60);
        assert!((again.max_directivity().0 - greatest).abs() < 1e-9, "the same on a finer grid");
    }

    #[test]
    fn powers_make_efficiencies() {
        let powers = Powers { incident: 1.0, accepted: 0.9, lost: 0.0, ..Powers::default() };
        let mut dipole = field(|t, _| [-t.sin(), 0.0]);
        dipole.powers = Powers { lost: dipole.powers.radiated / 4.0, radiated: dipole.powers.radiated, ..powers };
        assert!((dipole.efficiency() - 0.8).abs() < 1e-12, "four fifths are radiated");
        assert!((dipole.total_efficiency().expect("a port") - 0.72).abs() < 1e-12, "of nine tenths");
        assert!(dipole.gain().iter().zip(dipole.directivity()).all(|(g, d)| (d - g - 0.969_1).abs() < 1e-4), "gain");
        dipole.powers.accepted = 0.0;
        assert_eq!(dipole.balance(), None, "nothing to compare with");
    }
}
