//! The points of a curve, reduced and shortened to the needs of a picture.

use std::fmt::Write as _;
use std::ops::Range;

/// Units of a curve's points per pixel of the page: whole numbers of them are short, and finer than visible.
pub const FINE: f64 = 20.0;
/// Most points of one loop.
pub const CURVE_POINTS: usize = 400;
/// Columns into which a long time is divided, each with its smallest and largest value: more than there are pixels, for zooming in.
pub const TIME_COLUMNS: usize = 2000;

/// At most `most` of the samples, evenly spread, including the last one.
pub fn thinned(samples: Range<usize>, most: usize) -> Vec<usize> {
    let (start, count) = (samples.start, samples.len());
    if count <= most {
        return samples.collect();
    }
    (0..most)
        .map(|i| start + i * (count - 1) / (most - 1))
        .collect()
}

/// Points in order of x, divided into columns, of which the smallest and the largest value remain.
pub fn envelope(points: &[(f64, f64)], columns: usize) -> Vec<(f64, f64)> {
    let size = points.len().div_ceil(columns).max(1);
    if size <= 2 {
        return points.to_vec();
    }
    points
        .chunks(size)
        .flat_map(|column| {
            let least = column.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1));
            let largest = column.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
            let mut ends: Vec<(f64, f64)> = least.into_iter().chain(largest).collect();
            ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            ends
        })
        .collect()
}

/// A path along `points` in px: steps in whole units of 1/[`FINE`] px. It is interrupted where a point is not finite.
pub fn path(points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut path = String::new();
    let mut last = (0, 0);
    let (mut breaks, mut letter) = (true, ' ');
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            breaks = true;
            continue;
        }
        let at = fine(x, y);
        let next = match breaks {
            true if path.is_empty() => 'M',
            true => 'm',
            false => 'l',
        };
        if next != letter {
            path.push(next);
        }
        step(&mut path, at.0 - last.0, next == letter);
        step(&mut path, at.1 - last.1, true);
        (last, breaks, letter) = (at, false, next);
    }
    path
}

/// Dots at `points` in px, as one path of lines without length: with round ends each is a disc.
pub fn dots(points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut path = String::new();
    let mut last = (0, 0);
    for (x, y) in points.filter(|(x, y)| x.is_finite() && y.is_finite()) {
        let at = fine(x, y);
        path.push(if path.is_empty() { 'M' } else { 'm' });
        step(&mut path, at.0 - last.0, false);
        step(&mut path, at.1 - last.1, true);
        path.push_str("h0");
        last = at;
    }
    path
}

/// A number, separated from the previous one; a sign also separates.
fn step(path: &mut String, value: i64, parted: bool) {
    let separator = if parted && value >= 0 { "," } else { "" };
    // Writing into a string does not fail.
    let _ = write!(path, "{separator}{value}");
}

/// A point far outside the picture is cut off anyway.
fn fine(x: f64, y: f64) -> (i64, i64) {
    [x, y]
        .map(|value| (FINE * value.clamp(-1e5, 1e5)).round() as i64)
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_ends_and_the_peaks() {
        assert_eq!(thinned(5..8, 10), [5, 6, 7]);
        let chosen = thinned(10..100_010, 400);
        assert_eq!((chosen.len(), chosen[0], chosen[399]), (400, 10, 100_009));
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|i| (f64::from(i), 0.0)).collect();
        points[4321].1 = 7.0;
        points[8000].1 = -7.0;
        let thin = envelope(&points, 100);
        assert_eq!(thin.len(), 200);
        assert!(thin.contains(&points[4321]) && thin.contains(&points[8000]));
    }

    #[test]
    fn a_path_is_short_and_ends_where_its_curve_does() {
        let points = [
            (1.0, 2.0),
            (1.5, 1.0),
            (f64::NAN, 0.0),
            (4.0, 4.0),
            (4.0, 5.0),
            (3.0, 5.0),
        ];
        assert_eq!(path(points.into_iter()), "M20,40l10-20m50,60l0,20-20,0");
        assert_eq!(
            dots(points.into_iter()),
            "M20,40h0m10-20h0m50,60h0m0,20h0m-20,0h0"
        );
        assert_eq!(path(std::iter::empty()), "");
        // Rounding errors do not add up: 0.03 px is less than a unit.
        let many = path((0..=1000).map(|i| (0.03 * f64::from(i), 0.0)));
        let steps = many.trim_start_matches("M0,0l").split(',');
        let sum: i64 = steps.step_by(2).map(|x| x.parse::<i64>().unwrap()).sum();
        assert_eq!(sum, 600);
    }
}
