//! Far-field source files (`.ffs`, version 3.0) for CST and all that reads them: complex patterns with their powers.
//!
//! [`FarField`]s of one grid enter, one block of numbers each. Phi runs from 0 to 360 degrees, both ends written, as the
//! outer loop; theta from 0 to 180. Columns: phi, theta (degrees), real and imaginary part of `E_theta`, then of `E_phi`:
//! `r E exp(+jkr)` in volts, peak phasors for the stimulated power of the head, in watts. The phase's origin is the
//! origin of coordinates. Reading is not handled.
//!
//! Source: online help of CST Microwave Studio, "Farfield Source File Format".

use super::{IoError, write_atomic_with};
use crate::results::FarField;
use std::io::Write;
use std::path::Path;

/// Writes far fields by ascending frequency.
///
/// # Errors
/// [`IoError::System`].
pub fn write(fields: &[FarField], path: &Path) -> Result<(), IoError> {
    write_atomic_with(path, |out| {
        writeln!(out, "// CST Farfield Source File\n\n// Version:\n3.0\n\n// Data Type\nFarfield\n")?;
        writeln!(out, "// #Frequencies\n{}\n", fields.len())?;
        for (name, axis) in [("Position", [0.0; 3]), ("zAxis", [0.0, 0.0, 1.0]), ("xAxis", [1.0, 0.0, 0.0])] {
            writeln!(out, "// {name}\n{:.6e} {:.6e} {:.6e}\n", axis[0], axis[1], axis[2])?;
        }
        writeln!(out, "// Radiated/Accepted/Stimulated Power , Frequency")?;
        for FarField { powers, freq, .. } in fields {
            writeln!(out, "{:.9e}\n{:.9e}\n{:.9e}\n{freq:.9e}\n", powers.radiated, powers.accepted, powers.incident)?;
        }
        fields.iter().try_for_each(|field| block(field, out))
    })
}

fn block(field: &FarField, out: &mut dyn Write) -> std::io::Result<()> {
    let (n_theta, n_phi) = (field.theta.len(), field.phi.len());
    writeln!(out, "\n// >> Total #phi samples, total #theta samples\n{} {n_theta}\n", n_phi + 1)?;
    writeln!(out, "// >> Phi, Theta, Re(E_Theta), Im(E_Theta), Re(E_Phi), Im(E_Phi):")?;
    for p in 0..=n_phi {
        let phi_deg = 360.0 * p as f64 / n_phi as f64;
        for (t, theta) in field.theta.iter().enumerate() {
            let [a, b] = [&field.e_theta, &field.e_phi].map(|e| e[t * n_phi + p % n_phi]);
            let theta_deg = theta.to_degrees();
            writeln!(out, "{phi_deg:8.3} {theta_deg:8.3} {:.8e} {:.8e} {:.8e} {:.8e}", a.re, a.im, b.re, b.im)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Powers;
    use nalgebra::Complex;
    use std::f64::consts::PI;

    #[test]
    fn every_sample_stands_in_its_row() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.ffs");
        let n = 6;
        let number = |k: usize, part: f64| Complex::new(k as f64, part);
        let field = |freq| FarField {
            freq,
            theta: (0..=n).map(|i| PI * i as f64 / n as f64).collect(),
            phi: (0..2 * n).map(|j| PI * j as f64 / n as f64).collect(),
            e_theta: (0..(n + 1) * 2 * n).map(|k| number(k, 0.5)).collect(),
            e_phi: (0..(n + 1) * 2 * n).map(|k| number(k, -0.5)).collect(),
            powers: Powers { incident: 1.0, accepted: 0.75, radiated: 0.5, ..Powers::default() },
        };
        write(&[field(1e10), field(1.1e10)], &path).expect("written");
        let text = std::fs::read_to_string(&path).expect("readable");
        // Whatever begins with // is a heading; sections are read by their headings.
        let sections: Vec<(String, Vec<f64>)> = text
            .split("// ")
            .filter(|s| !s.trim().is_empty())
            .map(|section| {
                let (head, body) = section.split_once('\n').expect("a heading");
                (head.trim().to_owned(), body.split_whitespace().filter_map(|w| w.parse().ok()).collect())
            })
            .collect();
        let numbers = |head: &str, k: usize| {
            let mut found = sections.iter().filter(|(h, _)| h.starts_with(head));
            found.nth(k).map(|(_, numbers)| numbers.clone()).expect("a section")
        };
        assert!(text.starts_with("// CST Farfield Source File\n"), "first line");
        assert_eq!(numbers("#Frequencies", 0), [2.0], "blocks");
        assert_eq!(numbers("zAxis", 0), [0.0, 0.0, 1.0], "axes");
        assert_eq!(
            numbers("Radiated/Accepted/Stimulated Power , Frequency", 0)[4..],
            [0.5, 0.75, 1.0, 1.1e10],
            "powers"
        );
        for block in 0..2 {
            assert_eq!(numbers(">> Total #phi samples, total #theta samples", block), [13.0, 7.0], "counts");
            let rows = numbers(">> Phi, Theta,", block);
            assert_eq!(rows.len(), 13 * 7 * 6, "numbers");
            for (k, row) in rows.chunks(6).enumerate() {
                let (p, t) = (k / 7, k % 7);
                let at = (t * 12 + p % 12) as f64;
                assert_eq!(row, [30.0 * p as f64, 30.0 * t as f64, at, 0.5, at, -0.5], "row {k}");
            }
        }
    }
}
