//! The relief pass: resident tiles, pose and sun to linear HDR radiance, depth and ids.
//!
//! ```text
//! ground_pass ─▶ distance, normal ─┬───────────────────────────────────────────────────────────────┬────────────────┐
//!                                  └▶ cone_pass ─▶ exact_pass | search_pass | polygons_pass ─▶ ambient_pass ─▶ light_pass ─▶ radiance, distance, id
//! ```
//! One traversal on the CPU as well: `march` past the buildings, `ground_march` past the terrain; `cast` is what others call.

mod ambient_pass;
mod beside_frames;
mod building_mesh;
mod cast;
mod city_bindings;
mod cone_pass;
mod constants;
mod context;
mod exact_pass;
pub mod extrusion;
mod frame_uniforms;
mod grid_position;
mod ground_march;
mod ground_pass;
mod march;
mod pass;
mod polygons_pass;
mod relief_view;
mod light_pass;
mod search_parameters;
mod search_pass;
mod settings;
mod shaders;
mod sky_tables;
mod streets;
mod sun_bounds;
mod sun_bounds_texture;
mod sun_obstacles;
mod sun_visibility;
mod targets;

pub use ambient_pass::AmbientPass;
pub use building_mesh::{BuildingMesh, MeshVertex, building_mesh};
pub use cast::{cast_buildings, cast_ground, is_open, pick};
pub use city_bindings::CityBindings;
pub use constants::FAR;
pub use context::TIMED_PASSES;
pub use exact_pass::ExactPass;
pub use frame_uniforms::FrameUniforms;
pub use grid_position::GridPosition;
pub use light_pass::LightPass;
pub use march::{Hit, SurfaceHit};
pub use pass::ReliefPass;
pub use polygons_pass::{Anchor, PolygonsPass};
pub use relief_view::ReliefView;
pub use search_parameters::{SEARCH_BAY_M, SearchParameters};
pub use search_pass::SearchPass;
pub use settings::{Layers, ReliefMode, ReliefSettings};
pub use shaders::ALL as SHADERS;
pub use streets::{Footprints, SeenBlocks, Streets, StreetsRequest};
pub use sun_bounds::SunBounds;
pub use sun_obstacles::SunObstacles;
pub use sun_visibility::sun_seen_from;
pub use targets::ReliefTargets;
