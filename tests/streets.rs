//! Streets guessed from the gaps between buildings, against those that the sample city's photos show.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use gdal::Dataset;
use glam::DVec2;
use rilievo::buildings::FootprintMask;
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::relief::Layers;
use rilievo::relief::{Footprints, SeenBlocks, Streets};
use rilievo::scene::{PoolOptions, TerrainMesh};
use rilievo::space::Sun;
use support::{sample, succeed};

/// Pixels of a photo: rows from the north, red, green, blue.
struct Photo {
    west: f64,
    north: f64,
    pixel: f64,
    size: [usize; 2],
    bands: [Vec<u8>; 3],
}

impl Photo {
    fn open(name: &str) -> Self {
        let dataset = Dataset::open(sample().join("files").join(name)).unwrap();
        let [west, pixel, _, north, _, _] = dataset.geo_transform().unwrap();
        let bands = [1, 2, 3].map(|band| {
            let band = dataset.rasterband(band).unwrap().read_band_as::<u8>().unwrap();
            band.data().to_vec()
        });
        let size = dataset.raster_size().into();
        Self {
            west,
            north,
            pixel,
            size,
            bands,
        }
    }

    /// Whether the photo has the colour of asphalt there: a middle grey.
    fn is_asphalt(&self, at: DVec2) -> Option<bool> {
        let [x, y] = [(at.x - self.west) / self.pixel, (self.north - at.y) / self.pixel];
        if x < 0.0 || y < 0.0 || x >= self.size[0] as f64 || y >= self.size[1] as f64 {
            return None;
        }
        let place = y as usize * self.size[0] + x as usize;
        let [red, green, blue] = [0, 1, 2].map(|band| i32::from(self.bands[band][place]));
        Some((100..=134).contains(&green) && (red - green).abs() <= 6 && (green - blue).abs() <= 6)
    }
}

/// Whether buildings cover as much round a place as where streets are drawn in full (`shaders/lib/bare_ground.wgsl`).
fn is_built_up(footprints: &Footprints, at: DVec2) -> bool {
    let grid = &footprints.grid;
    let is_covered = |at: DVec2| {
        let Some(id) = grid.tile_at(at) else { return false };
        let Some((_, mask)) = footprints.masks.iter().find(|(of, _)| *of == id) else {
            return false;
        };
        let cell = (at - grid.origin(id)) / grid.tile_m * mask.side() as f64;
        mask.is_covered(cell.x as usize, cell.y as usize)
    };
    let places = (0..400).map(|k| at + 5.0 * (DVec2::new(f64::from(k % 20), f64::from(k / 20)) - 9.5));
    places.filter(|&at| is_covered(at)).count() > 120
}

#[test]
fn guessed_streets_are_where_the_photos_show_some() {
    let city = City::open(&sample().join("city")).unwrap();
    let grid = city.manifest().grid;
    let mask = |id| {
        Some((
            id,
            Arc::new(FootprintMask::from_map(&city.buildings(id).unwrap()?)),
        ))
    };
    let footprints = Footprints {
        grid,
        masks: grid.tiles().filter_map(mask).collect(),
    };
    let middle = DVec2::new(289_280.0, 4_773_024.0);
    let streets = Streets::new(&footprints, Streets::centre_of(&grid, middle), &SeenBlocks::ALL);
    let photos = ["photo_0_0.tif", "photo_0_1.tif", "photo_1_0.tif", "photo_1_1.tif"].map(Photo::open);
    let (mut places, mut guessed, mut right, mut shown) = (0, 0, 0, 0);
    for k in 0..250 * 250 {
        let at = middle + 4.0 * (DVec2::new(f64::from(k % 250), f64::from(k / 250)) - 124.7);
        let Some(cell) = streets.cell_at(at) else { continue };
        // Within the town, not under a building.
        if cell[2] < 5 || !is_built_up(&footprints, at) {
            continue;
        }
        let asphalt = photos
            .iter()
            .find_map(|photo| photo.is_asphalt(at))
            .unwrap_or(false);
        let carriageway = streets.kerb_at(at).unwrap()[0] > 0.0;
        places += 1;
        guessed += i32::from(carriageway);
        shown += i32::from(asphalt);
        right += i32::from(carriageway && asphalt);
    }
    let part = |of: i32, all: i32| f64::from(of) / f64::from(all);
    let (precision, recall, chance) = (part(right, guessed), part(right, shown), part(shown, places));
    println!(
        "{precision:.3} of what is guessed are streets, {recall:.3} of the streets are guessed; {chance:.3} by chance"
    );
    assert!(
        shown > 2000 && precision > 2.0 * chance && recall > 0.5,
        "{precision} {recall}"
    );
}

