//! The windows in which an image is drawn that is too large to be drawn at once.

use crate::space::ImageWindow;

/// Longest side that is drawn at once, pixels: what every device's memory has room for.
pub const MAX_WINDOW_PX: u32 = 4096;

/// Windows begin at multiples of so many pixels: the random numbers of `shaders/lib/random.wgsl` repeat so, also on pixels twice as large.
const STEP_PX: u32 = 128;
/// Pixels drawn beside the crop of a window, for passes that look at a pixel's neighbours.
const MARGIN_PX: u32 = 16;

/// A window, and the crop of it that the image takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CroppedWindow {
    /// What is drawn.
    pub drawn: ImageWindow,
    /// The crop, within the image; no two overlap.
    pub crop: ImageWindow,
}

/// A stretch along one side of an image: first pixel drawn, first of the crop, length of the crop.
type Stretch = (i32, u32, u32);

/// Windows of one size that cover an image of `size` pixels, their sides at most `max_px` where that leaves room for a step.
pub fn image_windows(size: [u32; 2], max_px: u32) -> Vec<CroppedWindow> {
    let [(wide, columns), (high, rows)] = size.map(|side| stretches(side, max_px));
    let window = |&(x, crop_x, width): &Stretch, &(y, crop_y, height): &Stretch| CroppedWindow {
        drawn: ImageWindow {
            first: [x, y],
            size: [wide, high],
        },
        crop: ImageWindow {
            first: [crop_x as i32, crop_y as i32],
            size: [width, height],
        },
    };
    let window = &window;
    rows.iter()
        .flat_map(|row| columns.iter().map(move |column| window(column, row)))
        .collect()
}

/// Pixels drawn of each, and all of them.
fn stretches(side: u32, max_px: u32) -> (u32, Vec<Stretch>) {
    if side <= max_px {
        return (side, vec![(0, 0, side)]);
    }
    let room = max_px.saturating_sub(STEP_PX + MARGIN_PX) / STEP_PX * STEP_PX;
    let count = side.div_ceil(room.max(STEP_PX));
    let step = side.div_ceil(count).next_multiple_of(STEP_PX);
    let starts = (0..side).step_by(step as usize);
    let stretch = |start: u32| (start as i32 - STEP_PX as i32, start, step.min(side - start));
    (STEP_PX + step + MARGIN_PX, starts.map(stretch).collect())
}

/// An image's values that come window by window, rows from the top.
pub struct Assembled<T> {
    size: [u32; 2],
    values: Vec<T>,
}

impl<T: Copy + Default> Assembled<T> {
    /// Of an image of `size` pixels.
    pub fn new(size: [u32; 2]) -> Self {
        Self {
            size,
            values: Vec::new(),
        }
    }

    /// Takes what was drawn of a window.
    pub fn put(&mut self, window: &CroppedWindow, drawn: Vec<T>) {
        if window.drawn == ImageWindow::whole(self.size) {
            self.values = drawn;
            return;
        }
        let [width, height] = self.size.map(|side| side as usize);
        self.values.resize(width * height, T::default());
        let CroppedWindow { drawn: from, crop } = window;
        let beside = [0, 1].map(|axis| (crop.first[axis] - from.first[axis]) as usize);
        let first = crop.first.map(|first| first as usize);
        let [columns, rows] = crop.size.map(|side| side as usize);
        let drawn_rows = drawn.chunks_exact(from.size[0] as usize).skip(beside[1]);
        let rows = self.values.chunks_exact_mut(width).skip(first[1]).take(rows);
        for (row, drawn) in rows.zip(drawn_rows) {
            row[first[0]..first[0] + columns].copy_from_slice(&drawn[beside[0]..beside[0] + columns]);
        }
    }

    /// All of them.
    pub fn into_values(self) -> Vec<T> {
        self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_cover_an_image_once_and_are_of_one_size() {
        for (size, max_px) in [
            ([640, 360], 400),
            ([8193, 4097], 4096),
            ([65_535, 1], 4096),
            ([300, 5000], 4096),
            ([401, 400], 1),
        ] {
            let windows = image_windows(size, max_px);
            let mut times: Assembled<u8> = Assembled::new(size);
            let mut pixels = 0;
            for window in &windows {
                assert_eq!(window.drawn.size, windows[0].drawn.size);
                if max_px > 2 * STEP_PX + MARGIN_PX {
                    assert!(window.drawn.size.iter().all(|&side| side <= max_px), "{window:?}");
                }
                for axis in [0, 1] {
                    let (crop, drawn) = (window.crop, window.drawn);
                    let before = crop.first[axis] - drawn.first[axis];
                    let after = drawn.size[axis] as i32 - crop.size[axis] as i32 - before;
                    let is_split = drawn.size[axis] != size[axis];
                    assert!(!is_split || (before >= MARGIN_PX as i32 && after >= MARGIN_PX as i32));
                    assert!(before >= 0 && after >= 0);
                    assert_eq!(drawn.first[axis].rem_euclid(STEP_PX as i32), 0);
                }
                pixels += window.crop.size[0] * window.crop.size[1];
                let drawn = window.drawn.size[0] * window.drawn.size[1];
                times.put(window, vec![1; drawn as usize]);
            }
            assert_eq!(pixels, size[0] * size[1], "{size:?}");
            assert!(times.into_values().iter().all(|&times| times == 1));
        }
    }

    #[test]
    fn a_value_comes_where_it_was_drawn() {
        let size = [500, 3];
        let mut places = Assembled::new(size);
        for window in image_windows(size, 300) {
            let ImageWindow { first, size } = window.drawn;
            let drawn = (0..size[1] as i32)
                .flat_map(|row| (0..size[0] as i32).map(move |column| [first[0] + column, first[1] + row]));
            places.put(&window, drawn.collect());
        }
        for (k, place) in (0..).zip(places.into_values()) {
            assert_eq!(place, [k % 500, k / 500]);
        }
    }
}
