//! The picture against ground truth: depth and ids of the sample city, drawn both ways, against an independent ray
//! caster of the survey files.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::path::Path;

use glam::DVec3;
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::{Renderer, Still};
use rilievo::relief::{ReliefMode, ReliefSettings};
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;
use support::View;
use support::raycaster::{Raycaster, Truth};

const SIZE: [u32; 2] = [192, 108];
/// Among the densest houses of Mamre, in its CRS.
const MAMRE: [f64; 2] = [264_448.0, 6_288_820.0];

fn view(eye: [f64; 3], target: [f64; 3]) -> View {
    View {
        eye: DVec3::from_array(eye),
        target: DVec3::from_array(target),
        fov_y: 60_f64.to_radians(),
    }
}

fn draw(renderer: &mut Renderer, view: View, mode: ReliefMode) -> Still {
    let camera = view.camera();
    let sun = Sun::from_direction(DVec3::new(-0.5, -0.5, 0.7).normalize());
    let request = rilievo::output::FrameRequest {
        relief: ReliefSettings {
            mode,
            ..ReliefSettings::default()
        },
        ..support::request(&camera, &sun, SIZE)
    };
    renderer.still(&request, 1).unwrap()
}

fn open(mesh: TerrainMesh) -> Renderer {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, mesh).unwrap();
    renderer.load_polygons(&city).unwrap();
    renderer
}

fn caster() -> Raycaster {
    let files = support::sample().join("files");
    Raycaster::open(
        &files.join("terrain.tif"),
        &files.join("buildings.gpkg"),
        "height_m",
    )
}

/// What must hold (the project's accuracy promise).
fn check(name: &str, caster: &Raycaster, view: View, picture: &Still) {
    let [width, height] = SIZE;
    let truth: Vec<Truth> = (0..width * height)
        .map(|k| {
            caster.cast(
                view.eye.to_array(),
                support::ray(&view, SIZE, k % width, k / width).to_array(),
            )
        })
        .collect();
    let class = |k: usize| match truth[k] {
        Truth::Sky => -1_i64,
        Truth::Ground { .. } => 0,
        Truth::Building { id, .. } => i64::from(id),
    };
    let (mut buildings, mut right_buildings, mut grounds, mut right_grounds, mut smooth_wrong) =
        (0, 0, 0, 0, 0);
    for (k, seen) in truth.iter().enumerate() {
        let (column, row) = (k as u32 % width, k as u32 / width);
        let (t, id) = (f64::from(picture.depth[k]), picture.ids[k]);
        let right = match *seen {
            Truth::Sky => t.is_nan(),
            Truth::Building {
                t: t_true,
                id: id_true,
            } => {
                buildings += 1;
                let right = id == id_true && (t - t_true).abs() <= f64::max(0.10, 0.0005 * t_true);
                right_buildings += u32::from(right);
                right
            }
            Truth::Ground { .. } => {
                grounds += 1;
                let at = view.eye + support::ray(&view, SIZE, column, row) * t;
                let error = caster.ground(at.x, at.y).map(|ground| (at.z - ground).abs());
                let right = id == 0 && error.is_some_and(|error| error <= 0.30);
                right_grounds += u32::from(right);
                right
            }
        };
        let inner = column > 0 && row > 0 && column + 1 < width && row + 1 < height;
        let smooth = inner
            && [-1, 0, 1].iter().all(|dy| {
                [-1, 0, 1]
                    .iter()
                    .all(|dx| class((k as i64 + dy * i64::from(width) + dx) as usize) == class(k))
            });
        smooth_wrong += u32::from(smooth && !right);
    }
    let share = |part: u32, whole: u32| f64::from(part) / f64::from(whole.max(1));
    let (buildings_right, grounds_right) = (share(right_buildings, buildings), share(right_grounds, grounds));
    let away = share(smooth_wrong, width * height);
    println!(
        "{name}: buildings {buildings_right:.5} of {buildings}, ground {grounds_right:.5} of {grounds}, wrong away from silhouettes {away:.6}"
    );
    assert!(
        buildings > 400 && grounds > 200,
        "{name}: the view shows too little to judge"
    );
    assert!(buildings_right >= 0.995, "{name}: buildings {buildings_right}");
    assert!(grounds_right >= 0.995, "{name}: ground {grounds_right}");
    assert!(away <= 0.001, "{name}: {away} wrong away from silhouettes");
}

