//! Footprints to a building map: every texel an outline crosses gets the outline's edges, every other
//! texel inside gets the highest roof.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use geo::{CoordsIter, LineString};
use thiserror::Error;

use super::cell::{Full, INDEX_LIMIT, MAX_EDGES, MAX_LIST, MAX_LIST_EDGES};
use super::map::{OutlineVertex, RoofRecord};
use super::{Building, BuildingMap, CellKind, Run, facade_coordinates};
use crate::space::Bounds;

/// A tile holds more outline than a code can index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("more outlines cross, or more of one winds through, one place than can be kept")]
pub struct MapTooLarge;

/// The codes of all texels of a tile, before the empty ones are left out.
pub(super) struct CellRaster {
    /// Texels along a side.
    pub side: usize,
    /// Side of a texel, metres.
    pub texel_m: f32,
    /// `side * side` codes, row by row from the south.
    pub cells: Vec<u32>,
    /// Lists of codes; a LIST code counts from the first.
    pub lists: Vec<u32>,
    /// Outline vertices.
    pub vertices: Vec<OutlineVertex>,
    /// Buildings, by ascending id.
    pub roofs: Vec<RoofRecord>,
}

/// Texels are widened by this when edges are handed out, so that rounding on the GPU meets no gap, metres.
const WIDENING_M: f64 = 2e-3;

/// An edge in a texel.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Touch {
    cell: u32,
    building: u32,
    edge: u32,
}

/// Rasterises the buildings that meet the tile. `buildings` must be sorted by id; roofs that are equally high
/// give way to the lower id.
pub fn rasterise(tile: &Bounds, side: usize, buildings: &[&Building]) -> Result<BuildingMap, MapTooLarge> {
    let texel_m = tile.width() / side as f64;
    let mut work = Work {
        tile: *tile,
        side,
        texel_m,
        vertices: Vec::new(),
        touches: Vec::new(),
        inside: Vec::new(),
        full: vec![u32::MAX; side * side],
        roofs: Vec::new(),
    };
    for building in without_hidden(buildings) {
        work.add(building);
        if work.touches.len() > MAX_EDGES || work.inside.len() > MAX_EDGES {
            return Err(MapTooLarge);
        }
    }
    work.finish()
}

/// Of buildings with the same outline the highest, of equally high ones the first: the others are hidden in it.
fn without_hidden<'a>(buildings: &[&'a Building]) -> Vec<&'a Building> {
    let mut by_outline: HashMap<u64, Vec<usize>> = HashMap::new();
    let mut kept: Vec<&Building> = Vec::new();
    for &building in buildings {
        let mut hasher = DefaultHasher::new();
        for at in building.outline.coords_iter() {
            [at.x.to_bits(), at.y.to_bits()].hash(&mut hasher);
        }
        let alike = by_outline.entry(hasher.finish()).or_default();
        let same = alike
            .iter()
            .find(|&&index| kept[index].outline == building.outline);
        match same {
            Some(&index) if building.roof_m > kept[index].roof_m => kept[index] = building,
            Some(_) => {}
            None => {
                alike.push(kept.len());
                kept.push(building);
            }
        }
    }
    kept.sort_by_key(|building| building.fid);
    kept
}

struct Work {
    tile: Bounds,
    side: usize,
    texel_m: f64,
    vertices: Vec<OutlineVertex>,
    touches: Vec<Touch>,
    /// (cell, building) whose reference point is inside although an edge crosses the cell.
    inside: Vec<(u32, u32)>,
    full: Vec<u32>,
    roofs: Vec<RoofRecord>,
}

