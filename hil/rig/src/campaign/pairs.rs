//! Two attacks in one trial.

use mesh_damper::health::Channel;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::change::Change;
use super::trial::{Close, FREQUENCY, Headroom, Place, Set, Trial};
use super::{Campaign, FOLLOW};

use Channel::{Displacement, Force};

/// Two attacks with their sizes, and the number of cycles by which the second is later: each hides the other, or makes it worse.
const SCENARIOS: [[(Change, f64, f64); 2]; 17] = {
    use Change as A;
    [
        // A limit that is hidden.
        [
            (A::Stiffened, 2.0, 0.0),
            (A::ZeroOneInTen(Force), 10.0, 0.0),
        ],
        [
            (A::Stiffened, 2.0, 0.0),
            (A::GoodOneInTen(Force), 10.0, 0.0),
        ],
        [(A::Stiffened, 2.0, 0.0), (A::Ringing(Force), 10.0, 0.0)],
        [
            (A::GainDrift(Displacement), -0.02, 0.0),
            (A::ZeroOneInTen(Displacement), 10.0, 0.0),
        ],
        // A channel that is lost, and then needed.
        [(A::Open(Force), 0.005, 0.0), (A::Stiffened, 4.0, 6.0)],
        [(A::Frozen(Force), 1.0, 0.0), (A::Stiffened, 4.0, 6.0)],
        [
            (A::NeverConnected(Force), 0.005, 0.0),
            (A::Seized, 20.0, 0.0),
        ],
        // A fault that latches before one that must be found.
        [(A::Spike(Displacement), 0.5, 0.0), (A::Break, 0.2, 4.0)],
        [(A::Spike(Force), 0.5, 0.0), (A::Break, 0.3, 4.0)],
        [
            (A::TemperatureNanAtCycleEnd, 1.0, 0.0),
            (A::Break, 0.2, 4.0),
        ],
        // A temperature that explains the fault away.
        [(A::TemperatureNan, 1.0, 0.0), (A::Break, 0.3, 4.0)],
        [(A::TemperatureOpen, 1372.0, 0.0), (A::Break, 0.2, 0.0)],
        [(A::TemperatureJump, 30.0, 0.0), (A::Break, 0.1, 0.0)],
        [(A::TemperatureNoise, 15.0, -8.0), (A::Break, 0.1, 0.0)],
        // Two at once.
        [(A::Break, 0.1, 0.0), (A::GainStep(Force), 0.11, 0.0)],
        [(A::Preload, 0.1, 0.0), (A::Wear, 0.2, 0.0)],
        [(A::EnableStuckHigh, 1.0, 0.0), (A::Stiffened, 4.0, 2.0)],
    ]
};

/// Ratio of the limits to the values of the healthy rig: smallest and largest.
pub(super) const CLOSE: (f64, f64) = (1.2, 2.0);
/// Highest frequency in Hz for limits this close: at 10 Hz the first cycles, before amplitude and phase are corrected, exceed the
/// force of the others by 17 %.
pub(super) const FASTEST: f64 = 8.0;

/// Drawn from [`CLOSE`].
pub(super) fn headroom(random: &mut ChaCha8Rng) -> Headroom {
    let mut draw = || random.random_range(CLOSE.0..=CLOSE.1);
    Headroom {
        displacement: draw(),
        force: draw(),
        tracking: draw(),
    }
}

/// One of `all`.
pub(super) fn one_of<T: Copy>(random: &mut ChaCha8Rng, all: &[T]) -> T {
    all[random.random_range(0..all.len())]
}

/// The pairs that are known to be hard, on each specimen and at each noise of `campaign`.
pub(super) fn scenarios(campaign: &Campaign) -> Vec<Trial> {
    let mut all = Vec::new();
    for pair in SCENARIOS {
        for &(density, amplitude, _) in &campaign.specimens {
            for &noise in &campaign.noises {
                let moment = campaign.moments[all.len() % campaign.moments.len()];
                let changes = pair.map(|(kind, size, later)| kind.attack(size, moment, later));
                let place = Place {
                    specimen: (density, amplitude, FREQUENCY),
                    noise,
                    follow: if all.len() % 2 == 1 { FOLLOW } else { 0.0 },
                    seed: all.len() as u64,
                };
                all.push(Trial::attacked(Set::Pair, changes.into(), place));
            }
        }
    }
    all
}

/// `count` pairs of kinds, sizes, specimens, noises, moments and limits, each drawn from its number.
pub(super) fn drawn_pairs(campaign: &Campaign, count: u32) -> Vec<Trial> {
    let kinds = Change::singles();
    let draw = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let random = &mut random;
        let changes = [0.0, random.random_range(0.0..8.0_f64).floor()].map(|later| {
            let kind = one_of(random, &kinds);
            let moment = one_of(random, &campaign.moments);
            kind.attack(one_of(random, kind.sizes()), moment, later)
        });
        let (density, amplitude, _) = one_of(random, &campaign.specimens);
        let place = Place {
            specimen: (density, amplitude, FASTEST),
            noise: one_of(random, &campaign.noises),
            follow: one_of(random, &[0.0, FOLLOW]),
            seed,
        };
        let trial = Trial::attacked(Set::Pair, changes.into(), place);
        let close = trial.close.map(|close| Close {
            headroom: headroom(random),
            ..close
        });
        Trial { close, ..trial }
    };
    (0..u64::from(count)).map(draw).collect()
}
