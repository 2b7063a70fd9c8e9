//! What painters paint on: a tile's colours, heights and materials, a texel each, rows from below.

use std::sync::LazyLock;

/// Texels of a tile along u and v: two bays by one storey, or a square of roof twice.
pub const TILE_SIZE: [usize; 2] = [256, 128];

/// A texel in the making.
#[derive(Clone, Copy, Debug)]
pub struct Texel {
    /// Reflectance, linear sRGB.
    pub albedo: [f32; 3],
    /// How far it stands out, metres.
    pub height_m: f32,
    /// 1 on glass.
    pub glass: f32,
    /// How far the building's own colour multiplies the reflectance, 0 to 1.
    pub tint: f32,
}

/// A tile in the making.
pub struct Canvas {
    /// Its size, metres.
    pub size_m: [f32; 2],
    texels: Vec<Texel>,
}

/// A rectangle, metres from the lower left: west, south, east, north.
pub type Rect = [f32; 4];

impl Canvas {
    /// A tile of `size_m` metres, every texel by its position, metres.
    pub fn new(size_m: [f32; 2], texel: impl Fn([f32; 2]) -> Texel) -> Self {
        Self::sampled(size_m, [1, 1], texel)
    }

    /// The same by the mean of some places of each texel, along u and v: joints are narrower than a texel.
    pub fn sampled(size_m: [f32; 2], samples: [usize; 2], texel: impl Fn([f32; 2]) -> Texel) -> Self {
        let [width, height] = TILE_SIZE;
        let [across, up] = samples;
        let at = |k: usize| {
            let place = |j: usize| {
                let x = ((k % width) as f32 + ((j % across) as f32 + 0.5) / across as f32) / width as f32;
                let y = ((k / width) as f32 + ((j / across) as f32 + 0.5) / up as f32) / height as f32;
                texel([x * size_m[0], y * size_m[1]])
            };
            (1..across * up).fold(place(0), |mean, j| mean.mixed(place(j), 1.0 / (j + 1) as f32))
        };
        Self {
            size_m,
            texels: (0..width * height).map(at).collect(),
        }
    }

    /// Paints a rectangle; `texel` gets the position in it, metres, and what is there. Texels on its edge are mixed by how much of them it
    /// covers.
    pub fn paint(&mut self, rect: Rect, texel: impl Fn([f32; 2], Texel) -> Texel) {
        let [width, height] = TILE_SIZE;
        let step = [self.size_m[0] / width as f32, self.size_m[1] / height as f32];
        let covered = |from: f32, to: f32, k: usize, step: f32| {
            let (low, high) = (k as f32 * step, (k as f32 + 1.0) * step);
            ((to.min(high) - from.max(low)) / step).clamp(0.0, 1.0)
        };
        let range = |from: f32, to: f32, step: f32, count: usize| {
            let first = (from / step).floor().max(0.0) as usize;
            first..((to / step).ceil().max(0.0) as usize).min(count)
        };
        for row in range(rect[1], rect[3], step[1], height) {
            for column in range(rect[0], rect[2], step[0], width) {
                let part =
                    covered(rect[0], rect[2], column, step[0]) * covered(rect[1], rect[3], row, step[1]);
                if part <= 0.0 {
                    continue;
                }
                let position = [
                    (column as f32 + 0.5) * step[0] - rect[0],
                    (row as f32 + 0.5) * step[1] - rect[1],
                ];
                let under = self.texels[row * width + column];
                self.texels[row * width + column] = under.mixed(texel(position, under), part);
            }
        }
    }

    /// Paints a rectangle in one material.
    pub fn fill(&mut self, rect: Rect, texel: Texel) {
        self.paint(rect, |_, _| texel);
    }

    /// The image for the device, with its halvings down to one texel.
    pub fn levels(&self) -> Vec<TileLevel> {
        let [width, height] = TILE_SIZE;
        let step = [self.size_m[0] / width as f32, self.size_m[1] / height as f32];
        let at = |column: usize, row: usize| self.texels[row * width + column].height_m;
        let channels = |k: usize| {
            let (column, row) = (k % width, k / width);
            let across = at((column + 1) % width, row) - at((column + width - 1) % width, row);
            let (below, above) = (row.saturating_sub(1), (row + 1).min(height - 1));
            let up = at(column, above) - at(column, below);
            let slope = [across / (2.0 * step[0]), up / ((above - below) as f32 * step[1])];
            let [u, v] = slope.map(|slope| (0.5 + 0.5 * slope / MAX_SLOPE).clamp(0.0, 1.0));
            let Texel {
                albedo: [r, g, b],
                glass,
                tint,
                ..
            } = self.texels[k];
            [r, g, b, glass, u, v, tint, 1.0]
        };
        let mut size = TILE_SIZE;
        let mut texels: Vec<[f32; 8]> = (0..width * height).map(channels).collect();
        let mut levels = vec![TileLevel::new(&texels)];
        while size != [1, 1] {
            (size, texels) = halved(size, &texels);
            levels.push(TileLevel::new(&texels));
        }
        levels
    }

    /// The tile as it looks on a wall of a colour (linear sRGB), 8-bit sRGB RGBA, rows from above.
    pub fn rows_from_above(&self, wall: [f32; 3]) -> Vec<[u8; 4]> {
        let colour = |texel: &Texel| {
            let tinted = |k: usize| texel.albedo[k] * (1.0 + (wall[k] / WALL_GREY - 1.0) * texel.tint);
            let [r, g, b] = [0, 1, 2].map(|k| srgb_byte(tinted(k)));
            [r, g, b, 255]
        };
        let rows = self.texels.chunks_exact(TILE_SIZE[0]).rev();
        rows.flatten().map(colour).collect()
    }

