// The faces of a box.

// Corner `index` (0..36) of the two triangles of each of the volume's six faces, in 0..1; counter-clockwise seen
// from outside.
fn volume_corner(index: u32) -> vec3<f32> {
    var square = array<vec2<f32>, 6>(
        vec2<f32>(0.0, 0.0), vec2<f32>(1.0, 0.0), vec2<f32>(1.0, 1.0),
        vec2<f32>(0.0, 0.0), vec2<f32>(1.0, 1.0), vec2<f32>(0.0, 1.0),
    );
    let face = index / 6u;
    let side = f32(face & 1u);
    // The far side of an axis is seen with its two other axes in order, the near side with them swapped.
    let corner = square[index % 6u];
    let on_face = select(corner.yx, corner, (face & 1u) == 1u);
    switch face / 2u {
        case 0u: { return vec3<f32>(side, on_face.x, on_face.y); }
        case 1u: { return vec3<f32>(on_face.y, side, on_face.x); }
        default: { return vec3<f32>(on_face.x, on_face.y, side); }
    }
}
