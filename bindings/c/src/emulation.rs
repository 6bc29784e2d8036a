//! The damper emulation: measured motion in, the law's force out.

use mesh_damper::rig::{Controller as _, DamperEmulationSettings, EmulationController};

use crate::converter::{self, Reading, Wiring};
use crate::error::{Error, Problem, answer, code};
use crate::law::{Law, SharedLaw};
use crate::storage::{self, Storage, assert_fits, held, initialize};
use crate::telemetry::Telemetry;

/// Bytes of `md_emulation`.
#[cfg(target_pointer_width = "32")]
pub const MD_EMULATION_SIZE: usize = 584;
/// Bytes of `md_emulation`.
#[cfg(target_pointer_width = "64")]
pub const MD_EMULATION_SIZE: usize = 584;
/// Alignment of `md_emulation`, bytes.
pub const MD_EMULATION_ALIGN: usize = 8;

/// Memory of a damper emulation: it is the damper, and drives the law's force for the displacement that it measures. It does no I/O:
/// each tick takes a reading, and its telemetry has the command and the level of the enable line.
#[repr(C, align(8))]
pub struct Emulation {
    storage: [u8; MD_EMULATION_SIZE],
}

// SAFETY: the assertion below.
unsafe impl Storage for Emulation {
    type Inner = EmulationController<SharedLaw>;
    const TAG: u32 = u32::from_le_bytes(*b"emu1");
}
const _: () = assert_fits::<Emulation>();

/// What a damper emulation is set to. Begin with `md_emulation_defaults`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmulationSettings {
    /// Hz, 1...1e6.
    pub tick_rate: f64,
    /// Largest measured displacement in either direction, mm, 1e-6...1e4.
    pub displacement_limit: f64,
    /// Largest force in either direction, kN, 1e-6...1e9: of the law, at once, and as measured.
    pub force_limit: f64,
    /// For how many ticks on end a measured quantity must exceed its limit to stop, 1...1e6.
    pub trip_ticks: u32,
    /// In how many ticks the force comes in once started, and goes to 0 once stopped, 1...1e7.
    pub stop_ticks: u32,
    /// After how many ticks without `md_emulation_exchange` it stops, 0...1e7; 0 where nobody is linked.
    pub link_ticks: u32,
    /// Rate of the counter whose reading each tick is given, Hz: 0, or the tick rate to 4e9 and to 2e9 times the tick rate. At 0 it
    /// counts the ticks of the timer, one each. A clock that is independent of the timer also finds a timer at a wrong rate.
    pub clock_rate: f64,
    /// Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3...3.
    pub observer_damping: f64,
    /// Half width of the band in which a displacement is at rest that has stayed there for 0.05 s, mm, 0...1e4; 0 where nothing is rest.
    pub rest_band: f64,
    /// After how many ticks of the very same code the displacement channel is stuck, 0...1e9; 0 where it has no noise at all.
    pub stuck_ticks: u32,
    /// Coldest that a measured temperature can be, degrees Celsius, -273...2000.
    pub temperature_coldest: f64,
    /// Hottest that it can be.
    pub temperature_hottest: f64,
    /// Fastest that it can change, degrees a second, 1e-3...1e3.
    pub temperature_rate: f64,
    /// How far the displacement must go from its mean for a cycle to count, mm, 1e-9...1e4.
    pub hysteresis: f64,
}

/// Settings for amplitudes of 0.02 to 0.3 mm up to 10 Hz, at 10 kHz. Returns MD_ERROR_NONE, MD_ERROR_NULL or MD_ERROR_MISALIGNED.
///
/// # Safety
/// `settings` is null or points to writable memory for them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_defaults(settings: *mut EmulationSettings) -> Error {
    let defaults = EmulationSettings::from(&DamperEmulationSettings::default());
    // SAFETY: as the caller vouches.
    code(unsafe { storage::write(settings, defaults) })
}

impl From<&DamperEmulationSettings> for EmulationSettings {
    fn from(settings: &DamperEmulationSettings) -> Self {
        let [temperature_coldest, temperature_hottest] = settings.temperature_range;
        Self {
            tick_rate: settings.tick_rate,
            displacement_limit: settings.displacement_limit,
            force_limit: settings.force_limit,
            trip_ticks: settings.trip_ticks,
            stop_ticks: settings.stop_ticks,
            link_ticks: settings.link_ticks,
            clock_rate: settings.clock_rate,
            observer_bandwidth: settings.observer_bandwidth,
            observer_damping: settings.observer_damping,
            rest_band: settings.rest_band,
            stuck_ticks: settings.stuck_ticks,
            temperature_coldest,
            temperature_hottest,
            temperature_rate: settings.temperature_rate,
            hysteresis: settings.hysteresis,
        }
    }
}

