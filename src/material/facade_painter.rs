//! The facades: of each kind four bands of one storey by two bays, which differ a little so that a wall of them does not look stamped.
//! Deterministic.

use super::FacadeStyle;
use super::brickwork::{Courses, corrugated, courses, panels, render};
use super::canvas::{Canvas, Rect, TILE_SIZE, Texel};
use super::noise::hash;
use super::openings::{Window, door, gate, shop_front, shutters, surround, window};

/// Which storeys a tile is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacadeBand {
    /// The ground floor.
    Ground,
    /// A ground floor of shops.
    Shop,
    /// Those between.
    Middle,
    /// The uppermost, with the cornice.
    Top,
}

impl FacadeBand {
    /// All, by their numbers in shaders.
    pub const ALL: [Self; 4] = [Self::Ground, Self::Shop, Self::Middle, Self::Top];
}

const SANDSTONE: [f32; 3] = [0.50, 0.44, 0.34];
const DARK: [f32; 3] = [0.06, 0.065, 0.07];
const OAK: [f32; 3] = [0.10, 0.065, 0.04];
const BRICK: Courses = Courses {
    brick_m: [0.225, 0.075],
    joint_m: 0.012,
    depth_m: 0.004,
    variation: 0.34,
    joint: 1.35,
};
const ASHLAR: Courses = Courses {
    brick_m: [0.85, 0.41],
    joint_m: 0.014,
    depth_m: 0.006,
    variation: 0.10,
    joint: 0.70,
};

/// Places of a texel along u and v whose mean shows joints.
const JOINT_SAMPLES: [usize; 2] = [2, 4];

/// Paints one band of a kind of facade.
pub fn paint_facade(style: FacadeStyle, band: FacadeBand) -> Canvas {
    let (bay, storey) = (style.bay_m() as f32, style.storey_m() as f32);
    let width = 2.0 * bay;
    let wall = |position: [f32; 2]| match style {
        FacadeStyle::Brick => courses(position, width, BRICK),
        FacadeStyle::Stone => courses(position, width, ASHLAR),
        FacadeStyle::Shed => corrugated(position, width),
        FacadeStyle::Concrete => panels(position, width, [bay, storey]),
        FacadeStyle::CurtainWall => Texel::wall(1.0, 0.0),
        FacadeStyle::Render | FacadeStyle::HalfTimber | FacadeStyle::House => render(position, width),
    };
    let has_courses = matches!(style, FacadeStyle::Brick | FacadeStyle::Stone);
    let samples = if has_courses { JOINT_SAMPLES } else { [1, 1] };
    let mut canvas = Canvas::sampled([width, storey], samples, wall);
    for variant in 0..2 {
        let bay = Bay {
            west: variant as f32 * bay,
            width: bay,
            storey,
            variant,
        };
        match style {
            FacadeStyle::Render => render_bay(&mut canvas, bay, band),
            FacadeStyle::Brick => brick_bay(&mut canvas, bay, band),
            FacadeStyle::Stone => stone_bay(&mut canvas, bay, band),
            FacadeStyle::CurtainWall => curtain_wall_bay(&mut canvas, bay, band),
            FacadeStyle::Concrete => concrete_bay(&mut canvas, bay, band),
            FacadeStyle::Shed => shed_bay(&mut canvas, bay, band),
            FacadeStyle::HalfTimber => half_timber_bay(&mut canvas, bay, band),
            FacadeStyle::House => house_bay(&mut canvas, bay, band),
        }
    }
    // Walls are darker and greyer at the foot, where rain splashes.
    if band == FacadeBand::Ground {
        canvas.paint([0.0, 0.0, width, 0.45], |[x, y], under| {
            let splash = 0.18 * (1.0 - y / 0.45) * (0.6 + 0.4 * hash((x * 30.0) as u32, 1, 2));
            under.scaled(1.0 - splash * under.tint)
        });
    }
    canvas
}

/// One bay of a tile.
#[derive(Clone, Copy)]
struct Bay {
    west: f32,
    width: f32,
    storey: f32,
    variant: u32,
}

impl Bay {
    /// A rectangle about the bay's centre: `width` metres, from `bottom` to `top`.
    fn centred(self, width: f32, bottom: f32, top: f32) -> Rect {
        let centre = self.west + 0.5 * self.width;
        [centre - 0.5 * width, bottom, centre + 0.5 * width, top]
    }

