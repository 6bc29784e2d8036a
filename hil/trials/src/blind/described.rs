//! Trials over the crate's own descriptions of effects: each effect of the crate is hidden in turn, with roughly typical
//! parameters.
//!
//! The truth is the crate's law in f64. So these trials test whether a trace finds the crate's effects, and not whether the crate's
//! physics are correct: the other draw tests that, with specimens that share no code with the crate. An effect that is added to the
//! crate is drawn here without further code.

use mesh_damper::effects::description::{Dependence, Description};
use mesh_damper::effects::{AugmentedLaw, CONTROLS, DESCRIPTIONS, Effect, Motion};
use mesh_damper::law::Law;
use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::HiddenEffect;
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::absorbed::left_by_eq13;
use super::blocks::{Tests, rms};
use super::families::{idle, log_uniform, schedule};
use super::programme::{self, TestShape};
use super::test_rig::{Sensors, Truth, answer, record};
use super::trial::{Blocks, Class, Hidden, Secret, Sized, Test, Trial};

/// Ticks per second of the law that represents the specimen.
const TICK_RATE: f64 = 4000.0;
/// A parameter is within this factor of its typical value.
const VARIED: f64 = 1.4;
/// With every draw that a test does not show, or shows too clearly, the factor grows by this one: up to four in the end.
const WIDER: f64 = 1.02;
/// Residual of eq 13 for the effect, over the force's noise: clear, but not larger than everything else.
const VISIBLE: (f64, f64) = (5.0, 300.0);
/// Draws before an effect is given up because no test shows it.
const DRAWS: i32 = 50;

/// An effect of the crate, drawn from the crate's description of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DescribedEffect {
    /// The family of the effect.
    pub family: &'static str,
    /// The name of the effect.
    pub name: &'static str,
    /// The parameters in the order of the effect's description, element by element.
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

/// The number of effects that are drawn in turn, round after round: seed n hides number n modulo this.
pub fn described() -> u64 {
    DESCRIPTIONS.len() as u64
}

/// Numbers of the effects that were drawn first, in their order then.
#[rustfmt::skip]
const FIRST: [u8; 24] = [0, 1, 2, 3, 4, 15, 20, 6, 5, 7, 8, 9, 11, 16, 18, 19, 21, 22, 23, 12, 14, 17, 10, 13];

/// What is drawn for an effect in a round, whatever other effects there are, so that a figure stays when one is added.
fn dice(number: u8, round: u64) -> ChaCha8Rng {
    let place = FIRST.iter().position(|first| *first == number);
    ChaCha8Rng::seed_from_u64(match place {
        Some(place) => FIRST.len() as u64 * round + place as u64,
        None => (u64::from(number) << 32) + round,
    })
}

/// The trial of `seed` over the descriptions: the same for the same seed. `None` where no test shows the effect.
pub(super) fn draw_described(seed: u64) -> Option<Trial> {
    let description = &DESCRIPTIONS[(seed % described()) as usize];
    let mut rng = dice(description.number, seed / described());
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
    // Whether the force depends on it or not, so that the thermometer reveals nothing.
    let chamber = HiddenEffect::Temperature {
        beta: 0.0,
        rise: rng.random_range(5.0..30.0),
        time: rng.random_range(5.0..30.0),
    };
    // Nor does a current.
    let current = idle(schedule(rng));
    let answered = |blocks: &[TestBlock]| {
        let motion = answer(density, &[chamber, current], blocks, TICK_RATE, TICK_RATE);
        let force = force_of(density, &effect, blocks, &motion)?;
        Some(every(&motion, &force, (TICK_RATE / rate) as usize))
    };
    let training = answered(&programme.training)?;
    let law = answer(density, &[], &programme.training, rate, rate);
    let force_noise = noise * rms(&training.force);
    let visible = left_by_eq13(&training, &programme.training) / force_noise;
    if !(VISIBLE.0..VISIBLE.1).contains(&visible) {
        return None;
    }
    let added = training.force.iter().zip(&law.force);
    let added: Vec<f64> = added.map(|(whole, law)| whole - law).collect();
    let tests = Tests::of(&programme, rate, |which, blocks| {
        let truth = answered(blocks)?;
        let sensors = Sensors {
            force_noise: noise * rms(&truth.force),
            thermometer: true,
            seed: rng.random(),
        };
        let name = format!("{} of described seed {seed}", which.name());
        Some((record(name, &truth, &sensors), sensors.force_noise))
    })?;
    let hidden = Sized {
        size: rms(&added) / force_noise,
        visible,
        effect: Hidden::Described(effect),
    };
    Some(tests.hiding(Secret {
        seed,
        class: Class::Listed,
        density,
        effects: vec![hidden],
        rate,
        test: Test::Blocks(Blocks {
            programme,
            noise,
            warms: true,
            is_set: true,
        }),
    }))
}

