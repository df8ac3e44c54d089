//! Arrows that move, rings that turn and knobs that scale, of constant size on the screen: geometry, and how it is drawn.
//!
//! Arrows and knobs stand along the world's axes, rings across them. All are turned into screen triangles here, sorted
//! from far to near (each cone leaves out the sides turned away), so that they are drawn on top of the scene without a
//! depth buffer. What no drag could use is neither drawn nor picked: an arrow that points at the viewer, a ring seen
//! from its edge. Of a ring the half towards the viewer is there, so that the rings do not tangle.

use super::gpu::{Cached, Content, Uploader};
use super::operator::{Bound, Operator};
use super::passes::{Recipe, Shared, shader, shader_source};
use super::scene::{Rgba, Scene};
use super::view::View;
use super::{Vec2, Vec3};
use wgpu::{CompareFunction, PrimitiveTopology};

/// From the center to the tips, points.
const ARM: f32 = 76.0;
/// Free space between the center and the shafts, points.
const GAP: f32 = 12.0;
const HEAD_LENGTH: f32 = 17.0;
const HEAD_RADIUS: f32 = 5.5;
const SHAFT_WIDTH: f32 = 2.5;
/// From the center to the knobs beyond the tips, and half a knob's side, points.
const KNOB_ARM: f32 = 92.0;
const KNOB_HALF: f32 = 4.5;
/// Radius and width of the rings, points.
const RING_RADIUS: f32 = 50.0;
const RING_WIDTH: f32 = 2.2;
/// Pieces of a whole ring.
const N_PIECES: u16 = 64;
/// A ring whose axis leaves the screen by less than this cosine is seen from its edge; by more than the second one it
/// faces the viewer and is there as a whole.
const LEAST_FACING: f32 = 0.12;
const WHOLE_FACING: f32 = 0.94;
/// Radius of the center, points.
pub(super) const CENTER_RADIUS: f32 = 6.5;
/// An arrow whose shaft is shorter than this on the screen, in points, points at the viewer.
const LEAST_ARM: f32 = 20.0;
/// Sides of a cone and of the disc in the center.
const N_SIDES: u16 = 20;

/// What can be grabbed on a gizmo; the numbers are those of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GizmoPart {
    /// Moves in the plane of the screen.
    Center,
    /// Moves along an axis.
    Arrow(usize),
    /// Turns about an axis.
    Ring(usize),
    /// Scales along an axis.
    Knob(usize),
}

impl GizmoPart {
    /// The operator that a drag of this part begins, and what it is bound to.
    #[must_use]
    pub fn operation(self) -> (Operator, Bound) {
        match self {
            Self::Center => (Operator::Move, Bound::Free),
            Self::Arrow(axis) => (Operator::Move, Bound::Axis(axis)),
            Self::Ring(axis) => (Operator::Rotate, Bound::Axis(axis)),
            Self::Knob(axis) => (Operator::Scale, Bound::Axis(axis)),
        }
    }
}

/// A gizmo at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gizmo {
    /// Where, mm.
    pub center: Vec3,
    /// Whether it has rings and knobs: a single vertex is neither turned nor scaled.
    pub is_whole: bool,
    /// Colours of the parts of the x, y and z axis, and of the center.
    pub colors: [Rgba; 4],
    /// The part under the pointer or being dragged.
    pub hot: Option<GizmoPart>,
    /// Colour of that part.
    pub hot_color: Rgba,
}

impl Gizmo {
    fn color(&self, part: GizmoPart) -> Rgba {
        let own = match part {
            GizmoPart::Center => self.colors[3],
            GizmoPart::Arrow(axis) | GizmoPart::Ring(axis) | GizmoPart::Knob(axis) => self.colors[axis],
        };
        if self.hot == Some(part) { self.hot_color } else { own }
    }
}

/// An arrow in the picture: ends of its shaft and head and its knob on the screen in points, and the depth of its tip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arm {
    pub(super) axis: usize,
    pub(super) from: Vec2,
    pub(super) tip: Vec2,
    pub(super) knob: Vec2,
    pub(super) depth: f32,
}

