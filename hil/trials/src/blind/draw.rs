//! Trials by seed.

use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_rig::specimen::{HiddenEffect, Unlisted};
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::absorbed::left_by_eq13;
use super::described::DescribedEffect;
use super::families::{
    FIRST_WITH_CONTROL, LATER, LISTED, UNLISTED, Unsized, effect, idle, largest_amplitude,
    log_uniform, schedule,
};
use super::programme::{self, Programme, TestShape};
use super::test_rig::{Sensors, Truth, answer, record};

/// Seeds of a group, in which each class has a fixed share.
pub const GROUP: u64 = 50;
/// In a group: nothing hidden, one listed effect, two of them; the rest is unlisted.
const NONE: usize = 10;
const SINGLE: usize = LISTED;
const PAIRS: usize = 9;

/// Residual of eq 13 for a single effect, over the force's noise.
const SIZES: (f64, f64) = (1.0, 50.0);
/// The same for each effect of a pair.
const SIZES_IN_PAIR: (f64, f64) = (3.0, 50.0);
/// RMS of an effect's force over that of eq 13, at most.
const LARGEST_SHARE: f64 = 0.6;
/// The size may differ from the drawn one by this factor.
const MISS: f64 = 1.15;
/// Attempts at a size before another is drawn.
const SIZINGS: usize = 8;
/// Rate at which sizes are computed, Hz.
const SIZING_RATE: f64 = 500.0;
/// Lowest rate at which the specimen is computed, Hz.
const TRUTH_RATE: f64 = 4000.0;

/// The correct answer of the tracer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Nothing is hidden.
    None,
    /// One listed effect.
    Listed,
    /// Two listed effects.
    Pair,
    /// One unlisted effect.
    Unlisted,
}

/// The hidden effect of a specimen.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Hidden {
    /// The hidden effect uses separate physics.
    Specimen(HiddenEffect),
    /// The hidden effect uses the crate's physics.
    Described(DescribedEffect),
}

impl Hidden {
    /// Its family, or the kind of an unlisted one.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Specimen(effect) => effect.family(),
            Self::Described(effect) => effect.family,
        }
    }

    /// Its parameters as (name, value, unit).
    pub fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        match self {
            Self::Specimen(effect) => effect.parameters(),
            Self::Described(effect) => effect.parameters(),
        }
    }
}

/// An effect and its size.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sized {
    /// The effect.
    pub effect: Hidden,
    /// RMS of the effect's force in the training test over the RMS of the noise.
    pub size: f64,
    /// RMS of the residual of eq 13, fitted separately at each amplitude, over the RMS of the noise.
    pub visible: f64,
}

/// The hidden truth of a trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Secret {
    /// The seed.
    pub seed: u64,
    /// The correct answer of the tracer.
    pub class: Class,
    /// Density, g/cm³.
    pub density: f64,
    /// The hidden effects.
    pub effects: Vec<Sized>,
    /// The tests.
    pub programme: Programme,
    /// Sampling rate, Hz.
    pub rate: f64,
    /// RMS of the force's noise over the RMS of the force.
    pub noise: f64,
    /// Whether the chamber warms although nothing depends on it.
    pub warms: bool,
    /// Whether a current is set although nothing depends on it.
    pub is_set: bool,
}

impl Secret {
    /// The families, or kinds of the unlisted.
    pub fn families(&self) -> Vec<&'static str> {
        self.effects.iter().map(|e| e.effect.family()).collect()
    }

    /// The visibility of the least visible effect; infinite if there is none.
    pub fn visible(&self) -> f64 {
        self.effects
            .iter()
            .fold(f64::INFINITY, |least, e| least.min(e.visible))
    }
}

/// Two recordings and their hidden truth.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The truth, which the tracer must not see.
    pub secret: Secret,
    /// To be fitted.
    pub training: Recording,
    /// To be predicted.
    pub held_out: Recording,
    /// RMS of the held-out force's noise over that of its force.
    pub held_out_noise: f64,
}

/// The trial of `seed`: the same for the same seed.
///
/// Of 50 seeds 50n…50n + 49, 10 hide nothing, 18 hide a listed effect, 9 hide two, and 13 an unlisted one, in an order drawn for
/// the 50. The density is between 2 and 4 g/cm³, the noise of the force 0.2–3 % of its RMS and most often 0.4 %, the rate mostly 1
/// kHz. An effect's size is drawn evenly over the logarithm of the part that eq 13 cannot absorb, 1–50 times the noise (3–50 in
/// pairs). If no specimen or no test could have that size, everything is drawn again.
pub fn draw(seed: u64) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (class, number) = class(seed);
    loop {
        if let Some((secret, effects)) = secret(seed, class, number, &mut rng) {
            return trial(secret, effects, &mut rng);
        }
    }
}

