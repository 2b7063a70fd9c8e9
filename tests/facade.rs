//! The facade coordinate: metres along a building's outline, running on round its corners, against the survey's own rings.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::HashMap;

use gdal::vector::LayerAccess;
use glam::DVec2;
use rilievo::city::City;
use rilievo::gpu::{Gpu, read_texture};
use rilievo::output::Renderer;
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;

const SIZE: [u32; 2] = [320, 180];

/// A closed ring.
struct Ring(Vec<DVec2>);

impl Ring {
    fn length(&self) -> f64 {
        self.0.windows(2).map(|edge| edge[0].distance(edge[1])).sum()
    }

    /// Metres along the ring to the point of it that is nearest, and how far away that is.
    fn along(&self, point: DVec2) -> (f64, f64) {
        let mut start = 0.0;
        let mut best = (0.0, f64::INFINITY);
        for edge in self.0.windows(2) {
            let along = edge[1] - edge[0];
            let length = along.length();
            let fraction = ((point - edge[0]).dot(along) / (length * length)).clamp(0.0, 1.0);
            let away = point.distance(edge[0] + fraction * along);
            if away < best.1 {
                best = (start + fraction * length, away);
            }
            start += length;
        }
        best
    }
}

/// Outer rings of the footprints without courtyards, by id, read by OGR alone.
fn rings() -> HashMap<u32, Ring> {
    let dataset = gdal::Dataset::open(support::sample().join("files/buildings.gpkg")).unwrap();
    let mut layer = dataset.layer(0).unwrap();
    let simple = layer.features().filter_map(|feature| {
        let geometry = feature.geometry()?;
        if geometry.geometry_count() != 1 {
            return None;
        }
        let mut points = Vec::new();
        geometry.get_geometry(0).get_points(&mut points);
        let ring = points.iter().map(|&(x, y, _)| DVec2::new(x, y)).collect();
        Some((feature.fid()? as u32, Ring(ring)))
    });
    simple.collect()
}

#[test]
fn the_facade_coordinate_is_metres_along_the_outline() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let rings = rings();
    let (mut walls, mut buildings, mut corners, mut wrong) = (0, 0, 0, 0);
    for (name, eye, target) in &support::VIEWS[..2] {
        let camera = support::pinhole(*eye, *target, 1.0);
        let sun = Sun::from_azimuth_altitude(200.0, 40.0);
        renderer.still(&support::request(&camera, &sun, SIZE), 1).unwrap();
        let targets = renderer.relief_targets().unwrap();
        let surfaces = read_texture::<[u32; 4]>(&renderer.gpu, &targets.building_surface.texture).unwrap();
        let shown = read_texture::<u32>(&renderer.gpu, &targets.id.texture).unwrap();
        let projection = camera.projection(SIZE);
        // Per building: where the survey has a wall's point along its ring, and the facade coordinate of the image.
        let mut points: HashMap<u32, Vec<[f64; 2]>> = HashMap::new();
        for (k, &[t, id, along, _]) in surfaces.iter().enumerate() {
            let along = f64::from(f32::from_bits(along));
            if id == 0 || shown[k] != id || along == 0.0 {
                continue;
            }
            let Some(ring) = rings.get(&id) else { continue };
            let ray = projection.ray_direction(k as u32 % SIZE[0], k as u32 / SIZE[0]);
            let at = camera.pose.eye + ray * f64::from(f32::from_bits(t));
            let (survey, away) = ring.along(at.truncate());
            assert!(away < 0.1, "{name}: a wall of {id} lies {away} m off its outline");
            assert!(
                (0.0..=ring.length() + 0.05).contains(&along),
                "{id}: {along} m along {} m",
                ring.length()
            );
            points.entry(id).or_default().push([survey, along]);
            walls += 1;
        }
        for (id, points) in points {
            let length = rings[&id].length();
            // The ring may be walked the other way, from another vertex: one direction and one offset for the whole building.
            let off = |sign: f64| {
                let [survey, along] = points[0];
                let offset = along - sign * survey;
                let errors = points.iter().map(|[survey, along]| {
                    let apart = (along - sign * survey - offset).rem_euclid(length);
                    apart.min(length - apart)
                });
                errors.filter(|&error| error > 0.15).count()
            };
            wrong += off(1.0).min(off(-1.0));
            buildings += 1;
            let [min, max] = points
                .iter()
                .fold([f64::INFINITY, 0.0_f64], |[min, max], [survey, _]| {
                    [min.min(*survey), max.max(*survey)]
                });
            corners += u32::from(max - min > 15.0);
        }
    }
    println!("{wrong} of {walls} wall pixels of {buildings} buildings differ, {corners} round corners");
    assert!(
        walls > 5000 && buildings > 50 && corners > 20,
        "{walls}, {buildings}, {corners}"
    );
    assert!(wrong * 200 <= walls, "{wrong} of {walls} differ");
}
