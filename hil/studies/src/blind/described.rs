//! Trials over the crate's own descriptions of effects: each effect that the crate has is hidden, with parameters about typical.
//!
//! The truth is the crate's law in f64, so these trials say whether a trace finds what the crate has, and not whether the crate's
//! physics are right: that the other draw asks, whose specimens share no code with the crate. An effect that is added to the
//! crate is drawn here without a line more.

use mesh_damper::effects::description::{Dependence, Description};
use mesh_damper::effects::{AugmentedLaw, DESCRIPTIONS, Effect, Motion};
use mesh_damper::law::Law;
use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::HiddenEffect;
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::absorbed::left_by_eq13;
use super::draw::{Class, Hidden, Secret, Sized, Trial, rms};
use super::families::log_uniform;
use super::programme::{self, TestShape};
use super::test_rig::{Sensors, Truth, answer, record};

/// Ticks a second of the law that stands for the specimen.
const TICK_RATE: f64 = 4000.0;
/// A parameter is within this factor of the typical one,
const VARIED: f64 = 1.4;
/// and with every draw that no test shows within this factor more: what is typical of a damper may be too little in this one.
const WIDER: f64 = 1.1;
/// What eq 13 leaves of the effect, over the force's noise: as clear as it can be without being all that is there.
const VISIBLE: (f64, f64) = (5.0, 300.0);
/// What is drawn before an effect is given up: with parameters about its typical ones no test shows it.
const DRAWS: i32 = 60;

/// An effect of the crate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedEffect {
    /// Its family.
    pub family: &'static str,
    /// Its own name.
    pub name: &'static str,
    /// Its parameters in the order of its description, element by element.
    pub parameters: Vec<f64>,
    #[serde(skip)]
    number: u8,
}

impl DescribedEffect {
    fn drawn(of: &Description, within: f64, rng: &mut impl Rng) -> Self {
        let parameters = of.typical.iter().zip(of.parameters.iter().cycle());
        let varied = parameters.map(|(typical, parameter)| {
            let [low, high] = parameter.range;
            (typical * log_uniform(1.0 / within, within, rng)).clamp(low, high)
        });
        Self {
            family: of.family,
            name: of.name,
            parameters: varied.collect(),
            number: of.number,
        }
    }

    /// Its parameters as (name, value, unit).
    pub fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        let description = DESCRIPTIONS.iter().find(|each| each.number == self.number);
        let named = description.map_or(&[][..], |each| each.parameters);
        let values = self.parameters.iter().zip(named.iter().cycle());
        values
            .map(|(value, parameter)| (parameter.name, *value, parameter.unit))
            .collect()
    }
}

/// How many effects are drawn in turn: seed n hides number n modulo these.
pub fn described() -> u64 {
    DESCRIPTIONS.len() as u64
}

/// The trial of `seed` over the descriptions: the same for the same seed. `None` where no test shows the effect.
pub fn draw_described(seed: u64) -> Option<Trial> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let description = &DESCRIPTIONS[(seed % described()) as usize];
    (0..DRAWS).find_map(|lost| drawn(seed, description, VARIED * WIDER.powi(lost), &mut rng))
}

/// A test in which such an effect differs from a law with other coefficients.
fn shape_for(description: &Description, rng: &mut impl Rng) -> TestShape {
    let depends_on = |on| description.depends_on.contains(&on);
    let shapes: &[TestShape] =
        if depends_on(Dependence::Cycle) || depends_on(Dependence::Temperature) {
            &[TestShape::Long]
        } else if depends_on(Dependence::Frequency) || depends_on(Dependence::Velocity) {
            &[TestShape::Frequencies]
        } else if depends_on(Dependence::History) {
            &[TestShape::Frequencies, TestShape::Amplitudes]
        } else {
            &[TestShape::Amplitudes]
        };
    *shapes.choose(rng).expect("there is a shape")
}

