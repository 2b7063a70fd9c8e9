//! Which coordinate operation leads from one CRS to another: the best one for the area that is installed here.
//!
//! PROJ lists the operations its registry knows (EPSG's among them), sorted by how much of the area of interest each
//! serves and then by accuracy. One is taken for the whole city, so that no seam runs where two operations meet.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::proj_object::ProjObject;
use super::{Crs, CrsError};

/// How far an operation may be off, as its publisher says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// Metres; 0 for a pure conversion, which is exact.
    Metres(f64),
    /// Nobody says.
    Unknown,
    /// One datum is taken for another: metres to hundreds of metres.
    Ballpark,
}

impl Accuracy {
    /// Metres, where they are known.
    pub fn metres(self) -> Option<f64> {
        match self {
            Self::Metres(metres) => Some(metres),
            Self::Unknown | Self::Ballpark => None,
        }
    }
}

impl std::fmt::Display for Accuracy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Metres(0.0) => write!(f, "exact"),
            Self::Metres(metres) => write!(f, "accurate to {metres} m"),
            Self::Unknown => write!(f, "of unknown accuracy"),
            Self::Ballpark => write!(f, "ballpark (no shift between the datums)"),
        }
    }
}

/// A way from one CRS to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Operation {
    /// Its name in PROJ's words.
    pub name: String,
    /// Its accuracy.
    pub accuracy: Accuracy,
    /// What is better and not installed.
    pub better: Option<MissingGrids>,
    /// The PROJ string that computes it, x east and y north on both sides.
    pub(super) pipeline: String,
    /// The same with the axes in each CRS's own order, as GDAL wants it.
    pub pipeline_in_axis_order: String,
}

/// Grids that a better operation would need.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingGrids {
    /// Their file names.
    pub files: Vec<String>,
    /// How accurate the operation would be with them.
    pub accuracy: Accuracy,
}

/// What is worth knowing before the result of an operation is trusted.
#[derive(Clone, Debug, PartialEq)]
pub enum OperationWarning {
    /// A better operation needs grids that are not installed.
    MissingGrids {
        /// Source and target, short.
        between: [String; 2],
        /// Accuracy of what is used.
        used: Accuracy,
        /// What is missing.
        better: MissingGrids,
    },
    /// Nothing better than a ballpark is known.
    Ballpark {
        /// Source and target, short.
        between: [String; 2],
    },
}

impl std::fmt::Display for OperationWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::MissingGrids {
                between: [from, to],
                used,
                better,
            } => write!(
                f,
                "the transformation from {from} to {to} is {used}; one that is {} needs grids that are not installed ({})",
                better.accuracy,
                better.files.join(", ")
            ),
            Self::Ballpark { between: [from, to] } => write!(
                f,
                "no shift is known between the datums of {from} and {to}: positions may be off by metres to hundreds of metres"
            ),
        }
    }
}

impl Operation {
    /// The best installed operation for the area that either CRS is used in; none where both are the same.
    pub fn between(from: &Crs, to: &Crs) -> Result<Option<Arc<Self>>, CrsError> {
        /// Operations found: searching PROJ's registry takes tens of milliseconds, and every thread asks again.
        static FOUND: Mutex<Option<HashMap<String, Arc<Operation>>>> = Mutex::new(None);
        if from.same_as(to) {
            return Ok(None);
        }
        let area = from.area.or(to.area);
        let key = format!("{}\n{}\n{area:?}", from.wkt, to.wkt);
        let lock = || FOUND.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get_or_insert_default().get(&key) {
            return Ok(Some(Arc::clone(known)));
        }
        let operation = Arc::new(Self::search(from, to)?);
        lock().get_or_insert_default().insert(key, Arc::clone(&operation));
        Ok(Some(operation))
    }

    /// What the user should know of it.
    pub fn warning(&self, from: &Crs, to: &Crs) -> Option<OperationWarning> {
        let between = [from.name(), to.name()].map(str::to_owned);
        match &self.better {
            Some(better) => Some(OperationWarning::MissingGrids {
                between,
                used: self.accuracy,
                better: better.clone(),
            }),
            None => (self.accuracy == Accuracy::Ballpark).then_some(OperationWarning::Ballpark { between }),
        }
    }

