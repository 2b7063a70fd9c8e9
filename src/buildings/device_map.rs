//! A building map as shaders read it: the index and the texels' own codes as they are, and one record for each occupied block in place
//! of its entry and header, so that a block is one read.

use super::cell::CellKind;
use super::map::{Block, BuildingMap, MAIN_BITS};

/// The integers of a map on the device.
pub struct DeviceMap {
    /// Index, the texels' own codes block after block, lists. Places count from the first word.
    pub words: Vec<u32>,
    /// Header, code of the commonest roof, place of the texels' own codes, 0; in the order of the entries.
    pub blocks: Vec<[u32; 4]>,
}

impl DeviceMap {
    /// The number of its words: a map's own without entries, headers and commonest roofs.
    pub fn word_count(map: &BuildingMap) -> usize {
        let in_blocks = map.blocks().map(|(_, block)| match block {
            Block::Record(place) => 2 + usize::from(map.word(place) & MAIN_BITS != 0),
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
                Block::Uniform(code) => blocks.push([MAIN_BITS, code, 0, 0]),
                Block::Record(place) => {
                    let header = map.word(place);
                    let (main, own) = map
                        .stored_codes(&block)
                        .split_at(usize::from(header & MAIN_BITS != 0));
                    let main = main.first().copied().unwrap_or(0);
                    blocks.push([header, main, words.len() as u32, 0]);
                    for &code in own {
                        if let CellKind::List(list) = CellKind::from_code(code) {
                            first_list = first_list.min(list as usize);
                            list_codes.push(words.len());
                        }
                        words.push(code);
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
