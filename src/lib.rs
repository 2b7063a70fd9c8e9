//! Rilievo: survey data in, a true city out.
//!
//! The modules stand in the order the data flows; each imports only what stands before it.

/// The building map: footprints rasterised per tile with their exact outlines.
pub mod buildings;
/// The optics between radiance and the picture.
pub mod camera;
/// The city folder: import, tiles on disk, manifest.
pub mod city;
/// Commands: one file each.
pub mod cli;
/// Device, shaders, targets, read-back, timing.
pub mod gpu;
/// Pictures out.
pub mod output;
/// Radiance, depth and ids from resident tiles, pose and sun.
pub mod relief;
/// Which tiles are on the GPU, and in which order they are drawn.
pub mod scene;
/// Georeferenced rasters, footprints and photos, read by GDAL and OGR.
pub mod source;
/// Units, coordinate reference systems, bounds, tile ids and the camera pose.
pub mod space;
/// The sample city's source files.
pub mod sample;
/// Ground heights and the triangles that carry them.
pub mod terrain;
