//! The controller of a damper emulation: measured motion in, the law's force out.

use core::borrow::{Borrow, BorrowMut};

use super::blend::Blend;
use super::comparison::Comparison;
use super::controller::Controller;
use super::fault::{Exceeded, Limits, TripCause};
use super::guard::{self, Guard, answered_by_guard};
use super::io::{Reading, Wiring};
use super::pace::PaceConfig;
use super::refusal::{ClearRefused, StartRefused};
use super::standstill::{Standstill, StandstillConfig};
use super::state::State;
use super::temperature::{Temperature, TemperatureConfig};
use super::{CycleReport, Telemetry};
use crate::crossing::CrossingDetector;
use crate::effects::Motion;
use crate::error::ConfigError;
use crate::fast_law::{Adaptation, FastLaw, RunningLaw};
use crate::health::{Event, HealthCause, Statistic};
use crate::observer::{Observer, ObserverConfig};
use crate::real::Real;
use crate::tick_law::TickLaw;

/// Settings of a damper emulation. [`EmulationController::new`] validates them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct DamperEmulationSettings {
    /// Tick rate, Hz, 1…1e6.
    pub tick_rate: f64,
    /// Largest measured displacement in either direction, mm, 1e-6…1e4.
    pub displacement_limit: f64,
    /// Largest force in either direction, kN, 1e-6…1e9. A force of the law beyond it stops at once, a measured one after
    /// `trip_ticks`.
    pub force_limit: f64,
    /// Trip time: number of ticks in which a measured quantity exceeds its limit until the stop, 1…1e6. As
    /// [`super::RigSettings::trip_ticks`], they need not be in a row, and a quarter is enough for an excess of more than a tenth.
    pub trip_ticks: u32,
    /// Number of ticks in which the force rises to its full value after a start, and goes to 0 after a stop, 1…1e7.
    pub stop_ticks: u32,
    /// Number of ticks without an exchange over the link after which it stops, see [`Controller::exchange`], 0…1e7; 0 without a
    /// link.
    pub link_ticks: u32,
    /// As [`super::RigSettings::clock_rate`].
    pub clock_rate: f64,
    /// Bandwidth of the observer, Hz, 1e-3 to a tenth of the tick rate. It does not know the motion in advance: its lag at
    /// frequency f is about (1 + 2ζ)·(f/bandwidth)² of the velocity.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3…3.
    pub observer_damping: f64,
    /// Half width of the rest band, mm, 0…1e4: a few times the noise of the displacement channel. A displacement that has stayed in
    /// the band for 0.05 s is at rest. Its velocity is then taken as 0, so that the damping force does not chatter with the noise.
    /// 0 switches this off.
    pub rest_band: f64,
    /// Number of ticks with an unchanged code after which the displacement channel is stuck, 0…1e9; 0 for a channel without any
    /// noise, as in a simulation.
    pub stuck_ticks: u32,
    /// Coldest and hottest plausible temperature, °C, −273…2000.
    pub temperature_range: [f64; 2],
    /// Fastest plausible change of the temperature, °C/s, 1e-3…1e3.
    pub temperature_rate: f64,
    /// Distance of the displacement from its mean at which a cycle counts, mm, 1e-9…1e4.
    pub hysteresis: f64,
}

impl Default for DamperEmulationSettings {
    /// Settings for amplitudes of 0.02–0.3 mm up to 10 Hz, at 10 kHz.
    fn default() -> Self {
        Self {
            tick_rate: 10_000.0,
            displacement_limit: 0.5,
            force_limit: 4.5,
            trip_ticks: 10,
            stop_ticks: 5_000,
            link_ticks: 0,
            clock_rate: 0.0,
            observer_bandwidth: 100.0,
            observer_damping: 0.7,
            rest_band: 5e-4,
            stuck_ticks: 10_000,
            temperature_range: super::TEMPERATURES,
            temperature_rate: super::TEMPERATURE_RATE,
            hysteresis: 0.01,
        }
    }
}

