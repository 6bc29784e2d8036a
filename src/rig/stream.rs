//! Any motion as an excitation: a host streams it, a few points ahead.
//!
//! The host gives displacement and velocity at every `knot_ticks`-th tick, a [`Knot`]. From knot to knot the demand is the cubic
//! that meets both. Position and velocity thus have no step, and the link carries one knot in place of many ticks. For a motion of
//! angular frequency ω the error is within (ω·T)⁴/384 of its amplitude, with T the time from knot to knot: 6e-7 at 20 Hz and 1 ms.
//!
//! The rig still decides what it demands:
//!
//! - A knot beyond the limits of displacement or velocity, or one that no velocity within its limit can reach in time, stops the
//!   rig with [`TripCause::DemandLimit`].
//! - If the next knot does not arrive in time, the demand slows down to a hold: v = v₀·(1 − s)² over the part s of `hold_ticks`.
//!   This has no step in velocity, and goes v₀·`hold_ticks`/3 further. A knot that arrives meanwhile is followed from there. If
//!   none has arrived by then, the rig trips with [`TripCause::LinkLost`].
//!
//! While the rig follows a stream it counts as being in a ramp: it learns no correction of amplitude and phase and gives no results
//! of cycles, and its monitor watches the channels but neither specimen nor response, because all of these need cycles that repeat.
//! Cycles are counted for effects that depend on their number and for the swap of a law. A cycle ends where the demand rises
//! through 0 after it was below 0 by a hundredth of its limit.

use super::exciter::Exciter;
use super::fault::TripCause;
use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::{Real, in_range};
use crate::sine::{Excitation, TICK_RATE_MAX};

/// Number of knots that a stream holds ahead.
pub const STREAM_QUEUE: usize = 8;

/// Distance below 0 from which a demand must rise through 0, as a part of its limit.
const HYSTERESIS: f32 = 0.01;

/// Position and velocity of a streamed motion at one of its knots.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Knot {
    /// Displacement, mm.
    pub displacement: f32,
    /// Velocity, mm/s.
    pub velocity: f32,
}

/// Settings of a stream. [`StreamSettings::at`] validates them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct StreamSettings {
    /// Largest displacement of a knot in either direction, mm, 1e-6…1e4.
    pub displacement_limit: f64,
    /// Largest velocity of a knot and largest mean velocity from knot to knot, mm/s, 1e-6…1e6.
    pub velocity_limit: f64,
    /// Ticks from knot to knot, 1…1e4.
    pub knot_ticks: u32,
    /// Ticks in which the demand comes to a hold without a knot, 1…1e6.
    pub hold_ticks: u32,
}

impl Default for StreamSettings {
    /// Settings for the rig of [`super::RigSettings::default`]: a knot every millisecond at 10 kHz, and 0.1 s to a hold.
    fn default() -> Self {
        Self {
            displacement_limit: 0.5,
            velocity_limit: 120.0,
            knot_ticks: 10,
            hold_ticks: 1000,
        }
    }
}

/// [`StreamSettings`] at a tick rate, as they go over a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamConfig {
    /// Tick rate in Hz, and length of a tick in s.
    rate: f32,
    tick: f32,
    displacement_limit: f32,
    velocity_limit: f32,
    /// Largest distance from knot to knot, mm.
    way_limit: f32,
    knot_ticks: u32,
    hold_ticks: u32,
}

impl StreamConfig {
    /// Tick rate, Hz.
    pub fn tick_rate(&self) -> f32 {
        self.rate
    }
}

impl StreamSettings {
    /// Converts the settings for `tick_rate` Hz, 1…1e6.
    ///
    /// # Errors
    /// A setting that is not finite or out of range.
    pub fn at(&self, tick_rate: f64) -> Result<StreamConfig, ConfigError> {
        in_range("tick_rate", tick_rate, 1.0, TICK_RATE_MAX)?;
        in_range("knot_ticks", f64::from(self.knot_ticks), 1.0, 1e4)?;
        in_range("hold_ticks", f64::from(self.hold_ticks), 1.0, 1e6)?;
        let velocity = in_range("velocity_limit", self.velocity_limit, 1e-6, 1e6)?;
        let displacement = in_range("displacement_limit", self.displacement_limit, 1e-6, 1e4)?;
        Ok(StreamConfig {
            rate: tick_rate as f32,
            tick: (1.0 / tick_rate) as f32,
            displacement_limit: displacement as f32,
            velocity_limit: velocity as f32,
            way_limit: (velocity * f64::from(self.knot_ticks) / tick_rate) as f32,
            knot_ticks: self.knot_ticks,
            hold_ticks: self.hold_ticks,
        })
    }
}

impl Fields for StreamConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        let floats = [
            self.rate,
            self.tick,
            self.displacement_limit,
            self.velocity_limit,
            self.way_limit,
        ];
        writer.words(floats.map(f32::to_bits));
        writer.words([self.knot_ticks, self.hold_ticks]);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [rate, tick, displacement_limit, velocity_limit, way_limit] =
            reader.words()?.map(f32::from_bits);
        let [knot_ticks, hold_ticks] = reader.words()?;
        let within = |value, low, high| in_range("stream", value, low, high).ok();
        Some(Self {
            rate: within(rate, 1.0, TICK_RATE_MAX)?,
            tick: within(tick, 1.0 / TICK_RATE_MAX, 1.0)?,
            displacement_limit: within(displacement_limit, 1e-6, 1e4)?,
            velocity_limit: within(velocity_limit, 1e-6, 1e6)?,
            way_limit: within(way_limit, 1e-12, 1e10)?,
            knot_ticks: (1..=10_000).contains(&knot_ticks).then_some(knot_ticks)?,
            hold_ticks: (1..=1_000_000)
                .contains(&hold_ticks)
                .then_some(hold_ticks)?,
        })
    }
}

