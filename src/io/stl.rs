//! STL: one closed solid as loose triangles, single precision, no unit of its own (ours are millimetres).
//!
//! Written as binary; read as binary or text. The format has no vertices to share: corners belong together where they
//! agree bit for bit, which is why one rounding per vertex of the whole antenna decides whether solids fit.

use super::error::{ParseError, Place};
use crate::geometry::DVec3;

/// Bytes before the first triangle: 80 of comment and the count.
const HEADER: usize = 84;
/// Bytes per triangle: twelve numbers and two bytes that we leave zero.
const RECORD: usize = 50;

/// One triangle as stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Unit normal as stored; zero where the writer did not care.
    pub normal: [f32; 3],
    /// Corners in the file's unit, counter-clockwise seen from outside; finite, and zero is always positive zero.
    pub corners: [[f32; 3]; 3],
}

/// The triangles under one `solid` name; the name may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// What follows `solid` in text; empty in binary files, whose header is a comment.
    pub name: String,
    /// Its triangles.
    pub triangles: Vec<Triangle>,
}

/// A corner in double precision, exactly.
#[must_use]
pub fn widen(corner: [f32; 3]) -> DVec3 {
    DVec3::from_array(corner.map(f64::from))
}

/// The unit normal of the stored corners, or zero for a triangle without area.
#[must_use]
pub fn normal_of(corners: &[[f32; 3]; 3]) -> DVec3 {
    let [a, b, c] = corners.map(widen);
    (b - a).cross(c - a).normalize_or_zero()
}

/// Encodes triangles as binary STL.
///
/// * `comment`: ASCII, cut at 80 bytes; must not begin with "solid".
/// * `triangles`: corners in millimetres, counter-clockwise from outside.
pub(super) fn encode(comment: &str, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + RECORD * triangles.len());
    bytes.extend(comment.bytes().chain(std::iter::repeat(b' ')).take(80));
    let count = u32::try_from(triangles.len()).expect("face numbers have 32 bits");
    bytes.extend(count.to_le_bytes());
    for corners in triangles {
        let normal = super::rounding::to_single(normal_of(corners));
        for number in std::iter::once(&normal).chain(corners).flatten() {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

/// Reads binary or text STL; all solids of a text together.
///
/// # Errors
/// As [`parse_solids`].
pub fn parse(bytes: &[u8]) -> Result<Vec<Triangle>, ParseError> {
    Ok(parse_solids(bytes)?.into_iter().flat_map(|s| s.triangles).collect())
}

/// Reads binary or text STL; a text may hold several solids.
///
/// # Errors
/// [`ParseError`] for anything cut off, overlong, unknown, or not finite.
pub fn parse_solids(bytes: &[u8]) -> Result<Vec<Solid>, ParseError> {
    let claimed = bytes.get(80..HEADER).map(|c| u64::from(u32::from_le_bytes([c[0], c[1], c[2], c[3]])));
    let expected = claimed.map(|n| HEADER as u64 + n * RECORD as u64);
    if expected == Some(bytes.len() as u64) {
        return Ok(vec![Solid { name: String::new(), triangles: parse_binary(&bytes[HEADER..])? }]);
    }
    if bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return parse_text(&String::from_utf8_lossy(bytes));
    }
    let what = match (claimed, expected) {
        (Some(n), Some(length)) => {
            format!(
                "a binary STL of {n} triangles has {length} bytes, but this file has {}: it is cut off or was changed",
                bytes.len()
            )
        }
        _ => format!("only {} bytes: neither text (it would begin with \"solid\") nor a binary STL", bytes.len()),
    };
    Err(ParseError::new(Place::File, what))
}

fn parse_binary(records: &[u8]) -> Result<Vec<Triangle>, ParseError> {
    let (records, _) = records.as_chunks::<RECORD>();
    let read = |(i, record): (usize, &[u8; RECORD])| {
        let mut numbers = [[0.0_f32; 3]; 4];
        let (words, _) = record.as_chunks::<4>();
        for (k, word) in words.iter().enumerate() {
            let number = f32::from_le_bytes(*word);
            if !number.is_finite() {
                let what = format!("triangle {i} has a number that is not finite");
                return Err(ParseError::new(Place::Byte(HEADER + i * RECORD + 4 * k), what));
            }
            // Adding zero makes negative zero positive, so that equal corners have equal bits.
            numbers[k / 3][k % 3] = number + 0.0;
        }
        let [normal, corners @ ..] = numbers;
        Ok(Triangle { normal, corners })
    };
    records.iter().enumerate().map(read).collect()
}

fn parse_text(text: &str) -> Result<Vec<Solid>, ParseError> {
    let mut solids: Vec<Solid> = Vec::new();
    let mut facet: Option<([f32; 3], Vec<[f32; 3]>)> = None;
    let mut last = "";
    for (i, line) in text.lines().enumerate() {
        let place = Place::Line(i + 1);
        let mut words = line.split_ascii_whitespace();
        let Some(word) = words.next() else { continue };
        last = word;
        match (word.to_ascii_lowercase().as_str(), &mut facet) {
            ("solid", None) => {
                let name = words.collect::<Vec<_>>().join(" ");
                solids.push(Solid { name, triangles: Vec::new() });
            }
            ("endsolid", None) | ("outer" | "endloop", Some(_)) => {}
            ("facet", None) => {
                words.next();
                facet = Some((three_numbers(words, place)?, Vec::with_capacity(3)));
            }
            ("vertex", Some((_, corners))) => corners.push(three_numbers(words, place)?),
            ("endfacet", Some((normal, corners))) => {
                let &mut [a, b, c] = corners.as_mut_slice() else {
                    return Err(ParseError::new(place, format!("this facet has {} vertices, not 3", corners.len())));
                };
                let solid = solids.last_mut().expect("a text begins with its first solid");
                solid.triangles.push(Triangle { normal: *normal, corners: [a, b, c] });
                facet = None;
            }
            _ => return Err(ParseError::new(place, format!("\"{}\" does not belong here", shorten(word)))),
        }
    }
    if facet.is_some() || !last.eq_ignore_ascii_case("endsolid") {
        return Err(ParseError::new(Place::File, "ends before its \"endsolid\": it was cut off"));
    }
    Ok(solids)
}

fn three_numbers<'a>(mut words: impl Iterator<Item = &'a str>, place: Place) -> Result<[f32; 3], ParseError> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        let word = words.next().ok_or_else(|| ParseError::new(place, "three numbers are needed here"))?;
        *number = match word.parse::<f32>() {
            Ok(value) if value.is_finite() => value + 0.0,
            _ => return Err(ParseError::new(place, format!("\"{}\" is not a finite number", shorten(word)))),
        };
    }
    Ok(numbers)
}

