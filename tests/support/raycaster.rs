//! Ground truth: a ray caster of the survey's own files, f64, brute force. It reads the DTM and the footprints with GDAL
//! and shares no code with the program: no tiles, no building map, no mesh.

use std::path::Path;

use gdal::Dataset;
use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};
use gdal::vector::{Geometry, LayerAccess};

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Truth {
    Sky,
    Ground { t: f64 },
    Building { t: f64, id: u32 },
}

pub struct Raycaster {
    heights: Vec<f32>,
    size: [usize; 2],
    west: f64,
    north: f64,
    pixel: f64,
    /// From the city's CRS to the DTM's, and metres of a pixel.
    to_dtm: Option<(CoordTransform, f64)>,
    buildings: Vec<Block>,
}

struct Block {
    id: u32,
    rings: Vec<Vec<[f64; 2]>>,
    low: [f64; 2],
    high: [f64; 2],
    roof: f64,
}

impl Raycaster {
    /// Reads a north-up DTM and a layer of polygons in the same CRS, with heights in `field`.
    pub fn open(terrain: &Path, footprints: &Path, field: &str) -> Self {
        Self::open_in(None, terrain, footprints, field)
    }

    /// The same for a city in a CRS of its own (`EPSG:n`): points are taken to the DTM, where it is bilinear, and outlines to the
    /// city, by GDAL.
    pub fn open_in(city: Option<&str>, terrain: &Path, footprints: &Path, field: &str) -> Self {
        let dataset = Dataset::open(terrain).unwrap();
        let [west, pixel, _, north, _, _] = dataset.geo_transform().unwrap();
        let city = city.map(|definition| easting_first(SpatialRef::from_definition(definition).unwrap()));
        let to_dtm = city.as_ref().map(|city| {
            let dtm = easting_first(dataset.spatial_ref().unwrap());
            let metres = if dtm.is_geographic() { 111_320.0 } else { 1.0 };
            (CoordTransform::new(city, &dtm).unwrap(), pixel * metres)
        });
        let band = dataset.rasterband(1).unwrap();
        let no_data = band.no_data_value().unwrap_or(f64::NAN) as f32;
        let known = |&height: &f32| if height == no_data { f32::NAN } else { height };
        let heights = band.read_band_as::<f32>().unwrap();
        let mut caster = Self {
            heights: heights.data().iter().map(known).collect(),
            size: dataset.raster_size().into(),
            west,
            north,
            pixel,
            to_dtm,
            buildings: Vec::new(),
        };
        let dataset = Dataset::open(footprints).unwrap();
        // A GeoPackage keeps ids, other files have places.
        let keeps_ids = dataset.driver().short_name() == "GPKG";
        let mut layer = dataset.layer(0).unwrap();
        let to_city = city.as_ref().map(|city| {
            let source = easting_first(layer.spatial_ref().unwrap());
            CoordTransform::new(&source, city).unwrap()
        });
        for (place, feature) in (1..).zip(layer.features()) {
            let index = feature.field_index(field).unwrap();
            // What an import without `--default-height` gives buildings without a height.
            let height = feature.field_as_double(index).unwrap();
            let height = height.filter(|&height| height > 0.0).unwrap_or(6.0);
            let geometry = feature.geometry().unwrap();
            let moved = to_city
                .as_ref()
                .map(|to_city| geometry.transform(to_city).unwrap());
            let mut rings: Vec<Vec<[f64; 2]>> = Vec::new();
            collect_rings(moved.as_ref().unwrap_or(geometry), &mut rings);
            let points = || rings.iter().flatten();
            let fold = |axis: usize, start: f64, pick: fn(f64, f64) -> f64| {
                points().map(|p| p[axis]).fold(start, pick)
            };
            let base = points()
                .filter_map(|p| caster.ground(p[0], p[1]))
                .fold(f64::INFINITY, f64::min);
            if !base.is_finite() {
                continue;
            }
            let block = Block {
                id: match keeps_ids {
                    true => feature.fid().unwrap() as u32,
                    false => place,
                },
                low: [fold(0, f64::INFINITY, f64::min), fold(1, f64::INFINITY, f64::min)],
                high: [
                    fold(0, f64::NEG_INFINITY, f64::max),
                    fold(1, f64::NEG_INFINITY, f64::max),
                ],
                roof: base + height,
                rings,
            };
            caster.buildings.push(block);
        }
        caster
    }

    /// Bilinear between pixel centres.
    pub fn ground(&self, x: f64, y: f64) -> Option<f64> {
        let [x, y] = match &self.to_dtm {
            Some((to_dtm, _)) => {
                let (mut x, mut y) = ([x], [y]);
                to_dtm.transform_coords(&mut x, &mut y, &mut []).ok()?;
                [x[0], y[0]]
            }
            None => [x, y],
        };
        let u = (x - self.west) / self.pixel - 0.5;
        let v = (self.north - y) / self.pixel - 0.5;
        let [width, height] = self.size;
        if u < 0.0 || v < 0.0 || u > (width - 1) as f64 || v > (height - 1) as f64 {
            return None;
        }
        let (i, j) = ((u as usize).min(width - 2), (v as usize).min(height - 2));
        let (fu, fv) = (u - i as f64, v - j as f64);
        let h = |di: usize, dj: usize| f64::from(self.heights[(j + dj) * width + i + di]);
        let upper = h(0, 0) * (1.0 - fu) + h(1, 0) * fu;
        let lower = h(0, 1) * (1.0 - fu) + h(1, 1) * fu;
        Some(upper * (1.0 - fv) + lower * fv).filter(|height| height.is_finite())
    }

