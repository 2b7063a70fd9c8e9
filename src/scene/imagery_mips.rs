//! Mip levels of an orthophoto tile.

use crate::city::ImageryTile;

/// The orthophoto and its halvings down to one pixel, RGBA.
pub fn imagery_mips(imagery: ImageryTile) -> Vec<Vec<u8>> {
    let mut levels = vec![imagery];
    while let Some(last) = levels.last().filter(|last| last.side > 1) {
        let half = last.halved();
        levels.push(half);
    }
    levels.into_iter().map(|level| level.rgba).collect()
}
