//! A section through a lens with traced rays, as SVG: glass, stop, sensor, and beams at three angles.

use std::fmt::Write;

use glam::DVec2;

use super::lens::{Glass, Lens, Surface};
use super::paraxial::Paraxial;
use super::path::{Ghost, path};
use super::trace::{Tracer, beam_direction};

/// Rays in a beam.
const RAYS: i32 = 7;
/// Colour of each beam: axis, centre, edge of the field.
const COLOURS: [&str; 3] = ["#c0392b", "#2471a3", "#1e8449"];
/// Blank space round the drawing, millimetres.
const MARGIN_MM: f64 = 4.0;

/// The drawing, in millimetres. With a ghost, its rays at the centre angle alone. `angles` in radians.
pub fn lens_diagram(lens: &Lens, wavelength_um: f64, angles: &[f64], ghost: Option<Ghost>) -> String {
    let paraxial = Paraxial::new(lens, wavelength_um, None);
    let vertices = vertex_positions(lens);
    let sensor_z = vertices.last().copied().unwrap_or(0.0) + paraxial.sensor_gap_mm();
    let clear = |surface: usize| {
        let known = lens.surfaces[surface].semi_diameter_mm;
        known.unwrap_or_else(|| 1.2 * paraxial.entrance_pupil(lens.clear_radius(lens.stop).min(20.0)))
    };
    let half_film = 0.5 * lens.film_mm[0];
    let tallest = (0..lens.surfaces.len()).map(clear).fold(half_film, f64::max);
    let lead_in = 0.35 * (sensor_z + 20.0);
    let (left, right) = (-lead_in, sensor_z.max(0.0) + MARGIN_MM);
    let height = 2.0 * (tallest + MARGIN_MM);
    let mut svg = String::new();
    let mut draw = |text: std::fmt::Arguments<'_>| {
        // Writing to a string cannot fail.
        let _ = svg.write_fmt(text);
        svg.push('\n');
    };
    draw(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{left:.3} {:.3} {:.3} {height:.3}\" width=\"1200\">",
        -0.5 * height,
        right - left,
    ));
    draw(format_args!(
        "<rect x=\"{left:.3}\" y=\"{:.3}\" width=\"100%\" height=\"100%\" fill=\"#fbfaf7\"/>",
        -0.5 * height
    ));
    draw(format_args!(
        "<path d=\"M{left:.3} 0H{right:.3}\" stroke=\"#999\" stroke-width=\"0.15\" stroke-dasharray=\"3 1 0.6 1\"/>"
    ));
    for index in 0..lens.surfaces.len().saturating_sub(1) {
        if lens.surfaces[index].glass != Glass::Air {
            let outline = element(lens, &vertices, index, clear(index), clear(index + 1));
            draw(format_args!(
                "<path d=\"{outline}\" fill=\"#cfe4ee\" fill-opacity=\"0.8\" stroke=\"#34596b\" stroke-width=\"0.25\"/>"
            ));
        }
    }
    let stop_z = vertices[lens.stop];
    let stop = clear(lens.stop);
    for side in [-1.0, 1.0] {
        draw(format_args!(
            "<path d=\"M{stop_z:.3} {:.3}V{:.3}\" stroke=\"#222\" stroke-width=\"0.8\"/>",
            side * stop,
            side * (stop + 0.25 * tallest).min(tallest + 1.0),
        ));
    }
    draw(format_args!(
        "<path d=\"M{sensor_z:.3} {:.3}V{half_film:.3}\" stroke=\"#222\" stroke-width=\"0.6\"/>",
        -half_film
    ));
    let tracer = Tracer::new(lens, wavelength_um, paraxial.sensor_gap_mm());
    let paths: Vec<Option<Ghost>> = match ghost {
        Some(ghost) => vec![None, Some(ghost)],
        None => vec![None],
    };
    let pupil = paraxial.entrance_pupil(stop);
    for ghost_path in paths {
        for (angle, colour) in angles.iter().zip(COLOURS.iter().cycle()) {
            let colour = if ghost_path.is_some() { "#d68910" } else { colour };
            // Aim at the pupil: what the stop lets through, by the paraxial image of its centre.
            let ma = paraxial.matrices(ghost_path).ma;
            let aim = -ma.y_axis.x * angle.tan() / ma.x_axis.x;
            let half_extent = if ghost_path.is_some() {
                clear(lens.stop) / ma.x_axis.x.abs()
            } else {
                pupil
            };
            for ray in 0..RAYS {
                let height = aim + half_extent * (2.0 * f64::from(ray) / f64::from(RAYS - 1) - 1.0) * 0.98;
                let entry = DVec2::new(height.clamp(-clear(0), clear(0)), 0.0);
                let Some(points) =
                    tracer.points(ghost_path, entry, beam_direction(*angle), &vertices, sensor_z)
                else {
                    continue;
                };
                let first = points[0];
                let start = first.x - (first.x - left).max(0.0);
                let mut line = format!("M{start:.3} {:.3}", -(first.y - (first.x - start) * angle.tan()));
                for point in &points {
                    let _ = write!(line, "L{:.3} {:.3}", point.x, -point.y);
                }
                draw(format_args!(
                    "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"0.18\"/>"
                ));
            }
        }
    }
    draw(format_args!("</svg>"));
    svg
}

