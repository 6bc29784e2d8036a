//! Dates and times of day, as loggers stamp their rows.

/// A stamp: a day, none where it has the time of day alone, and the time of that day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stamp<'c> {
    /// Days since some day, where the date says it for sure.
    pub day: Option<i64>,
    /// The date as it is written; empty where there is none.
    pub date: &'c str,
    /// Nanoseconds since midnight.
    pub nanoseconds: i64,
}

const DAY: i64 = 86_400_000_000_000;

impl<'c> Stamp<'c> {
    /// The stamp in a cell: `2024-03-01 12:00:00.125`, `01.03.2024 12:00:00,125`, `00:01:02.345`, `3/1/2024 1:54:32 PM`.
    pub fn of(cell: &'c str) -> Option<Self> {
        let colon = cell.find(':')?;
        let before = &cell[..colon];
        // The date ends before the digits of the hour, with a blank or a T.
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

    /// Seconds since `first`; an error in words where the dates do not say how many days apart they are.
    pub fn since(&self, first: &Stamp) -> Result<f64, &'static str> {
        let days = match (self.day, first.day) {
            _ if self.date == first.date => 0,
            (Some(day), Some(first)) => day - first,
            _ => return Err("the date changes, and day and month cannot be told apart in it"),
        };
        let nanoseconds = days
            .checked_mul(DAY)
            .map(|days| days + self.nanoseconds - first.nanoseconds);
        match nanoseconds {
            Some(nanoseconds) => Ok(nanoseconds as f64 / 1e9),
            None => Err("the dates are too far apart"),
        }
    }
}

/// The number of a day; none inside where day and month could be either.
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
    // The year comes first, or the day does before points; before anything else it may be the month.
    if first.len() == 4 {
        return (is_month(b) && is_day(c)).then(|| Some(days(a, b, c)));
    }
    let can_be_day_first = is_day(a) && is_month(b);
    let can_be_month_first = is_month(a) && is_day(b) && sign != '.';
    match (can_be_day_first, can_be_month_first) {
        (true, true) if a == b => Some(Some(days(c, b, a))),
        (true, true) => Some(None),
        (true, false) => Some(Some(days(c, b, a))),
        (false, true) => Some(Some(days(c, a, b))),
        (false, false) => None,
    }
}

/// Days of the calendar since the first of March of the year 0.
fn days(year: i64, month: i64, day: i64) -> i64 {
    // With March as the first month the day that comes every fourth year is the last of the year.
    let year = if month < 3 { year - 1 } else { year };
    let month = (month + 9) % 12;
    365 * year + year.div_euclid(4) - year.div_euclid(100)
        + year.div_euclid(400)
        + (153 * month + 2) / 5
        + day
}

/// `12:00:00.125`, with a point, a comma or a colon before the fraction, and a half of the day behind.
fn time_of_day(time: &str) -> Option<i64> {
    let time = time.trim().trim_end_matches(['Z', 'z']).trim_end();
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
    Some(seconds * 1_000_000_000 + fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(first: &str, cell: &str) -> Option<f64> {
        let first = Stamp::of(first)?;
        Stamp::of(cell)?.since(&first).ok()
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
        ] {
            let is = seconds(first, cell).unwrap_or(f64::NAN);
            assert!((is - apart).abs() < 1e-9, "{first} to {cell}: {is}");
        }
        // The third of April or the fourth of March.
        assert_eq!(seconds("3/4/2024 23:59:59", "3/5/2024 00:00:00"), None);
        for cell in [
            "12:00",
            "1:2",
            "abc",
            "12:61:00",
            "99.99.2024 12:00:00",
            "key: 12:00:00",
            ":",
            "12:00:00.",
        ] {
            assert_eq!(Stamp::of(cell), None, "{cell}");
        }
    }
}
