//! Sensor readings of a true motion and force.

use std::f64::consts::TAU;

use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::MotionSample;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use super::families::log_uniform;

/// A deviation from laboratory sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Flaw {
    /// White noise on both channels, 16 bits.
    None,
    /// Force noise that is nearly zero.
    Quiet,
    /// Force noise with equal power in every octave.
    Pink,
    /// A resolution of 10 bits on both channels.
    Coarse,
    /// Ten times the displacement noise.
    Shaky,
    /// Mains hum on both channels.
    Hum,
    /// A velocity that is differentiated from the displacement.
    Differentiated,
}

impl Flaw {
    /// All flaws: half of the draws have none.
    pub const DRAWN: [Self; 12] = [
        Self::None,
        Self::None,
        Self::None,
        Self::None,
        Self::None,
        Self::None,
        Self::Quiet,
        Self::Pink,
        Self::Coarse,
        Self::Shaky,
        Self::Hum,
        Self::Differentiated,
    ];
}

/// The recording of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSensors {
    /// The deviation from laboratory sensors.
    pub flaw: Flaw,
    /// RMS of the force's noise, kN.
    pub force_noise: f64,
    /// RMS of the displacement's noise, mm.
    pub displacement_noise: f64,
}

impl MotionSensors {
    /// For a force of RMS `force` kN.
    pub fn draw(flaw: Flaw, force: f64, rng: &mut impl Rng) -> Self {
        let noise = match flaw {
            Flaw::Quiet => 0.001,
            _ => log_uniform(0.003, 0.015, rng),
        };
        let displacement_noise = 5e-5 * if flaw == Flaw::Shaky { 10.0 } else { 1.0 };
        Self {
            flaw,
            force_noise: noise * force,
            displacement_noise,
        }
    }

    /// The recording.
    pub fn record(
        &self,
        name: String,
        motion: &[MotionSample],
        force: &[f64],
        seed: u64,
    ) -> Recording {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let bits = if self.flaw == Flaw::Coarse { 10 } else { 16 };
        let steps = f64::from(1_u32 << bits);
        let time: Vec<f64> = motion.iter().map(|sample| sample.time).collect();
        let mains = rng.random_range(0.0..TAU);
        let hum = |time: f64, size: f64| match self.flaw {
            Flaw::Hum => size * (TAU * 50.0 * time + mains).sin(),
            _ => 0.0,
        };
        let moved = motion.iter().map(|sample| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            let clean = sample.displacement + hum(sample.time, 5.0 * self.displacement_noise);
            clean + self.displacement_noise * noise
        });
        let moved: Vec<f64> = moved.collect();
        let mut noise = white(force.len(), &mut rng);
        if self.flaw == Flaw::Pink {
            noise = pink(noise);
        }
        let pushed = force.iter().zip(&noise).zip(&time);
        let pushed: Vec<f64> = pushed
            .map(|((force, noise), time)| {
                force + self.force_noise * noise + hum(*time, 3.0 * self.force_noise)
            })
            .collect();
        let [moved, pushed] = [moved, pushed].map(|channel| stepped(channel, steps));
        let velocity = (self.flaw == Flaw::Differentiated).then(|| differentiated(&time, &moved));
        let recording = Recording::new(name, time, moved, pushed);
        let recording = match velocity {
            Some(velocity) => recording.and_then(|r| r.with_velocity(velocity)),
            None => recording,
        };
        recording.expect("a simulated test moves")
    }
}

fn white(count: usize, rng: &mut impl Rng) -> Vec<f64> {
    (0..count).map(|_| StandardNormal.sample(rng)).collect()
}

/// White noise through poles an octave apart (Kellet's filter), with the same deviation.
fn pink(white: Vec<f64>) -> Vec<f64> {
    const POLES: [(f64, f64); 3] = [
        (0.99765, 0.0990460),
        (0.96300, 0.2965164),
        (0.57000, 1.0526913),
    ];
    let mut states = [0.0; 3];
    let mut pink: Vec<f64> = white
        .into_iter()
        .map(|white| {
            for (state, (pole, gain)) in states.iter_mut().zip(POLES) {
                *state = pole * *state + gain * white;
            }
            states.iter().sum::<f64>() + 0.1848 * white
        })
        .collect();
    let deviation = (pink.iter().map(|x| x * x).sum::<f64>() / pink.len() as f64).sqrt();
    pink.iter_mut().for_each(|x| *x /= deviation);
    pink
}

/// Rounded to one of `steps` over a range somewhat larger than the channel.
fn stepped(channel: Vec<f64>, steps: f64) -> Vec<f64> {
    let largest = channel.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let step = 2.0 * (1.2 * largest).log2().ceil().exp2() / steps;
    channel
        .into_iter()
        .map(|x| (x / step).round() * step)
        .collect()
}

/// Central differences, as in a spreadsheet.
fn differentiated(time: &[f64], displacement: &[f64]) -> Vec<f64> {
    let last = time.len() - 1;
    (0..=last)
        .map(|index| {
            let (a, b) = (index.saturating_sub(1), (index + 1).min(last));
            (displacement[b] - displacement[a]) / (time[b] - time[a])
        })
        .collect()
}
