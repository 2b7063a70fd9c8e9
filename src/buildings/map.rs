//! A tile's building map: a sparse raster of cell codes ([`super::cell`]), the outlines and roofs that they point at.
//!
//! Three quarters of a city's texels hold no building, so only blocks of 4 x 4 texels that hold one are stored. All integers are in
//! one array of words:
//!
//! | part | words |
//! |---|---|
//! | index | one for each group of 4 x 4 blocks, row by row from the south: bits 15-0 tell which of its blocks hold a building, bits 31-16 where their entries begin in the next part |
//! | entries | one for each such block: a FULL code where one roof covers the whole block, otherwise LIST with the place of the block's record |
//! | records | a header of two bits a texel (0 no building, 1 the block's commonest roof, 2 a code of its own), that roof's FULL code if any texel has it, then the texels' own codes |
//! | lists | a count, then that many codes |
//!
//! Blocks of a group, texels of a block: row by row from the south-west. Places count from the first word.

use super::cell::{CellKind, INDEX_LIMIT};
use super::rasterise::{CellRaster, MapTooLarge};

/// A tile's building map. Local coordinates: metres from the tile's south-west corner.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildingMap {
    /// Texels along a side, a power of two.
    pub side: usize,
    /// Side of a texel, metres.
    pub texel_m: f32,
    /// Index, entries, records and lists.
    pub words: Vec<u32>,
    /// Outline vertices; edge e runs from vertex e to e+1.
    pub vertices: Vec<OutlineVertex>,
    /// Buildings that touch the tile, by ascending id.
    pub roofs: Vec<RoofRecord>,
    /// Lowest ground or base under the tile's buildings and their highest roof, metres, those included that a coarse level does not
    /// show.
    pub height_range: [f32; 2],
}

/// A vertex of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineVertex {
    /// Metres east of the tile's corner.
    pub x_m: f32,
    /// Metres north of the tile's corner.
    pub y_m: f32,
    /// Bays along the outline to this vertex (the facade coordinate, [`super::facade_coordinates`]).
    pub bays: f32,
    /// Index of the building in `roofs`.
    pub building: u32,
}

/// A building's roof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoofRecord {
    /// Elevation of the flat roof, metres.
    pub roof_m: f32,
    /// Lowest ground at the outline, metres.
    pub base_m: f32,
    /// Id in the footprint dataset of record.
    pub fid: u32,
    /// What it is made of: [`crate::material::BuildingMaterial::code`].
    pub material: u32,
}

/// A block of 4 x 4 texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// No building.
    Empty,
    /// The FULL code of the one roof that covers it.
    Uniform(u32),
    /// Where its record begins in the words.
    Record(usize),
}

/// Texels along a block's side; blocks along a group's.
pub const BLOCK: usize = 4;
/// Texels of a block.
pub const TEXELS: usize = BLOCK * BLOCK;
/// What a record's header says of a texel: no building. Shaders have the next one too.
pub const TEXEL_EMPTY: u32 = 0;
/// A texel under the block's commonest roof.
pub const TEXEL_MAIN: u32 = 1;
/// A texel with a code of its own.
pub const TEXEL_OWN: u32 = 2;
/// The bits of a header that tell of its texels that they lie under the commonest roof, and that they have codes of their own.
pub const MAIN_BITS: u32 = 0x5555_5555 * TEXEL_MAIN;
pub const OWN_BITS: u32 = 0x5555_5555 * TEXEL_OWN;

impl BuildingMap {
    /// Where in a texel the parity of its outline is known, in texels from its south-west corner. Off the centre
    /// and off the diagonals, because real outlines like to run through those.
    pub const REFERENCE: [f32; 2] = [0.4387, 0.5719];

    /// Most texels along a side: entries are counted in 16 bits, and the guard on the steps of a walk (`MAX_STEPS` in
    /// `relief::constants`) stands on it.
    pub const MAX_SIDE: usize = 1024;

    /// Groups along the side of a map of `side` texels.
    pub fn groups_across(side: usize) -> usize {
        (side / TEXELS).max(1)
    }