impl Work {
    fn add(&mut self, building: &Building) {
        let index = self.roofs.len() as u32;
        self.roofs.push(RoofRecord {
            roof_m: building.roof_m as f32,
            base_m: building.base_m as f32,
            fid: building.fid,
            material: building.material.code(),
        });
        let first_touch = self.touches.len();
        let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); self.side];
        for polygon in &building.outline {
            for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
                let bays = facade_coordinates(ring, building.material.facade.bay_m);
                self.add_ring(ring, (index, &bays), &mut crossings);
            }
        }
        self.touches[first_touch..].sort_unstable();
        self.add_interior(index, first_touch, &mut crossings);
    }

    /// Local coordinates, rounded once to what the shader will see.
    fn local(&self, point: geo::Coord<f64>) -> [f64; 2] {
        [
            f64::from((point.x - self.tile.west) as f32),
            f64::from((point.y - self.tile.south) as f32),
        ]
    }

    /// `bays`: the facade coordinate of the ring's vertices.
    fn add_ring(
        &mut self,
        ring: &LineString<f64>,
        (building, bays): (u32, &[f64]),
        crossings: &mut [Vec<f64>],
    ) {
        let mut last_stored: Option<[f64; 2]> = None;
        for (edge, bays) in ring.lines().zip(bays.windows(2)) {
            let (a, b) = (self.local(edge.start), self.local(edge.end));
            self.cross_rows(a, b, crossings);
            let first_cell_touch = self.touches.len();
            let index = match last_stored {
                Some(_) => self.vertices.len() as u32 - 1,
                None => self.vertices.len() as u32,
            };
            self.touch_cells(a, b, building, index);
            if self.touches.len() > first_cell_touch {
                if last_stored.is_none() {
                    self.push_vertex(a, bays[0], building);
                }
                self.push_vertex(b, bays[1], building);
                last_stored = Some(b);
            } else {
                last_stored = None;
            }
        }
    }

    fn push_vertex(&mut self, [x, y]: [f64; 2], bays: f64, building: u32) {
        self.vertices.push(OutlineVertex {
            x_m: x as f32,
            y_m: y as f32,
            bays: bays as f32,
            building,
        });
    }

    /// Notes where the edge crosses the lines through the texels' reference points.
    fn cross_rows(&self, a: [f64; 2], b: [f64; 2], crossings: &mut [Vec<f64>]) {
        let offset = f64::from(BuildingMap::REFERENCE[1]);
        let row_of = |y: f64| y / self.texel_m - offset;
        let (low, high) = (a[1].min(b[1]), a[1].max(b[1]));
        let first = row_of(low).ceil().max(0.0) as usize;
        let mut row = first;
        while row < self.side {
            let y = (row as f64 + offset) * self.texel_m;
            if y >= high {
                break;
            }
            if y >= low {
                crossings[row].push(a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]));
            }
            row += 1;
        }
    }

    /// Hands the edge to every texel that it meets.
    fn touch_cells(&mut self, a: [f64; 2], b: [f64; 2], building: u32, edge: u32) {
        let size = self.texel_m;
        let last = self.side as f64 - 1.0;
        let index = |value: f64| (value / size).floor();
        let (low_y, high_y) = (a[1].min(b[1]) - WIDENING_M, a[1].max(b[1]) + WIDENING_M);
        if index(high_y) < 0.0 || index(low_y) > last {
            return;
        }
        for row in index(low_y).max(0.0) as usize..=index(high_y).min(last) as usize {
            // The part of the edge within the widened row.
            let (south, north) = (
                row as f64 * size - WIDENING_M,
                (row as f64 + 1.0) * size + WIDENING_M,
            );
            let (mut from, mut to) = (0.0_f64, 1.0_f64);
            let dy = b[1] - a[1];
            if dy != 0.0 {
                let (t0, t1) = ((south - a[1]) / dy, (north - a[1]) / dy);
                from = from.max(t0.min(t1));
                to = to.min(t0.max(t1));
            }
            if from > to {
                continue;
            }
            let at = |t: f64| a[0] + (b[0] - a[0]) * t;
            let (x0, x1) = (at(from), at(to));
            let (west, east) = (x0.min(x1) - WIDENING_M, x0.max(x1) + WIDENING_M);
            if index(east) < 0.0 || index(west) > last {
                continue;
            }
            for column in index(west).max(0.0) as usize..=index(east).min(last) as usize {
                self.touches.push(Touch {
                    cell: (row * self.side + column) as u32,
                    building,
                    edge,
                });
            }
        }
    }

    /// Even-odd spans of every row: whole texels compete for `full`, crossed ones note their reference.
    fn add_interior(&mut self, building: u32, first_touch: usize, crossings: &mut [Vec<f64>]) {
        let offset = f64::from(BuildingMap::REFERENCE[0]);
        for (row, xs) in crossings.iter_mut().enumerate() {
            xs.sort_unstable_by(f64::total_cmp);
            for span in xs.chunks_exact(2) {
                let first = (span[0] / self.texel_m - offset).ceil().max(0.0) as usize;
                let end = (span[1] / self.texel_m - offset)
                    .ceil()
                    .clamp(0.0, self.side as f64) as usize;
                for column in first..end {
                    let cell = (row * self.side + column) as u32;
                    let crossed = self.touches[first_touch..]
                        .binary_search_by(|touch| touch.cell.cmp(&cell))
                        .is_ok();
                    if crossed {
                        self.inside.push((cell, building));
                    } else {
                        self.offer_full(cell, building);
                    }
                }
            }
        }
    }

    fn offer_full(&mut self, cell: u32, building: u32) {
        let current = &mut self.full[cell as usize];
        let roof = |index: u32| self.roofs[index as usize].roof_m;
        if *current == u32::MAX || roof(building) > roof(*current) {
            *current = building;
        }
    }

    fn finish(mut self) -> Result<BuildingMap, MapTooLarge> {
        if self.vertices.len() >= INDEX_LIMIT || self.roofs.len() >= INDEX_LIMIT {
            return Err(MapTooLarge);
        }
        self.touches.sort_unstable();
        self.inside.sort_unstable();
        let mut cells: Vec<u32> = self
            .full
            .iter()
            .map(|&building| match building {
                u32::MAX => 0,
                building => CellKind::Full(Full::whole(building)).code(),
            })
            .collect();
        let mut lists = Vec::new();
        for group in self.touches.chunk_by(|a, b| a.cell == b.cell) {
            let cell = group[0].cell;
            let codes = self.codes_of(cell, group);
            cells[cell as usize] = match codes.as_slice() {
                [] => cells[cell as usize],
                [code] => *code,
                codes => {
                    let offset = lists.len();
                    if codes.len() > MAX_LIST || group.len() > MAX_LIST_EDGES {
                        return Err(MapTooLarge);
                    }
                    lists.push(codes.len() as u32);
                    lists.extend_from_slice(codes);
                    CellKind::List(offset as u32).code()
                }
            };
        }
        BuildingMap::from_raster(CellRaster {
            side: self.side,
            texel_m: self.texel_m as f32,
            cells,
            vertices: self.vertices,
            lists,
            roofs: self.roofs,
        })
    }

    /// The codes of one crossed texel: the roof that covers it all, if any, and what rises above that.
    fn codes_of(&self, cell: u32, touches: &[Touch]) -> Vec<u32> {
        let full = self.full[cell as usize];
        let hidden_below = match full {
            u32::MAX => f32::NEG_INFINITY,
            building => self.roofs[building as usize].roof_m,
        };
        let mut codes = Vec::new();
        if full != u32::MAX {
            codes.push(CellKind::Full(Full::whole(full)).code());
        }
        for group in touches.chunk_by(|a, b| a.building == b.building) {
            let building = group[0].building;
            if self.roofs[building as usize].roof_m <= hidden_below {
                continue;
            }
            let inside = self.inside.binary_search(&(cell, building)).is_ok();
            let first_code = codes.len();
            for run in group.chunk_by(|a, b| b.edge == a.edge + 1) {
                for part in run.chunks(16) {
                    codes.push(
                        CellKind::Run(Run {
                            inside,
                            more: true,
                            edges: part.len() as u32,
                            first: part[0].edge,
                        })
                        .code(),
                    );
                }
            }
            if let Some(last) = codes[first_code..].last_mut()
                && let CellKind::Run(run) = CellKind::from_code(*last)
            {
                *last = CellKind::Run(Run { more: false, ..run }).code();
            }
        }
        codes
    }
}
