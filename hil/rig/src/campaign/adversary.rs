//! An adversary that draws combinations of attacks from a seed.

use mesh_damper::health::Channel::{Displacement, Force};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::FOLLOW;
use super::change::Change;
use super::facts::Begins;
use super::pairs::{FASTEST, headroom, one_of};
use super::trial::{BLOCKS, Close, Injected, NO_RUN_IN, RUN_IN, Set, Trial};

/// Most attacks in one trial.
const MOST: usize = 4;
/// g/cm³, mm.
const DENSITIES: [f64; 4] = [2.0, 2.5, 3.0, 4.0];
const AMPLITUDES: [f64; 4] = [0.05, 0.1, 0.2, 0.25];
/// Hz.
const FREQUENCIES: [f64; 2] = [5.0, FASTEST];
const NOISES: [f64; 3] = [0.002, 0.005, 0.01];
/// Cycles of a single block, and of each of several short ones.
const LONG: (u32, u32) = (24, 40);
const SHORT: (u32, u32) = (4, 12);
/// Ratio of the force channel's full scale to its limit.
const RANGE: (f64, f64) = (1.2, 3.0);
/// Probability that an attack is present from the start, probability that it ends again, and the cycles within which it does.
const FROM_START: f64 = 0.2;
const PASSES: f64 = 0.4;
const SHORTEST: f64 = 0.02;
const LONGEST: f64 = 10.0;
/// Probability that a kind is one of [`HARD`].
const HARD_ONES: f64 = 0.5;
/// Sizes are those of a kind, multiplied or divided by up to this factor.
const VARIED: f64 = 2.0;

/// Attacks that drive a quantity beyond its limit, and attacks that hide it.
const HARD: [Change; 14] = {
    use Change as A;
    [
        A::Stiffened,
        A::Seized,
        A::Preload,
        A::GainDrift(Displacement),
        A::GainStep(Displacement),
        A::GainStep(Force),
        A::DropOuts(Force),
        A::Open(Force),
        A::Frozen(Force),
        A::ZeroOneInTen(Displacement),
        A::ZeroOneInTen(Force),
        A::GoodOneInTen(Force),
        A::Ringing(Displacement),
        A::Ringing(Force),
    ]
};

/// One of the kind's sizes, made larger or smaller where possible.
fn drawn_size(kind: Change, random: &mut ChaCha8Rng) -> f64 {
    let size = one_of(random, kind.sizes());
    let by = VARIED.powf(random.random_range(-1.0..=1.0));
    match kind.facts().counted {
        // The number of a bit, of samples or of ticks is not scaled.
        Some((least, most)) => random.random_range(least..=most).into(),
        // A gain does not change its sign, and a specimen loses no more than its whole force.
        None => (size * by).max(-0.9),
    }
}

/// The adversary's trial with this number: 1 to 4 attacks of any kinds, some of which end again, on any specimen, with limits close
/// to its demands.
pub fn adversary(seed: u64) -> Trial {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let random = &mut random;
    let blocks: Vec<u32> = if random.random::<bool>() {
        vec![random.random_range(LONG.0..=LONG.1)]
    } else {
        let count = random.random_range(2..=BLOCKS);
        let mut cycles = || random.random_range(SHORT.0..=SHORT.1);
        (0..count).map(|_| cycles()).collect()
    };
    let cycles: u32 = blocks.iter().sum();
    let kinds = Change::attacks();
    let count = random.random_range(1..=MOST);
    let mut attack = || {
        let pool = if random.random::<f64>() < HARD_ONES {
            &HARD[..]
        } else {
            &kinds
        };
        let kind = one_of(random, pool);
        let at_start =
            kind.facts().begins == Begins::AtStart || random.random::<f64>() < FROM_START;
        let begins = random.random_range(-1.0..f64::from(cycles));
        let lasts = SHORTEST * (LONGEST / SHORTEST).powf(random.random());
        Injected {
            kind,
            size: drawn_size(kind, random),
            begins: if at_start { -2.0 } else { begins },
            lasts: (random.random::<f64>() < PASSES).then_some(lasts),
        }
    };
    let changes = (0..count).map(|_| attack()).collect();
    Trial {
        set: Set::Adversary,
        changes,
        density: one_of(random, &DENSITIES),
        amplitude: one_of(random, &AMPLITUDES),
        frequency: one_of(random, &FREQUENCIES),
        noise: one_of(random, &NOISES),
        follow: one_of(random, &[0.0, FOLLOW]),
        blocks,
        run_in: one_of(random, &[NO_RUN_IN, RUN_IN]),
        close: Some(Close {
            headroom: headroom(random),
            range: random.random_range(RANGE.0..RANGE.1),
        }),
        seed,
    }
}
