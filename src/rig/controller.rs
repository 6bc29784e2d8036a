//! What every controller does, whoever calls it and from where.

use super::Telemetry;
use super::io::Reading;
use super::refusal::{ClearRefused, StartRefused};
use super::state::State;

/// A controller without I/O: a [`Reading`] goes in, a [`Command`](super::Command) comes out in its telemetry, once per tick.
///
/// [`super::Blocking`] calls one between the [`super::Sensors`] and the [`super::Actuator`] that it owns. Who has readings and
/// takes commands in another way, by DMA, from other tasks or over a link, calls it himself, in this order:
///
/// 1. [`Controller::tick`] with the tick's reading, and [`Telemetry::to_drive`] of what it returns;
/// 2. the enable line to [`Command::enabled`](super::Command::enabled), then the actuator to
///    [`Command::value`](super::Command::value);
/// 3. [`Controller::enable_failed`] or [`Controller::command_failed`] where that failed, and the enable line low;
/// 4. [`Controller::enable_failed`] or [`Controller::command_unverified`] where the line's level or what is driven, read back every
///    [`super::VERIFY_TICKS`] ticks, is not as it should be, and the enable line low;
/// 5. an external watchdog's signal, where all of this was done without a failure and [`Controller::late_ticks`] is as it was before
///    the tick.
///
/// [`Controller::start`] has effect with the next tick. So have [`Controller::stop`], [`Controller::overrun`] and
/// [`Controller::external_trip`]: who cannot wait for it sets the line low. An input that says stop is asked before each tick, start
/// and clear.
///
/// # Example
/// An ADC with 12 bits writes its two channels into a buffer by DMA, whose interrupt is the tick. Another DMA takes what the
/// timer of a pulse-width modulator is to have.
///
/// ```
/// use mesh_damper::converter::Scale;
/// use mesh_damper::effects::CONTROLS;
/// use mesh_damper::error::ConfigError;
/// use mesh_damper::rig::{Controller, DamperEmulationSettings, EmulationController, Reading, Wiring};
/// # use mesh_damper::amplitude_independent;
/// # use mesh_damper::fast_law::RunningLaw;
///
/// /// The interrupt: what the ADC wrote goes in, and what the modulator and the enable pin are to have comes out. `clock` is the
/// /// count of a timer that runs freely.
/// fn on_samples(damper: &mut impl Controller, wiring: &Wiring, samples: [u16; 2], clock: u32) -> (u16, bool) {
///     let [displacement, force] = samples;
///     let reading = Reading {
///         displacement: wiring.displacement.decode_narrow::<12>(displacement),
///         force: wiring.force.decode_narrow::<12>(force),
///         controls: [0.0; CONTROLS],
///     };
///     let seen = damper.tick(Some(reading), clock);
///     let command = seen.to_drive();
///     (wiring.command.encode(command.value).code, command.enabled)
/// }
///
/// let force = Scale::new(5.0, 0.0)?;
/// let wiring = Wiring { displacement: Scale::new(0.5, 0.0)?, force, command: force };
/// # let law = RunningLaw::new(amplitude_independent::law(3.0)?);
/// // 1 MHz: 100 counts to each tick of 10 kHz.
/// let settings = DamperEmulationSettings { clock_rate: 1e6, ..Default::default() };
/// let mut damper = EmulationController::new(&settings, &wiring, law)?;
/// damper.start().expect("it is at rest");
/// // 0x800 is 0 mm and 0 kN, and 0x8000 drives no force.
/// assert_eq!(on_samples(&mut damper, &wiring, [0x800, 0x800], 17), (0x8000, true));
/// assert_eq!(on_samples(&mut damper, &wiring, [0x800, 0x800], 117), (0x8000, true));
/// // A channel at its end stops it in that very tick, as a tick that comes late does.
/// assert_eq!(on_samples(&mut damper, &wiring, [0xFFF, 0x800], 217), (0x8000, false));
/// # Ok::<(), ConfigError>(())
/// ```
pub trait Controller {
    /// Begins from the start.
    ///
    /// # Errors
    /// Why it does not. It goes on as before.
    fn start(&mut self) -> Result<(), StartRefused>;