    /// The whole width.
    fn across(self, bottom: f32, top: f32) -> Rect {
        [self.west, bottom, self.west + self.width, top]
    }

    /// How much a curtain covers of a window.
    fn curtain(self, seed: u32) -> f32 {
        let chance = hash(self.variant, seed, 13);
        if chance < 0.45 { 0.0 } else { 0.7 * (chance - 0.35) }
    }

    fn shop(self, canvas: &mut Canvas, head: f32) {
        let colours = [[0.05, 0.10, 0.08], [0.16, 0.05, 0.04]];
        let awning = (self.variant == 1).then_some([0.30, 0.07, 0.05]);
        let pier = 0.16;
        let span = [self.west + pier, self.west + self.width - pier];
        shop_front(canvas, span, head, colours[self.variant as usize], awning);
    }
}

/// A moulding of some courses over the whole width.
fn moulding(canvas: &mut Canvas, bay: Bay, bottom: f32, top: f32, stands_out_m: f32) {
    let height = top - bottom;
    canvas.paint(bay.across(bottom, top), |[_, y], _| {
        let step = (y / height * 3.0).floor() / 3.0;
        Texel::dull(
            SANDSTONE.map(|c| c * (0.92 + 0.16 * step)),
            stands_out_m * (0.4 + 0.6 * step),
        )
    });
}

fn render_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    let curtained = Window {
        curtain: bay.curtain(1),
        ..Window::CASEMENT
    };
    let opening = bay.centred(1.05, 0.85, 2.35);
    match band {
        FacadeBand::Shop => bay.shop(canvas, bay.storey - 0.25),
        FacadeBand::Ground if bay.variant == 1 => {
            surround(canvas, bay.centred(1.1, 0.0, 2.5), 0.14, SANDSTONE);
            door(canvas, bay.centred(1.1, 0.0, 2.5), [0.07, 0.11, 0.09]);
        }
        _ => {
            surround(canvas, opening, 0.12, SANDSTONE.map(|c| 1.15 * c));
            window(canvas, opening, curtained);
            if band == FacadeBand::Middle {
                shutters(canvas, opening, [0.10, 0.15, 0.13]);
            }
        }
    }
    match band {
        FacadeBand::Top => moulding(canvas, bay, bay.storey - 0.34, bay.storey, 0.30),
        FacadeBand::Ground => canvas.fill(
            bay.across(0.0, 0.5),
            Texel::dull(SANDSTONE.map(|c| 0.7 * c), 0.03),
        ),
        _ => {}
    }
    if matches!(band, FacadeBand::Ground | FacadeBand::Shop) {
        moulding(canvas, bay, bay.storey - 0.16, bay.storey, 0.08);
    }
}

fn brick_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    let opening = bay.centred(1.0, 0.75, 2.35);
    let sash = Window {
        panes: [2, 2],
        bar_m: 0.045,
        curtain: bay.curtain(2),
        ..Window::CASEMENT
    };
    match band {
        FacadeBand::Shop => bay.shop(canvas, bay.storey - 0.2),
        FacadeBand::Ground if bay.variant == 1 => {
            canvas.fill(bay.centred(1.5, 2.42, 2.66), Texel::dull(SANDSTONE, 0.03));
            door(canvas, bay.centred(1.05, 0.0, 2.4), [0.13, 0.03, 0.03]);
        }
        _ => {
            // A flat arch of gauged bricks, splayed.
            canvas.paint(bay.centred(1.4, 2.35, 2.62), |[x, _], under| {
                let joint = (x / 0.075).fract() < 0.14;
                let shade = if joint { 0.8 } else { 1.12 };
                Texel::wall(shade, under.height_m + 0.004)
            });
            window(canvas, opening, sash);
        }
    }
    match band {
        FacadeBand::Top => moulding(canvas, bay, bay.storey - 0.26, bay.storey, 0.22),
        FacadeBand::Ground | FacadeBand::Shop => {
            canvas.fill(
                bay.across(bay.storey - 0.14, bay.storey),
                Texel::dull(SANDSTONE, 0.05),
            );
        }
        FacadeBand::Middle => {}
    }
}

