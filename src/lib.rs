//! Rilievo: survey data in, a true city out.
//!
//! The modules stand in the order the data flows; each imports only what stands before it (`tests/flow.rs`).
//!
//! ```text
//! DTM, footprints, orthophotos ─▶ source ─▶ terrain ───────────────┐
//!                                      └─▶ material ─▶ buildings ┴▶ city ─▶ scene ─▶ relief ─▶ camera ─▶ output ─▶ viewer, cli
//! ```

/// Coordinate reference systems, bounds, the tile grid, the sun and the camera pose.
pub mod space;
/// Device, shaders, targets, read-back, timing.
pub mod gpu;
/// Georeferenced rasters, footprints and orthophotos, read by GDAL and OGR.
pub mod source;
/// The sample city's source files.
pub mod sample;
/// Ground heights and the triangles that carry them.
pub mod terrain;
/// Facades and roofs: which a building has, and the tiled textures of each.
pub mod material;
/// The building map: footprints rasterised per tile with their exact outlines.
pub mod buildings;
/// The city folder: import, tiles on disk, manifest.
pub mod city;
/// Which tiles are on the GPU, and in which order they are drawn.
pub mod scene;
/// Radiance, depth and ids from resident tiles, pose and sun.
pub mod relief;
/// The optics between radiance and the image.
pub mod camera;
/// Images out.
pub mod output;
/// The window.
pub mod viewer;
/// Commands: one file each.
pub mod cli;
