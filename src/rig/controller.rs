//! The interface of every controller, for any caller.

use super::Telemetry;
use super::io::Reading;
use super::refusal::{ClearRefused, StartRefused};
use super::state::State;

/// A controller without I/O: once per tick it takes a [`Reading`], and returns a [`Command`](super::Command) in its telemetry.
///
/// [`super::Blocking`] calls a controller between the [`super::Sensors`] and the [`super::Actuator`] that it owns. If your readings
/// and commands go another way, by DMA, through other tasks or over a link, call the controller yourself, in this order:
///
/// 1. [`Controller::tick`] with the tick's reading, then [`Telemetry::to_drive`] of its result;
/// 2. set the enable line to [`Command::enabled`](super::Command::enabled), then the actuator to
///    [`Command::value`](super::Command::value);
/// 3. if that failed, call [`Controller::enable_failed`] or [`Controller::command_failed`], and set the enable line low;
/// 4. every [`super::VERIFY_TICKS`] ticks read back the line's level and the output; if one is wrong, call
///    [`Controller::enable_failed`] or [`Controller::command_unverified`], and set the enable line low;
/// 5. if nothing failed and [`Controller::late_ticks`] is as before the tick, give an external watchdog's signal.
///
/// [`Controller::start`] takes effect with the next tick. So do [`Controller::stop`], [`Controller::overrun`] and
/// [`Controller::external_trip`]; if you cannot wait for it, set the line low. Read a stop input before each tick, start
/// and clear.
///
/// # Example
/// An ADC with 12 bits writes its two channels into a buffer by DMA, whose interrupt is the tick. Another DMA transfers the next
/// value to the timer of a pulse-width modulator.
///
/// ```
/// use mesh_damper::converter::Scale;
/// use mesh_damper::effects::CONTROLS;
/// use mesh_damper::error::ConfigError;
/// use mesh_damper::rig::{Controller, DamperEmulationSettings, EmulationController, Reading, Wiring};
/// # use mesh_damper::amplitude_independent;
/// # use mesh_damper::fast_law::RunningLaw;
///
/// /// The interrupt: takes the codes that the ADC wrote, and gives the level of the enable pin and the value of the modulator.
/// /// `clock` is the count of a free-running timer.
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
/// // 1 MHz: 100 counts per tick at 10 kHz.
/// let settings = DamperEmulationSettings { clock_rate: 1e6, ..Default::default() };
/// let mut damper = EmulationController::new(&settings, &wiring, law)?;
/// damper.start().expect("it is at rest");
/// // 0x800 is 0 mm and 0 kN, and 0x8000 drives no force.
/// assert_eq!(on_samples(&mut damper, &wiring, [0x800, 0x800], 17), (0x8000, true));
/// assert_eq!(on_samples(&mut damper, &wiring, [0x800, 0x800], 117), (0x8000, true));
/// // A channel at the end of its range stops it in that very tick, and so does a late tick.
/// assert_eq!(on_samples(&mut damper, &wiring, [0xFFF, 0x800], 217), (0x8000, false));
/// # Ok::<(), ConfigError>(())
/// ```
pub trait Controller {
    /// Starts from the beginning.
    ///
    /// # Errors
    /// Why it does not start. It continues as before, or trips if it must not start.
    fn start(&mut self) -> Result<(), StartRefused>;

    /// Stops without a trip cause. A controller that does not run continues as before.
    fn stop(&mut self);

    /// Whether [`Controller::clear`] would succeed now, for callers with work to do before the fault is cleared.
    ///
    /// # Errors
    /// Why it would be refused.
    fn may_clear(&self) -> Result<(), ClearRefused>;

    /// Clears the trip.
    ///
    /// # Errors
    /// Why it does not. It continues as before.
    fn clear(&mut self) -> Result<(), ClearRefused>;

    /// The other end of the link was heard: call it each time.
    fn exchange(&mut self);

    /// The owner of the timer has found a tick late or missing: trips with [`super::TripCause::TickOverrun`].
    fn overrun(&mut self);

    /// An external stop input is active: trips with [`super::TripCause::External`], in any state except [`State::Faulted`], also at rest.
    fn external_trip(&mut self);

    /// Ticks since construction that were not in time, as [`Controller::tick`] finds them; wraps. They are counted in every state,
    /// and a clear keeps the count.
    fn late_ticks(&self) -> u32;

    /// Runs one tick: see [`super`] for its deadline. `reading` is `None` if the sensors failed: the controller then trips, and
    /// continues with the last reading.
    ///
    /// `clock` is the reading of a free-running counter at this tick, which wraps at 2³², at
    /// [`clock_rate`](super::RigSettings::clock_rate): for example a second timer, or a count of the tick timer's periods that
    /// hardware makes. A variable that the tick itself increments shows no missing tick. If less than half a tick or more than one
    /// and a half has passed since the tick before, a running controller trips with [`super::TripCause::TickOverrun`]. This happens
    /// after a stall, for a tick that is missing or called twice, and, if the clock is independent, with a timer at a wrong rate.
    /// The first tick after construction is not checked. Ticks continue at rest too.
    fn tick(&mut self, reading: Option<Reading>, clock: u32) -> Telemetry;

    /// The actuator did not accept the command of the last tick: trips with [`super::TripCause::DacBus`], and assumes that the
    /// output is still the command before.
    fn command_failed(&mut self);

    /// The output as read back is not the command: trips with [`super::TripCause::DacBus`]. A command on its way back to 0
    /// continues.
    fn command_unverified(&mut self);

    /// The enable line could not be set, or reads back at another level: trips with [`super::TripCause::EnableLine`].
    fn enable_failed(&mut self);

    /// State of the controller.
    fn state(&self) -> State;

    /// Present output of the actuator: mm, or kN in a damper emulation.
    fn driven(&self) -> f32;
}

/// For a borrowed controller: firmware builds a controller in its final place, and its caller next to it.
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
