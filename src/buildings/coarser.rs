//! The building map of a coarser level, from four of the level below.
//!
//! A texel there is a column: one roof, at its true elevation, and how much of the texel buildings cover. What covers less than half
//! does not show, but counts in the next level: small buildings go by area, not by how they lie on the raster.

use super::BuildingMap;
use super::cell::{CellKind, Full};
use super::map::{BLOCK, RoofRecord};
use super::rasterise::{CellRaster, MapTooLarge};

/// Coverages are multiples of it: a seventh of the whole.
const COVERAGE_STEP: u32 = Full::WHOLE / 7;

/// Part of a column: index of a building among those of all children, how much it covers of its quarter of the texel.
#[derive(Clone, Copy, Default)]
struct Part {
    building: u32,
    coverage: u32,
}

/// The map over four maps of `side` texels a side (south-west, south-east, north-west, north-east; none where no building stands);
/// none without any.
///
/// # Errors
/// When it has more words than a code can count.
pub fn coarser(children: [Option<&BuildingMap>; 4]) -> Result<Option<BuildingMap>, MapTooLarge> {
    let Some(first) = children.iter().flatten().next() else {
        return Ok(None);
    };
    let (side, texel_m) = (first.side, 2.0 * first.texel_m);
    let mut roofs: Vec<RoofRecord> = children
        .iter()
        .flatten()
        .flat_map(|map| map.roofs.clone())
        .collect();
    roofs.sort_by_key(|roof| roof.fid);
    roofs.dedup_by_key(|roof| roof.fid);
    let half = side / 2;
    // The parts of every texel's column, one a quarter.
    let mut columns = vec![[Part::default(); 4]; side * side];
    for (quadrant, map) in children.iter().enumerate() {
        let Some(map) = map else { continue };
        let index: Vec<u32> = (map.roofs.iter())
            .map(|roof| roofs.partition_point(|other| other.fid < roof.fid) as u32)
            .collect();
        let origin = [half * (quadrant % 2), half * (quadrant / 2)];
        for ([block_x, block_y], codes) in map.occupied_blocks() {
            for (texel, &code) in codes.iter().enumerate() {
                let Some((building, coverage)) = covered(map, code) else {
                    continue;
                };
                let [x, y] = [BLOCK * block_x + texel % BLOCK, BLOCK * block_y + texel / BLOCK];
                let cell = (origin[1] + y / 2) * side + origin[0] + x / 2;
                columns[cell][x % 2 + 2 * (y % 2)] = Part {
                    building: index[building as usize],
                    coverage,
                };
            }
        }
    }
    let mut used = vec![false; roofs.len()];
    let mut cells: Vec<Option<Full>> = vec![None; side * side];
    let is_covered = |parts: &&mut [Part; 4]| parts.iter().any(|part| part.coverage > 0);
    let texels = cells.iter_mut().zip(&mut columns).enumerate();
    for (place, (cell, parts)) in texels.filter(|(_, (_, parts))| is_covered(parts)) {
        *cell = merged(parts, &roofs, (place % side + place / side) % 2 == 0);
        if let Some(full) = cell {
            used[full.building as usize] = true;
        }
    }
    let mut new_index = vec![0; roofs.len()];
    let mut count = 0;
    for (index, used) in new_index.iter_mut().zip(&used) {
        *index = count;
        count += u32::from(*used);
    }
    let mut is_used = used.iter();
    roofs.retain(|_| is_used.next().copied().unwrap_or(false));
    let code = |full: &Option<Full>| match full {
        None => 0,
        Some(full) => CellKind::Full(Full {
            building: new_index[full.building as usize],
            ..*full
        })
        .code(),
    };
    let mut map = BuildingMap::from_raster(CellRaster {
        side,
        texel_m,
        cells: cells.iter().map(code).collect(),
        lists: Vec::new(),
        vertices: Vec::new(),
        roofs,
    })?;
    let ranges = children.iter().flatten().map(|map| map.height_range);
    map.height_range = ranges.fold(
        [f32::INFINITY, f32::NEG_INFINITY],
        |[lowest, highest], [low, high]| [lowest.min(low), highest.max(high)],
    );
    Ok(Some(map))
}

/// The building of a texel and how much of it is covered, 1 to [`Full::WHOLE`]; of a texel with an outline what covers its reference
/// point counts for all of it.
fn covered(map: &BuildingMap, code: u32) -> Option<(u32, u32)> {
    match CellKind::from_code(code) {
        CellKind::Full(full) => Some((full.building, full.coverage)),
        _ => map
            .roof_at_reference(code)
            .map(|building| (building, Full::WHOLE)),
    }
}

/// One column out of up to four: of the building that covers most, the higher roof and then the lower id where two are equal.
/// `rounds_up`: what becomes of a half; every second texel rounds up, so that areas stay.
fn merged(parts: &mut [Part; 4], roofs: &[RoofRecord], rounds_up: bool) -> Option<Full> {
    parts.sort_by_key(|part| part.building);
    let mut best: Option<Part> = None;
    for group in parts.chunk_by(|a, b| a.building == b.building) {
        let part = Part {
            building: group[0].building,
            coverage: group.iter().map(|part| part.coverage).sum(),
        };
        let rank = |part: &Part| (part.coverage, roofs[part.building as usize].roof_m);
        if best.is_none_or(|best| rank(&part) > rank(&best)) {
            best = Some(part);
        }
    }
    let covered: u32 = parts.iter().map(|part| part.coverage).sum();
    // A quarter of the sum, rounded: fewer values are stored in fewer bytes.
    let step = 4 * COVERAGE_STEP;
    let coverage = (covered + step / 2 - u32::from(!rounds_up)) / step * COVERAGE_STEP;
    best.filter(|_| coverage > 0).map(|best| Full {
        building: best.building,
        coverage,
    })
}
