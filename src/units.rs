//! Physical constants and the conversions used where the program meets its users.
//!
//! The core computes in SI units and never names them (`height` is metres, `freq` hertz); millimetres, gigahertz and
//! degrees appear only in project files, exports, the command line and the window, always with the unit in the name.
//! Fields vary as `exp(+jωt)`.

/// Speed of light in vacuum, m/s (exact).
pub const C0: f64 = 299_792_458.0;
/// Magnetic constant, H/m (CODATA 2018).
pub const MU0: f64 = 1.256_637_062_12e-6;
/// Electric constant, F/m.
pub const EPS0: f64 = 1.0 / (MU0 * C0 * C0);
/// Wave impedance of vacuum, ohm.
pub const ETA0: f64 = MU0 * C0;
/// Metres in a millimetre.
pub const MM: f64 = 1e-3;
/// Hertz in a gigahertz.
pub const GHZ: f64 = 1e9;

/// Converts millimetres to metres.
#[must_use]
pub fn from_mm(value_mm: f64) -> f64 {
    value_mm * MM
}

/// Converts metres to millimetres.
#[must_use]
pub fn to_mm(value: f64) -> f64 {
    value / MM
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vacuum_constants_agree_with_each_other() {
        assert!((ETA0 - 376.730_313_67).abs() < 1e-6, "wave impedance {ETA0}");
        assert!((EPS0 - 8.854_187_812_8e-12).abs() < 1e-20, "electric constant {EPS0}");
    }

    #[test]
    fn millimetres_come_back_unchanged() {
        assert!((to_mm(from_mm(1.575)) - 1.575).abs() < 1e-15, "1.575 mm");
    }
}
