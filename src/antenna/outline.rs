//! The patch's outline: the rectangle of its width and length, or any simple polygon in its place.
//!
//! A polygon stands in the patch's frame: its bounding box is the patch's width by length about the origin, so that the
//! feed's place, the estimates and the width-and-length compensation, which go by these two numbers, mean the box.
//!
//! Not handled: holes, and patches of several pieces.

use super::params::{ParamError, PatchParams};
use crate::geometry::DVec2;
use crate::units::to_mm;

/// More points than this are a photograph of an outline, and each costs cells.
pub const MAX_OUTLINE_POINTS: usize = 500;
/// Greatest difference of the outline's box from width and length, relative: above rounding, below anything drawn.
const BOX: f64 = 1e-6;
/// Least distance between parts of the outline that are no neighbors, and least length of an edge, over the patch's
/// shorter side: closer ones make cells that no time step has patience for.
const APART: f64 = 2e-3;
/// Sharpest corner, degrees: cells in a sharper one are slivers.
const SHARPEST_DEG: f64 = 5.0;

/// What is wrong with an outline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutlineError {
    /// Too few or too many points.
    #[error(
        "outline has {count} points, but must have 3 to {MAX_OUTLINE_POINTS}: draw it with fewer, or import it with a \
         greater tolerance"
    )]
    Count {
        /// How many there are.
        count: usize,
    },
    /// A coordinate is no number.
    #[error("outline: point {point} is no place: its coordinates must be finite numbers")]
    NoPlace {
        /// Number of the point, from 1.
        point: usize,
    },
    /// The bounding box does not agree with width and length.
    #[error(
        "outline lies between ({:.4}, {:.4}) and ({:.4}, {:.4}) mm, but width and length say a box of {width_mm:.4} x \
         {length_mm:.4} mm about the origin: correct them or move the outline", lo[0], lo[1], hi[0], hi[1]
    )]
    OtherBox {
        /// Lower corner of the box, mm.
        lo: [f64; 2],
        /// Upper corner, mm.
        hi: [f64; 2],
        /// Width of the patch, mm.
        width_mm: f64,
        /// Length of the patch, mm.
        length_mm: f64,
    },
    /// Two edges cross or nearly touch, or an edge is too short.
    #[error(
        "outline: the edges from points {first} and {second} cross or come closer than {limit_mm:.4} mm at \
         ({:.4}, {:.4}) mm: draw them apart", at_mm[0], at_mm[1]
    )]
    Touching {
        /// Number of the first edge's first point, from 1.
        first: usize,
        /// Number of the other edge's first point.
        second: usize,
        /// Where, mm.
        at_mm: [f64; 2],
        /// Least distance, mm.
        limit_mm: f64,
    },
    /// An edge is too short.
    #[error(
        "outline: points {point} and {next} are {length_mm:.4} mm apart, but must be {limit_mm:.4} mm: leave one out"
    )]
    Short {
        /// Number of the edge's first point, from 1.
        point: usize,
        /// Number of its other point.
        next: usize,
        /// Its length, mm.
        length_mm: f64,
        /// Least length, mm.
        limit_mm: f64,
    },
    /// A corner is too sharp.
    #[error(
        "outline: the corner at point {point}, ({:.4}, {:.4}) mm, has {angle_deg:.1} degrees, but must have at least \
         {SHARPEST_DEG}: blunt it", at_mm[0], at_mm[1]
    )]
    Sharp {
        /// Number of the point, from 1.
        point: usize,
        /// Where, mm.
        at_mm: [f64; 2],
        /// Its angle, degrees.
        angle_deg: f64,
    },
}

/// The edges of a polygon, each from its first to its second corner.
pub fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    (0..polygon.len()).map(|k| (polygon[k], polygon[(k + 1) % polygon.len()]))
}

/// Twice the area within a polygon, m²; positive if it is counter-clockwise.
#[must_use]
pub fn doubled_area(polygon: &[DVec2]) -> f64 {
    edges(polygon).map(|(a, b)| a.perp_dot(b)).sum()
}

/// Whether a place is within a polygon; on its edge either way.
#[must_use]
pub fn contains(polygon: &[DVec2], p: DVec2) -> bool {
    let crosses =
        |&(a, b): &(DVec2, DVec2)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    edges(polygon).filter(crosses).count() % 2 == 1
}

/// The place of a segment nearest to a point.
#[must_use]
pub fn nearest((a, b): (DVec2, DVec2), p: DVec2) -> DVec2 {
    let along = b - a;
    a + along * ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
}

