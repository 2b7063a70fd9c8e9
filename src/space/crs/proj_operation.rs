//! PROJ's coordinate operations: found and questioned, by their names in PROJ's C API.

use std::ptr::{null, null_mut};

use proj_sys as sys;

use super::GeoArea;
use super::proj_object::{ProjObject, string};

impl ProjObject {
    /// Coordinate operations from this CRS to another, best first, as if every grid were installed; on request also those
    /// that go through a third CRS where direct ones are registered.
    pub fn operations_to(&self, target: &Self, area: Option<&GeoArea>, through_third: bool) -> Vec<Self> {
        let context = self.context.0;
        // SAFETY: all are alive, and the factory lives until its list is made.
        unsafe {
            let factory = sys::proj_create_operation_factory_context(context, null());
            if factory.is_null() {
                return Vec::new();
            }
            if let Some(area) = area {
                let (west, east) = (area.west_deg, area.east_deg);
                let (south, north) = (area.south_deg, area.north_deg);
                sys::proj_operation_factory_context_set_area_of_interest(
                    context, factory, west, south, east, north,
                );
            }
            sys::proj_operation_factory_context_set_spatial_criterion(
                context,
                factory,
                sys::PROJ_SPATIAL_CRITERION_PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION,
            );
            sys::proj_operation_factory_context_set_grid_availability_use(
                context,
                factory,
                sys::PROJ_GRID_AVAILABILITY_USE_PROJ_GRID_AVAILABILITY_IGNORED,
            );
            if through_third {
                sys::proj_operation_factory_context_set_allow_use_intermediate_crs(
                    context,
                    factory,
                    sys::PROJ_INTERMEDIATE_CRS_USE_PROJ_INTERMEDIATE_CRS_USE_ALWAYS,
                );
            }
            let list = sys::proj_create_operations(context, self.raw, target.raw, factory);
            sys::proj_operation_factory_context_destroy(factory);
            self.list(list)
        }
    }

    /// True when an operation has all it needs, its grids too.
    pub fn is_instantiable(&self) -> bool {
        // SAFETY: both are alive.
        unsafe { sys::proj_coordoperation_is_instantiable(self.context.0, self.raw) == 1 }
    }

    /// True when an operation takes one datum for another, for want of anything better.
    pub fn is_ballpark(&self) -> bool {
        // SAFETY: both are alive.
        unsafe { sys::proj_coordoperation_has_ballpark_transformation(self.context.0, self.raw) == 1 }
    }

    /// An operation's accuracy, metres; 0 for a pure conversion, none where nobody knows.
    pub fn accuracy_m(&self) -> Option<f64> {
        if self.kind() == sys::PJ_TYPE_PJ_TYPE_CONVERSION {
            return Some(0.0);
        }
        // SAFETY: both are alive.
        let metres = unsafe { sys::proj_coordoperation_get_accuracy(self.context.0, self.raw) };
        (metres >= 0.0).then_some(metres)
    }

    /// File names of the grids that an operation needs and that are not installed.
    pub fn missing_grids(&self) -> Vec<String> {
        // SAFETY: both are alive; -1 on failure is an empty range.
        let count = unsafe { sys::proj_coordoperation_get_grid_used_count(self.context.0, self.raw) };
        (0..count)
            .filter_map(|index| {
                let (mut name, mut available) = (null(), 0);
                // SAFETY: outputs that are null are not written; the text is copied while the operation lives.
                unsafe {
                    let found = sys::proj_coordoperation_get_grid_used(
                        self.context.0,
                        self.raw,
                        index,
                        &mut name,
                        null_mut(),
                        null_mut(),
                        null_mut(),
                        null_mut(),
                        null_mut(),
                        &mut available,
                    );
                    string(name).filter(|_| found == 1 && available == 0)
                }
            })
            .collect()
    }

    /// An operation as a PROJ string.
    pub fn proj_string(&self) -> Option<String> {
        let version = sys::PJ_PROJ_STRING_TYPE_PJ_PROJ_5;
        // SAFETY: both are alive; the text is copied at once.
        unsafe {
            string(sys::proj_as_proj_string(
                self.context.0,
                self.raw,
                version,
                null(),
            ))
        }
    }
}
