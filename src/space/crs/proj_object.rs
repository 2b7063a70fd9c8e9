//! PROJ's objects as far as they are questioned, not computed with: what the `proj` crate leaves to `proj-sys`.
//! Functions by their names in PROJ's C API (<https://proj.org/en/9.1/development/reference/functions.html>).

use std::ffi::{CStr, CString, c_char, c_int};
use std::ptr::{null, null_mut};
use std::rc::Rc;
use std::sync::Once;

use proj_sys as sys;

use super::GeoArea;

/// One of PROJ's contexts: a thread's own, quiet.
pub(super) struct Context(pub(super) *mut sys::PJ_CONTEXT);

impl Drop for Context {
    fn drop(&mut self) {
        // SAFETY: made by proj_context_create, and every object of it is gone (each holds an `Rc` of this).
        unsafe { sys::proj_context_destroy(self.0) };
    }
}

thread_local! {
    /// This thread's: each opens PROJ's database for itself, which takes longer than most questions.
    // SAFETY: nothing is asked of it before it is made.
    static CONTEXT: Rc<Context> = Rc::new(Context(unsafe { sys::proj_context_create() }));
}

/// A CRS, a part of one, or a coordinate operation (`proj_operation`).
pub struct ProjObject {
    /// Never null.
    pub(super) raw: *mut sys::PJ,
    pub(super) context: Rc<Context>,
}

/// Dialects of WKT.
#[derive(Clone, Copy)]
pub enum Wkt {
    /// ISO 19162:2019.
    Iso2019,
    /// What `.prj` files hold.
    Esri,
}

/// One axis of a coordinate system.
pub struct Axis {
    /// `east`, `north`, `west`, `south`, `up`..
    pub direction: String,
    /// Metres or radians a unit.
    pub unit: f64,
}

impl Drop for ProjObject {
    fn drop(&mut self) {
        // SAFETY: the object is this value's own, and its context is alive.
        unsafe { sys::proj_destroy(self.raw) };
    }
}

impl ProjObject {
    /// Reads `EPSG:n`, WKT of any dialect, PROJ strings, PROJJSON, URNs and names; the error says why not.
    pub fn from_text(text: &str) -> Result<Self, String> {
        /// New contexts take over what the default one is told: the `proj` crate's are quiet by this as well.
        static QUIET: Once = Once::new();
        // SAFETY: null is PROJ's default context.
        QUIET.call_once(|| unsafe {
            sys::proj_log_level(null_mut(), sys::PJ_LOG_LEVEL_PJ_LOG_NONE);
        });
        let definition = CString::new(text).map_err(|_| "it holds a NUL character".to_owned())?;
        // SAFETY: the text and the context outlive the calls.
        unsafe {
            let context = CONTEXT.with(Rc::clone);
            let raw = sys::proj_create(context.0, definition.as_ptr());
            if raw.is_null() {
                // PROJ's own reasons are "unknown error" and "invalid PROJ string", whatever was given.
                let why = match sys::proj_context_get_database_path(context.0).is_null() {
                    true => "PROJ finds its registry proj.db nowhere: install proj-data or set PROJ_DATA",
                    false => "PROJ knows no such code, name or definition",
                };
                return Err(why.to_owned());
            }
            Ok(Self { raw, context })
        }
    }

    /// Takes over an object that PROJ made in this one's context.
    fn owned(&self, raw: *mut sys::PJ) -> Option<Self> {
        let context = Rc::clone(&self.context);
        (!raw.is_null()).then_some(Self { raw, context })
    }

    pub(super) fn kind(&self) -> sys::PJ_TYPE {
        // SAFETY: the object is alive.
        unsafe { sys::proj_get_type(self.raw) }
    }

    /// A horizontal and a vertical system together.
    pub fn is_compound(&self) -> bool {
        self.kind() == sys::PJ_TYPE_PJ_TYPE_COMPOUND_CRS
    }

    /// A CRS that brings its own transformation to another (`TOWGS84`).
    pub fn is_bound(&self) -> bool {
        self.kind() == sys::PJ_TYPE_PJ_TYPE_BOUND_CRS
    }