/// The arrows that do not point at the viewer, from far to near.
pub(super) fn arms(view: &View, center: Vec3) -> Vec<Arm> {
    let step = view.length_per_point(center);
    let mut arms: Vec<Arm> = (0..3)
        .filter_map(|axis| {
            let at = |reach: f32| view.project(center + reach * step * Vec3::AXES[axis]);
            let (from, tip, knob) = (at(GAP)?, at(ARM)?, at(KNOB_ARM)?.at);
            let long_enough = from.at.distance(tip.at) >= LEAST_ARM;
            long_enough.then_some(Arm { axis, from: from.at, tip: tip.at, knob, depth: tip.depth })
        })
        .collect();
    arms.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    arms
}

/// The rings that are not seen from their edge, each as its axis and a line on the screen in points.
pub(super) fn rings(view: &View, center: Vec3) -> Vec<(usize, Vec<Vec2>)> {
    let Some(seen) = view.project(center) else { return Vec::new() };
    let radius = RING_RADIUS * view.length_per_point(center);
    let to_eye = -view.ray(seen.at).direction;
    let ring = |axis: usize| {
        let normal = Vec3::AXES[axis];
        let facing = normal.dot(to_eye);
        if facing.abs() < LEAST_FACING {
            return None;
        }
        let nearest = (to_eye - facing * normal).try_normalize().unwrap_or(normal.any_orthonormal_vector());
        let across = normal.cross(nearest);
        let whole = facing.abs() > WHOLE_FACING;
        let n = if whole { N_PIECES } else { N_PIECES / 2 };
        let first = if whole { 0.0 } else { -std::f32::consts::FRAC_PI_2 };
        let at = |k: u16| {
            let angle = first + std::f32::consts::TAU * f32::from(k) / f32::from(N_PIECES);
            view.project(center + radius * (angle.cos() * nearest + angle.sin() * across)).map(|p| p.at)
        };
        Some((axis, (0..=n).map(at).collect::<Option<Vec<Vec2>>>()?))
    };
    (0..3).filter_map(ring).collect()
}

/// Where a part of a gizmo can be taken hold of, points; `None` if it is not there.
#[must_use]
pub fn grip(view: &View, gizmo: &Gizmo, part: GizmoPart) -> Option<Vec2> {
    let arm = |axis: usize| arms(view, gizmo.center).into_iter().find(|arm| arm.axis == axis);
    match part {
        GizmoPart::Center => view.project(gizmo.center).map(|p| p.at),
        GizmoPart::Arrow(axis) => arm(axis).map(|arm| arm.from.lerp(arm.tip, 0.9)),
        GizmoPart::Knob(axis) => arm(axis).filter(|_| gizmo.is_whole).map(|arm| arm.knob),
        GizmoPart::Ring(axis) => {
            let ring = rings(view, gizmo.center).into_iter().find(|(a, _)| *a == axis && gizmo.is_whole)?;
            ring.1.get(3 * ring.1.len() / 8).copied()
        }
    }
}

#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Corner {
    place: [f32; 2],
    color: Rgba,
}

/// Collects screen triangles.
struct Sketch<'a> {
    view: &'a View,
    corners: Vec<Corner>,
}

impl Sketch<'_> {
    fn triangle(&mut self, points: [Vec2; 3], color: Rgba) {
        self.corners.extend(points.map(|p| Corner { place: self.view.ndc(p).to_array(), color }));
    }

    fn disc(&mut self, center: Vec2, radius: f32, color: Rgba) {
        let at = |k: u16| center + radius * Vec2::from_angle(turn(k));
        for k in 0..N_SIDES {
            self.triangle([center, at(k), at(k + 1)], color);
        }
    }

    fn line(&mut self, [from, to]: [Vec2; 2], width: f32, color: Rgba) {
        let side = width / 2.0 * (to - from).normalize_or_zero().perp();
        self.triangle([from - side, from + side, to + side], color);
        self.triangle([from - side, to + side, to - side], color);
    }

    fn knob(&mut self, center: Vec2, color: Rgba) {
        let corner = |x: f32, y: f32| center + KNOB_HALF * Vec2::new(x, y);
        self.triangle([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)], color);
        self.triangle([corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], color);
    }

    fn arrow(&mut self, center: Vec3, arm: &Arm, color: Rgba) {
        let step = self.view.length_per_point(center);
        let axis = Vec3::AXES[arm.axis];
        let base = center + (ARM - HEAD_LENGTH) * step * axis;
        let Some(end) = self.view.project(base) else { return };
        self.line([arm.from, end.at], SHAFT_WIDTH, color);
        let to_eye = -self.view.ray(arm.tip).direction;
        let (u, v) = axis.any_orthonormal_pair();
        let outward = |angle: f32| angle.cos() * u + angle.sin() * v;
        let rim = |k: u16| self.view.project(base + HEAD_RADIUS * step * outward(turn(k))).map(|p| p.at);
        let Some(rims) = (0..=N_SIDES).map(rim).collect::<Option<Vec<Vec2>>>() else { return };
        let from_behind = axis.dot(to_eye) < 0.0;
        for (pair, k) in rims.windows(2).zip(0..) {
            let middle = (turn(k) + turn(k + 1)) / 2.0;
            let normal = (HEAD_LENGTH * outward(middle) + HEAD_RADIUS * axis).normalize_or_zero();
            let facing = normal.dot(to_eye);
            if facing > 0.0 {
                self.triangle([arm.tip, pair[0], pair[1]], shaded(color, 0.72 + 0.28 * facing));
            }
            if from_behind {
                self.triangle([end.at, pair[0], pair[1]], shaded(color, 0.7));
            }
        }
    }
}

