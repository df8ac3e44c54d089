//! From a drag on the screen to a displacement in the world.
//!
//! Both ends of the drag become rays; each ray is turned into a place on what the motion is bound to (the plane that
//! faces the camera, an axis, a plane), and the displacement is the difference of the two places. So the grabbed point
//! stays under the pointer, and no error adds up over a drag: always measure from where the button went down.
//!
//! Where the picture does not say how far the pointer went (a plane seen edge-on, a ray beyond the horizon) the answer
//! is `None`: keep the last displacement. An axis that points at the viewer moves slowly instead of running away.

use super::camera::Ray;
use super::view::View;
use super::{Vec2, Vec3};

/// Sine of the least angle between line of sight and axis that is taken at face value. Smaller makes arrows that
/// point at the viewer jump by metres; larger lets the handle lag behind the pointer in ordinary views.
const LEAST_SINE: f32 = 0.15;
/// Sine of the least angle between line of sight and a plane. Below it one point is more than twenty in the world.
const LEAST_SLOPE: f32 = 0.05;

/// What a drag is bound to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// The plane through the grabbed point that faces the camera.
    Screen,
    /// The line through the grabbed point along a direction of any length but zero.
    Axis(Vec3),
    /// The plane through the grabbed point with a normal of any length but zero.
    Plane(Vec3),
}

/// How far `grabbed` (mm) moves when the pointer goes from `from` to `to` (points); mm.
///
/// `None` where the view does not tell: the direction is zero, a plane is seen edge-on, or the place is beyond the
/// horizon.
#[must_use]
pub fn displacement(view: &View, grabbed: Vec3, motion: Motion, from: Vec2, to: Vec2) -> Option<Vec3> {
    let rays = [from, to].map(|p| view.ray(p));
    let [start, end] = match motion {
        Motion::Screen => rays.map(|ray| on_plane(&ray, grabbed, view.camera.axes()[2])),
        Motion::Axis(axis) => rays.map(|ray| on_axis(&ray, grabbed, axis.try_normalize()?)),
        Motion::Plane(normal) => rays.map(|ray| on_plane(&ray, grabbed, normal.try_normalize()?)),
    };
    Some(end? - start?)
}

/// Where `ray` meets the plane through `point` with the unit vector `normal`.
fn on_plane(ray: &Ray, point: Vec3, normal: Vec3) -> Option<Vec3> {
    let slope = ray.direction.dot(normal);
    let distance = (point - ray.origin).dot(normal) / slope;
    (slope.abs() >= LEAST_SLOPE && distance >= ray.start).then(|| ray.at(distance))
}

/// The point of the line through `point` along the unit vector `axis` that is closest to `ray`.
fn on_axis(ray: &Ray, point: Vec3, axis: Vec3) -> Option<Vec3> {
    let between = point - ray.origin;
    let cosine = ray.direction.dot(axis);
    let along_ray = between.dot(ray.direction);
    // Closest approach of two lines; the denominator is the squared sine of their angle.
    let numerator = cosine * along_ray - between.dot(axis);
    let place = numerator / (1.0 - cosine * cosine).max(LEAST_SINE * LEAST_SINE);
    let seen = along_ray + place * cosine >= ray.start;
    seen.then(|| point + place * axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Camera, Projection, StandardView};

    fn views() -> Vec<View> {
        let mut rng = fastrand::Rng::with_seed(6);
        let mut views = Vec::new();
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for _ in 0..40 {
                let (yaw, pitch) = (6.0 * rng.f32(), 0.2 + 1.0 * rng.f32());
                let camera = Camera { yaw, pitch, distance: 150.0, projection, ..Camera::default() };
                views.push(View::new(camera, 1000.0, 700.0));
            }
        }
        views
    }

    const GRABBED: Vec3 = Vec3::new(4.0, -7.0, 3.0);

    fn at(view: &View, point: Vec3) -> Vec2 {
        view.project(point).expect("in front of the eye").at
    }

    #[test]
    fn the_grabbed_point_stays_under_the_pointer_on_the_screen_plane() {
        for view in views() {
            let from = at(&view, GRABBED);
            let to = from + Vec2::new(60.0, -35.0);
            let moved = displacement(&view, GRABBED, Motion::Screen, from, to).expect("the plane faces the viewer");
            assert!(at(&view, GRABBED + moved).distance(to) < 0.05, "{moved} in {view:?}");
            assert!(moved.dot(view.camera.axes()[2]).abs() < 1e-3, "it stays at its depth");
        }
    }

    #[test]
    fn a_drag_along_a_projected_axis_moves_by_that_much() {
        for view in views() {
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                let line_of_sight = view.ray(at(&view, GRABBED)).direction;
                if line_of_sight.cross(axis).length() < 0.3 {
                    continue;
                }
                let wanted = GRABBED + 6.0 * axis;
                let (from, to) = (at(&view, GRABBED), at(&view, wanted));
                let moved = displacement(&view, GRABBED, Motion::Axis(2.0 * axis), from, to).expect("well visible");
                assert!(moved.distance(6.0 * axis) < 0.02, "{moved} along {axis} in {view:?}");
            }
        }
    }

    #[test]
    fn a_drag_in_a_plane_stays_in_it_and_under_the_pointer() {
        for view in views() {
            let wanted = Vec3::new(9.0, -3.0, 0.0);
            let (from, to) = (at(&view, GRABBED), at(&view, GRABBED + wanted));
            let moved = displacement(&view, GRABBED, Motion::Plane(Vec3::Z), from, to).expect("seen from above");
            assert!(moved.distance(wanted) < 0.02, "{moved} in {view:?}");
        }
    }

    #[test]
    fn an_axis_that_points_at_the_viewer_does_not_run_away() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let mut camera = Camera { projection, ..Camera::default() };
            camera.look_from(StandardView::Top);
            let view = View::new(camera, 800.0, 600.0);
            let from = view.size / 2.0;
            let step = view.length_per_point(Vec3::ZERO);
            for points in [1.0_f32, 5.0, 40.0] {
                let to = from + Vec2::new(points, 0.0);
                let moved = displacement(&view, Vec3::ZERO, Motion::Axis(Vec3::Z), from, to).expect("still a motion");
                let most = points * step / LEAST_SINE;
                assert!(moved.is_finite() && moved.length() <= most, "{projection:?}: {moved} for {points} points");
            }
        }
    }

    #[test]
    fn planes_seen_edge_on_horizons_and_zero_directions_give_no_motion() {
        let mut camera = Camera::default();
        camera.look_from(StandardView::Front);
        let view = View::new(camera, 800.0, 600.0);
        let (from, to) = (view.size / 2.0, view.size / 2.0 + Vec2::new(0.0, -20.0));
        let go = |motion, grabbed| displacement(&view, grabbed, motion, from, to);
        assert_eq!(go(Motion::Plane(Vec3::Z), Vec3::ZERO), None, "edge-on");
        assert_eq!(go(Motion::Plane(Vec3::ZERO), Vec3::ZERO), None, "no normal");
        assert_eq!(go(Motion::Axis(Vec3::ZERO), Vec3::ZERO), None, "no direction");
        let above = Vec3::new(0.0, 0.0, 500.0);
        assert_eq!(go(Motion::Plane(Vec3::Y + 0.2 * Vec3::Z), above + 5000.0 * Vec3::NEG_Y), None, "behind the eye");
    }
}