impl StreamConfig {
    /// Whether the rig can go from `from` to `to` in the time from knot to knot. NaN is beyond every limit.
    fn allows(&self, from: &Knot, to: &Knot) -> bool {
        to.displacement.abs() <= self.displacement_limit
            && to.velocity.abs() <= self.velocity_limit
            && (to.displacement - from.displacement).abs() <= self.way_limit
    }

    /// Where a demand at `from` comes to a hold.
    fn hold(&self, from: &Knot) -> Knot {
        let way = from.velocity * self.tick * self.hold_ticks as f32 * (1.0 / 3.0);
        Knot {
            displacement: (from.displacement + way).clamped(self.displacement_limit),
            velocity: 0.0,
        }
    }
}

/// Follows the knots that a host gives. It begins at rest at 0.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    config: StreamConfig,
    queue: [Knot; STREAM_QUEUE],
    /// Index of the oldest knot in the queue, and number of knots.
    first: usize,
    count: usize,
    /// No knot follows these.
    complete: bool,
    /// Displacement over the ticks since the last knot, mm: the coefficients of 1, t, t² and t³.
    cubic: [f32; 4],
    /// Knot at its end.
    end: Knot,
    /// Its length in ticks, and the ticks elapsed.
    ticks: u32,
    gone: u32,
    holding: bool,
    done: bool,
    refusal: Option<TripCause>,
    below: bool,
    cycle: u32,
}

impl Stream {
    /// A stream without knots.
    pub fn new(config: StreamConfig) -> Self {
        Self {
            config,
            queue: [Knot::default(); STREAM_QUEUE],
            first: 0,
            count: 0,
            complete: false,
            cubic: [0.0; 4],
            end: Knot::default(),
            ticks: 0,
            gone: 0,
            holding: false,
            done: false,
            refusal: None,
            below: false,
            cycle: 0,
        }
    }

    /// Number of knots for which there is room.
    pub fn room(&self) -> usize {
        STREAM_QUEUE.saturating_sub(self.count)
    }

    /// Takes the next knot. Returns `false`, and takes nothing, if there is no room.
    pub fn push(&mut self, knot: Knot) -> bool {
        let is_room = self.count < STREAM_QUEUE;
        if is_room {
            self.queue[(self.first + self.count) % STREAM_QUEUE] = knot;
            self.count += 1;
        }
        is_room
    }

    /// The motion ends with the last knot given: once it is reached, the programme is over.
    pub fn complete(&mut self) {
        self.complete = true;
    }

    /// The oldest knot.
    fn queued(&self) -> Option<Knot> {
        let knot = self.queue.get(self.first)?;
        (self.count > 0).then_some(*knot)
    }

    /// Begins the next cubic. Neither this function nor its callees are inlined: there is enough time, and flash is scarce.
    #[inline(never)]
    fn next(&mut self) {
        let from = self.end;
        let config = &self.config;
        let (to, ticks) = match self.queued() {
            Some(knot) if config.allows(&from, &knot) => {
                self.count -= 1;
                self.first = (self.first + 1) % STREAM_QUEUE;
                self.holding = false;
                (knot, config.knot_ticks)
            }
            knot => {
                if knot.is_some() {
                    self.refusal = Some(TripCause::DemandLimit);
                } else if self.complete {
                    self.done = true;
                } else if self.holding {
                    self.refusal = Some(TripCause::LinkLost);
                }
                self.holding = true;
                (config.hold(&from), config.hold_ticks)
            }
        };
        self.lead(&from, to, ticks);
    }

    fn lead(&mut self, from: &Knot, to: Knot, ticks: u32) {
        let part = 1.0 / ticks as f32;
        // All per tick.
        let mean = (to.displacement - from.displacement) * part;
        let [first, last] = [from.velocity, to.velocity].map(|v| v * self.config.tick);
        self.cubic = [
            from.displacement,
            first,
            (3.0 * mean - first - first - last) * part,
            (first + last - mean - mean) * part * part,
        ];
        self.end = to;
        self.ticks = ticks;
        self.gone = 0;
    }
}

impl Exciter for Stream {
    fn restart(&mut self) {
        *self = Self::new(self.config);
    }

    #[inline(never)]
    fn tick(&mut self) -> Excitation {
        if self.gone >= self.ticks {
            self.next();
        }
        let t = self.gone as f32;
        self.gone += 1;
        let [d, v, a, j] = self.cubic;
        let rate = self.config.rate;
        let displacement = d + t * (v + t * (a + t * j));
        let rises = self.below && displacement >= 0.0;
        if rises {
            self.below = false;
            self.cycle = self.cycle.wrapping_add(1);
        } else if displacement < -HYSTERESIS * self.config.displacement_limit {
            self.below = true;
        }
        Excitation {
            displacement,
            velocity: (v + t * (a + a + 3.0 * t * j)) * rate,
            acceleration: (a + a + 6.0 * t * j) * rate * rate,
            cycle: self.cycle,
            cycle_end: rises,
            ramp: true,
            done: self.done,
            ..Excitation::default()
        }
    }

    fn refusal(&self) -> Option<TripCause> {
        self.refusal
    }
}
