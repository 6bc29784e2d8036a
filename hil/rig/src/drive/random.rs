//! A band of frequencies with random phases and equal amplitudes. It repeats after its duration, and has no power outside the band
//! (a multisine: Pintelon and Schoukens, System Identification, 2012, ch. 2).

use std::f64::consts::TAU;

use mesh_damper_output::error::{InputError, Place, quoted};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use super::{Grid, Motion};

const FORM: &str =
    "write random:rms=0.1mm,from=0.5Hz,to=20Hz,duration=30s,seed=1; only the seed may be left out";
/// The longest motion, s.
const LONGEST: f64 = 3600.0;
/// Length of its ramps, s: one period of the lowest frequency, clamped to this range.
const RAMP: [f64; 2] = [0.2, 5.0];

/// Parameters of such a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomMotion {
    /// RMS of the displacement, mm, 1e-6…1e4.
    pub rms: f64,
    /// Lowest frequency, Hz, with at least one cycle in the duration.
    pub from: f64,
    /// Highest frequency, Hz, above the lowest and at most a tenth of the knots' rate, 100 Hz at ticks of 1 kHz and more.
    pub to: f64,
    /// Duration without its ramps, s, up to an hour.
    pub duration: f64,
    /// Seed of the phases.
    pub seed: u64,
}

fn refused(field: &str, problem: String, remedy: impl Into<String>) -> InputError {
    InputError::new("random motion", problem, remedy).at(Place::Field(field.into()))
}

/// A number with one of `units`, or without a unit, in which case the first of them applies.
fn quantity(field: &str, text: &str, units: &[(&str, f64)]) -> Result<f64, InputError> {
    let digits = text.trim_end_matches(|c: char| c.is_alphabetic());
    let unit = &text[digits.len()..];
    let known: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
    let scale = match units.iter().find(|(name, _)| *name == unit) {
        Some((_, scale)) => *scale,
        None if unit.is_empty() => 1.0,
        None => {
            let problem = format!("{} is not a unit of it", quoted(unit));
            return Err(refused(
                field,
                problem,
                format!("use {}", known.join(" or ")),
            ));
        }
    };
    match digits.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value * scale),
        _ => Err(refused(
            field,
            format!("{} is not a number above 0", quoted(digits)),
            FORM,
        )),
    }
}

impl RandomMotion {
    /// Parses `text`: `rms=0.1mm,from=0.5Hz,to=20Hz,duration=30s,seed=1`, in any order. Units are optional, and so is the seed,
    /// which is 1 by default.
    ///
    /// # Errors
    /// The field that is missing, given twice, unknown, or invalid.
    pub fn parse(text: &str) -> Result<Self, InputError> {
        let [mut rms, mut from, mut to, mut duration] = [None; 4];
        let mut seed = None;
        for part in text.split(',') {
            let Some((field, value)) = part.split_once('=') else {
                let problem = format!("{} is not name=value", quoted(part.trim()));
                return Err(InputError::new("random motion", problem, FORM));
            };
            let (field, value) = (field.trim(), value.trim());
            let place = match field {
                "rms" => &mut rms,
                "from" => &mut from,
                "to" => &mut to,
                "duration" => &mut duration,
                "seed" if seed.is_none() => {
                    let problem = format!("{} is no whole number", quoted(value));
                    seed = Some(value.parse().map_err(|_| refused(field, problem, FORM))?);
                    continue;
                }
                "seed" => return Err(refused(field, "it is given twice".into(), FORM)),
                _ => return Err(refused(field, "there is no such field".into(), FORM)),
            };
            let units: &[(&str, f64)] = match field {
                "rms" => &[("mm", 1.0), ("um", 1e-3), ("m", 1e3), ("in", 25.4)],
                "duration" => &[("s", 1.0), ("min", 60.0), ("ms", 1e-3)],
                _ => &[("Hz", 1.0)],
            };
            if place.is_some() {
                return Err(refused(field, "it is given twice".into(), FORM));
            }
            *place = Some(quantity(field, value, units)?);
        }
        let needed = |field: &str, value: Option<f64>| {
            value.ok_or_else(|| refused(field, "it is missing".into(), FORM))
        };
        Ok(Self {
            rms: needed("rms", rms)?,
            from: needed("from", from)?,
            to: needed("to", to)?,
            duration: needed("duration", duration)?,
            seed: seed.unwrap_or(1),
        })
    }

