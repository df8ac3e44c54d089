//! A turntable camera as plain mathematics: orbit, standard views, matrices and rays.
//!
//! z is up. The eye looks at `target` from `distance` away, at `yaw` around the z axis and `pitch` above the horizon.
//! The screen axes come from the two angles and not from a cross product with z, so the view from straight above is
//! an ordinary one: nothing flips or degenerates at the poles. Switching between perspective and orthographic keeps
//! the size of what lies at the target. Lengths are millimetres and points, see [`super`].

use super::{Vec2, Vec3};
use glam::Mat4;
use glam::camera::rh::proj::directx;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Nearest the eye comes to its target, mm: 35 µm of foil then fill most of the height. Ten times nearer, the `f32`
/// positions of a 100 mm antenna (steps of 8 nm) begin to jitter visibly.
pub const MIN_DISTANCE: f32 = 0.1;
/// Farthest, mm. Beyond it the scene is less than a point on the screen.
pub const MAX_DISTANCE: f32 = 1.0e5;
/// Near plane over distance. Larger cuts off what stands before the target; smaller only costs depth resolution.
const NEAR_FRACTION: f32 = 0.01;
/// Radians per point dragged: half a turn across about 400 points.
const ORBIT_SPEED: f32 = 0.008;

/// How depth changes size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Projection {
    /// Nearer is larger.
    #[default]
    Perspective,
    /// Equal lengths look equal: for alignment.
    Orthographic,
}

/// The named directions to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StandardView {
    /// From −y, x to the right.
    Front,
    /// From +y.
    Back,
    /// From −x.
    Left,
    /// From +x.
    Right,
    /// From +z, x to the right and y up.
    Top,
    /// From −z, x to the right.
    Bottom,
    /// From (+x, −y, +z) with equal foreshortening.
    Isometric,
}

impl StandardView {
    /// All of them, in the order of a menu.
    pub const ALL: [Self; 7] =
        [Self::Front, Self::Back, Self::Left, Self::Right, Self::Top, Self::Bottom, Self::Isometric];

    /// Yaw and pitch, rad.
    #[must_use]
    pub fn angles(self) -> (f32, f32) {
        match self {
            Self::Front => (0.0, 0.0),
            Self::Back => (PI, 0.0),
            Self::Left => (-FRAC_PI_2, 0.0),
            Self::Right => (FRAC_PI_2, 0.0),
            Self::Top => (0.0, FRAC_PI_2),
            Self::Bottom => (0.0, -FRAC_PI_2),
            Self::Isometric => (FRAC_PI_4, (1.0_f32 / 3.0).sqrt().asin()),
        }
    }
}

/// Where the eye is and how it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point it looks at and turns about, mm.
    pub target: Vec3,
    /// Turn around z, rad; 0 looks along +y, positive moves the eye counter-clockwise seen from above.
    pub yaw: f32,
    /// Height above the horizon, rad, from −π/2 to π/2.
    pub pitch: f32,
    /// From the eye to the target, mm.
    pub distance: f32,
    /// Vertical field of view, rad; in an orthographic view it gives the height at the target.
    pub fov: f32,
    /// Perspective or orthographic.
    pub projection: Projection,
}

impl Default for Camera {
    fn default() -> Self {
        let (yaw, pitch) = StandardView::Isometric.angles();
        let fov = 30.0_f32.to_radians();
        Self { target: Vec3::ZERO, yaw, pitch, distance: 200.0, fov, projection: Projection::Perspective }
    }
}

