//! Operators on a selection: move, rotate and scale about a pivot, bound to an axis or a plane, by pointer or number.
//!
//! Enters: where the pointer went in a [`View`], or numbers typed, and what the motion is bound to. Leaves: a
//! [`Change`], which displaces any place, in part where its weight is below 1 (proportional editing). All of it is
//! measured from where the operator began, so that no error adds up. Lengths are millimetres in `f64`; angles are
//! radians, right-handed about their axis.

use super::drag::{Motion, displacement};
use super::view::View;
use super::{Vec2, Vec3};
use crate::geometry::{DQuat, DVec3};

/// Least distance from pivot to pointer that a scaling is measured by, points: nearer, a twitch is a factor of ten.
const LEAST_REACH: f32 = 12.0;
/// A plane that a line of sight meets by less than this cosine is seen from its edge.
const LEAST_SLOPE: f64 = 0.05;
/// Factors are snapped to a tenth.
const FACTOR_STEP: f64 = 0.1;

/// What an operator does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Displaces.
    Move,
    /// Turns about the pivot.
    Rotate,
    /// Scales from the pivot.
    Scale,
}

/// What an operator is bound to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bound {
    /// Nothing: the screen decides.
    #[default]
    Free,
    /// The axis of this number.
    Axis(usize),
    /// The plane across the axis of this number.
    Plane(usize),
}

impl Bound {
    /// What the key of an axis binds to; the same key again frees.
    #[must_use]
    pub fn pressed(self, axis: usize, across: bool) -> Self {
        let wanted = if across { Self::Plane(axis) } else { Self::Axis(axis) };
        if self == wanted { Self::Free } else { wanted }
    }

    /// Axes along which places may change, ascending.
    #[must_use]
    pub fn axes(self) -> Vec<usize> {
        (0..3).filter(|&a| self.allows(a)).collect()
    }

    fn allows(self, axis: usize) -> bool {
        match self {
            Self::Free => true,
            Self::Axis(a) => a == axis,
            Self::Plane(a) => a != axis,
        }
    }

    fn motion(self) -> Motion {
        match self {
            Self::Free => Motion::Screen,
            Self::Axis(a) => Motion::Axis(Vec3::AXES[a]),
            Self::Plane(a) => Motion::Plane(Vec3::AXES[a]),
        }
    }
}

/// A change of places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// By a vector, mm.
    Move(DVec3),
    /// About a unit axis through the pivot.
    Rotate {
        /// The axis.
        axis: DVec3,
        /// The angle, rad.
        angle: f64,
    },
    /// By a factor along each axis, from the pivot.
    Scale(DVec3),
}

/// Steps that changes are rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// Of lengths, mm.
    pub length: f64,
    /// Of angles, rad.
    pub angle: f64,
}

impl Change {
    /// How far a place moves, mm; `weight` 1 is the whole change.
    #[must_use]
    pub fn displacement(self, pivot: DVec3, place: DVec3, weight: f64) -> DVec3 {
        let arm = place - pivot;
        match self {
            Self::Move(by) => weight * by,
            Self::Rotate { axis, angle } => DQuat::from_axis_angle(axis, weight * angle) * arm - arm,
            Self::Scale(factors) => weight * (factors - DVec3::ONE) * arm,
        }
    }

    /// The change in whole steps; a step that is not positive changes nothing.
    #[must_use]
    pub fn snapped(self, steps: Steps) -> Self {
        let snap = |value: f64, step: f64| if step > 0.0 { (value / step).round() * step } else { value };
        match self {
            Self::Move(by) => Self::Move(DVec3::from_array(by.to_array().map(|v| snap(v, steps.length)))),
            Self::Rotate { axis, angle } => Self::Rotate { axis, angle: snap(angle, steps.angle) },
            Self::Scale(factors) => Self::Scale(DVec3::from_array(factors.to_array().map(|v| snap(v, FACTOR_STEP)))),
        }
    }
}

