//! The coarse levels of the quadtree, each from the one below.

use std::collections::HashMap;
use std::sync::Mutex;

use rayon::prelude::*;

use super::plan::Plan;
use crate::buildings::coarser;
use crate::city::codec::{TexelGrid, read_buildings, write_terrain_errors};
use crate::city::writer::TileWriter;
use crate::city::{CityError, ImageryTile, Layer, TerrainTile, Tile};
use crate::space::TileId;
use crate::terrain::{coarser_ground, meshes_alone};
use indicatif::ProgressBar;

/// What the levels are made with.
pub struct LevelParameters {
    /// Texels along a building-map tile's side.
    pub tile_texels: usize,
    /// Side of a texel of level 0, metres.
    pub texel_m: f64,
    /// Pixels along an orthophoto tile's side, 0 without orthophotos.
    pub imagery_side: usize,
    /// Bound on the error of the finest mesh, metres.
    pub terrain_error_m: f64,
}

/// Makes every tile of the coarse levels.
pub fn make_levels(
    plan: &Plan,
    parameters: &LevelParameters,
    writer: &TileWriter<'_>,
    bar: &ProgressBar,
) -> Result<(), CityError> {
    let grid = &plan.grid;
    let levels = 1..grid.levels();
    let count = levels
        .clone()
        .map(|level| grid.tiles_of_level(level).count() as u64);
    bar.set_length(count.sum());
    let mut all_errors = Vec::new();
    // Of the level below, by tile.
    let mut errors_below: HashMap<TileId, f32> = HashMap::new();
    for level in levels {
        for layer in Layer::ALL {
            let path = layer.level_path(writer.folder, level);
            std::fs::create_dir_all(&path).map_err(CityError::file(&path))?;
        }
        let tiles: Vec<TileId> = grid.tiles_of_level(level).collect();
        let errors = Mutex::new(HashMap::new());
        tiles.par_iter().try_for_each(|&id| -> Result<(), CityError> {
            let children = grid.children(id);
            let terrain = parent_terrain(children, parameters, writer);
            if let Some((_, error)) = &terrain {
                let below = children.iter().filter_map(|child| errors_below.get(child));
                let error = error + below.copied().fold(0.0, f32::max);
                if let Ok(mut errors) = errors.lock() {
                    errors.insert(id, error);
                }
            }
            let map = parent_map(id, children, parameters, writer)?;
            let imagery = parent_imagery(children, parameters, writer);
            let tile = Tile::new(id, terrain.map(|(terrain, _)| terrain), map, imagery);
            writer.put(&tile, &Layer::ALL)?;
            bar.inc(1);
            Ok(())
        })?;
        errors_below = errors.into_inner().unwrap_or_default();
        let error_of = |id: &TileId| errors_below.get(id).copied().unwrap_or(f32::NAN);
        all_errors.push(tiles.iter().map(error_of).collect::<Vec<f32>>());
    }
    bar.finish_and_clear();
    match all_errors.is_empty() {
        true => Ok(()),
        false => write_terrain_errors(
            &Layer::Terrain.errors_path(writer.folder),
            grid,
            &all_errors,
            writer.keys,
        ),
    }
}

fn parent_terrain(
    children: [TileId; 4],
    parameters: &LevelParameters,
    writer: &TileWriter<'_>,
) -> Option<(TerrainTile, f32)> {
    let children = children.map(|child| writer.terrain(child));
    let grounds = children
        .each_ref()
        .map(|child| child.as_ref().map(|child| &child.ground));
    let (ground, error) = coarser_ground(grounds)?;
    ground.range()?;
    let meshes = meshes_alone(&ground, parameters.terrain_error_m);
    Some((TerrainTile { ground, meshes }, error))
}

fn parent_map(
    id: TileId,
    children: [TileId; 4],
    parameters: &LevelParameters,
    writer: &TileWriter<'_>,
) -> Result<Option<crate::buildings::BuildingMap>, CityError> {
    let read = |child| {
        let texels = TexelGrid {
            side: parameters.tile_texels,
            texel_m: parameters.texel_m,
            level: id.level - 1,
            corner: writer.corner(child),
        };
        let path = writer.path(Layer::Buildings, child);
        let exists = path.exists();
        exists.then(|| read_buildings(&path, texels))
    };
    let mut maps = [const { None }; 4];
    for (map, child) in maps.iter_mut().zip(children) {
        *map = read(child).transpose()?;
    }
    coarser(maps.each_ref().map(Option::as_ref)).map_err(|source| CityError::TileTooLarge {
        path: writer.path(Layer::Buildings, id),
        place: writer.grid.tile_bounds(id).centre(),
        source,
    })
}

fn parent_imagery(
    children: [TileId; 4],
    parameters: &LevelParameters,
    writer: &TileWriter<'_>,
) -> Option<ImageryTile> {
    if parameters.imagery_side == 0 {
        return None;
    }
    let children = children.map(|child| writer.imagery(child, parameters.imagery_side));
    ImageryTile::coarser(children.each_ref().map(Option::as_ref))
}
