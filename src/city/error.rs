//! Why a city could not be written or read. What a command can be told instead is the command line's to say
//! (`cli::advice`).

use std::path::PathBuf;

use glam::DVec2;
use thiserror::Error;

use super::import::Setting;
use crate::buildings::MapTooLarge;
use crate::source::SourceError;
use crate::space::CrsError;

/// A city folder could not be made or opened.
#[derive(Debug, Error)]
pub enum CityError {
    /// A source file was refused.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The city's CRS cannot be used.
    #[error(transparent)]
    Crs(#[from] CrsError),
    /// A file could not be read or written.
    #[error("{}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        why: String,
    },
    /// A tile is damaged.
    #[error("{}: is not a tile of this city ({why}); run the import again", path.display())]
    Tile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// A file of facade rules cannot be used.
    #[error("{}: is no file of facade rules ({why})", path.display())]
    Rules {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The folder is no city.
    #[error("{}: is not a city ({why})", path.display())]
    NotACity {
        /// The folder.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The place of the city to make is taken by something else.
    #[error("{}: exists and is not a city", path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
    },
    /// It would lie in a city's folder.
    #[error("{}: lies in the folder of the city {}", path.display(), city.display())]
    Inside {
        /// What was to be written.
        path: PathBuf,
        /// The city.
        city: PathBuf,
    },
    /// Another import makes the same city.
    #[error("{}: another import{} makes this city", path.display(), Self::process(process))]
    Busy {
        /// The folder.
        path: PathBuf,
        /// Number of its process; may be empty.
        process: String,
    },
    /// A city cannot be in the sources' CRS.
    #[error("a city's CRS is a code or WKT that names no file; the sources' is {crs}")]
    UnfitCrs {
        /// Its beginning.
        crs: String,
    },
    /// A source changed while it was read.
    #[error("{}: changed while it was imported; run the import again", path.display())]
    SourceChanged {
        /// The source.
        path: PathBuf,
    },
    /// The city to make has no name.
    #[error("{}: is no folder name", path.display())]
    NoFolderName {
        /// The folder.
        path: PathBuf,
    },
    /// The old city's folder holds what no import made.
    #[error("{}: is not part of a city and would be lost", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The old city's footprint dataset was edited.
    #[error("{}: is newer than the city's manifest, or the city was updated: an edit since the city was made, which an import would lose", path.display())]
    Edited {
        /// The footprint dataset.
        path: PathBuf,
    },
    /// The footprint dataset was edited and the tiles do not know yet.
    #[error("{}: was edited since the last update; run rilievo update on the city alone first", path.display())]
    EditedDataset {
        /// The footprint dataset.
        path: PathBuf,
    },
    /// The city was replaced by another import while it was open.
    #[error("{}: was imported anew; open it again", path.display())]
    ImportedAnew {
        /// The city folder.
        path: PathBuf,
    },
    /// A building to delete is not there.
    #[error("{}: has no building {fid}", path.display())]
    NoBuilding {
        /// The footprint dataset.
        path: PathBuf,
        /// Its id.
        fid: u32,
    },
    /// No attribute of the dataset gives heights.
    #[error("{}: has no attribute of its own that gives heights; add one in a GIS and import the dataset with it", path.display())]
    NoHeightField {
        /// The footprint dataset.
        path: PathBuf,
    },
    /// A footprint that an edit gives becomes no building.
    #[error("building {fid}: there is no ground under the outline; draw it where the city has terrain")]
    NotTaken {
        /// Its id.
        fid: u32,
    },
    /// An outline that is none.
    #[error("building {fid}: the outline crosses itself or encloses nothing; draw it again")]
    WrongOutline {
        /// Its id.
        fid: u32,
    },
    /// A building is to be changed and to be deleted.
    #[error("building {fid} is to be changed and to be deleted")]
    ChangedAndDeleted {
        /// Its id.
        fid: u32,
    },
    /// A changed building reaches beyond the city.
    #[error("{}: building {fid} reaches beyond the city's tiles; import the city again, with terrain that covers it", path.display())]
    OutsideCity {
        /// The city folder.
        path: PathBuf,
        /// Its id.
        fid: u32,
    },
    /// A source lies in the old city.
    #[error("{}: lies inside the city that the import replaces", path.display())]
    InputInside {
        /// The source.
        path: PathBuf,
    },
    /// A number that no city can be made with.
    #[error("{setting} of {value} is out of range ({min} to {max})")]
    OutOfRange {
        /// Which.
        setting: Setting,
        /// What was given.
        value: f64,
        /// Smallest value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// The footprint layer holds nothing.
    #[error("{}: its layer holds no features", path.display())]
    EmptyLayer {
        /// The footprint file.
        path: PathBuf,
    },
    /// No footprint lies on the terrain.
    #[error("{}: no footprint lies on the terrain (terrain: {terrain}; footprints: {footprints}; {rejected})", path.display())]
    Apart {
        /// The footprint file.
        path: PathBuf,
        /// Extent of the terrain.
        terrain: String,
        /// Extent of the footprints.
        footprints: String,
        /// Features read and why some became no building.
        rejected: String,
    },
    /// The terrain has holes where the buildings are.
    #[error("{}: has no ground where the buildings are; check that both files show the same place", path.display())]
    NoGround {
        /// The terrain file.
        path: PathBuf,
    },
    /// Every footprint was rejected.
    #[error("{}: no footprint could be kept ({rejected})", path.display())]
    NoBuildings {
        /// The footprint file.
        path: PathBuf,
        /// Features read and why they became no building.
        rejected: String,
    },
    /// A raster holds far more than a city keeps of it.
    #[error("{}: has {:.0} million pixels under the city, {times:.0} times finer than any that is kept; make it coarser first, with gdalwarp -tr 0.25 0.25 -r average", path.display(), pixels * 1e-6)]
    TooFine {
        /// The file.
        path: PathBuf,
        /// Its pixels under the city.
        pixels: f64,
        /// How many of them lie along one that is kept.
        times: f64,
    },
    /// More tiles than a city may have.
    #[error("the city would have {tiles:.0} tiles ({extent})")]
    TooManyTiles {
        /// How many.
        tiles: f64,
        /// Extent of the city.
        extent: String,
    },
    /// A tile has too many vertices.
    #[error("{}: {source}, around {:.0} east, {:.0} north", path.display(), place.x, place.y)]
    TileTooLarge {
        /// The footprints.
        path: PathBuf,
        /// The tile's centre, metres.
        place: DVec2,
        /// How many are too many.
        source: MapTooLarge,
    },
}

impl CityError {
    fn process(number: &str) -> String {
        match number {
            "" => String::new(),
            number => format!(" (process {number})"),
        }
    }

    /// Wraps an I/O error with its file.
    pub fn file(path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |error| Self::File {
            path,
            why: error.to_string(),
        }
    }
}
