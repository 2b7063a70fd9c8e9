//! Shader sources. An entry file names the libraries it uses; WGSL does not mind the order of declarations, so
//! linking is joining texts. (A module system for WGSL would be one more compiler for what a list of five does.)
//! Constants that Rust and a shader share are written once, in Rust: they come first, as a prelude.

use std::fmt::{self, Write};

use super::Gpu;

/// A file under `shaders/`: its path there and its text.
pub type ShaderFile = (&'static str, &'static str);

/// The shader file of a path under `shaders/`.
macro_rules! shader_file {
    ($path:literal) => {
        (
            $path,
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
        )
    };
}
pub(crate) use shader_file;

/// A value that shaders share with Rust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConstantValue {
    /// `u32`.
    Uint(u32),
    /// `i32`.
    Int(i32),
    /// `f32`.
    Float(f32),
    /// `vec2<f32>`.
    Float2([f32; 2]),
    /// `vec4<f32>`.
    Float4([f32; 4]),
}

/// A named value that shaders share with Rust.
pub type Constant = (&'static str, ConstantValue);

impl fmt::Display for ConstantValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uint(value) => write!(f, "{value}u"),
            Self::Int(value) => write!(f, "{value}i"),
            Self::Float(value) => write!(f, "{value:?}f"),
            Self::Float2([x, y]) => write!(f, "vec2<f32>({x:?}f, {y:?}f)"),
            Self::Float4([x, y, z, w]) => write!(f, "vec4<f32>({x:?}f, {y:?}f, {z:?}f, {w:?}f)"),
        }
    }
}

/// A linked shader: the prelude, libraries from `shaders/lib`, then the entry file.
#[derive(Clone, Copy, Debug)]
pub struct ShaderSource {
    /// Path of the entry file under `shaders/`.
    pub name: &'static str,
    /// Constants that the files use.
    pub constants: &'static [Constant],
    /// Files in flow order, the entry file last.
    pub files: &'static [ShaderFile],
}

impl ShaderSource {
    /// The constants as WGSL, a line each.
    fn prelude(&self) -> String {
        self.constants
            .iter()
            .fold(String::new(), |mut text, (name, value)| {
                // Writing to a string cannot fail.
                let _ = writeln!(text, "const {name} = {value};");
                text
            })
    }

    /// The whole text.
    pub fn linked(&self) -> String {
        let mut text = self.prelude();
        for (_, part) in self.files {
            text += part;
            text.push('\n');
        }
        text
    }

    /// File and line of a line of the whole text, both lines from 1.
    pub fn locate(&self, linked_line: usize) -> (&'static str, usize) {
        let mut line = linked_line;
        if line <= self.constants.len() {
            return ("prelude", line);
        }
        line -= self.constants.len();
        for &(path, text) in self.files {
            let lines = text.split('\n').count();
            if line <= lines {
                return (path, line);
            }
            line -= lines;
        }
        (self.name, line)
    }
}

/// Compiles a linked shader. What the compiler finds is kept for [`Gpu::wait`], each message with the file and line it is about.
pub fn shader_module(gpu: &Gpu, source: &ShaderSource) -> wgpu::ShaderModule {
    gpu.count_creation();
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(source.name),
        source: wgpu::ShaderSource::Wgsl(source.linked().into()),
    });
    let error = pollster::block_on(scope.pop());
    let found = pollster::block_on(module.get_compilation_info());
    let mut errors = found
        .messages
        .iter()
        .filter(|message| message.message_type == wgpu::CompilationMessageType::Error)
        .map(|message| {
            let line = message
                .location
                .map_or(1, |location| location.line_number as usize);
            let (path, line) = source.locate(line);
            format!("shaders/{path}:{line}: {}", message.message)
        })
        .peekable();
    if errors.peek().is_some() {
        gpu.complain(&errors.collect::<Vec<_>>().join("; "));
    } else if let Some(error) = error {
        gpu.complain(&format!("shaders/{}: {error}", source.name));
    }
    module
}