/// The beginning of a word for a message, however long the word.
pub(super) fn shorten(word: &str) -> String {
    word.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.5, -1e-3]];

    #[test]
    fn binary_comes_back_bit_for_bit() {
        let read = parse(&encode("unit mm", &[CORNERS, CORNERS])).unwrap();
        assert_eq!(read.len(), 2, "both triangles");
        assert_eq!(read[1].corners, CORNERS, "same corners");
        assert!((widen(read[0].normal) - normal_of(&CORNERS)).length() < 1e-6, "normal of the corners");
    }

    #[test]
    fn text_reads_as_binary_does() {
        let text = "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5 0 0\n   VERTEX 0 2.5 -1e-3\n  endloop\n endfacet\nendsolid a b\n";
        assert_eq!(parse(text.as_bytes()).unwrap()[0].corners, CORNERS, "same corners");
        let cut = &text[..text.find(" endfacet").unwrap()];
        assert!(parse(cut.as_bytes()).unwrap_err().to_string().contains("cut off"), "the end is missing");
        let nan = text.replace("1.5", "nan");
        let error = parse(nan.as_bytes()).unwrap_err();
        assert_eq!(error.place, Place::Line(5), "{error}");
    }

    #[test]
    fn a_header_that_claims_four_billion_triangles_is_refused() {
        let mut bytes = encode("unit mm", &[CORNERS]);
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = parse(&bytes).unwrap_err();
        assert!(error.what.contains("4294967295 triangles"), "{error}");
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused_with_its_place() {
        let mut bytes = encode("unit mm", &[CORNERS, CORNERS]);
        bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
        assert_eq!(parse(&bytes).unwrap_err().place, Place::Byte(146), "first corner of the second triangle");
    }
}