/// The trial with that number among those with an unlisted effect.
pub fn draw_unlisted(number: u64) -> Trial {
    let of_group = GROUP - (NONE + SINGLE + PAIRS) as u64;
    let group = number / of_group * GROUP;
    let mut seeds = (group..group + GROUP).filter(|&seed| class(seed).0 == Class::Unlisted);
    draw(seeds.nth((number % of_group) as usize).unwrap_or(group))
}

/// The class of `seed` and its number within the class.
fn class(seed: u64) -> (Class, usize) {
    let group = (seed / GROUP) as usize;
    let mut places: [usize; GROUP as usize] = std::array::from_fn(|i| i);
    places.shuffle(&mut ChaCha8Rng::seed_from_u64(seed / GROUP));
    let place = places[(seed % GROUP) as usize];
    let others = GROUP as usize - NONE - SINGLE - PAIRS;
    if place < NONE {
        (Class::None, group * NONE + place)
    } else if place < NONE + SINGLE {
        (Class::Listed, group * SINGLE + place - NONE)
    } else if place < NONE + SINGLE + PAIRS {
        (Class::Pair, group * PAIRS + place - NONE - SINGLE)
    } else {
        let place = place - NONE - SINGLE - PAIRS;
        (Class::Unlisted, group * others + place)
    }
}

/// A secret of its class and its effects, if the draw is possible.
fn secret(
    seed: u64,
    class: Class,
    number: usize,
    rng: &mut impl Rng,
) -> Option<(Secret, Vec<HiddenEffect>)> {
    let (shape, effects) = hidden(seed, class, number, rng)?;
    let programme = programme::draw(shape, rng);
    let largest = largest_amplitude(&programme.training);
    let mut secret = Secret {
        seed,
        class,
        density: rng.random_range(2.0..4.0),
        effects: Vec::new(),
        rate: *[1000.0, 1000.0, 1000.0, 500.0, 500.0, 2000.0].choose(rng)?,
        noise: if rng.random_bool(0.6) {
            0.004
        } else {
            log_uniform(0.002, 0.03, rng)
        },
        warms: rng.random_bool(0.1),
        is_set: seed >= FIRST_WITH_CONTROL && rng.random_bool(0.1),
        programme,
    };
    let mut drawn = Vec::new();
    let law = answer(
        secret.density,
        &[],
        &secret.programme.training,
        SIZING_RATE,
        SIZING_RATE,
    );
    let sizes = if class == Class::Pair {
        SIZES_IN_PAIR
    } else {
        SIZES
    };
    for which in effects {
        let example = effect(which, largest, rng);
        let wanted = log_uniform(sizes.0, sizes.1, rng);
        let (effect, sized) = size(&secret, &law, &example, wanted)?;
        drawn.push(effect);
        secret.effects.push(sized);
    }
    Some((secret, drawn))
}

/// The effects, and the shape of a test that shows all of them.
fn hidden(
    seed: u64,
    class: Class,
    number: usize,
    rng: &mut impl Rng,
) -> Option<(TestShape, Vec<usize>)> {
    const ALL: [TestShape; 4] = [
        TestShape::Amplitudes,
        TestShape::Frequencies,
        TestShape::Long,
        TestShape::Single,
    ];
    let later = LATER.iter().filter(|(_, first)| seed >= *first);
    let listed = LISTED + later.count();
    let of_listed = |which: usize| match which.checked_sub(LISTED) {
        None => which,
        Some(later) => LATER[later].0,
    };
    let effects = match class {
        Class::None => return Some((ALL[number % ALL.len()], Vec::new())),
        Class::Listed => vec![of_listed(number % listed)],
        Class::Pair => [0; 2]
            .map(|_| of_listed(rng.random_range(0..listed)))
            .to_vec(),
        Class::Unlisted => vec![LISTED + number % UNLISTED],
    };
    // Neither the shapes nor the family's name depend on draws within it.
    let examples: Vec<Unsized> = effects
        .iter()
        .map(|&which| effect(which, 1.0, rng))
        .collect();
    let mut shapes = examples[0].shapes.to_vec();
    if let [a, b] = examples[..] {
        if a.effect.family() == b.effect.family() {
            return None;
        }
        shapes.retain(|shape| b.shapes.contains(shape) && *shape != TestShape::Single);
    }
    Some((*shapes.choose(rng)?, effects))
}

/// The effect scaled until the residual of eq 13 is `wanted` times the noise; `None` if that needs more than the largest possible
/// size.
fn size(
    secret: &Secret,
    law: &Truth,
    drawn: &Unsized,
    wanted: f64,
) -> Option<(HiddenEffect, Sized)> {
    let law_rms = rms(&law.force);
    let noise = secret.noise * law_rms;
    let mut factor = drawn.factors.0.max(1e-3);
    for _ in 0..SIZINGS {
        let effect = drawn.effect.scaled(factor);
        let truth = answer(
            secret.density,
            &[effect],
            &secret.programme.training,
            SIZING_RATE,
            SIZING_RATE,
        );
        let beyond: Vec<f64> = (truth.force.iter().zip(&law.force))
            .map(|(force, law)| force - law)
            .collect();
        let added = rms(&beyond);
        let visible = left_by_eq13(&truth, &secret.programme.training) / noise;
        if visible > wanted / MISS && visible < wanted * MISS {
            let sized = Sized {
                effect: Hidden::Specimen(effect),
                size: added / noise,
                visible,
            };
            return (added <= LARGEST_SHARE * law_rms).then_some((effect, sized));
        }
        // Before the effect is visible, a step is larger than proportional.
        factor *= (wanted / visible.max(1e-3 * wanted)).clamp(1e-3, 1e3);
        if factor < drawn.factors.0 || factor > drawn.factors.1 {
            return None;
        }
    }
    None
}