/// The force of the crate's law with the effect for a motion at [`TICK_RATE`], kN; `None` if it refuses the parameters.
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
    let each = truth.motion.iter().enumerate();
    each.map(|(index, motion)| {
        let now = &truth.block[index];
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
            temperature: truth.temperature[index],
            controls: [truth.control.get(index).copied().unwrap_or_default(); CONTROLS],
        };
        Some(augmented.force(&mut state, &motion))
    })
    .collect()
}

/// One sample of every `step`.
fn every(truth: &Truth, force: &[f64], step: usize) -> Truth {
    fn of<T: Clone>(values: &[T], step: usize) -> Vec<T> {
        values.iter().step_by(step).cloned().collect()
    }
    Truth {
        motion: of(&truth.motion, step),
        force: of(force, step),
        temperature: of(&truth.temperature, step),
        control: of(&truth.control, step),
        block: of(&truth.block, step),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within four times the typical values, and visible in both tests, which differ.
    #[test]
    #[ignore = "half a minute: in the full tier"]
    fn every_description_is_shown_by_a_test() {
        for (seed, description) in (0..).zip(DESCRIPTIONS) {
            let name = description.name;
            let trial = draw_described(seed).unwrap_or_else(|| panic!("{name}: no test shows it"));
            let [hidden] = &trial.secret.effects[..] else {
                panic!("{name}: one effect is hidden")
            };
            let Hidden::Described(effect) = &hidden.effect else {
                panic!("{name}: it is the crate's")
            };
            assert_eq!(effect.name, name);
            let drawn = effect.parameters.iter().zip(description.typical);
            for (drawn, typical) in drawn.filter(|(_, typical)| **typical != 0.0) {
                assert!((0.25..4.0).contains(&(drawn / typical)), "{name}: {drawn}");
            }
            let Test::Blocks(Blocks { programme, .. }) = &trial.secret.test else {
                panic!("{name}: a test has blocks")
            };
            assert_ne!(programme.training, programme.held_out, "{name}");
        }
    }

    /// The published figures are those of these draws: seed n of the first effects, and another of each later one.
    #[test]
    fn an_effect_is_drawn_the_same_whatever_is_added() {
        let drawn = |number, round| dice(number, round).random::<u64>();
        let first: Vec<u64> = (0..4)
            .flat_map(|round| FIRST.map(|number| drawn(number, round)))
            .collect();
        let seeds = (0..96).map(|seed| ChaCha8Rng::seed_from_u64(seed).random());
        assert_eq!(first, seeds.collect::<Vec<u64>>());
        let later = [drawn(24, 0), drawn(24, 1), drawn(25, 0)];
        assert!(later.iter().all(|each| !first.contains(each)));
        assert!(later[0] != later[1] && later[1] != later[2] && later[0] != later[2]);
    }

    #[test]
    #[ignore = "half a minute: in the full tier"]
    fn a_trial_is_the_same_again() {
        let [one, again] = [(); 2].map(|()| draw_described(2).unwrap());
        assert_eq!(one.secret, again.secret);
        assert_eq!(one.training.force, again.training.force);
    }

    /// Hardening by k5·y⁵ in addition to the law of the block.
    #[test]
    fn the_force_is_the_laws_with_the_effect() {
        let description = DESCRIPTIONS.iter().find(|each| each.name == "hardening");
        let description = description.unwrap();
        let effect = DescribedEffect {
            family: description.family,
            name: description.name,
            parameters: vec![90.0],
            number: description.number,
        };
        let block = |amplitude| TestBlock::new(amplitude, 2.0, 2);
        let blocks = [block(0.1), block(0.2)];
        let motion = answer(3.0, &[], &blocks, TICK_RATE, TICK_RATE);
        let force = force_of(3.0, &effect, &blocks, &motion).unwrap();
        for (index, force) in force.iter().enumerate() {
            let expected = motion.force[index] + 90.0 * motion.motion[index].displacement.powi(5);
            assert!(
                (force - expected).abs() < 1e-9,
                "{index}: {force} {expected}"
            );
        }
    }
}