impl Camera {
    /// Unit vectors of the screen in the world: right, up, and back towards the eye.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        let (sy, cy) = self.yaw.sin_cos();
        let (sp, cp) = self.pitch.sin_cos();
        [Vec3::new(cy, sy, 0.0), Vec3::new(-sy * sp, cy * sp, cp), Vec3::new(sy * cp, -cy * cp, sp)]
    }

    /// Position of the eye, mm.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.target + self.distance * self.axes()[2]
    }

    /// Half the height of what is seen at the target, mm.
    #[must_use]
    pub fn half_height(&self) -> f32 {
        self.distance * (self.fov / 2.0).tan()
    }

    /// Turns the scene with a drag of `delta` points; the pitch stops at the poles.
    pub fn orbit(&mut self, delta: Vec2) {
        let yaw = self.yaw - ORBIT_SPEED * delta.x;
        self.yaw = yaw - TAU * (yaw / TAU).round();
        self.pitch = (self.pitch + ORBIT_SPEED * delta.y).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Looks from a standard direction; target and distance stay.
    pub fn look_from(&mut self, view: StandardView) {
        (self.yaw, self.pitch) = view.angles();
    }

    /// World to view: x right, y up, z back, mm from the eye.
    #[must_use]
    pub fn view_from_world(&self) -> Mat4 {
        let [right, up, back] = self.axes();
        let eye = self.eye();
        let rotation = glam::Mat3::from_cols(right, up, back).transpose();
        Mat4::from_mat3(rotation) * Mat4::from_translation(-eye)
    }

    /// View to clip space with reversed depth (1 near, 0 far), for a picture `aspect` times as wide as high.
    #[must_use]
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        match self.projection {
            Projection::Perspective => directx::perspective_infinite_reverse(self.fov, aspect, self.near()),
            Projection::Orthographic => {
                let (half, depth) = (self.half_height(), self.half_depth());
                let (near, far) = (self.distance - depth, self.distance + depth);
                directx::orthographic(-half * aspect, half * aspect, -half, half, far, near)
            }
        }
    }

    /// World to clip space with reversed depth.
    #[must_use]
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        self.clip_from_view(aspect) * self.view_from_world()
    }

    /// The half-line under a place of the picture; `ndc` runs from −1 to 1, y up.
    #[must_use]
    pub fn ray(&self, ndc: Vec2, aspect: f32) -> Ray {
        let [right, up, back] = self.axes();
        let offset = self.half_height() * (ndc.x * aspect * right + ndc.y * up);
        match self.projection {
            Projection::Perspective => {
                let direction = (offset - self.distance * back).try_normalize().unwrap_or(-back);
                Ray { origin: self.eye(), direction, start: 0.0 }
            }
            Projection::Orthographic => {
                Ray { origin: self.target + offset, direction: -back, start: -self.half_depth() }
            }
        }
    }

    /// Distance of the near plane of a perspective view, mm.
    pub(super) fn near(&self) -> f32 {
        NEAR_FRACTION * self.distance
    }

    /// Half the depth that an orthographic view shows about its target, mm: deep enough that nothing is cut off.
    pub(super) fn half_depth(&self) -> f32 {
        100.0 * self.distance + 1000.0
    }
}

/// A half-line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// A point on it, mm.
    pub origin: Vec3,
    /// Unit vector away from the viewer.
    pub direction: Vec3,
    /// Where it begins, mm along the direction from the origin (negative in orthographic views).
    pub start: f32,
}

impl Ray {
    /// The point `distance` mm along the ray from its origin.
    #[must_use]
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + distance * self.direction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed_even_at_the_poles() {
        for pitch in [-FRAC_PI_2, -1.0, 0.0, 0.3, FRAC_PI_2] {
            for yaw in [-3.0, 0.0, 0.7, PI] {
                let [right, up, back] = Camera { yaw, pitch, ..Camera::default() }.axes();
                assert!((right.cross(up) - back).length() < 1e-6, "yaw {yaw} pitch {pitch}");
                assert!((right.length() - 1.0).abs() < 1e-6, "unit right at yaw {yaw}");
                assert!((up.length() - 1.0).abs() < 1e-6, "unit up at yaw {yaw} pitch {pitch}");
            }
        }
    }

    #[test]
    fn nearer_points_have_greater_depth_values() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = Camera { projection, ..Camera::default() };
            let [_, _, back] = camera.axes();
            let depth = |towards: f32| {
                let clip = camera.clip_from_world(1.0) * (camera.target + towards * back).extend(1.0);
                clip.z / clip.w
            };
            assert!(depth(0.035) > depth(0.0), "{projection:?}: 35 um of copper are resolved");
        }
    }

    #[test]
    fn standard_views_show_the_axes_where_they_belong() {
        let screen = |view: StandardView, world: Vec3| {
            let mut camera = Camera::default();
            camera.look_from(view);
            let [right, up, _] = camera.axes();
            Vec2::new(world.dot(right), world.dot(up))
        };
        let cases = [
            (StandardView::Front, Vec3::X, Vec3::Z),
            (StandardView::Back, Vec3::NEG_X, Vec3::Z),
            (StandardView::Left, Vec3::NEG_Y, Vec3::Z),
            (StandardView::Right, Vec3::Y, Vec3::Z),
            (StandardView::Top, Vec3::X, Vec3::Y),
            (StandardView::Bottom, Vec3::X, Vec3::NEG_Y),
        ];
        for (view, right, up) in cases {
            assert!(screen(view, right).distance(Vec2::X) < 1e-6, "{view:?}: right");
            assert!(screen(view, up).distance(Vec2::Y) < 1e-6, "{view:?}: up");
        }
        let lengths = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| screen(StandardView::Isometric, axis).length());
        assert!(lengths.iter().all(|l| (l - lengths[0]).abs() < 1e-6), "equal foreshortening: {lengths:?}");
    }

    #[test]
    fn orbit_stops_at_the_poles_and_wraps_around() {
        let mut camera = Camera::default();
        for _ in 0..100 {
            camera.orbit(Vec2::new(-37.0, 40.0));
            assert!(camera.pitch <= FRAC_PI_2 && camera.yaw.abs() <= PI + 1e-5, "{camera:?}");
        }
        assert!((camera.pitch - FRAC_PI_2).abs() < 1e-6, "at the pole");
        camera.orbit(Vec2::new(0.0, -10.0));
        assert!(camera.pitch < FRAC_PI_2 - 0.07, "and away from it at once");
    }
}
