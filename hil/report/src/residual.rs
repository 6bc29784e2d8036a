//! The residual force of a law: its place over displacement and velocity, its frequencies, and whether it is white.

use realfft::RealFftPlanner;

use super::Series;

/// Cells of a map along either axis.
pub const CELLS: usize = 25;
/// Fewest samples in a drawn cell of a map.
const FEWEST: usize = 3;
/// Samples of one spectrum; several are averaged.
const SEGMENT: usize = 4096;
/// Bands of frequency, evenly spread over its logarithm.
const BANDS: usize = 160;
/// Most lags of an autocorrelation.
const MOST_LAGS: usize = 200;
/// Lags for the test of whiteness.
const TESTED: usize = 20;

/// The law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// The law alone.
    Before,
    /// With the effects found.
    After,
}

/// Measured force minus the law's at the measured samples, kN; 0 at others.
fn residual(series: &Series, law: Law) -> Vec<f64> {
    let predicted = match law {
        Law::Before => &series.before,
        Law::After => &series.after,
    };
    (0..series.time.len())
        .map(|index| {
            let measured = series.measured.get(index).copied().unwrap_or(true);
            let values = series.force.get(index).zip(predicted.get(index));
            values
                .filter(|_| measured)
                .map_or(0.0, |(force, law)| force - law)
        })
        .collect()
}

/// Mean residual over displacement and velocity, cell by cell.
#[derive(Clone, Debug)]
pub struct Map {
    /// Largest displacement, mm: the cells span ± this.
    pub displacement: f64,
    /// Largest velocity, mm/s, likewise.
    pub velocity: f64,
    /// kN, row by row from the lowest velocity; `None` where the motion never was.
    pub cells: Vec<Option<f64>>,
}

impl Map {
    /// The map of the residual of `law` in all of `series`. Cells are finer at low velocities, where the motions of all frequencies
    /// meet: they are even in the cube root of the velocity.
    pub fn of(series: &[Series], law: Law) -> Self {
        let largest = |channel: fn(&Series) -> &Vec<f64>| {
            let values = series.iter().flat_map(channel);
            values.fold(f64::MIN_POSITIVE, |largest, value| largest.max(value.abs()))
        };
        let displacement = largest(|one| &one.displacement);
        let velocity = largest(|one| &one.velocity);
        let mut sums = vec![(0.0, 0); CELLS * CELLS];
        for one in series {
            let channels = one.displacement.iter().zip(&one.velocity);
            for ((y, v), left) in channels.zip(residual(one, law)) {
                let cell =
                    |part: f64| ((0.5 * (part + 1.0) * CELLS as f64) as usize).min(CELLS - 1);
                let at = cell((v / velocity).cbrt()) * CELLS + cell(y / displacement);
                sums[at].0 += left;
                sums[at].1 += 1;
            }
        }
        let mean = |&(sum, count): &(f64, usize)| (count >= FEWEST).then(|| sum / count as f64);
        Self {
            displacement,
            velocity,
            cells: sums.iter().map(mean).collect(),
        }
    }

    /// Magnitude that all cells except the most extreme hundredth stay below, kN.
    pub fn scale(&self) -> f64 {
        let mut sizes: Vec<f64> = self.cells.iter().flatten().map(|cell| cell.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let place = (sizes.len() * 99) / 100;
        sizes
            .get(place.min(sizes.len().saturating_sub(1)))
            .copied()
            .unwrap_or(0.0)
    }
}

/// Frequency (Hz) and RMS amplitude (kN) of the residual of `law`, in bands of equal width on a logarithmic axis; empty bands are
/// left out. Amplitudes are those of sines: white noise of deviation σ lies at about σ·√(3/4096), and a tone stands out from it.
///
/// With a Hann window, segments that overlap by half (Welch 1967), averaged over all of `series`.
pub fn spectrum(series: &[Series], law: Law) -> Vec<(f64, f64)> {
    let mut lines: Vec<(f64, f64)> = Vec::new();
    for one in series {
        let left = residual(one, law);
        let length = SEGMENT.min(left.len());
        let [first, second, ..] = one.time[..] else {
            continue;
        };
        if length < 16 {
            continue;
        }
        let window: Vec<f64> = (0..length)
            .map(|i| 0.5 - 0.5 * (std::f64::consts::TAU * i as f64 / length as f64).cos())
            .collect();
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let mut power = vec![0.0; length / 2 + 1];
        let mut segments = 0.0;
        for start in (0..=left.len() - length).step_by((length / 2).max(1)) {
            let mut input: Vec<f64> = left[start..]
                .iter()
                .zip(&window)
                .map(|(x, w)| x * w)
                .collect();
            let mut output = transform.make_output_vec();
            // Both have the planned length.
            if transform.process(&mut input, &mut output).is_ok() {
                power
                    .iter_mut()
                    .zip(&output)
                    .for_each(|(power, line)| *power += line.norm_sqr());
                segments += 1.0;
            }
        }
        // A sine of amplitude A gives A·length/4 under this window.
        let amplitude = 4.0 / length as f64;
        let step = 1.0 / (length as f64 * (second - first));
        lines.extend(
            (1..power.len())
                .map(|i| (i as f64 * step, amplitude * amplitude * power[i] / segments)),
        );
    }
    banded(&lines)
}

fn banded(lines: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (low, high) = lines
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), line| {
            (low.min(line.0), high.max(line.0))
        });
    if high <= low {
        return Vec::new();
    }
    let width = (high / low).ln() / BANDS as f64;
    let mut bands = vec![(0.0, 0.0); BANDS];
    for &(frequency, power) in lines {
        let band = (((frequency / low).ln() / width) as usize).min(BANDS - 1);
        bands[band].0 += power;
        bands[band].1 += 1.0;
    }
    bands
        .iter()
        .enumerate()
        .filter(|(_, band)| band.1 > 0.0)
        .map(|(index, (power, count))| {
            (
                low * ((index as f64 + 0.5) * width).exp(),
                (power / count).sqrt(),
            )
        })
        .collect()
}