#[test]
fn exact_relief_is_true() {
    let (caster, mut renderer) = (caster(), open(TerrainMesh::Tin));
    for (name, eye, look) in support::VIEWS {
        let view = view(eye, look);
        check(
            &format!("exact {name}"),
            &caster,
            view,
            &draw(&mut renderer, view, ReliefMode::Exact),
        );
    }
}

#[test]
fn polygons_are_true_and_agree_with_exact() {
    let (caster, mut renderer) = (caster(), open(TerrainMesh::Tin));
    for (name, eye, look) in support::VIEWS {
        let view = view(eye, look);
        let polygons = draw(&mut renderer, view, ReliefMode::Polygons);
        check(&format!("polygons {name}"), &caster, view, &polygons);
        let exact = draw(&mut renderer, view, ReliefMode::Exact);
        let differing = exact
            .ids
            .iter()
            .zip(&polygons.ids)
            .filter(|(a, b)| a != b)
            .count();
        assert!(
            differing * 200 <= exact.ids.len(),
            "{name}: {differing} ids differ"
        );
    }
}

/// Imports terrain and footprints with heights in `height_m`.
fn import(terrain: &[&Path], buildings: &Path, more: &[&str], out: &Path) -> City {
    let mut arguments: Vec<std::ffi::OsString> = vec!["import".into(), "--terrain".into()];
    arguments.extend(terrain.iter().map(|path| path.into()));
    arguments.extend([
        "--buildings".into(),
        buildings.into(),
        "--height-field".into(),
        "height_m".into(),
    ]);
    arguments.extend(more.iter().map(|text| text.into()));
    arguments.extend(["--out".into(), out.into()]);
    support::succeed(&arguments);
    City::open(out).unwrap()
}

#[test]
fn fine_and_coarse_texels_are_true() {
    let (caster, files) = (caster(), support::sample().join("files"));
    let folder = tempfile::tempdir().unwrap();
    for texel in ["0.5", "2"] {
        let city = import(
            &[&files.join("terrain.tif")],
            &files.join("buildings.gpkg"),
            &["--texel", texel],
            &folder.path().join(texel),
        );
        let side = city.manifest().texel_m;
        assert!(
            (side / texel.parse::<f64>().unwrap() - 1.0).abs() < 0.25,
            "{side}"
        );
        let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
        for (name, eye, look) in support::VIEWS {
            let view = view(eye, look);
            let picture = draw(&mut renderer, view, ReliefMode::Exact);
            check(&format!("texel {texel} {name}"), &caster, view, &picture);
        }
    }
}

/// The sample and its copy 40 km to the north-east are one city, with nothing between.
#[test]
fn a_city_of_40_km_is_true_at_its_far_end() {
    const SHIFT: f64 = 40_000.0;
    let folder = tempfile::tempdir().unwrap();
    let files = support::sample().join("files");
    let far_terrain = folder.path().join("far.tif");
    std::fs::copy(files.join("terrain.tif"), &far_terrain).unwrap();
    let update = gdal::DatasetOptions {
        open_flags: gdal::GdalOpenFlags::GDAL_OF_UPDATE,
        ..Default::default()
    };
    let mut raster = gdal::Dataset::open_ex(&far_terrain, update).unwrap();
    let mut transform = raster.geo_transform().unwrap();
    transform[0] += SHIFT;
    transform[3] += SHIFT;
    raster.set_geo_transform(&transform).unwrap();
    raster.close().unwrap();
    let buildings = folder.path().join("both.geojson");
    let near = rings_and_heights(&files.join("buildings.gpkg"));
    let far = near.iter().map(|(rings, height)| {
        let shifted = |ring: &Vec<[f64; 2]>| ring.iter().map(|[x, y]| [x + SHIFT, y + SHIFT]).collect();
        (rings.iter().map(shifted).collect(), *height)
    });
    let both: Vec<(Vec<Vec<[f64; 2]>>, f64)> = near.iter().cloned().chain(far).collect();
    write_geojson(&buildings, &both);

    let out = folder.path().join("city");
    let city = import(
        &[&files.join("terrain.tif"), &far_terrain],
        &buildings,
        &["--fill", "0"],
        &out,
    );
    let bounds = city.manifest().grid.bounds();
    assert!(bounds.width() > SHIFT && bounds.height() > SHIFT, "{bounds:?}");

    // Every vertex of the far outlines is stored within a millimetre.
    let is_vertex: std::collections::HashSet<[i64; 2]> = both
        .iter()
        .flat_map(|(rings, _)| rings.iter().flatten())
        .flat_map(|point| {
            let [x, y] = point.map(|value| (value * 1e3).round() as i64);
            [-1, 0, 1]
                .into_iter()
                .flat_map(move |dx| [-1, 0, 1].map(|dy| [x + dx, y + dy]))
        })
        .collect();
    let mut checked = 0;
    for tile in city.manifest().grid.tiles() {
        let Some(map) = city.buildings(tile).unwrap() else {
            continue;
        };
        let origin = city.manifest().grid.origin(tile);
        for vertex in &map.vertices {
            let at = [origin.x + f64::from(vertex.x_m), origin.y + f64::from(vertex.y_m)];
            let millimetres = at.map(|value| (value * 1e3).round() as i64);
            assert!(
                is_vertex.contains(&millimetres),
                "{at:?} is no vertex of the survey"
            );
            checked += 1;
        }
    }
    assert!(checked > 20_000, "{checked} vertices");

    let caster = Raycaster::open(&far_terrain, &buildings, "height_m");
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    for (name, eye, look) in support::VIEWS {
        let far = |[x, y, z]: [f64; 3]| [x + SHIFT, y + SHIFT, z];
        let view = view(far(eye), far(look));
        let picture = draw(&mut renderer, view, ReliefMode::Exact);
        check(&format!("40 km away, {name}"), &caster, view, &picture);
    }
}

