// One sample of a moving view and what the frames before it showed there: temporal anti-aliasing without ghosts, since what stands still
// is found again by its distance. Reprojection and a jittered sample a frame: Karis 2014, High-quality temporal supersampling;
// the history kept within the neighbourhood's mean and deviation: Salvi 2016, An excursion in temporal supersampling; read by
// Catmull & Rom's spline, which blurs least.

struct Motion {
    // Clip space of the frame before from positions relative to its eye, without jitter.
    clip_before: mat4x4<f32>,
    // The ray through normalised device coordinates (x, y) is forward + x * across + y * upward.
    forward: vec4<f32>,
    across: vec4<f32>,
    upward: vec4<f32>,
    // The eye from that of the frame before, metres; 1 where there is such a frame.
    eye: vec4<f32>,
    // Image size, pixels; sub-pixel offset of the sample, pixels.
    size: vec2<f32>,
    jitter: vec2<f32>,
}

@group(0) @binding(0) var radiance: texture_2d<f32>;
@group(0) @binding(1) var seen_distance: texture_2d<f32>;
// Mean radiance, and the distance of the last sample.
@group(0) @binding(2) var history: texture_2d<f32>;
@group(0) @binding(3) var<uniform> motion: Motion;

struct Mean {
    // As a sum of one sample.
    @location(0) sum: vec4<f32>,
    @location(1) history: vec4<f32>,
}

// Part of the image that is history: some nine samples count.
const HISTORY_WEIGHT: f32 = 0.9;
// The same where the image moves: each reading between pixels blurs.
const MOVING_HISTORY_WEIGHT: f32 = 0.68;
// Deviations from the neighbourhood's mean that the history may keep.
const DEVIATIONS: f32 = 1.25;
// The sky is so far away, metres.
const SKY_M: f32 = 1.0e6;
// Distances that differ by this fraction are of one surface.
const SAME: f32 = 0.04;
// Distances beside each other of a surface seen from the side, at most by the nearest.
const STEEP: f32 = 1.6;
// Bend of 1 / distance between pixels, by itself, of a flat surface.
const FLAT: f32 = 0.02;

fn inside(pixel: vec2<i32>) -> vec2<i32> {
    return clamp(pixel, vec2<i32>(0), vec2<i32>(motion.size) - 1);
}

fn nearness(pixel: vec2<i32>) -> f32 {
    return 1.0 / min(textureLoad(seen_distance, inside(pixel), 0).r, SKY_M);
}

fn weights(t: f32) -> vec4<f32> {
    let t2 = t * t;
    let t3 = t2 * t;
    return 0.5 * vec4<f32>(-t3 + 2.0 * t2 - t, 3.0 * t3 - 5.0 * t2 + 2.0, -3.0 * t3 + 4.0 * t2 + t, t3 - t2);
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> Mean {
    let pixel = vec2<i32>(position.xy);
    let here = textureLoad(radiance, pixel, 0).rgb;
    let here_distance = min(textureLoad(seen_distance, pixel, 0).r, SKY_M);
    var mean = Mean(vec4<f32>(here, 1.0), vec4<f32>(here, here_distance));
    if motion.eye.w == 0.0 { return mean; }

    var sum = vec3<f32>(0.0);
    var squares = vec3<f32>(0.0);
    var nearest = SKY_M;
    for (var row = -1; row <= 1; row += 1) {
        for (var column = -1; column <= 1; column += 1) {
            let beside = inside(pixel + vec2<i32>(column, row));
            let colour = textureLoad(radiance, beside, 0).rgb;
            sum += colour;
            squares += colour * colour;
            nearest = min(nearest, textureLoad(seen_distance, beside, 0).r);
        }
    }
    // What is flat moves as it is, an edge with what is in front: over a plane 1 / distance is linear in the image.
    let near_beside = vec4<f32>(
        nearness(pixel + vec2<i32>(-1, 0)),
        nearness(pixel + vec2<i32>(1, 0)),
        nearness(pixel + vec2<i32>(0, -1)),
        nearness(pixel + vec2<i32>(0, 1)),
    );
    let bend = max(abs(near_beside.x + near_beside.y - 2.0 / here_distance), abs(near_beside.z + near_beside.w - 2.0 / here_distance));
    let followed = select(nearest, here_distance, bend * here_distance < FLAT);
    let ndc = position.xy / motion.size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0);
    let ray = normalize(motion.forward.xyz + ndc.x * motion.across.xyz + ndc.y * motion.upward.xyz);
    let before = ray * followed + motion.eye.xyz;
    let clip = motion.clip_before * vec4<f32>(before, 1.0);
    let place = (clip.xy / clip.w * vec2<f32>(0.5, -0.5) + 0.5) * motion.size;
    if clip.w <= 0.0 || any(place < vec2<f32>(0.0)) || any(place >= motion.size) { return mean; }

    let corner = floor(place - 0.5);
    let t = place - 0.5 - corner;
    let across = weights(t.x);
    let upward = weights(t.y);
    var seen = vec3<f32>(0.0);
    let expected = min(length(before), SKY_M);
    var from_m = SKY_M;
    var to_m = 0.0;
    var is_known = false;
    for (var row = 0; row < 4; row += 1) {
        for (var column = 0; column < 4; column += 1) {
            let known = textureLoad(history, inside(vec2<i32>(corner) + vec2<i32>(column - 1, row - 1)), 0);
            seen += across[column] * upward[row] * known.rgb;
            from_m = min(from_m, known.a);
            to_m = max(to_m, known.a);
            is_known = is_known || abs(known.a - expected) < SAME * expected;
        }
    }
    // What was hidden then has no history.
    let is_between = expected > from_m && expected < to_m && to_m < STEEP * from_m;
    if !is_known && !is_between { return mean; }
    let middle = sum / 9.0;
    let deviation = DEVIATIONS * sqrt(max(squares / 9.0 - middle * middle, vec3<f32>(0.0)));
    let clipped = clamp(max(seen, vec3<f32>(0.0)), middle - deviation, middle + deviation);
    let moved = min(8.0 * distance(place, position.xy), 1.0);
    let colour = mix(here, clipped, mix(HISTORY_WEIGHT, MOVING_HISTORY_WEIGHT, moved));
    mean.sum = vec4<f32>(colour, 1.0);
    mean.history = vec4<f32>(colour, here_distance);
    return mean;
}
