//! The controller that excites a specimen and evaluates the law alongside it.

use core::borrow::{Borrow, BorrowMut};

use super::approach::Approach;
use super::comparison::Comparison;
use super::controller::Controller;
use super::correction::{Correction, CorrectionConfig};
use super::exciter::Exciter;
use super::fault::{Exceeded, Limits, TripCause, clipped};
use super::guard::{Guard, answered_by_guard};
use super::io::{Reading, Wiring};
use super::refusal::{ClearRefused, StartRefused};
use super::state::State;
use super::temperature::{Temperature, TemperatureConfig};
use super::{CycleReport, RigConfig, RigSettings, Telemetry};
use crate::effects::Motion;
use crate::error::ConfigError;
use crate::fast_law::{Adaptation, FastLaw, RunningLaw};
use crate::health::{Change, Channel, Ended, Event, HealthConfig, HealthMonitor, Look, Steady};
use crate::observer::{Observer, ObserverConfig};
use crate::sine::{Excitation, Programme, SineGenerator};

/// `cargo hil bench` also counts the tick without the health monitor; the difference is the monitor's cost. It sets `unmonitored`
/// through the compiler for a separate image. It is not a feature, so that no crate can remove the monitor from another crate's
/// rig.
const MONITORED: bool = !cfg!(unmonitored);

/// Part of the displacement's limit within which the piston counts as being at the exciter's start.
const APPROACHED: f32 = 0.02;

/// The trip cause when a channel is lost.
fn trip_of(channel: Channel) -> TripCause {
    match channel {
        Channel::Displacement => TripCause::DisplacementLost,
        Channel::Force => TripCause::ForceLost,
    }
}

/// The [`Controller`] of a rig with up to `N` effects in its law, driven by the [`Exciter`] `X`.
///
/// It owns programme and law, or borrows them. Sixteen blocks take 2.6 KiB and a law 8 KiB, too much for a small stack, so firmware
/// keeps them in statics.
#[derive(Debug)]
// The fields of every tick come first, within the offset of a load. In the compiler's order a tick takes up to 40 instructions more
// or less, depending on the size of any field.
#[repr(C)]
pub struct RigController<const N: usize, X, L = RunningLaw<N>> {
    limits: Limits,
    reading: Reading,
    tick: u64,
    observer_config: ObserverConfig,
    exceeded: Exceeded,
    observer: Observer,
    correction_config: CorrectionConfig,
    correction: Correction,
    comparison: Comparison,
    guard: Guard,
    excitation: Excitation,
    temperature: Temperature,
    temperature_config: TemperatureConfig,
    approach: Approach,
    /// Whether the last tick had a reading, without a clear since.
    is_seen: bool,
    /// The next start keeps the learned correction.
    keeps: bool,
    exciter: X,
    law: L,
    health: HealthMonitor,
    health_config: HealthConfig,
}

impl<const B: usize, const N: usize, P, L> RigController<N, SineGenerator<B, P>, L>
where
    P: Borrow<Programme<B>>,
    L: BorrowMut<RunningLaw<N>>,
{
    /// Idle. Ticks run at the programme's rate. `programme` and `law` are either values or references.
    ///
    /// # Errors
    /// A setting that is not finite or out of range; a programme without blocks.
    pub fn new(
        settings: &RigSettings,
        wiring: &Wiring,
        programme: P,
        law: L,
    ) -> Result<Self, ConfigError> {
        let config = settings.at(programme.borrow().tick_rate())?;
        let generator = SineGenerator::new(programme)?;
        Ok(Self::with_exciter(&config, wiring, generator, law))
    }

    /// The programme.
    pub fn programme(&self) -> &Programme<B> {
        self.exciter.programme()
    }
}

