//! Date and time of day over a place, and when the sun rises and sets there.

use jiff::civil::Date;
use jiff::tz::{Offset, TimeZone};
use jiff::{Timestamp, ToSpan};

use crate::space::{Place, Sun, SunError, sun_direction_at};

/// A time of day at a place.
#[derive(Clone, Debug)]
pub struct Clock {
    place: Place,
    date: Date,
    offset: Offset,
    /// Hours since midnight, 0 to 24.
    pub hours: f64,
    /// Hours of sunrise and sunset; none where the sun does neither that day.
    pub sunrise_sunset: Option<[f64; 2]>,
}

/// Altitude of the sun's centre as its upper edge rises: its radius and mean refraction on the horizon (Meeus, *Astronomical
/// Algorithms*, chapter 15), degrees.
const RISING_DEG: f64 = -0.8333;
/// Steps in which a day is searched, an hour.
const STEPS_PER_HOUR: u32 = 6;

impl Clock {
    /// At an instant. `offset` is what its hours count from; without one, the zone of the place's longitude.
    pub fn new(place: Place, instant: Timestamp, offset: Option<Offset>) -> Self {
        let offset = offset.unwrap_or_else(|| zone_of(place.longitude_deg));
        let local = instant.to_zoned(TimeZone::fixed(offset));
        let hours = hours_of(&local);
        let mut clock = Self {
            place,
            date: local.date(),
            offset,
            hours,
            sunrise_sunset: None,
        };
        clock.sunrise_sunset = clock.find_sunrise_sunset();
        clock
    }

    /// Four in the afternoon of this year's midsummer, in the zone of the place's longitude.
    pub fn midsummer_afternoon(place: Place) -> Self {
        let offset = zone_of(place.longitude_deg);
        let year = Timestamp::now().to_zoned(TimeZone::fixed(offset)).year();
        let month = if place.latitude_deg < 0.0 { 12 } else { 6 };
        let local = Date::new(year, month, 21).map(|date| date.at(16, 0, 0, 0));
        let instant = local
            .and_then(|local| TimeZone::fixed(offset).to_timestamp(local))
            .unwrap_or_default();
        Self::new(place, instant, Some(offset))
    }

    /// The same hour of the same day at another place.
    pub fn move_to(&mut self, place: Place) {
        self.place = place;
        self.offset = zone_of(place.longitude_deg);
        self.sunrise_sunset = self.find_sunrise_sunset();
    }

    /// Shows an instant.
    pub fn set(&mut self, instant: Timestamp) {
        let local = instant.to_zoned(TimeZone::fixed(self.offset));
        let is_other_day = local.date() != self.date;
        (self.date, self.hours) = (local.date(), hours_of(&local));
        if is_other_day {
            self.sunrise_sunset = self.find_sunrise_sunset();
        }
    }

    /// Another day, so many from this one; the same hour.
    pub fn add_days(&mut self, days: i64) {
        if let Ok(date) = self.date.checked_add(days.days()) {
            self.date = date;
            self.sunrise_sunset = self.find_sunrise_sunset();
        }
    }

    /// The instant that an hour of the day is.
    fn instant(&self, hours: f64) -> Option<Timestamp> {
        let midnight = TimeZone::fixed(self.offset)
            .to_timestamp(self.date.to_datetime(jiff::civil::Time::midnight()))
            .ok()?;
        midnight
            .checked_add(((hours * 3600.0).round() as i64).seconds())
            .ok()
    }

    /// The sun at the clock's hour.
    ///
    /// # Errors
    /// When the year is too far away.
    pub fn sun(&self) -> Result<Sun, SunError> {
        match self.instant(self.hours) {
            Some(instant) => sun_direction_at(instant, self.place).map(Sun::from_direction),
            None => Ok(Sun::from_azimuth_altitude(0.0, -90.0)),
        }
    }