/// Where an operator works: the view and the pivot of the selection, mm.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    /// The view.
    pub view: &'a View,
    /// The middle that rotations turn about and scalings grow from, mm.
    pub pivot: DVec3,
}

impl Stage<'_> {
    fn pivot_seen(&self) -> Option<Vec2> {
        self.view.project(self.pivot.as_vec3()).map(|p| p.at)
    }

    /// The axis that a rotation turns about: the one it is bound to, or the line of sight towards the viewer.
    fn axis(&self, bound: Bound) -> DVec3 {
        match bound {
            Bound::Free => self.view.camera.axes()[2].as_dvec3().normalize_or(DVec3::Z),
            Bound::Axis(a) | Bound::Plane(a) => DVec3::AXES[a],
        }
    }

    /// The angle about the pivot, as seen, from one place of the pointer to another; rad, counter-clockwise.
    #[must_use]
    pub fn turn(&self, from: Vec2, to: Vec2) -> f64 {
        let Some(center) = self.pivot_seen() else { return 0.0 };
        let [a, b] = [from - center, to - center];
        // y points down on the screen.
        if a.length().min(b.length()) < 1.0 { 0.0 } else { -f64::from(a.angle_to(b)) }
    }

    /// The same about an axis through the pivot, in the plane across it: what lay under the pointer stays there. As
    /// [`Self::turn`] where that plane is seen from its edge.
    #[must_use]
    pub fn turn_about(&self, axis: usize, from: Vec2, to: Vec2) -> f64 {
        let normal = DVec3::AXES[axis];
        let arm = |at: Vec2| {
            let ray = self.view.ray(at);
            let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let slope = direction.dot(normal);
            let reach = (self.pivot - origin).dot(normal) / slope;
            let is_met = slope.abs() > LEAST_SLOPE && reach >= f64::from(ray.start);
            is_met.then(|| (origin + reach * direction - self.pivot, slope))
        };
        let (Some((a, slope)), Some((b, _))) = (arm(from), arm(to)) else { return self.turn(from, to) };
        let angle = normal.dot(a.cross(b)).atan2(a.dot(b));
        // Counter-clockwise as seen, whichever way the axis points.
        if slope > 0.0 { -angle } else { angle }
    }

    /// The change that the pointer asks for; `None` where the view does not tell (see [`displacement`]).
    ///
    /// * `grabbed`: what stays under the pointer in a move, mm.
    /// * `[from, to]`: the pointer at the beginning and now, points.
    /// * `turned`: the sum of the turns of the pointer since the beginning, rad: so it may go round more than once.
    #[must_use]
    pub fn pointed(
        &self,
        operator: Operator,
        bound: Bound,
        grabbed: Vec3,
        [from, to]: [Vec2; 2],
        turned: f64,
    ) -> Option<Change> {
        match operator {
            Operator::Move => {
                displacement(self.view, grabbed, bound.motion(), from, to).map(|by| Change::Move(by.as_dvec3()))
            }
            Operator::Rotate => {
                let axis = self.axis(bound);
                let towards_viewer = -self.view.ray(self.pivot_seen()?).direction.as_dvec3();
                let sign = if axis.dot(towards_viewer) < 0.0 { -1.0 } else { 1.0 };
                Some(Change::Rotate { axis, angle: sign * turned })
            }
            Operator::Scale => {
                let center = self.pivot_seen()?;
                let reach = |p: Vec2| f64::from(p.distance(center));
                let factor = reach(to) / reach(from).max(f64::from(LEAST_REACH));
                Some(Change::Scale(factors(bound, |_| factor)))
            }
        }
    }

    /// The change that typed numbers ask for: mm, degrees or factors; `None` while there is no number.
    ///
    /// In a move the numbers go to the axes that are free, in order; `place` (mm) is where the vertex is whose target
    /// they are, if they are absolute. A single factor is that of all free axes.
    #[must_use]
    pub fn typed(
        &self,
        operator: Operator,
        bound: Bound,
        numbers: [Option<f64>; 3],
        place: Option<DVec3>,
    ) -> Option<Change> {
        let first = numbers.into_iter().flatten().next()?;
        let axes = bound.axes();
        let number_of = |axis: usize| axes.iter().position(|&a| a == axis).and_then(|k| numbers[k]);
        Some(match operator {
            Operator::Move => {
                let along = |axis: usize| number_of(axis).map_or(0.0, |number| number - place.map_or(0.0, |p| p[axis]));
                Change::Move(DVec3::from_array([0, 1, 2].map(along)))
            }
            Operator::Rotate => Change::Rotate { axis: self.axis(bound), angle: first.to_radians() },
            Operator::Scale => {
                let is_single = numbers.iter().flatten().count() == 1 && numbers[0].is_some();
                Change::Scale(factors(bound, |axis| if is_single { first } else { number_of(axis).unwrap_or(1.0) }))
            }
        })
    }

    /// How many numbers an operator takes.
    #[must_use]
    pub fn n_numbers(operator: Operator, bound: Bound) -> usize {
        if operator == Operator::Rotate { 1 } else { bound.axes().len() }
    }
}