    /// Stores the occupied blocks of a raster.
    ///
    /// # Errors
    /// When a place does not fit in a code.
    pub(super) fn from_raster(raster: CellRaster) -> Result<Self, MapTooLarge> {
        let side = raster.side;
        let groups = Self::groups_across(side);
        let blocks = side.div_ceil(BLOCK);
        let block_at = |column: usize, row: usize| -> [u32; TEXELS] {
            std::array::from_fn(|texel| {
                let [x, y] = [BLOCK * column + texel % BLOCK, BLOCK * row + texel / BLOCK];
                match x < side && y < side {
                    true => raster.cells[y * side + x],
                    false => 0,
                }
            })
        };
        let mut index = Vec::with_capacity(groups * groups);
        let mut occupied = Vec::new();
        for group in 0..groups * groups {
            let first = occupied.len() as u32;
            let mut mask = 0;
            for block in 0..TEXELS {
                let column = BLOCK * (group % groups) + block % BLOCK;
                let row = BLOCK * (group / groups) + block / BLOCK;
                if column >= blocks || row >= blocks {
                    continue;
                }
                let codes = block_at(column, row);
                if codes.iter().any(|&code| code != 0) {
                    mask |= 1 << block;
                    occupied.push(codes);
                }
            }
            index.push((first << 16) | mask);
        }
        let entries = index.len();
        let mut words = index;
        words.resize(entries + occupied.len(), 0);
        let mut own_lists = Vec::new();
        for (block, codes) in occupied.iter().enumerate() {
            let is_uniform = codes.iter().all(|&code| code == codes[0])
                && matches!(CellKind::from_code(codes[0]), CellKind::Full(_));
            words[entries + block] = match is_uniform {
                true => codes[0],
                false => {
                    let place = words.len();
                    push_record(&mut words, codes, &mut own_lists);
                    place_code(place)?
                }
            };
        }
        let lists = words.len();
        words.extend(&raster.lists);
        for word in own_lists {
            if let CellKind::List(offset) = CellKind::from_code(words[word]) {
                words[word] = place_code(lists + offset as usize)?;
            }
        }
        Ok(Self {
            side,
            texel_m: raster.texel_m,
            words,
            height_range: raster
                .roofs
                .iter()
                .fold([f32::INFINITY, f32::NEG_INFINITY], |[lowest, highest], roof| {
                    [lowest.min(roof.base_m), highest.max(roof.roof_m)]
                }),
            vertices: raster.vertices,
            roofs: raster.roofs,
        })
    }

    /// True without a building.
    pub fn is_empty(&self) -> bool {
        self.words.len() == self.index_len()
    }

    /// Words of the index.
    pub fn index_len(&self) -> usize {
        Self::groups_across(self.side).pow(2)
    }

    /// Number of blocks that hold a building.
    pub fn occupied_count(&self) -> usize {
        let index = self.words.iter().take(self.index_len());
        index.map(|word| (word & 0xffff).count_ones() as usize).sum()
    }

    /// The same map over ground that goes down to `lowest` metres.
    pub fn over_ground(mut self, lowest: f32) -> Self {
        self.height_range[0] = self.height_range[0].min(lowest);
        self
    }

    /// The word at a place, 0 beyond the last.
    pub fn word(&self, place: usize) -> u32 {
        self.words.get(place).copied().unwrap_or(0)
    }

    /// A block by its column and row among the tile's blocks.
    pub fn block(&self, column: usize, row: usize) -> Block {
        let groups = Self::groups_across(self.side);
        let index = self.word(row / BLOCK * groups + column / BLOCK);
        let bit = row % BLOCK * BLOCK + column % BLOCK;
        if index & (1 << bit) == 0 {
            return Block::Empty;
        }
        let before = (index & ((1 << bit) - 1)).count_ones();
        self.block_of_entry(groups * groups + (index >> 16) as usize + before as usize)
    }

    fn block_of_entry(&self, entry: usize) -> Block {
        let entry = self.word(entry);
        match CellKind::from_code(entry) {
            CellKind::List(place) => Block::Record(place as usize),
            _ => Block::Uniform(entry),
        }
    }

    /// The codes of a block's texels.
    pub fn codes_in(&self, block: Block) -> [u32; TEXELS] {
        match block {
            Block::Empty => [0; TEXELS],
            Block::Uniform(code) => [code; TEXELS],
            Block::Record(place) => {
                let header = self.word(place);
                let has_main = header & MAIN_BITS != 0;
                let main = self.word(place + 1);
                let mut own = place + 1 + usize::from(has_main);
                std::array::from_fn(|texel| match (header >> (2 * texel)) & 3 {
                    TEXEL_EMPTY => 0,
                    TEXEL_MAIN => main,
                    _ => {
                        own += 1;
                        self.word(own - 1)
                    }
                })
            }
        }
    }

    /// The codes that a block stores, its commonest roof's once.
    pub fn stored_codes<'a>(&'a self, block: &'a Block) -> &'a [u32] {
        match block {
            Block::Empty => &[],
            Block::Uniform(code) => std::slice::from_ref(code),
            Block::Record(place) => {
                let header = self.word(*place);
                let own = (header & OWN_BITS).count_ones() as usize;
                let count = usize::from(header & MAIN_BITS != 0) + own;
                self.words.get(place + 1..place + 1 + count).unwrap_or(&[])
            }
        }
    }

    /// The code of a texel.
    pub fn code(&self, column: usize, row: usize) -> u32 {
        let block = self.block(column / BLOCK, row / BLOCK);
        self.codes_in(block)[row % BLOCK * BLOCK + column % BLOCK]
    }

