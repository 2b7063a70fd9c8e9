//! Anti-aliasing of a moving view (`shaders/camera/temporal.wgsl` tells how).

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Mat4, Vec4};

use super::shaders::TEMPORAL;
use crate::gpu::{
    BySize, FLOAT, Gpu, PipelineParameters, Target, UNIFORM, Uniform, color_target, shader_module, texture,
};
use crate::space::Projection;

/// Layout of `Motion` in `shaders/camera/temporal.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct Motion {
    pub clip_before: Mat4,
    pub forward: Vec4,
    pub across: Vec4,
    pub upward: Vec4,
    pub eye: Vec4,
    pub size: [f32; 2],
    pub jitter: [f32; 2],
}

impl Motion {
    /// From the view before to a jittered one; without one before, or with one of another size, nothing is kept.
    pub fn new(before: Option<&Projection>, now: &Projection) -> Self {
        let vector = |v: DVec3, w: f64| v.as_vec3().extend(w as f32);
        let tan = now.tan_half_fov();
        let before = before.filter(|before| before.size == now.size);
        let eye = before.map_or(Vec4::ZERO, |before| vector(now.pose.eye - before.pose.eye, 1.0));
        Self {
            clip_before: before.map_or(Mat4::IDENTITY, Projection::clip_from_eye_relative),
            forward: vector(now.pose.forward, 0.0),
            across: vector(now.pose.right * tan.x, 0.0),
            upward: vector(now.pose.up * tan.y, 0.0),
            eye,
            size: now.size.map(|side| side as f32),
            jitter: now.jitter.as_vec2().to_array(),
        }
    }
}

/// The pipeline, and two histories that take turns.
pub struct TemporalPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    motion: Uniform<Motion>,
    histories: BySize<Histories>,
    /// The view that the history shows, and which of the two it is.
    before: Option<Projection>,
    turn: usize,
}

struct Histories {
    targets: [Target; 2],
    /// What each is made of: the other one and a sample.
    inputs: [wgpu::BindGroup; 2],
}

impl TemporalPass {
    /// Group 0: a sample's radiance and distance, the history, the motion.
    pub const INPUT: [wgpu::BindingType; 4] = [texture(FLOAT), texture(FLOAT), texture(FLOAT), UNIFORM];
    /// Format of the histories, and of the sum that the mean is written to.
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

    /// Compiles the pipeline.
    pub fn new(gpu: &Gpu) -> Self {
        let module = shader_module(gpu, &TEMPORAL);
        let layout = gpu.layout("temporal", &Self::INPUT);
        let targets = [color_target(Self::FORMAT), color_target(Self::FORMAT)];
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "temporal",
                &module,
                &[&layout],
                &targets,
            )),
            layout,
            motion: Uniform::new(gpu, "motion"),
            histories: BySize::default(),
            before: None,
            turn: 0,
        }
    }

    /// Histories of `size` pixels of what `radiance` and `distance` will hold.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2], radiance: &Target, distance: &Target) {
        let (layout, motion) = (&self.layout, &self.motion);
        self.histories.select(size, || {
            let targets = ["history 0", "history 1"].map(|label| Target::new(gpu, label, size, Self::FORMAT));
            let input = |before: &Target| {
                let resources = [
                    radiance.binding(),
                    distance.binding(),
                    before.binding(),
                    motion.binding(),
                ];
                gpu.group("temporal", layout, &resources)
            };
            Histories {
                inputs: [input(&targets[1]), input(&targets[0])],
                targets,
            }
        });
    }

    /// The next frame keeps nothing of those before.
    pub fn forget(&mut self) {
        self.before = None;
    }

    /// Writes the mean of the frames so far into `sum`, as a sum of one sample; `now` is the sample's view.
    pub fn encode(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        now: &Projection,
        sum: &Target,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let Some(histories) = self.histories.current() else {
            return;
        };
        self.motion.write(gpu, &Motion::new(self.before.as_ref(), now));
        self.turn = 1 - self.turn;
        let clear = wgpu::Color::TRANSPARENT;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("temporal"),
            color_attachments: &[sum.cleared(clear), histories.targets[self.turn].cleared(clear)],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &histories.inputs[self.turn], &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.before = Some(Projection {
            jitter: glam::DVec2::ZERO,
            ..*now
        });
    }
}
