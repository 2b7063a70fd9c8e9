//! Targets on which ghosts are softened: texels that double from level to level, each with a margin so that what lies beside the
//! image softens into it. What is softened on the sensor is drawn on texels half as large as its level's.
//!
//! ```text
//! ghosts softened in the iris ─────────────────────────▶ sum (level) ─┐
//! a class of others ─▶ ghosts ─▶ resample ─▶ soften ───▶ sum (level) ─┤
//!                                        sum (level) ─▶ resample ─────┴▶ sum (level - 1) ─▶ … ─▶ image
//! ```

use glam::DVec2;

use super::ghost_frame::FlareFrame;
use super::guard_band::{guard_sides, set_guard_band};
use super::resources::Resources;
use super::soft_masks::IrisMasks;
use super::soft_plan::{SoftClass, SoftPlan};
use crate::camera::shaders::{RESAMPLE, SOFTEN};
use crate::gpu::{Gpu, Target, Uniform, shader_module};

/// Texels of a level's margin: more than the radius of any class but those of the last level.
pub const SOFT_MARGIN: u32 = 8;
/// Most doublings of the texels.
const MAX_LEVEL: u32 = 6;
/// Least pixels of an image at its last level.
const MIN_SIDE: u32 = 8;
/// Format of the targets.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The pipelines.
pub struct SoftPipelines {
    soften: wgpu::RenderPipeline,
    resample: wgpu::RenderPipeline,
}

impl SoftPipelines {
    /// Compiles them.
    pub fn new(gpu: &Gpu, resources: &Resources) -> Self {
        let pipeline = |source| {
            let module = shader_module(gpu, source);
            resources.image_pipeline(gpu, &module)
        };
        Self {
            soften: pipeline(&SOFTEN),
            resample: pipeline(&RESAMPLE),
        }
    }
}

/// One size of texel.
struct Level {
    /// Ghosts of one class at a time.
    ghosts: Target,
    ghosts_input: wgpu::BindGroup,
    /// The same on the level's own texels; at level 0 they are on those.
    resampled: Option<(Target, wgpu::BindGroup)>,
    /// What the ghosts' target shows.
    frame: Uniform<FlareFrame>,
    frame_input: wgpu::BindGroup,
    /// Softened ghosts; at level 0 they go to the image itself.
    sum: Option<(Target, wgpu::BindGroup)>,
    /// Pixels of the image from its top left to the target's, negative; and of a texel of the ghosts' target.
    start_px: f64,
    texel_px: f64,
}

/// What is drawn, with what, and on what.
#[derive(Clone, Copy)]
pub struct SoftTask<'a> {
    /// The pipelines.
    pub pipelines: &'a SoftPipelines,
    /// How each ghost is drawn.
    pub plan: &'a SoftPlan,
    /// Keeps what it holds.
    pub image: &'a Target,
}

/// The levels of an image.
pub struct SoftLevels {
    levels: Vec<Level>,
    size: [u32; 2],
}

impl SoftLevels {
    /// For an image of `size` pixels and an iris.
    pub fn new(gpu: &Gpu, resources: &Resources, size: [u32; 2], masks: &IrisMasks) -> Self {
        let least = size[0].min(size[1]);
        let count = (0..=MAX_LEVEL).take_while(|level| least >> level >= MIN_SIDE || *level == 0);
        let levels = count.map(|level| {
            let whole = size.map(|side| side.div_ceil(1 << level) + 2 * SOFT_MARGIN);
            let drawn = if level == 0 {
                whole
            } else {
                whole.map(|side| 2 * side)
            };
            let ghosts = Target::new(gpu, "ghosts", drawn, FORMAT);
            let frame = Uniform::new(gpu, "ghosts");
            let whole_target = |name| {
                (level > 0).then(|| {
                    let target = Target::new(gpu, name, whole, FORMAT);
                    let input = resources.image_group(gpu, &target.view);
                    (target, input)
                })
            };
            Level {
                resampled: whole_target("resampled ghosts"),
                ghosts_input: resources.image_group(gpu, &ghosts.view),
                ghosts,
                frame_input: resources.ghost_group(gpu, frame.binding(), masks),
                frame,
                sum: whole_target("soft ghosts"),
                start_px: -f64::from(SOFT_MARGIN << level),
                texel_px: f64::from(1_u32 << level.saturating_sub(1)),
            }
        });
        Self {
            levels: levels.collect(),
            size,
        }
    }

    /// The coarsest.
    pub fn max_level(&self) -> u32 {
        self.levels.len() as u32 - 1
    }

    /// Writes what each level's target shows of the sensor, for an image that shows `frame`.
    pub fn set_frame(&self, gpu: &Gpu, frame: &FlareFrame) {
        for level in &self.levels {
            let texels = level.ghosts.texture.size();
            let extent_px = [texels.width, texels.height].map(|side| f64::from(side) * level.texel_px);
            let part = |axis: usize| {
                let half_mm = f64::from(frame.half_mm[axis]);
                let mm_per_px = 2.0 * half_mm / f64::from(self.size[axis]);
                let centre_px = level.start_px + 0.5 * extent_px[axis];
                (0.5 * extent_px[axis] * mm_per_px, centre_px * mm_per_px - half_mm)
            };
            let ((half_x, x), (half_y, down)) = (part(0), part(1));
            let shown = FlareFrame {
                half_mm: [half_x as f32, half_y as f32],
                centre_mm: [x as f32, -down as f32],
                ..*frame
            };
            level
                .frame
                .write(gpu, &shown.guarded(guard_sides(level.ghosts.size())));
        }
    }