/// Where two segments are closest to each other, and how close; 0 where they cross.
fn closest(first: (DVec2, DVec2), second: (DVec2, DVec2)) -> (f64, DVec2) {
    let side = |(a, b): (DVec2, DVec2), p: DVec2| (b - a).perp_dot(p - a);
    let splits = |s: (DVec2, DVec2), t: (DVec2, DVec2)| side(s, t.0) * side(s, t.1) < 0.0;
    if splits(first, second) && splits(second, first) {
        let (from, to) = (side(first, second.0), side(first, second.1));
        return (0.0, second.0 + (second.1 - second.0) * (from / (from - to)));
    }
    let pairs = [(first, second.0), (first, second.1), (second, first.0), (second, first.1)];
    let near = pairs.map(|(segment, p)| (nearest(segment, p).distance(p), p));
    near.into_iter().fold((f64::INFINITY, DVec2::ZERO), |best, one| if one.0 < best.0 { one } else { best })
}

impl PatchParams {
    /// Corners of the patch, counter-clockwise, m.
    #[must_use]
    pub fn patch_corners(&self) -> Vec<DVec2> {
        if self.outline.is_empty() {
            let (x, y) = (self.width / 2.0, self.length / 2.0);
            return vec![DVec2::new(-x, -y), DVec2::new(x, -y), DVec2::new(x, y), DVec2::new(-x, y)];
        }
        self.outline.clone()
    }

    /// Length of the patch's outline, m.
    #[must_use]
    pub fn perimeter(&self) -> f64 {
        if self.outline.is_empty() {
            return 2.0 * (self.width + self.length);
        }
        edges(&self.outline).map(|(a, b)| a.distance(b)).sum()
    }

    /// How far inside the patch's edge a place is, m; negative outside.
    #[must_use]
    pub fn inside_patch(&self, at: DVec2) -> f64 {
        if self.outline.is_empty() {
            return (DVec2::new(self.width, self.length) / 2.0 - at.abs()).min_element();
        }
        let distance = edges(&self.outline).map(|edge| nearest(edge, at).distance(at)).fold(f64::INFINITY, f64::min);
        if contains(&self.outline, at) { distance } else { -distance }
    }

    pub(super) fn check_outline(&self) -> Result<(), ParamError> {
        if self.outline.is_empty() {
            return Ok(());
        }
        self.check_polygon()?;
        let (feed, limit) = (self.feed(), 1.1 * self.pin_radius);
        let inside = self.inside_patch(feed);
        if inside >= limit {
            return Ok(());
        }
        Err(ParamError::FeedOutside {
            x_mm: to_mm(feed.x),
            y_mm: to_mm(feed.y),
            inside_mm: to_mm(inside),
            limit_mm: to_mm(limit),
        })
    }