/// Rings and `height_m` of every polygon.
fn rings_and_heights(path: &Path) -> Vec<(Vec<Vec<[f64; 2]>>, f64)> {
    use gdal::vector::LayerAccess;
    let dataset = gdal::Dataset::open(path).unwrap();
    let mut layer = dataset.layer(0).unwrap();
    let features = layer.features().map(|feature| {
        let geometry = feature.geometry().unwrap();
        let rings = (0..geometry.geometry_count()).map(|k| {
            let mut points = Vec::new();
            geometry.get_geometry(k).get_points(&mut points);
            points.iter().map(|&(x, y, _)| [x, y]).collect()
        });
        let height = feature.field_index("height_m").unwrap();
        (rings.collect(), feature.field_as_double(height).unwrap().unwrap())
    });
    features.collect()
}

fn write_geojson(path: &Path, polygons: &[(Vec<Vec<[f64; 2]>>, f64)]) {
    use serde_json::json;
    let features: Vec<_> = polygons
        .iter()
        .map(|(rings, height)| {
            let geometry = json!({"type": "Polygon", "coordinates": rings});
            json!({"type": "Feature", "properties": {"height_m": height}, "geometry": geometry})
        })
        .collect();
    let crs = json!({"type": "name", "properties": {"name": "EPSG:32633"}});
    let collection = json!({"type": "FeatureCollection", "crs": crs, "features": features});
    std::fs::write(path, collection.to_string()).unwrap();
}

#[test]
fn the_regular_grid_draws_the_same_ground() {
    let (caster, mut renderer) = (caster(), open(TerrainMesh::Grid));
    let (name, eye, look) = support::VIEWS[1];
    let view = view(eye, look);
    check(
        &format!("grid {name}"),
        &caster,
        view,
        &draw(&mut renderer, view, ReliefMode::Exact),
    );
}

#[test]
fn the_same_command_gives_the_same_picture() {
    let city = support::sample().join("city");
    let folder = tempfile::tempdir().unwrap();
    let render = |name: &str| {
        let out = folder.path().join(name);
        let [east, north, height] = support::VIEWS[1].1;
        let eye = format!("{east},{north},{height}");
        let [east, north, height] = support::VIEWS[1].2;
        let look = format!("{east},{north},{height}");
        let arguments: [&std::ffi::OsStr; 11] = [
            "render".as_ref(),
            city.as_ref(),
            "--eye".as_ref(),
            eye.as_ref(),
            "--look".as_ref(),
            look.as_ref(),
            "--size".as_ref(),
            "96x54".as_ref(),
            "--samples=2".as_ref(),
            "--out".as_ref(),
            out.as_ref(),
        ];
        support::succeed(&arguments);
        std::fs::read(Path::new(&out)).unwrap()
    };
    assert_eq!(render("a.png"), render("b.png"));
}