/// The [`Controller`] of a damper made of the law `L` and a force actuator. It owns the law or borrows it, as firmware borrows it
/// from a static.
#[derive(Debug)]
pub struct EmulationController<L> {
    guard: Guard,
    limits: Limits,
    observer_config: ObserverConfig,
    law: L,
    observer: Observer,
    crossing: CrossingDetector,
    comparison: Comparison,
    exceeded: Exceeded,
    reading: Reading,
    /// Part of the law's force that is driven, 0…1, and its increase per tick.
    part: f32,
    part_step: f32,
    cycle: u32,
    /// Remaining steps in force after a swap of the law, and after a standstill; the last force of the law.
    swapped: Blend,
    stopped: Blend,
    last: f32,
    rested: bool,
    standstill: Standstill,
    standstill_config: StandstillConfig,
    temperature: Temperature,
    temperature_config: TemperatureConfig,
    tick: u64,
}

impl<L: TickLaw> EmulationController<L> {
    /// Idle. `law` is the law or a reference to it.
    ///
    /// # Errors
    /// A setting that is not finite or out of range.
    pub fn new(
        settings: &DamperEmulationSettings,
        wiring: &Wiring,
        law: L,
    ) -> Result<Self, ConfigError> {
        Ok(Self {
            guard: Guard::new(
                &wiring.command,
                guard::valid_stop_ticks(settings.stop_ticks)?,
                guard::valid_link_ticks(settings.link_ticks)?,
                PaceConfig::new(settings.tick_rate, settings.clock_rate)?,
            ),
            // There is no demanded displacement, and so no limit on tracking.
            limits: Limits::new(
                settings.displacement_limit,
                settings.force_limit,
                settings.displacement_limit,
                settings.trip_ticks,
            )?,
            observer_config: ObserverConfig::new(
                settings.tick_rate,
                settings.observer_bandwidth,
                settings.observer_damping,
            )?,
            law,
            observer: Observer::default(),
            crossing: CrossingDetector::new(settings.hysteresis as f32)?,
            comparison: Comparison::default(),
            exceeded: Exceeded::default(),
            reading: Reading::default(),
            part: 0.0,
            part_step: (1.0 / f64::from(settings.stop_ticks)) as f32,
            cycle: 0,
            swapped: Blend::default(),
            stopped: Blend::default(),
            last: 0.0,
            rested: false,
            standstill: Standstill::default(),
            standstill_config: StandstillConfig::new(
                settings.tick_rate,
                settings.rest_band,
                settings.stuck_ticks,
                settings.force_limit as f32,
            )?,
            temperature: Temperature::default(),
            temperature_config: TemperatureConfig::new(
                settings.tick_rate,
                settings.temperature_range,
                settings.temperature_rate,
            )?,
            tick: 0,
        })
    }

    /// Sets the temperature for the law's effects, °C; 20 until set. A value that the settings rule out is ignored, and reported as
    /// an event.
    pub fn set_temperature(&mut self, temperature: f32) {
        let moving = self.guard.is_running();
        self.temperature
            .show(&self.temperature_config, temperature, moving);
    }
}

impl<L: TickLaw> Controller for EmulationController<L> {
    /// Starts to drive the law's force, which rises over `stop_ticks`.
    fn start(&mut self) -> Result<(), StartRefused> {
        self.guard.start()?;
        self.law.boundary();
        self.exceeded = Exceeded::default();
        self.crossing.reset();
        self.part = 0.0;
        self.swapped = Blend::default();
        self.stopped = Blend::default();
        self.standstill.restart();
        Ok(())
    }

    answered_by_guard!();

    fn clear(&mut self) -> Result<(), ClearRefused> {
        self.guard.clear()
    }