impl<const N: usize, X, L> RigController<N, X, L>
where
    X: Exciter,
    L: BorrowMut<RunningLaw<N>>,
{
    /// [`RigController::new`] with any exciter in place of a programme's generator. Ticks run at the exciter's rate, which must be
    /// that of `config`.
    #[inline(always)]
    pub fn with_exciter(config: &RigConfig, wiring: &Wiring, exciter: X, law: L) -> Self {
        Self {
            health: HealthMonitor::new(
                &wiring.displacement,
                &wiring.force,
                config.limits.allowed(),
            ),
            guard: Guard::new(
                &wiring.command,
                config.stop_ticks,
                config.link_ticks,
                config.pace,
            ),
            limits: config.limits,
            observer_config: config.observer,
            correction_config: config.correction,
            health_config: config.health,
            exciter,
            law,
            observer: Observer::default(),
            correction: Correction::new(&config.correction),
            comparison: Comparison::default(),
            exceeded: Exceeded::default(),
            reading: Reading::default(),
            excitation: Excitation::default(),
            temperature: Temperature::default(),
            temperature_config: config.temperature,
            approach: Approach::default(),
            is_seen: false,
            keeps: false,
            tick: 0,
        }
    }

    /// The exciter, for example to give a [`super::Stream`] its knots. Other changes while running may demand a step.
    pub fn exciter(&mut self) -> &mut X {
        &mut self.exciter
    }

    /// The first event of each cause since [`RigController::clear_events`]. Neither a start nor a clear drops events.
    pub fn events(&self) -> &[Event] {
        self.health.events()
    }

    /// Drops all events; the present condition becomes the normal one.
    pub fn clear_events(&mut self) {
        self.health.clear();
    }

    /// Swaps the law at the end of this cycle, or at the start if not running; see [`RigController::law`]. Effects keep their state
    /// if they are of the same kinds in the same order. The health monitor learns the normal state again with the new law, and
    /// takes changes that begin with the swap as normal.
    ///
    /// The law is used as given. A law loaded from a pack has been checked for passivity. Check any other law with
    /// [`passivity::check`](crate::passivity::check) before.
    pub fn swap_law(&mut self, law: FastLaw<N>) {
        self.law.borrow_mut().swap(law);
    }

    /// [`RigController::swap_law`] with a law that `write` writes in place, so that it need not pass through the stack.
    ///
    /// # Errors
    /// The error of `write`; no law waits then, and the running one stays.
    pub fn swap_law_with<F>(
        &mut self,
        write: impl FnOnce(&mut FastLaw<N>) -> Result<(), F>,
    ) -> Result<(), F> {
        self.law.borrow_mut().swap_with(write)
    }

    /// [`RunningLaw::swap_in_slices`]: [`RigController::swap_law`] with a law that is written slice by slice, between ticks.
    ///
    /// # Errors
    /// The error of `write`; no law waits then, and the running one stays.
    pub fn swap_law_in_slices<T, F>(
        &mut self,
        write: impl FnOnce(&mut FastLaw<N>) -> Result<Option<T>, F>,
    ) -> Result<Option<T>, F> {
        self.law.borrow_mut().swap_in_slices(write)
    }

    /// The running law, as given.
    pub fn law(&self) -> &FastLaw<N> {
        self.law.borrow().law()
    }

    /// Whether a law waits for the end of this cycle.
    pub fn law_waits(&self) -> bool {
        self.law.borrow().is_waiting()
    }

    /// Adaptation to slow changes of the specimen: relative difference between the running law and the law as given.
    pub fn followed(&self) -> Adaptation {
        self.law.borrow().followed()
    }

    /// Sets the temperature for the law's effects, °C; 20 until set. A value that [`RigSettings::temperature_range`] or
    /// [`RigSettings::temperature_rate`] rules out is ignored, and reported as an event.
    pub fn set_temperature(&mut self, temperature: f32) {
        let moving = self.guard.is_running();
        self.temperature
            .show(&self.temperature_config, temperature, moving);
    }

    /// The next start keeps the amplitude correction learned so far. Without this call every start begins like the first one,
    /// because a correction learned with a bad sensor would drive the repaired rig too far.
    pub fn keep_correction(&mut self) {
        self.keeps = true;
    }

    /// Examines a change of a channel against the demand of this tick and the law's force of the one before. Stops for a lost
    /// sensor; for any other fault the rig continues.
    #[cold]
    #[inline(never)]
    fn look_at_channels(&mut self, changes: [Change; 2]) -> Option<Event> {
        let demand = self.excitation.displacement;
        let law = self.comparison.model_force();
        let lost = self.health.channels(&self.reading, &changes, demand, law);
        if let Some(channel) = lost {
            self.guard.trip(trip_of(channel));
        }
        self.health.take_fresh()
    }

    /// Takes a close look at this tick. If there is another event, its own `event` is reported later.
    #[cold]
    #[inline(never)]
    fn look(
        &mut self,
        motion: &Motion<f32>,
        model_force: f32,
        phase: u32,
        event: &mut Option<Event>,
    ) {
        let excitation = &self.excitation;
        let parts = if self.health_config.follows() {
            self.law.borrow().parts(motion)
        } else {
            [0.0; 3]
        };
        let look = Look {
            displacement: motion.displacement,
            velocity: motion.velocity,
            measured: self.reading.displacement.value,
            demand: (excitation.displacement, excitation.velocity),
            force: self.reading.force.value,
            law: model_force,
            parts,
            phase,
            ramp: excitation.ramp,
        };
        if !self.exciter.has_phase() {
            self.health.look_at_any(&look);
        } else if let Some(followed) = self.health.look(&self.health_config, &look) {
            self.law.borrow_mut().follow(followed);
        }
        if let Some(shown) = self.temperature.take_implausible() {
            let taken = self.temperature.taken();
            self.health.implausible_temperature(shown, taken);
        }
        if let Some(cause) = self.health.stops() {
            self.guard.trip(cause);
        }
        if event.is_none() && self.health.has_fresh() {
            *event = self.health.take_fresh();
        }
    }

    /// Reason not to start with the last tick's reading, if there was one.
    #[cold]
    #[inline(never)]
    fn unfit(&self) -> Option<TripCause> {
        if !self.is_seen {
            return None;
        }
        clipped(&self.reading).or_else(|| {
            let Reading {
                displacement,
                force,
                ..
            } = &self.reading;
            // NaN is within no limit.
            let is_near = displacement.value.abs() <= self.limits.tracking();
            let is_bearable = force.value.abs() <= self.limits.force();
            match (is_near, is_bearable) {
                (false, _) => Some(TripCause::TrackingLimit),
                (true, false) => Some(TripCause::ForceLimit),
                (true, true) => None,
            }
        })
    }

    /// Takes the piston's position at the start: from there it first goes to the exciter's start.
    #[cold]
    #[inline(never)]
    fn begin(&mut self) {
        // With a wrong reading the command jumps by the error. The jump is at most the limit of tracking; a larger one stops the
        // rig.
        let displacement = self.reading.displacement.value;
        let displacement = if displacement.abs() > self.limits.tracking() {
            0.0
        } else {
            displacement
        };
        let tolerance = APPROACHED * self.limits.displacement();
        self.approach
            .begin(displacement, tolerance, self.guard.stop_ticks());
    }

    /// A tick on the way to the exciter's start.
    #[cold]
    #[inline(never)]
    fn approach(&mut self) -> Excitation {
        if self.approach.is_due() {
            self.begin();
            if !self.approach.is_under_way() {
                return self.exciter.tick();
            }
        }
        let left = self.approach.tick();
        if self.exciter.waits() {
            if left == 0.0 {
                self.comparison = Comparison::default();
            }
            return Excitation {
                displacement: left,
                ramp: true,
                ..Excitation::default()
            };
        }
        let excitation = self.exciter.tick();
        Excitation {
            displacement: excitation.displacement + left,
            ..excitation
        }
    }

    /// The controller does not run: reports the fault that stopped it if it `was_running`, and events not yet reported.
    #[cold]
    #[inline(never)]
    fn attend(&mut self, was_running: bool, event: &mut Option<Event>) {
        if was_running && let State::Faulted(fault) = self.guard.state() {
            let growth = self.correction.growth();
            self.health.stopped(fault, &self.reading, growth);
        }
        if event.is_none() {
            *event = self.health.take_fresh();
        }
    }
}

