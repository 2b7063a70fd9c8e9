//! All facades and roofs in two array textures on the device: a layer a band of a facade, a layer a roof, the ground's, then the bands of
//! the user's own facades.

use rayon::prelude::*;

use super::canvas::{Canvas, TILE_SIZE, TileLevel, WALL_GREY};
use super::facade_painter::{FacadeBand, paint_facade};
use super::ground_painter::paint_ground;
use super::roof_painter::paint_roof;
use super::{FacadeStyle, RoofStyle};
use crate::gpu::{Gpu, GpuError, LayerPool, filled_texture};

/// Layers of facades: the roofs' stand behind them.
pub const FACADE_LAYERS: u32 = (FacadeStyle::ALL.len() * FacadeBand::ALL.len()) as u32;

/// The layer of bare ground, behind the roofs'.
pub const GROUND_LAYER: u32 = FACADE_LAYERS + RoofStyle::ALL.len() as u32;

/// Layers before those of the user's own facades.
pub const OWN_LAYERS: u32 = GROUND_LAYER + 1;

/// A facade of the user's own: its tiles, a band each, and the width of a bay, metres.
pub struct OwnTiles {
    /// In the order of `FacadeBand::ALL`.
    pub bands: [Canvas; FacadeBand::ALL.len()],
    /// The width that a bay comes near to.
    pub bay_m: f64,
}

/// All tiles with their levels, layer by layer, the user's own behind the others.
pub fn painted_tiles(own: &[OwnTiles]) -> Vec<Vec<TileLevel>> {
    let facades = FacadeStyle::ALL
        .iter()
        .flat_map(|&style| FacadeBand::ALL.map(|band| (style, band)));
    let facades: Vec<_> = facades.collect();
    let painted = facades
        .into_par_iter()
        .map(|(style, band)| paint_facade(style, band));
    let painted = painted.chain(RoofStyle::ALL.into_par_iter().map(paint_roof));
    let painted = painted.chain(rayon::iter::once(()).map(|()| paint_ground()));
    let mut tiles: Vec<_> = painted.map(|canvas: Canvas| canvas.levels()).collect();
    tiles.extend(own.iter().flat_map(|facade| &facade.bands).map(Canvas::levels));
    tiles
}

/// The textures.
pub struct MaterialTextures {
    /// Reflectance and glass, a layer a tile.
    pub colour: LayerPool,
    /// Slopes and tint, a layer a tile.
    pub detail: LayerPool,
    /// The colours that walls have, and the width of a bay, metres: a row a kind of facade.
    pub palette: wgpu::TextureView,
}

impl MaterialTextures {
    /// Uploads what [`painted_tiles`] gives.
    ///
    /// # Errors
    /// When the device cannot hold them.
    pub fn new(gpu: &Gpu, tiles: &[Vec<TileLevel>], own: &[OwnTiles]) -> Result<Self, GpuError> {
        let size = TILE_SIZE.map(|side| side as u32);
        let levels = tiles.first().map_or(1, Vec::len) as u32;
        let pool = |label, format| LayerPool::new(gpu, label, format, size, levels);
        let mut colour = pool("facade colours", wgpu::TextureFormat::Rgba8UnormSrgb)?;
        let mut detail = pool("facade details", wgpu::TextureFormat::Rgba8Unorm)?;
        for pool in [&mut colour, &mut detail] {
            pool.reserve(gpu, tiles.len() as u32)?;
        }
        for tile in tiles {
            let layers = [colour.take(gpu)?.0, detail.take(gpu)?.0];
            for (level, texels) in (0..).zip(tile) {
                colour.write(gpu, layers[0], level, &texels.colour);
                detail.write(gpu, layers[1], level, &texels.detail);
            }
        }
        let painted = FacadeStyle::ALL
            .iter()
            .flat_map(|style| style.colours().map(|[r, g, b]| [r, g, b, style.bay_m() as f32]));
        let pictured = own
            .iter()
            .flat_map(|facade| [[WALL_GREY, WALL_GREY, WALL_GREY, facade.bay_m as f32]; 4]);
        let colours: Vec<[f32; 4]> = painted.chain(pictured).collect();
        let rows = [4, (FacadeStyle::ALL.len() + own.len()) as u32];
        let format = wgpu::TextureFormat::Rgba32Float;
        Ok(Self {
            colour,
            detail,
            palette: filled_texture(gpu, "facade palette", rows, format, &colours),
        })
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        [&self.colour, &self.detail]
            .map(|pool| u64::from(pool.count()) * pool.image_bytes())
            .iter()
            .sum()
    }
}
