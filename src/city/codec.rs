//! The three tile kinds as TIFF files.
//!
//! Terrain: page 1 heights (f32, samples on the tile's border included, so the raster reaches half a pixel beyond
//! the tile), page 2 the triangles of the TIN (u32, 3 indices of mesh positions a row: `HeightTile::mesh_parts`).
//!
//! Buildings: page 1 roof elevation and page 2 building id per texel (what a GIS shows), page 3 the cell codes,
//! page 4 outline vertices (x, y, along, building; f32, the building's bits as they are), page 5 lists of cell codes,
//! page 6 roofs (roof, base, fid as u32 bits).
//!
//! Imagery: one RGBA page.

use std::path::Path;

use super::CityError;
use super::geotiff::{GeoKeys, Page, PageReader, Pixels, damaged, write};
use crate::buildings::{BuildingMap, OutlineVertex, RoofRecord};
use crate::space::Bounds;
use crate::terrain::HeightTile;

/// Ground of one tile: heights and the triangles that carry them.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainTile {
    /// Heights.
    pub ground: HeightTile,
    /// Triangles of the TIN, as indices of mesh positions.
    pub triangles: Vec<[u32; 3]>,
}

/// Imagery of one tile.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageryTile {
    /// Pixels along a side.
    pub side: usize,
    /// RGBA, rows from the north; alpha 0 without orthophoto.
    pub rgba: Vec<u8>,
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
    } = &tile.ground;
    let half = 0.5 * step_m;
    let mut pages = vec![Page {
        size: [*side, *side],
        pixels: Pixels::Float(flipped(heights, *side)),
        georeference: Some([bounds.west - half, bounds.north + half, *step_m]),
    }];
    if !tile.triangles.is_empty() {
        pages.push(Page {
            size: [3, tile.triangles.len()],
            pixels: Pixels::Word(tile.triangles.iter().flatten().copied().collect()),
            georeference: None,
        });
    }
    write(path, &pages, keys)
}

/// Reads the heights of a terrain tile of `side` samples, `step_m` apart.
pub fn read_heights(path: &Path, side: usize, step_m: f64) -> Result<HeightTile, CityError> {
    heights_of(&mut PageReader::open(path)?, path, side, step_m)
}

fn heights_of(
    reader: &mut PageReader,
    path: &Path,
    side: usize,
    step_m: f64,
) -> Result<HeightTile, CityError> {
    let (heights, _) = reader.floats([Some(side), Some(side)])?;
    if heights.len() != side * side {
        return Err(damaged(path, "a page has more than one band".to_owned()));
    }
    Ok(HeightTile {
        side,
        step_m,
        heights: flipped(&heights, side),
    })
}

/// Reads a terrain tile, heights and triangles.
pub fn read_terrain(path: &Path, side: usize, step_m: f64) -> Result<TerrainTile, CityError> {
    let mut reader = PageReader::open(path)?;
    let ground = heights_of(&mut reader, path, side, step_m)?;
    let (indices, _) = reader.words([Some(3), None])?;
    let positions = ground.mesh_side() * ground.mesh_side();
    if indices.iter().any(|&index| index as usize >= positions) {
        return Err(damaged(
            path,
            "a triangle's vertex is no position of the mesh".to_owned(),
        ));
    }
    let (triangles, _) = indices.as_chunks::<3>();
    Ok(TerrainTile {
        ground,
        triangles: triangles.to_vec(),
    })
}

/// Writes a building-map tile.
pub fn write_buildings(
    path: &Path,
    bounds: &Bounds,
    map: &BuildingMap,
    keys: &GeoKeys,
) -> Result<(), CityError> {
    let shown: Vec<Option<&RoofRecord>> = (0..map.cells.len())
        .map(|cell| {
            map.roof_at_reference(cell)
                .map(|index| &map.roofs[index as usize])
        })
        .collect();
    let roofs = shown.iter().map(|roof| roof.map_or(f32::NAN, |roof| roof.roof_m));
    let fids = shown.iter().map(|roof| roof.map_or(0, |roof| roof.fid));
    let raster = |pixels: Pixels| Page {
        size: [map.side, map.side],
        pixels,
        georeference: Some([bounds.west, bounds.north, f64::from(map.texel_m)]),
    };
    let table = |columns: usize, values: Vec<u32>| Page {
        size: [columns, values.len() / columns],
        pixels: Pixels::Word(values),
        georeference: None,
    };
    let vertices = map
        .vertices
        .iter()
        .flat_map(|v| [v.x_m.to_bits(), v.y_m.to_bits(), v.along_m.to_bits(), v.building]);
    let records = map
        .roofs
        .iter()
        .flat_map(|r| [r.roof_m.to_bits(), r.base_m.to_bits(), r.fid]);
    // A TIFF page has at least one row: every table ends with a row of padding.
    let padded = |mut values: Vec<u32>, columns: usize| {
        values.resize(values.len() + columns, 0);
        values
    };
    let pages = [
        raster(Pixels::Float(flipped(&roofs.collect::<Vec<_>>(), map.side))),
        raster(Pixels::Word(flipped(&fids.collect::<Vec<_>>(), map.side))),
        raster(Pixels::Word(flipped(&map.cells, map.side))),
        table(4, padded(vertices.collect(), 4)),
        table(1, padded(map.lists.clone(), 1)),
        table(3, padded(records.collect(), 3)),
    ];
    write(path, &pages, keys)
}

/// Reads a building-map tile of `side` texels of `texel_m` metres.
pub fn read_buildings(path: &Path, side: usize, texel_m: f64) -> Result<BuildingMap, CityError> {
    let mut reader = PageReader::open(path)?;
    let square = [Some(side), Some(side)];
    reader.floats(square)?;
    reader.words(square)?;
    let (cells, _) = reader.words(square)?;
    let mut table = |columns: usize| -> Result<Vec<u32>, CityError> {
        let (mut values, _) = reader.words([Some(columns), None])?;
        values.truncate(values.len() - columns);
        Ok(values)
    };
    let (vertices, lists, roofs) = (table(4)?, table(1)?, table(3)?);
    let (vertices, _) = vertices.as_chunks::<4>();
    let (roofs, _) = roofs.as_chunks::<3>();
    let map = BuildingMap {
        side,
        texel_m: texel_m as f32,
        cells: flipped(&cells, side),
        vertices: vertices
            .iter()
            .map(|&[x, y, along, building]| OutlineVertex {
                x_m: f32::from_bits(x),
                y_m: f32::from_bits(y),
                along_m: f32::from_bits(along),
                building,
            })
            .collect(),
        lists,
        roofs: roofs
            .iter()
            .map(|&[roof, base, fid]| RoofRecord {
                roof_m: f32::from_bits(roof),
                base_m: f32::from_bits(base),
                fid,
            })
            .collect(),
    };
    if !map.is_sound() {
        return Err(damaged(path, "an index points outside the map".to_owned()));
    }
    Ok(map)
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
    };
    write(path, &[page], keys)
}

/// Reads an orthophoto tile of `side` pixels.
pub fn read_imagery(path: &Path, side: usize) -> Result<ImageryTile, CityError> {
    let rgba = PageReader::open(path)?.rgba([Some(side), Some(side)])?;
    Ok(ImageryTile { side, rgba })
}
