//! What a command can be told to repair an error or a warning: the one file where they meet the command line's flags.

use super::CommandError;
use crate::city::{CityError, ImportWarning, Setting};
use crate::gpu::GpuError;
use crate::output::RenderError;
use crate::scene::SceneError;
use crate::source::{SourceError, SourceRole};
use crate::space::OperationWarning;
use crate::viewer::ViewerError;

/// What to do about an error, where a flag or a command mends it.
pub fn for_error(error: &CommandError) -> Option<String> {
    match error {
        CommandError::City(error)
        | CommandError::Render(RenderError::City(error) | RenderError::Scene(SceneError::City(error))) => {
            for_city(error)
        }
        CommandError::Render(RenderError::Gpu(error) | RenderError::Scene(SceneError::Gpu(error))) => {
            for_gpu(error)
        }
        CommandError::Viewer(ViewerError::NoWindow { .. }) => {
            Some("start it where there is a display, or draw images with rilievo render".to_owned())
        }
        CommandError::Viewer(ViewerError::Render(RenderError::Gpu(error))) => for_gpu(error),
        _ => None,
    }
}

/// What to do about a warning.
pub fn for_warning(warning: &ImportWarning) -> String {
    match warning {
        ImportWarning::Outside {
            role: SourceRole::Imagery,
            ..
        } => "check its place and --photo-crs, or leave it out".to_owned(),
        ImportWarning::Outside { .. } => "check its place, or leave it out".to_owned(),
        ImportWarning::UnspecifiedUnit { .. } => {
            "if they are feet, give --terrain-unit 0.3048 (US survey feet: 0.3048006)".to_owned()
        }
        ImportWarning::Operation(OperationWarning::MissingGrids { .. }) => {
            "put them in PROJ's data folder (projsync --file NAME gets one) and import again".to_owned()
        }
        ImportWarning::Operation(OperationWarning::Ballpark { .. }) => {
            "check them against each other, or give the files in the city's datum".to_owned()
        }
        ImportWarning::Steps { kept: false, .. } => "--keep-steps keeps them".to_owned(),
        ImportWarning::Steps { kept: true, .. } => "leave out --keep-steps to smooth them".to_owned(),
        ImportWarning::FillCut { .. } => "fill wider ones in the source, with gdal_fillnodata.py".to_owned(),
        ImportWarning::OutsideCrs { .. } => "give another --crs".to_owned(),
        ImportWarning::TranslationDropped { .. } => "check where the buildings lie".to_owned(),
        ImportWarning::NoHeights { .. } => {
            "name a field with --height-field, --storeys-field or --roof-field, or another --default-height"
                .to_owned()
        }
    }
}

fn for_city(error: &CityError) -> Option<String> {
    Some(match error {
        CityError::Source(error) => return for_source(error),
        CityError::NotACity { path, .. } => format!(
            "make one with: rilievo import --terrain .. --buildings .. --out {}",
            path.display()
        ),
        CityError::Occupied { .. } => "choose another --out or remove it yourself".to_owned(),
        CityError::Inside { .. } => "write to a place outside it".to_owned(),
        CityError::UnfitCrs { .. } => "name another CRS for the city (--crs EPSG:n)".to_owned(),
        CityError::Busy { .. } => "wait until it has ended, or choose another --out".to_owned(),
        CityError::NoFolderName { .. } => "give --out a folder to make".to_owned(),
        CityError::Foreign { .. } => "move it elsewhere, or choose another --out".to_owned(),
        CityError::Edited { .. } => {
            "move it elsewhere (and import it with --buildings), or choose another --out".to_owned()
        }
        CityError::InputInside { .. } => "copy it elsewhere first, or choose another --out".to_owned(),
        CityError::OutOfRange { setting, .. } => format!("give another {}", flag(*setting)),
        CityError::EmptyLayer { .. } => {
            "give the file that has the footprints, or another --layer".to_owned()
        }
        CityError::Apart { .. } => {
            "check the files' coordinate reference systems (--buildings-crs, --terrain-crs), or name the city's (--crs)".to_owned()
        }
        CityError::NoBuildings { .. } => {
            "check the layer (--layer) and that it shows the same place as the terrain".to_owned()
        }
        CityError::TooManyTiles { .. } => "use larger texels (--texel) or a smaller --margin".to_owned(),
        CityError::TileTooLarge { .. } => {
            "thin them out there, or use smaller texels (--texel)".to_owned()
        }
        CityError::NoBuilding { .. } => "check the ids after --delete".to_owned(),
        CityError::ChangedAndDeleted { .. } => {
            "leave it out of the file of changes, or out of --delete".to_owned()
        }
        CityError::Rules { .. } => {
            "mend it: data/facades.toml of this program is an example that says how".to_owned()
        }
        CityError::Crs(_)
        | CityError::File { .. }
        | CityError::Tile { .. }
        | CityError::NoGround { .. }
        | CityError::TooFine { .. }
        | CityError::SourceChanged { .. }
        | CityError::EditedDataset { .. }
        | CityError::ImportedAnew { .. }
        | CityError::NoHeightField { .. }
        | CityError::WrongOutline { .. }
        | CityError::NotTaken { .. }
        | CityError::OutsideCity { .. } => return None,
    })
}

fn for_source(error: &SourceError) -> Option<String> {
    let crs_flag = |role: SourceRole| match role {
        SourceRole::Terrain => "--terrain-crs",
        SourceRole::Footprints => "--buildings-crs",
        SourceRole::Imagery => "--photo-crs",
        // Such files have no flag: the city's CRS is taken for those that name none.
        SourceRole::Plan | SourceRole::Track => "--crs",
    };
    Some(match error {
        SourceError::NoCrs { role, .. } => format!("name it with {} EPSG:n", crs_flag(*role)),
        SourceError::WrongCrs { role, .. } => {
            format!("name the right CRS with {} EPSG:n", crs_flag(*role))
        }
        SourceError::NotTerrain { .. } => "give it with --photo".to_owned(),
        SourceError::SeveralLayers { .. } => "choose one with --layer NAME".to_owned(),
        SourceError::NoLayer { .. } => "name one with --layer".to_owned(),
        _ => return None,
    })
}

fn for_gpu(error: &GpuError) -> Option<String> {
    matches!(error, GpuError::TooLarge { .. })
        .then(|| "import the city with larger texels (--texel 2) or a smaller --margin".to_owned())
}

fn flag(setting: Setting) -> &'static str {
    match setting {
        Setting::Texel => "--texel",
        Setting::TerrainError => "--terrain-error",
        Setting::DefaultHeight => "--default-height",
        Setting::Fill => "--fill",
        Setting::Margin => "--margin",
        Setting::TerrainUnit => "--terrain-unit",
        Setting::StoreyHeight => "--storey-height",
    }
}
