//! A recorded motion, to be run again.
//!
//! Displacement and velocity are estimated as in a trace, by cubics over windows that reject the noise, because a rig that followed
//! the noise would shake. The rejected part is reported. Between samples the motion is the cubic that meets both.

use mesh_damper_output::error::{InputError, Place as Where};
use mesh_damper_recording::Recording;
use mesh_damper_recording::motion::MotionEstimate;

use super::{Grid, Motion, Place, cubic};

/// Durations of ramps to try, s: the first one that exceeds none of the motion's own peaks is used, else the gentlest.
const RAMPS: [f64; 10] = [0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0];

/// A motion from a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// From rest to rest.
    pub motion: Motion,
    /// RMS of the part that was taken for displacement noise and rejected, mm, scaled like the motion.
    pub left_out: f64,
}

/// The displacement of `recording` on `grid`, with `shift` mm added and then multiplied by `scale`.
///
/// # Errors
/// A scale or a shift that is not a number, a recording with a gap, or one shorter than two knots.
pub fn recorded(
    recording: &Recording,
    scale: f64,
    shift: f64,
    grid: Grid,
) -> Result<Recorded, InputError> {
    for (field, value) in [("scale", scale), ("shift", shift)] {
        if !value.is_finite() {
            let problem = format!("{value} is not finite");
            return Err(InputError::new(&recording.name, problem, "give a number")
                .at(Where::Field(field.into())));
        }
    }
    let uniform = recording.uniform()?;
    if let Some(gap) = uniform.measured.iter().position(|measured| !measured) {
        let problem = format!("there is a gap at {:.3} s", uniform.time(gap));
        let remedy = "record it again, or cut the file there and run the parts";
        return Err(InputError::new(&recording.name, problem, remedy));
    }
    let period = uniform.period;
    let estimate = MotionEstimate::of(&uniform.displacement, period);
    let left_out = uniform
        .displacement
        .iter()
        .zip(&estimate.displacement)
        .map(|(measured, estimated)| (measured - estimated).powi(2))
        .sum::<f64>();
    let samples: Vec<[f64; 2]> = estimate
        .displacement
        .iter()
        .zip(&estimate.velocity)
        .map(|(y, v)| [scale * (y + shift), scale * v])
        .collect();
    let last = samples.len() - 1;
    let count = (last as f64 * period / grid.step() + 1e-6) as usize;
    if count < 2 {
        let problem = format!("{:.4} s is too short for a motion", last as f64 * period);
        return Err(InputError::new(&recording.name, problem, "record longer"));
    }
    let at = |time: f64| {
        let place = time / period;
        let before = (place as usize).min(last - 1);
        cubic(
            samples[before],
            samples[before + 1],
            period,
            place - before as f64,
        )
    };
    let core: Vec<[f64; 2]> = (0..=count)
        .map(|knot| {
            let place = at((knot as f64 * grid.step()).min(last as f64 * period));
            [place.displacement, place.velocity]
        })
        .collect();
    let peaks = Motion::new(grid, Vec::new(), core.clone(), Vec::new()).peaks();
    let end = |knot: usize, sample: usize, way: f64| Place {
        displacement: core[knot][0],
        velocity: way * core[knot][1],
        acceleration: scale * estimate.acceleration[sample],
    };
    let lead_in = lead(&end(0, 0, 1.0), &peaks, grid);
    // The ramp out is a ramp in, reversed in time.
    let lead_out = lead(&end(count, last, -1.0), &peaks, grid);
    let lead_out = lead_out.into_iter().rev().map(|[y, v]| [y, -v]).collect();
    Ok(Recorded {
        motion: Motion::new(grid, lead_in, core, lead_out),
        left_out: scale.abs() * (left_out / samples.len() as f64).sqrt(),
    })
}

/// From rest at 0 to `end`, which is not part of it: the quintic that meets position, velocity and acceleration at both ends.
fn lead(end: &Place, peaks: &Place, grid: Grid) -> Vec<[f64; 2]> {
    let mut gentlest: Option<(f64, Vec<[f64; 2]>)> = None;
    for time in RAMPS {
        let count = (time / grid.step()).ceil() as usize;
        let time = count as f64 * grid.step();
        // y = s³·(a + b·s + c·s²), s the part of the time.
        let (y, v) = (end.displacement, end.velocity * time);
        let curved = end.acceleration * time * time;
        let a = 10.0 * y - 4.0 * v + 0.5 * curved;
        let b = -15.0 * y + 7.0 * v - curved;
        let c = 6.0 * y - 3.0 * v + 0.5 * curved;
        let mut excess = 0.0_f64;
        let knots = (0..count).map(|knot| {
            let s = knot as f64 / count as f64;
            let place = Place {
                displacement: s * s * s * (a + s * (b + s * c)),
                velocity: s * s * (3.0 * a + s * (4.0 * b + s * 5.0 * c)) / time,
                acceleration: s * (6.0 * a + s * (12.0 * b + s * 20.0 * c)) / (time * time),
            };
            for (value, peak) in [
                (place.displacement, peaks.displacement),
                (place.velocity, peaks.velocity),
                (place.acceleration, peaks.acceleration),
            ] {
                excess = excess.max(value.abs() / peak.max(f64::MIN_POSITIVE));
            }
            [place.displacement, place.velocity]
        });
        let knots: Vec<[f64; 2]> = knots.collect();
        if gentlest.as_ref().is_none_or(|(least, _)| excess < *least) {
            gentlest = Some((excess, knots));
        }
        if excess <= 1.0 {
            break;
        }
    }
    gentlest.map_or_else(Vec::new, |(_, knots)| knots)
}
