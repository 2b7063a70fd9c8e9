//! The ground drawn as a plan where there is no orthophoto: roads, rails, water and green, in the imagery tiles.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

use resvg::tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

use super::clipped_ring::clipped_ring;
use crate::city::{CityError, ImageryTile};
use crate::source::{GroundRules, PlanFeature, PlanKind, read_plan};
use crate::space::{Bounds, Crs, TileGrid, TileId};

/// Size of a plan's pixel, metres, where no orthophoto asks for another.
pub const PLAN_PIXEL_M: f64 = 0.5;

/// Opacity of what is drawn: less than an orthophoto's, so that roofs, which an orthophoto shows as well, do not take it
/// (`shaders/relief/light.wgsl`).
const OPACITY: u8 = 224;

/// The ground where nothing is drawn, sRGB: about what `shaders/lib/bare_ground.wgsl` shows between houses.
const BARE: [u8; 3] = [0x9b, 0x98, 0x8e];

/// Files to draw.
#[derive(Clone, Debug, Default)]
pub struct PlanFiles {
    /// Streets and paths.
    pub roads: Vec<PathBuf>,
    /// Railways.
    pub rails: Vec<PathBuf>,
    /// Rivers and lakes.
    pub water: Vec<PathBuf>,
    /// Parks and woods.
    pub green: Vec<PathBuf>,
    /// How they are drawn.
    pub rules: GroundRules,
}

impl PlanFiles {
    /// All of them, in the order in which they are drawn.
    pub fn all(&self) -> impl Iterator<Item = (PlanKind, &PathBuf)> {
        let kinds = [
            (PlanKind::Green, &self.green),
            (PlanKind::Water, &self.water),
            (PlanKind::Rail, &self.rails),
            (PlanKind::Road, &self.roads),
        ];
        kinds
            .into_iter()
            .flat_map(|(kind, files)| files.iter().map(move |file| (kind, file)))
    }
}

/// Features by the tiles that they meet.
pub struct GroundPlan {
    rules: GroundRules,
    features: Vec<PlanFeature>,
    by_tile: BTreeMap<TileId, Vec<usize>>,
    grid: TileGrid,
}

impl GroundPlan {
    /// Reads the files; none without any.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn read(files: &PlanFiles, city: &Crs, grid: TileGrid) -> Result<Option<Self>, CityError> {
        let mut features: Vec<PlanFeature> = Vec::new();
        for (kind, file) in files.all() {
            features.extend(read_plan(file, (kind, &files.rules), (city, &grid.bounds()))?);
        }
        if features.is_empty() {
            return Ok(None);
        }
        // Wide roads over narrow ones.
        features.sort_by(|a, b| {
            let width = |feature: &PlanFeature| feature.width_m.unwrap_or(0.0);
            a.kind.cmp(&b.kind).then(width(a).total_cmp(&width(b)))
        });
        let mut by_tile: BTreeMap<TileId, Vec<usize>> = BTreeMap::new();
        for (index, feature) in features.iter().enumerate() {
            for tile in grid.tiles_meeting(&feature.bounds()) {
                by_tile.entry(tile).or_default().push(index);
            }
        }
        Ok(Some(Self {
            rules: files.rules.clone(),
            features,
            by_tile,
            grid,
        }))
    }

    /// Whether something is drawn on a tile.
    pub fn meets(&self, id: TileId) -> bool {
        self.by_tile.contains_key(&id)
    }

    /// Draws a tile of `side` pixels under its orthophoto, if it has one.
    pub fn under(&self, id: TileId, side: usize, orthophoto: Option<ImageryTile>) -> Option<ImageryTile> {
        let Some(features) = self.by_tile.get(&id) else {
            return orthophoto;
        };
        let bounds = self.grid.tile_bounds(id);
        let mut pixels = Pixmap::new(side as u32, side as u32)?;
        for &index in features {
            draw(&mut pixels, &self.features[index], &self.rules, &bounds);
        }
        let mut rgba: Vec<u8> = Vec::with_capacity(4 * side * side);
        for pixel in pixels.pixels() {
            let colour = pixel.demultiply();
            let alpha = u32::from(colour.alpha()) * u32::from(OPACITY) / 255;
            // What is not drawn has the ground's colour, for what is read between it and a line.
            let [r, g, b] = if alpha > 0 {
                [colour.red(), colour.green(), colour.blue()]
            } else {
                BARE
            };
            rgba.extend([r, g, b, alpha as u8]);
        }
        if let Some(orthophoto) = orthophoto {
            for (under, over) in rgba.chunks_exact_mut(4).zip(orthophoto.rgba.chunks_exact(4)) {
                if over[3] > 0 {
                    under.copy_from_slice(over);
                }
            }
        }
        Some(ImageryTile { side, rgba })
    }
}

fn draw(pixels: &mut Pixmap, feature: &PlanFeature, rules: &GroundRules, bounds: &Bounds) {
    let scale = f64::from(pixels.width()) / bounds.width();
    let mut builder = PathBuilder::new();
    let pixel_m = 1.0 / scale;
    let around = bounds.grown(2.0 * pixel_m);
    for part in &feature.parts {
        let part = match feature.width_m {
            None => Cow::Owned(clipped_ring(part, &around)),
            Some(_) => Cow::Borrowed(part),
        };
        for (index, point) in part.iter().enumerate() {
            let [x, y] =
                [(point.x - bounds.west) * scale, (bounds.north - point.y) * scale].map(|value| value as f32);
            if index == 0 {
                builder.move_to(x, y);
            } else {
                builder.line_to(x, y);
            }
        }
        if feature.width_m.is_none() && !part.is_empty() {
            builder.close();
        }
    }
    let Some(path) = builder.finish() else { return };
    let Some(width_m) = feature.width_m else {
        let paint = paint_of(feature.colour);
        pixels.fill_path(&path, &paint, FillRule::EvenOdd, Transform::identity(), None);
        return;
    };
    let width = width_m * scale;
    let (roads, rail) = (&rules.roads, &rules.rail);
    match feature.kind {
        PlanKind::Road if width_m >= roads.pavements_from_m => {
            stroke(pixels, &path, width, roads.pavement.0);
            stroke(pixels, &path, 0.68 * width, roads.carriageway.0);
            if width_m >= roads.line_from_m {
                stroke(pixels, &path, (0.18 * scale).max(0.4), roads.line.0);
            }
        }
        PlanKind::Road => stroke(pixels, &path, width, roads.path.0),
        PlanKind::Rail => {
            stroke(pixels, &path, width, rail.bed.0);
            stroke(pixels, &path, 0.45 * width, rail.track.0);
        }
        PlanKind::Water | PlanKind::Green => stroke(pixels, &path, width, feature.colour),
    }
}

fn paint_of([r, g, b]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

fn stroke(pixels: &mut Pixmap, path: &Path, width: f64, colour: [u8; 3]) {
    let stroke = Stroke {
        width: width as f32,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    pixels.stroke_path(path, &paint_of(colour), &stroke, Transform::identity(), None);
}