impl<const N: usize, X, L> Controller for RigController<N, X, L>
where
    X: Exciter,
    L: BorrowMut<RunningLaw<N>>,
{
    /// Begins the programme or the motion from its start, once the piston is there. The piston goes there from its position within
    /// [`RigSettings::stop_ticks`], while a stream does not wait for it. Before the first tick, and between a clear and the next
    /// tick, the position is unknown: the servo takes the piston to 0, and the rig starts from the position of the first tick. The
    /// checks below are not made then, so run a tick before the start.
    ///
    /// A piston that is further away than [`RigSettings::tracking_limit`] gives [`TripCause::TrackingLimit`]: move it nearer by
    /// hand. A force beyond its limit, a channel at an end of its range and a way that begins beyond the command's range also stop
    /// the rig. The correction begins as at the first start, unless [`RigController::keep_correction`] was called.
    fn start(&mut self) -> Result<(), StartRefused> {
        self.guard.may_start()?;
        if let Some(cause) = self.unfit() {
            self.guard.trip(cause);
        }
        self.guard.start()?;
        self.exciter.restart();
        let law = self.law.borrow_mut();
        law.boundary();
        law.follow_nothing();
        law.rest();
        self.comparison = Comparison::default();
        self.exceeded = Exceeded::default();
        if core::mem::take(&mut self.keeps) {
            self.correction.restart();
        } else {
            self.correction = Correction::new(&self.correction_config);
        }
        self.health.restart();
        self.approach = Approach::DUE;
        if self.is_seen {
            // The output before the first tick is the piston's position.
            self.begin();
            let excitation = Excitation {
                displacement: self.approach.left(),
                ..Excitation::default()
            };
            self.guard.begin_at(self.correction.ahead(&excitation))?;
        }
        Ok(())
    }

    answered_by_guard!();

    fn clear(&mut self) -> Result<(), ClearRefused> {
        self.guard.clear()?;
        // A reading from before the part was set up again is not valid.
        self.is_seen = false;
        Ok(())
    }

    #[inline]
    fn tick(&mut self, reading: Option<Reading>, clock: u32) -> Telemetry {
        self.tick = self.tick.wrapping_add(1);
        let was_running = self.guard.is_running();
        self.guard.pace(clock, self.tick);
        self.guard.watch_link();
        let last = [self.reading.displacement.code, self.reading.force.code];
        self.is_seen = reading.is_some();
        self.guard.take(reading, &mut self.reading);
        let displacement = self.reading.displacement.value;
        let measured_force = self.reading.force.value;
        // The cycle that ends with this tick belongs to the block before it.
        let before = self.excitation;
        let mut event = None;
        if self.guard.is_running() {
            self.excitation = if self.approach.is_under_way() {
                self.approach()
            } else {
                self.exciter.tick()
            };
            if let Some(cause) = self.exciter.refusal() {
                self.guard.trip(cause);
            }
            if MONITORED {
                let changes = self.health.samples(last, &self.reading);
                if changes.iter().any(Change::asks) {
                    event = self.look_at_channels(changes);
                }
            }
        } else {
            // Standing still, for the observer.
            self.excitation.acceleration = 0.0;
            self.excitation.cycle_end = false;
        }
        let excitation = self.excitation;
        let another_law = excitation.cycle_end && self.law.borrow_mut().boundary();
        let estimate =
            self.observer
                .update(&self.observer_config, displacement, excitation.acceleration);
        let motion = Motion {
            displacement: estimate.displacement,
            velocity: estimate.velocity,
            acceleration: estimate.acceleration,
            cycles: excitation.cycle as f32 + excitation.phase as f32 * (1.0 / (1u64 << 32) as f32),
            temperature: self.temperature.tick(&self.temperature_config),
            controls: self.reading.controls,
        };
        let model_force = self.law.borrow_mut().force(&motion);
        if !model_force.is_finite() {
            self.guard.trip(TripCause::NotFinite);
        }
        let mut command = 0.0;
        let mut report = None;
        if self.guard.is_running() {
            let error = displacement - excitation.displacement;
            if let Some(fault) =
                self.limits
                    .check(&mut self.exceeded, displacement, measured_force, error)
            {
                self.guard.trip(fault);
            }
            let ticks = self.correction.ticks();
            if excitation.cycle_end
                && let Err(fault) = self.correction.boundary(&self.correction_config)
            {
                self.guard.trip(fault);
            }
            command = self
                .correction
                .command(&self.correction_config, &excitation, displacement);
            report = self.comparison.update(
                measured_force,
                model_force,
                excitation.cycle_end,
                |accumulator, forces| {
                    accumulator.update(estimate.displacement, forces, excitation.phase)
                },
            );
            if MONITORED && excitation.cycle_end {
                self.health.cycle(Ended {
                    block: before.block,
                    temperature: self.temperature.taken(),
                    ticks,
                    command: self.correction.mean_command(),
                    another_law,
                    steady: report.as_ref().filter(|_| !before.ramp).map(
                        |([measured, model], _)| Steady {
                            energy: measured.energy,
                            law_energy: model.energy,
                            mean: measured.mean_force - model.mean_force,
                        },
                    ),
                });
            }
            // A motion without cycles is looked at as often as one with 1024 ticks per cycle.
            let phase = if self.exciter.has_phase() {
                excitation.phase
            } else {
                (self.tick as u32) << 22
            };
            if MONITORED && self.health.is_due(phase) {
                self.look(&motion, model_force, phase, &mut event);
            }
            if excitation.done {
                self.guard.finish();
            }
        }
        if !self.guard.is_running() {
            self.attend(was_running, &mut event);
        }
        self.guard.command(command);
        Telemetry {
            tick: self.tick,
            displacement,
            velocity: estimate.velocity,
            measured_force,
            controls: self.reading.controls,
            model_force,
            command: self.guard.driven(),
            block: excitation.block,
            cycle: excitation.cycle,
            phase: excitation.phase,
            ramp: excitation.ramp,
            state: self.guard.state(),
            report: report.map(|results| {
                CycleReport::new(
                    results,
                    before.block,
                    excitation.cycle,
                    before.ramp,
                    self.health.followed(),
                )
            }),
            event,
        }
    }
}
