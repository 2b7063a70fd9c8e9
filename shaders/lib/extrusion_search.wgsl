// The search of KR 10-0738500 (claims 2, 3, 9): where a view ray first dips below a displacement map that stands on a plane.
//
// The volume between the map's highest value and the plane is cut into slices. From the top down the ray's point on each slice is
// held against the map there, until one lies below it: the surface is between this point and the one before. Halving narrows that down.
// Who links this file has `displaced_height`: the map's height at a point, in the height of the point.

struct Found {
    // Along the ray; FAR where it meets nothing.
    t: f32,
    // Height of the map where the ray meets it (the first height of claim 9), and where the ray was last found above it (the second).
    height: f32,
    height_before: f32,
}

// Between the ray's entry into the volume and its end, at the plane or where it leaves.
fn search(start: vec3<f32>, direction: vec3<f32>, t_top: f32, t_end: f32, parameters: SearchParameters) -> Found {
    var above = t_top;
    var below = FAR;
    var height = 0.0;
    var height_before = displaced_height(start + t_top * direction);
    // Sequential search.
    for (var slice = 0u; slice <= parameters.slices && below >= FAR; slice += 1u) {
        let t = mix(t_top, t_end, f32(slice) / f32(parameters.slices));
        let at = start + t * direction;
        height = displaced_height(at);
        if at.z < height { below = t; } else { above = t; height_before = height; }
    }
    if below >= FAR { return Found(FAR, 0.0, 0.0); }
    // Binary search.
    for (var step = 0u; step < parameters.refinements; step += 1u) {
        let t = 0.5 * (above + below);
        let at = start + t * direction;
        let here = displaced_height(at);
        if at.z < here {
            below = t;
            height = here;
        } else {
            above = t;
            height_before = here;
        }
    }
    return Found(below, height, height_before);
}

fn is_steep(found: Found, parameters: SearchParameters) -> bool {
    return found.height - found.height_before > parameters.delta;
}
