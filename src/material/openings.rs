//! Windows, doors and shop fronts, to be set into walls.

use super::canvas::{Canvas, Rect, Texel};
use super::noise::hash;

/// Reflectance of what is seen behind glass by day.
const ROOM: [f32; 3] = [0.035, 0.038, 0.042];
const WHITE: [f32; 3] = [0.72, 0.71, 0.68];
const CURTAIN: [f32; 3] = [0.34, 0.33, 0.30];

/// How a window looks.
#[derive(Clone, Copy)]
pub struct Window {
    /// Colour of its frame, linear sRGB.
    pub frame: [f32; 3],
    /// Width of the frame's bars, metres.
    pub bar_m: f32,
    /// Panes across and up.
    pub panes: [u32; 2],
    /// How deep it lies in the wall, metres.
    pub depth_m: f32,
    /// What of it curtains cover, 0 to 1 from above.
    pub curtain: f32,
    /// How far the sill stands out, metres.
    pub sill_m: f32,
}

impl Window {
    /// A white casement of two lights.
    pub const CASEMENT: Self = Self {
        frame: WHITE,
        bar_m: 0.06,
        panes: [2, 1],
        depth_m: 0.12,
        curtain: 0.0,
        sill_m: 0.06,
    };
}

fn glass(depth_m: f32) -> Texel {
    Texel {
        albedo: ROOM,
        height_m: -depth_m,
        glass: 1.0,
        tint: 0.0,
    }
}

/// Sets a window into the wall.
pub fn window(canvas: &mut Canvas, [x0, y0, x1, y1]: Rect, window: Window) {
    let Window {
        frame,
        bar_m,
        panes,
        depth_m,
        curtain,
        sill_m,
    } = window;
    canvas.fill([x0, y0, x1, y1], Texel::dull(frame, -depth_m));
    let step = [(x1 - x0) / panes[0] as f32, (y1 - y0) / panes[1] as f32];
    let edge = y1 - curtain * (y1 - y0);
    for k in 0..panes[0] * panes[1] {
        let (x, y) = (
            x0 + (k % panes[0]) as f32 * step[0],
            y0 + (k / panes[0]) as f32 * step[1],
        );
        let pane = [
            x + bar_m,
            y + bar_m,
            x + step[0] - 0.5 * bar_m,
            y + step[1] - 0.5 * bar_m,
        ];
        canvas.paint(pane, |position, _| {
            let behind = glass(depth_m + 0.02);
            match pane[1] + position[1] > edge {
                true => Texel {
                    albedo: CURTAIN.map(|c| c * (0.85 + 0.15 * (40.0 * position[0]).sin())),
                    ..behind
                },
                false => behind,
            }
        });
    }
    if sill_m > 0.0 {
        canvas.fill(
            [x0 - 0.06, y0 - 0.09, x1 + 0.06, y0],
            Texel::dull([0.52, 0.50, 0.46], sill_m),
        );
    }
}

/// A flat surround of stone about an opening.
pub fn surround(canvas: &mut Canvas, [x0, y0, x1, y1]: Rect, width_m: f32, albedo: [f32; 3]) {
    let stone = Texel::dull(albedo, 0.04);
    canvas.fill([x0 - width_m, y0, x0, y1 + width_m], stone);
    canvas.fill([x1, y0, x1 + width_m, y1 + width_m], stone);
    canvas.fill([x0, y1, x1, y1 + width_m], stone);
}

/// Louvred shutters at both sides of a window.
pub fn shutters(canvas: &mut Canvas, [x0, y0, x1, y1]: Rect, albedo: [f32; 3]) {
    let width = 0.5 * (x1 - x0);
    for x in [x0 - width, x1] {
        canvas.paint([x + 0.02, y0, x + width - 0.02, y1], |[_, y], _| {
            let slat = (y / 0.055).fract();
            Texel::dull(albedo.map(|c| c * (0.72 + 0.28 * slat)), 0.03 + 0.012 * slat)
        });
    }
}

/// A door of boards with a light over it.
pub fn door(canvas: &mut Canvas, [x0, y0, x1, y1]: Rect, albedo: [f32; 3]) {
    canvas.fill(
        [x0 - 0.08, y0, x1 + 0.08, y1 + 0.08],
        Texel::dull(WHITE.map(|c| 0.8 * c), 0.0),
    );
    canvas.paint([x0, y0, x1, y1 - 0.4], |[x, y], _| {
        let (u, v) = (x / (x1 - x0), y / (y1 - y0 - 0.4));
        let is_panel = (0.14..0.86).contains(&u) && ((0.08..0.42).contains(&v) || (0.50..0.92).contains(&v));
        Texel::dull(albedo, if is_panel { -0.10 } else { -0.07 })
    });
    canvas.fill([x0, y1 - 0.36, x1, y1], glass(0.1));
}

/// A gate of horizontal slats, as of a garage or a hall.
pub fn gate(canvas: &mut Canvas, rect: Rect, albedo: [f32; 3]) {
    canvas.paint(rect, |[_, y], _| {
        let slat = (y / 0.42).fract();
        let shade = if slat < 0.06 { 0.6 } else { 1.0 };
        Texel::dull(albedo.map(|c| c * shade), if slat < 0.06 { -0.11 } else { -0.09 })
    });
}

/// A shop front: a base, panes between posts, a fascia; `awning`: a striped one over it.
pub fn shop_front(
    canvas: &mut Canvas,
    [x0, x1]: [f32; 2],
    top: f32,
    colour: [f32; 3],
    awning: Option<[f32; 3]>,
) {
    canvas.fill([x0, 0.0, x1, top], Texel::dull(colour, 0.02));
    let door = x0 + 0.62 * (x1 - x0);
    let head = top - 0.62;
    for [from, to, sill] in [[x0 + 0.12, door - 0.06, 0.5], [door, x1 - 0.16, 0.06]] {
        canvas.paint([from, sill, to, head], |[_, y], _| {
            // Goods in the window are lighter below.
            let goods = 0.05 + 0.10 * (-2.0 * y).exp() * hash((from * 40.0) as u32, (y * 9.0) as u32, 21);
            Texel {
                albedo: [goods * 1.1, goods, goods * 0.85],
                ..glass(0.1)
            }
        });
    }
    canvas.fill(
        [x0 + 0.06, head + 0.1, x1 - 0.06, top - 0.08],
        Texel::dull(colour.map(|c| 0.55 * c + 0.06), 0.08),
    );
    if let Some(stripe) = awning {
        canvas.paint([x0 + 0.04, head - 0.28, x1 - 0.04, head + 0.12], |[x, y], _| {
            let is_white = (x / 0.32) as i32 % 2 == 0;
            let colour = if is_white { [0.70, 0.68, 0.62] } else { stripe };
            Texel::dull(colour.map(|c| c * (0.75 + 0.6 * y)), 0.30 - 0.5 * y)
        });
    }
}
