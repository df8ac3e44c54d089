//! A camera in a rectangle of the screen: where a point lands, what lies under the pointer, pan, zoom and fit.
//!
//! Places on the screen are points (logical pixels) from the top left, y down; lengths in the world are millimetres.

use super::camera::{Camera, MAX_DISTANCE, MIN_DISTANCE, Projection, Ray};
use super::{Vec2, Vec3};
use glam::Mat4;

/// Free border around a fitted box, as a factor.
const FIT_MARGIN: f32 = 1.08;

/// Where a point of the world lands in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Points from the top left, y down; may lie outside the picture.
    pub at: Vec2,
    /// Distance in front of the eye's plane, mm.
    pub depth: f32,
}

/// A camera in a rectangle of the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Width and height, points.
    pub size: Vec2,
    /// Texels per point.
    pub scale: f32,
}

impl View {
    /// A view with one texel per point.
    #[must_use]
    pub fn new(camera: Camera, width: f32, height: f32) -> Self {
        Self { camera, size: Vec2::new(width, height), scale: 1.0 }
    }

    /// Width over height; 1 while there is no area.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        if self.size.min_element() > 0.0 { self.size.x / self.size.y } else { 1.0 }
    }

    /// World to clip space with reversed depth.
    #[must_use]
    pub fn clip_from_world(&self) -> Mat4 {
        self.camera.clip_from_world(self.aspect())
    }

    /// From points to −1..1, y up.
    #[must_use]
    pub fn ndc(&self, pointer: Vec2) -> Vec2 {
        let unit = pointer / self.size.max(Vec2::splat(f32::MIN_POSITIVE));
        Vec2::new(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y)
    }

    /// The half-line under the pointer.
    #[must_use]
    pub fn ray(&self, pointer: Vec2) -> Ray {
        self.camera.ray(self.ndc(pointer), self.aspect())
    }

    /// Where `point` lands in the picture; `None` behind the near plane.
    #[must_use]
    pub fn project(&self, point: Vec3) -> Option<Projected> {
        let camera = &self.camera;
        let [right, up, back] = camera.axes();
        let from_target = point - camera.target;
        let depth = camera.distance - from_target.dot(back);
        let reach = match camera.projection {
            Projection::Perspective if depth < camera.near() => return None,
            Projection::Perspective => depth * (camera.fov / 2.0).tan(),
            Projection::Orthographic => camera.half_height(),
        };
        let ndc = Vec2::new(from_target.dot(right) / self.aspect(), from_target.dot(up)) / reach;
        let at = Vec2::new(1.0 + ndc.x, 1.0 - ndc.y) / 2.0 * self.size;
        Some(Projected { at, depth })
    }

    /// Millimetres that one point of the screen spans at the depth of `place`, for scale bars and constant sizes.
    #[must_use]
    pub fn length_per_point(&self, place: Vec3) -> f32 {
        let camera = &self.camera;
        let depth = match camera.projection {
            Projection::Perspective => {
                (camera.distance - (place - camera.target).dot(camera.axes()[2])).max(camera.near())
            }
            Projection::Orthographic => camera.distance,
        };
        2.0 * depth * (camera.fov / 2.0).tan() / self.size.y.max(1.0)
    }

    /// Slides the scene with a drag of `delta` points: what lies at the target's depth stays under the pointer.
    pub fn pan(&mut self, delta: Vec2) {
        let step = self.length_per_point(self.camera.target);
        let [right, up, _] = self.camera.axes();
        self.camera.target += step * (delta.y * up - delta.x * right);
    }

    /// Comes nearer by `factor` (2 doubles the size); what lies under the pointer at the target's depth stays there.
    ///
    /// At the ends of the range of distances nothing moves; a factor that is not positive does nothing.
    pub fn zoom(&mut self, factor: f32, pointer: Vec2) {
        if !(factor > 0.0 && factor.is_finite()) {
            return;
        }
        let before = self.camera.distance;
        let after = (before / factor).clamp(MIN_DISTANCE, MAX_DISTANCE);
        let [right, up, _] = self.camera.axes();
        let ndc = self.ndc(pointer);
        let offset = self.camera.half_height() * (ndc.x * self.aspect() * right + ndc.y * up);
        self.camera.target += (1.0 - after / before) * offset;
        self.camera.distance = after;
    }

    /// Looks at the middle of a box from as near as shows all of it; the direction stays.
    ///
    /// A box without extent is centered at the present distance; one with a coordinate that is not finite is ignored.
    pub fn fit(&mut self, low: Vec3, high: Vec3) {
        if !(low.is_finite() && high.is_finite()) {
            return;
        }
        let [right, up, back] = self.camera.axes();
        let slope = (self.camera.fov / 2.0).tan();
        let half = (high - low) / 2.0;
        let mut needed = 0.0_f32;
        for corner in 0..8 {
            let sign = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
            let p = half * Vec3::new(sign(1), sign(2), sign(4));
            let across = (p.dot(right).abs() / self.aspect()).max(p.dot(up).abs());
            let before = if self.camera.projection == Projection::Perspective { p.dot(back) } else { 0.0 };
            needed = needed.max(FIT_MARGIN * across / slope + before);
        }
        self.camera.target = low + half;
        if needed > 0.0 {
            self.camera.distance = needed.clamp(MIN_DISTANCE, MAX_DISTANCE);
        }
    }
}

