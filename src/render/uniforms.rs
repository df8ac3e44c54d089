//! Rust mirrors of the uniform structs in `shaders/`; `tests/shaders.rs` holds sizes and offsets against each other.
//!
//! Every member is a `vec4<f32>` or a matrix of them, so that both languages lay them out alike. What each component
//! means stands in the shader.

use bytemuck::{Pod, Zeroable};

/// `Globals` in `common.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Globals {
    /// World to clip space, by columns.
    pub clip_from_world: [[f32; 4]; 4],
    /// World to view space, by columns.
    pub view_from_world: [[f32; 4]; 4],
    /// Texels across and down, texels per point, 1 in perspective.
    pub viewport: [f32; 4],
    /// One step of depth as factor and summand, least w.
    pub depth: [f32; 4],
}

/// `SurfaceStyle` in `surface.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SurfaceStyle {
    /// Encoded colour and opacity.
    pub color: [f32; 4],
    /// Low end and inverse width of the range, row of the map, 1 to paint the field.
    pub field: [f32; 4],
    /// From 0 matt to 1 metal.
    pub finish: [f32; 4],
}

/// `LineStyle` in `lines.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LineStyle {
    /// Encoded colour and opacity.
    pub color: [f32; 4],
    /// Width in texels, depth steps.
    pub shape: [f32; 4],
}

/// `HandleStyle` in `handles.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HandleStyle {
    /// Encoded fill for each state.
    pub fills: [[f32; 4]; 4],
    /// Encoded rim.
    pub outline: [f32; 4],
    /// Radius and rim in texels, factor on alpha, depth steps.
    pub shape: [f32; 4],
}

/// `GridStyle` in `grid.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GridStyle {
    /// Encoded colour of the lines.
    pub color: [f32; 4],
    /// Encoded colour of the x axis.
    pub x_axis: [f32; 4],
    /// Encoded colour of the y axis.
    pub y_axis: [f32; 4],
    /// Center, height and half side, mm.
    pub place: [f32; 4],
    /// Spacing, line width, depth steps.
    pub shape: [f32; 4],
}

/// Channels from 0 to 1.
pub(super) fn unit(color: super::Rgba) -> [f32; 4] {
    color.map(|c| f32::from(c) / 255.0)
}
