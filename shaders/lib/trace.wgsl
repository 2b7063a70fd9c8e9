// Exact rays through a lens, surface after surface, f32. Twin: src/camera/trace.rs, where the method and its sources are told.

// One meeting of a path with a surface, in the order that the light goes.
struct InterfaceRecord {
    // Distance along the axis from the surface before, signed, millimetres.
    gap_mm: f32,
    // 1 / radius; conic constant; clear radius (millimetres).
    curvature: f32,
    conic: f32,
    clear_mm: f32,
    // Refractive indices before and after, in the order of travel.
    index_before: f32,
    index_after: f32,
    // REFLECTS, STOP.
    flags: u32,
    // Films as the light meets them, in `films`.
    first_film: u32,
    film_count: u32,
    // Aspheric terms, in `terms`.
    first_term: u32,
    term_count: u32,
    padding: u32,
}

struct RayRecord {
    // On the sensor and in the stop, millimetres.
    sensor_mm: vec2<f32>,
    stop_mm: vec2<f32>,
    // Largest ratio of the ray's height to a clear radius, the stop apart, and at the stop.
    relative_height: f32,
    relative_stop: f32,
    // Fraction of the power that arrives; LOST for a ray that does not.
    power: f32,
    padding: u32,
}

@group(0) @binding(0) var<storage, read> interfaces: array<InterfaceRecord>;
// Index, thickness in micrometres.
@group(0) @binding(1) var<storage, read> films: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read> terms: array<f32>;

const NEWTON_STEPS: u32 = 24u;
// Last step, millimetres, with which the surface counts as met.
const MEETING_MM: f32 = 1.0e-3;

// Height over the vertex plane, and the gradient over x, y; z is 0 where there is no surface.
fn sag_and_slope(face: InterfaceRecord, square: f32) -> vec3<f32> {
    let c = face.curvature;
    let inside = 1.0 - (1.0 + face.conic) * c * c * square;
    if inside <= 0.0 { return vec3<f32>(0.0); }
    let root = sqrt(inside);
    // Horner's scheme from the highest term: powers of r² alone would overflow.
    var sag = 0.0;
    var slope = 0.0;
    for (var k = face.term_count; k > 0u; k -= 1u) {
        let coefficient = terms[face.first_term + k - 1u];
        sag = (sag + coefficient) * square;
        slope = slope * square + 2.0 * f32(k) * coefficient;
    }
    sag += c * square / (1.0 + root);
    slope += c / root;
    return vec3<f32>(sag, slope, 1.0);
}

fn normal_at(face: InterfaceRecord, at: vec3<f32>) -> vec3<f32> {
    if face.term_count == 0u {
        let c = face.curvature;
        return normalize(vec3<f32>(-c * at.xy, 1.0 - c * (1.0 + face.conic) * at.z));
    }
    let surface = sag_and_slope(face, dot(at.xy, at.xy));
    return normalize(vec3<f32>(-surface.y * at.xy, 1.0));
}

// Where the ray meets the surface; w is 0 where it does not.
fn meet(face: InterfaceRecord, start: vec3<f32>, d: vec3<f32>) -> vec4<f32> {
    if d.z == 0.0 { return vec4<f32>(0.0); }
    let on_plane = start - d * (start.z / d.z);
    let c = face.curvature;
    let f = c * dot(on_plane.xy, on_plane.xy);
    let g = d.z - c * dot(on_plane.xy, d.xy);
    let square = g * g - c * f * (1.0 + face.conic * d.z * d.z);
    let is_missed = square < 0.0;
    if is_missed && face.term_count == 0u { return vec4<f32>(0.0); }
    let length = sqrt(max(square, 0.0));
    let root = select(-length, length, d.z >= 0.0);
    // An asphere may be met where its conic alone is missed.
    var at = on_plane + select(d * (f / (g + root)), vec3<f32>(0.0), is_missed);
    if face.term_count > 0u {
        var step = 0.0;
        for (var i = 0u; i < NEWTON_STEPS; i += 1u) {
            let surface = sag_and_slope(face, dot(at.xy, at.xy));
            if surface.z == 0.0 { return vec4<f32>(0.0); }
            let normal = normal_at(face, at);
            step = (at.z - surface.x) * normal.z / dot(normal, d);
            at -= d * step;
            if abs(step) < 1.0e-6 { break; }
        }
        if abs(step) > MEETING_MM { return vec4<f32>(0.0); }
    }
    return vec4<f32>(at, 1.0);
}