    /// Altitude at an hour above the rising sun's, degrees.
    fn altitude(&self, hours: f64) -> Option<f64> {
        let to_sun = sun_direction_at(self.instant(hours)?, self.place).ok()?;
        Some(to_sun.z.clamp(-1.0, 1.0).asin().to_degrees() - RISING_DEG)
    }

    fn find_sunrise_sunset(&self) -> Option<[f64; 2]> {
        let mut found = [None, None];
        for step in 0..24 * STEPS_PER_HOUR {
            let hour = |step: u32| f64::from(step) / f64::from(STEPS_PER_HOUR);
            let (mut from, mut to) = (hour(step), hour(step + 1));
            let rises = self.altitude(from)? <= 0.0;
            if rises == (self.altitude(to)? <= 0.0) {
                continue;
            }
            while to - from > 1.0 / 7200.0 {
                let centre = 0.5 * (from + to);
                if (self.altitude(centre)? <= 0.0) == rises {
                    from = centre;
                } else {
                    to = centre;
                }
            }
            found[usize::from(!rises)].get_or_insert(0.5 * (from + to));
        }
        let [Some(sunrise), Some(sunset)] = found else {
            return None;
        };
        Some([sunrise, sunset])
    }

    /// The date and what its hours count from, such as `2026-06-21, UTC+1`.
    pub fn label(&self) -> String {
        let hours = f64::from(self.offset.seconds()) / 3600.0;
        format!("{}, UTC{hours:+}", self.date)
    }

    /// The instant as RFC 3339.
    pub fn rfc3339(&self) -> String {
        let local = self.instant(self.hours).map(|instant| {
            let local = instant.to_zoned(TimeZone::fixed(self.offset));
            local.strftime("%Y-%m-%dT%H:%M:%S%:z").to_string()
        });
        local.unwrap_or_default()
    }
}

/// Hours since midnight.
fn hours_of(local: &jiff::Zoned) -> f64 {
    f64::from(local.hour()) + f64::from(local.minute()) / 60.0 + f64::from(local.second()) / 3600.0
}

/// An hour of the day as `HH:MM`.
pub fn hour_text(hours: f64) -> String {
    let minutes = (hours * 60.0).round() as i64;
    format!("{:02}:{:02}", minutes / 60, minutes % 60)
}

/// The nautical zone of a longitude: whole hours.
fn zone_of(longitude_deg: f64) -> Offset {
    let hours = (longitude_deg / 15.0).round().clamp(-12.0, 12.0) as i8;
    Offset::from_hours(hours).unwrap_or(Offset::UTC)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The United States Naval Observatory's table for Greenwich, 2026-06-21: sunrise 03:43, sunset 20:21 UT1.
    #[test]
    fn the_sun_rises_and_sets_as_an_almanac_says() {
        let greenwich = Place {
            latitude_deg: 51.4772,
            longitude_deg: 0.0,
            grid_north_deg: 0.0,
        };
        let instant: Timestamp = "2026-06-21T12:00:00Z".parse().unwrap_or_default();
        let clock = Clock::new(greenwich, instant, None);
        let [sunrise, sunset] = clock.sunrise_sunset.unwrap_or_default();
        assert!(
            (sunrise - (3.0 + 43.0 / 60.0)).abs() < 2.0 / 60.0,
            "{}",
            hour_text(sunrise)
        );
        assert!(
            (sunset - (20.0 + 21.0 / 60.0)).abs() < 2.0 / 60.0,
            "{}",
            hour_text(sunset)
        );
    }

    #[test]
    fn a_polar_day_has_neither() {
        let north = Place {
            latitude_deg: 80.0,
            longitude_deg: 20.0,
            grid_north_deg: 0.0,
        };
        let instant: Timestamp = "2026-06-21T12:00:00Z".parse().unwrap_or_default();
        assert_eq!(Clock::new(north, instant, None).sunrise_sunset, None);
    }
}
