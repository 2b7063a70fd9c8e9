//! The guessed streets on the device: remade when the tiles round the eye or its place on the lattice change.

use std::time::{Duration, Instant};

use glam::{DVec2, Vec4};
use half::f16;

use super::clearance::CLEARANCE_STEP_M;
use super::strips::{KERB_STEP_M, OUTSIDE_M};
use super::{Footprints, STREET_CELLS, STREET_LEVELS, SeenBlocks, Streets};
use crate::gpu::{Gpu, GpuError, LayerPool};
use crate::relief::beside_frames::BesideFrames;
use crate::scene::{Frustum, Resident};
use crate::space::Projection;

/// Streets, and what they are of.
pub struct StreetsTexture {
    /// A layer a level, twice where frames do not wait: those that are shown, and those that are written beside them.
    pub images: LayerPool,
    /// The first layer of those that are shown.
    first_layer: u32,
    /// What is written a level at a time, and how many levels of it are.
    writing: Option<(Key, Made, u32)>,
    streets: Option<(Key, Streets)>,
    job: BesideFrames<Key, Made>,
    /// When the last ones were begun beside the frames.
    begun: Option<Instant>,
    /// What was asked for last: the tiles, the centre; whether it is not there yet.
    place: Option<(u64, DVec2)>,
    is_pending: bool,
    /// Whether the last frame asked for any.
    is_shown: bool,
    /// Counts how often other ones came to be shown.
    version: u64,
}

/// What a frame wants of them.
#[derive(Clone, Copy, Debug)]
pub struct StreetsRequest<'a> {
    /// The view.
    pub view: &'a Projection,
    /// Whether streets are shown.
    pub is_shown: bool,
    /// Whether imagery is not.
    pub hides_imagery: bool,
    /// Whether an image is drawn of which some bands are still to come.
    pub is_amid_image: bool,
}

/// Footprints; centre; what is seen.
type Key = (Footprints, DVec2, SeenBlocks);
/// Streets, and their levels as texels.
type Made = (Streets, Vec<Vec<[f16; 4]>>);

/// Layers of one place's streets.
const LAYERS: u32 = STREET_LEVELS as u32;
/// Where frames do not wait, streets are made anew so often at most.
const EVERY: Duration = Duration::from_millis(400);

fn make((footprints, centre, seen): &Key) -> Made {
    let streets = Streets::new(footprints, *centre, seen);
    let levels = streets.levels().iter().map(|cells| texels(cells)).collect();
    (streets, levels)
}

/// Whether streets of one are those of another, as far as that is seen.
fn serves((footprints, centre, seen): &Key, other: &Key) -> bool {
    *centre == other.1 && footprints.is_same(&other.0) && seen.covers(&other.2)
}

impl StreetsTexture {
    /// None yet. `streams`: frames do not wait.
    ///
    /// # Errors
    /// When the device cannot hold them.
    pub fn new(gpu: &Gpu, streams: bool) -> Result<Self, GpuError> {
        let format = wgpu::TextureFormat::Rgba16Float;
        let mut images = LayerPool::new(gpu, "streets", format, [STREET_CELLS as u32; 2], 1)?;
        images.reserve(gpu, LAYERS * (1 + u32::from(streams)))?;
        Ok(Self {
            images,
            first_layer: 0,
            writing: None,
            streets: None,
            job: BesideFrames::default(),
            begun: None,
            place: None,
            is_pending: false,
            is_shown: false,
            version: 0,
        })
    }

