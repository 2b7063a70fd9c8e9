//! What a building is made of: one word in the building map, read by `shaders/lib/facade.wgsl`.

use super::own_facade::MAX_OWN_FACADES;
use super::{FacadeStyle, RoofStyle};

/// A facade that a building can have: one of the project's, or of the user's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facade {
    /// Its number in a building's code: the project's first.
    pub number: u32,
    /// The width that a bay comes near to, metres.
    pub bay_m: f64,
    /// The height that a storey comes near to, metres.
    pub storey_m: f64,
}

impl From<FacadeStyle> for Facade {
    fn from(style: FacadeStyle) -> Self {
        let number = FacadeStyle::ALL.iter().position(|other| *other == style);
        Self {
            number: number.unwrap_or(0) as u32,
            bay_m: style.bay_m(),
            storey_m: style.storey_m(),
        }
    }
}

/// A building's facade and roof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildingMaterial {
    /// Its facade.
    pub facade: Facade,
    /// Whether its ground floor is shops.
    pub has_shops: bool,
    /// Its roof, where no imagery shows it.
    pub roof: RoofStyle,
    /// Storeys, 1 to 255.
    pub storeys: u8,
    /// Direction of its longest wall, in 256ths of half a circle from east towards north: roofs are laid along it.
    pub direction: u8,
}

impl BuildingMaterial {
    /// Whether a code names a facade and a roof that there can be.
    pub fn is_code(code: u32) -> bool {
        (code & 127) < (FacadeStyle::ALL.len() + MAX_OWN_FACADES) as u32
            && ((code >> 8) & 255) < RoofStyle::ALL.len() as u32
    }

    /// Bits 31-24: direction; 23-16: storeys; 15-8: roof; 7: shops; 6-0: facade.
    pub fn code(self) -> u32 {
        let roof = RoofStyle::ALL.iter().position(|style| *style == self.roof);
        let roof = roof.unwrap_or(0) as u32;
        let direction = u32::from(self.direction) << 24;
        let shops = u32::from(self.has_shops) << 7;
        direction | (u32::from(self.storeys) << 16) | (roof << 8) | shops | self.facade.number
    }
}