    /// Every occupied block, in the order of the entries: its column and row, and where its codes are.
    pub fn blocks(&self) -> impl Iterator<Item = ([usize; 2], Block)> {
        let groups = Self::groups_across(self.side);
        let (mut group, mut entry) = (0, self.index_len());
        let mut mask = self.word(0) & 0xffff;
        std::iter::from_fn(move || {
            while mask == 0 {
                group += 1;
                if group >= groups * groups {
                    return None;
                }
                mask = self.word(group) & 0xffff;
            }
            let bit = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let column = BLOCK * (group % groups) + bit % BLOCK;
            let row = BLOCK * (group / groups) + bit / BLOCK;
            entry += 1;
            Some(([column, row], self.block_of_entry(entry - 1)))
        })
    }

    /// The same with the codes of the texels.
    pub fn occupied_blocks(&self) -> impl Iterator<Item = ([usize; 2], [u32; TEXELS])> {
        self.blocks().map(|(place, block)| (place, self.codes_in(block)))
    }

    /// Whether it is of the finest level and has outlines.
    pub fn has_outlines(&self) -> bool {
        !self.vertices.is_empty()
    }

    /// The codes of a list; none of any other code.
    pub fn codes(&self, code: u32) -> &[u32] {
        match CellKind::from_code(code) {
            CellKind::List(place) => {
                let first = place as usize + 1;
                let count = self.word(place as usize) as usize;
                self.words.get(first..first.saturating_add(count)).unwrap_or(&[])
            }
            _ => &[],
        }
    }

    /// Building of a code that is a run or full.
    pub fn building_of(&self, code: u32) -> Option<u32> {
        match CellKind::from_code(code) {
            CellKind::Full(full) => Some(full.building),
            CellKind::Run(run) => Some(self.vertices.get(run.first as usize)?.building),
            _ => None,
        }
    }

    /// The building whose roof shows at a texel's reference point, the highest first; none on open ground.
    pub fn roof_at_reference(&self, code: u32) -> Option<u32> {
        let single = [code];
        let codes = match CellKind::from_code(code) {
            CellKind::List(_) => self.codes(code),
            _ => &single[..],
        };
        let mut best: Option<u32> = None;
        let mut continued = false;
        for &code in codes {
            let covers = match CellKind::from_code(code) {
                CellKind::Full(full) => full.is_shown(),
                CellKind::Run(run) => run.inside && !continued,
                _ => false,
            };
            continued = matches!(CellKind::from_code(code), CellKind::Run(run) if run.more);
            let Some(building) = self.building_of(code).filter(|_| covers) else {
                continue;
            };
            let roof = |index: u32| self.roofs[index as usize].roof_m;
            if best.is_none_or(|best| roof(building) > roof(best)) {
                best = Some(building);
            }
        }
        best
    }

    /// Highest roof of a code that shows, metres; negative infinity on open ground.
    pub fn highest_roof(&self, code: u32) -> f32 {
        let is_shown = |code: &u32| match CellKind::from_code(*code) {
            CellKind::Full(full) => full.is_shown(),
            _ => true,
        };
        let roof = |code: u32| {
            Some(code)
                .filter(is_shown)
                .and_then(|code| self.building_of(code))
                .and_then(|building| self.roofs.get(building as usize))
                .map_or(f32::NEG_INFINITY, |record| record.roof_m)
        };
        match CellKind::from_code(code) {
            CellKind::List(_) => self
                .codes(code)
                .iter()
                .map(|&code| roof(code))
                .fold(f32::NEG_INFINITY, f32::max),
            _ => roof(code),
        }
    }
}

/// Appends a block's record; notes the words that are places of lists.
fn push_record(words: &mut Vec<u32>, codes: &[u32; TEXELS], own_lists: &mut Vec<usize>) {
    let is_full = |code: u32| matches!(CellKind::from_code(code), CellKind::Full(_));
    let count = |code: u32| codes.iter().filter(|&&other| other == code).count();
    let full = codes.iter().copied().filter(|&code| is_full(code));
    let main = full.max_by_key(|&code| (count(code), std::cmp::Reverse(code)));
    let kind = |code: u32| match code {
        0 => TEXEL_EMPTY,
        code if Some(code) == main => TEXEL_MAIN,
        _ => TEXEL_OWN,
    };
    let header = (0..).zip(codes).map(|(texel, &code)| kind(code) << (2 * texel));
    words.push(header.sum());
    words.extend(main);
    for &code in codes.iter().filter(|&&code| kind(code) == TEXEL_OWN) {
        if matches!(CellKind::from_code(code), CellKind::List(_)) {
            own_lists.push(words.len());
        }
        words.push(code);
    }
}

fn place_code(place: usize) -> Result<u32, MapTooLarge> {
    match place < INDEX_LIMIT {
        true => Ok(CellKind::List(place as u32).code()),
        false => Err(MapTooLarge),
    }
}
