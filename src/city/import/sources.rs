//! The source files opened, and the city's CRS decided.

use super::ImportOptions;
use crate::city::CityError;
use crate::source::{CrsChoice, Dtm, FootprintSource, Imagery, SteppedHeights};
use crate::space::Crs;

/// Opened sources.
pub struct Sources {
    /// Terrain.
    pub dtm: Dtm,
    /// Terrain files whose heights are stored in whole steps.
    pub stepped: Vec<SteppedHeights>,
    /// Footprints.
    pub buildings: FootprintSource,
    /// Orthophotos.
    pub imagery: Option<Imagery>,
    /// The city's.
    pub crs: Crs,
}

impl Sources {
    /// Opens all files' headers.
    pub fn open(options: &ImportOptions) -> Result<Self, CityError> {
        let parse = |text: &Option<String>| text.as_deref().map(Crs::from_text).transpose();
        let city = parse(&options.crs)?;
        let terrain_crs = CrsChoice::new(parse(&options.terrain_crs)?, city.as_ref());
        let mut dtm = Dtm::open(&options.terrain, &terrain_crs, options.terrain_unit_m)?;
        let stepped = dtm.find_stepped_heights(options.keep_steps)?;
        let buildings_crs = CrsChoice::new(parse(&options.buildings_crs)?, city.as_ref());
        let buildings = FootprintSource::open(&options.buildings, options.layer.as_deref(), &buildings_crs)?;
        let crs = match city {
            Some(crs) => {
                crs.require_metric()?;
                crs
            }
            None if dtm.crs().is_metric()? => dtm.crs().clone(),
            None => {
                let centre = match buildings.centre_on_globe() {
                    Some(centre) => centre,
                    None => dtm.centre_on_globe()?,
                };
                Crs::utm_of(centre.x, centre.y)?
            }
        };
        let imagery_crs = CrsChoice::new(parse(&options.imagery_crs)?, Some(&crs));
        let imagery = (!options.imagery.is_empty())
            .then(|| Imagery::open(&options.imagery, &imagery_crs, &crs))
            .transpose()?;
        Ok(Self {
            dtm,
            stepped,
            buildings,
            imagery,
            crs,
        })
    }
}