    /// Longitude and latitude.
    pub fn is_geographic(&self) -> bool {
        [
            sys::PJ_TYPE_PJ_TYPE_GEOGRAPHIC_2D_CRS,
            sys::PJ_TYPE_PJ_TYPE_GEOGRAPHIC_3D_CRS,
        ]
        .contains(&self.kind())
    }

    /// Lengths on a map.
    pub fn is_projected(&self) -> bool {
        self.kind() == sys::PJ_TYPE_PJ_TYPE_PROJECTED_CRS
    }

    /// Part of a compound CRS: 0 horizontal, 1 vertical.
    pub fn part(&self, index: c_int) -> Option<Self> {
        // SAFETY: both are alive; other kinds give null.
        self.owned(unsafe { sys::proj_crs_get_sub_crs(self.context.0, self.raw, index) })
    }

    /// What a bound CRS binds.
    pub fn unbound(&self) -> Option<Self> {
        // SAFETY: both are alive; other kinds give null.
        self.owned(unsafe { sys::proj_get_source_crs(self.context.0, self.raw) })
    }

    /// Its name.
    pub fn name(&self) -> Option<String> {
        // SAFETY: the object is alive and the name is copied at once.
        unsafe { string(sys::proj_get_name(self.raw)) }
    }

    /// `AUTHORITY:code`, where it is registered.
    pub fn code(&self) -> Option<String> {
        // SAFETY: the object is alive and both texts are copied at once.
        let (authority, code) = unsafe {
            (
                string(sys::proj_get_id_auth_name(self.raw, 0)),
                string(sys::proj_get_id_code(self.raw, 0)),
            )
        };
        Some(format!("{}:{}", authority?, code?))
    }

    /// As WKT in one line.
    pub fn wkt(&self, dialect: Wkt) -> Option<String> {
        let dialect = match dialect {
            Wkt::Iso2019 => sys::PJ_WKT_TYPE_PJ_WKT2_2019,
            Wkt::Esri => sys::PJ_WKT_TYPE_PJ_WKT1_ESRI,
        };
        let options = [c"MULTILINE=NO".as_ptr(), null()];
        // SAFETY: the options end with null; the text is the object's and copied at once.
        unsafe {
            string(sys::proj_as_wkt(
                self.context.0,
                self.raw,
                dialect,
                options.as_ptr(),
            ))
        }
    }

    /// The axes of its coordinate system, in the authority's order.
    pub fn axes(&self) -> Vec<Axis> {
        // SAFETY: both are alive; a CRS without one system gives null.
        let raw = unsafe { sys::proj_crs_get_coordinate_system(self.context.0, self.raw) };
        let Some(system) = self.owned(raw) else {
            return Vec::new();
        };
        // SAFETY: the system is alive; -1 on failure is an empty range.
        let count = unsafe { sys::proj_cs_get_axis_count(self.context.0, system.raw) };
        (0..count)
            .filter_map(|index| {
                let (mut direction, mut unit) = (null(), 0.0);
                // SAFETY: outputs that are null are not written; the text is copied while the system lives.
                unsafe {
                    let found = sys::proj_cs_get_axis_info(
                        self.context.0,
                        system.raw,
                        index,
                        null_mut(),
                        null_mut(),
                        &mut direction,
                        &mut unit,
                        null_mut(),
                        null_mut(),
                        null_mut(),
                    );
                    let direction = string(direction).filter(|_| found == 1)?;
                    Some(Axis { direction, unit })
                }
            })
            .collect()
    }

    /// Semi-major and semi-minor axis of its ellipsoid, metres.
    pub fn ellipsoid_m(&self) -> Option<[f64; 2]> {
        // SAFETY: all are alive; outputs that are null are not written.
        unsafe {
            let ellipsoid = self.owned(sys::proj_get_ellipsoid(self.context.0, self.raw))?;
            let [mut major, mut minor] = [0.0; 2];
            let found = sys::proj_ellipsoid_get_parameters(
                self.context.0,
                ellipsoid.raw,
                &mut major,
                &mut minor,
                null_mut(),
                null_mut(),
            );
            (found == 1).then_some([major, minor])
        }
    }

