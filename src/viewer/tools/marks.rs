//! Lines in the city, drawn over the image: outlines of buildings, what is measured, what is drawn. What the city hides of them is faint.

use geo::MultiPolygon;
use glam::{DVec2, DVec3};

use crate::buildings::Building;
use crate::relief::pick;
use crate::scene::TileSet;
use crate::space::Projection;

/// A line through points of the city.
#[derive(Clone, Debug)]
pub struct Mark {
    points: Vec<DVec3>,
    colour: egui::Color32,
    /// A dot on every point.
    has_dots: bool,
}

/// Nearest distance ahead of the eye at which lines are drawn, metres.
const NEAR_M: f64 = 0.1;
/// Parts that a line is tested in, and how long one is in the image, pixels.
const MAX_PARTS: usize = 12;
const PART_PIXELS: f64 = 24.0;
/// A point counts as hidden by what is nearer to the eye by more than this: metres, and metres a metre.
const TOLERANCE: [f64; 2] = [0.25, 0.003];
const WIDTH: f32 = 2.0;
const DOT_RADIUS: f32 = 4.0;
/// Opacity of what is hidden.
const FAINT: f32 = 0.6;

/// A line, with a dot on every point.
pub fn line_mark(points: Vec<DVec3>, colour: egui::Color32) -> Mark {
    Mark {
        points,
        colour,
        has_dots: true,
    }
}

/// The edges of a building: its outline at the roof and at the base, and the corners' uprights.
pub fn building_marks(building: &Building, colour: egui::Color32) -> Vec<Mark> {
    outline_marks(&building.outline, [building.base_m, building.roof_m], colour)
}

/// The same of an outline between two elevations, metres.
pub fn outline_marks(
    outline: &MultiPolygon<f64>,
    [base_m, roof_m]: [f64; 2],
    colour: egui::Color32,
) -> Vec<Mark> {
    let rings = outline
        .iter()
        .flat_map(|polygon| std::iter::once(polygon.exterior()).chain(polygon.interiors()));
    let mut marks = Vec::new();
    for ring in rings {
        let at = |elevation: f64| {
            ring.coords()
                .map(move |vertex| DVec3::new(vertex.x, vertex.y, elevation))
        };
        let mut line = |points: Vec<DVec3>| {
            marks.push(Mark {
                points,
                colour,
                has_dots: false,
            });
        };
        line(at(roof_m).collect());
        line(at(base_m).collect());
        for (low, high) in at(base_m).zip(at(roof_m)).skip(1) {
            line(vec![low, high]);
        }
    }
    marks
}

/// The corners of a building's roof.
pub fn corners(building: &Building) -> Vec<DVec3> {
    let rings = building
        .outline
        .iter()
        .flat_map(|polygon| std::iter::once(polygon.exterior()).chain(polygon.interiors()));
    // A ring ends where it begins.
    let vertices = rings.flat_map(|ring| ring.coords().skip(1));
    vertices
        .map(|vertex| DVec3::new(vertex.x, vertex.y, building.roof_m))
        .collect()
}

/// Where a point lies in an image, pixels from its top left corner; none behind the eye.
pub fn pixel_of(projection: &Projection, point: DVec3) -> Option<DVec2> {
    let pose = &projection.pose;
    let relative = point - pose.eye;
    let ahead = relative.dot(pose.forward);
    if ahead < NEAR_M {
        return None;
    }
    let ndc = DVec2::new(relative.dot(pose.right), relative.dot(pose.up)) / ahead / projection.tan_half_fov();
    let size = DVec2::from_array(projection.size.map(f64::from));
    Some((ndc * DVec2::new(0.5, -0.5) + 0.5) * size)
}

/// The part of a line ahead of the eye.
fn ahead(projection: &Projection, [a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let pose = &projection.pose;
    let depth = |point: DVec3| (point - pose.eye).dot(pose.forward) - 2.0 * NEAR_M;
    let (da, db) = (depth(a), depth(b));
    match (da > 0.0, db > 0.0) {
        (true, true) => Some([a, b]),
        (false, false) => None,
        (true, false) => Some([a, a.lerp(b, da / (da - db))]),
        (false, true) => Some([a.lerp(b, da / (da - db)), b]),
    }
}

/// Paints marks over an image, whose pixels are so many to a point of the user interface.
pub fn paint_marks(
    painter: &egui::Painter,
    tiles: &TileSet,
    projection: &Projection,
    marks: &[Mark],
    pixels_per_point: f32,
) {
    let eye = projection.pose.eye;
    let is_seen = |point: DVec3| {
        let distance = point.distance(eye);
        let hit = pick(tiles, eye, (point - eye).normalize_or(DVec3::X));
        hit.is_none_or(|hit| f64::from(hit.t) > distance - TOLERANCE[0] - TOLERANCE[1] * distance)
    };
    let on_screen = |point: DVec3| {
        let pixel = pixel_of(projection, point)? / f64::from(pixels_per_point);
        Some(egui::pos2(pixel.x as f32, pixel.y as f32))
    };
    for mark in marks {
        for pair in mark.points.windows(2) {
            let Some([a, b]) = ahead(projection, [pair[0], pair[1]]) else {
                continue;
            };
            let length = match (pixel_of(projection, a), pixel_of(projection, b)) {
                (Some(from), Some(to)) => from.distance(to),
                _ => continue,
            };
            let parts = ((length / PART_PIXELS).ceil() as usize).clamp(1, MAX_PARTS);
            let at = |k: usize| a.lerp(b, k as f64 / parts as f64);
            for k in 0..parts {
                let (Some(from), Some(to)) = (on_screen(at(k)), on_screen(at(k + 1))) else {
                    continue;
                };
                let seen = is_seen(at(k).lerp(at(k + 1), 0.5));
                let colour = if seen {
                    mark.colour
                } else {
                    mark.colour.gamma_multiply(FAINT)
                };
                painter.line_segment([from, to], egui::Stroke::new(WIDTH, colour));
            }
        }
        if mark.has_dots {
            for point in mark.points.iter().filter_map(|&point| on_screen(point)) {
                painter.circle_filled(point, DOT_RADIUS, mark.colour);
            }
        }
    }
}
