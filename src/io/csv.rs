//! Comma-separated numbers: points in, tables out.

use super::error::{IoError, ParseError, Place, read};
use super::stl::shorten;
use super::write_atomic_with;
use crate::geometry::DVec3;
use std::path::Path;

/// Reads points as rows `x,y,z` without a header, numbers as they stand.
///
/// Blank lines are passed over.
///
/// # Errors
/// [`IoError`] with the line that has not three finite numbers.
pub fn read_points(path: &Path) -> Result<Vec<DVec3>, IoError> {
    parse_points(&read(path)?).map_err(|e| e.at(path))
}

/// As [`read_points`], from bytes.
///
/// # Errors
/// [`ParseError`] with the line that has not three finite numbers.
pub fn parse_points(bytes: &[u8]) -> Result<Vec<DVec3>, ParseError> {
    let text = String::from_utf8_lossy(bytes);
    let rows = text.lines().enumerate().filter(|(_, row)| !row.trim().is_empty());
    rows.map(|(i, row)| point(row, Place::Line(i + 1))).collect()
}

fn point(row: &str, place: Place) -> Result<DVec3, ParseError> {
    let mut coordinates = [0.0; 3];
    let mut cells = row.split(',');
    for coordinate in &mut coordinates {
        let cell = cells.next().map(str::trim).unwrap_or_default();
        *coordinate = cell.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| {
            let what = format!("\"{}\" is not a finite number; rows are x,y,z without a header", shorten(cell));
            ParseError::new(place, what)
        })?;
    }
    match cells.next() {
        None => Ok(DVec3::from_array(coordinates)),
        Some(_) => Err(ParseError::new(place, "more than three numbers; rows are x,y,z")),
    }
}

/// Writes a table whole or not at all, each number with the fewest digits that give it back bit for bit.
///
/// * `header`: names of the columns; none for a table without header.
///
/// # Errors
/// [`IoError::System`] if the file cannot be written.
pub fn write_table<R: IntoIterator<Item = f64>>(
    path: &Path,
    header: &[&str],
    rows: impl IntoIterator<Item = R>,
) -> Result<(), IoError> {
    write_atomic_with(path, |out| {
        if !header.is_empty() {
            writeln!(out, "{}", header.join(","))?;
        }
        for row in rows {
            for (k, number) in row.into_iter().enumerate() {
                let comma = if k == 0 { "" } else { "," };
                write!(out, "{comma}{number:?}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("points.csv");
        let mut rng = fastrand::Rng::with_seed(5);
        let points: Vec<DVec3> = (0..1000)
            .map(|_| DVec3::from_array([(); 3].map(|()| (rng.f64() - 0.5) * 10_f64.powi(rng.i32(-300..300)))))
            .collect();
        write_table(&path, &[], points.iter().map(|p| p.to_array())).unwrap();
        assert_eq!(read_points(&path).unwrap(), points, "same numbers");
        write_table(&path, &["x", "y", "z"], [[1.0, -0.5, 1e-9]]).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "x,y,z\n1.0,-0.5,1e-9\n", "header and short digits");
    }

    #[test]
    fn a_bad_row_is_named() {
        for (text, line) in [("1,2,3\n\n1,2\n", 3), ("x,y,z\n", 1), ("1,2,3,4", 1), ("1,2,inf", 1), ("1;2;3", 1)] {
            assert_eq!(parse_points(text.as_bytes()).unwrap_err().place, Place::Line(line), "{text:?}");
        }
        assert_eq!(parse_points(b" 1 , 2,3\r\n").unwrap(), [DVec3::new(1.0, 2.0, 3.0)], "blanks do no harm");
    }
}
