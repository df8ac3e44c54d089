//! What takes power from the antenna besides its dielectrics: lossy sheets, and resistors through the substrate.
//!
//! A resistor stands upright between ground and patch, at a place of the flat antenna: a loading resistor, or a
//! shorting post where it is small. It is as thin as the mesh makes a line, so its own inductance is that of a wire about
//! a quarter of an edge thick.

use super::params::{ParamError, PatchParams};
use crate::geometry::DVec2;
use crate::units::to_mm;

/// What a sheet of metal is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Conductor {
    /// Without loss.
    #[default]
    Perfect,
    /// A lossy sheet: ohm per square of the whole sheet, both of its sides together.
    Sheet(f64),
}

/// A resistor between ground and patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistor {
    /// Its place in the flat antenna, m.
    pub at: DVec2,
    /// Ohm.
    pub resistance: f64,
}

/// More resistors than this are no design but a broken file.
pub const MAX_RESISTORS: usize = 64;
/// Range of a surface resistance, ohm per square: from far below thick copper to a sheet that hardly conducts.
const SHEET_OHM: (f64, f64) = (1e-6, 1e6);
/// Range of a resistor, ohm: less is a short already, more is none.
const RESISTOR_OHM: (f64, f64) = (1e-3, 1e7);
/// Least distance of a resistor from whatever else the mesh must follow, over the patch's shorter side: nearer ones make
/// cells so small that the time step suffers.
const CLEARANCE: f64 = 0.02;
/// Places along each side of the patch where room is looked for.
const PLACES: usize = 21;

impl PatchParams {
    /// Distance that a resistor keeps from the patch's edge, the outer conductor and the other resistors, m.
    #[must_use]
    pub fn clearance(&self) -> f64 {
        CLEARANCE * self.width.min(self.length)
    }

    /// The place under the patch with most room for one more resistor; `None` if there is none that keeps clear.
    #[must_use]
    pub fn roomiest_place(&self) -> Option<DVec2> {
        let half = DVec2::new(self.width, self.length) / 2.0;
        let room = |at: DVec2| {
            let to_feed = at.distance(self.feed()) - self.coax_radius;
            let to_others = self.resistors.iter().map(|r| r.at.distance(at));
            to_others.fold(to_feed.min(self.inside_patch(at)), f64::min)
        };
        let part = |k: usize| 2.0 * k as f64 / (PLACES - 1) as f64 - 1.0;
        let places = (0..PLACES * PLACES).map(|k| half * DVec2::new(part(k % PLACES), part(k / PLACES)));
        let (most, place) = places.map(|at| (room(at), at)).max_by(|a, b| a.0.total_cmp(&b.0))?;
        // A little more than the least, so that rounding the place does not matter.
        (most > 1.1 * self.clearance() && self.resistors.len() < MAX_RESISTORS).then_some(place)
    }

    pub(super) fn check_loads(&self) -> Result<(), ParamError> {
        for (field, metal) in [("patch_metal", self.patch_metal), ("ground_metal", self.ground_metal)] {
            let (lo, hi) = SHEET_OHM;
            match metal {
                Conductor::Sheet(value) if !(lo..=hi).contains(&value) => {
                    return Err(ParamError::OutOfRange { field, value, lo, hi });
                }
                _ => {}
            }
        }
        let count = self.resistors.len();
        if count > MAX_RESISTORS {
            return Err(ParamError::TooManyResistors { count });
        }
        (0..count).try_for_each(|index| self.check_resistor(index))
    }

