// Streets as guessed from the gaps between buildings. Host: src/relief/streets/mod.rs.

// Metres from the kerb, half the way between the street's fronts, metres from the nearest building; a layer a level.
@group(2) @binding(14) var streets: texture_2d_array<f32>;

// Part of its reach at which a street of the coarsest level begins to fade.
const STREETS_FADE: f32 = 0.8;
// Width of a pavement, metres; between which ways from the kerb to the houses they leave room for front gardens.
const PAVEMENT_M: f32 = 2.2;
const GARDENS_FROM_M: vec2<f32> = vec2<f32>(4.2, 5.4);

struct StreetPlace {
    // How far the streets are known here, 0 or 1 and between where the coarsest level ends.
    known: f32,
    // Metres from the kerb, larger on the carriageway.
    from_kerb: f32,
    // Width of the pavement, metres.
    pavement: f32,
    // Metres from the nearest building.
    from_building: f32,
}

// `at`: metres from the eye in plan.
fn street_at(at: vec2<f32>) -> StreetPlace {
    let offset = at - frame.street_grid.xy;
    let half = 0.5 * f32(STREET_CELLS) * frame.street_grid.z;
    let away = max(abs(offset.x), abs(offset.y)) + STREET_BORDER_M;
    let level = max(ceil(log2(away / half)), 0.0);
    if level >= frame.street_grid.w { return StreetPlace(0.0, -FAR, PAVEMENT_M, FAR); }
    let uv = offset / (f32(STREET_CELLS) * frame.street_grid.z * exp2(level)) + 0.5;
    let cell = textureSampleLevel(streets, imagery_sampler, uv, frame.street_layer + u32(level), 0.0);
    let reach = half * exp2(frame.street_grid.w - 1.0);
    let known = 1.0 - smoothstep(STREETS_FADE * reach, reach, away);
    let to_houses = cell.y - min(CARRIAGEWAY_PART * cell.y, CARRIAGEWAY_M);
    let pavement = mix(to_houses, PAVEMENT_M, smoothstep(GARDENS_FROM_M.x, GARDENS_FROM_M.y, to_houses));
    return StreetPlace(known, cell.x, pavement, cell.z);
}
