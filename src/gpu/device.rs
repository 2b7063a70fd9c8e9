//! Opens a Vulkan, Metal or DirectX 12 device; a software one (lavapipe) is a device like any other.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use thiserror::Error;

/// Why there is no picture.
#[derive(Debug, Error)]
pub enum GpuError {
    /// No adapter at all.
    #[error(
        "no graphics device found ({why}); install a Vulkan driver, or the software one: apt-get install mesa-vulkan-drivers"
    )]
    NoAdapter {
        /// What wgpu said.
        why: String,
    },
    /// The adapter lacks what is needed.
    #[error(
        "{adapter} cannot be used ({why}); update its driver or use the software device (VK_ICD_FILENAMES=lvp_icd.x86_64.json)"
    )]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What wgpu said.
        why: String,
    },
    /// The city does not fit the device.
    #[error("{what} needs {needed}, {adapter} allows {allowed}")]
    TooLarge {
        /// What does not fit.
        what: &'static str,
        /// How much it needs.
        needed: u64,
        /// How much is allowed.
        allowed: u64,
        /// The adapter's name.
        adapter: String,
    },
    /// The device was lost or refused a command.
    #[error("{adapter} failed: {why}")]
    Failed {
        /// The adapter's name.
        adapter: String,
        /// What wgpu said.
        why: String,
    },
}

/// A device with its queue.
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name of the adapter, for messages.
    pub adapter_name: String,
    /// True when the processor does the work of a graphics card.
    pub is_software: bool,
    /// True when passes can be timed.
    pub has_timestamps: bool,
    /// What the device complained of since it was last asked.
    complaint: Arc<Mutex<Option<String>>>,
    /// Resources made so far.
    creations: AtomicU64,
}

impl Gpu {
    /// Opens the most powerful device without a window.
    pub fn open() -> Result<Self, GpuError> {
        let instance = instance(wgpu::InstanceDescriptor::new_without_display_handle());
        Self::from_instance(&instance, None)
    }

    /// Opens a device that can show its images on a window's surface; the surface comes beside it.
    ///
    /// # Errors
    /// When no device can.
    pub fn open_for_window(
        window: std::sync::Arc<winit::window::Window>,
    ) -> Result<(Self, wgpu::Surface<'static>, wgpu::SurfaceConfiguration), GpuError> {
        let no_adapter = |why: String| GpuError::NoAdapter { why };
        let display = Box::new(window.clone());
        let instance = instance(wgpu::InstanceDescriptor::new_with_display_handle(display));
        let size = window.inner_size();
        let surface = instance
            .create_surface(window)
            .map_err(|error| no_adapter(error.to_string()))?;
        let adapter = request_adapter(&instance, Some(&surface))?;
        let configuration = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| no_adapter("the window's surface is not supported".to_owned()))?;
        let gpu = Self::from_adapter(&adapter)?;
        surface.configure(&gpu.device, &configuration);
        Ok((gpu, surface, configuration))
    }

    fn from_instance(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        Self::from_adapter(&request_adapter(instance, surface)?)
    }

    fn from_adapter(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let adapter_name = adapter.get_info().name;
        let wanted = wgpu::Features::TIMESTAMP_QUERY;
        let features = adapter.features() & wanted;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("rilievo"),
            required_features: features,
            required_limits: adapter.limits(),
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoDevice {
            adapter: adapter_name.clone(),
            why: error.to_string(),
        })?;
        let complaint: Arc<Mutex<Option<String>>> = Arc::default();
        let first = Arc::clone(&complaint);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert_with(|| error.to_string());
        }));
        Ok(Self {
            complaint,
            creations: AtomicU64::new(0),
            device,
            queue,
            adapter_name,
            is_software: adapter.get_info().device_type == wgpu::DeviceType::Cpu,
            has_timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
        })
    }

    /// Waits until the device has done all that was submitted; fails when it refused something since.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| self.failed(error))?;
        let mut complaint = self.complaint.lock().unwrap_or_else(PoisonError::into_inner);
        match complaint.take() {
            Some(why) => Err(self.failed(why)),
            None => Ok(()),
        }
    }

    /// Keeps what a caller or the device found wrong for the next [`Gpu::wait`]; the first complaint stands.
    pub fn complain(&self, why: &str) {
        let mut complaint = self.complaint.lock().unwrap_or_else(PoisonError::into_inner);
        complaint.get_or_insert_with(|| why.to_owned());
    }

    /// How many buffers, textures, groups, layouts, samplers, shaders and pipelines have been made so far: a frame of a view
    /// already drawn makes none.
    pub fn creations(&self) -> u64 {
        self.creations.load(Ordering::Relaxed)
    }

    /// Counts one resource. Everything of this module that makes one calls it; nothing else makes any (a test holds that).
    pub(super) fn count_creation(&self) {
        self.creations.fetch_add(1, Ordering::Relaxed);
    }

    /// An error that names the device.
    pub fn failed(&self, why: impl ToString) -> GpuError {
        GpuError::Failed {
            adapter: self.adapter_name.clone(),
            why: why.to_string(),
        }
    }

    /// Refuses what the device's limits forbid.
    pub fn require(&self, what: &'static str, needed: u64, allowed: u64) -> Result<(), GpuError> {
        if needed <= allowed {
            return Ok(());
        }
        Err(GpuError::TooLarge {
            what,
            needed,
            allowed,
            adapter: self.adapter_name.clone(),
        })
    }
}

/// Vulkan and its peers only: the GL back end of software Mesa draws hierarchical walks wrongly.
fn instance(mut description: wgpu::InstanceDescriptor) -> wgpu::Instance {
    description.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    wgpu::Instance::new(description)
}

fn request_adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
) -> Result<wgpu::Adapter, GpuError> {
    pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        compatible_surface: surface,
        ..Default::default()
    }))
    .map_err(|error| GpuError::NoAdapter {
        why: error.to_string(),
    })
}