impl From<&EmulationSettings> for DamperEmulationSettings {
    fn from(settings: &EmulationSettings) -> Self {
        Self {
            tick_rate: settings.tick_rate,
            displacement_limit: settings.displacement_limit,
            force_limit: settings.force_limit,
            trip_ticks: settings.trip_ticks,
            stop_ticks: settings.stop_ticks,
            link_ticks: settings.link_ticks,
            clock_rate: settings.clock_rate,
            observer_bandwidth: settings.observer_bandwidth,
            observer_damping: settings.observer_damping,
            rest_band: settings.rest_band,
            stuck_ticks: settings.stuck_ticks,
            temperature_range: [settings.temperature_coldest, settings.temperature_hottest],
            temperature_rate: settings.temperature_rate,
            hysteresis: settings.hysteresis,
        }
    }
}

/// An idle emulation.
///
/// * `wiring`: scales of displacement, force and command (kN), each initialised
/// * `law`: initialised; it stays where it is as long as `emulation` is used. `md_law_load` between two ticks gives another law, which
///   takes over at the end of a cycle.
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE or
/// MD_ERROR_OUT_OF_RANGE.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_init(
    emulation: *mut Emulation,
    settings: *const EmulationSettings,
    wiring: *const Wiring,
    law: *mut Law,
    problem: *mut Problem,
) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        let make = || {
            let settings = storage::read(settings)?.into();
            let wiring = converter::wiring(wiring)?;
            Ok(EmulationController::new(
                &settings,
                &wiring,
                SharedLaw::of(law)?,
            )?)
        };
        answer(initialize(emulation, make), problem)
    }
}

/// Begins to drive the law's force, which comes in over `stop_ticks`.
///
/// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_start(
    emulation: *mut Emulation,
    problem: *mut Problem,
) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        let started = held(emulation)
            .map_err(Problem::from)
            .and_then(|emulation| Ok(emulation.start()?));
        answer(started, problem)
    }
}

/// Stops without a trip. Set the enable line low then: otherwise it stays high until the next tick, which says so. Returns as
/// `md_emulation_start` where memory is not right.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_stop(emulation: *mut Emulation) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.stop()))
}

/// Forgets the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT or MD_ERROR_MOVING, and as
/// `md_emulation_start` where memory is not right; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_clear(
    emulation: *mut Emulation,
    problem: *mut Problem,
) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        let cleared = held(emulation)
            .map_err(Problem::from)
            .and_then(|emulation| Ok(emulation.clear()?));
        answer(cleared, problem)
    }
}

/// One tick, at the tick rate. Set the enable line to `telemetry->enabled` and drive `telemetry->command` (kN) then.
///
/// * `reading`: null where the sensors failed, which stops it
/// * `clock`: what a counter reads that runs freely at `clock_rate` and wraps. Less than half a tick or more than one and a half since
///   the tick before trips: a stall, a tick that is missing or called twice.
/// * `telemetry`: gets what it saw
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or MD_ERROR_NOT_INITIALIZED: set the line low then.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_tick(
    emulation: *mut Emulation,
    reading: *const Reading,
    clock: u32,
    telemetry: *mut Telemetry,
) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        code(held(emulation).and_then(|emulation| {
            let reading = if reading.is_null() {
                None
            } else {
                Some(storage::read(reading)?.of_crate())
            };
            storage::write(telemetry, Telemetry::from(&emulation.tick(reading, clock)))
        }))
    }
}

/// The actuator did not take the command of the last tick: it trips. Set the enable line low then: otherwise it stays high until the
/// next tick, which says so. Returns as `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_command_failed(emulation: *mut Emulation) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.command_failed()))
}

/// What the actuator drives, as it is read back, is not the command: it trips. Set the enable line low then: otherwise it stays high
/// until the next tick, which says so. Returns as `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_command_unverified(emulation: *mut Emulation) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.command_unverified()))
}

/// The enable line could not be set: it trips. Try to set it low then, and again at the next tick: it may still be high. Returns as
/// `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_enable_failed(emulation: *mut Emulation) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.enable_failed()))
}

/// A tick came late, or not at all: it trips. Set the enable line low then: otherwise it stays high until the next tick, which says so.
/// Returns as `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_overrun(emulation: *mut Emulation) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.overrun()))
}

/// An input outside of the emulation says stop: it trips in any state without a trip. Set the enable line low then: otherwise it stays
/// high until the next tick, which says so. Ask the input before each start and clear too. Returns as `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_external_trip(emulation: *mut Emulation) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.external_trip()))
}

/// Whoever is at the other end of a link was heard: call it as often as that is so. Returns as `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_exchange(emulation: *mut Emulation) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.exchange()))
}

/// Temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns as `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_set_temperature(
    emulation: *mut Emulation,
    temperature: f32,
) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(emulation) }.map(|emulation| emulation.set_temperature(temperature)))
}

/// Ticks so far that did not come in time, in every state; a clear leaves them. It wraps. Where it has gone up with a tick, give an external
/// watchdog no signal. 0 of no emulation.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_late_ticks(emulation: *mut Emulation) -> u32 {
    // SAFETY: as the caller vouches.
    unsafe { held(emulation) }.map_or(0, |emulation| emulation.late_ticks())
}
