//! The graphics device without a window, and buffers that upload only what changed.
//!
//! A machine without an adapter is an ordinary case: [`Gpu::headless`] then returns [`GpuError::NoAdapter`].

#![allow(clippy::cast_possible_truncation, reason = "byte counts of buffers, far below 2^63")]

use wgpu::BufferUsages;

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// No graphics adapter, not even a software one.
    #[error("no graphics adapter ({reason}): install mesa-vulkan-drivers, or try WGPU_BACKEND=gl")]
    NoAdapter {
        /// What the graphics library says.
        reason: String,
    },
    /// The adapter gave no device.
    #[error("the graphics adapter {adapter} gave no device ({reason}): update its driver, or try WGPU_BACKEND=gl")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the graphics library says.
        reason: String,
    },
    /// The picture is empty or larger than the adapter can hold.
    #[error("a picture of {width} x {height} is not possible here: choose 1 to {limit} on each side")]
    BadSize {
        /// Texels across.
        width: u32,
        /// Texels down.
        height: u32,
        /// Most texels on a side.
        limit: u32,
    },
    /// The picture could not be read back.
    #[error("the picture did not come back from the graphics adapter: {reason}")]
    Readback {
        /// What the graphics library says.
        reason: String,
    },
}

/// A device of its own, for pictures without a window.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name of the adapter, for reports.
    pub adapter: String,
}

impl Gpu {
    /// Opens a device without a window, on the backends that `WGPU_BACKEND` names or on any.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::NoDevice`].
    pub fn headless() -> Result<Self, GpuError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY | wgpu::Backends::GL);
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .map_err(|e| GpuError::NoAdapter { reason: e.to_string() })?;
        let name = adapter.get_info().name;
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| GpuError::NoDevice { adapter: name.clone(), reason: e.to_string() })?;
        Ok(Self { device, queue, adapter: name })
    }
}

/// What is in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Vertices of surfaces.
    Positions,
    /// The field on them.
    Values,
    /// Their triangles.
    Triangles,
    /// Ends of lines.
    Lines,
    /// Places and states of handles.
    Handles,
    /// The arrows at the selection, which keep their size on the screen.
    Gizmo,
}

/// What a renderer has done since it was made: uploads of lists by what is in them, and pictures drawn.
///
/// Uniforms, some hundred bytes for each picture, do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pictures drawn.
    pub pictures: u64,
    /// Uploads of vertices of surfaces.
    pub positions: u64,
    /// Uploads of fields.
    pub values: u64,
    /// Uploads of triangles.
    pub triangles: u64,
    /// Uploads of ends of lines.
    pub lines: u64,
    /// Uploads of places or states of handles.
    pub handles: u64,
    /// Uploads of the arrows at the selection.
    pub gizmo: u64,
    /// Bytes uploaded in all of them.
    pub bytes: u64,
}

/// A device and its queue, as passes get them, and where uploads are counted.
#[derive(Debug)]
pub(super) struct Uploader<'a> {
    pub(super) device: &'a wgpu::Device,
    pub(super) queue: &'a wgpu::Queue,
    pub(super) counts: &'a mut Counts,
}

impl Uploader<'_> {
    fn count(&mut self, content: Content, bytes: u64) {
        let counts = &mut *self.counts;
        let uploads = match content {
            Content::Positions => &mut counts.positions,
            Content::Values => &mut counts.values,
            Content::Triangles => &mut counts.triangles,
            Content::Lines => &mut counts.lines,
            Content::Handles => &mut counts.handles,
            Content::Gizmo => &mut counts.gizmo,
        };
        *uploads += 1;
        counts.bytes += bytes;
    }
}

/// A buffer that remembers the generations of what it holds.
#[derive(Debug, Default)]
pub(super) struct Cached {
    buffer: Option<wgpu::Buffer>,
    key: [u64; 2],
    /// How many elements it holds.
    pub(super) count: u32,
}

impl Cached {
    /// Uploads what `make` returns, unless it was made from the same generations.
    pub(super) fn update<T: bytemuck::Pod>(
        &mut self,
        gpu: &mut Uploader<'_>,
        content: Content,
        key: [u64; 2],
        make: impl FnOnce() -> Vec<T>,
    ) {
        if self.buffer.is_some() && self.key == key {
            return;
        }
        let items = make();
        let bytes: &[u8] = bytemuck::cast_slice(&items);
        let size = bytes.len() as u64;
        let fits = self.buffer.as_ref().is_some_and(|b| size <= b.size());
        if !fits {
            let kind = if content == Content::Triangles { BufferUsages::INDEX } else { BufferUsages::VERTEX };
            let usage = kind | BufferUsages::COPY_DST;
            let descriptor =
                wgpu::BufferDescriptor { label: None, size: size.max(16), usage, mapped_at_creation: false };
            self.buffer = Some(gpu.device.create_buffer(&descriptor));
        }
        if let Some(buffer) = self.buffer.as_ref().filter(|_| size > 0) {
            gpu.queue.write_buffer(buffer, 0, bytes);
            gpu.count(content, size);
        }
        self.key = key;
        self.count = items.len() as u32;
    }

    /// All of the buffer, if it holds anything.
    pub(super) fn slice(&self) -> Option<wgpu::BufferSlice<'_>> {
        self.buffer.as_ref().filter(|_| self.count > 0).map(|b| b.slice(..))
    }
}
