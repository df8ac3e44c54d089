//! A picture in memory, without a window: for tests, reports and the command line.

use super::gpu::{Gpu, GpuError};
use super::passes::COLOR_FORMAT;
use super::renderer::Renderer;
use super::scene::{Rgba, Scene};
use super::view::View;

/// An image: rows from the top, sRGB-encoded, with straight alpha: opaque unless the scene's ground is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// `width` × `height` colours, row by row.
    pub pixels: Vec<Rgba>,
}

impl Picture {
    /// Colour at a place counted from the top left.
    ///
    /// # Panics
    /// If the place is not in the picture.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Rgba {
        assert!(x < self.width && y < self.height, "({x}, {y}) is outside of {} x {}", self.width, self.height);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The picture as a PNG file.
    ///
    /// # Errors
    /// What the encoder says; only a picture whose pixels do not match its size can cause it.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(file)
    }
}

/// Draws one picture of `scene`; its size is that of the view times its scale.
///
/// # Errors
/// [`GpuError::BadSize`] if a side is empty or too long for the adapter, [`GpuError::Readback`].
pub fn picture(gpu: &Gpu, scene: &Scene, view: &View) -> Result<Picture, GpuError> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    let size = (view.size * view.scale).round();
    if !(size.min_element() >= 1.0 && size.max_element() <= limit as f32) {
        let [width, height] = size.as_uvec2().to_array();
        return Err(GpuError::BadSize { width, height, limit });
    }
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, COLOR_FORMAT);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, scene, view);
    let texture = renderer.texture().expect("prepare has made the picture");
    read(gpu, encoder, texture)
}

fn read(gpu: &Gpu, mut encoder: wgpu::CommandEncoder, texture: &wgpu::Texture) -> Result<Picture, GpuError> {
    let (width, height) = (texture.width(), texture.height());
    let stride = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(stride) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    gpu.queue.submit([encoder.finish()]);
    let failed = |reason: String| GpuError::Readback { reason };
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver lives until the end of this function; if it is gone, nobody wants to know.
        let _ = sender.send(result);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(e.to_string()))?;
    receiver.recv().map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
    let bytes = buffer.get_mapped_range(..).map_err(|e| failed(e.to_string()))?;
    let rows = bytes.chunks_exact(stride as usize);
    let pixels = rows.flat_map(|row| row.as_chunks::<4>().0.iter().take(width as usize).map(straight)).collect();
    Ok(Picture { width, height, pixels })
}

/// Undoes the multiplication of the colour by its alpha.
fn straight(&[r, g, b, a]: &Rgba) -> Rgba {
    if matches!(a, 0 | 255) {
        return [r, g, b, a];
    }
    let whole = |c: u8| u8::try_from((u32::from(c) * 255 + u32::from(a) / 2) / u32::from(a)).unwrap_or(255);
    [whole(r), whole(g), whole(b), a]
}
