//! Repeatable chance: a generator and smooth value noise from one hash.

/// A stream of random numbers (SplitMix64: Steele, Lea & Flood 2014).
#[derive(Clone, Debug)]
pub struct Chance(u64);

impl Chance {
    /// A stream of its own for every seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    /// The next number in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        unit_of(self.0)
    }

    /// The next number in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// True with the given probability.
    pub fn happens(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }
}

fn unit_of(mut z: u64) -> f64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A number in 0..1 for a lattice point.
pub fn lattice(x: i64, y: i64, seed: u64) -> f64 {
    let mixed = (x as u64).wrapping_mul(0x9E37_79B1) ^ (y as u64).wrapping_mul(0x85EB_CA77_C2B2_AE63);
    unit_of(mixed.wrapping_add(seed.wrapping_mul(0xD6E8_FEB8_6659_FD93)))
}

/// Smooth noise in -1..1 with one feature per unit.
pub fn value_noise(x: f64, y: f64, seed: u64) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let (u, v) = (ease(x - i), ease(y - j));
    let at = |di: i64, dj: i64| lattice(i as i64 + di, j as i64 + dj, seed);
    let south = at(0, 0) + (at(1, 0) - at(0, 0)) * u;
    let north = at(0, 1) + (at(1, 1) - at(0, 1)) * u;
    2.0 * (south + (north - south) * v) - 1.0
}

/// Four octaves of value noise, about -1..1.
pub fn fractal_noise(x: f64, y: f64, seed: u64) -> f64 {
    let octave = |k: i32| {
        let scale = f64::from(1 << k);
        value_noise(x * scale, y * scale, seed + k as u64) / scale
    };
    (0..4).map(octave).sum::<f64>() / 1.4
}
