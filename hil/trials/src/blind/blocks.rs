//! Trials with blocks of sines, by seed.

use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_rig::specimen::{HiddenEffect, Unlisted};
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::absorbed::left_by_eq13;
use super::families::{Unsized, Version, idle, largest_amplitude, log_uniform, schedule, unlisted};
use super::programme::{self, Programme, TestShape};
use super::test_rig::{Sensors, Truth, answer, record};
use super::trial::{Blocks, Class, Hidden, Secret, Sized, Test, Trial};

/// Seeds of a group, in which each class has a fixed share.
pub const GROUP: u64 = 50;
/// In a group: nothing hidden, one listed effect, two of them; the rest is unlisted.
const NONE: usize = 10;
const SINGLE: usize = 18;
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

/// The trial of `seed`: the same for the same seed.
///
/// Of 50 seeds 50n…50n + 49, 10 hide nothing, 18 hide a listed effect, 9 hide two, and 13 an unlisted one, in an order drawn for
/// the 50. The density is between 2 and 4 g/cm³, the noise of the force 0.2–3 % of its RMS and most often 0.4 %, the rate mostly 1
/// kHz. An effect's size is drawn evenly over the logarithm of the part that eq 13 cannot absorb, 1–50 times the noise (3–50 in
/// pairs). If no specimen or no test could have that size, everything is drawn again.
pub(super) fn draw(version: Version, seed: u64) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    loop {
        if let Some(trial) = drawn(version, seed, &mut rng) {
            return trial;
        }
    }
}

