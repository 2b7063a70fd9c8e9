//! Numbers that look random and are the same everywhere.

/// A number in 0..1 from three whole ones (after PCG3D: Jarzynski & Olano 2020, JCGT 9(3), mixed once more).
pub fn hash(x: u32, y: u32, z: u32) -> f32 {
    let mut v = [x, y, z].map(|k| k.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for _ in 0..2 {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        v = v.map(|k| k ^ (k >> 16));
    }
    (v[0] >> 8) as f32 / 16_777_216.0
}

/// Value noise in 0..1 that repeats after `period` cells along both axes.
pub fn value_noise([x, y]: [f32; 2], period: u32, seed: u32) -> f32 {
    let (cell_x, cell_y) = (x.floor(), y.floor());
    let smooth = |f: f32| f * f * (3.0 - 2.0 * f);
    let (fx, fy) = (smooth(x - cell_x), smooth(y - cell_y));
    let wrapped = |cell: f32, step: i32| (cell as i32 + step).rem_euclid(period as i32) as u32;
    let at = |i: i32, j: i32| hash(wrapped(cell_x, i), wrapped(cell_y, j), seed);
    let row = |j: i32| at(0, j) + (at(1, j) - at(0, j)) * fx;
    row(0) + (row(1) - row(0)) * fy
}
