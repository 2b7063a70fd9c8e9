// Numbers that look random.

// Three in 0..1 from three whole ones (pcg3d: Jarzynski & Olano 2020, JCGT 9(3)).
fn random3(seed: vec3<u32>) -> vec3<f32> {
    var v = seed * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> vec3<u32>(16u);
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    return vec3<f32>(v >> vec3<u32>(8u)) / 16777216.0;
}

// Place of a pixel along Hilbert's curve through a square of 64 pixels: near places are near pixels (Hilbert 1891; for noise: Intel's
// XeGTAO 2021).
fn hilbert_index(pixel: vec2<i32>) -> u32 {
    var p = vec2<u32>(pixel) & vec2<u32>(63u);
    var index = 0u;
    for (var side = 32u; side > 0u; side >>= 1u) {
        let half = vec2<u32>((p.x & side) / side, (p.y & side) / side);
        index += side * side * ((3u * half.x) ^ half.y);
        if half.y == 0u {
            p = select(p, vec2<u32>(63u) - p, half.x == 1u).yx;
        }
    }
    return index;
}

// Numbers in 0..1 for a pixel's sample. In the plane: low-discrepancy sequences along Hilbert's curve, so that neighbours differ evenly
// and without stripes (golden ratio and R2: Roberts 2018). Along the samples: R3 (Roberts 2018).
fn sample_numbers(pixel: vec2<i32>, index: u32) -> vec3<f32> {
    let mask = f32(hilbert_index(pixel)) * vec3<f32>(0.75487767, 0.56984029, 0.61803399);
    return fract(fract(mask) + f32(index) * vec3<f32>(0.8191725, 0.6710436, 0.5497005));
}
