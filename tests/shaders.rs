//! Every shader links and is valid, without a GPU; and its records are laid out as the Rust side writes them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::mem::{offset_of, size_of};

use naga::valid::{Capabilities, ValidationFlags, Validator};
use rilievo::camera::flare::{FlareFrame, SpriteFrame};
use rilievo::camera::{BundleRecord, InterfaceRecord, RayRecord};
use rilievo::relief::FrameUniforms;
use rilievo::scene::{GroundRecord, TileSlot, VertexRecord};

fn all() -> Vec<rilievo::gpu::ShaderSource> {
    rilievo::relief::SHADERS
        .into_iter()
        .chain(rilievo::camera::SHADERS)
        .collect()
}

#[test]
fn every_shader_is_valid() {
    for source in all() {
        let text = source.linked();
        let module = naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|error| panic!("{}: {}", source.name, error.emit_to_string(&text)));
        Validator::new(ValidationFlags::all(), Capabilities::all())
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}: {}", source.name, error.emit_to_string(&text)));
    }
}

/// Names, offsets and size of a struct in whichever shader declares it.
fn shader_layout(name: &str) -> (Vec<(String, usize)>, usize) {
    for source in all() {
        let module = naga::front::wgsl::parse_str(&source.linked()).unwrap();
        for (_, ty) in module.types.iter() {
            if ty.name.as_deref() == Some(name)
                && let naga::TypeInner::Struct { members, span } = &ty.inner
            {
                let fields = members
                    .iter()
                    .map(|member| (member.name.clone().unwrap_or_default(), member.offset as usize))
                    .collect();
                return (fields, *span as usize);
            }
        }
    }
    panic!("no shader declares {name}");
}

macro_rules! same_layout {
    ($name:literal, $rust:ty, [$($shader:literal = $field:ident),* $(,)?]) => {
        let (fields, size) = shader_layout($name);
        let expected = [$(($shader.to_owned(), offset_of!($rust, $field))),*];
        assert_eq!(fields, expected, "{}", $name);
        assert_eq!(size, size_of::<$rust>(), "{}", $name);
    };
}

#[test]
fn records_are_laid_out_alike_on_both_sides() {
    same_layout!(
        "Frame",
        FrameUniforms,
        [
            "clip_from_eye_relative" = clip_from_eye_relative,
            "forward" = forward,
            "across" = across,
            "upward" = upward,
            "sun" = sun,
            "sun_irradiance" = sun_irradiance,
            "eye_in_tile" = eye_in_tile,
            "eye_elevation" = eye_elevation,
            "tile_m" = tile_m,
            "eye_tile" = eye_tile,
            "grid" = grid,
            "size" = size,
            "jitter" = jitter,
            "texel_m" = texel_m,
            "top_level" = top_level,
            "max_roof" = max_roof,
            "min_ground" = min_ground,
            "terrain_step_m" = terrain_step_m,
            "terrain_side" = terrain_side,
            "sample" = sample,
            "pixel_angle" = pixel_angle,
            "imagery_side" = imagery_side,
            "pyramid_width" = pyramid_width,
            "max_ground" = max_ground,
            "padding" = padding,
        ]
    );
    same_layout!(
        "TileSlot",
        TileSlot,
        [
            "vertex_base" = vertex_base,
            "list_base" = list_base,
            "min_height" = min_height,
            "max_height" = max_height,
        ]
    );
    same_layout!(
        "OutlineVertex",
        VertexRecord,
        ["position" = position, "roof_m" = roof_m, "fid" = fid,]
    );
    same_layout!(
        "GroundTile",
        GroundRecord,
        ["tile" = tile, "layer" = layer, "mesh_parts" = mesh_parts]
    );
    same_layout!(
        "Interface",
        InterfaceRecord,
        [
            "gap_mm" = gap_mm,
            "curvature" = curvature,
            "conic" = conic,
            "clear_mm" = clear_mm,
            "index_before" = index_before,
            "index_after" = index_after,
            "flags" = flags,
            "first_film" = first_film,
            "film_count" = film_count,
            "first_term" = first_term,
            "term_count" = term_count,
            "padding" = padding,
        ]
    );
    same_layout!(
        "Bundle",
        BundleRecord,
        [
            "min_mm" = min_mm,
            "max_mm" = max_mm,
            "direction" = direction,
            "sensor_gap_mm" = sensor_gap_mm,
            "wavelength_um" = wavelength_um,
            "first" = first,
            "count" = count,
            "size" = size,
            "padding" = padding,
        ]
    );
    same_layout!(
        "FlareFrame",
        FlareFrame,
        [
            "half_mm" = half_mm,
            "mask_extent" = mask_extent,
            "padding_a" = padding_a,
            "irradiance" = irradiance,
            "padding_b" = padding_b,
        ]
    );
    same_layout!(
        "SpriteFrame",
        SpriteFrame,
        [
            "centre_mm" = centre_mm,
            "half_mm" = half_mm,
            "rotation" = rotation,
            "image_half_mm" = image_half_mm,
            "radiance" = radiance,
            "padding" = padding,
        ]
    );
    same_layout!(
        "TracedRay",
        RayRecord,
        [
            "sensor_mm" = sensor_mm,
            "stop_mm" = stop_mm,
            "relative_height" = relative_height,
            "relative_stop" = relative_stop,
            "power" = power,
            "padding" = padding,
        ]
    );
}
