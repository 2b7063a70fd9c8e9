//! What is made for a size of image, cached for a few sizes: coming back to one of them makes nothing.

/// Values of the sizes used last, the one in use first. Caches that are asked for the same sizes in the same order hold the same
/// sizes, so that what one of them makes may refer to what another one made.
pub struct BySize<T> {
    entries: Vec<([u32; 2], T)>,
}

/// The size at rest, and two in motion: one in use, and the one tried beside it.
const MAX_SIZES: usize = 3;

impl<T> Default for BySize<T> {
    fn default() -> Self {
        Self { entries: Vec::new() }
    }
}

impl<T> BySize<T> {
    /// Puts the value of `size` in use; made where it is not cached.
    pub fn select(&mut self, size: [u32; 2], make: impl FnOnce() -> T) -> &T {
        let entry = match self.entries.iter().position(|(known, _)| *known == size) {
            Some(index) => self.entries.remove(index),
            None => {
                // Before another one is made, so that the device need not hold both.
                self.entries.truncate(MAX_SIZES - 1);
                (size, make())
            }
        };
        self.entries.insert(0, entry);
        &self.entries[0].1
    }

    /// Forgets all values: what they were made from is gone.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// The value in use; none before the first size.
    pub fn current(&self) -> Option<&T> {
        self.entries.first().map(|(_, value)| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_sizes_stay_and_the_oldest_goes() {
        let mut cache = BySize::default();
        let mut made = 0;
        let mut select = |width: u32| {
            *cache.select([width, 1], || {
                made += 1;
                made
            })
        };
        let widths = [1, 2, 1, 3, 1, 4, 2];
        assert_eq!(
            widths.map(&mut select),
            [1, 2, 1, 3, 1, 4, 5],
            "2 is the oldest when 4 comes"
        );
    }
}