/// Position of each vertex on the axis, the first at 0, millimetres.
fn vertex_positions(lens: &Lens) -> Vec<f64> {
    lens.surfaces
        .iter()
        .scan(0.0, |z, surface| {
            let here = *z;
            *z += surface.thickness_mm;
            Some(here)
        })
        .collect()
}

/// Outline of the glass between a surface and the next.
fn element(lens: &Lens, vertices: &[f64], index: usize, front: f64, back: f64) -> String {
    let edge = front.max(back);
    let curve = |surface: &Surface, z: f64, clear: f64, down: bool| -> Vec<DVec2> {
        (0..=24)
            .map(|k| {
                let fraction = f64::from(k) / 12.0 - 1.0;
                let y = clear * if down { -fraction } else { fraction };
                DVec2::new(z + surface.sag(y), y)
            })
            .collect()
    };
    let (first, second) = (&lens.surfaces[index], &lens.surfaces[index + 1]);
    let mut points = curve(first, vertices[index], front, true);
    points.push(DVec2::new(points[24].x, -edge));
    let behind = curve(second, vertices[index + 1], back, false);
    points.push(DVec2::new(behind[0].x, -edge));
    points.extend(&behind);
    points.push(DVec2::new(behind[24].x, edge));
    points.push(DVec2::new(points[0].x, edge));
    let mut outline = String::new();
    for (k, point) in points.iter().enumerate() {
        let _ = write!(
            outline,
            "{}{:.3} {:.3}",
            if k == 0 { "M" } else { "L" },
            point.x,
            -point.y
        );
    }
    outline + "Z"
}

impl Tracer<'_> {
    /// The ray's points as (position on the axis, height) in its plane, from the first surface to the sensor; none when it is
    /// vignetted or the stop holds it.
    fn points(
        &self,
        ghost: Option<Ghost>,
        entry: DVec2,
        direction: glam::DVec3,
        vertices: &[f64],
        sensor_z: f64,
    ) -> Option<Vec<DVec2>> {
        let (ray, met) = self.trace_points(ghost, entry, direction)?;
        if !ray.is_alive() {
            return None;
        }
        let mut points: Vec<DVec2> = path(vertices.len(), ghost)
            .iter()
            .zip(&met)
            .map(|(step, at)| DVec2::new(vertices[step.surface] + at.z, at.x))
            .collect();
        points.push(DVec2::new(sensor_z, ray.sensor_mm.x));
        Some(points)
    }
}
