//! What is made beforehand of a lens's ghosts: traced patterns, photographed ones, or both (KR 10-1658883, claims 2, 3 and 14).

use serde::{Deserialize, Serialize};

use super::{FlareTable, ImageTable};
use crate::camera::flare::{Aperture, Pattern};

/// Traced patterns of nonlinear ghosts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TracedPatterns {
    /// Their rays, by angle.
    Rays(FlareTable),
    /// Their images, by angle and azimuth.
    Images(ImageTable),
}

/// Patterns made beforehand; at least one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GhostTable {
    /// Traced through the prescription.
    pub traced: Option<TracedPatterns>,
    /// Taken with a camera.
    pub photographed: Option<ImageTable>,
}

/// What of a table draws a light.
#[derive(Clone, Copy, Debug)]
pub struct PlayedPatterns<'a> {
    /// Rays.
    pub rays: Option<&'a FlareTable>,
    /// Images, and whether they are photos.
    pub images: Option<(&'a ImageTable, bool)>,
    /// Which images of ghosts are then still to be made.
    pub rest: Pattern,
}

impl PlayedPatterns<'_> {
    /// Nothing made beforehand.
    pub const NONE: Self = Self {
        rays: None,
        images: None,
        rest: Pattern::Whole,
    };
}

impl GhostTable {
    /// Of rays.
    pub fn of_rays(table: FlareTable) -> Self {
        Self {
            traced: Some(TracedPatterns::Rays(table)),
            photographed: None,
        }
    }

    /// Of drawn images.
    pub fn of_images(table: ImageTable) -> Self {
        Self {
            traced: Some(TracedPatterns::Images(table)),
            photographed: None,
        }
    }

    /// Of photos.
    pub fn of_photos(table: ImageTable) -> Self {
        Self {
            traced: None,
            photographed: Some(table),
        }
    }

    /// With photos beside what it holds.
    pub fn with_photos(self, table: Option<ImageTable>) -> Self {
        Self {
            photographed: table.or(self.photographed),
            ..self
        }
    }

    /// f-number of the traced patterns.
    pub fn f_number(&self) -> Option<f64> {
        match self.traced.as_ref()? {
            TracedPatterns::Rays(table) => Some(table.f_number),
            TracedPatterns::Images(table) => table.f_number,
        }
    }

    /// Iris that is in its images; rays take any.
    pub fn aperture(&self) -> Option<Aperture> {
        match self.traced.as_ref()? {
            TracedPatterns::Rays(_) => None,
            TracedPatterns::Images(table) => table.aperture,
        }
    }

    /// Whether images are drawn, of which nothing can be fitted or blended but by adding.
    pub fn plays_images(&self, photographed: bool) -> bool {
        match &self.traced {
            Some(TracedPatterns::Rays(_)) => photographed && self.photographed.is_some(),
            _ => true,
        }
    }

    /// What draws a light at an angle, radians: the photographed patterns where they are asked for or alone, else the
    /// traced ones beside the linear ghosts. Beyond its largest angle a table holds nothing, and all is made.
    pub fn at(&self, angle: f64, photographed: bool) -> PlayedPatterns<'_> {
        let none = PlayedPatterns::NONE;
        let photos = self.photographed.as_ref();
        match (
            photos.filter(|_| photographed || self.traced.is_none()),
            &self.traced,
        ) {
            (Some(table), _) if !table.with_linear || angle <= table.max_angle() => PlayedPatterns {
                images: Some((table, true)),
                rest: Pattern::Linear,
                ..none
            },
            (None, Some(TracedPatterns::Rays(table))) if angle <= table.max_angle => PlayedPatterns {
                rays: Some(table),
                ..none
            },
            (None, Some(TracedPatterns::Images(table))) if angle <= table.max_angle() => PlayedPatterns {
                images: Some((table, false)),
                rest: Pattern::Linear,
                ..none
            },
            _ => none,
        }
    }

    pub(super) fn is_sound(&self) -> bool {
        let is_traced_sound = self.traced.as_ref().is_none_or(|traced| match traced {
            TracedPatterns::Rays(table) => table.is_sound(),
            TracedPatterns::Images(table) => table.is_sound(),
        });
        let is_empty = self.traced.is_none() && self.photographed.is_none();
        !is_empty && is_traced_sound && self.photographed.as_ref().is_none_or(ImageTable::is_sound)
    }
}