/// Runs and records both tests.
fn trial(secret: Secret, mut effects: Vec<HiddenEffect>, rng: &mut impl Rng) -> Trial {
    let heated = effects
        .iter()
        .any(|effect| matches!(effect, HiddenEffect::Temperature { .. }));
    let warms = secret.warms && !heated;
    if warms {
        effects.push(HiddenEffect::Temperature {
            beta: 0.0,
            rise: rng.random_range(5.0..30.0),
            time: rng.random_range(5.0..30.0),
        });
    }
    let is_controlled = effects
        .iter()
        .any(|effect| effect.control_at(0.0).is_some());
    if secret.is_set && !is_controlled {
        effects.push(idle(schedule(rng)));
    }
    let (seed, density, rate) = (secret.seed, secret.density, secret.rate);
    let tests = Tests::of(&secret.programme, rate, |which, blocks| {
        if which == Which::HeldOut {
            for effect in &mut effects {
                // Another day, another random walk, and other currents.
                match effect {
                    HiddenEffect::Unlisted(Unlisted::RandomWalk { seed, .. }) => *seed ^= 1,
                    HiddenEffect::ControlInput { schedule, .. } => schedule.seed ^= 1,
                    _ => (),
                }
            }
        }
        let truth = answer(density, &effects, blocks, rate, TRUTH_RATE);
        let sensors = Sensors {
            force_noise: secret.noise * rms(&truth.force),
            thermometer: heated || warms,
            seed: rng.random(),
        };
        let name = format!("{} of seed {seed}", which.name());
        Some((record(name, &truth, &sensors), sensors.force_noise))
    });
    tests.expect("each is recorded").hiding(secret)
}

/// The test of a programme.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Which {
    /// The one to fit,
    Training,
    /// the one to predict,
    HeldOut,
    /// or the one to predict that begins with the fitted one.
    Whole,
}

impl Which {
    pub fn name(self) -> &'static str {
        match self {
            Self::Training => "training test",
            Self::HeldOut | Self::Whole => "held-out test",
        }
    }
}

/// Both tests of a programme, recorded.
pub(super) struct Tests {
    training: Recording,
    held_out: Recording,
    /// Noise over force of the scored recording.
    held_out_noise: f64,
}

impl Tests {
    /// `record` gives the recording of a test and the deviation of its force's noise in kN. `None` if `record` does.
    pub fn of(
        programme: &Programme,
        rate: f64,
        mut record: impl FnMut(Which, &[TestBlock]) -> Option<(Recording, f64)>,
    ) -> Option<Self> {
        let (training, held_out, noise, scored_from) = if programme.shape == TestShape::Long {
            let (whole, noise) = record(Which::Whole, &programme.held_out)?;
            let blocks = programme.training.iter();
            let seconds: f64 = blocks.map(|b| f64::from(b.cycles) / b.frequency).sum();
            let samples = (seconds * rate).round() as usize;
            let name = whole
                .name
                .replace(Which::Whole.name(), Which::Training.name());
            (beginning(&whole, name, samples), whole, noise, samples)
        } else {
            let (training, _) = record(Which::Training, &programme.training)?;
            let (held_out, noise) = record(Which::HeldOut, &programme.held_out)?;
            (training, held_out, noise, 0)
        };
        Some(Self {
            held_out_noise: noise / rms(&held_out.force[scored_from..]),
            training,
            held_out,
        })
    }

    /// As the trial that hides `secret`.
    pub fn hiding(self, secret: Secret) -> Trial {
        Trial {
            training: self.training,
            held_out: self.held_out,
            held_out_noise: self.held_out_noise,
            secret,
        }
    }
}

/// The first `samples` of a recording.
fn beginning(whole: &Recording, name: String, samples: usize) -> Recording {
    let cut = |channel: &[f64]| channel[..samples].to_vec();
    let recording = Recording::new(
        name,
        cut(&whole.time),
        cut(&whole.displacement),
        cut(&whole.force),
    );
    let recording = match &whole.temperature {
        Some(temperature) => recording.and_then(|r| r.with_temperature(cut(temperature))),
        None => recording,
    };
    let recording = whole.controls.iter().fold(recording, |recording, control| {
        recording.and_then(|r| r.with_control(control.name.clone(), cut(&control.values)))
    });
    recording.expect("the beginning of a recording is one")
}

/// Root of the mean square.
pub(super) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}
