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
/// 3. [`Controller::enable_failed`] or [`Controller::command_failed`] where that failed, and the enable line low.
///
/// [`Controller::start`] has effect with the next tick. So have [`Controller::stop`] and [`Controller::overrun`]: who cannot wait
/// for it sets the line low.
///
/// # Example
/// An ADC with 12 bits writes its two channels into a buffer by DMA, whose interrupt is the tick. Another DMA takes what the
/// timer of a pulse-width modulator is to have.
///
/// ```
/// use mesh_damper::converter::Scale;
/// use mesh_damper::effects::CONTROLS;
/// use mesh_damper::error::ConfigError;
/// use mesh_damper::rig::{Controller, EmulationController, Reading, Wiring};
/// # use mesh_damper::amplitude_independent;
/// # use mesh_damper::fast_law::RunningLaw;
/// # use mesh_damper::rig::DamperEmulationSettings;
///
/// /// The interrupt: what the ADC wrote goes in, and what the modulator and the enable pin are to have comes out.
/// fn on_samples(damper: &mut impl Controller, wiring: &Wiring, samples: [u16; 2]) -> (u16, bool) {
///     let [displacement, force] = samples;
///     let seen = damper.tick(Some(Reading {
///         displacement: wiring.displacement.decode_narrow::<12>(displacement),
///         force: wiring.force.decode_narrow::<12>(force),
///         controls: [0.0; CONTROLS],
///     }));
///     let command = seen.to_drive();
///     (wiring.command.encode(command.value).code, command.enabled)
/// }
///
/// let force = Scale::new(5.0, 0.0)?;
/// let wiring = Wiring { displacement: Scale::new(0.5, 0.0)?, force, command: force };
/// # let law = RunningLaw::new(amplitude_independent::law(3.0)?);
/// # let settings = DamperEmulationSettings::default();
/// let mut damper = EmulationController::new(&settings, &wiring, law)?;
/// damper.start().expect("it is at rest");
/// // 0x800 is 0 mm and 0 kN, and 0x8000 drives no force.
/// assert_eq!(on_samples(&mut damper, &wiring, [0x800, 0x800]), (0x8000, true));
/// // A channel at its end stops it in that very tick.
/// assert_eq!(on_samples(&mut damper, &wiring, [0xFFF, 0x800]), (0x8000, false));
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

    /// Forgets the fault.
    ///
    /// # Errors
    /// Why it does not. It goes on as before.
    fn clear(&mut self) -> Result<(), ClearRefused>;

    /// Whoever is at the other end of the link has been heard: to be called as often as that is so.
    fn exchange(&mut self);

    /// A tick came late, or not at all, as whoever owns the timer sees: stops with [`super::TripCause::TickOverrun`].
    fn overrun(&mut self);

    /// One tick: see [`super`] for its deadline. `reading` is none where the sensors failed: it stops then, and goes on with the
    /// last reading.
    fn tick(&mut self, reading: Option<Reading>) -> Telemetry;

    /// The actuator did not take the command of the last tick: stops with [`super::TripCause::DacBus`], and takes the command
    /// before as what is driven.
    fn command_failed(&mut self);

    /// The enable line could not be set: stops with [`super::TripCause::EnableLine`].
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
    fn tick(&mut self, reading: Option<Reading>) -> Telemetry {
        C::tick(self, reading)
    }

    #[inline(always)]
    fn command_failed(&mut self) {
        C::command_failed(self);
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