/// The sample city without its photos.
fn bare_city(folder: &Path) -> City {
    let out = folder.join("city");
    let path = |name: &str| sample().join("files").join(name).display().to_string();
    succeed(&[
        "import",
        "--terrain",
        &path("terrain.tif"),
        "--buildings",
        &path("buildings.gpkg"),
        "--height-field",
        "height_m",
        "--out",
        &out.display().to_string(),
    ]);
    City::open(&out).unwrap()
}

/// Where nothing else shows the ground streets are drawn, the same from view to view; hidden they are not; and a plan or photos over all
/// the ground leave no room for them.
#[test]
fn bare_ground_shows_streets_however_one_came_there() {
    let folder = tempfile::tempdir().unwrap();
    let city = bare_city(folder.path());
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let sun = Sun::from_azimuth_altitude(200.0, 60.0);
    let size = [96, 64];
    let mut look = |target: [f64; 2], layers: Layers| {
        let [x, y] = target;
        let camera = support::pinhole([x, y - 10.0, 300.0], [x, y, 228.0], 0.6);
        let mut request = support::request(&camera, &sun, size);
        request.relief.layers = layers;
        support::radiance(&mut renderer, &request, 1)
    };
    let shown = Layers::default();
    let street = [289_442.35, 4_773_173.31];
    let first = look(street, shown);
    look([288_700.0, 4_772_800.0], shown);
    assert!(look(street, shown) == first, "it depends on where one was before");
    let hidden = look(
        street,
        Layers {
            streets: false,
            ..shown
        },
    );
    let middle =
        |image: &[[f32; 3]]| image[size[1] as usize / 2 * size[0] as usize + size[0] as usize / 2][1];
    let (with, without) = (middle(&first), middle(&hidden));
    // Asphalt, where paving was.
    assert!(with < 0.75 * without && with > 0.25 * without, "{with} {without}");
    let photographed = City::open(&sample().join("city")).unwrap();
    let renderer = Renderer::open(Gpu::open().unwrap(), &photographed, TerrainMesh::Tin).unwrap();
    assert!(!renderer.resident.has_bare_ground);
}

/// Beside frames that do not wait they come to rest, also where one turns back before those of another place are there.
#[test]
fn streets_beside_frames_come_to_rest() {
    let folder = tempfile::tempdir().unwrap();
    let city = bare_city(folder.path());
    let options = PoolOptions {
        streams: true,
        ..PoolOptions::default()
    };
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, options).unwrap();
    let sun = Sun::from_azimuth_altitude(200.0, 60.0);
    let mut look = |x: f64, rests: bool| {
        let camera = support::pinhole([x, 4_773_163.0, 300.0], [x, 4_773_173.0, 228.0], 0.6);
        let request = support::request(&camera, &sun, [48, 32]);
        let begun = Instant::now();
        loop {
            renderer.prepare(&request).unwrap();
            if !rests || !renderer.is_loading() {
                break;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "it does not rest");
            std::thread::sleep(Duration::from_millis(5));
        }
        renderer.streets_version()
    };
    let first = look(289_442.0, true);
    assert!(first > 0);
    std::thread::sleep(Duration::from_millis(500));
    look(289_042.0, false);
    look(289_442.0, true);
    let second = look(289_042.0, true);
    assert!(second > first);
    assert!(look(289_442.0, true) > second);
}
