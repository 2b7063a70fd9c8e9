//! The aerial orthophoto: country, river, streets, yards, roofs and trees, painted in that order from above.
//! No shadows of buildings: those are the renderer's.

use glam::{DVec2, DVec3};

use super::blocks::BlockKind;
use super::features::SampleBuilding;
use super::landscape::{river_distance, river_half_width, river_point};
use super::noise::{fractal_noise, lattice, value_noise};
use super::shapes::{Ring, centre, longest_direction, set_back};
use super::town::{Town, woods};

/// A rectangle of orthophoto, local metres; rows from the north.
pub struct Canvas {
    west: f64,
    north: f64,
    pixel_m: f64,
    size: [usize; 2],
    /// sRGB 0..255.
    pixels: Vec<DVec3>,
}

fn rgb(r: u8, g: u8, b: u8) -> DVec3 {
    DVec3::new(f64::from(r), f64::from(g), f64::from(b))
}

/// Country roads, local metres.
fn roads() -> Vec<Vec<DVec2>> {
    let at = |x: f64, y: f64| DVec2::new(x, y);
    vec![
        vec![
            at(870.0, 0.0),
            at(930.0, 240.0),
            at(1000.0, 430.0),
            river_point(1015.0),
            at(1030.0, 900.0),
        ],
        vec![
            at(1840.0, 0.0),
            at(1640.0, 300.0),
            river_point(1490.0),
            at(1440.0, 900.0),
        ],
        vec![at(0.0, 1010.0), at(330.0, 985.0), at(620.0, 1015.0)],
        vec![at(1900.0, 1000.0), at(2180.0, 1080.0), at(2560.0, 1010.0)],
        vec![at(1330.0, 1480.0), at(1420.0, 1760.0), at(1330.0, 2048.0)],
    ]
}

/// Paints a rectangle whose north-west corner is (`west`, `north`).
pub fn paint(town: &Town, west: f64, north: f64, size: [usize; 2], pixel_m: f64) -> Vec<u8> {
    let mut canvas = Canvas {
        west,
        north,
        pixel_m,
        size,
        pixels: Vec::new(),
    };
    canvas.country();
    for road in roads() {
        canvas.road(&road, 4.6, rgb(138, 132, 122));
        canvas.road(&road, 3.4, rgb(116, 114, 112));
    }
    for block in &town.blocks {
        if let Some(street) = set_back(&block.ring, -8.9) {
            canvas.fill(&[street], |p| dry(p).then(|| asphalt(p)));
        }
    }
    for block in &town.blocks {
        if let Some(pavement) = set_back(&block.ring, -1.7) {
            canvas.fill(&[pavement], |p| {
                Some(rgb(158, 154, 147) + DVec3::splat(5.0 * grain(p)))
            });
        }
        canvas.fill(std::slice::from_ref(&block.ring), |p| Some(yard(block.kind, p)));
    }
    for building in &town.buildings {
        canvas.roof(building);
    }
    for tree in &town.trees {
        canvas.tree(tree.at, tree.radius);
    }
    canvas
        .pixels
        .iter()
        .flat_map(|colour| {
            colour
                .to_array()
                .map(|value| value.round().clamp(0.0, 255.0) as u8)
        })
        .collect()
}

/// Width of a gutter, metres.
const GUTTER_M: f64 = 0.7;

fn grain(p: DVec2) -> f64 {
    lattice((p.x * 4.0) as i64, (p.y * 4.0) as i64, 3) * 2.0 - 1.0
}

fn dry(p: DVec2) -> bool {
    river_distance(p).abs() > river_half_width(p) + 5.0
}

fn asphalt(p: DVec2) -> DVec3 {
    rgb(118, 116, 114) + DVec3::splat(7.0 * value_noise(p.x / 9.0, p.y / 9.0, 8) + 4.0 * grain(p))
}