    /// Where half of the buildings lie to either side.
    pub fn median_position(&self) -> [f64; 2] {
        [0, 1].map(|axis| {
            let mut values: Vec<f64> = self
                .buildings
                .iter()
                .map(|block| 0.5 * (block.low[axis] + block.high[axis]))
                .collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        })
    }

    /// The first thing along a ray, within 6 km.
    pub fn cast(&self, eye: [f64; 3], d: [f64; 3]) -> Truth {
        const REACH: f64 = 6000.0;
        let ground = self.cast_ground(eye, d, REACH);
        let mut best = (ground.unwrap_or(REACH), None);
        for block in &self.buildings {
            if let Some(t) = block.cast(eye, d, best.0) {
                best = (t, Some(block.id));
            }
        }
        match (best, ground) {
            ((t, Some(id)), _) => Truth::Building { t, id },
            ((t, None), Some(_)) => Truth::Ground { t },
            _ => Truth::Sky,
        }
    }

    fn cast_ground(&self, eye: [f64; 3], d: [f64; 3], reach: f64) -> Option<f64> {
        let above = |t: f64| {
            let ground = self.ground(eye[0] + t * d[0], eye[1] + t * d[1])?;
            Some(eye[2] + t * d[2] - ground)
        };
        let plan = d[0].hypot(d[1]).max(0.05);
        let pixel_m = self.to_dtm.as_ref().map_or(self.pixel, |(_, pixel_m)| *pixel_m);
        let step = (0.25 * pixel_m / plan).min(2.0);
        let mut before = 0.0;
        let mut t = 0.0;
        // From below, as through a hole in the survey, there is no ground to meet.
        let mut was_above = true;
        while t < reach {
            match above(t) {
                Some(height) if height <= 0.0 && !was_above => {
                    before = t;
                    t += step.max(1.0);
                }
                Some(height) if height <= 0.0 => {
                    let (mut low, mut high) = (before, t);
                    for _ in 0..40 {
                        let centre = 0.5 * (low + high);
                        if above(centre).is_some_and(|height| height <= 0.0) {
                            high = centre;
                        } else {
                            low = centre;
                        }
                    }
                    return Some(high);
                }
                // Far above the ground longer steps cannot jump over it: no slope is steeper than 3.
                Some(height) => {
                    was_above = true;
                    before = t;
                    t += step.max(height / (3.0 * plan + d[2].abs()) * 0.5);
                }
                None => {
                    was_above = false;
                    before = t;
                    t += step.max(1.0);
                }
            }
        }
        None
    }
}

fn easting_first(mut crs: SpatialRef) -> SpatialRef {
    crs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    crs
}

/// The rings of a polygon, or of all of a collection.
fn collect_rings(geometry: &Geometry, rings: &mut Vec<Vec<[f64; 2]>>) {
    for k in 0..geometry.geometry_count() {
        collect_rings(&geometry.get_geometry(k), rings);
    }
    if geometry.geometry_count() == 0 {
        let mut points = Vec::new();
        geometry.get_points(&mut points);
        rings.push(points.iter().map(|&(x, y, _)| [x, y]).collect());
    }
}

impl Block {
    fn cast(&self, eye: [f64; 3], d: [f64; 3], reach: f64) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, reach);
        for axis in 0..2 {
            if d[axis].abs() < 1e-15 {
                if eye[axis] < self.low[axis] || eye[axis] > self.high[axis] {
                    return None;
                }
                continue;
            }
            let a = (self.low[axis] - eye[axis]) / d[axis];
            let b = (self.high[axis] - eye[axis]) / d[axis];
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        if enter > leave {
            return None;
        }
        let mut best: Option<f64> = None;
        let mut offer = |t: f64| {
            if t > 0.0 && t < reach && best.is_none_or(|best| t < best) {
                best = Some(t);
            }
        };
        for ring in &self.rings {
            for pair in ring.windows(2) {
                let [a, b] = [pair[0], pair[1]];
                let e = [b[0] - a[0], b[1] - a[1]];
                let cross = d[0] * e[1] - d[1] * e[0];
                if cross == 0.0 {
                    continue;
                }
                let w = [a[0] - eye[0], a[1] - eye[1]];
                let t = (w[0] * e[1] - w[1] * e[0]) / cross;
                let s = (w[0] * d[1] - w[1] * d[0]) / cross;
                if (0.0..=1.0).contains(&s) && eye[2] + t * d[2] <= self.roof {
                    offer(t);
                }
            }
        }
        if d[2] < 0.0 {
            let t = (self.roof - eye[2]) / d[2];
            if self.contains(eye[0] + t * d[0], eye[1] + t * d[1]) {
                offer(t);
            }
        }
        best
    }

    fn contains(&self, x: f64, y: f64) -> bool {
        let crossings = self.rings.iter().flat_map(|ring| ring.windows(2)).filter(|pair| {
            let [a, b] = [pair[0], pair[1]];
            (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
        });
        crossings.count() % 2 == 1
    }
}