fn stone_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    let opening = bay.centred(1.25, 0.55, 2.85);
    let tall = Window {
        panes: [2, 3],
        bar_m: 0.05,
        depth_m: 0.22,
        curtain: bay.curtain(3),
        ..Window::CASEMENT
    };
    let light = SANDSTONE.map(|c| 1.2 * c);
    match band {
        FacadeBand::Shop => bay.shop(canvas, bay.storey - 0.35),
        FacadeBand::Ground => {
            // Rustication: deep joints.
            for course in 0..8 {
                let y = 0.46 * course as f32;
                canvas.paint(bay.across(y, y + 0.05), |_, under| Texel {
                    height_m: -0.03,
                    ..under.scaled(0.72)
                });
            }
            if bay.variant == 1 {
                surround(canvas, bay.centred(1.5, 0.0, 2.95), 0.2, light);
                door(canvas, bay.centred(1.5, 0.0, 2.95), OAK);
            } else {
                surround(canvas, bay.centred(1.25, 0.9, 2.75), 0.16, light);
                window(canvas, bay.centred(1.25, 0.9, 2.75), tall);
            }
        }
        FacadeBand::Middle | FacadeBand::Top => {
            surround(canvas, opening, 0.18, light);
            // An entablature over the opening.
            canvas.fill(bay.centred(1.75, 2.98, 3.16), Texel::dull(light, 0.14));
            canvas.fill(
                bay.centred(1.5, 3.16, 3.24),
                Texel::dull(light.map(|c| 0.9 * c), 0.09),
            );
            window(canvas, opening, tall);
        }
    }
    match band {
        FacadeBand::Top => moulding(canvas, bay, bay.storey - 0.42, bay.storey, 0.45),
        FacadeBand::Ground | FacadeBand::Shop => moulding(canvas, bay, bay.storey - 0.26, bay.storey, 0.16),
        FacadeBand::Middle => canvas.fill(bay.across(0.0, 0.1), Texel::dull(light, 0.05)),
    }
}

fn curtain_wall_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    let spandrel = match band {
        FacadeBand::Ground | FacadeBand::Shop => 0.12,
        _ => 0.95,
    };
    let blind = bay.curtain(4) * 0.8;
    let top = bay.storey - 0.06;
    window(
        canvas,
        bay.across(spandrel, top),
        Window {
            frame: DARK.map(|c| 2.2 * c),
            bar_m: 0.05,
            panes: [2, 1],
            depth_m: 0.05,
            curtain: blind,
            sill_m: 0.0,
        },
    );
    // Spandrels are glass before a panel of the building's colour.
    canvas.paint(bay.across(0.0, spandrel), |[x, _], under| {
        let is_joint = (x % (0.5 * bay.width)) < 0.04;
        Texel {
            height_m: if is_joint { -0.02 } else { 0.0 },
            glass: if is_joint { 0.0 } else { 0.35 },
            ..under.scaled(if is_joint { 0.5 } else { 1.0 })
        }
    });
    if band == FacadeBand::Top {
        canvas.paint(bay.across(bay.storey - 0.8, bay.storey), |[_, y], _| {
            let slat = (y / 0.16).fract();
            Texel::wall(0.55 + 0.35 * slat, 0.03 * slat)
        });
    }
}

fn concrete_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    let wide = Window {
        panes: [3, 1],
        frame: [0.55, 0.55, 0.53],
        curtain: bay.curtain(5),
        ..Window::CASEMENT
    };
    match band {
        FacadeBand::Shop => bay.shop(canvas, bay.storey - 0.2),
        FacadeBand::Ground if bay.variant == 1 => {
            canvas.fill(bay.centred(2.6, 2.35, 2.5), Texel::dull([0.35; 3], 0.6));
            window(
                canvas,
                bay.centred(2.0, 0.0, 2.3),
                Window {
                    sill_m: 0.0,
                    panes: [2, 1],
                    frame: DARK,
                    ..wide
                },
            );
        }
        _ if bay.variant == 1 && band != FacadeBand::Ground => {
            // A loggia: a dark recess, a door of glass, a parapet before it.
            canvas.fill(bay.centred(2.9, 0.0, 2.55), Texel::dull([0.22, 0.21, 0.20], -0.9));
            window(
                canvas,
                bay.centred(2.3, 0.1, 2.35),
                Window {
                    sill_m: 0.0,
                    depth_m: 1.0,
                    panes: [2, 1],
                    ..wide
                },
            );
            canvas.paint(bay.centred(3.0, 0.0, 0.98), |[x, _], _| {
                let rib = (x / 0.5).fract() < 0.06;
                Texel {
                    tint: 1.0,
                    ..Texel::wall(if rib { 0.75 } else { 1.1 }, 0.10)
                }
            });
        }
        _ => window(canvas, bay.centred(2.1, 0.9, 2.3), wide),
    }
    if band == FacadeBand::Top {
        canvas.fill(bay.across(bay.storey - 0.22, bay.storey), Texel::wall(0.8, 0.06));
    }
}

