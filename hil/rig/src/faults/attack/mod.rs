//! Attacks: faults of specimen, sensors, converters, clock and link, injected into the rig without regard to what its monitor
//! knows, and the rig's response.

mod adversary;
mod apply;
mod coverage;
mod hazard;
mod kind;
mod lost;
mod names;
mod pairs;
mod run;
mod settings;
mod summary;
mod trial;

pub use adversary::adversary;
pub use coverage::{Coverage, coverage};
pub use hazard::{Allowed, Behind, Hazard, HazardMeter, Quantity};
pub use kind::{AttackKind, Begins, Element};
pub use names::Name;
pub use pairs::{drawn_pairs, scenarios};
pub use run::{run_attack, run_attack_with};
pub use settings::{Forgery, forgeries};
pub use summary::{
    AttackKindSummary, AttackSummary, Counts, Hazards, LossSummary, Outcomes, WorstHazard,
};
pub use trial::{Attack, AttackOutcome, AttackTrial, BLOCKS, Headroom, Loss, Naming, TRACKING};

use super::{Campaign, FOLLOW};

/// Cycles at full amplitude before a fault, and after it.
const HEALTHY: f64 = 24.0;
const WATCHED: f64 = 14.0;
/// Cycles of each of four short blocks.
const SHORT: u32 = 12;
/// Ratio of the limits to the values of the healthy rig, and of the force channel's full scale to its limit.
const HEADROOM: f64 = 1.5;
const RANGE: f64 = 2.0;
/// Cycles after which a slow change is not a run-in: for kinds in the run-in, and for kinds to be distinguished from it.
const RUN_IN: u32 = 200;
const NO_RUN_IN: u32 = 20;
/// Frequency, Hz: the most cycles in the least time.
const FREQUENCY: f64 = 10.0;
/// Ticks for which the temperature is not a number at the end of a cycle: the tick before, the tick of the end, and the tick after.
const AT_CYCLE_END: f64 = 3.0;

impl AttackKind {
    /// Such an attack of `size`, in its own trial or with others, at `moment` of a cycle, `later` by this many cycles.
    fn attack(self, size: f64, moment: f64, later: f64) -> Attack {
        let tick = FREQUENCY / crate::TICK_RATE;
        let (begins, lasts) = match self.begins() {
            Begins::AtStart => (-2.0, None),
            Begins::WhileLearning => (kind::LEARNING.0 + moment, None),
            Begins::Later => (HEALTHY + later + moment, None),
            Begins::AtCycleEnd => (HEALTHY + later - tick, Some(AT_CYCLE_END * tick)),
            // Two blocks and the ramps after them, and some cycles of the third.
            Begins::InShortBlock => (f64::from(2 * (SHORT + trial::RAMP)) + 5.0 + moment, None),
        };
        Attack {
            kind: self,
            size,
            begins,
            lasts,
        }
    }
}

impl AttackTrial {
    /// A trial of `attacks` on the specimen of this density in g/cm³ and amplitude in mm, with `noise` and `follow` as in
    /// [`AttackTrial`].
    fn of(
        attacks: Vec<Attack>,
        (density, amplitude): (f64, f64),
        (noise, follow): (f64, f64),
        seed: u64,
    ) -> Self {
        let in_short_blocks = |attack: &Attack| attack.kind.begins() == Begins::InShortBlock;
        let blocks = if attacks.iter().any(in_short_blocks) {
            vec![SHORT; BLOCKS]
        } else {
            let there = |attack: &Attack| attack.begins + attack.kind.lead(attack.size, follow);
            let last = attacks.iter().map(there).fold(0.0, f64::max);
            vec![(last + WATCHED).ceil() as u32]
        };
        let is_slow = |attack: &Attack| attack.kind.is_after_run_in();
        let run_in = if attacks.iter().any(is_slow) {
            NO_RUN_IN
        } else {
            RUN_IN
        };
        Self {
            attacks,
            density,
            amplitude,
            frequency: FREQUENCY,
            noise,
            follow,
            blocks,
            run_in,
            headroom: Headroom::of_all(HEADROOM),
            range: RANGE,
            seed,
        }
    }
}

/// Whether a kind makes a trial alone. A kind that changes nothing alone does not, nor does one that no signal of the campaign
/// shows.
fn is_single(kind: AttackKind) -> bool {
    !matches!(kind, AttackKind::Ringing(_) | AttackKind::ControlsLost)
}

/// Every attack in every size alone, at the moments, specimens and noises of `campaign`, every second one with adaptation.
pub fn singles(campaign: &Campaign) -> Vec<AttackTrial> {
    let mut all = Vec::new();
    for kind in AttackKind::all()
        .into_iter()
        .filter(|kind| is_single(*kind))
    {
        for &size in kind.sizes() {
            for (place, &(density, amplitude, _)) in campaign.specimens.iter().enumerate() {
                for (loudness, &noise) in campaign.noises.iter().enumerate() {
                    for (part, &moment) in campaign.moments.iter().enumerate() {
                        let follows = (place + loudness + part) % 2 == 1;
                        let attack = kind.attack(size, moment, 0.0);
                        let seed = all.len() as u64;
                        let settings = (noise, if follows { FOLLOW } else { 0.0 });
                        let specimen = (density, amplitude);
                        all.push(AttackTrial::of(vec![attack], specimen, settings, seed));
                    }
                }
            }
        }
    }
    all
}

#[cfg(test)]
mod tests;