fn drawn(seed: u64, description: &Description, within: f64, rng: &mut impl Rng) -> Option<Trial> {
    let programme = programme::draw(shape_for(description, rng), rng);
    let density = rng.random_range(2.0..4.0);
    let rate = *[1000.0, 500.0, 2000.0].choose(rng)?;
    let noise = log_uniform(0.002, 0.01, rng);
    let effect = DescribedEffect::drawn(description, within, rng);
    // Whether the force depends on it or not, so that the thermometer gives nothing away.
    let chamber = HiddenEffect::Temperature {
        beta: 0.0,
        rise: rng.random_range(5.0..30.0),
        time: rng.random_range(5.0..30.0),
    };
    let run = |blocks: &[TestBlock]| {
        let motion = answer(density, &[chamber], blocks, TICK_RATE, TICK_RATE);
        let force = force_of(density, &effect, blocks, &motion)?;
        Some(every(&motion, &force, (TICK_RATE / rate) as usize))
    };
    let (training, held_out) = (run(&programme.training)?, run(&programme.held_out)?);
    let law = answer(density, &[], &programme.training, rate, rate);
    let force_noise = noise * rms(&law.force);
    let visible = left_by_eq13(&training, &programme.training) / force_noise;
    if !(VISIBLE.0..VISIBLE.1).contains(&visible) {
        return None;
    }
    let beyond: Vec<f64> = training
        .force
        .iter()
        .zip(&law.force)
        .map(|(a, b)| a - b)
        .collect();
    let mut recorded = |what: &str, truth: &Truth| {
        let sensors = Sensors {
            force_noise,
            thermometer: true,
            seed: rng.random(),
        };
        record(format!("{what} of described seed {seed}"), truth, &sensors)
    };
    let training = recorded("training test", &training);
    let scored_from = if programme.shape == TestShape::Long {
        training.len()
    } else {
        0
    };
    let held_out_force = rms(&held_out.force[scored_from..]);
    Some(Trial {
        training,
        held_out: recorded("held-out test", &held_out),
        held_out_noise: force_noise / held_out_force,
        secret: Secret {
            seed,
            class: Class::Listed,
            density,
            effects: vec![Sized {
                size: rms(&beyond) / force_noise,
                visible,
                effect: Hidden::Described(effect),
            }],
            programme,
            rate,
            noise,
            warms: true,
        },
    })
}

/// What the crate's law with the effect gives for a motion at [`TICK_RATE`], kN; `None` where it refuses the parameters.
fn force_of(
    density: f64,
    effect: &DescribedEffect,
    blocks: &[TestBlock],
    truth: &Truth,
) -> Option<Vec<f64>> {
    let law = |block: &TestBlock| {
        let at = tables::interpolate(density, block.amplitude);
        Law::new(at.k1, at.k3, at.c, at.alpha).ok()
    };
    let effect = Effect::from_parameters(effect.number, &effect.parameters, 1.0 / TICK_RATE);
    let mut augmented = AugmentedLaw::<f64, 1>::new(law(&blocks[0])?)
        .with(effect.ok()?)
        .ok()?;
    let mut state = augmented.at_rest();
    let (mut block, mut cycles) = (0, 0.0);
    let each = truth
        .motion
        .iter()
        .zip(&truth.temperature)
        .zip(&truth.block);
    each.map(|((motion, temperature), now)| {
        if *now != block {
            block = *now;
            augmented.set_law(law(&blocks[block])?);
        }
        cycles += blocks[block].frequency / TICK_RATE;
        let motion = Motion {
            displacement: motion.displacement,
            velocity: motion.velocity,
            acceleration: motion.acceleration,
            cycles,
            temperature: *temperature,
            ..Motion::default()
        };
        Some(augmented.force(&mut state, &motion))
    })
    .collect()
}

/// One sample of `step`.
fn every(truth: &Truth, force: &[f64], step: usize) -> Truth {
    fn of<T: Clone>(values: &[T], step: usize) -> Vec<T> {
        values.iter().step_by(step).cloned().collect()
    }
    Truth {
        motion: of(&truth.motion, step),
        force: of(force, step),
        temperature: of(&truth.temperature, step),
        block: of(&truth.block, step),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_description_is_drawn_as_asked_and_the_same_again() {
        for seed in 0..described() {
            let trial = draw_described(seed);
            let name = DESCRIPTIONS[seed as usize].name;
            let trial = trial.unwrap_or_else(|| panic!("{name}: no test shows it"));
            let hidden = &trial.secret.effects[0];
            assert_eq!(hidden.effect.family(), DESCRIPTIONS[seed as usize].family);
            assert!(
                hidden.visible >= VISIBLE.0 && hidden.visible <= VISIBLE.1,
                "{name}"
            );
            assert_ne!(trial.training.force, trial.held_out.force);
            // Of the first: each is drawn in the same way.
            if seed == 0 {
                let again = draw_described(seed).unwrap();
                assert_eq!(trial.secret, again.secret);
                assert_eq!(trial.training.force, again.training.force);
            }
        }
    }
}
