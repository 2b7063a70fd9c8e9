//! Rilievo: survey data in, a true city out.
//!
//! The modules stand in the order the data flows; each imports only what stands before it.

/// The building map: footprints rasterised per tile with their exact outlines.
pub mod buildings;
/// The city folder: import, tiles on disk, manifest.
pub mod city;
/// Commands: one file each.
pub mod cli;
/// Georeferenced rasters, footprints and photos, read by GDAL and OGR.
pub mod source;
/// Units, coordinate reference systems, bounds, tile ids and the camera pose.
pub mod space;
/// Ground heights and the triangles that carry them.
pub mod terrain;
