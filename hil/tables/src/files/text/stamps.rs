//! Dates and times of day, as loggers write them in their rows.

/// A stamp: a day, `None` if it has only the time of day, and the time of that day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stamp<'c> {
    /// Days since a fixed day, if the date is unambiguous.
    pub day: Option<i64>,
    /// The date as written; empty without a date.
    pub date: &'c str,
    /// Nanoseconds since midnight.
    pub nanoseconds: i64,
}

const DAY: i64 = 86_400_000_000_000;
/// Distance from midnight within which a time has passed it. Convention: no row of a recording comes an hour after another.
const HOUR: i64 = DAY / 24;

/// The stamps of a column, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Since {
    /// Nanoseconds since midnight of the first and of the last one.
    first: i64,
    last: i64,
    /// The date of the last one.
    date: String,
    day: Option<i64>,
    /// Days from the first one to the last.
    days: i64,
    /// Number of these days without a date.
    pub guessed: u64,
}

impl Since {
    /// From this stamp on.
    pub fn of(first: &Stamp) -> Self {
        Self {
            first: first.nanoseconds,
            last: first.nanoseconds,
            date: first.date.to_owned(),
            day: first.day,
            days: 0,
            guessed: 0,
        }
    }

    /// Seconds from the first stamp to the next one; an error in words if the dates do not determine the number of days between
    /// them.
    ///
    /// From the last hour of a day to the first one of another, one midnight has passed, even if the date does not show it.
    pub fn seconds(&mut self, next: &Stamp) -> Result<f64, &'static str> {
        let is_midnight = self.last >= DAY - HOUR && next.nanoseconds < HOUR;
        let days = match (self.day, next.day) {
            _ if self.date == next.date && !self.date.is_empty() => 0,
            (Some(day), Some(next)) => next - day,
            _ if is_midnight => {
                self.guessed += 1;
                1
            }
            _ if self.date == next.date => 0,
            _ => return Err(UNCLEAR),
        };
        if self.date != next.date {
            next.date.clone_into(&mut self.date);
            self.day = next.day;
        }
        self.last = next.nanoseconds;
        self.days = self.days.checked_add(days).ok_or(TOO_FAR)?;
        let nanoseconds = self.days.checked_mul(DAY);
        let nanoseconds = nanoseconds.map(|days| days + next.nanoseconds - self.first);
        nanoseconds
            .map(|nanoseconds| nanoseconds as f64 / 1e9)
            .ok_or(TOO_FAR)
    }
}

const UNCLEAR: &str = "the date changes, but its day and month cannot be distinguished";
const TOO_FAR: &str = "the dates are too far apart";

impl<'c> Stamp<'c> {
    /// The stamp in a cell: `2024-03-01 12:00:00.125`, `01.03.2024 12:00:00,125`, `00:01:02.345`, `3/1/2024 1:54:32 PM`.
    pub fn of(cell: &'c str) -> Option<Self> {
        let colon = cell.find(':')?;
        let before = &cell[..colon];
        // The date ends before the digits of the hour, at a blank or a T.
        let begin = before.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let (date, time) = (before[..begin].trim_end(), &cell[begin..]);
        let (date, is_divided) = match date.strip_suffix(['T', 't']) {
            Some(date) => (date, true),
            None => (date, date.len() < begin),
        };
        let date = date.trim_end_matches(',').trim();
        let (day, is_date) = if begin == 0 {
            (None, true)
        } else {
            let day = day(date);
            (day.flatten(), day.is_some() && is_divided)
        };
        if !is_date {
            return None;
        }
        Some(Self {
            day,
            date,
            nanoseconds: time_of_day(time)?,
        })
    }
}

