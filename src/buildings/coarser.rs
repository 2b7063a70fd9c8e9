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

/// Columns of a square of a coarse map.
struct Patch {
    /// Its south-west texel in the map.
    origin: [usize; 2],
    side: usize,
    /// Columns, row by row; buildings are indices of `roofs`.
    cells: Vec<Option<Full>>,
    roofs: Vec<RoofRecord>,
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
    let children = (0..4).zip(children);
    let patches: Vec<Patch> = children
        .clone()
        .filter_map(|(quadrant, child)| Some(Patch::from_child(child?, quadrant)))
        .collect();
    let ranges = children.filter_map(|(_, child)| Some(child?.height_range));
    assembled((side, texel_m), &patches, ranges).map(Some)
}

/// The same where `before` is the map over the children as they were and some of them changed: of the others only the ranges of their
/// heights are asked, `ranges`. `changed`: by quadrant, none where the child is as it was.
///
/// # Errors
/// When it has more words than a code can count.
pub fn coarser_updated(
    before: &BuildingMap,
    changed: [Option<Option<&BuildingMap>>; 4],
    ranges: [Option<[f32; 2]>; 4],
) -> Result<Option<BuildingMap>, MapTooLarge> {
    if ranges.iter().all(Option::is_none) {
        return Ok(None);
    }
    let fresh = (0..4).zip(changed);
    let fresh = fresh.filter_map(|(quadrant, child)| Some(Patch::from_child(child??, quadrant)));
    let (unchanged, fresh) = rayon::join(
        || Patch::from_parent(before, changed.map(|child| child.is_none())),
        || fresh.collect::<Vec<Patch>>(),
    );
    let patches: Vec<Patch> = fresh.into_iter().chain([unchanged]).collect();
    assembled(
        (before.side, before.texel_m),
        &patches,
        ranges.into_iter().flatten(),
    )
    .map(Some)
}

impl Patch {
    /// Of the child that lies under a quadrant.
    fn from_child(map: &BuildingMap, quadrant: usize) -> Self {
        let half = map.side / 2;
        // The parts of every texel's column, one a quarter.
        let mut columns = vec![[Part::default(); 4]; half * half];
        for ([block_x, block_y], codes) in map.occupied_blocks() {
            for (texel, &code) in codes.iter().enumerate() {
                let Some((building, coverage)) = covered(map, code) else {
                    continue;
                };
                let [x, y] = [BLOCK * block_x + texel % BLOCK, BLOCK * block_y + texel / BLOCK];
                columns[y / 2 * half + x / 2][x % 2 + 2 * (y % 2)] = Part { building, coverage };
            }
        }
        let is_covered = |parts: &[Part; 4]| parts.iter().any(|part| part.coverage > 0);
        let cell = |(place, parts): (usize, &mut [Part; 4])| {
            // The same places round up in every quadrant: its origin is even.
            let rounds_up = (place % half + place / half).is_multiple_of(2);
            is_covered(parts)
                .then(|| merged(parts, &map.roofs, rounds_up))
                .flatten()
        };
        Self {
            origin: [half * (quadrant % 2), half * (quadrant / 2)],
            side: half,
            cells: columns.iter_mut().enumerate().map(cell).collect(),
            roofs: map.roofs.clone(),
        }
    }

    /// Of a coarse map those quadrants that stay.
    fn from_parent(map: &BuildingMap, stays: [bool; 4]) -> Self {
        let half = map.side / 2;
        let mut cells = vec![None; map.side * map.side];
        for ([block_x, block_y], codes) in map.occupied_blocks() {
            let [x, y] = [BLOCK * block_x, BLOCK * block_y];
            if !stays[x / half + 2 * (y / half)] {
                continue;
            }
            for (texel, &code) in codes.iter().enumerate() {
                if let CellKind::Full(full) = CellKind::from_code(code) {
                    cells[(y + texel / BLOCK) * map.side + x + texel % BLOCK] = Some(full);
                }
            }
        }
        Self {
            origin: [0; 2],
            side: map.side,
            cells,
            roofs: map.roofs.clone(),
        }
    }

    /// Its columns with their places in a map of `side` texels.
    fn columns(&self, side: usize) -> impl Iterator<Item = (usize, Full)> {
        let cells = self.cells.iter().enumerate();
        cells.filter_map(move |(place, full)| {
            let [x, y] = [
                place % self.side + self.origin[0],
                place / self.side + self.origin[1],
            ];
            Some((y * side + x, (*full)?))
        })
    }
}

/// A map of `side` texels from patches; `ranges`: of its children's heights.
fn assembled(
    (side, texel_m): (usize, f32),
    patches: &[Patch],
    ranges: impl Iterator<Item = [f32; 2]>,
) -> Result<BuildingMap, MapTooLarge> {
    // Of each patch's buildings those that it shows, by id.
    let mut roofs: Vec<RoofRecord> = Vec::new();
    for patch in patches {
        let mut used = vec![false; patch.roofs.len()];
        for full in patch.cells.iter().flatten() {
            used[full.building as usize] = true;
        }
        let used = patch.roofs.iter().zip(used).filter(|(_, used)| *used);
        roofs.extend(used.map(|(roof, _)| *roof));
    }
    roofs.sort_by_key(|roof| roof.fid);
    roofs.dedup_by_key(|roof| roof.fid);
    let mut cells = vec![0; side * side];
    for patch in patches {
        let index: Vec<u32> = (patch.roofs.iter())
            .map(|roof| roofs.partition_point(|other| other.fid < roof.fid) as u32)
            .collect();
        for (place, full) in patch.columns(side) {
            let building = index[full.building as usize];
            cells[place] = CellKind::Full(Full { building, ..full }).code();
        }
    }
    let mut map = BuildingMap::from_raster(CellRaster {
        side,
        texel_m,
        cells,
        lists: Vec::new(),
        vertices: Vec::new(),
        roofs,
    })?;
    map.height_range = ranges.fold(
        [f32::INFINITY, f32::NEG_INFINITY],
        |[lowest, highest], [low, high]| [lowest.min(low), highest.max(high)],
    );
    Ok(map)
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