    /// Draws all that is drawn on larger texels or softened on the sensor onto the task's image. `draw` draws ghosts; their group is set. `begin` is given to the first of the passes; what is left of it comes back.
    pub fn encode<'a>(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        SoftTask {
            pipelines,
            plan,
            image,
        }: SoftTask<'_>,
        draw: impl Fn(&mut wgpu::RenderPass<'_>, &[usize]),
        mut begin: Option<wgpu::RenderPassTimestampWrites<'a>>,
    ) -> Option<wgpu::RenderPassTimestampWrites<'a>> {
        let mut pass_on = |encoder: &mut wgpu::CommandEncoder,
                           attachment: Option<wgpu::RenderPassColorAttachment<'_>>,
                           body: &dyn Fn(&mut wgpu::RenderPass<'_>)| {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("soft ghosts"),
                color_attachments: &[attachment],
                timestamp_writes: begin.take(),
                ..Default::default()
            });
            body(&mut pass);
        };
        // The image keeps what it holds.
        let mut is_drawn: Vec<bool> = (0..self.levels.len()).map(|index| index == 0).collect();
        for index in (0..self.levels.len()).rev() {
            let level = &self.levels[index];
            let onto = level.sum.as_ref().map_or(image, |(sum, _)| sum);
            let in_iris = &plan.in_iris[index];
            if index > 0 && !in_iris.is_empty() {
                let attachment = onto.begun(&mut is_drawn[index]);
                pass_on(encoder, attachment, &|pass| {
                    pass.set_bind_group(0, &level.frame_input, &[]);
                    set_guard_band(pass, onto, guard_sides(level.ghosts.size()));
                    draw(pass, in_iris);
                });
            }
            let of_level = |class: &&SoftClass| class.level as usize == index;
            for class in plan.on_sensor.iter().filter(of_level) {
                pass_on(encoder, level.ghosts.cleared(wgpu::Color::TRANSPARENT), &|pass| {
                    pass.set_bind_group(0, &level.frame_input, &[]);
                    set_guard_band(pass, &level.ghosts, guard_sides(level.ghosts.size()));
                    draw(pass, &class.ghosts);
                });
                let (origin, margin, input) = match &level.resampled {
                    None => ([0.0, 1.0], SOFT_MARGIN, &level.ghosts_input),
                    Some((_, input)) => ([level.start_px, 2.0 * level.texel_px], 0, input),
                };
                let draw_parts = |pass: &mut wgpu::RenderPass<'_>, instance: u32| {
                    for part in &class.parts {
                        if confine(pass, part, onto, origin) {
                            pass.draw(0..3, instance..instance + 1);
                        }
                    }
                };
                if let Some((resampled, _)) = &level.resampled {
                    pass_on(encoder, resampled.cleared(wgpu::Color::TRANSPARENT), &|pass| {
                        pass.set_pipeline(&pipelines.resample);
                        pass.set_bind_group(0, &level.ghosts_input, &[]);
                        draw_parts(pass, 1 << 31);
                    });
                }
                let attachment = onto.begun(&mut is_drawn[index]);
                pass_on(encoder, attachment, &|pass| {
                    pass.set_pipeline(&pipelines.soften);
                    pass.set_bind_group(0, input, &[]);
                    let radius = (256.0 * class.radius).round().min(65535.0) as u32;
                    draw_parts(pass, radius | margin << 16);
                });
            }
            // What is now whole goes to texels half as large.
            if let Some((_, input)) = level.sum.as_ref().filter(|_| is_drawn[index] && index > 0) {
                let finer = &self.levels[index - 1];
                let (onto, margin) = finer
                    .sum
                    .as_ref()
                    .map_or((image, 0), |(sum, _)| (sum, SOFT_MARGIN));
                let attachment = onto.begun(&mut is_drawn[index - 1]);
                pass_on(encoder, attachment, &|pass| {
                    pass.set_pipeline(&pipelines.resample);
                    pass.set_bind_group(0, input, &[]);
                    pass.draw(0..3, margin..margin + 1);
                });
            }
        }
        begin
    }
}

/// Lets a pass draw on a part of a target only, between least and greatest pixels of the image; the target begins at a pixel, and its
/// texels are so many pixels large. False when the target shows nothing of it.
fn confine(
    pass: &mut wgpu::RenderPass<'_>,
    bounds: &[DVec2; 2],
    target: &Target,
    [start_px, texel_px]: [f64; 2],
) -> bool {
    let size = target.texture.size();
    let size = DVec2::new(f64::from(size.width), f64::from(size.height));
    let [min, max] = bounds.map(|px| (px - start_px) / texel_px);
    let [min, max] = [min.floor(), max.ceil()].map(|texel| texel.clamp(DVec2::ZERO, size));
    let extent = max - min;
    let is_shown = extent.min_element() > 0.0;
    if is_shown {
        let (min, extent) = (min.as_uvec2(), extent.as_uvec2());
        pass.set_scissor_rect(min.x, min.y, extent.x, extent.y);
    }
    is_shown
}