/// The largest of 1, 2 or 5 times a power of ten that is at most `length`: for scale bars and grids.
#[must_use]
pub fn round_length(length: f32) -> f32 {
    if !(length > 0.0 && length.is_finite()) {
        return 1.0;
    }
    let decade = 10.0_f32.powf(length.log10().floor());
    // A little slack, so that rounding in the logarithm does not turn 5 into 2.
    [5.0, 2.0, 1.0].into_iter().map(|m| m * decade).find(|&l| l <= length * 1.000_01).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::StandardView;
    use std::f32::consts::{FRAC_PI_2, PI};

    const PROJECTIONS: [Projection; 2] = [Projection::Perspective, Projection::Orthographic];

    /// A place that is seen whatever the direction.
    fn random_place(rng: &mut fastrand::Rng, camera: &Camera) -> Vec3 {
        camera.target + camera.half_height() * (Vec3::new(rng.f32(), rng.f32(), rng.f32()) - 0.5)
    }

    fn random_view(rng: &mut fastrand::Rng, projection: Projection) -> View {
        let mut number = |lo: f32, hi: f32| lo + (hi - lo) * rng.f32();
        let target = Vec3::new(number(-50.0, 50.0), number(-50.0, 50.0), number(-20.0, 20.0));
        let (yaw, pitch) = (number(-PI, PI), number(-FRAC_PI_2, FRAC_PI_2));
        let camera = Camera { target, yaw, pitch, distance: number(20.0, 400.0), projection, ..Camera::default() };
        View::new(camera, number(300.0, 1500.0), number(300.0, 900.0))
    }

    #[test]
    fn projection_agrees_with_the_matrix_of_the_shader() {
        let mut rng = fastrand::Rng::with_seed(1);
        for projection in PROJECTIONS {
            for _ in 0..200 {
                let view = random_view(&mut rng, projection);
                let point = random_place(&mut rng, &view.camera);
                let clip = view.clip_from_world() * point.extend(1.0);
                let ndc = clip.truncate() / clip.w;
                let seen = view.project(point).expect("in front of the eye");
                assert!(view.ndc(seen.at).distance(ndc.truncate()) < 1e-3, "{view:?} {point}");
                assert!(ndc.z > 0.0 && ndc.z < 1.0, "depth {} in {view:?}", ndc.z);
            }
        }
    }

    #[test]
    fn a_ray_through_a_projected_point_passes_the_point() {
        let mut rng = fastrand::Rng::with_seed(2);
        for projection in PROJECTIONS {
            for _ in 0..200 {
                let view = random_view(&mut rng, projection);
                let point = random_place(&mut rng, &view.camera);
                let ray = view.ray(view.project(point).expect("in front of the eye").at);
                let beside = (point - ray.origin).cross(ray.direction).length();
                assert!(beside < 1e-4 * view.camera.distance, "{beside} mm beside in {view:?}");
                assert!((point - ray.origin).dot(ray.direction) > ray.start, "the ray begins before the point");
            }
        }
    }

    #[test]
    fn panning_moves_the_target_with_the_pointer() {
        let mut rng = fastrand::Rng::with_seed(3);
        for projection in PROJECTIONS {
            let mut view = random_view(&mut rng, projection);
            let place = view.camera.target;
            let before = view.project(place).expect("seen").at;
            let delta = Vec2::new(31.0, -17.0);
            view.pan(delta);
            let after = view.project(place).expect("still seen").at;
            assert!((after - before).distance(delta) < 0.02, "{projection:?}: {} for {delta}", after - before);
        }
    }

    #[test]
    fn zooming_keeps_the_place_under_the_pointer() {
        let mut rng = fastrand::Rng::with_seed(4);
        for projection in PROJECTIONS {
            let mut view = random_view(&mut rng, projection);
            let pointer = view.size * Vec2::new(0.8, 0.3);
            let plane = view.camera.axes()[2];
            let ray = view.ray(pointer);
            let place = ray.at((view.camera.target - ray.origin).dot(plane) / ray.direction.dot(plane));
            let size = view.length_per_point(place);
            view.zoom(2.0, pointer);
            assert!(view.project(place).expect("seen").at.distance(pointer) < 0.05, "{projection:?}");
            assert!((view.length_per_point(place) / size - 0.5).abs() < 1e-3, "{projection:?}: twice the size");
        }
    }

    #[test]
    fn zooming_stands_still_at_its_limits() {
        let mut view = View::new(Camera { distance: MIN_DISTANCE, ..Camera::default() }, 800.0, 600.0);
        let before = view.camera;
        view.zoom(3.0, Vec2::new(10.0, 20.0));
        assert_eq!(view.camera, before, "nearest");
        view.camera.distance = MAX_DISTANCE;
        let before = view.camera;
        view.zoom(0.1, Vec2::new(10.0, 20.0));
        view.zoom(f32::NAN, Vec2::ZERO);
        view.zoom(0.0, Vec2::ZERO);
        assert_eq!(view.camera, before, "farthest, and nonsense");
    }

    #[test]
    fn a_fitted_box_touches_the_margin_from_inside() {
        let (low, high) = (Vec3::new(-30.0, -25.0, 0.0), Vec3::new(30.0, 25.0, 1.6));
        for projection in PROJECTIONS {
            for standard in StandardView::ALL {
                for (width, height) in [(1280.0, 800.0), (400.0, 900.0)] {
                    let mut view = View::new(Camera { projection, ..Camera::default() }, width, height);
                    view.camera.look_from(standard);
                    view.fit(low, high);
                    let corner = |k: u32| {
                        let pick = |bit: u32, l: f32, h: f32| if k & bit == 0 { l } else { h };
                        Vec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z))
                    };
                    let far = (0..8).map(|k| view.ndc(view.project(corner(k)).expect("seen").at).abs().max_element());
                    let most = far.fold(0.0, f32::max);
                    assert!((0.85..=1.0).contains(&most), "{projection:?} {standard:?} {width}: {most}");
                }
            }
        }
    }

    #[test]
    fn fitting_nothing_keeps_the_distance() {
        let mut view = View::new(Camera::default(), 800.0, 600.0);
        view.fit(Vec3::ONE, Vec3::ONE);
        assert!((view.camera.distance - Camera::default().distance).abs() < 1e-6, "a single point");
        assert_eq!(view.camera.target, Vec3::ONE, "is looked at");
        let before = view.camera;
        view.fit(Vec3::INFINITY, Vec3::NEG_INFINITY);
        assert_eq!(view.camera, before, "an empty box is ignored");
    }

    #[test]
    fn switching_the_projection_keeps_the_size_at_the_target() {
        let view = |projection| View::new(Camera { projection, ..Camera::default() }, 640.0, 480.0);
        let [a, b] = PROJECTIONS.map(|p| view(p).length_per_point(Vec3::ZERO));
        assert!((a / b - 1.0).abs() < 1e-5, "{a} and {b} mm per point");
    }

    #[test]
    fn points_behind_the_eye_are_not_projected() {
        let view = View::new(Camera::default(), 640.0, 480.0);
        let behind = view.camera.eye() + 5.0 * view.camera.axes()[2];
        assert_eq!(view.project(behind), None, "behind");
    }

    #[test]
    fn round_lengths_are_one_two_five() {
        let cases =
            [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (4.9, 2.0), (5.0, 5.0), (73.0, 50.0), (0.03, 0.02), (0.0, 1.0)];
        for (length, expected) in cases {
            let found = round_length(length);
            assert!((found / expected - 1.0).abs() < 1e-5, "{length} gives {found}");
        }
    }
}
