// Square grids of rays over parts of the entrance, one grid a bundle. Host: src/camera/ray_bundles.rs.

struct BundleRecord {
    // Least and greatest coordinates of the grid on the plane of the first vertex, millimetres.
    min_mm: vec2<f32>,
    max_mm: vec2<f32>,
    // Sine and cosine of the beam's angle from the axis.
    direction: vec2<f32>,
    sensor_gap_mm: f32,
    wavelength_um: f32,
    // Its path, in `interfaces`.
    first: u32,
    count: u32,
    // Rays along an edge.
    size: u32,
    padding: u32,
}

@group(0) @binding(3) var<storage, read> bundles: array<BundleRecord>;
// Bundle after bundle, row by row.
@group(0) @binding(4) var<storage, read_write> rays: array<RayRecord>;

@compute @workgroup_size(WORKGROUP)
fn cs(@builtin(global_invocation_id) id: vec3<u32>) {
    let bundle = bundles[id.y];
    let rays_each = bundle.size * bundle.size;
    if id.x >= rays_each { return; }
    let position = vec2<f32>(vec2<u32>(id.x % bundle.size, id.x / bundle.size)) / f32(bundle.size - 1u);
    let entry = mix(bundle.min_mm, bundle.max_mm, position);
    let direction = vec3<f32>(bundle.direction.x, 0.0, bundle.direction.y);
    rays[id.y * rays_each + id.x] = trace(bundle.first, bundle.count, entry, direction, bundle.sensor_gap_mm, bundle.wavelength_um);
}