    fn check_polygon(&self) -> Result<(), OutlineError> {
        let points = &self.outline;
        let count = points.len();
        if !(3..=MAX_OUTLINE_POINTS).contains(&count) {
            return Err(OutlineError::Count { count });
        }
        if let Some(point) = points.iter().position(|p| !p.is_finite()) {
            return Err(OutlineError::NoPlace { point: point + 1 });
        }
        let (lo, hi) = points.iter().fold((points[0], points[0]), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let half = DVec2::new(self.width, self.length) / 2.0;
        if (hi - half).abs().max_element().max((lo + half).abs().max_element()) > BOX * half.max_element() {
            let mm = |p: DVec2| p.to_array().map(to_mm);
            let (width_mm, length_mm) = (to_mm(self.width), to_mm(self.length));
            return Err(OutlineError::OtherBox { lo: mm(lo), hi: mm(hi), width_mm, length_mm });
        }
        self.check_edges()
    }

    fn check_edges(&self) -> Result<(), OutlineError> {
        let points = &self.outline;
        let count = points.len();
        let limit = APART * self.width.min(self.length);
        let limit_mm = to_mm(limit);
        let mm = |p: DVec2| p.to_array().map(to_mm);
        let all: Vec<_> = edges(points).collect();
        for (k, &(a, b)) in all.iter().enumerate() {
            let length = a.distance(b);
            if length < limit {
                let next = (k + 1) % count + 1;
                return Err(OutlineError::Short { point: k + 1, next, length_mm: to_mm(length), limit_mm });
            }
            let before = all[(k + count - 1) % count].0;
            let angle_deg = (before - a).angle_to(b - a).abs().to_degrees();
            if angle_deg < SHARPEST_DEG {
                return Err(OutlineError::Sharp { point: k + 1, at_mm: mm(a), angle_deg });
            }
        }
        for first in 0..count {
            for second in (first + 2..count).filter(|second| (second + 1) % count != first) {
                let (distance, at) = closest(all[first], all[second]);
                if distance < limit {
                    let (first, second) = (first + 1, second + 1);
                    return Err(OutlineError::Touching { first, second, at_mm: mm(at), limit_mm });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::params::tests::paper;
    use super::*;
    use crate::units::from_mm;
    use std::f64::consts::{PI, TAU};

    /// The paper's antenna with another patch, given in mm; a polygon about the origin.
    pub(crate) fn with_outline(points_mm: &[[f64; 2]]) -> PatchParams {
        let outline: Vec<DVec2> = points_mm.iter().map(|&[x, y]| DVec2::new(from_mm(x), from_mm(y))).collect();
        let (lo, hi) = outline.iter().fold((outline[0], outline[0]), |(lo, hi), &p| (lo.min(p), hi.max(p)));
        PatchParams { width: hi.x - lo.x, length: hi.y - lo.y, outline, ..paper() }
    }

    /// A disc of 5 mm radius with the feed well inside.
    pub(crate) fn disc() -> PatchParams {
        let points: Vec<[f64; 2]> =
            (0..40).map(|k| TAU * f64::from(k) / 40.0).map(|a| [5.0 * a.cos(), 5.0 * a.sin()]).collect();
        with_outline(&points)
    }

    /// An E with two slots from above, the feed in its middle arm.
    pub(crate) fn e_shape() -> PatchParams {
        let right = [[5.4, -4.1], [5.4, 4.1], [2.6, 4.1], [2.6, -1.0], [2.0, -1.0], [2.0, 4.1]];
        let left = right.iter().rev().map(|&[x, y]| [-x, y]);
        with_outline(&right.into_iter().chain(left).collect::<Vec<_>>())
    }

    #[test]
    fn discs_and_letters_are_outlines() {
        for (name, params, area) in
            [("disc", disc(), 20.0 * 25.0 * (PI / 20.0).sin()), ("E", e_shape(), 10.8 * 8.2 - 2.0 * 0.6 * 5.1)]
        {
            assert_eq!(params.validate(), Ok(()), "{name}");
            let found = doubled_area(&params.outline) / 2.0 * 1e6;
            assert!((found / area - 1.0).abs() < 1e-9, "{name}: {found} mm2, drawn {area}");
        }
        let e = e_shape();
        let at = |x, y| to_mm(e.inside_patch(DVec2::new(from_mm(x), from_mm(y))));
        assert!((at(0.0, 3.6) - 0.5).abs() < 1e-9 && (at(1.5, 0.0) - 0.5).abs() < 1e-9, "inside");
        assert!((at(2.2, 0.0) + 0.2).abs() < 1e-9 && (at(9.4, 0.0) + 4.0).abs() < 1e-9, "in a slot, beside");
    }

    #[test]
    fn what_is_no_outline_is_refused_with_its_place() {
        let refused = |points: &[[f64; 2]]| with_outline(points).validate().expect_err("no outline").to_string();
        let square = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]];
        assert_eq!(with_outline(&square).validate(), Ok(()), "a square is one");
        let bow = refused(&[[-4.0, -4.0], [4.0, 4.0], [4.0, -4.0], [-4.0, 4.0]]);
        assert!(bow.contains("edges from points 1 and 3 cross") && bow.contains("at (0.0000, 0.0000) mm"), "{bow}");
        let doubled = refused(&[square[0], square[1], [4.0, -3.999], square[2], square[3]]);
        assert!(doubled.contains("points 2 and 3 are 0.0010 mm apart"), "{doubled}");
        let spike = refused(&[square[0], square[1], square[2], [0.3, 4.0], [0.2, 0.5], [0.1, 4.0], square[3]]);
        assert!(spike.contains("the corner at point 5"), "{spike}");
        assert!(refused(&[square[0], square[2]]).contains("outline has 2 points"), "too few");
        let many: Vec<[f64; 2]> =
            (0..501).map(|k| TAU * f64::from(k) / 501.0).map(|a| [4.0 * a.cos(), 4.0 * a.sin()]).collect();
        assert!(refused(&many).contains("outline has 501 points"), "too many");
        let mut nowhere = with_outline(&square);
        nowhere.outline[2].x = f64::NAN;
        let nowhere = nowhere.validate().expect_err("no place").to_string();
        assert!(nowhere.contains("point 3 is no place"), "{nowhere}");
        let shifted = PatchParams { width: from_mm(9.0), ..with_outline(&square) };
        assert!(
            shifted.validate().expect_err("another box").to_string().contains("a box of 9.0000 x 8.0000 mm"),
            "box"
        );
        let mut slotted = e_shape();
        (slotted.feed_offset, slotted.inset) = (from_mm(2.3), from_mm(5.0));
        let message = slotted.validate().expect_err("the feed is in a slot").to_string();
        assert!(
            message.contains("the feed at (2.3000, ") && message.contains("inside the patch's outline"),
            "{message}"
        );
    }
}