/// The number of a day; `Some(None)` if day and month are ambiguous.
fn day(date: &str) -> Option<Option<i64>> {
    let sign = date.chars().find(|c| !c.is_ascii_digit())?;
    if !['-', '.', '/'].contains(&sign) {
        return None;
    }
    let parts: Vec<&str> = date.split(sign).collect();
    let [first, second, third] = parts[..] else {
        return None;
    };
    let number = |text: &str| -> Option<i64> {
        let is_short = (1..=4).contains(&text.len());
        (is_short && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
    };
    let (a, b, c) = (number(first)?, number(second)?, number(third)?);
    let is_month = |month: i64| (1..=12).contains(&month);
    let is_day = |day: i64| (1..=31).contains(&day);
    // The year comes first, or the day comes before points; before another sign it may be the month.
    if first.len() == 4 {
        return (is_month(b) && is_day(c)).then(|| Some(days(a, b, c)));
    }
    // Two digits first may be those of the year.
    let has_short_year = sign != '.' && first.len() == 2 && third.len() == 2;
    let mut could_be = [
        (is_day(a) && is_month(b)).then(|| days(c, b, a)),
        (is_month(a) && is_day(b) && sign != '.').then(|| days(c, a, b)),
        (has_short_year && is_month(b) && is_day(c)).then(|| days(a, b, c)),
    ]
    .into_iter()
    .flatten();
    let day = could_be.next()?;
    Some(could_be.all(|other| other == day).then_some(day))
}

/// Days of the calendar since 1 March of the year 0.
fn days(year: i64, month: i64, day: i64) -> i64 {
    // With March as the first month the leap day is the last day of the year.
    let year = if month < 3 { year - 1 } else { year };
    let month = (month + 9) % 12;
    365 * year + year.div_euclid(4) - year.div_euclid(100)
        + year.div_euclid(400)
        + (153 * month + 2) / 5
        + day
}

/// `12:00:00.125`, with a point, a comma or a colon before the fraction, and AM or PM after it.
fn time_of_day(time: &str) -> Option<i64> {
    let time = time.trim().trim_end_matches(['Z', 'z']).trim_end();
    let (time, ahead) = match time.rfind(['+', '-']) {
        Some(sign) => (time[..sign].trim_end(), Some(offset(&time[sign..])?)),
        None => (time, None),
    };
    let upper = time.len().checked_sub(2).and_then(|at| time.get(at..));
    let half = upper.filter(|end| end.eq_ignore_ascii_case("am") || end.eq_ignore_ascii_case("pm"));
    let (time, half) = match half {
        Some(half) => (time[..time.len() - 2].trim_end(), Some(half)),
        None => (time, None),
    };
    let mut parts = time.splitn(3, ':');
    let (hours, minutes, rest) = (parts.next()?, parts.next()?, parts.next()?);
    let stop = rest.find(['.', ',', ':']).unwrap_or(rest.len());
    let (seconds, fraction) = (&rest[..stop], rest.get(stop + 1..).unwrap_or_default());
    let number = |text: &str, most: i64| -> Option<i64> {
        let is_short = (1..=2).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
        let value: i64 = is_short.then(|| text.parse().ok())??;
        (value <= most).then_some(value)
    };
    let mut hours = number(hours, 24)?;
    if let Some(half) = half {
        hours = (hours <= 12).then_some(hours % 12)?;
        hours += if half.eq_ignore_ascii_case("pm") {
            12
        } else {
            0
        };
    }
    let seconds = 3600 * hours + 60 * number(minutes, 59)? + number(seconds, 60)?;
    let digits = fraction.len();
    if digits > 18
        || (stop < rest.len() && digits == 0)
        || !fraction.bytes().all(|b| b.is_ascii_digit())
    {
        return None;
    }
    let shown = &fraction[..digits.min(9)];
    let fraction: i64 = if shown.is_empty() {
        0
    } else {
        shown.parse().ok()?
    };
    let fraction = fraction * 10_i64.pow(9 - shown.len() as u32);
    Some((seconds - ahead.unwrap_or(0)) * 1_000_000_000 + fraction)
}

/// Offset of a clock from UTC in seconds: `+01:00`, `-0530`, `+02`.
fn offset(text: &str) -> Option<i64> {
    let digits = text[1..].replacen(':', "", 1);
    if !matches!(digits.len(), 2 | 4) || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (hours, minutes) = digits.split_at(2);
    let minutes: i64 = if minutes.is_empty() {
        0
    } else {
        minutes.parse().ok()?
    };
    let seconds = 3600 * hours.parse::<i64>().ok()? + 60 * minutes;
    Some(if text.starts_with('-') {
        -seconds
    } else {
        seconds
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(first: &str, cell: &str) -> Option<f64> {
        let mut since = Since::of(&Stamp::of(first)?);
        since.seconds(&Stamp::of(cell)?).ok()
    }

    #[test]
    fn stamps_are_seconds_apart() {
        for (first, cell, apart) in [
            ("2024-03-01 12:00:00.125", "2024-03-01 12:00:00.130", 0.005),
            ("2024-02-28T23:59:59", "2024-03-01T00:00:01Z", 86_402.0),
            ("2023-12-31 23:59:59,5", "2024-01-01 00:00:00,25", 0.75),
            ("31.12.2023 23:59:59", "01.01.2024 00:00:00", 1.0),
            ("00:01:02.345", "00:01:02.355", 0.01),
            ("11:59:59 AM", "12:00:01 PM", 2.0),
            ("3/1/2024 1:54:32 PM", "3/1/2024 1:54:33 PM", 1.0),
            ("12/31/2023 23:59:59", "12/31/2023 23:59:59.5", 0.5),
            ("10:00:00:125", "10:00:00:250", 0.125),
            (
                "2024-03-01T12:00:00+01:00",
                "2024-03-01T12:00:00.5+01:00",
                0.5,
            ),
            ("2024-03-31T01:59:59+0100", "2024-03-31T03:00:00+02", 1.0),
            // By the midnight passed.
            ("23:59:59.5", "00:00:00.25", 0.75),
            ("24-03-01 23:59:59", "24-03-02 00:00:01", 2.0),
            ("3/4/2024 23:59:59", "3/5/2024 00:00:00", 1.0),
        ] {
            let is = seconds(first, cell).unwrap_or(f64::NAN);
            assert!((is - apart).abs() < 1e-9, "{first} to {cell}: {is}");
        }
        // 3 April or 4 March.
        assert_eq!(seconds("3/4/2024 12:59:59", "3/5/2024 00:00:00"), None);
        // A clock that was set back is not a midnight.
        assert_eq!(seconds("12:00:00", "00:00:01"), Some(-43_199.0));
        for cell in [
            "12:00",
            "1:2",
            "abc",
            "12:61:00",
            "99.99.2024 12:00:00",
            "key: 12:00:00",
            ":",
            "12:00:00.",
            "12:00:00+1",
            "12:00:00+01:0",
        ] {
            assert_eq!(Stamp::of(cell), None, "{cell}");
        }
    }
}