fn yard(kind: BlockKind, p: DVec2) -> DVec3 {
    let mottle = value_noise(p.x / 6.0, p.y / 6.0, 9);
    let lawn = rgb(104, 124, 66) + rgb(20, 16, 10) * mottle + DVec3::splat(6.0 * grain(p));
    let paving = rgb(164, 152, 134) + DVec3::splat(8.0 * mottle + 5.0 * grain(p));
    match kind {
        BlockKind::Square => {
            // Setts in a grid of paler bands.
            let band = (p.x * 0.97 + p.y * 0.24).rem_euclid(9.0) < 0.8
                || (p.y * 0.97 - p.x * 0.24).rem_euclid(9.0) < 0.8;
            if band {
                rgb(196, 186, 168)
            } else {
                rgb(170, 152, 130) + DVec3::splat(5.0 * grain(p))
            }
        }
        BlockKind::Perimeter => paving.lerp(
            lawn,
            (0.5 + 1.2 * value_noise(p.x / 22.0, p.y / 22.0, 10)).clamp(0.0, 1.0),
        ),
        BlockKind::Works => rgb(150, 146, 138) + DVec3::splat(9.0 * mottle + 5.0 * grain(p)),
        BlockKind::Castle => rgb(150, 144, 108).lerp(lawn, (0.5 + mottle).clamp(0.0, 1.0)),
        _ => lawn,
    }
}

/// Fields of a patchwork: cells round jittered points, each with its crop and its furrows.
fn field(p: DVec2) -> DVec3 {
    const CELL: f64 = 165.0;
    let (i, j) = ((p.x / CELL).floor() as i64, (p.y / CELL).floor() as i64);
    let mut best = [(f64::INFINITY, 0, 0); 2];
    for n in 0..9 {
        let (a, b) = (i + n % 3 - 1, j + n / 3 - 1);
        let seed = DVec2::new(a as f64 + lattice(a, b, 21), b as f64 + lattice(a, b, 22)) * CELL;
        // Longer along the contour than across it.
        let distance = ((p - seed) * DVec2::new(0.8, 1.25)).length();
        if distance < best[0].0 {
            best = [(distance, a, b), best[0]];
        } else if distance < best[1].0 {
            best[1] = (distance, a, b);
        }
    }
    let [(near, a, b), (next, ..)] = best;
    if next - near < 3.2 {
        return rgb(74, 88, 48) + DVec3::splat(12.0 * grain(p));
    }
    let crop = lattice(a, b, 23);
    let furrows = DVec2::from_angle(lattice(a, b, 24) * 3.0);
    let stripe = (furrows.dot(p) * 1.4).sin();
    let soft = 9.0 * fractal_noise(p.x / 40.0, p.y / 40.0, 25);
    let (colour, striped) = match (crop * 6.0) as u32 {
        0 => (rgb(176, 162, 110), 6.0),
        1 => (rgb(138, 112, 84), 7.0),
        2 => (rgb(98, 120, 62), 4.0),
        3 => (rgb(150, 150, 92), 3.0),
        4 => (rgb(116, 132, 74), 0.0),
        _ => (rgb(122, 128, 70), 10.0),
    };
    colour + DVec3::splat(striped * stripe + soft + 3.0 * grain(p))
}

impl Canvas {
    fn point(&self, column: usize, row: usize) -> DVec2 {
        DVec2::new(
            self.west + (column as f64 + 0.5) * self.pixel_m,
            self.north - (row as f64 + 0.5) * self.pixel_m,
        )
    }

