//! What a building is made of: one word in the building map, read by `shaders/lib/facade.wgsl`.

use super::{FacadeStyle, RoofStyle};

/// A building's facade and roof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildingMaterial {
    /// Its facade.
    pub facade: FacadeStyle,
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
    /// Whether a code names a facade and a roof that there are.
    pub fn is_code(code: u32) -> bool {
        (code & 127) < FacadeStyle::ALL.len() as u32 && ((code >> 8) & 255) < RoofStyle::ALL.len() as u32
    }

    /// Bits 31-24: direction; 23-16: storeys; 15-8: roof; 7: shops; 6-0: facade.
    pub fn code(self) -> u32 {
        let facade = FacadeStyle::ALL.iter().position(|style| *style == self.facade);
        let roof = RoofStyle::ALL.iter().position(|style| *style == self.roof);
        let [facade, roof] = [facade, roof].map(|index| index.unwrap_or(0) as u32);
        let direction = u32::from(self.direction) << 24;
        direction | (u32::from(self.storeys) << 16) | (roof << 8) | (u32::from(self.has_shops) << 7) | facade
    }
}
