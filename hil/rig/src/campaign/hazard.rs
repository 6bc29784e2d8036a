//! The hazardous state: a true quantity beyond 1.1 times its limit for longer than the trip time, while the enable line is high.

use std::collections::VecDeque;

use serde::Serialize;

use super::lost::LostSince;
use crate::Passed;
use crate::signals::Sensed;

/// A quantity with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// True displacement, mm.
    Displacement,
    /// True force, kN.
    Force,
    /// True displacement minus the demanded one, mm.
    Tracking,
}

impl Quantity {
    const ALL: [Self; 3] = [Self::Displacement, Self::Force, Self::Tracking];

    /// The channel that measures it, as its index in [`Sensed`].
    fn channel(self) -> usize {
        usize::from(self == Self::Force)
    }
}

/// Reason for a hazardous state, judged by the signals alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Behind {
    /// The single channel of the quantity showed the true value with a constant gain and a constant offset, exactly and at every
    /// sample, from one cycle before the hazard on. With these, every shown value was within the limit, or beyond it for no longer
    /// than the trip time. A single channel cannot detect this.
    ConstantGain,
    /// The same, but the gain changed by up to a few percent in that time.
    DriftingGain,
    /// The rig had dropped the enable line, but the line stayed high at the servo.
    LineHigh,
    /// The single channel of the quantity was lost, so it hardly showed the excess, and the excess came within the 2.25 cycles that
    /// the detection of a loss takes. This needs two attacks at once and excuses no single attack.
    JustLost,
    /// The controller was not called for longer than the trip time, and the rest of the excess lasted no longer than the trip time.
    /// Only an external watchdog of the controller can act.
    NotCalled,
    /// Any other reason: the rig must not let this happen.
    Other,
}

/// A hazardous state that occurred.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Hazard {
    /// The quantity beyond its limit.
    pub quantity: Quantity,
    /// Largest value of the quantity divided by its limit.
    pub factor: f64,
    /// Largest number of successive plant steps beyond the limit.
    pub steps: u32,
    /// Tick of the trial at which the quantity had first been beyond the limit for longer than the trip time.
    pub tick: u64,
    /// The reason for the hazardous state.
    pub behind: Behind,
}

/// Limits of the trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allowed {
    /// Limits of displacement in mm, force in kN and tracking in mm.
    pub limits: [f64; 3],
    /// Ticks after which the rig stops.
    pub trip_ticks: u32,
    /// Ticks per cycle.
    pub cycle_ticks: usize,
    /// Displacement in mm and force in kN per V.
    pub units: [f64; 2],
}

/// Part of a limit above which it counts as exceeded.
const BEYOND: f64 = 1.1;
/// Part of the shown quantity's variance that a constant gain and offset may leave unexplained if they are exact: rounding of the
/// sums.
const EXACT: f64 = 1e-9;
/// The same for a gain that varies by 1 % RMS about its mean.
const DRIFTING: f64 = 1e-4;
/// Gains below this do not count as a gain: the channel shows nothing.
const LEAST_GAIN: f64 = 0.05;
/// Difference between the shown and the true value, as a part of the limit, above which the shown value is false.
const FALSE: f64 = 0.05;
/// A limit that is exceeded in no more than one of nine ticks need not stop the rig: see the crate's `rig/fault.rs`.
const NINTH: usize = 9;
/// A quantity beyond its limit.
#[derive(Clone, Copy, Debug, Default)]
struct Beyond {
    /// Successive steps, those of them in this tick, and the most of them in one tick.
    steps: u32,
    in_tick: u32,
    late: u32,
    /// The largest ratio to the limit.
    factor: f64,
    /// Index of the hazard recorded for it.
    noted: Option<usize>,
}

/// Watches the plant.
#[derive(Clone, Debug)]
pub struct HazardMeter {
    allowed: Allowed,
    /// In the order of [`Quantity::ALL`].
    beyond: [Beyond; 3],
    /// Whether the rig held the enable line high.
    held_high: bool,
    /// True and shown values of the last cycle, with the demand, mm.
    past: VecDeque<(Sensed, f64)>,
    /// Losses of the channel of each quantity, relative to its limit.
    losses: [LostSince; 3],
    hazards: Vec<Hazard>,
}

impl HazardMeter {
    /// A meter before the first tick.
    pub fn new(allowed: Allowed) -> Self {
        Self {
            allowed,
            beyond: [Beyond::default(); 3],
            held_high: false,
            past: VecDeque::new(),
            losses: [LostSince::default(); 3],
            hazards: Vec::new(),
        }
    }

