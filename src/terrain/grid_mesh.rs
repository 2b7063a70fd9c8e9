//! The regular grid: two triangles per cell of the mesh lattice.

use super::HeightTile;

/// Triangles as indices of mesh positions, counter-clockwise from above; cells with a missing corner are left open.
pub fn grid_triangles(tile: &HeightTile) -> Vec<[u32; 3]> {
    let tile = &tile.refined(tile.mesh_parts());
    let side = tile.side;
    let mut triangles = Vec::with_capacity(2 * (side - 1) * (side - 1));
    for j in 0..side - 1 {
        for i in 0..side - 1 {
            let corner = |di: usize, dj: usize| (j + dj) * side + i + di;
            let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if corners.iter().any(|&corner| !tile.heights[corner].is_finite()) {
                continue;
            }
            let [a, b, c, d] = corners.map(|corner| corner as u32);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}
