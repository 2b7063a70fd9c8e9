//! The relief pass: resident tiles, pose and sun to linear HDR radiance, depth and ids.
//!
//! ```text
//! ground ─▶ distance, normal ─┬──────────────────────────────────┐
//!                             └▶ cone ─▶ exact | polygons ─▶ shade ─▶ radiance, distance, id
//! ```

mod cone;
mod bindings;
mod cpu_map;
mod exact;
mod frame;
mod ground;
mod march;
mod mesh;
mod pass;
mod polygons;
mod shade;
mod shaders;
mod sun;
mod targets;

pub use bindings::MapBindings;
pub use cpu_map::CpuMap;
pub use frame::{FrameUniforms, Light};
pub use march::{Hit, MapTile, Ray, visit_cell, walk_city, walk_tile};
pub use mesh::{BuildingMesh, MeshVertex, building_mesh};
pub use pass::{ReliefMode, ReliefPass};
pub use shaders::ALL as SHADERS;
pub use sun::{SUN_RADIUS, sun_irradiance, sun_visibility};
pub use targets::ReliefTargets;