    /// Mean reflectance, linear sRGB.
    pub fn mean_albedo(&self) -> [f32; 3] {
        let sum = |k: usize| self.texels.iter().map(|texel| texel.albedo[k]).sum::<f32>();
        std::array::from_fn(|k| sum(k) / self.texels.len() as f32)
    }
}

/// One level of a tile's two images, RGBA.
pub struct TileLevel {
    /// Reflectance (sRGB); glass.
    pub colour: Vec<[u8; 4]>,
    /// Slope of the surface along u and v (0.5 is level, in units of [`MAX_SLOPE`]), tint, 1.
    pub detail: Vec<[u8; 4]>,
}

impl TileLevel {
    fn new(texels: &[[f32; 8]]) -> Self {
        let colour = |&[r, g, b, glass, ..]: &[f32; 8]| {
            let [r, g, b] = [r, g, b].map(srgb_byte);
            [r, g, b, unit_byte(glass)]
        };
        let detail = |&[.., u, v, tint, one]: &[f32; 8]| [u, v, tint, one].map(unit_byte);
        Self {
            colour: texels.iter().map(colour).collect(),
            detail: texels.iter().map(detail).collect(),
        }
    }
}

/// An image of half the size, every texel the mean of those it stands for.
fn halved([width, height]: [usize; 2], texels: &[[f32; 8]]) -> ([usize; 2], Vec<[f32; 8]>) {
    let half = [(width / 2).max(1), (height / 2).max(1)];
    let step = [width / half[0], height / half[1]];
    let mean = |k: usize| {
        let (x, y) = (k % half[0] * step[0], k / half[0] * step[1]);
        let parts =
            (0..step[0] * step[1]).map(|part| texels[(y + part / step[0]) * width + x + part % step[0]]);
        let sum = parts.fold([0.0; 8], |sum, part| std::array::from_fn(|c| sum[c] + part[c]));
        sum.map(|channel: f32| channel / (step[0] * step[1]) as f32)
    };
    (half, (0..half[0] * half[1]).map(mean).collect())
}

/// What a tile's wall is painted in: the building's colour multiplies it by as much more, so that lighter grains fit in a byte.
pub const WALL_GREY: f32 = 0.65;

/// The steepest slope of a tile's surface that is told apart.
pub const MAX_SLOPE: f32 = 2.0;

impl Texel {
    /// A dull material of one colour.
    pub fn dull(albedo: [f32; 3], height_m: f32) -> Self {
        Self {
            albedo,
            height_m,
            glass: 0.0,
            tint: 0.0,
        }
    }

    /// Wall of the building's own colour, `grain` times as light.
    pub fn wall(grain: f32, height_m: f32) -> Self {
        Self {
            albedo: [WALL_GREY * grain; 3],
            height_m,
            glass: 0.0,
            tint: 1.0,
        }
    }

    /// The same, darker or lighter.
    pub fn scaled(self, factor: f32) -> Self {
        Self {
            albedo: self.albedo.map(|channel| channel * factor),
            ..self
        }
    }

    /// The same with a part of another over it.
    pub fn mixed(self, over: Self, part: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * part;
        Self {
            albedo: std::array::from_fn(|k| mix(self.albedo[k], over.albedo[k])),
            height_m: mix(self.height_m, over.height_m),
            glass: mix(self.glass, over.glass),
            tint: mix(self.tint, over.tint),
        }
    }
}

fn unit_byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// IEC 61966-2-1, 8 bits.
pub fn srgb_byte(linear: f32) -> u8 {
    // From the first byte that may be meant on.
    let step = (linear.clamp(0.0, 1.0) * SRGB_STEPS as f32) as usize;
    let (first_bytes, from) = &*SRGB;
    let mut byte = first_bytes[step];
    while byte < u8::MAX && linear >= from[usize::from(byte) + 1] {
        byte += 1;
    }
    byte
}

/// Steps of reflectance, few enough that none is passed over by more than some bytes.
const SRGB_STEPS: usize = 1024;

/// The byte that each step begins with, and the reflectance that each byte begins with: half a byte before its own.
static SRGB: LazyLock<([u8; SRGB_STEPS + 1], [f32; 256])> = LazyLock::new(|| {
    let from: [f32; 256] = std::array::from_fn(|byte| {
        let coded = (byte as f32 - 0.5) / 255.0;
        if coded <= 0.04045 {
            coded / 12.92
        } else {
            ((coded + 0.055) / 1.055).powf(2.4)
        }
    });
    let first = |step: usize| {
        let linear = step as f32 / SRGB_STEPS as f32;
        from[1..].partition_point(|&from| from <= linear) as u8
    };
    (std::array::from_fn(first), from)
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_the_nearest_to_the_standards_curve() {
        for k in -100..=20_100 {
            let linear = k as f32 / 20_000.0;
            let clamped = f64::from(linear).clamp(0.0, 1.0);
            let coded = if clamped <= 0.003_130_8 {
                12.92 * clamped
            } else {
                1.055 * clamped.powf(1.0 / 2.4) - 0.055
            };
            let away = (f64::from(srgb_byte(linear)) - 255.0 * coded).abs();
            assert!(away < 0.5 + 1e-3, "{linear}: {away}");
        }
    }
}