    /// The worst hazard of each quantity and [`Behind`], in the order in which they occurred.
    pub fn hazards(self) -> Vec<Hazard> {
        self.hazards
    }

    /// Takes a tick: the plant's steps in `passed`, the values `sensed` before, the displacement that the rig demands in mm, `None`
    /// while it does not run, and whether it holds the enable line high.
    pub fn tick(
        &mut self,
        tick: u64,
        passed: &[Passed],
        sensed: Sensed,
        demanded: Option<f64>,
        held_high: bool,
    ) {
        self.past.push_back((sensed, demanded.unwrap_or(0.0)));
        if self.past.len() > self.allowed.cycle_ticks + self.allowed.trip_ticks as usize {
            self.past.pop_front();
        }
        if demanded.is_some() {
            for (place, quantity) in Quantity::ALL.into_iter().enumerate() {
                let channel = quantity.channel();
                let off = sensed.arrived[channel] - sensed.put_out[channel];
                let is_false =
                    self.allowed.units[channel] * off.abs() > FALSE * self.allowed.limits[place];
                self.losses[place].tick(is_false, self.allowed.cycle_ticks);
            }
        }
        // An excess while the rig ran ends when it stops; an excess that continues then is counted separately.
        if self.held_high != held_high {
            self.held_high = held_high;
            self.beyond = [Beyond::default(); 3];
        }
        for beyond in &mut self.beyond {
            beyond.in_tick = 0;
        }
        for step in passed {
            let values = [
                step.displacement,
                step.force,
                demanded.map_or(0.0, |demanded| step.displacement - demanded),
            ];
            for (place, quantity) in Quantity::ALL.into_iter().enumerate() {
                let factor = values[place].abs() / self.allowed.limits[place];
                let beyond = &mut self.beyond[place];
                if !step.enabled || factor <= BEYOND {
                    self.note(tick, quantity, place);
                    self.beyond[place] = Beyond::default();
                    continue;
                }
                beyond.steps += 1;
                beyond.in_tick += 1;
                beyond.late = beyond.late.max(beyond.in_tick);
                beyond.factor = beyond.factor.max(factor);
            }
        }
        for (place, quantity) in Quantity::ALL.into_iter().enumerate() {
            self.note(tick, quantity, place);
        }
    }

    /// Records a quantity that is beyond its limit for too long, at the end of a tick or of the excess.
    fn note(&mut self, tick: u64, quantity: Quantity, place: usize) {
        let beyond = self.beyond[place];
        let Beyond {
            steps,
            in_tick,
            factor,
            noted,
            ..
        } = beyond;
        if steps <= self.allowed.trip_ticks || in_tick == 0 {
            return;
        }
        // Evaluated when it occurs, and once in each cycle for which it lasts; if the controller was not called, until it is
        // called.
        let over = (steps - self.allowed.trip_ticks) as usize;
        let is_settled = |noted: &usize| {
            self.hazards[*noted].behind != Behind::NotCalled
                && !over.is_multiple_of(self.allowed.cycle_ticks)
        };
        let noted = match noted.filter(is_settled) {
            Some(noted) => noted,
            None => {
                let behind = self.behind(quantity, place, &beyond);
                let of_this = |known: &Hazard| known.quantity == quantity && known.behind == behind;
                self.hazards.iter().position(of_this).unwrap_or_else(|| {
                    self.hazards.push(Hazard {
                        quantity,
                        factor,
                        steps,
                        tick,
                        behind,
                    });
                    self.hazards.len() - 1
                })
            }
        };
        self.beyond[place].noted = Some(noted);
        let hazard = &mut self.hazards[noted];
        hazard.steps = hazard.steps.max(steps);
        hazard.factor = hazard.factor.max(factor);
    }

