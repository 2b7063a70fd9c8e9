// Numbers that look random.

// Three in 0..1 from three whole ones (pcg3d: Jarzynski & Olano 2020, JCGT 9(3)).
fn random3(seed: vec3<u32>) -> vec3<f32> {
    var v = seed * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> vec3<u32>(16u);
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    return vec3<f32>(v >> vec3<u32>(8u)) / 16777216.0;
}

// Numbers in 0..1 for a pixel's sample. In the plane: three low-discrepancy masks, so that neighbours differ evenly (R2: Roberts 2018;
// interleaved gradient noise: Jimenez 2014). Along the samples: R3 (Roberts 2018).
fn sample_numbers(pixel: vec2<i32>, index: u32) -> vec3<f32> {
    let p = vec2<f32>(pixel);
    let mask = vec3<f32>(
        dot(p, vec2<f32>(0.75487767, 0.56984029)),
        52.9829189 * fract(dot(p, vec2<f32>(0.06711056, 0.00583715))),
        dot(p, vec2<f32>(0.56984029, 0.75487767)) + 0.5,
    );
    return fract(fract(mask) + f32(index) * vec3<f32>(0.8191725, 0.6710436, 0.5497005));
}