/// The trial with that number among those with an unlisted effect.
pub(super) fn draw_unlisted(version: Version, number: u64) -> Trial {
    let of_group = GROUP - (NONE + SINGLE + PAIRS) as u64;
    let group = number / of_group * GROUP;
    let mut seeds = (group..group + GROUP).filter(|&seed| class(seed).0 == Class::Unlisted);
    draw(
        version,
        seeds.nth((number % of_group) as usize).unwrap_or(group),
    )
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

/// The trial, if the draw is possible.
fn drawn(version: Version, seed: u64, rng: &mut ChaCha8Rng) -> Option<Trial> {
    let (class, number) = class(seed);
    let (shape, effects) = hidden(version, class, number, rng)?;
    let programme = programme::draw(shape, rng);
    let largest = largest_amplitude(&programme.training);
    let density = rng.random_range(2.0..4.0);
    let rate = *[1000.0, 1000.0, 1000.0, 500.0, 500.0, 2000.0].choose(rng)?;
    let test = Blocks {
        noise: if rng.random_bool(0.6) {
            0.004
        } else {
            log_uniform(0.002, 0.03, rng)
        },
        warms: rng.random_bool(0.1),
        is_set: version.has_control_input() && rng.random_bool(0.1),
        programme,
    };
    let training = &test.programme.training;
    let respond =
        |effects: &[HiddenEffect]| answer(density, effects, training, SIZING_RATE, SIZING_RATE);
    let law = respond(&[]);
    let sizes = if class == Class::Pair {
        SIZES_IN_PAIR
    } else {
        SIZES
    };
    let (mut drawn, mut sized) = (Vec::new(), Vec::new());
    for which in effects {
        let example = example(version, class, which, largest, rng)?;
        let wanted = log_uniform(sizes.0, sizes.1, rng);
        let noise = test.noise * rms(&law.force);
        let (effect, size) = size(&example, &law, noise, wanted, |effect| {
            let truth = respond(&[effect]);
            let left = left_by_eq13(&truth, training);
            (truth, left)
        })?;
        drawn.push(effect);
        sized.push(size);
    }
    let tests = recorded((seed, density, rate), &test, drawn, rng)?;
    Some(tests.hiding(Secret {
        seed,
        class,
        density,
        effects: sized,
        rate,
        test: Test::Blocks(test),
    }))
}

/// Effect number `which` of its class.
fn example(
    version: Version,
    class: Class,
    which: usize,
    largest: f64,
    rng: &mut ChaCha8Rng,
) -> Option<Unsized> {
    match class {
        Class::Unlisted => Some(unlisted(which, largest, rng)),
        Class::None | Class::Listed | Class::Pair => version.effect(which, largest, rng),
    }
}

/// The effects, and the shape of a test that shows all of them.
fn hidden(
    version: Version,
    class: Class,
    number: usize,
    rng: &mut ChaCha8Rng,
) -> Option<(TestShape, Vec<usize>)> {
    const ALL: [TestShape; 4] = [
        TestShape::Amplitudes,
        TestShape::Frequencies,
        TestShape::Long,
        TestShape::Single,
    ];
    let effects = match class {
        Class::None => return Some((ALL[number % ALL.len()], Vec::new())),
        Class::Listed => vec![number % version.listed()],
        Class::Pair => [0; 2].map(|_| rng.random_range(0..version.listed())).into(),
        Class::Unlisted => vec![number],
    };
    // Neither the shapes nor the family's name depend on draws within it.
    let examples = effects
        .iter()
        .map(|&which| example(version, class, which, 1.0, rng));
    let examples: Vec<Unsized> = examples.collect::<Option<_>>()?;
    let mut shapes = examples[0].shapes.to_vec();
    if let [a, b] = examples[..] {
        if a.effect.family() == b.effect.family() {
            return None;
        }
        shapes.retain(|shape| b.shapes.contains(shape) && *shape != TestShape::Single);
    }
    Some((*shapes.choose(rng)?, effects))
}

/// The effect scaled until the residual of eq 13, which `respond` gives with the answer of the specimen, is `wanted` times the
/// `noise` in kN; `None` if that needs more than the largest possible size.
fn size(
    drawn: &Unsized,
    law: &Truth,
    noise: f64,
    wanted: f64,
    respond: impl Fn(HiddenEffect) -> (Truth, f64),
) -> Option<(HiddenEffect, Sized)> {
    let mut factor = drawn.factors.0.max(1e-3);
    for _ in 0..SIZINGS {
        let effect = drawn.effect.scaled(factor);
        let (truth, left) = respond(effect);
        let beyond: Vec<f64> = (truth.force.iter().zip(&law.force))
            .map(|(force, law)| force - law)
            .collect();
        let added = rms(&beyond);
        let visible = left / noise;
        if visible > wanted / MISS && visible < wanted * MISS {
            let sized = Sized {
                effect: Hidden::Specimen(effect),
                size: added / noise,
                visible,
            };
            return (added <= LARGEST_SHARE * rms(&law.force)).then_some((effect, sized));
        }
        // Before the effect is visible, a step is larger than proportional.
        factor *= (wanted / visible.max(1e-3 * wanted)).clamp(1e-3, 1e3);
        if factor < drawn.factors.0 || factor > drawn.factors.1 {
            return None;
        }
    }
    None
}

/// Runs and records both tests of the specimen that `seed` draws, with this density and sampling rate.
fn recorded(
    (seed, density, rate): (u64, f64, f64),
    test: &Blocks,
    mut effects: Vec<HiddenEffect>,
    rng: &mut impl Rng,
) -> Option<Tests> {
    let heated = effects
        .iter()
        .any(|effect| matches!(effect, HiddenEffect::Temperature { .. }));
    let warms = test.warms && !heated;
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
    if test.is_set && !is_controlled {
        effects.push(idle(schedule(rng)));
    }
    Tests::of(&test.programme, rate, |which, blocks| {
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
            force_noise: test.noise * rms(&truth.force),
            thermometer: heated || warms,
            seed: rng.random(),
        };
        let name = format!("{} of seed {seed}", which.name());
        Some((record(name, &truth, &sensors), sensors.force_noise))
    })
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
            motion: Vec::new(),
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
pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}
