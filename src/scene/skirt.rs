//! Skirts: strips that hang from the border of a terrain mesh, so that no sky shows between it and a neighbour whose mesh is another
//! one (Ulrich 2002, "Rendering Massive Terrains using Chunked Level of Detail Control").

/// Set in the index of a vertex that hangs below the mesh position with the rest of the index; shaders have it as `SKIRT_BIT`.
pub const SKIRT_BIT: u32 = 1 << 24;
/// How far it hangs on level 0, metres; it doubles from level to level. Shaders have it as `SKIRT_M`.
pub const SKIRT_M: f32 = 24.0;

/// The skirts of a mesh whose positions are `side` along a side, in the south, east, north and west. They look outward.
pub fn skirts(triangles: &[[u32; 3]], side: usize) -> [Vec<[u32; 3]>; 4] {
    let last = side as u32 - 1;
    let mut skirts = [const { Vec::new() }; 4];
    let position = |index: u32| [index % side as u32, index / side as u32];
    for triangle in triangles {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            let ([ax, ay], [bx, by]) = (position(a), position(b));
            let borders = [
                ay == 0 && by == 0,
                ax == last && bx == last,
                ay == last && by == last,
                ax == 0 && bx == 0,
            ];
            if a == b {
                continue;
            }
            if let Some(border) = borders.iter().position(|&is_on| is_on) {
                let (below_a, below_b) = (a | SKIRT_BIT, b | SKIRT_BIT);
                skirts[border].extend([[below_a, below_b, b], [below_a, b, a]]);
            }
        }
    }
    skirts
}