fn factors(bound: Bound, factor: impl Fn(usize) -> f64) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| if bound.allows(axis) { factor(axis) } else { 1.0 }))
}

/// The weight of each place in a change: 1 where it is selected, falling off smoothly to 0 at `radius` (mm) from the
/// nearest selected place; without a radius, 0 everywhere else. Places of weight 0 are left out.
///
/// The falloff is `3 t² − 2 t³` with `t = 1 − distance / radius`.
#[must_use]
pub fn weights(places: &[DVec3], is_selected: impl Fn(usize) -> bool, radius: Option<f64>) -> Vec<(usize, f64)> {
    let selected: Vec<DVec3> = places.iter().enumerate().filter(|(i, _)| is_selected(*i)).map(|(_, p)| *p).collect();
    let weight = |i: usize| {
        if is_selected(i) {
            return 1.0;
        }
        let Some(radius) = radius.filter(|r| *r > 0.0) else { return 0.0 };
        let nearest = selected.iter().map(|p| p.distance_squared(places[i])).fold(f64::INFINITY, f64::min).sqrt();
        let t = (1.0 - nearest / radius).max(0.0);
        t * t * (3.0 - 2.0 * t)
    };
    (0..places.len()).map(|i| (i, weight(i))).filter(|(_, w)| *w > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Camera, Projection, StandardView};
    use std::f64::consts::{FRAC_PI_2, PI};

    const PIVOT: DVec3 = DVec3::new(1.0, -2.0, 3.0);

    fn view(from: StandardView) -> View {
        let mut camera = Camera { distance: 120.0, projection: Projection::Orthographic, ..Camera::default() };
        camera.look_from(from);
        View::new(camera, 900.0, 700.0)
    }

    fn moved(change: Change, place: DVec3) -> DVec3 {
        place + change.displacement(PIVOT, place, 1.0)
    }

    #[test]
    fn rotations_keep_distances_and_scalings_keep_the_pivot() {
        let place = DVec3::new(7.0, 1.0, -4.0);
        for (axis, angle) in [(DVec3::X, 0.7), (DVec3::Y, -3.0), (DVec3::Z, 12.0)] {
            let to = moved(Change::Rotate { axis, angle }, place);
            assert!((to.distance(PIVOT) - place.distance(PIVOT)).abs() < 1e-12, "about {axis}");
            assert!((to - place).dot(axis).abs() < 1e-12, "in the plane across {axis}");
        }
        let quarter = moved(Change::Rotate { axis: DVec3::Z, angle: FRAC_PI_2 }, PIVOT + DVec3::X);
        assert!(quarter.distance(PIVOT + DVec3::Y) < 1e-12, "right-handed: x goes to y");
        let scaled = Change::Scale(DVec3::new(2.0, 1.0, 0.5));
        assert_eq!(moved(scaled, PIVOT), PIVOT, "the pivot stays");
        assert!(moved(scaled, PIVOT + DVec3::ONE).distance(PIVOT + DVec3::new(2.0, 1.0, 0.5)) < 1e-12, "by axis");
    }

    #[test]
    fn a_weight_takes_part_of_a_change() {
        let place = PIVOT + DVec3::X;
        let half = |change: Change| change.displacement(PIVOT, place, 0.5);
        assert_eq!(half(Change::Move(2.0 * DVec3::Z)), DVec3::Z, "half the way");
        let turned = half(Change::Rotate { axis: DVec3::Z, angle: PI });
        assert!(turned.distance(DVec3::Y - DVec3::X) < 1e-12, "half the angle");
        assert_eq!(half(Change::Scale(DVec3::splat(3.0))), DVec3::X, "half the growth");
    }

    #[test]
    fn the_pointer_turns_what_it_circles() {
        let (top, bottom) = (view(StandardView::Top), view(StandardView::Bottom));
        for (view, sign) in [(&top, 1.0), (&bottom, -1.0)] {
            let stage = Stage { view, pivot: PIVOT };
            let center = stage.pivot_seen().expect("in view");
            let [right, above] = [center + Vec2::new(80.0, 0.0), center + Vec2::new(0.0, -50.0)];
            let turned = stage.turn(right, above);
            assert!((turned - FRAC_PI_2).abs() < 1e-4, "counter-clockwise as seen: {turned}");
            let change = stage.pointed(Operator::Rotate, Bound::Axis(2), Vec3::ZERO, [right, above], turned);
            let Some(Change::Rotate { axis: DVec3::Z, angle }) = change else { panic!("{change:?}") };
            assert!((angle - sign * FRAC_PI_2).abs() < 1e-4, "about z it is seen the other way from below: {angle}");
        }
    }

    #[test]
    fn going_away_from_the_pivot_scales_the_axes_that_are_free() {
        let view = view(StandardView::Top);
        let stage = Stage { view: &view, pivot: PIVOT };
        let center = stage.pivot_seen().expect("in view");
        let way = [center + Vec2::new(50.0, 0.0), center + Vec2::new(0.0, 100.0)];
        for (bound, wanted) in [
            (Bound::Free, DVec3::splat(2.0)),
            (Bound::Axis(0), DVec3::new(2.0, 1.0, 1.0)),
            (Bound::Plane(2), DVec3::new(2.0, 2.0, 1.0)),
        ] {
            let change = stage.pointed(Operator::Scale, bound, Vec3::ZERO, way, 0.0);
            let Some(Change::Scale(found)) = change else { panic!("{change:?}") };
            assert!(found.distance(wanted) < 1e-4, "{bound:?}: {found}");
        }
    }

    #[test]
    fn typed_numbers_go_to_the_axes_that_are_free() {
        let view = view(StandardView::Isometric);
        let stage = Stage { view: &view, pivot: PIVOT };
        let go = |operator, bound, numbers, place| stage.typed(operator, bound, numbers, place);
        let two = [Some(1.5), Some(-2.0), None];
        let by = |x, y, z| Some(Change::Move(DVec3::new(x, y, z)));
        assert_eq!(go(Operator::Move, Bound::Free, two, None), by(1.5, -2.0, 0.0), "x, y");
        assert_eq!(go(Operator::Move, Bound::Axis(2), two, None), by(0.0, 0.0, 1.5), "the axis alone");
        assert_eq!(go(Operator::Move, Bound::Plane(1), two, None), by(1.5, 0.0, -2.0), "x and z");
        let place = Some(DVec3::new(1.0, 1.0, 1.0));
        assert_eq!(go(Operator::Move, Bound::Axis(0), two, place), by(0.5, 0.0, 0.0), "to x = 1.5");
        assert_eq!(go(Operator::Move, Bound::Free, [None; 3], None), None, "no number yet");
        let turn = go(Operator::Rotate, Bound::Axis(1), [Some(90.0), None, None], None);
        assert_eq!(turn, Some(Change::Rotate { axis: DVec3::Y, angle: FRAC_PI_2 }), "degrees");
        let one = [Some(3.0), None, None];
        let scaled = |x, y, z| Some(Change::Scale(DVec3::new(x, y, z)));
        assert_eq!(go(Operator::Scale, Bound::Free, one, None), scaled(3.0, 3.0, 3.0), "one factor for all");
        assert_eq!(go(Operator::Scale, Bound::Plane(2), one, None), scaled(3.0, 3.0, 1.0), "in the plane");
        assert_eq!(go(Operator::Scale, Bound::Free, two, None), scaled(1.5, -2.0, 1.0), "or one each");
    }

    #[test]
    fn snapping_gives_whole_steps() {
        let steps = Steps { length: 0.5, angle: 5.0_f64.to_radians() };
        let go = |change: Change| change.snapped(steps);
        assert_eq!(go(Change::Move(DVec3::new(0.6, -0.3, 0.1))), Change::Move(DVec3::new(0.5, -0.5, 0.0)), "lengths");
        let Change::Rotate { angle, .. } = go(Change::Rotate { axis: DVec3::X, angle: 0.2 }) else { panic!("a turn") };
        assert!((angle.to_degrees() - 10.0).abs() < 1e-12, "{} degrees", angle.to_degrees());
        let Change::Scale(factors) = go(Change::Scale(DVec3::splat(1.26))) else { panic!("a scaling") };
        assert!(factors.distance(DVec3::splat(1.3)) < 1e-12, "{factors}");
        let none = Steps { length: 0.0, angle: 0.0 };
        let as_it_was = Change::Move(DVec3::ONE / 3.0);
        assert_eq!(as_it_was.snapped(none), as_it_was, "no step");
    }

    #[test]
    fn what_lies_under_the_pointer_turns_with_it() {
        for camera in [StandardView::Isometric, StandardView::Bottom] {
            let view = view(camera);
            let stage = Stage { view: &view, pivot: PIVOT };
            let seen = |place: DVec3| view.project(place.as_vec3()).expect("in view").at;
            let arm = PIVOT + DVec3::new(6.0, 2.0, 0.0);
            let to = seen(moved(Change::Rotate { axis: DVec3::Z, angle: 0.6 }, arm));
            let turned = stage.turn_about(2, seen(arm), to);
            let change = stage.pointed(Operator::Rotate, Bound::Axis(2), Vec3::ZERO, [seen(arm), to], turned);
            let Some(Change::Rotate { angle, .. }) = change else { panic!("a turn") };
            assert!((angle - 0.6).abs() < 1e-4, "{camera:?}: {angle}");
        }
    }

    #[test]
    fn the_same_key_twice_frees_and_another_binds_anew() {
        let x = Bound::Free.pressed(0, false);
        assert_eq!((x, x.pressed(0, false)), (Bound::Axis(0), Bound::Free), "on and off");
        assert_eq!(x.pressed(0, true), Bound::Plane(0), "with Shift the plane");
        assert_eq!((x.axes(), Bound::Plane(0).axes()), (vec![0], vec![1, 2]), "what stays free");
    }

    #[test]
    fn weights_are_one_on_the_selection_and_fall_to_zero_at_the_radius() {
        let places: Vec<DVec3> = (0..12).map(|i| f64::from(i) * DVec3::X).collect();
        let found = weights(&places, |i| i == 2, Some(4.0));
        let numbers: Vec<usize> = found.iter().map(|(i, _)| *i).collect();
        assert_eq!(numbers, [0, 1, 2, 3, 4, 5], "nearer than the radius");
        let weight = |i: usize| found.iter().find(|(k, _)| *k == i).expect("listed").1;
        assert_eq!((weight(2), weight(4)), (1.0, 0.5), "whole, and half at half the radius");
        assert!(weight(3) > weight(4) && weight(4) > weight(5), "falling");
        assert_eq!(weights(&places, |i| i == 2, None), [(2, 1.0)], "without a radius the selection alone");
    }
}
