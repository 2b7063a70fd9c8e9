//! Ground surfaces per tile: heights on a lattice, and the triangles that carry them.
//!
//! A triangle's corners lie on the lattice, refined by whole parts where the samples are far apart
//! (`HeightTile::mesh_parts`), so a mesh is a list of indices and its vertices are displaced by the height texture alone
//! ("global vertex displacement", KR 10-0738500): the same vertex shader draws the regular grid (`grid`) and the TIN (`tin`).

mod fill;
mod grid_mesh;
mod ground_bounds;
mod height_tile;
mod level;
mod profile;
mod tin;

pub use fill::fill_gaps;
pub use grid_mesh::grid_triangles;
pub use ground_bounds::GroundBounds;
pub use height_tile::HeightTile;
pub use level::{coarser_ground, mesh_errors, meshes, meshes_alone};
pub use tin::{Apron, tin_triangles};