// Fraction of unpolarised power that is reflected. Twin: src/camera/lens/coating.rs; a film's matrix is
// [[cos, i a], [i b, cos]] with real a, b also beyond its limit of total reflection.
fn reflectance(face: InterfaceRecord, cos_incidence: f32, wavelength_um: f32) -> f32 {
    let n1 = face.index_before;
    let n2 = face.index_after;
    if abs(n1 - n2) < 1.0e-7 { return 0.0; }
    let cos1 = min(abs(cos_incidence), 1.0);
    let invariant = n1 * sqrt(max(1.0 - cos1 * cos1, 0.0));
    if invariant >= n2 { return 1.0; }
    let cos2 = sqrt(max(1.0 - (invariant / n2) * (invariant / n2), 0.0));
    // Electric and magnetic fields of both polarisations (s, p): real parts in xy, imaginary in zw.
    var e = vec4<f32>(1.0, 1.0, 0.0, 0.0);
    var h = vec4<f32>(n2 * cos2, n2 / max(cos2, 1.0e-6), 0.0, 0.0);
    for (var k = face.film_count; k > 0u; k -= 1u) {
        let film = films[face.first_film + k - 1u];
        let square = 1.0 - (invariant / film.x) * (invariant / film.x);
        let cos_film = sqrt(max(abs(square), 1.0e-7));
        let depth = 6.2831853 * film.x * film.y / wavelength_um * cos_film;
        let y = vec2<f32>(film.x * cos_film, film.x / cos_film);
        let fades = square <= 0.0;
        let across = select(sin(depth), sinh(min(depth, 40.0)), fades);
        let along = select(cos(depth), cosh(min(depth, 40.0)), fades);
        let a = select(vec2<f32>(across) / y, vec2<f32>(across / y.x, -across / y.y), fades);
        let b = select(across * y, vec2<f32>(-across * y.x, across * y.y), fades);
        let e_next = e * along + vec4<f32>(-a * h.zw, a * h.xy);
        h = h * along + vec4<f32>(-b * e.zw, b * e.xy);
        e = e_next;
    }
    let y1 = vec2<f32>(n1 * cos1, n1 / max(cos1, 1.0e-6));
    let less = e * vec4<f32>(y1, y1) - h;
    let more = e * vec4<f32>(y1, y1) + h;
    let fractions = (less.xy * less.xy + less.zw * less.zw) / (more.xy * more.xy + more.zw * more.zw);
    return 0.5 * (fractions.x + fractions.y);
}

// Follows a ray from the plane of the first vertex through `count` interfaces to the sensor.
fn trace(first: u32, count: u32, entry_mm: vec2<f32>, direction: vec3<f32>, sensor_gap_mm: f32, wavelength_um: f32) -> RayRecord {
    let lost = RayRecord(vec2<f32>(0.0), vec2<f32>(0.0), 0.0, 0.0, LOST, 0u);
    var at = vec3<f32>(entry_mm, 0.0);
    var d = direction;
    var ray = RayRecord(vec2<f32>(0.0), vec2<f32>(0.0), 0.0, 0.0, 1.0, 0u);
    var past_stop = false;
    for (var k = 0u; k < count; k += 1u) {
        let face = interfaces[first + k];
        at.z += face.gap_mm;
        let met = meet(face, at, d);
        if met.w == 0.0 { return lost; }
        at = met.xyz;
        let height = length(at.xy) / face.clear_mm;
        if (face.flags & STOP) != 0u {
            if !past_stop { ray.stop_mm = at.xy; }
            past_stop = true;
            ray.relative_stop = max(ray.relative_stop, height);
        } else {
            ray.relative_height = max(ray.relative_height, height);
        }
        let normal = normal_at(face, at);
        let cos = dot(normal, d);
        let reflected = reflectance(face, cos, wavelength_um);
        if (face.flags & REFLECTS) != 0u {
            d -= 2.0 * cos * normal;
            ray.power *= reflected;
        } else {
            // Snell's law in vector form.
            let ratio = face.index_before / face.index_after;
            let square = 1.0 - ratio * ratio * (1.0 - cos * cos);
            if square < 0.0 { return lost; }
            let root = select(-sqrt(square), sqrt(square), cos >= 0.0);
            d = ratio * d + (root - ratio * cos) * normal;
            ray.power *= 1.0 - reflected;
        }
    }
    at.z -= sensor_gap_mm;
    ray.sensor_mm = (at - d * (at.z / d.z)).xy;
    if !past_stop { return lost; }
    return ray;
}