    fn country(&mut self) {
        // How wooded the country is changes slowly: a coarse lattice, linear between.
        const STEP: f64 = 8.0;
        let columns = (self.size[0] as f64 * self.pixel_m / STEP) as usize + 2;
        let rows = (self.size[1] as f64 * self.pixel_m / STEP) as usize + 2;
        let coarse: Vec<f64> = (0..columns * rows)
            .map(|k| {
                woods(
                    DVec2::new(self.west, self.north)
                        + DVec2::new((k % columns) as f64, -((k / columns) as f64)) * STEP,
                )
            })
            .collect();
        let wooded = |column: usize, row: usize| {
            let (x, y) = (
                (column as f64 + 0.5) * self.pixel_m / STEP,
                (row as f64 + 0.5) * self.pixel_m / STEP,
            );
            let (i, j) = (x as usize, y as usize);
            let at = |di: usize, dj: usize| coarse[(j + dj) * columns + i + di];
            let top = at(0, 0) + (at(1, 0) - at(0, 0)) * x.fract();
            let low = at(0, 1) + (at(1, 1) - at(0, 1)) * x.fract();
            top + (low - top) * y.fract()
        };
        let mut pixels = Vec::with_capacity(self.size[0] * self.size[1]);
        for row in 0..self.size[1] {
            for column in 0..self.size[0] {
                let p = self.point(column, row);
                let away = river_distance(p).abs() - river_half_width(p);
                pixels.push(if away < 0.0 {
                    let ripple = fractal_noise(p.x / 14.0, p.y / 5.0, 31);
                    let deep = (-away / 14.0).min(1.0);
                    rgb(112, 118, 98).lerp(rgb(58, 84, 84), deep) + DVec3::splat(5.0 * ripple)
                } else if away < 4.0 {
                    rgb(158, 150, 128) + DVec3::splat(8.0 * grain(p))
                } else if away < 22.0 {
                    rgb(102, 120, 64)
                        + DVec3::splat(8.0 * value_noise(p.x / 7.0, p.y / 7.0, 32) + 6.0 * grain(p))
                } else {
                    let forest_floor = rgb(62, 76, 42) + DVec3::splat(10.0 * grain(p));
                    field(p).lerp(forest_floor, (2.0 * wooded(column, row)).min(1.0))
                });
            }
        }
        self.pixels = pixels;
    }

    /// Paints the inside (even-odd) of rings; `colour` may decline a pixel.
    fn fill(&mut self, rings: &[Ring], colour: impl Fn(DVec2) -> Option<DVec3>) {
        self.repaint(rings, |p, _| colour(p));
    }

