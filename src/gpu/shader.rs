//! Shader sources. An entry file names the libraries it uses; WGSL does not mind the order of declarations, so
//! linking is joining texts. (A module system for WGSL would be one more compiler for what a list of five does.)

use super::Gpu;

/// A linked shader: libraries from `shaders/lib`, then the entry file.
#[derive(Clone, Copy, Debug)]
pub struct ShaderSource {
    /// Path of the entry file under `shaders/`.
    pub name: &'static str,
    /// Texts in flow order, the entry file last.
    pub texts: &'static [&'static str],
}

impl ShaderSource {
    /// The whole text.
    pub fn linked(&self) -> String {
        self.texts.join("\n")
    }
}

/// Compiles a linked shader.
pub fn shader_module(gpu: &Gpu, source: &ShaderSource) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(source.name),
        source: wgpu::ShaderSource::Wgsl(source.linked().into()),
    })
}