    /// The law is evaluated whether running or not, so that the state of its effects follows the motion.
    #[inline]
    fn tick(&mut self, reading: Option<Reading>, clock: u32) -> Telemetry {
        self.tick = self.tick.wrapping_add(1);
        self.guard.pace(clock, self.tick);
        self.guard.watch_link();
        self.guard.take(reading, &mut self.reading);
        let displacement = self.reading.displacement.value;
        let measured_force = self.reading.force.value;
        let estimate = self
            .observer
            .update(&self.observer_config, displacement, 0.0);
        let crossing = self.crossing.update(estimate.displacement);
        let ended = crossing.boundary.is_some();
        let mut another_law = false;
        if ended {
            self.cycle = self.cycle.wrapping_add(1);
            another_law = self.law.boundary();
        }
        let rests = self
            .standstill
            .rests(&self.standstill_config, estimate.displacement);
        let motion = Motion {
            displacement: estimate.displacement,
            velocity: if rests { 0.0 } else { estimate.velocity },
            acceleration: estimate.acceleration,
            cycles: self.cycle as f32 + crossing.phase as f32 * (1.0 / (1u64 << 32) as f32),
            temperature: self.temperature.tick(&self.temperature_config),
            controls: self.reading.controls,
        };
        let model_force = self.law.force(&motion);
        if !model_force.is_finite() {
            self.guard.trip(TripCause::NotFinite);
        }
        let results =
            self.comparison
                .update(measured_force, model_force, ended, |accumulator, forces| {
                    accumulator.update_at(
                        estimate.displacement,
                        forces,
                        crossing.phase,
                        crossing.boundary,
                    )
                });
        if self.guard.is_running() {
            let measured = self
                .limits
                .check(&mut self.exceeded, displacement, measured_force, 0.0);
            // A force about to be driven is checked without being measured first.
            let driven = (model_force.abs() > self.limits.force()).then_some(TripCause::ForceLimit);
            let command = self.guard.driven();
            let implausible =
                self.standstill
                    .check(&self.standstill_config, &self.reading, command);
            if let Some(fault) = measured.or(driven).or(implausible) {
                self.guard.trip(fault);
            }
            self.part = (self.part + self.part_step).min(1.0);
        }
        let step = self.last - model_force;
        if another_law {
            self.swapped.begin(step, self.part_step);
        } else if rests && !self.rested {
            self.stopped.begin(step, self.part_step);
        } else if !rests {
            // A damper that moves again has all of its friction at once.
            self.stopped = Blend::default();
        }
        self.rested = rests;
        self.last = model_force;
        // During the transition both are within the limit, and their sum must be too.
        let blended = model_force + self.swapped.tick() + self.stopped.tick();
        let limit = self.limits.force();
        self.guard.command(self.part * blended.clamped(limit));
        Telemetry {
            tick: self.tick,
            displacement,
            velocity: estimate.velocity,
            measured_force,
            controls: self.reading.controls,
            model_force,
            command: self.guard.driven(),
            block: 0,
            cycle: self.cycle,
            phase: crossing.phase,
            ramp: false,
            state: self.guard.state(),
            report: results.map(|results| {
                CycleReport::new(results, 0, self.cycle, false, Adaptation::default())
            }),
            event: self.temperature.take_implausible().map(|shown| Event {
                cause: HealthCause::TemperatureImplausible,
                or: None,
                statistic: Statistic::Sample,
                value: shown,
                limit: self.temperature.taken(),
                cycle: self.cycle,
            }),
        }
    }
}

impl<L> EmulationController<L> {
    /// Swaps the law at the end of this cycle, or at the start if that comes before. Effects keep their state if they are of the
    /// same kinds in the same order. The force changes over within `stop_ticks`.
    ///
    /// The law is used as given. A law loaded from a pack has been checked for passivity. Check any other law with
    /// [`passivity::check`](crate::passivity::check) before.
    pub fn swap_law<const N: usize>(&mut self, law: FastLaw<N>)
    where
        L: BorrowMut<RunningLaw<N>>,
    {
        self.law.borrow_mut().swap(law);
    }

    /// The running law.
    pub fn law<const N: usize>(&self) -> &FastLaw<N>
    where
        L: Borrow<RunningLaw<N>>,
    {
        self.law.borrow().law()
    }
}
