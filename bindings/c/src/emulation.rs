//! The damper emulation: measured motion in, force of the law out.

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

/// Memory of a damper emulation. It replaces the damper: it drives the law's force for the displacement that it measures. It does
/// no I/O. Each tick takes a reading, and the telemetry contains the command and the level of the enable line.
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

/// Settings of a damper emulation. Begin with `md_emulation_defaults`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmulationSettings {
    /// Tick rate, Hz, 1...1e6.
    pub tick_rate: f64,
    /// Largest measured displacement in either direction, mm, 1e-6...1e4.
    pub displacement_limit: f64,
    /// Largest force in either direction, kN, 1e-6...1e9. A force of the law beyond it stops at once, a measured one after
    /// `trip_ticks`.
    pub force_limit: f64,
    /// Number of ticks beyond the limit of a measured quantity until the trip, 1...1e6. A tick within takes back an eighth of one.
    pub trip_ticks: u32,
    /// Number of ticks in which the force rises to its full value after a start, and goes to 0 after a stop or a trip, 1...1e7.
    pub stop_ticks: u32,
    /// Number of ticks without `md_emulation_exchange` after which it trips, 0...1e7; 0 without a link.
    pub link_ticks: u32,
    /// Rate of the clock whose reading is given at each tick, Hz: 0, or from the tick rate to the smaller of 4e9 and 2e9 times the
    /// tick rate. At 0 it counts the ticks of the timer, one each. A clock independent of the timer also detects a timer with a
    /// wrong rate.
    pub clock_rate: f64,
    /// Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3...3.
    pub observer_damping: f64,
    /// Half width of the rest band, mm, 0...1e4. A displacement that has stayed in the band for 0.05 s is at rest. 0 switches this
    /// off.
    pub rest_band: f64,
    /// Number of ticks with an unchanged code after which the displacement channel is stuck, 0...1e9; 0 for a channel without
    /// noise.
    pub stuck_ticks: u32,
    /// Lowest plausible measured temperature, degrees Celsius, -273...2000.
    pub temperature_coldest: f64,
    /// Highest plausible measured temperature, degrees Celsius.
    pub temperature_hottest: f64,
    /// Fastest plausible change of the temperature, degrees Celsius per second, 1e-3...1e3.
    pub temperature_rate: f64,
    /// Smallest deviation of the displacement from its mean for a cycle to count, mm, 1e-9...1e4.
    pub hysteresis: f64,
}

/// Default settings, for amplitudes of 0.02 to 0.3 mm up to 10 Hz, at 10 kHz. Returns MD_ERROR_NONE, MD_ERROR_NULL or
/// MD_ERROR_MISALIGNED.
///
/// # Safety
/// `settings` is null or points to writable memory for them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_defaults(settings: *mut EmulationSettings) -> Error {
    let defaults = EmulationSettings::from(&DamperEmulationSettings::default());
    // SAFETY: guaranteed by the caller.
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

/// Initialises an idle emulation.
///
/// * `wiring`: scales of displacement, force and command (kN), each initialised
/// * `law`: initialised. It must stay in place while `emulation` is used. `md_law_load` between two ticks loads another law, which
///   takes over at the end of a cycle.
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE or
/// MD_ERROR_OUT_OF_RANGE.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_init(
    emulation: *mut Emulation,
    settings: *const EmulationSettings,
    wiring: *const Wiring,
    law: *mut Law,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
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

/// Starts driving the law's force, which rises over `stop_ticks`.
///
/// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_start(
    emulation: *mut Emulation,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let started = held(emulation)
            .map_err(Problem::from)
            .and_then(|emulation| Ok(emulation.start()?));
        answer(started, problem)
    }
}

/// Stops without a trip. Then set the enable line low: otherwise it stays high until the next tick, whose telemetry reports it.
/// Returns the codes of `md_emulation_start` for invalid memory.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_stop(emulation: *mut Emulation) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.stop()))
}

/// Clears the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT or MD_ERROR_MOVING, and the codes of
/// `md_emulation_start` for invalid memory; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_clear(
    emulation: *mut Emulation,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let cleared = held(emulation)
            .map_err(Problem::from)
            .and_then(|emulation| Ok(emulation.clear()?));
        answer(cleared, problem)
    }
}

/// Processes one tick, at the tick rate. Then set the enable line to `telemetry->enabled` and drive `telemetry->command` (kN).
///
/// * `reading`: null if the sensors failed, which stops the emulation
/// * `clock`: reading of a counter that runs freely at `clock_rate` and wraps. A time since the tick before of less than half a
///   tick or more than one and a half trips: a stall, a missing tick, or a tick called twice.
/// * `telemetry`: receives the telemetry of this tick
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or MD_ERROR_NOT_INITIALIZED. Set the line low if it is not
/// MD_ERROR_NONE.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_tick(
    emulation: *mut Emulation,
    reading: *const Reading,
    clock: u32,
    telemetry: *mut Telemetry,
) -> Error {
    // SAFETY: guaranteed by the caller.
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

/// Reports that the actuator did not accept the command of the last tick: the emulation trips. Then set the enable line low:
/// otherwise it stays high until the next tick, whose telemetry reports it. Returns the codes of `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_command_failed(emulation: *mut Emulation) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.command_failed()))
}

/// Reports that the actuator's output, as read back, differs from the command: the emulation trips. Then set the enable line low:
/// otherwise it stays high until the next tick, whose telemetry reports it. Returns the codes of `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_command_unverified(emulation: *mut Emulation) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.command_unverified()))
}

/// Reports that the enable line could not be set: the emulation trips. Try to set it low now, and again at the next tick: it may
/// still be high. Returns the codes of `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_enable_failed(emulation: *mut Emulation) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.enable_failed()))
}

/// Reports that a tick was late or missing: the emulation trips. Then set the enable line low: otherwise it stays high until the
/// next tick, whose telemetry reports it. Returns the codes of `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_overrun(emulation: *mut Emulation) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.overrun()))
}

/// Reports that an external stop input is active: the emulation trips, unless it has tripped already. Then set the enable
/// line low: otherwise it stays high until the next tick, whose telemetry reports it. Check the input before each start and clear
/// too. Returns the codes of `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_external_trip(emulation: *mut Emulation) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.external_trip()))
}

/// Reports a message from the other end of a link. Call it for every message. Returns the codes of `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_exchange(emulation: *mut Emulation) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.exchange()))
}

/// Sets the temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns the codes of
/// `md_emulation_stop`.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_set_temperature(
    emulation: *mut Emulation,
    temperature: f32,
) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(emulation) }.map(|emulation| emulation.set_temperature(temperature)))
}

/// Number of ticks so far that were not in time, in every state. A clear does not change it, and it wraps. If it has increased with
/// a tick, give an external watchdog no signal. 0 without an emulation.
///
/// # Safety
/// `emulation` is null or points to an `md_emulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_emulation_late_ticks(emulation: *mut Emulation) -> u32 {
    // SAFETY: guaranteed by the caller.
    unsafe { held(emulation) }.map_or(0, |emulation| emulation.late_ticks())
}
