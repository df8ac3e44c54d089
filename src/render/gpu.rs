//! The graphics device without a window, and buffers that upload only what changed.
//!
//! A machine without an adapter is an ordinary case: [`Gpu::headless`] then returns [`GpuError::NoAdapter`].

#![allow(clippy::cast_possible_truncation, reason = "byte counts of buffers, far below 2^63")]

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

/// A device and its queue, as passes get them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Uploader<'a> {
    pub(super) device: &'a wgpu::Device,
    pub(super) queue: &'a wgpu::Queue,
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
        gpu: Uploader<'_>,
        usage: wgpu::BufferUsages,
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
            let usage = usage | wgpu::BufferUsages::COPY_DST;
            let descriptor =
                wgpu::BufferDescriptor { label: None, size: size.max(16), usage, mapped_at_creation: false };
            self.buffer = Some(gpu.device.create_buffer(&descriptor));
        }
        if let Some(buffer) = self.buffer.as_ref().filter(|_| size > 0) {
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
        self.key = key;
        self.count = items.len() as u32;
    }

    /// All of the buffer, if it holds anything.
    pub(super) fn slice(&self) -> Option<wgpu::BufferSlice<'_>> {
        self.buffer.as_ref().filter(|_| self.count > 0).map(|b| b.slice(..))
    }
}