    /// The motion on `grid`. Its duration is rounded to a whole number of knots; its frequencies are multiples of the inverse of
    /// the duration.
    ///
    /// # Errors
    /// The field that is out of its range.
    pub fn motion(&self, grid: Grid) -> Result<Motion, InputError> {
        let highest = 0.1 / grid.step();
        for (field, value, low, high, unit) in [
            ("rms", self.rms, 1e-6, 1e4, "mm"),
            ("duration", self.duration, 1.0 / self.from, LONGEST, "s"),
            ("to", self.to, self.from, highest, "Hz"),
        ] {
            if !(low..=high).contains(&value) {
                let problem = format!("{value} {unit} is outside {low} to {high} {unit}");
                return Err(refused(field, problem, "change it"));
            }
        }
        let count = (self.duration / grid.step()).round() as usize;
        let period = count as f64 * grid.step();
        // A line is included even if a decimal frequency is off it by rounding.
        let first = (self.from * period - 1e-6).ceil().max(1.0) as usize;
        let last = (self.to * period + 1e-6).floor() as usize;
        if first > last || last >= count / 2 {
            let problem = format!(
                "no multiple of {:.4} Hz, one over the duration, is from {} to {} Hz",
                1.0 / period,
                self.from,
                self.to
            );
            return Err(refused(
                "to",
                problem,
                "widen the band, or make the duration longer",
            ));
        }
        let amplitude = self.rms * (2.0 / (last - first + 1) as f64).sqrt();
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let mut lines = vec![[Complex::default(); 2]; count / 2 + 1];
        for (index, line) in lines.iter_mut().enumerate().take(last + 1).skip(first) {
            let displacement = Complex::from_polar(0.5 * amplitude, random.random_range(0.0..TAU));
            let rate = Complex::new(0.0, TAU * index as f64 / period);
            *line = [displacement, displacement * rate];
        }
        let displacement = summed(lines.iter().map(|line| line[0]).collect(), count);
        let velocity = summed(lines.iter().map(|line| line[1]).collect(), count);
        let ramp_time = (1.0 / self.from).clamp(RAMP[0], RAMP[1]);
        let ramp = (ramp_time / grid.step()).ceil() as usize;
        // The motion is periodic, so it exists before its start and after its end.
        let at = |knot: usize| [displacement[knot % count], velocity[knot % count]];
        let faded = |knot: usize, done: usize, sign: f64| {
            let s = done as f64 / ramp as f64;
            let window = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
            let slope = sign * 30.0 * (s * (1.0 - s)).powi(2) / (ramp as f64 * grid.step());
            let [y, v] = at(knot);
            [window * y, window * v + slope * y]
        };
        let before = count * ramp.div_ceil(count) - ramp;
        Ok(Motion::new(
            grid,
            (0..ramp).map(|k| faded(before + k, k, 1.0)).collect(),
            (0..=count).map(at).collect(),
            (1..=ramp).map(|k| faded(k, ramp - k, -1.0)).collect(),
        ))
    }
}

/// The `count` samples of a real signal whose lines from 0 on are half of `lines`.
fn summed(mut lines: Vec<Complex<f64>>, count: usize) -> Vec<f64> {
    let plan = RealFftPlanner::<f64>::new().plan_fft_inverse(count);
    let mut samples = plan.make_output_vec();
    match plan.process(&mut lines, &mut samples) {
        Ok(()) => samples,
        // Possible only for lines that must be real and are not, and there are none.
        Err(_) => vec![0.0; count],
    }
}