/// The correlation of the residual with itself some samples later.
#[derive(Clone, Debug)]
pub struct Autocorrelation {
    /// From lag 1 on.
    pub values: Vec<f64>,
    /// Nineteen in twenty values of white noise lie within ± this.
    pub white: f64,
    /// Sum of Ljung and Box (1978) over the first [`Autocorrelation::tested`] lags; for white noise it is the number of lags, give
    /// or take the root of twice that.
    pub ljung_box: f64,
    /// Number of lags in the sum.
    pub tested: usize,
}

impl Autocorrelation {
    /// For the residual of `law` in the longest of `series`; `None` if there are too few samples.
    pub fn of(series: &[Series], law: Law) -> Option<Self> {
        let longest = series.iter().max_by_key(|one| one.time.len())?;
        let left = residual(longest, law);
        let count = left.len();
        if count < 8 * TESTED {
            return None;
        }
        let mean = left.iter().sum::<f64>() / count as f64;
        let left: Vec<f64> = left.iter().map(|value| value - mean).collect();
        let power: f64 = left.iter().map(|value| value * value).sum();
        if power == 0.0 {
            return None;
        }
        let values: Vec<f64> = (1..=MOST_LAGS.min(count / 4))
            .map(|lag| {
                left.iter()
                    .zip(&left[lag..])
                    .map(|(a, b)| a * b)
                    .sum::<f64>()
                    / power
            })
            .collect();
        let n = count as f64;
        let terms = values.iter().take(TESTED).enumerate();
        let sum: f64 = terms
            .map(|(index, r)| r * r / (n - (index + 1) as f64))
            .sum();
        Some(Self {
            white: 1.96 / n.sqrt(),
            ljung_box: n * (n + 2.0) * sum,
            tested: TESTED,
            values,
        })
    }

    /// Whether white noise gives a sum this large at least once in a hundred times. The sum is then χ² distributed, and its cube
    /// root is nearly normal (Wilson and Hilferty 1931).
    pub fn is_white(&self) -> bool {
        let m = self.tested as f64;
        let normal =
            ((self.ljung_box / m).cbrt() - (1.0 - 2.0 / (9.0 * m))) / (2.0 / (9.0 * m)).sqrt();
        normal < 2.326
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    /// Half a minute at 500 Hz. The residual of the law is noise, and before also `extra` of displacement mm and time s.
    fn series(extra: impl Fn(f64, f64) -> f64) -> [Series; 1] {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let time: Vec<f64> = (0..15_000).map(|i| f64::from(i) * 0.002).collect();
        let wave = |t: &f64| (std::f64::consts::TAU * t).sin_cos();
        let displacement: Vec<f64> = time.iter().map(|t| 0.1 * wave(t).0).collect();
        let noise: Vec<f64> = time
            .iter()
            .map(|_| StandardNormal.sample(&mut random))
            .collect();
        let extras = displacement.iter().zip(&time).map(|(y, t)| extra(*y, *t));
        [Series {
            velocity: time.iter().map(|t| 0.628 * wave(t).1).collect(),
            before: extras.map(|extra| -extra).collect(),
            after: vec![0.0; time.len()],
            force: noise.iter().map(|n: &f64| 1e-3 * n).collect(),
            measured: vec![true; time.len()],
            displacement,
            time,
            ..Series::default()
        }]
    }

    #[test]
    fn a_map_shows_where_the_force_is_left() {
        let series = series(|y, _| 3.0 * y * y);
        let (before, after) = (Map::of(&series, Law::Before), Map::of(&series, Law::After));
        // 3·0.1² at the turns, nothing in the middle; noise of 1e-3 averaged over three samples or more.
        assert!((before.scale() - 0.03).abs() < 0.004, "{}", before.scale());
        assert!(after.scale() < 2e-3, "{}", after.scale());
        let middle = before.cells[(CELLS - 1) * CELLS + CELLS / 2].unwrap();
        assert!(middle.abs() < 2e-3, "{middle}");
        assert!(
            before.cells[0].is_none(),
            "never at once at the turn and fast"
        );
    }

    #[test]
    fn a_tone_stands_at_its_frequency_with_its_amplitude() {
        let series = series(|_, t| 0.02 * (std::f64::consts::TAU * 50.0 * t).sin());
        let highest = |law| {
            let lines = spectrum(&series, law);
            lines
                .into_iter()
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap()
        };
        let (frequency, amplitude) = highest(Law::Before);
        assert!((frequency / 50.0 - 1.0).abs() < 0.05, "{frequency}");
        // A band holds several lines, and the tone is in three of them.
        assert!((0.005..=0.02).contains(&amplitude), "{amplitude}");
        assert!(highest(Law::After).1 < 2e-4);
    }

    #[test]
    fn noise_is_white_and_what_depends_on_the_motion_is_not() {
        let series = series(|y, _| 0.02 * y);
        let after = Autocorrelation::of(&series, Law::After).unwrap();
        assert!(after.is_white(), "{}", after.ljung_box);
        let outside = after
            .values
            .iter()
            .filter(|r| r.abs() > after.white)
            .count();
        assert!((2..=24).contains(&outside), "{outside} of 200");
        let before = Autocorrelation::of(&series, Law::Before).unwrap();
        assert!(!before.is_white(), "{}", before.ljung_box);
    }
}