    /// Paints the inside of rings from the place and the colour before.
    fn repaint(&mut self, rings: &[Ring], colour: impl Fn(DVec2, DVec3) -> Option<DVec3>) {
        let points = || rings.iter().flatten();
        let top = points().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let low = points().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let row_of = |y: f64| {
            ((self.north - y) / self.pixel_m - 0.5)
                .ceil()
                .clamp(0.0, self.size[1] as f64) as usize
        };
        for row in row_of(top)..row_of(low) {
            let y = self.point(0, row).y;
            let mut crossings: Vec<f64> = rings
                .iter()
                .flat_map(|ring| super::shapes::edges(ring))
                .filter(|(a, b)| (a.y <= y) != (b.y <= y))
                .map(|(a, b)| a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y))
                .collect();
            crossings.sort_by(f64::total_cmp);
            for span in crossings.chunks_exact(2) {
                let column_of = |x: f64| {
                    ((x - self.west) / self.pixel_m - 0.5)
                        .ceil()
                        .clamp(0.0, self.size[0] as f64) as usize
                };
                for column in column_of(span[0])..column_of(span[1]) {
                    let index = row * self.size[0] + column;
                    if let Some(colour) = colour(self.point(column, row), self.pixels[index]) {
                        self.pixels[index] = colour;
                    }
                }
            }
        }
    }

    fn road(&mut self, line: &[DVec2], half_width: f64, colour: DVec3) {
        for pair in line.windows(2) {
            let aside = (pair[1] - pair[0]).normalize_or(DVec2::X).perp() * half_width;
            let strip = vec![pair[0] - aside, pair[1] - aside, pair[1] + aside, pair[0] + aside];
            self.fill(&[strip], |p| {
                dry(p).then(|| colour + DVec3::splat(5.0 * grain(p)))
            });
            let joint = super::shapes::round(pair[1], half_width, 12);
            self.fill(&[joint], |p| {
                dry(p).then(|| colour + DVec3::splat(5.0 * grain(p)))
            });
        }
    }

    /// A roof and the gutter round it.
    fn roof(&mut self, building: &SampleBuilding) {
        self.roofing(building);
        // Of what has a ridge, which has no holes.
        if building.ridge.is_some() {
            let ring = &building.ring;
            for (k, &a) in ring.iter().enumerate() {
                let b = ring[(k + 1) % ring.len()];
                let inward = (b - a).normalize_or_zero().perp() * GUTTER_M;
                self.fill(&[vec![a, b, b + inward, a + inward]], |_| {
                    Some(rgb(150, 144, 134))
                });
            }
        }
    }

    fn roofing(&mut self, building: &SampleBuilding) {
        let centre = centre(&building.ring);
        let chance = |seed: u64| lattice((centre.x * 10.0) as i64, (centre.y * 10.0) as i64, seed);
        let mut rings = vec![building.ring.clone()];
        rings.extend(building.holes.iter().cloned());
        let tint = chance(51);
        let Some(ridge) = building.ridge else {
            let base = match building.kind {
                "bridge" => rgb(128, 124, 118),
                "castle" | "castle tower" | "keep" | "bell tower" => rgb(156, 132, 108),
                "crossing dome" => rgb(118, 138, 124),
                "palace" => rgb(160, 102, 76),
                "silo" => rgb(190, 190, 186),
                _ => rgb(146, 143, 139) + DVec3::splat(26.0 * (tint - 0.5)),
            };
            // A parapet, and a little plant on flat roofs.
            let along = longest_direction(&building.ring);
            self.fill(&rings, |p| {
                let q = p - centre;
                let cell = DVec2::new(along.dot(q), along.perp().dot(q)) / 4.6;
                let plant = lattice(cell.x.floor() as i64, cell.y.floor() as i64, (tint * 1e6) as u64);
                let box_here = plant > 0.9 && (cell - cell.floor() - 0.5).abs().max_element() < 0.28;
                let lift = if box_here && building.kind != "bridge" {
                    34.0
                } else {
                    0.0
                };
                Some(base + DVec3::splat(lift + 4.0 * grain(p)))
            });
            return;
        };
        let base = match building.kind {
            "hall" => rgb(164, 168, 172),
            _ if tint < 0.72 => rgb(168, 96, 64).lerp(rgb(186, 124, 88), chance(52)),
            _ if tint < 0.9 => rgb(150, 84, 62).lerp(rgb(136, 92, 74), chance(52)),
            _ => rgb(112, 104, 100),
        };
        // Two slopes, one to the sun and one away from it, and courses of tiles along the ridge.
        let across = ridge.perp();
        let reach = building
            .ring
            .iter()
            .map(|p| (*p - centre).dot(across).abs())
            .fold(0.1, f64::max);
        let sun = DVec2::new(-0.71, -0.71);
        self.fill(&rings, |p| {
            let v = (p - centre).dot(across);
            let facing = across.dot(sun) * v.signum();
            let ridge_line = if v.abs() < 0.35 { 14.0 } else { 0.0 };
            let courses = 3.5 * (v * 7.0).sin();
            let weather =
                8.0 * value_noise(p.x / 5.0, p.y / 5.0, 53) - 10.0 * (v.abs() / reach - 0.7).max(0.0);
            Some(base * (1.0 + 0.13 * facing) + DVec3::splat(ridge_line + courses + weather + 5.0 * grain(p)))
        });
    }

    fn tree(&mut self, at: DVec2, radius: f64) {
        let tint = lattice((at.x * 8.0) as i64, (at.y * 8.0) as i64, 61);
        let leaf = rgb(58, 78, 38).lerp(rgb(92, 108, 54), tint);
        let crown = super::shapes::round(at, radius * 1.15, 14);
        let shade = crown
            .iter()
            .map(|p| *p + DVec2::new(0.9, 0.9) * (radius * 0.35))
            .collect();
        self.repaint(&[shade], |_, before| Some(before * 0.72));
        self.fill(&[crown], |p| {
            let q = (p - at) / radius;
            let leafy = 0.35 * value_noise(p.x / 1.1, p.y / 1.1, 62);
            (q.length() + leafy < 1.0).then(|| {
                let light = -0.30 * (q.x + q.y) + 0.5 * leafy;
                leaf * (1.0 + 0.5 * light) + DVec3::splat(4.0 * grain(p))
            })
        });
    }
}
