//! A patch of any outline: put in place of the rectangle, stretched with width and length.

use super::AntennaSpec;
use crate::antenna::outline::doubled_area;
use crate::geometry::DVec2;
use crate::units::{from_mm, to_mm};

/// Least distance of a feed that is put somewhere from the patch's edge, in pin radii.
const FEED_ROOM: f64 = 2.0;
/// Places along each side of the patch's box where the feed may be put.
const PLACES: usize = 41;
/// Substrate and ground reach past a patch that does not fit them by this many substrate heights.
const MARGIN_HEIGHTS: f64 = 3.0;

impl AntennaSpec {
    /// The outline in metres, counter-clockwise.
    pub(super) fn outline(&self) -> Vec<DVec2> {
        let mut points: Vec<DVec2> = self.outline_mm.iter().map(|&[x, y]| DVec2::new(from_mm(x), from_mm(y))).collect();
        if doubled_area(&points) < 0.0 {
            points.reverse();
        }
        points
    }

    /// The antenna with a patch of another outline, about the origin, m.
    ///
    /// Width and length become those of its box, and the ground grows where it is too small. The feed stays where it is if
    /// that is under the patch; else it goes to the lowest place of the center line that has room, or to any.
    #[must_use]
    pub fn with_outline(&self, outline: &[DVec2]) -> Self {
        // To the nanometre: numbers that can be read.
        let mm = |value: f64| (to_mm(value) * 1e6).round() / 1e6 + 0.0;
        let outline_mm: Vec<[f64; 2]> = outline.iter().map(|p| [mm(p.x), mm(p.y)]).collect();
        let extent = |axis: usize| {
            let along = outline_mm.iter().map(|p| p[axis]);
            let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), c| (lo.min(c), hi.max(c)));
            hi - lo
        };
        let (width_mm, length_mm) = (extent(0), extent(1));
        let margin = 2.0 * MARGIN_HEIGHTS * self.height_mm;
        let grown = |ground: f64, patch: f64| if patch < ground { ground } else { (patch + margin).ceil() };
        let mut new = Self {
            width_mm,
            length_mm,
            outline_mm,
            ground_width_mm: grown(self.ground_width_mm, width_mm),
            ground_length_mm: grown(self.ground_length_mm, length_mm),
            ..self.clone()
        };
        new.put_feed_inside();
        new
    }

    /// The antenna with its outline stretched as its width and length differ from those of another.
    #[must_use]
    pub fn stretched_from(mut self, before: &Self) -> Self {
        let factors = [self.width_mm / before.width_mm, self.length_mm / before.length_mm];
        for point in &mut self.outline_mm {
            for (c, factor) in point.iter_mut().zip(factors) {
                *c *= factor;
            }
        }
        self
    }

    fn put_feed_inside(&mut self) {
        let params = self.to_params();
        if params.inside_patch(params.feed()) >= FEED_ROOM * params.pin_radius {
            return;
        }
        let half = DVec2::new(params.width, params.length) / 2.0;
        let part = |k: usize| 2.0 * k as f64 / (PLACES - 1) as f64 - 1.0;
        let fits = |p: &DVec2| params.inside_patch(*p) >= FEED_ROOM * params.pin_radius;
        let on_line = (0..PLACES).map(|k| DVec2::new(0.0, half.y * part(k)));
        let anywhere = (0..PLACES * PLACES).map(|k| half * DVec2::new(part(k % PLACES), part(k / PLACES)));
        if let Some(at) = on_line.chain(anywhere).find(fits) {
            let mm = |value: f64| (to_mm(value) * 1e3).round() / 1e3 + 0.0;
            (self.feed_offset_mm, self.inset_mm) = (mm(at.x), mm(at.y + half.y));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Edit, Project};
    use super::*;
    use std::f64::consts::TAU;

    fn ring(radius_mm: f64) -> Vec<DVec2> {
        (0..36).map(|k| from_mm(radius_mm) * DVec2::from_angle(TAU * f64::from(k) / 36.0)).collect()
    }

    #[test]
    fn an_outline_brings_its_size_its_ground_and_a_place_for_the_feed() {
        let mut project = Project::default();
        let disc = project.antenna.with_outline(&ring(15.0));
        assert!((disc.width_mm - 30.0).abs() < 1e-6 && disc.ground_width_mm > 30.0, "{disc:?}");
        Edit::SetAntenna(disc.clone()).apply(&mut project).expect("valid as it comes");
        let mut wide = disc.clone();
        wide.width_mm *= 1.2;
        Edit::SetAntenna(wide.clone()).apply(&mut project.clone()).expect_err("the outline says otherwise");
        Edit::SetAntenna(wide.stretched_from(&disc)).apply(&mut project).expect("stretched");
        // A frame open to the left: its middle is no place for a feed.
        let u =
            [[-8.0, -8.0], [8.0, -8.0], [8.0, 8.0], [-8.0, 8.0], [-8.0, 5.0], [5.0, 5.0], [5.0, -5.0], [-8.0, -5.0]];
        let u: Vec<DVec2> = u.iter().map(|&[x, y]| DVec2::new(from_mm(x), from_mm(y))).collect();
        let frame = AntennaSpec { inset_mm: 8.0, ..AntennaSpec::default() }.with_outline(&u);
        assert!(frame.inset_mm < 2.0 && frame.feed_offset_mm.abs() < 1e-9, "on the center line, below: {frame:?}");
        let clockwise = AntennaSpec { outline_mm: frame.outline_mm.iter().rev().copied().collect(), ..frame.clone() };
        assert_eq!(clockwise.to_params(), frame.to_params(), "either way round");
    }
}