    fn check_resistor(&self, index: usize) -> Result<(), ParamError> {
        let Resistor { at, resistance } = self.resistors[index];
        let (lo, hi) = RESISTOR_OHM;
        if !(lo..=hi).contains(&resistance) {
            return Err(ParamError::Resistance { index, value: resistance, lo, hi });
        }
        // Not the other way round: NaN is far from nothing.
        let far = |what: String, distance: f64, limit: f64| {
            let (x_mm, y_mm) = (to_mm(at.x), to_mm(at.y));
            let (distance_mm, limit_mm) = (to_mm(distance), to_mm(limit));
            if distance >= limit {
                Ok(())
            } else {
                Err(ParamError::Misplaced { index, x_mm, y_mm, what, distance_mm, limit_mm })
            }
        };
        let limit = self.clearance();
        far("inside the patch's edge".to_owned(), self.inside_patch(at), limit)?;
        let to_feed = at.distance(self.feed());
        far("from the feed, whose outer conductor opens the ground".to_owned(), to_feed, self.coax_radius + limit)?;
        let mut others = self.resistors[..index].iter().enumerate();
        others.try_for_each(|(k, other)| far(format!("from resistor {}", k + 1), at.distance(other.at), limit))
    }
}

#[cfg(test)]
mod tests {
    use super::super::params::tests::paper;
    use super::*;
    use crate::units::from_mm;

    fn with(resistors: &[(f64, f64, f64)]) -> PatchParams {
        let resistor =
            |&(x, y, ohm): &(f64, f64, f64)| Resistor { at: DVec2::new(x, y) * from_mm(1.0), resistance: ohm };
        PatchParams { resistors: resistors.iter().map(resistor).collect(), ..paper() }
    }

    #[test]
    fn resistors_stand_under_the_patch_clear_of_feed_and_each_other() {
        assert_eq!(with(&[(0.0, 2.0, 50.0), (-4.0, 3.0, 1e-3)]).validate(), Ok(()), "two in their places");
        let refused = |resistors: &[(f64, f64, f64)]| with(resistors).validate().expect_err("misplaced").to_string();
        assert_eq!(
            refused(&[(5.4, 0.0, 50.0)]),
            "resistors[0] (resistor 1) at (5.4000, 0.0000) mm is 0.0150 mm inside the patch's edge, but must be at least \
             0.1635 mm: move it"
        );
        let faults = [
            (
                vec![(0.0, 2.0, 50.0), (9.0, 0.0, 50.0)],
                "resistors[1] (resistor 2) at (9.0000, 0.0000) mm is -3.5850 mm inside",
            ),
            (vec![(0.0, -0.2, 50.0)], "2.1385 mm from the feed, whose outer conductor opens the ground"),
            (vec![(0.0, 2.0, 50.0), (0.1, 2.0, 50.0)], "is 0.1000 mm from resistor 1, but must be at least 0.1635 mm"),
            (vec![(f64::NAN, 2.0, 50.0)], "resistors[0]"),
            (vec![(0.0, 2.0, 0.0)], "resistors[0] (resistor 1) has 0 ohm, but must have between 0.001 and 10000000"),
        ];
        for (resistors, expected) in faults {
            let message = refused(&resistors);
            assert!(message.contains(expected), "{expected}: {message}");
        }
        assert!(refused(&[(0.0, 2.0, 1.0); 65]).contains("65 resistors"), "too many");
    }

    #[test]
    fn there_is_room_for_some_resistors_and_each_is_put_where_it_may_stand() {
        let mut params = paper();
        while let Some(at) = params.roomiest_place() {
            params.resistors.push(Resistor { at, resistance: 50.0 });
            assert_eq!(params.validate(), Ok(()), "{at}");
        }
        assert!(params.resistors.len() > 40, "{} found room", params.resistors.len());
    }

    #[test]
    fn a_sheet_has_a_resistance_that_makes_sense() {
        let fabric = PatchParams { patch_metal: Conductor::Sheet(0.05), ..paper() };
        assert_eq!(fabric.validate(), Ok(()), "conductive fabric");
        for (ohm, field) in [(0.0, "patch_metal"), (f64::NAN, "patch_metal"), (-1.0, "patch_metal")] {
            let params = PatchParams { patch_metal: Conductor::Sheet(ohm), ..paper() };
            let message = params.validate().expect_err("no such sheet").to_string();
            assert!(message.starts_with(field), "{message}");
        }
    }
}
