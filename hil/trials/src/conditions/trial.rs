//! A trial: a device, its recordings under some conditions, and those under others.

use std::f64::consts::TAU;

use mesh_damper_recording::Recording;
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::device::{Device, Family, Scale};
use super::programme::{Condition, Kind, Programme};
use super::sensors::{Sensors, Truth};
use super::waves::Motion;
use crate::blind::log_uniform;

/// The hidden truth of a trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Secret {
    /// The seed.
    pub seed: u64,
    /// The kind of device.
    pub family: Family,
    /// Its parts with their parameters, without dimensions.
    pub device: String,
    /// Unit of its stiffness, kN/mm.
    pub stiffness: f64,
    /// Name of the control input, if it is recorded.
    pub control: Option<&'static str>,
    /// Control input at level 1, in the unit of its name.
    pub control_scale: f64,
    /// The conditions.
    pub programme: Programme,
    /// The sensors.
    pub sensors: Sensors,
}

/// Recordings of a device and their hidden truth.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The truth, which the tracer must not see.
    pub secret: Secret,
    /// To be fitted, one for each condition of [`Programme::training`].
    pub training: Vec<Recording>,
    /// To be predicted, one for each condition of [`Programme::held_out`].
    pub held_out: Vec<Recording>,
}

/// Parts of the trials by [`Kind`], in its order. Fewer devices have a control input, and fewer laboratories drive ramps.
const KINDS: [(Kind, f64); 4] = [
    (Kind::Amplitude, 0.35),
    (Kind::Frequency, 0.3),
    (Kind::Speed, 0.15),
    (Kind::Level, 0.2),
];
/// Part of the devices with nothing beyond the law, and with two things.
const PART_PLAIN: f64 = 0.1;
const PART_PAIRS: f64 = 0.15;
/// Range of stiffness, kN/mm: from an instrument's foot to a building's brace.
const STIFFNESSES: (f64, f64) = (0.001, 100.0);

/// The trial of `seed`: the same for the same seed.
pub fn trial(seed: u64) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    loop {
        if let Some(trial) = drawn(seed, &mut rng) {
            return trial;
        }
    }
}

/// `None` if a condition does not move its sensor.
fn drawn(seed: u64, rng: &mut ChaCha8Rng) -> Option<Trial> {
    let kind = KINDS.choose_weighted(rng, |(_, part)| *part).ok()?.0;
    let family = family(kind, rng)?;
    let programme = Programme::draw(kind, rng);
    let (control, largest) = family.control();
    let scale = scale(&programme, largest, rng);
    let device = family.device(scale, rng);
    // A control input that is not varied may be recorded or not.
    let is_recorded =
        kind == Kind::Level || Family::CONTROLLED.contains(&family) && rng.random_bool(0.5);
    let respond = |condition: &Condition, rng: &mut ChaCha8Rng| {
        let control = condition.level * scale.control;
        let motion = Motion::of(condition, programme.wave, programme.is_under_way, rng);
        respond(device.clone(), &motion, control)
    };
    let truths: Vec<Truth> = programme
        .all()
        .map(|condition| respond(condition, rng))
        .collect();
    let sensors = Sensors::draw(&programme, &truths, rng);
    let conditions: Vec<Condition> = programme.all().copied().collect();
    let mut recordings = Vec::new();
    for (index, (truth, condition)) in truths.into_iter().zip(&conditions).enumerate() {
        let name = match index.checked_sub(programme.training.len()) {
            None => format!("training {} of seed {seed}", index + 1),
            Some(index) => format!("held-out {} of seed {seed}", index + 1),
        };
        let recording = sensors.record(name, truth, rng)?;
        recordings.push(if is_recorded {
            let level = condition.level * scale.control;
            let levels = vec![level; recording.len()];
            recording.with_control(control, levels).ok()?
        } else {
            recording
        });
    }
    let held_out = recordings.split_off(programme.training.len());
    Some(Trial {
        secret: Secret {
            seed,
            family,
            device: device.in_words(),
            stiffness: scale.stiffness,
            control: is_recorded.then_some(control),
            control_scale: scale.control,
            programme,
            sensors,
        },
        training: recordings,
        held_out,
    })
}

/// A kind of device that has conditions of this kind. One with nothing beyond the law may have a control input that does nothing.
fn family(kind: Kind, rng: &mut impl Rng) -> Option<Family> {
    let among: &[Family] = if rng.random_bool(PART_PLAIN) {
        &Family::PLAIN
    } else if kind == Kind::Level {
        &Family::CONTROLLED
    } else if rng.random_bool(PART_PAIRS) {
        &[Family::Pair]
    } else {
        Family::beyond()
    };
    among.choose(rng).copied()
}

fn scale(programme: &Programme, largest: [f64; 2], rng: &mut impl Rng) -> Scale {
    let length = programme
        .all()
        .fold(0.0, |most: f64, c| most.max(c.amplitude));
    let logs: Vec<f64> = programme.all().map(|c| c.frequency.ln()).collect();
    let middle = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
    Scale {
        length,
        angular_frequency: TAU * middle,
        stiffness: log_uniform(STIFFNESSES.0, STIFFNESSES.1, rng),
        control: log_uniform(largest[0], largest[1], rng),
    }
}

/// The channels of a device that starts unloaded. The recording's time starts at 0.
fn respond(mut device: Device, motion: &Motion, control: f64) -> Truth {
    let mut truth = Truth {
        time: Vec::new(),
        displacement: Vec::new(),
        force: Vec::new(),
    };
    let dt = motion.steps[1].time - motion.steps[0].time;
    for (index, step) in motion.steps.iter().enumerate() {
        let force = device.force(
            dt,
            step.displacement,
            step.velocity,
            step.acceleration,
            control,
        );
        if index >= motion.first && (index - motion.first).is_multiple_of(motion.stride) {
            truth.time.push(step.time - motion.steps[motion.first].time);
            truth.displacement.push(step.displacement);
            truth.force.push(force);
        }
    }
    truth
}
