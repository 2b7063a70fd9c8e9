//! The source files opened, and the city's CRS decided.

use super::ImportOptions;
use crate::city::{CityError, Layer, OperationRecord};
use crate::source::{CrsChoice, Dtm, FootprintSource, ImageryMosaic, SteppedHeights};
use crate::space::{Crs, GeoArea, Operation, OperationWarning};

/// Opened sources.
pub struct Sources {
    /// Terrain.
    pub dtm: Dtm,
    /// Terrain files whose heights are stored in whole steps.
    pub stepped: Vec<SteppedHeights>,
    /// Footprints.
    pub buildings: FootprintSource,
    /// Orthophotos.
    pub imagery: Option<ImageryMosaic>,
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
        let built_area = buildings.area_on_globe();
        let crs = match city {
            Some(crs) => {
                crs.require_metric()?;
                crs
            }
            None if dtm.crs().is_metric() => dtm.crs().clone(),
            None => {
                let area = match built_area {
                    Some(area) => area,
                    None => dtm.area_on_globe()?,
                };
                let centre = area.centre();
                Crs::utm_of(centre.x, centre.y)?
            }
        };
        let crs = crs.used_in(city_area(built_area, dtm.area_on_globe().ok()));
        let imagery_crs = CrsChoice::new(parse(&options.imagery_crs)?, Some(&crs));
        let imagery = (!options.imagery.is_empty())
            .then(|| ImageryMosaic::open(&options.imagery, &imagery_crs, &crs))
            .transpose()?;
        Ok(Self {
            dtm,
            stepped,
            buildings,
            imagery,
            crs,
        })
    }

    /// How the coordinates of each kind of source come into the city's CRS, and what is worth knowing of it.
    pub fn operations(&self) -> Result<(Vec<OperationRecord>, Vec<OperationWarning>), CityError> {
        let imagery = self.imagery.iter().flat_map(ImageryMosaic::all_crs);
        let sources = (self.dtm.all_crs().map(|crs| (Layer::Terrain.name(), crs)))
            .chain([(Layer::Buildings.name(), self.buildings.crs())])
            .chain(imagery.map(|crs| (Layer::Imagery.name(), crs)));
        let (mut records, mut warnings) = (Vec::<OperationRecord>::new(), Vec::new());
        for (role, crs) in sources {
            if records
                .iter()
                .any(|known| known.role == role && known.from == crs.label())
            {
                continue;
            }
            let operation = Operation::between(crs, &self.crs)?;
            let warning = operation.as_ref().and_then(|used| used.warning(crs, &self.crs));
            if let Some(warning) = warning
                && !warnings.contains(&warning)
            {
                warnings.push(warning);
            }
            records.push(OperationRecord::new(role, crs, operation.as_deref()));
        }
        Ok((records, warnings))
    }
}

/// Where the city is: the footprints on the terrain, so that a stray one far away does not count.
fn city_area(built: Option<GeoArea>, terrain: Option<GeoArea>) -> Option<GeoArea> {
    match (built, terrain) {
        (Some(built), Some(terrain)) => Some(built.intersection(&terrain).unwrap_or(built)),
        (built, terrain) => built.or(terrain),
    }
}
