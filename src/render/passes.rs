//! What the passes share: the pipeline recipe, the global bindings, and style records in one uniform buffer.

use super::gpu::Uploader;
use super::uniforms::Globals;
use super::{ColorMap, colormap};

/// Format of the renderer's own colour textures; shaders write encoded colour.
pub(super) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of the depth texture.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Samples per texel; every adapter has four.
pub(super) const SAMPLES: u32 = 4;
/// Bytes from one style record to the next: the alignment that every adapter accepts. No style is larger.
const RECORD: usize = 256;

/// Source of a pass: the shared part, then its own.
macro_rules! shader_source {
    ($name:literal) => {
        concat!(
            include_str!("../../shaders/common.wgsl"),
            "\n",
            include_str!(concat!("../../shaders/", $name, ".wgsl"))
        )
    };
}
pub(super) use shader_source;

/// Place of one style record, as a dynamic offset.
pub(super) type Record = u32;

/// The styles of one frame, one after the other.
#[derive(Debug, Default)]
pub(super) struct Records {
    bytes: Vec<u8>,
}

impl Records {
    /// Adds a style and says where it is.
    pub(super) fn push<T: bytemuck::Pod>(&mut self, style: &T) -> Record {
        let place = self.bytes.len();
        self.bytes.extend_from_slice(bytemuck::bytes_of(style));
        self.bytes.resize(place + RECORD, 0);
        Record::try_from(place).expect("a scene has fewer than 16 million styles")
    }
}

/// Bindings that all passes use.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) global_layout: wgpu::BindGroupLayout,
    style_layout: wgpu::BindGroupLayout,
    globals: wgpu::Buffer,
    pub(super) global_group: wgpu::BindGroup,
    styles: wgpu::Buffer,
    pub(super) style_group: wgpu::BindGroup,
}

impl Shared {
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let global_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("globals"),
            entries: &[uniform_entry(false), texture_entry(1)],
        });
        let style_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("style"),
            entries: &[uniform_entry(true)],
        });
        let globals = uniform_buffer(device, size_of::<Globals>() as u64);
        let maps = color_map_texture(device, queue).create_view(&wgpu::TextureViewDescriptor::default());
        let global_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("globals"),
            layout: &global_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: globals.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&maps) },
            ],
        });
        let styles = uniform_buffer(device, RECORD as u64);
        let style_group = style_group(device, &style_layout, &styles);
        Self { global_layout, style_layout, globals, global_group, styles, style_group }
    }

    /// Uploads the frame's uniforms.
    pub(super) fn update(&mut self, gpu: &Uploader<'_>, globals: &Globals, records: &Records) {
        gpu.queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(globals));
        let size = records.bytes.len() as u64;
        if size > self.styles.size() {
            self.styles = uniform_buffer(gpu.device, size);
            self.style_group = style_group(gpu.device, &self.style_layout, &self.styles);
        }
        if size > 0 {
            gpu.queue.write_buffer(&self.styles, 0, &records.bytes);
        }
    }

    /// Makes the pipeline of a pass.
    pub(super) fn pipeline(&self, device: &wgpu::Device, recipe: &Recipe<'_>) -> wgpu::RenderPipeline {
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(recipe.label),
            bind_group_layouts: &[Some(&self.global_layout), Some(&self.style_layout)],
            immediate_size: 0,
        });
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(recipe.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: recipe.module,
                entry_point: Some("vs_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: recipe.buffers,
            },
            primitive: wgpu::PrimitiveState { topology: recipe.topology, cull_mode: recipe.cull, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(recipe.depth_write),
                depth_compare: Some(recipe.depth),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: recipe.module,
                entry_point: Some("fs_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: COLOR_FORMAT,
                    blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// What differs between the pipelines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe<'a> {
    pub(super) label: &'a str,
    pub(super) module: &'a wgpu::ShaderModule,
    pub(super) buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(super) topology: wgpu::PrimitiveTopology,
    pub(super) cull: Option<wgpu::Face>,
    pub(super) depth: wgpu::CompareFunction,
    pub(super) depth_write: bool,
}

/// Compiles the source of a pass.
pub(super) fn shader(device: &wgpu::Device, label: &str, source: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(source.into());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source })
}

/// Bind-group entry of a filterable texture for the fragment shader.
pub(super) fn texture_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

fn uniform_entry(has_dynamic_offset: bool) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: None,
        },
        count: None,
    }
}

fn uniform_buffer(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
}

fn style_group(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, styles: &wgpu::Buffer) -> wgpu::BindGroup {
    let size = wgpu::BufferSize::new(RECORD as u64);
    let resource = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: styles, offset: 0, size });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("style"),
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource }],
    })
}

/// One row of texels per colour map.
fn color_map_texture(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::Texture {
    let texels: Vec<u8> =
        ColorMap::ALL.iter().flat_map(|map| map.table()).flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    let width = u32::try_from(colormap::N_ENTRIES).expect("a table is short");
    let height = u32::try_from(ColorMap::ALL.len()).expect("there are few maps");
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("colour maps"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: COLOR_FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), &texels, layout, size);
    texture
}