    fn search(from: &Crs, to: &Crs) -> Result<Self, CrsError> {
        let none = |why: String| CrsError::NoTransformation {
            from: from.name().to_owned(),
            to: to.name().to_owned(),
            why,
        };
        let (source, target) = (from.object()?, to.object()?);
        let area = from.area.or(to.area);
        let direct = source.operations_to(&target, area.as_ref(), false);
        let mut better = direct.as_slice();
        let mut found = first_usable(&direct, false);
        if let Some((index, _)) = &found {
            better = &direct[..*index];
        } else {
            // Where a direct operation wants a grid, another datum between may still do well without.
            let indirect = source.operations_to(&target, area.as_ref(), true);
            found = first_usable(&indirect, false).or_else(|| first_usable(&direct, true));
        }
        let (_, mut operation) =
            found.ok_or_else(|| none("PROJ knows no operation between them".to_owned()))?;
        if operation.accuracy == Accuracy::Ballpark && have_one_datum(&source, &target) {
            operation.accuracy = Accuracy::Metres(0.0);
            let steps = operation.name.split(" + ");
            let steps: Vec<&str> = steps.filter(|step| !step.starts_with("Ballpark")).collect();
            operation.name = steps.join(" + ");
        }
        // What stands before it in the list is better or serves more of the area.
        operation.better = better
            .iter()
            .filter(|candidate| !candidate.is_ballpark())
            .find_map(|candidate| {
                let better = MissingGrids {
                    files: candidate.missing_grids(),
                    accuracy: accuracy(candidate),
                };
                let worth = match (better.accuracy, operation.accuracy) {
                    (Accuracy::Metres(better), Accuracy::Metres(used)) => better < used,
                    (Accuracy::Metres(_), _) => true,
                    (_, used) => used == Accuracy::Ballpark,
                };
                (worth && !better.files.is_empty()).then_some(better)
            });
        Ok(operation)
    }

    /// None where something it needs is not installed.
    fn from_object(candidate: &ProjObject) -> Option<Self> {
        if !candidate.is_instantiable() {
            return None;
        }
        let pipeline = candidate.normalised()?.proj_string()?;
        // The `proj` crate panics on a string that PROJ refuses without a reason.
        ProjObject::from_text(&pipeline).ok()?;
        Some(Self {
            name: candidate.name().unwrap_or_default(),
            accuracy: accuracy(candidate),
            better: None,
            pipeline,
            pipeline_in_axis_order: candidate.proj_string()?,
        })
    }
}

/// The first operation with all it needs, ballpark or not, and its index.
fn first_usable(candidates: &[ProjObject], ballpark: bool) -> Option<(usize, Operation)> {
    let mut kind = (0..)
        .zip(candidates)
        .filter(|(_, candidate)| candidate.is_ballpark() == ballpark);
    kind.find_map(|(index, candidate)| Some((index, Operation::from_object(candidate)?)))
}

/// True when both stand on one registered datum, of which a file wrote the ellipsoid with other digits: PROJ then takes the
/// two for strangers, though nothing lies between them.
fn have_one_datum(source: &ProjObject, target: &ProjObject) -> bool {
    const ROUNDING_M: f64 = 1e-4;
    let same_code = source.geodetic_code().is_some() && source.geodetic_code() == target.geodetic_code();
    let ellipsoids = source.ellipsoid_m().zip(target.ellipsoid_m());
    same_code && ellipsoids.is_some_and(|(a, b)| a.iter().zip(&b).all(|(a, b)| (a - b).abs() < ROUNDING_M))
}

fn accuracy(operation: &ProjObject) -> Accuracy {
    match operation.accuracy_m() {
        _ if operation.is_ballpark() => Accuracy::Ballpark,
        Some(metres) => Accuracy::Metres(metres),
        None => Accuracy::Unknown,
    }
}
