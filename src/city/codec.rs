//! The three tile kinds as TIFF files.
//!
//! Terrain: page 1 heights (f32, samples on the tile's border included, so the raster reaches half a pixel beyond
//! the tile), pages 2.. the triangles of its TINs, the finest first (u32, 3 indices of mesh positions a row:
//! `HeightTile::mesh_parts`); [`mesh_errors`] tells how many.
//!
//! Buildings: on level 0 first roof elevation and building id per texel (what a GIS shows). Then the words of the building map,
//! outline vertices (x, y, bays, building; f32, the building's bits as they are), roofs (roof, base, fid and material as u32 bits; the
//! last row has the map's highest roof and lowest ground). On coarse levels the words have the tile's georeference.
//!
//! Imagery: one RGBA page.
//!
//! Beside the tiles `terrain/errors.tif`: how far the terrain of coarse levels departs from that of level 0, metres, page L for level L,
//! a pixel a tile.

use std::path::Path;

use super::geotiff::{GeoKeys, Page, PageReader, Pixels, damaged, write};
use super::{CityError, ImageryTile};
use crate::buildings::{BLOCK, BuildingMap, OutlineVertex, RoofRecord};
use crate::space::{Bounds, TileGrid};
use crate::terrain::{HeightTile, mesh_errors};

/// Farther from sea level than any ground that an import lets in, metres. Not a number is no ground.
const MAX_ELEVATION_M: f32 = 100_000.0;

/// Ground of one tile: heights and the meshes that carry them.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainTile {
    /// Heights.
    pub ground: HeightTile,
    /// Triangles of the TINs, as indices of mesh positions: one for each of [`mesh_errors`].
    pub meshes: Vec<Vec<[u32; 3]>>,
}

/// How the samples of a tile lie.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// Samples along a side.
    pub side: usize,
    /// Distance between them on level 0, metres.
    pub step_m: f64,
    /// Level of the tile.
    pub level: u32,
    /// West and north border of the tile, metres.
    pub corner: [f64; 2],
}

fn flipped<T: Copy>(rows: &[T], width: usize) -> Vec<T> {
    rows.chunks_exact(width).rev().flatten().copied().collect()
}

/// Writes a terrain tile.
pub fn write_terrain(
    path: &Path,
    bounds: &Bounds,
    tile: &TerrainTile,
    keys: &GeoKeys,
) -> Result<(), CityError> {
    let HeightTile {
        side,
        step_m,
        heights,
        ..
    } = &tile.ground;
    let half = 0.5 * step_m;
    let mut pages = vec![Page {
        size: [*side, *side],
        pixels: Pixels::Float(flipped(heights, *side)),
        georeference: Some([bounds.west - half, bounds.north + half, *step_m]),
        has_runs: false,
    }];
    for triangles in &tile.meshes {
        pages.push(Page {
            size: [3, triangles.len()],
            pixels: Pixels::Word(triangles.iter().flatten().copied().collect()),
            georeference: None,
            has_runs: false,
        });
    }
    write(path, &pages, keys)
}

/// Reads the heights of a terrain tile.
pub fn read_heights(path: &Path, lattice: Lattice) -> Result<HeightTile, CityError> {
    heights_of(&mut PageReader::open(path)?, path, lattice)
}

fn heights_of(reader: &mut PageReader, path: &Path, lattice: Lattice) -> Result<HeightTile, CityError> {
    let Lattice {
        side,
        step_m,
        level,
        corner: [west, north],
    } = lattice;
    let (heights, _) = reader.floats([Some(side), Some(side)])?;
    let level_step_m = step_m * f64::from(1_u32 << level);
    let half = 0.5 * level_step_m;
    reader.require_place([west - half, north + half, level_step_m])?;
    if heights.len() != side * side {
        return Err(damaged(path, "a page has more than one band".to_owned()));
    }
    if heights.iter().any(|height| height.abs() > MAX_ELEVATION_M) {
        return Err(damaged(path, "its heights are impossible".to_owned()));
    }
    Ok(HeightTile {
        side,
        level,
        step_m: level_step_m,
        heights: flipped(&heights, side),
    })
}

