//! A building map as shaders read it: the index and the texels' own codes as they are, and one record for each occupied block in place
//! of its entry and header, so that a block is one read.

use super::cell::CellKind;
use super::map::{Block, BuildingMap};

/// The integers of a map on the device.
pub struct DeviceMap {
    /// Index, the texels' own codes block after block, lists. Places count from the first word.
    pub words: Vec<u32>,
    /// Header, code of the commonest roof, place of the texels' own codes, 0; in the order of the entries.
    pub blocks: Vec<[u32; 4]>,
}

/// The header of a block that lies under one roof.
const UNIFORM: u32 = 0x5555_5555;

impl DeviceMap {
    /// The number of its words: a map's own without entries, headers and commonest roofs.
    pub fn word_count(map: &BuildingMap) -> usize {
        let in_blocks = map.blocks().map(|(_, block)| match block {
            Block::Record(place) => 2 + usize::from(map.word(place) & UNIFORM != 0),
            _ => 1,
        });
        map.words.len() - in_blocks.sum::<usize>().min(map.words.len())
    }

    /// Of a map.
    pub fn new(map: &BuildingMap) -> Self {
        let index = map.index_len();
        let mut words: Vec<u32> = map.words[..index].to_vec();
        let mut blocks = Vec::with_capacity(map.occupied_count());
        // Lists are the last words: where they begin is told by the first that is named.
        let (mut list_codes, mut first_list) = (Vec::new(), map.words.len());
        for (_, block) in map.blocks() {
            match block {
                Block::Empty => {}
                Block::Uniform(code) => blocks.push([UNIFORM, code, 0, 0]),
                Block::Record(place) => {
                    let header = map.word(place);
                    // Of a texel's two bits the lower one tells the commonest roof, the upper one a code of its own.
                    let has_main = header & UNIFORM != 0;
                    let main = if has_main { map.word(place + 1) } else { 0 };
                    blocks.push([header, main, words.len() as u32, 0]);
                    let first = place + 1 + usize::from(has_main);
                    let count = (header & (UNIFORM << 1)).count_ones() as usize;
                    for own in first..first + count {
                        if let CellKind::List(list) = CellKind::from_code(map.word(own)) {
                            first_list = first_list.min(list as usize);
                            list_codes.push(words.len());
                        }
                        words.push(map.word(own));
                    }
                }
            }
        }
        let moved = words.len();
        words.extend(&map.words[first_list..]);
        for place in list_codes {
            if let CellKind::List(list) = CellKind::from_code(words[place]) {
                words[place] = CellKind::List((moved + list as usize - first_list) as u32).code();
            }
        }
        Self { words, blocks }
    }
}
