//! Three arrows and a center, of constant size on the screen: their geometry, and the pass that draws them.
//!
//! The arrows stand along the world's axes. They are turned into screen triangles here, sorted from far to near (each
//! cone leaves out the sides turned away), so that they are drawn on top of the scene without a depth buffer. An arrow
//! that points at the viewer would be a blob that no drag could use: it is neither drawn nor picked.

use super::gpu::{Cached, Content, Uploader};
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
/// Radius of the center, points.
pub(super) const CENTER_RADIUS: f32 = 6.5;
/// An arrow whose shaft is shorter than this on the screen, in points, points at the viewer.
const LEAST_ARM: f32 = 20.0;
/// Sides of a cone and of the disc in the center.
const N_SIDES: u16 = 20;

/// What can be grabbed on a gizmo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GizmoPart {
    /// Moves along x.
    X,
    /// Moves along y.
    Y,
    /// Moves along z.
    Z,
    /// Moves in the plane of the screen.
    Center,
}

impl GizmoPart {
    /// The three arrows.
    pub const ARROWS: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Direction of an arrow; `None` for the center.
    #[must_use]
    pub fn axis(self) -> Option<Vec3> {
        match self {
            Self::X => Some(Vec3::X),
            Self::Y => Some(Vec3::Y),
            Self::Z => Some(Vec3::Z),
            Self::Center => None,
        }
    }
}

/// Arrows at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gizmo {
    /// Where, mm.
    pub center: Vec3,
    /// Colours of the x, y and z arrow and of the center.
    pub colors: [Rgba; 4],
    /// The part under the pointer or being dragged.
    pub hot: Option<GizmoPart>,
    /// Colour of that part.
    pub hot_color: Rgba,
}

impl Gizmo {
    fn color(&self, part: GizmoPart) -> Rgba {
        let own = match part {
            GizmoPart::X => self.colors[0],
            GizmoPart::Y => self.colors[1],
            GizmoPart::Z => self.colors[2],
            GizmoPart::Center => self.colors[3],
        };
        if self.hot == Some(part) { self.hot_color } else { own }
    }
}

/// An arrow in the picture: ends of its shaft and head on the screen in points, and the depth of its tip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arm {
    pub(super) part: GizmoPart,
    axis: Vec3,
    pub(super) from: Vec2,
    pub(super) tip: Vec2,
    pub(super) depth: f32,
}

/// The arrows that do not point at the viewer, from far to near.
pub(super) fn arms(view: &View, center: Vec3) -> Vec<Arm> {
    let step = view.length_per_point(center);
    let mut arms: Vec<Arm> = GizmoPart::ARROWS
        .into_iter()
        .filter_map(|part| {
            let axis = part.axis()?;
            let from = view.project(center + GAP * step * axis)?;
            let tip = view.project(center + ARM * step * axis)?;
            let long_enough = from.at.distance(tip.at) >= LEAST_ARM;
            long_enough.then_some(Arm { part, axis, from: from.at, tip: tip.at, depth: tip.depth })
        })
        .collect();
    arms.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    arms
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

    fn arrow(&mut self, center: Vec3, arm: &Arm, color: Rgba) {
        let step = self.view.length_per_point(center);
        let base = center + (ARM - HEAD_LENGTH) * step * arm.axis;
        let Some(end) = self.view.project(base) else { return };
        let along = (arm.tip - arm.from).normalize_or_zero();
        let side = SHAFT_WIDTH / 2.0 * along.perp();
        self.triangle([arm.from - side, arm.from + side, end.at + side], color);
        self.triangle([arm.from - side, end.at + side, end.at - side], color);
        let to_eye = -self.view.ray(arm.tip).direction;
        let (u, v) = arm.axis.any_orthonormal_pair();
        let outward = |angle: f32| angle.cos() * u + angle.sin() * v;
        let rim = |k: u16| self.view.project(base + HEAD_RADIUS * step * outward(turn(k))).map(|p| p.at);
        let Some(rims) = (0..=N_SIDES).map(rim).collect::<Option<Vec<Vec2>>>() else { return };
        let from_behind = arm.axis.dot(to_eye) < 0.0;
        for (pair, k) in rims.windows(2).zip(0..) {
            let middle = (turn(k) + turn(k + 1)) / 2.0;
            let normal = (HEAD_LENGTH * outward(middle) + HEAD_RADIUS * arm.axis).normalize_or_zero();
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
    let arms = arms(view, gizmo.center);
    let (behind, before): (Vec<&Arm>, Vec<&Arm>) = arms.iter().partition(|arm| arm.depth > center.depth);
    for arm in behind {
        sketch.arrow(gizmo.center, arm, gizmo.color(arm.part));
    }
    sketch.disc(center.at, CENTER_RADIUS, gizmo.color(GizmoPart::Center));
    for arm in before {
        sketch.arrow(gizmo.center, arm, gizmo.color(arm.part));
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
