//! Drawing with wgpu, without a window: what to draw, from where, the passes, pick and drag.
//!
//! Enters: a [`Scene`] (plain values: positions, triangles, colours; the window makes it from its domain) and a
//! [`View`] (a [`Camera`] in a rectangle). Leaves: a texture that the window blits ([`Renderer`]) or an image in
//! memory ([`readback::picture`]). Here, and only here, `f64` becomes `f32`.
//!
//! * **Units.** Lengths in a scene are **millimetres** and need not say so: it is a picture at the program's edge, and
//!   numbers near one keep `f32`, the depth buffer and the grid well-behaved. Lengths on the screen are *points*
//!   (logical pixels) with the origin at the top left and y down; [`View::scale`] converts to texels. z is up.
//! * **Colours** are sRGB-encoded `[r, g, b, a]` with straight alpha, as the window's theme has them. Shaders light in
//!   linear light and write encoded values to a `Unorm` target.
//! * **Upload on change.** Every list of a scene is an [`Array`] that carries a generation number: equal numbers mean
//!   equal contents, so a drag uploads positions and nothing else, and an unchanged frame draws nothing at all.
//! * **Depth** is reversed (1 near, 0 at infinity): `f32` then resolves 35 µm of copper from half a metre away.
//! * **Flat shading.** Normals come from screen derivatives in the fragment shader; none is stored or uploaded.
//! * **Portability.** No storage buffers, no compute: the limits of WebGL2 suffice. One `.wgsl` file per pass.
//!
//! Not handled: order-independent transparency (translucent parts are drawn in list order, back faces first),
//! shadows, text (the window writes labels where [`View::project`] says).

pub mod camera;
pub mod colormap;
pub mod drag;
pub mod gizmo;
pub mod gpu;
pub mod operator;
pub mod pick;
pub mod readback;
pub mod scene;
pub mod typed;
pub mod uniforms;
pub mod view;

mod blit;
mod grid;
mod handles;
mod lines;
mod passes;
mod renderer;
mod surface;

pub use camera::{Camera, Projection, Ray, StandardView};
pub use colormap::ColorMap;
pub use gizmo::{Gizmo, GizmoPart};
pub use glam::{Vec2, Vec3};
pub use gpu::{Counts, Gpu, GpuError};
pub use operator::{Bound, Change, Operator};
pub use readback::{Picture, picture};
pub use renderer::Renderer;
pub use scene::{Array, Grid, HandleState, Handles, Lines, Paint, Part, Rgba, Scalars, Scene, Surface};
pub use typed::Typed;
pub use view::{Projected, View, round_length};
