//! Touchstone version 1, one port: S11 over frequency in GHz, real and imaginary part.
//!
//! A [`Sweep`] enters, with remarks that become comment lines; `# GHz S RI R 50` heads the numbers, one frequency a
//! line. Reading is not handled.
//!
//! Source: EIA/IBIS, "Touchstone file format specification", version 1.1.

use super::{IoError, write_atomic_with};
use crate::results::Sweep;
use crate::units::GHZ;
use std::path::Path;

/// Writes a `.s1p` file.
///
/// * `remarks`: lines about where the numbers come from.
///
/// # Errors
/// [`IoError::System`].
pub fn write(sweep: &Sweep, remarks: &[String], path: &Path) -> Result<(), IoError> {
    write_atomic_with(path, |out| {
        for line in remarks.iter().flat_map(|r| r.lines()) {
            writeln!(out, "! {line}")?;
        }
        writeln!(out, "# GHz S RI R {}", sweep.reference)?;
        for (f, s) in sweep.freqs.iter().zip(&sweep.s11) {
            writeln!(out, "{:.9} {:.9e} {:.9e}", f / GHZ, s.re, s.im)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    #[test]
    fn the_file_says_unit_format_and_reference() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.s1p");
        let sweep = Sweep { freqs: vec![1e9, 10.5e9], s11: vec![Complex::new(0.5, -0.25); 2], reference: 50.0 };
        write(&sweep, &["made by hand".to_owned()], &path).expect("written");
        let text = std::fs::read_to_string(&path).expect("readable");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "! made by hand", "remark");
        assert_eq!(lines[1], "# GHz S RI R 50", "head");
        assert_eq!(lines[3], "10.500000000 5.000000000e-1 -2.500000000e-1", "numbers");
    }
}