    /// Name of a projected CRS's projection method, such as `Transverse Mercator`.
    pub fn method(&self) -> Option<String> {
        // SAFETY: all are alive; outputs that are null are not written; the text is copied at once.
        unsafe {
            let conversion = self.owned(sys::proj_crs_get_coordoperation(self.context.0, self.raw))?;
            let (mut name, none) = (null(), null_mut());
            sys::proj_coordoperation_get_method_info(self.context.0, conversion.raw, &mut name, none, none);
            string(name)
        }
    }

    /// The longitudes and latitudes below a CRS: the code they are registered under.
    pub fn geodetic_code(&self) -> Option<String> {
        // SAFETY: both are alive; a CRS without one gives null.
        self.owned(unsafe { sys::proj_crs_get_geodetic_crs(self.context.0, self.raw) })?
            .code()
    }

    /// The area it is registered for.
    pub fn area_of_use(&self) -> Option<GeoArea> {
        let [mut west_deg, mut south_deg, mut east_deg, mut north_deg] = [0.0; 4];
        // SAFETY: all are alive; the name is not asked for.
        let found = unsafe {
            sys::proj_get_area_of_use(
                self.context.0,
                self.raw,
                &mut west_deg,
                &mut south_deg,
                &mut east_deg,
                &mut north_deg,
                null_mut(),
            )
        };
        // PROJ writes -1000 where it knows no edge.
        (found == 1 && south_deg >= -90.0).then_some(GeoArea {
            west_deg,
            south_deg,
            east_deg,
            north_deg,
        })
    }

    /// With axes east (longitude) and north (latitude), in this order, where it has such axes.
    pub fn normalised(&self) -> Option<Self> {
        // SAFETY: both are alive; failure is null.
        self.owned(unsafe { sys::proj_normalize_for_visualization(self.context.0, self.raw) })
    }

    /// True when both mean the same; names may differ.
    pub fn is_equivalent(&self, other: &Self) -> bool {
        let criterion = sys::PJ_COMPARISON_CRITERION_PJ_COMP_EQUIVALENT;
        // SAFETY: all are alive.
        unsafe { sys::proj_is_equivalent_to_with_ctx(self.context.0, self.raw, other.raw, criterion) == 1 }
    }

    /// Registered objects that this one may be, each with PROJ's confidence, percent, best first.
    pub fn matches(&self) -> Vec<(Self, i32)> {
        let mut confidence: *mut c_int = null_mut();
        // SAFETY: the list of confidences has one entry an object and is read before it is freed.
        unsafe {
            let list = sys::proj_identify(self.context.0, self.raw, null(), null(), &mut confidence);
            let objects = self.list(list);
            let found = (0..objects.len()).map(|index| match confidence.is_null() {
                true => 0,
                false => *confidence.add(index),
            });
            let found: Vec<i32> = found.collect();
            sys::proj_int_list_destroy(confidence);
            objects.into_iter().zip(found).collect()
        }
    }

    /// Takes a list's objects and frees it.
    ///
    /// # Safety
    /// The list is null or made in this object's context, and nobody else's.
    pub(super) unsafe fn list(&self, list: *mut sys::PJ_OBJ_LIST) -> Vec<Self> {
        if list.is_null() {
            return Vec::new();
        }
        // SAFETY: the list is alive until its objects are taken (each is a copy).
        unsafe {
            let count = sys::proj_list_get_count(list);
            let objects = (0..count)
                .filter_map(|index| self.owned(sys::proj_list_get(self.context.0, list, index)))
                .collect();
            sys::proj_list_destroy(list);
            objects
        }
    }
}

/// A copy of PROJ's text; none when there is none.
///
/// # Safety
/// The pointer is null or a C string that lives during the call.
pub(super) unsafe fn string(text: *const c_char) -> Option<String> {
    // SAFETY: the caller's promise.
    (!text.is_null())
        .then(|| unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
        .filter(|text| !text.is_empty())
}