/// Reads a terrain tile, heights and meshes.
pub fn read_terrain(path: &Path, lattice: Lattice) -> Result<TerrainTile, CityError> {
    let mut reader = PageReader::open(path)?;
    let ground = heights_of(&mut reader, path, lattice)?;
    let positions = ground.mesh_side() * ground.mesh_side();
    let mut meshes = Vec::new();
    for _ in mesh_errors(lattice.level) {
        let (indices, _) = reader.words([Some(3), None])?;
        // No more than the regular grid over the same positions.
        if indices.len() > 6 * positions {
            return Err(damaged(path, "it has more triangles than its grid".to_owned()));
        }
        if indices.iter().any(|&index| index as usize >= positions) {
            return Err(damaged(
                path,
                "a triangle's vertex is no position of the mesh".to_owned(),
            ));
        }
        let (triangles, _) = indices.as_chunks::<3>();
        meshes.push(triangles.to_vec());
    }
    Ok(TerrainTile { ground, meshes })
}

/// Writes a building-map tile of a level.
pub fn write_buildings(
    path: &Path,
    (level, bounds): (u32, &Bounds),
    map: &BuildingMap,
    keys: &GeoKeys,
) -> Result<(), CityError> {
    let table = |columns: usize, values: Vec<u32>| Page {
        size: [columns, values.len() / columns],
        pixels: Pixels::Word(values),
        georeference: None,
        has_runs: false,
    };
    let vertices = map
        .vertices
        .iter()
        .flat_map(|v| [v.x_m.to_bits(), v.y_m.to_bits(), v.bays.to_bits(), v.building]);
    let records = map
        .roofs
        .iter()
        .flat_map(|r| [r.roof_m.to_bits(), r.base_m.to_bits(), r.fid, r.material]);
    let [lowest, highest] = map.height_range.map(f32::to_bits);
    let records = records.chain([highest, lowest, 0, 0]);
    // A TIFF page has at least one row: tables end with a row of padding.
    let padded = |mut values: Vec<u32>, columns: usize| {
        values.resize(values.len() + columns, 0);
        values
    };
    let mut pages = match level {
        0 => Vec::from(rasters(bounds, map)),
        _ => Vec::new(),
    };
    let words = Page {
        georeference: (level > 0).then_some([bounds.west, bounds.north, f64::from(map.texel_m)]),
        ..table(1, padded(map.words.clone(), 1))
    };
    pages.extend([
        words,
        table(4, padded(vertices.collect(), 4)),
        table(4, records.collect()),
    ]);
    write(path, &pages, keys)
}

/// Roof elevation and building id per texel.
fn rasters(bounds: &Bounds, map: &BuildingMap) -> [Page; 2] {
    let (mut roofs, mut fids) = (vec![f32::NAN; map.side * map.side], vec![0; map.side * map.side]);
    for ([block_x, block_y], codes) in map.occupied_blocks() {
        for (texel, &code) in codes.iter().enumerate() {
            let (x, y) = (BLOCK * block_x + texel % BLOCK, BLOCK * block_y + texel / BLOCK);
            if let Some(index) = map.roof_at_reference(code) {
                let roof = &map.roofs[index as usize];
                (roofs[y * map.side + x], fids[y * map.side + x]) = (roof.roof_m, roof.fid);
            }
        }
    }
    [
        Pixels::Float(flipped(&roofs, map.side)),
        Pixels::Word(flipped(&fids, map.side)),
    ]
    .map(|pixels| Page {
        size: [map.side, map.side],
        pixels,
        georeference: Some([bounds.west, bounds.north, f64::from(map.texel_m)]),
        has_runs: true,
    })
}

/// How the texels of a tile lie.
#[derive(Clone, Copy, Debug)]
pub struct TexelGrid {
    /// Texels along a side.
    pub side: usize,
    /// Side of a texel of level 0, metres.
    pub texel_m: f64,
    /// Level of the tile.
    pub level: u32,
    /// West and north border of the tile, metres.
    pub corner: [f64; 2],
}