    /// Stops without a fault.
    fn stop(&mut self);

    /// Whether [`Controller::clear`] would be done now: who has something to do before the fault is forgotten asks.
    ///
    /// # Errors
    /// Why it would not.
    fn may_clear(&self) -> Result<(), ClearRefused>;

    /// Forgets the fault.
    ///
    /// # Errors
    /// Why it does not. It goes on as before.
    fn clear(&mut self) -> Result<(), ClearRefused>;

    /// Whoever is at the other end of the link has been heard: to be called as often as that is so.
    fn exchange(&mut self);

    /// A tick came late, or not at all, as whoever owns the timer sees: stops with [`super::TripCause::TickOverrun`].
    fn overrun(&mut self);

    /// An input outside of this controller says stop: stops with [`super::TripCause::External`], in any state without a fault, also
    /// at rest.
    fn external_trip(&mut self);

    /// Ticks since construction that did not come in time, as [`Controller::tick`] finds them; wraps. They are counted in every
    /// state, and a clear leaves them.
    fn late_ticks(&self) -> u32;

    /// One tick: see [`super`] for its deadline. `reading` is none where the sensors failed: it stops then, and goes on with the
    /// last reading.
    ///
    /// `clock` is what a counter reads at this tick that runs freely and wraps at 2³², at
    /// [`clock_rate`](super::RigSettings::clock_rate): cycles of the processor, say, or the ticks that the timer has given. Where
    /// less than half a tick or more than one and a half has passed since the tick before, a controller that runs stops with
    /// [`super::TripCause::TickOverrun`]: after a stall, a tick that is missing or called twice, and, by a clock of its own, with a
    /// timer at a wrong rate. The first tick after construction is not judged. Ticks go on at rest too.
    fn tick(&mut self, reading: Option<Reading>, clock: u32) -> Telemetry;

    /// The actuator did not take the command of the last tick: stops with [`super::TripCause::DacBus`], and takes the command
    /// before as what is driven.
    fn command_failed(&mut self);

    /// What the actuator drives, as it is read back, is not the command: stops with [`super::TripCause::DacBus`]. Where the command
    /// is on its way back to 0, it goes on.
    fn command_unverified(&mut self);

    /// The enable line could not be set, or is at another level as it reads back: stops with [`super::TripCause::EnableLine`].
    fn enable_failed(&mut self);

    /// What it is doing.
    fn state(&self) -> State;

    /// What the actuator drives: mm, or kN of a damper emulation.
    fn driven(&self) -> f32;
}

/// Borrowed: firmware builds a controller where it stays, and what calls it beside it.
impl<C: Controller> Controller for &mut C {
    #[inline(always)]
    fn start(&mut self) -> Result<(), StartRefused> {
        C::start(self)
    }

    #[inline(always)]
    fn stop(&mut self) {
        C::stop(self);
    }

    #[inline(always)]
    fn may_clear(&self) -> Result<(), ClearRefused> {
        C::may_clear(self)
    }

    #[inline(always)]
    fn clear(&mut self) -> Result<(), ClearRefused> {
        C::clear(self)
    }

    #[inline(always)]
    fn exchange(&mut self) {
        C::exchange(self);
    }

    #[inline(always)]
    fn overrun(&mut self) {
        C::overrun(self);
    }

    #[inline(always)]
    fn external_trip(&mut self) {
        C::external_trip(self);
    }

    #[inline(always)]
    fn late_ticks(&self) -> u32 {
        C::late_ticks(self)
    }

    #[inline(always)]
    fn tick(&mut self, reading: Option<Reading>, clock: u32) -> Telemetry {
        C::tick(self, reading, clock)
    }

    #[inline(always)]
    fn command_failed(&mut self) {
        C::command_failed(self);
    }

    #[inline(always)]
    fn command_unverified(&mut self) {
        C::command_unverified(self);
    }

    #[inline(always)]
    fn enable_failed(&mut self) {
        C::enable_failed(self);
    }

    #[inline(always)]
    fn state(&self) -> State {
        C::state(self)
    }

    #[inline(always)]
    fn driven(&self) -> f32 {
        C::driven(self)
    }
}
