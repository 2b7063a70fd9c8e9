//! Every shader links and is valid, without a GPU; and its records are laid out as the Rust side writes them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::mem::{offset_of, size_of};

use naga::valid::{Capabilities, ValidationFlags, Validator};
use rilievo::camera::flare::{FlareFrame, SpriteFrame};
use rilievo::camera::{BundleRecord, Exposure, InterfaceRecord, Motion, RayRecord, TemporalPass};
use rilievo::output::{DebugFrame, FlareWindowFrame};
use rilievo::relief::extrusion::ExtrusionFrame;
use rilievo::relief::{Anchor, FrameUniforms, SearchParameters};
use rilievo::scene::{GroundRecord, RoofOutline, RoofRecord, TileRecord, VertexRecord};

fn all() -> Vec<rilievo::gpu::ShaderSource> {
    rilievo::relief::SHADERS
        .into_iter()
        .chain(rilievo::camera::SHADERS)
        .chain([
            rilievo::relief::extrusion::SHADER,
            rilievo::output::DEBUG_VIEW,
            rilievo::output::FLARE_WINDOW,
            rilievo::viewer::SCREEN,
        ])
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

/// A Rust type and the WGSL type that has its bytes.
trait ShaderType {
    const WGSL: &'static str;
}
macro_rules! shader_types {
    ($($rust:ty => $wgsl:literal),* $(,)?) => {
        $(impl ShaderType for $rust { const WGSL: &'static str = $wgsl; })*
    };
}
shader_types!(
    f32 => "f32", u32 => "u32", i32 => "i32",
    [f32; 2] => "vec2<f32>", [f32; 3] => "vec3<f32>", [f32; 4] => "vec4<f32>",
    [i32; 2] => "vec2<i32>", glam::Vec4 => "vec4<f32>", glam::Mat4 => "mat4x4<f32>",
    SearchParameters => "SearchParameters", [glam::Vec4; 9] => "array<vec4<f32>, 9>",
    [glam::Vec4; 4] => "array<vec4<f32>, 4>",
);

fn wgsl_of<S, T: ShaderType>(_: fn(&S) -> &T) -> String {
    T::WGSL.to_owned()
}

fn scalar(scalar: naga::Scalar) -> String {
    let kind = match scalar.kind {
        naga::ScalarKind::Float => "f",
        naga::ScalarKind::Uint => "u",
        naga::ScalarKind::Sint => "i",
        other => panic!("{other:?}"),
    };
    format!("{kind}{}", 8 * scalar.width)
}

fn wgsl_name(module: &naga::Module, inner: &naga::TypeInner) -> String {
    match *inner {
        naga::TypeInner::Scalar(of) => scalar(of),
        naga::TypeInner::Vector { size, scalar: of } => format!("vec{}<{}>", size as u8, scalar(of)),
        naga::TypeInner::Matrix {
            columns,
            rows,
            scalar: of,
        } => format!("mat{}x{}<{}>", columns as u8, rows as u8, scalar(of)),
        naga::TypeInner::Array {
            base,
            size: naga::ArraySize::Constant(count),
            ..
        } => format!("array<{}, {count}>", wgsl_name(module, &module.types[base].inner)),
        ref other => panic!("{other:?}"),
    }
}

/// Names, types, offsets and size of a struct in whichever shader declares it.
fn shader_layout(name: &str) -> (Vec<(String, String, usize)>, usize) {
    for source in all() {
        let module = naga::front::wgsl::parse_str(&source.linked()).unwrap();
        for (_, ty) in module.types.iter() {
            if ty.name.as_deref() == Some(name)
                && let naga::TypeInner::Struct { members, span } = &ty.inner
            {
                let fields = members.iter().map(|member| {
                    let name = member.name.clone().unwrap_or_default();
                    (
                        name,
                        module.types[member.ty]
                            .name
                            .clone()
                            .unwrap_or_else(|| wgsl_name(&module, &module.types[member.ty].inner)),
                        member.offset as usize,
                    )
                });
                return (fields.collect(), *span as usize);
            }
        }
    }
    panic!("no shader declares {name}");
}

macro_rules! same_layout {
    ($name:literal, $rust:ty, [$($shader:literal = $field:ident),* $(,)?]) => {
        let (fields, size) = shader_layout($name);
        let expected = [$((
            $shader.to_owned(),
            wgsl_of(|record: &$rust| &record.$field),
            offset_of!($rust, $field),
        )),*];
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
            "search" = search,
            "sun_grid" = sun_grid,
            "sun_axes" = sun_axes,
            "street_grid" = street_grid,
            "sky_light" = sky_light,
            "wall_light" = wall_light,
            "sunny_wall_light" = sunny_wall_light,
            "eye_in_tile" = eye_in_tile,
            "eye_elevation" = eye_elevation,
            "tile_m" = tile_m,
            "eye_tile" = eye_tile,
            "grid" = grid,
            "size" = size,
            "jitter" = jitter,
            "texel_m" = texel_m,
            "tile_texels_log2" = tile_texels_log2,
            "max_roof" = max_roof,
            "min_ground" = min_ground,
            "terrain_step_m" = terrain_step_m,
            "terrain_side" = terrain_side,
            "sample" = sample,
            "pixel_angle" = pixel_angle,
            "imagery_side" = imagery_side,
            "pyramid_nodes" = pyramid_nodes,
            "max_ground" = max_ground,
            "mesh_parts" = mesh_parts,
            "hidden" = hidden,
            "sun_levels" = sun_levels,
            "street_layer" = street_layer,
            "padding_3" = padding_3,
        ]
    );
    same_layout!(
        "DebugFrame",
        DebugFrame,
        ["kind" = kind, "component" = component, "scale" = scale]
    );
    same_layout!(
        "FlareWindow",
        FlareWindowFrame,
        ["first" = first, "texels" = texels]
    );
    same_layout!("Anchor", Anchor, ["at" = at]);
    same_layout!(
        "Motion",
        Motion,
        [
            "clip_before" = clip_before,
            "forward" = forward,
            "across" = across,
            "upward" = upward,
            "eye" = eye,
            "size" = size,
            "jitter" = jitter
        ]
    );
    same_layout!(
        "Exposure",
        Exposure,
        [
            "scale" = scale,
            "flare_scale" = flare_scale,
            "centre" = centre,
            "white_balance" = white_balance,
            "places_per_pixel" = places_per_pixel,
            "falloff" = falloff,
        ]
    );
    same_layout!(
        "TileRecord",
        TileRecord,
        [
            "quad_base" = quad_base,
            "word_base" = word_base,
            "min_height" = min_height,
            "max_height" = max_height,
            "block_base" = block_base,
            "roof_quads" = roof_quads,
            "padding_a" = padding_a,
            "padding_b" = padding_b,
        ]
    );
    same_layout!(
        "ExtrusionFrame",
        ExtrusionFrame,
        [
            "clip_from_eye_relative" = clip_from_eye_relative,
            "corner" = corner,
            "height_m" = height_m,
            "size_m" = size_m,
            "facade_m" = facade_m,
            "search" = search,
            "method" = method,
            "padding_a" = padding_a,
            "padding_b" = padding_b,
            "padding_c" = padding_c,
        ]
    );
    same_layout!(
        "SearchParameters",
        SearchParameters,
        [
            "slices" = slices,
            "refinements" = refinements,
            "delta" = delta,
            "padding" = padding
        ]
    );
    same_layout!(
        "VertexRecord",
        VertexRecord,
        ["position" = position, "roof_m" = roof_m, "building" = building]
    );
    same_layout!(
        "RoofRecord",
        RoofRecord,
        [
            "base_m" = base_m,
            "material" = material,
            "roof_m" = roof_m,
            "fid" = fid
        ]
    );
    same_layout!(
        "RoofOutline",
        RoofOutline,
        [
            "vertex" = vertex,
            "edges" = edges,
            "gaps" = gaps,
            "padding" = padding
        ]
    );
    same_layout!(
        "GroundRecord",
        GroundRecord,
        ["tile" = tile, "level" = level, "layer" = layer]
    );
    same_layout!(
        "InterfaceRecord",
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
        "BundleRecord",
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
            "centre_mm" = centre_mm,
            "irradiance" = irradiance,
            "padding" = padding,
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
        "RayRecord",
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

/// What a binding is, as the layouts say it.
fn binding_kind(ty: wgpu::BindingType) -> String {
    match ty {
        wgpu::BindingType::Buffer { ty, .. } => match ty {
            wgpu::BufferBindingType::Uniform => "uniform".to_owned(),
            wgpu::BufferBindingType::Storage { read_only } => format!("storage, read only {read_only}"),
        },
        wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            ..
        } => {
            let kind = match sample_type {
                wgpu::TextureSampleType::Float { .. } => "Float",
                wgpu::TextureSampleType::Uint => "Uint",
                wgpu::TextureSampleType::Sint => "Sint",
                wgpu::TextureSampleType::Depth => "depth",
            };
            let is_array = view_dimension == wgpu::TextureViewDimension::D2Array;
            format!("texture of {kind}, array {is_array}")
        }
        wgpu::BindingType::Sampler(_) => "sampler".to_owned(),
        other => panic!("{other:?}"),
    }
}

/// The same, as a shader declares it.
fn declared_kind(module: &naga::Module, variable: &naga::GlobalVariable) -> String {
    match variable.space {
        naga::AddressSpace::Uniform => return "uniform".to_owned(),
        naga::AddressSpace::Storage { access } => {
            let writes = access.contains(naga::StorageAccess::STORE);
            return format!("storage, read only {}", !writes);
        }
        _ => {}
    }
    match module.types[variable.ty].inner {
        naga::TypeInner::Image {
            arrayed,
            class: naga::ImageClass::Sampled { kind, .. },
            ..
        } => format!("texture of {kind:?}, array {arrayed}"),
        naga::TypeInner::Sampler { .. } => "sampler".to_owned(),
        ref other => panic!("{other:?}"),
    }
}

/// Every binding of every shader is what the layout of its group says at that number.
#[test]
fn bindings_are_what_the_layouts_say() {
    use rilievo::camera::flare::{FLARE_INPUT, GHOST_INPUT, IMAGE_INPUT};
    use rilievo::camera::{AccumulatePass, RayPass, ToneMapPass};
    use rilievo::output::{DebugView, FlareWindow};
    use rilievo::relief::{
        AmbientPass, CityBindings, ExactPass, LightPass, PolygonsPass, ReliefPass, SearchPass,
    };
    let groups = |name: &str| -> Vec<&'static [wgpu::BindingType]> {
        match name {
            "relief/ground.wgsl" | "relief/cone.wgsl" => vec![&ReliefPass::FRAME, &CityBindings::TYPES],
            "relief/exact.wgsl" => vec![&ReliefPass::FRAME, &CityBindings::TYPES, &ExactPass::INPUT],
            "relief/ambient.wgsl" => vec![&ReliefPass::FRAME, &CityBindings::TYPES, &AmbientPass::INPUT],
            "relief/search.wgsl" => vec![&ReliefPass::FRAME, &CityBindings::TYPES, &SearchPass::INPUT],
            "relief/extrusion.wgsl" => vec![&rilievo::relief::extrusion::INPUT],
            "relief/light.wgsl" => vec![&ReliefPass::FRAME, &CityBindings::TYPES, &LightPass::INPUT],
            "relief/polygons.wgsl" => vec![&ReliefPass::FRAME, &PolygonsPass::ANCHOR, &PolygonsPass::INPUT],
            "camera/accumulate.wgsl" => vec![&AccumulatePass::INPUT],
            "camera/temporal.wgsl" => vec![&TemporalPass::INPUT],
            "camera/tone_map.wgsl" => vec![&ToneMapPass::INPUT],
            "camera/ghost.wgsl" | "camera/ghost.wgsl, soft" => vec![&GHOST_INPUT],
            "camera/sprite.wgsl" => vec![&FLARE_INPUT],
            "camera/soften.wgsl" | "camera/resample.wgsl" => vec![&IMAGE_INPUT],
            "camera/ray_bundles.wgsl" => vec![&RayPass::TYPES],
            "output/debug_view.wgsl" => vec![&DebugView::INPUT],
            "output/flare_window.wgsl" => vec![&FlareWindow::INPUT],
            "viewer/blit.wgsl" => vec![&rilievo::viewer::Blit::INPUT],
            other => panic!("no layouts for {other}: name them here"),
        }
    };
    let mut checked = 0;
    for source in all() {
        let module = naga::front::wgsl::parse_str(&source.linked()).unwrap();
        let groups = groups(source.name);
        for (_, variable) in module.global_variables.iter() {
            let Some(binding) = &variable.binding else {
                continue;
            };
            let place = format!("{}: {:?}", source.name, variable.name);
            let layout = groups.get(binding.group as usize).expect(&place);
            let ty = *layout.get(binding.binding as usize).expect(&place);
            assert_eq!(declared_kind(&module, variable), binding_kind(ty), "{place}");
            checked += 1;
        }
    }
    assert!(checked > 50, "{checked}");
}

/// Vertex attributes have the types and locations that the entries of the vertex stage take.
#[test]
fn vertex_attributes_are_what_the_shaders_take() {
    use rilievo::camera::flare::{FlareVertex, GhostRecord};
    use rilievo::relief::MeshVertex;
    let format = |format: wgpu::VertexFormat| match format {
        wgpu::VertexFormat::Float32 => "f32",
        wgpu::VertexFormat::Float32x2 => "vec2<f32>",
        wgpu::VertexFormat::Float32x3 => "vec3<f32>",
        wgpu::VertexFormat::Uint32 => "u32",
        other => panic!("{other:?}"),
    };
    type Buffer = (&'static [wgpu::VertexAttribute], usize);
    let shaders: [(&str, &[Buffer]); 2] = [
        (
            "relief/polygons.wgsl",
            &[(&MeshVertex::ATTRIBUTES, size_of::<MeshVertex>())],
        ),
        (
            "camera/ghost.wgsl",
            &[
                (&FlareVertex::ATTRIBUTES, size_of::<FlareVertex>()),
                (&GhostRecord::ATTRIBUTES, size_of::<GhostRecord>()),
            ],
        ),
    ];
    for (name, buffers) in shaders {
        let source = all().into_iter().find(|source| source.name == name).unwrap();
        let module = naga::front::wgsl::parse_str(&source.linked()).unwrap();
        let entry = module
            .entry_points
            .iter()
            .find(|entry| entry.name == "vs")
            .unwrap();
        let taken: Vec<(u32, String)> = entry
            .function
            .arguments
            .iter()
            .filter_map(|argument| match argument.binding {
                Some(naga::Binding::Location { location, .. }) => {
                    Some((location, wgsl_name(&module, &module.types[argument.ty].inner)))
                }
                _ => None,
            })
            .collect();
        let given: Vec<(u32, String)> = buffers
            .iter()
            .flat_map(|(attributes, _)| *attributes)
            .map(|attribute| (attribute.shader_location, format(attribute.format).to_owned()))
            .collect();
        assert_eq!(taken, given, "{name}");
        for (attributes, size) in buffers {
            let ends = attributes
                .iter()
                .map(|attribute| attribute.offset + attribute.format.size());
            let end = ends.max();
            assert_eq!(end, Some(*size as u64), "{name}: no gap at the end of a vertex");
        }
    }
}

/// An error is told with the file and line that it is in, not with that of the text they are joined to.
#[test]
fn lines_are_located_in_their_own_files() {
    for source in all() {
        for (path, text) in source.files {
            for (number, line) in text.lines().enumerate().filter(|(_, line)| line.len() > 30) {
                let linked = source.linked();
                let at = linked.lines().position(|other| other == line).unwrap();
                let (found, line_number) = source.locate(at + 1);
                let (_, found_text) = source.files.iter().find(|(path, _)| *path == found).unwrap();
                assert_eq!(
                    found_text.lines().nth(line_number - 1),
                    Some(line),
                    "{path}:{}",
                    number + 1
                );
            }
        }
    }
}