/// Reads a building-map tile.
pub fn read_buildings(path: &Path, texels: TexelGrid) -> Result<BuildingMap, CityError> {
    let TexelGrid {
        side,
        level,
        corner: [west, north],
        ..
    } = texels;
    let texel_m = texels.texel_m * f64::from(1_u32 << level);
    let mut reader = PageReader::open(path)?;
    if level == 0 {
        // Roof elevations and ids follow from the rest.
        reader.skip([Some(side), Some(side)])?;
        reader.require_place([west, north, f64::from(texel_m as f32)])?;
        reader.skip([Some(side), Some(side)])?;
    }
    let mut words = reader.words([Some(1), None])?.0;
    if level > 0 {
        reader.require_place([west, north, f64::from(texel_m as f32)])?;
    }
    let mut table = || Ok::<_, CityError>(reader.words([Some(4), None])?.0);
    let (vertices, roofs) = (table()?, table()?);
    words.pop();
    let (vertices, _) = vertices.as_chunks::<4>();
    let (roofs, _) = roofs.as_chunks::<4>();
    let (Some((_, vertices)), Some((range, roofs))) = (vertices.split_last(), roofs.split_last()) else {
        return Err(damaged(path, "a table has no row".to_owned()));
    };
    let map = BuildingMap {
        side,
        texel_m: texel_m as f32,
        height_range: [range[1], range[0]].map(f32::from_bits),
        words,
        vertices: vertices
            .iter()
            .map(|&[x, y, bays, building]| OutlineVertex {
                x_m: f32::from_bits(x),
                y_m: f32::from_bits(y),
                bays: f32::from_bits(bays),
                building,
            })
            .collect(),
        roofs: roofs
            .iter()
            .map(|&[roof, base, fid, material]| RoofRecord {
                roof_m: f32::from_bits(roof),
                base_m: f32::from_bits(base),
                fid,
                material,
            })
            .collect(),
    };
    if !map.is_sound() {
        return Err(damaged(
            path,
            "its tables are not such as an import makes".to_owned(),
        ));
    }
    Ok(map)
}

/// Reads no more of a building-map tile than the range of its heights: lowest ground, highest roof, metres.
pub fn read_height_range(path: &Path, level: u32) -> Result<[f32; 2], CityError> {
    let mut reader = PageReader::open(path)?;
    let before = if level == 0 { 4 } else { 2 };
    for _ in 0..before {
        reader.skip([None, None])?;
    }
    let (roofs, _) = reader.words([Some(4), None])?;
    match roofs.as_chunks::<4>().0.last() {
        Some(&[highest, lowest, ..]) => {
            let range = [lowest, highest].map(f32::from_bits);
            match BuildingMap::is_sound_range(range) {
                true => Ok(range),
                false => Err(damaged(path, "its heights are impossible".to_owned())),
            }
        }
        None => Err(damaged(path, "a table has no row".to_owned())),
    }
}

/// Writes an orthophoto tile.
pub fn write_imagery(
    path: &Path,
    bounds: &Bounds,
    imagery: &ImageryTile,
    keys: &GeoKeys,
) -> Result<(), CityError> {
    let pixel_m = bounds.width() / imagery.side as f64;
    let page = Page {
        size: [imagery.side, imagery.side],
        pixels: Pixels::Rgba(imagery.rgba.clone()),
        georeference: Some([bounds.west, bounds.north, pixel_m]),
        has_runs: false,
    };
    write(path, &[page], keys)
}

/// Reads an orthophoto tile of `side` pixels that spans some bounds.
pub fn read_imagery(path: &Path, side: usize, bounds: &Bounds) -> Result<ImageryTile, CityError> {
    let mut reader = PageReader::open(path)?;
    let rgba = reader.rgba([Some(side), Some(side)])?;
    reader.require_place([bounds.west, bounds.north, bounds.width() / side as f64])?;
    Ok(ImageryTile { side, rgba })
}

/// Writes the errors of the coarse levels, level 1 first; rows from the south.
pub fn write_terrain_errors(
    path: &Path,
    grid: &TileGrid,
    levels: &[Vec<f32>],
    keys: &GeoKeys,
) -> Result<(), CityError> {
    let pages: Vec<Page> = (1..)
        .zip(levels)
        .map(|(level, errors)| {
            let [columns, rows] = grid.counts(level);
            let tile_m = grid.level_tile_m(level);
            Page {
                size: [columns, rows],
                pixels: Pixels::Float(flipped(errors, columns)),
                georeference: Some([grid.west, grid.south + tile_m * rows as f64, tile_m]),
                has_runs: false,
            }
        })
        .collect();
    write(path, &pages, keys)
}

/// Reads them, level 1 first.
pub fn read_terrain_errors(path: &Path, grid: &TileGrid) -> Result<Vec<Vec<f32>>, CityError> {
    let mut reader = PageReader::open(path)?;
    (1..grid.levels())
        .map(|level| {
            let [columns, rows] = grid.counts(level);
            let (errors, _) = reader.floats([Some(columns), Some(rows)])?;
            if errors.len() != columns * rows {
                return Err(damaged(path, "a page has more than one band".to_owned()));
            }
            let tile_m = grid.level_tile_m(level);
            reader.require_place([grid.west, grid.south + tile_m * rows as f64, tile_m])?;
            Ok(flipped(&errors, columns))
        })
        .collect()
}