fn turn(k: u16) -> f32 {
    std::f32::consts::TAU * f32::from(k) / f32::from(N_SIDES)
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a channel times at most one")]
fn shaded([r, g, b, a]: Rgba, factor: f32) -> Rgba {
    let [r, g, b] = [r, g, b].map(|c| (f32::from(c) * factor + 0.5) as u8);
    [r, g, b, a]
}

fn sketch(gizmo: &Gizmo, view: &View) -> Vec<Corner> {
    let Some(center) = view.project(gizmo.center) else { return Vec::new() };
    let mut sketch = Sketch { view, corners: Vec::new() };
    for (axis, line) in rings(view, gizmo.center).into_iter().filter(|_| gizmo.is_whole) {
        for pair in line.windows(2) {
            sketch.line([pair[0], pair[1]], RING_WIDTH, gizmo.color(GizmoPart::Ring(axis)));
        }
    }
    let arms = arms(view, gizmo.center);
    let (behind, before): (Vec<&Arm>, Vec<&Arm>) = arms.iter().partition(|arm| arm.depth > center.depth);
    let arrow = |sketch: &mut Sketch<'_>, arm: &Arm| {
        sketch.arrow(gizmo.center, arm, gizmo.color(GizmoPart::Arrow(arm.axis)));
        if gizmo.is_whole {
            sketch.knob(arm.knob, gizmo.color(GizmoPart::Knob(arm.axis)));
        }
    };
    for arm in behind {
        arrow(&mut sketch, arm);
    }
    sketch.disc(center.at, CENTER_RADIUS, gizmo.color(GizmoPart::Center));
    for arm in before {
        arrow(&mut sketch, arm);
    }
    sketch.corners
}

#[derive(Debug)]
pub(super) struct GizmoPass {
    pipeline: wgpu::RenderPipeline,
    corners: Cached,
    /// Counts the frames, as the triangles change with every one.
    frame: u64,
}

impl GizmoPass {
    pub(super) fn new(device: &wgpu::Device, shared: &Shared) -> Self {
        let module = shader(device, "gizmo", shader_source!("gizmo"));
        let attributes = wgpu::vertex_attr_array![0 => Float32x2, 1 => Unorm8x4];
        let step_mode = wgpu::VertexStepMode::Vertex;
        let buffers = [Some(wgpu::VertexBufferLayout { array_stride: 12, step_mode, attributes: &attributes })];
        let pipeline = shared.pipeline(
            device,
            &Recipe {
                label: "gizmo",
                module: &module,
                buffers: &buffers,
                topology: PrimitiveTopology::TriangleList,
                cull: None,
                depth: CompareFunction::Always,
                depth_write: false,
            },
        );
        Self { pipeline, corners: Cached::default(), frame: 0 }
    }

    pub(super) fn update(&mut self, gpu: &mut Uploader<'_>, scene: &Scene, view: &View) {
        self.frame += 1;
        let make = || scene.gizmo.as_ref().map_or_else(Vec::new, |gizmo| sketch(gizmo, view));
        self.corners.update(gpu, Content::Gizmo, [self.frame, 0], make);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(slice) = self.corners.slice() {
            pass.set_pipeline(&self.pipeline);
            pass.set_vertex_buffer(0, slice);
            pass.draw(0..self.corners.count, 0..1);
        }
    }
}