fn shed_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    match band {
        FacadeBand::Ground | FacadeBand::Shop => {
            canvas.paint(bay.across(0.0, 0.5), |_, _| Texel::dull([0.34, 0.33, 0.31], 0.03));
            if bay.variant == 1 {
                gate(canvas, bay.centred(3.2, 0.0, 3.4), [0.44, 0.45, 0.45]);
            } else {
                window(
                    canvas,
                    bay.centred(2.8, 2.9, 3.7),
                    Window {
                        frame: [0.4; 3],
                        panes: [4, 1],
                        sill_m: 0.02,
                        ..Window::CASEMENT
                    },
                );
            }
        }
        FacadeBand::Middle => window(
            canvas,
            bay.across(1.9, 2.9),
            Window {
                frame: [0.4; 3],
                panes: [4, 1],
                sill_m: 0.02,
                ..Window::CASEMENT
            },
        ),
        FacadeBand::Top => {
            canvas.fill(
                bay.across(bay.storey - 0.3, bay.storey),
                Texel::dull([0.40, 0.41, 0.42], 0.08),
            );
        }
    }
}

fn half_timber_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    let opening = bay.centred(0.85, 0.95, 2.05);
    let beam = Texel::dull(OAK, 0.015);
    if band == FacadeBand::Shop {
        bay.shop(canvas, bay.storey - 0.3);
    } else {
        for x in [
            0.0,
            0.5 * bay.width - 0.62,
            0.5 * bay.width + 0.46,
            bay.width - 0.08,
        ] {
            canvas.fill([bay.west + x, 0.0, bay.west + x + 0.16, bay.storey], beam);
        }
        canvas.fill(bay.across(0.82, 0.95), beam);
        // A brace in the field beside the window.
        let [across_m, up_m] = [0, 1].map(|axis: usize| canvas.size_m[axis] / TILE_SIZE[axis] as f32);
        canvas.paint(
            [
                bay.west + 0.16,
                0.95,
                bay.west + 0.5 * bay.width - 0.62,
                bay.storey - 0.2,
            ],
            |[x, y], under| {
                let run = 0.5 * bay.width - 0.78;
                let rise = bay.storey - 1.15;
                let along = if bay.variant == 0 { x } else { run - x };
                let beside_m = (y - along / run * rise).abs() - 0.17;
                // Texels on its edge are mixed by how much of them it covers.
                let edge_m = up_m + across_m * rise / run;
                under.mixed(beam, (0.5 - beside_m / edge_m).clamp(0.0, 1.0))
            },
        );
        if band == FacadeBand::Ground && bay.variant == 1 {
            door(canvas, bay.centred(0.92, 0.0, 2.2), [0.09, 0.05, 0.03]);
        } else {
            let panes = Window {
                panes: [2, 3],
                bar_m: 0.035,
                curtain: bay.curtain(6),
                ..Window::CASEMENT
            };
            window(canvas, opening, panes);
        }
    }
    canvas.fill(bay.across(0.0, 0.14), beam);
    canvas.fill(bay.across(bay.storey - 0.2, bay.storey), beam);
}

fn house_bay(canvas: &mut Canvas, bay: Bay, band: FacadeBand) {
    let plain = Window {
        curtain: bay.curtain(8),
        ..Window::CASEMENT
    };
    match (band, bay.variant) {
        (FacadeBand::Shop, _) => bay.shop(canvas, bay.storey - 0.3),
        (FacadeBand::Ground, 1) => door(canvas, bay.centred(1.05, 0.0, 2.25), [0.20, 0.11, 0.05]),
        (FacadeBand::Ground, _) => window(
            canvas,
            bay.centred(1.6, 0.9, 2.15),
            Window {
                panes: [3, 1],
                ..plain
            },
        ),
        _ => window(canvas, bay.centred(1.15, 0.95, 2.15), plain),
    }
    if band == FacadeBand::Top {
        canvas.fill(
            bay.across(bay.storey - 0.2, bay.storey),
            Texel::dull([0.60, 0.58, 0.54], 0.12),
        );
    }
    if band == FacadeBand::Ground {
        canvas.fill(bay.across(0.0, 0.3), Texel::dull([0.30, 0.29, 0.27], 0.02));
    }
}