    /// Makes them for a frame, where ground is bare. Where frames do not wait, beside them: until they are there, and while an image is
    /// amid its bands, the last ones serve.
    pub fn prepare(&mut self, gpu: &Gpu, resident: &Resident, request: StreetsRequest<'_>) {
        self.is_shown = request.is_shown && (resident.has_bare_ground || request.hides_imagery);
        if !self.is_shown {
            (self.is_pending, self.place) = (false, None);
            return;
        }
        let centre = Streets::centre_of(&resident.tiles.grid, request.view.pose.eye.truncate());
        let place = (resident.version(), centre);
        let seen = if resident.streams() {
            SeenBlocks::ALL
        } else {
            SeenBlocks::from_view(
                &Frustum::new(request.view),
                centre,
                resident.tiles.bounds.heights(),
            )
        };
        let is_seen = |of: &Key| of.2.covers(&seen);
        let has_all = self.streets.as_ref().is_some_and(|(of, _)| is_seen(of));
        if self.place == Some(place) && !self.is_pending && has_all {
            return;
        }
        self.place = Some(place);
        let footprints = Footprints {
            grid: resident.tiles.grid,
            masks: resident.tiles.standing_footprints().collect(),
        };
        let key = (footprints.within(centre, Streets::extent_m()), centre, seen);
        let is_made = |made: &Option<(Key, Streets)>| made.as_ref().is_some_and(|(of, _)| serves(of, &key));
        self.is_pending = !is_made(&self.streets);
        if !self.is_pending {
            return;
        }
        if !resident.streams() {
            // The first image does not wait for what it does not show; those after it may be of anything round the eye.
            let key = if self.streets.is_none() {
                key
            } else {
                (key.0, key.1, SeenBlocks::ALL)
            };
            let made = make(&key);
            self.is_pending = false;
            return self.take(gpu, key, made);
        }
        if request.is_amid_image {
            return;
        }
        if self.writing.is_none() {
            self.writing = self.job.finished().map(|(of, made)| (of, made, 0));
        }
        if let Some(of) = self.write_a_level(gpu) {
            self.is_pending = !serves(&of, &key);
        }
        let is_due = self.begun.is_none_or(|begun| begun.elapsed() >= EVERY);
        if self.is_pending && self.writing.is_none() && !self.job.is_busy() && is_due {
            self.begun = Some(Instant::now());
            let of = key.clone();
            self.job.begin(key, move || make(&of));
        }
    }

    fn take(&mut self, gpu: &Gpu, of: Key, (streets, levels): Made) {
        for (level, texels) in (0..).zip(&levels) {
            self.images.write(gpu, self.first_layer + level, 0, texels);
        }
        self.version += 1;
        self.streets = Some((of, streets));
    }

    /// Writes a level of what was made beside the frames: all at once would be felt. What it is of when that was the last, and it is shown.
    fn write_a_level(&mut self, gpu: &Gpu) -> Option<Key> {
        let (of, (streets, levels), written) = self.writing.take()?;
        let beside = LAYERS - self.first_layer;
        if let Some(texels) = levels.get(written as usize) {
            self.images.write(gpu, beside + written, 0, texels);
        }
        if written + 1 < LAYERS {
            self.writing = Some((of, (streets, levels), written + 1));
            return None;
        }
        self.first_layer = beside;
        self.version += 1;
        self.streets = Some((of.clone(), streets));
        Some(of)
    }

    /// What shaders take for an eye in plan: the grid, no levels where none are shown, and the first layer.
    pub fn uniforms(&self, eye: DVec2) -> (Vec4, u32) {
        let shown = self.streets.as_ref().filter(|_| self.is_shown);
        let grid = shown.map_or(Vec4::ZERO, |(_, streets)| streets.uniform(eye));
        (grid, self.first_layer)
    }

    /// A number that changes when other ones are shown.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// True while the ones that the last frame asked for are not there yet.
    pub fn is_pending(&self) -> bool {
        self.is_pending
    }
}

/// Metres from the kerb, half the way between fronts, clearance. Of more digits than the cells have, because kerbs run where they are
/// interpolated.
fn texels(cells: &[[u8; 3]]) -> Vec<[f16; 4]> {
    let table = |from: f64, step: f64| -> [f16; 256] {
        std::array::from_fn(|byte| f16::from_f64(from + byte as f64 * step))
    };
    let (kerbs, metres) = (table(-OUTSIDE_M, KERB_STEP_M), table(0.0, CLEARANCE_STEP_M));
    let texel = |&[from_kerb, half, clear]: &[u8; 3]| {
        let [half, clear] = [half, clear].map(|byte| metres[usize::from(byte)]);
        [kerbs[usize::from(from_kerb)], half, clear, f16::ZERO]
    };
    cells.iter().map(texel).collect()
}