/// A real place: Mamre's footprints on its 25 m terrain, both in the city's CRS.
#[test]
fn a_real_town_is_true() {
    let Some(data) = support::shared_data() else {
        return;
    };
    let terrain = data.join("mamre_za/derived_dtm25_utm34s_clip.tif");
    let footprints = data.join("mamre_za/derived_buildings_epsg32734.gpkg");
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("city");
    let path = |path: &Path| path.display().to_string();
    support::succeed(&[
        "import".to_owned(),
        "--terrain".to_owned(),
        path(&terrain),
        "--buildings".to_owned(),
        path(&footprints),
        "--height-field".to_owned(),
        "height_m".to_owned(),
        "--out".to_owned(),
        path(&out),
    ]);
    let caster = Raycaster::open(&terrain, &footprints, "height_m");
    let city = City::open(&out).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let [x, y] = MAMRE;
    let z = caster.ground(x, y).unwrap();
    for (name, eye) in [
        ("low", [x - 90.0, y - 110.0, z + 40.0]),
        ("oblique", [x - 160.0, y - 140.0, z + 130.0]),
        ("high", [x - 60.0, y - 80.0, z + 320.0]),
    ] {
        let view = view(eye, [x, y, z]);
        let exact = draw(&mut renderer, view, ReliefMode::Exact);
        check(&format!("mamre {name}"), &caster, view, &exact);
    }
}

/// Whole cities of `../shared/data`, minutes each: `cargo test --release --test truth -- --ignored --nocapture`.
#[test]
#[ignore = "imports whole cities"]
fn whole_cities_are_true() {
    let Some(data) = support::shared_data() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    // The second figure is the size of the views.
    for ((name, size), terrain, footprints, field) in [
        (
            ("hollywood", 1.0),
            "hollywood_us/terrain_srtm1_epsg4326.tif",
            "hollywood_us/derived_buildings_z14_epsg4326.fgb",
            "render_height",
        ),
        // No area has a landuse that is a height: all get the default one.
        (
            ("monaco", 0.6),
            "monaco_mc/N43E007.hgt",
            "monaco_mc/monaco-latest.osm.pbf",
            "landuse",
        ),
        (
            ("zurich", 0.15),
            "zurich_lidar_ch/derived_dtm_1m_epsg2056.tif",
            "zurich_lidar_ch/derived_buildings_epsg2056.gpkg",
            "height_m",
        ),
        (
            ("gothenburg", 0.3),
            "gothenburg_se/torgg_2m_epsg3006/torgg_dem.tif",
            "gothenburg_se/derived_kronhuset_buildings_epsg3006.gpkg",
            "height_m",
        ),
    ] {
        let (terrain, mut footprints) = (data.join(terrain), data.join(footprints));
        let out = folder.path().join(name);
        if name == "monaco" {
            // The areas of an OSM extract as polygons in a file of their own: the dataset of a first city.
            let first = folder.path().join("first");
            let [terrain, extract, first_text] =
                [&terrain, &footprints, &first].map(|path| path.display().to_string());
            support::succeed(&[
                "import",
                "--terrain",
                &terrain,
                "--buildings",
                &extract,
                "--out",
                &first_text,
            ]);
            footprints = first.join("buildings.gpkg");
        }
        let text = |path: &Path| path.display().to_string();
        let arguments = [
            "import",
            "--terrain",
            &text(&terrain),
            "--buildings",
            &text(&footprints),
        ]
        .into_iter()
        .chain(["--height-field", field, "--fill", "0", "--out", &text(&out)])
        .map(str::to_owned)
        .collect::<Vec<_>>();
        support::succeed(&arguments);
        let city = City::open(&out).unwrap();
        let caster = Raycaster::open_in(Some(&city.manifest().crs), &terrain, &footprints, field);
        let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
        let [x, y] = caster.median_position();
        let z = caster.ground(x, y).unwrap();
        for (view_name, eye) in [
            ("low", [-110.0, -130.0, 110.0]),
            ("oblique", [-260.0, -240.0, 230.0]),
            ("high", [-100.0, -130.0, 520.0]),
        ] {
            let target = DVec3::new(x, y, z);
            let view = view((target + size * DVec3::from_array(eye)).into(), target.into());
            let exact = draw(&mut renderer, view, ReliefMode::Exact);
            check(&format!("{name} {view_name}"), &caster, view, &exact);
        }
    }
}
