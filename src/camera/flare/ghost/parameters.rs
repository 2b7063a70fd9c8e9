//! What ghosts are made of, and how.

use super::{Blend, Fit, FlareSource, Tracing, TracingDevice};
use crate::camera::flare::FlareTable;
use crate::camera::lens::Lens;
use crate::camera::path::Ghost;

/// How ghosts are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum FlareMode {
    /// Flare quads by the matrices alone.
    Paraxial,
    /// The same from two rays a ghost.
    TwoRays,
    /// Quads for nearly linear ghosts, traced rays for the others.
    Blended,
    /// Traced rays for all.
    Exact,
}

/// Which images of ghosts are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pattern {
    /// Both.
    #[default]
    Whole,
    /// The linear ones: others come out of a table of images.
    Linear,
    /// The nonlinear ones.
    Nonlinear,
}

/// How ghosts are made, and how finely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GhostParameters {
    /// Quads, traced rays, or both.
    pub mode: FlareMode,
    /// Wavelengths.
    pub wavelengths: usize,
    /// Rays along an edge of a traced grid.
    pub rays: usize,
    /// A single ghost; none for all that cross the stop once.
    pub only: Option<Ghost>,
    /// Which of its images are made.
    pub pattern: Pattern,
    /// Draw the photographed patterns of a table that holds traced ones too.
    pub photographed: bool,
    /// How linear and nonlinear ghosts come together in the blended mode.
    pub blend: Blend,
    /// What of its nonlinear ghosts is fitted to the linear ones.
    pub fit: Fit,
    /// Draw quads over the whole front of the lens, not its effective pupil alone: the same image by more work.
    pub whole_entrance: bool,
    /// What traces rays.
    pub tracing: TracingDevice,
}

/// What a mesh is made of.
#[derive(Clone, Copy)]
pub struct FlareParameters<'a> {
    /// The lens.
    pub lens: &'a Lens,
    /// The light in it.
    pub source: FlareSource,
    /// How its ghosts are made.
    pub ghosts: GhostParameters,
    /// In the blended mode, takes the place of tracing. Baked for the same lens and f-number.
    pub table: Option<&'a FlareTable>,
    /// Where rays are traced.
    pub tracing: Tracing<'a>,
}
