//! A flat outline from a drawing: DXF or SVG to one closed polygon.
//!
//! Enters: a file, its unit where it does not say one, and how far chords may leave curves. Leaves: the corners of the
//! only closed outline in it, counter-clockwise, m, with its bounding box about the origin, y up.
//!
//! Not handled: drawings of several outlines, splines and blocks of DXF, style sheets and clipping of SVG; each is said.

mod dxf;
mod svg;

use super::IoError;
use crate::geometry::DVec2;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// A drawing larger than this is none of a patch.
const MAX_BYTES: u64 = 64 << 20;
/// Ends of lines and arcs are joined within this distance, over the size of the drawing.
const JOIN: f64 = 1e-5;

/// More lines than this are no outline of a patch, and joining them takes long.
const MOST_LINES: usize = 10_000;

/// Units that a drawing may be in, and their length, m.
pub const LENGTH_UNITS: [(&str, f64); 6] =
    [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("um", 1e-6), ("in", 0.0254), ("mil", 25.4e-6)];

/// Why a drawing gives no outline.
#[derive(Debug, thiserror::Error)]
pub enum OutlineFileError {
    /// The system refuses; names the file.
    #[error(transparent)]
    System(#[from] IoError),
    /// Neither DXF nor SVG by its name.
    #[error("{} is neither .dxf nor .svg: export the outline as one of these", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
    },
    /// The file is larger than any drawing of a patch.
    #[error("{} is larger than {} MiB: it is no drawing of an outline", path.display(), MAX_BYTES >> 20)]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// The text is not of its format.
    #[error("{}: {what}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        what: String,
    },
    /// The drawing does not say its unit.
    #[error("{} does not say its unit: give it", path.display())]
    NoUnit {
        /// The file.
        path: PathBuf,
    },
    /// There is not exactly one closed outline.
    #[error("{} holds {}", path.display(), describe(sizes_mm, *n_open))]
    NotOne {
        /// The file.
        path: PathBuf,
        /// Extents of the closed outlines, mm.
        sizes_mm: Vec<[f64; 2]>,
        /// How many lines are not closed.
        n_open: usize,
    },
}

fn describe(sizes_mm: &[[f64; 2]], n_open: usize) -> String {
    if sizes_mm.is_empty() {
        let open = if n_open > 0 { format!(", but {n_open} open lines: close the patch's") } else { String::new() };
        return format!("no closed outline{open}");
    }
    let sizes: Vec<String> = sizes_mm.iter().take(6).map(|[x, y]| format!("{x:.3} x {y:.3}")).collect();
    format!("{} closed outlines, of {} mm: leave the patch's alone in the file", sizes_mm.len(), sizes.join(", "))
}

/// Lines of a drawing in its own unit, y up, and how long that unit is where the drawing says so.
#[derive(Debug, Default)]
struct Drawing {
    closed: Vec<Vec<DVec2>>,
    open: Vec<Vec<DVec2>>,
    /// Metres.
    unit: Option<f64>,
}

/// Reads the outline of a drawing.
///
/// * `unit`: length of the drawing's unit, m; `None` to take the drawing's own.
/// * `tolerance`: greatest distance of a chord from its curve, m.
///
/// # Errors
/// [`OutlineFileError`]; never a panic, whatever the file.
pub fn read(path: &Path, unit: Option<f64>, tolerance: f64) -> Result<Vec<DVec2>, OutlineFileError> {
    let system = |source| IoError::System { action: "read", path: path.to_owned(), source };
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let parse = match ending.as_deref() {
        Some("dxf") => dxf::parse,
        Some("svg") => svg::parse,
        _ => return Err(OutlineFileError::Kind { path: path.to_owned() }),
    };
    if std::fs::metadata(path).map_err(system)?.len() > MAX_BYTES {
        return Err(OutlineFileError::TooLarge { path: path.to_owned() });
    }
    // Older drawings have texts in other encodings; their numbers are plain.
    let text = String::from_utf8_lossy(&std::fs::read(path).map_err(system)?).into_owned();
    let broken = |what| OutlineFileError::Broken { path: path.to_owned(), what };
    // How fine curves must be depends on the unit, which the drawing may say itself.
    let own = parse(&text, f64::INFINITY).map_err(broken)?.unit;
    let unit = unit.or(own).ok_or_else(|| OutlineFileError::NoUnit { path: path.to_owned() })?;
    let mut drawing = parse(&text, tolerance / unit).map_err(broken)?;
    if drawing.open.len() > MOST_LINES {
        return Err(broken(format!("it has more than {MOST_LINES} open lines: join them to a closed one")));
    }
    drawing.join();
    let mut outlines: Vec<Vec<DVec2>> = drawing.closed.into_iter().map(|o| tidy(&o, unit)).collect();
    outlines.retain(|o| o.len() >= 3);
    if let [_] = outlines[..] {
        return Ok(outlines.remove(0));
    }
    let size = |o: &Vec<DVec2>| {
        let (lo, hi) = bounds(o);
        ((hi - lo) * 1e3).to_array()
    };
    let sizes_mm = outlines.iter().map(size).collect();
    Err(OutlineFileError::NotOne { path: path.to_owned(), sizes_mm, n_open: drawing.open.len() })
}

fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    points.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)))
}

impl Drawing {
    /// Adds a line, closed if its ends meet.
    fn add(&mut self, line: Vec<DVec2>, is_closed: bool) {
        if line.len() > 1 {
            if is_closed { self.closed.push(line) } else { self.open.push(line) }
        }
    }

    /// Joins open lines whose ends meet to closed ones.
    fn join(&mut self) {
        let (lo, hi) = bounds(&self.open.concat());
        let reach = JOIN * (hi - lo).max_element();
        let meet = |a: DVec2, b: DVec2| a.distance(b) <= reach;
        let mut rest = std::mem::take(&mut self.open);
        while let Some(mut line) = rest.pop() {
            loop {
                let (first, last) = (line[0], line[line.len() - 1]);
                if line.len() > 2 && meet(first, last) {
                    self.closed.push(line);
                    break;
                }
                let next = rest.iter().position(|l| meet(l[0], last) || meet(l[l.len() - 1], last));
                let Some(next) = next else {
                    self.open.push(line);
                    break;
                };
                let mut piece = rest.swap_remove(next);
                if !meet(piece[0], last) {
                    piece.reverse();
                }
                line.extend(&piece[1..]);
            }
        }
    }
}

/// In metres about the origin, counter-clockwise, without repeated points and without points on straight lines.
fn tidy(line: &[DVec2], unit: f64) -> Vec<DVec2> {
    let (lo, hi) = bounds(line);
    let (center, reach) = ((lo + hi) / 2.0, JOIN * (hi - lo).max_element());
    let mut points: Vec<DVec2> = Vec::new();
    for &p in line {
        if points.last().is_none_or(|q| q.distance(p) > reach) {
            points.push(p);
        }
    }
    while points.len() > 1 && points[0].distance(points[points.len() - 1]) <= reach {
        points.pop();
    }
    let n = points.len();
    let is_corner = |k: usize| {
        let (a, p, b) = (points[(k + n - 1) % n], points[k], points[(k + 1) % n]);
        let along = b - a;
        let straight = (p - a).dot(b - p) > 0.0 && along.perp_dot(p - a).abs() <= 0.1 * reach * along.length();
        !straight
    };
    let mut corners: Vec<DVec2> = (0..n).filter(|&k| is_corner(k)).map(|k| (points[k] - center) * unit).collect();
    let area: f64 = (0..corners.len()).map(|k| corners[k].perp_dot(corners[(k + 1) % corners.len()])).sum();
    if area < 0.0 {
        corners.reverse();
    }
    corners
}

/// Places on an arc from its start to its end, both included: chords leave it by at most the tolerance.
///
/// * `sweep`: angle from start to end, radians; positive counter-clockwise.
fn arc(center: DVec2, radius: f64, start: f64, sweep: f64, tolerance: f64) -> Vec<DVec2> {
    let step = 2.0 * (1.0 - (tolerance / radius).clamp(1e-9, 0.5)).acos();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousand at most")]
    let n = (sweep.abs() / step).ceil().clamp(1.0, 1e5) as usize;
    // A full circle in fours, so that its box is the circle's.
    let n = if (sweep.abs() - TAU).abs() < 1e-9 { n.next_multiple_of(4) } else { n };
    let at = |k: usize| center + radius * DVec2::from_angle(start + sweep * k as f64 / n as f64);
    (0..=n).map(at).collect()
}

#[cfg(test)]
mod tests;
