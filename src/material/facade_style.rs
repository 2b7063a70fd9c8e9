//! What facades and roofs there are.

use serde::{Deserialize, Serialize};

/// A kind of facade.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FacadeStyle {
    /// Rendered wall, windows with shutters: a terraced town house.
    Render,
    /// Brick with sash windows.
    Brick,
    /// Dressed stone, tall windows with surrounds.
    Stone,
    /// Glass between mullions, spandrels between storeys.
    CurtainWall,
    /// Concrete panels, wide windows and balconies.
    Concrete,
    /// Corrugated sheet with high windows and gates.
    Shed,
    /// Timber frame with rendered panels.
    HalfTimber,
    /// A detached house: rendered, small windows.
    House,
}

impl FacadeStyle {
    /// All of them, by their numbers in a building's code.
    pub const ALL: [Self; 8] = [
        Self::Render,
        Self::Brick,
        Self::Stone,
        Self::CurtainWall,
        Self::Concrete,
        Self::Shed,
        Self::HalfTimber,
        Self::House,
    ];

    /// The width that a bay comes near to, metres.
    pub fn bay_m(self) -> f64 {
        match self {
            Self::Render => 3.0,
            Self::Brick => 2.8,
            Self::Stone => 3.4,
            Self::CurtainWall => 3.0,
            Self::Concrete => 3.6,
            Self::Shed => 4.2,
            Self::HalfTimber => 2.6,
            Self::House => 3.6,
        }
    }

    /// The height that a storey comes near to, metres.
    pub fn storey_m(self) -> f64 {
        match self {
            Self::Render => 3.1,
            Self::Brick => 3.0,
            Self::Stone => 3.7,
            Self::CurtainWall => 3.6,
            Self::Concrete => 2.9,
            Self::Shed => 4.5,
            Self::HalfTimber => 2.7,
            Self::House => 2.9,
        }
    }

    /// Colours of its walls, linear sRGB; a building has one of them.
    pub fn colours(self) -> [[f32; 3]; 4] {
        match self {
            Self::Render => [
                [0.66, 0.58, 0.45],
                [0.70, 0.67, 0.60],
                [0.58, 0.42, 0.28],
                [0.56, 0.53, 0.47],
            ],
            Self::Brick => [
                [0.30, 0.13, 0.085],
                [0.36, 0.18, 0.11],
                [0.42, 0.30, 0.19],
                [0.24, 0.11, 0.08],
            ],
            Self::Stone => [
                [0.55, 0.49, 0.39],
                [0.50, 0.47, 0.41],
                [0.60, 0.55, 0.46],
                [0.44, 0.41, 0.36],
            ],
            Self::CurtainWall => [
                [0.20, 0.23, 0.26],
                [0.12, 0.13, 0.14],
                [0.42, 0.43, 0.43],
                [0.24, 0.21, 0.17],
            ],
            Self::Concrete => [
                [0.46, 0.45, 0.42],
                [0.52, 0.49, 0.43],
                [0.40, 0.40, 0.39],
                [0.58, 0.56, 0.52],
            ],
            Self::Shed => [
                [0.42, 0.44, 0.46],
                [0.30, 0.36, 0.42],
                [0.50, 0.48, 0.43],
                [0.26, 0.33, 0.28],
            ],
            Self::HalfTimber => [
                [0.72, 0.68, 0.59],
                [0.70, 0.60, 0.43],
                [0.62, 0.48, 0.36],
                [0.74, 0.72, 0.67],
            ],
            Self::House => [
                [0.68, 0.65, 0.59],
                [0.62, 0.54, 0.42],
                [0.54, 0.56, 0.54],
                [0.72, 0.70, 0.66],
            ],
        }
    }
}

/// A kind of flat roof's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RoofStyle {
    /// Gravel over felt.
    Gravel,
    /// Clay tiles.
    Tiles,
    /// Slate.
    Slate,
    /// Sheet metal with standing seams.
    Metal,
    /// A light membrane with weld lines.
    Membrane,
}

impl RoofStyle {
    /// All of them, by their numbers in a building's code.
    pub const ALL: [Self; 5] = [
        Self::Gravel,
        Self::Tiles,
        Self::Slate,
        Self::Metal,
        Self::Membrane,
    ];
}