    /// Least squares of shown = gain·true + offset over the past: whether it is exact, and the shown value of the largest true one.
    fn behind(&self, quantity: Quantity, place: usize, beyond: &Beyond) -> Behind {
        let trip_ticks = self.allowed.trip_ticks;
        if !self.held_high {
            return Behind::LineHigh;
        }
        if beyond.late > trip_ticks && beyond.steps - beyond.late <= trip_ticks {
            return Behind::NotCalled;
        }
        let channel = quantity.channel();
        let unit = self.allowed.units[channel];
        let limit = self.allowed.limits[place];
        let reference = |demanded: f64| match quantity {
            Quantity::Tracking => demanded,
            Quantity::Displacement | Quantity::Force => 0.0,
        };
        let pairs = self.past.iter().map(|(sensed, demanded)| {
            let arrived = unit * sensed.arrived[channel];
            let watched = arrived - reference(*demanded);
            (unit * sensed.put_out[channel], arrived, watched)
        });
        let count = self.past.len() as f64;
        let mut sums = [0.0; 2];
        let steps = beyond.steps as usize;
        let [mut shown_in_all, mut shown_last] = [0; 2];
        for (at, (put_out, arrived, watched)) in pairs.clone().enumerate() {
            sums[0] += put_out;
            sums[1] += arrived;
            let is_shown = usize::from(watched.abs() > limit);
            shown_in_all += is_shown;
            shown_last += if at + steps >= self.past.len() {
                is_shown
            } else {
                0
            };
        }
        let means = sums.map(|sum| sum / count);
        let [mut square, mut product, mut shown_square] = [0.0; 3];
        for (put_out, arrived, _) in pairs {
            let (x, y) = (put_out - means[0], arrived - means[1]);
            square += x * x;
            product += x * y;
            shown_square += y * y;
        }
        let gain = product / square;
        let left = (shown_square - product * gain) / shown_square;
        // NaN, without any motion, is no gain.
        let is_gain = gain >= LEAST_GAIN && left <= DRIFTING;
        if !is_gain || shown_in_all > trip_ticks as usize {
            // One more sample, if the excess begins and ends with one.
            let hardly = NINTH * shown_last.saturating_sub(1) <= steps;
            if hardly && self.losses[place].is_new(self.allowed.cycle_ticks) {
                Behind::JustLost
            } else {
                Behind::Other
            }
        } else if left <= EXACT {
            Behind::ConstantGain
        } else {
            Behind::DriftingGain
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALLOWED: Allowed = Allowed {
        limits: [1.0, 2.0, 0.5],
        trip_ticks: 10,
        cycle_ticks: 100,
        units: [0.1, 0.5],
    };

    fn at(displacement: f64, force: f64, enabled: bool) -> Passed {
        Passed {
            displacement,
            force,
            enabled,
        }
    }

    /// `steps` at 1.2 times the force's limit.
    fn hazards(steps: u32, enabled: bool, held_high: bool) -> Vec<Hazard> {
        let mut meter = HazardMeter::new(ALLOWED);
        for tick in 0..300 {
            let is_beyond = (200..200 + u64::from(steps)).contains(&tick);
            let force = if is_beyond { -2.4 } else { 2.1 };
            let step = [at(0.5, force, enabled)];
            meter.tick(tick, &step, Sensed::default(), Some(0.5), held_high);
        }
        meter.hazards()
    }

    #[test]
    fn a_limit_counts_where_it_is_exceeded_for_longer_than_the_trip_time() {
        assert!(hazards(ALLOWED.trip_ticks, true, true).is_empty());
        let [hazard] = hazards(ALLOWED.trip_ticks + 1, true, true)[..] else {
            panic!("one is expected");
        };
        assert_eq!((hazard.quantity, hazard.steps), (Quantity::Force, 11));
        assert!((hazard.factor - 1.2).abs() < 1e-12);
        assert_eq!((hazard.tick, hazard.behind), (210, Behind::Other));
        assert_eq!(hazards(60, true, true)[0].steps, 60);
        assert!(hazards(60, false, true).is_empty());
        // A line that is high although the rig has dropped it is distinguished.
        let stuck = hazards(60, true, false);
        assert_eq!((stuck[0].steps, stuck[0].behind), (60, Behind::LineHigh));
    }

    /// All in one late tick.
    #[test]
    fn steps_count_and_not_ticks() {
        let mut meter = HazardMeter::new(ALLOWED);
        let late = [at(0.0, 0.0, true); 500].map(|step| Passed {
            displacement: -0.8,
            ..step
        });
        meter.tick(0, &late, Sensed::default(), Some(0.0), true);
        let [hazard] = meter.hazards()[..] else {
            panic!("one is expected");
        };
        assert_eq!((hazard.quantity, hazard.steps), (Quantity::Tracking, 500));
        assert_eq!(hazard.behind, Behind::NotCalled);
    }

    /// A controller that is called again has to act within the trip time, and one that is called late by less has no excuse.
    #[test]
    fn a_controller_that_was_not_called_is_excused_for_that_time_only() {
        let behind = |ticks: &[usize]| {
            let mut meter = HazardMeter::new(ALLOWED);
            for (tick, steps) in ticks.iter().enumerate() {
                let passed = vec![at(0.0, 2.4, true); *steps];
                meter.tick(tick as u64, &passed, Sensed::default(), Some(0.0), true);
            }
            let hazards = meter.hazards();
            hazards.iter().map(|one| one.behind).collect::<Vec<_>>()
        };
        assert_eq!(behind(&[1, 1, 40, 1]), [Behind::NotCalled]);
        let late = [&[40][..], &[1; 11]].concat();
        assert_eq!(behind(&late), [Behind::NotCalled, Behind::Other]);
        assert_eq!(behind(&[2; 6]), [Behind::Other]);
    }

    /// Reason for a force of 1.5 times its limit, where its channel shows `shown` of its voltage.
    fn behind(shown: impl Fn(u64, f64) -> f64) -> Behind {
        let mut meter = HazardMeter::new(ALLOWED);
        for tick in 0..1000 {
            let force = 3.0 * (std::f64::consts::TAU * tick as f64 / 100.0).sin();
            let volts = force / ALLOWED.units[1];
            let sensed = Sensed {
                put_out: [0.0, volts],
                arrived: [0.0, shown(tick, volts)],
            };
            meter.tick(tick, &[at(0.0, force, true)], sensed, Some(0.0), true);
        }
        let hazards = meter.hazards();
        let others = hazards
            .iter()
            .filter(|one| one.behind != Behind::ConstantGain);
        others
            .map(|one| one.behind)
            .next_back()
            .unwrap_or(hazards[0].behind)
    }

    #[test]
    fn a_constant_gain_is_told_by_the_signals_and_hides_nothing_else() {
        assert_eq!(behind(|_, volts| 0.5 * volts), Behind::ConstantGain);
        assert_eq!(behind(|_, volts| 0.5 * volts + 0.2), Behind::ConstantGain);
        let drifting = |tick: u64, volts: f64| (0.6 - 1e-4 * tick as f64) * volts;
        assert_eq!(behind(drifting), Behind::DriftingGain);
        // The rig would have seen it.
        assert_eq!(behind(|_, volts| volts), Behind::Other);
        // No gain at all, the opposite sign, one sample in ten missing, a small added signal.
        assert_eq!(behind(|_, _| 0.3), Behind::Other);
        assert_eq!(behind(|_, volts| -0.5 * volts), Behind::Other);
        let one_in_ten = |tick: u64, volts: f64| f64::from(!tick.is_multiple_of(10)) * 0.5 * volts;
        assert_eq!(behind(one_in_ten), Behind::Other);
        let hum = |tick: u64, volts: f64| 0.5 * volts + 0.1 * (tick as f64).sin();
        assert_eq!(behind(hum), Behind::Other);
    }

    /// A force of half its limit, and from tick 500 of 1.5 times its limit; the channel shows `shown` of its voltage.
    fn behind_a_jump(shown: impl Fn(u64, f64) -> f64) -> Vec<Behind> {
        let mut meter = HazardMeter::new(ALLOWED);
        for tick in 0..800 {
            let force = if tick < 500 { 1.0 } else { 3.0 };
            let volts = force / ALLOWED.units[1];
            let sensed = Sensed {
                put_out: [0.0, volts],
                arrived: [0.0, shown(tick, volts)],
            };
            meter.tick(tick, &[at(0.0, force, true)], sensed, Some(0.0), true);
        }
        meter.hazards().iter().map(|one| one.behind).collect()
    }

    #[test]
    fn a_lost_channel_is_an_excuse_for_a_time_and_only_while_it_shows_nothing() {
        let lost_from =
            |from: u64| behind_a_jump(move |tick, volts| if tick < from { volts } else { 0.0 });
        // Evaluated at once, and again each cycle, when the rig must have detected it.
        assert_eq!(lost_from(440), [Behind::JustLost, Behind::Other]);
        assert_eq!(lost_from(290), [Behind::JustLost, Behind::Other]);
        // Lost for longer than 2.25 cycles, or after the excess, or never.
        assert_eq!(lost_from(280), [Behind::Other]);
        assert_eq!(lost_from(520)[0], Behind::Other);
        assert_eq!(lost_from(800), [Behind::Other]);
        // A single correct sample in ten is too few for a limit, one in five is not.
        let every = |n: u64| {
            let is_shown = move |tick: u64| tick < 450 || tick.is_multiple_of(n);
            behind_a_jump(move |tick, volts| if is_shown(tick) { volts } else { 0.0 })
        };
        assert_eq!(every(10), [Behind::JustLost, Behind::Other]);
        assert_eq!(every(5), [Behind::Other]);
    }
}
