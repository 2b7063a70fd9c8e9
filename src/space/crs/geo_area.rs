//! An area of the globe, degrees of longitude and latitude.

use glam::DVec2;

/// A box in degrees; one over the date line has its west edge east of its east edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeoArea {
    /// Longitude where it begins, -180 to 180.
    pub west_deg: f64,
    /// Smallest latitude.
    pub south_deg: f64,
    /// Longitude where it ends, -180 to 180.
    pub east_deg: f64,
    /// Largest latitude.
    pub north_deg: f64,
}

impl GeoArea {
    /// The smallest area that holds points (longitude, latitude); none without a finite one.
    pub fn from_points(points: &[DVec2]) -> Option<Self> {
        let finite = || points.iter().filter(|point| point.is_finite());
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| {
                (min.min(value), max.max(value))
            })
        };
        let (south, north) = range(&mut finite().map(|point| point.y.clamp(-90.0, 90.0)));
        if south > north {
            return None;
        }
        let (west, east) = range(&mut finite().map(|point| (point.x + 180.0).rem_euclid(360.0) - 180.0));
        // Counted from 0 to 360, what lies across the date line is in one piece.
        let (first, last) = range(&mut finite().map(|point| point.x.rem_euclid(360.0)));
        let is_over_date_line = last - first < east - west && first <= 180.0 && last > 180.0;
        let (west_deg, east_deg) = if is_over_date_line {
            (first, last - 360.0)
        } else {
            (west, east)
        };
        Some(Self {
            west_deg,
            south_deg: south,
            east_deg,
            north_deg: north,
        })
    }

    /// Its centre, longitude and latitude.
    pub fn centre(&self) -> DVec2 {
        let [west, east] = self.longitudes();
        let longitude = (0.5 * (west + east) + 180.0).rem_euclid(360.0) - 180.0;
        DVec2::new(longitude, 0.5 * (self.south_deg + self.north_deg))
    }

    /// The part common to both; none when they do not meet.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let ([west, east], [other_west, other_east]) = (self.longitudes(), other.longitudes());
        let (south_deg, north_deg) = (
            self.south_deg.max(other.south_deg),
            self.north_deg.min(other.north_deg),
        );
        [-360.0, 0.0, 360.0].into_iter().find_map(|shift| {
            let (first, last) = (west.max(other_west + shift), east.min(other_east + shift));
            let into_range = |degrees: f64| match degrees {
                past if past > 180.0 => past - 360.0,
                before if before < -180.0 => before + 360.0,
                within => within,
            };
            (first <= last && south_deg <= north_deg).then_some(Self {
                west_deg: into_range(first),
                south_deg,
                east_deg: into_range(last),
                north_deg,
            })
        })
    }

    /// West and east edge, the east one beyond 180 where the area lies over the date line.
    fn longitudes(&self) -> [f64; 2] {
        let turn = if self.west_deg <= self.east_deg {
            0.0
        } else {
            360.0
        };
        [self.west_deg, self.east_deg + turn]
    }

    /// Grown by some degrees on every side.
    #[must_use]
    pub fn grown(&self, degrees: f64) -> Self {
        Self {
            west_deg: self.west_deg - degrees,
            south_deg: self.south_deg - degrees,
            east_deg: self.east_deg + degrees,
            north_deg: self.north_deg + degrees,
        }
    }

    /// True when a point (longitude, latitude) lies in it.
    pub fn contains(&self, point: DVec2) -> bool {
        let (west, east) = (self.west_deg, self.east_deg);
        let along = if west <= east {
            (west..=east).contains(&point.x)
        } else {
            point.x >= west || point.x <= east
        };
        along && (self.south_deg..=self.north_deg).contains(&point.y)
    }
}
