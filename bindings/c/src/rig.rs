//! The rig: it excites a specimen, runs the law in parallel, and calls C for its sensors and its actuator.

use core::ffi::c_void;

use mesh_damper::health::HealthSettings;
use mesh_damper::rig::{self, Actuator, RigController, Sensors};

use crate::converter::{self, Reading, Wiring};
use crate::error::{Error, Problem, answer, code};
use crate::law::{Law, MD_EFFECTS, SharedLaw};
use crate::sine::{Block, Generator, programme};
use crate::storage::{self, Storage, assert_fits, held, initialize};
use crate::telemetry::Telemetry;

/// Bytes of `md_rig`.
#[cfg(target_pointer_width = "32")]
pub const MD_RIG_SIZE: usize = 4352;
/// Bytes of `md_rig`.
#[cfg(target_pointer_width = "64")]
pub const MD_RIG_SIZE: usize = 4512;
/// Alignment of `md_rig`, bytes.
pub const MD_RIG_ALIGN: usize = 16;

/// Memory of a rig with its programme.
#[repr(C, align(16))]
pub struct Rig {
    storage: [u8; MD_RIG_SIZE],
}

/// cbindgen:ignore
type Inner = rig::Rig<Callbacks, Callbacks, MD_EFFECTS, Generator, SharedLaw>;

// SAFETY: the assertion below.
unsafe impl Storage for Rig {
    type Inner = Inner;
    const TAG: u32 = u32::from_le_bytes(*b"rig1");
    // So that a cause that is added, of which it keeps an event, takes no more memory of a program in C.
    const SLACK: usize = 256;
}
const _: () = assert_fits::<Rig>();

/// The functions that a rig calls at each tick, in order: `tripped`, `read`, `enable` when the line changes, `drive`, the two
/// read-backs, and `alive`. Each returns whether it succeeded, except `tripped`. If one of them fails, except `alive`, the rig
/// stops. None may call a function of the same rig or of its law.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RigIo {
    /// Passed to each function unchanged; may be null.
    pub context: *mut c_void,
    /// Fills in the current displacement, force and control inputs. A channel that is not filled in counts as missing.
    pub read: Option<unsafe extern "C" fn(context: *mut c_void, reading: *mut Reading) -> bool>,
    /// Drives `command`, mm.
    pub drive: Option<unsafe extern "C" fn(context: *mut c_void, command: f32) -> bool>,
    /// Sets the enable line; a low level stops the actuator.
    pub enable: Option<unsafe extern "C" fn(context: *mut c_void, on: bool) -> bool>,
    /// May be null. Returns true while an external stop input is active, or if it cannot be read. It is called at each tick, start
    /// and clear. It trips, and prevents a start and a clear.
    pub tripped: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
    /// May be null. Checks that the actuator drives the last command, every 16 ticks.
    pub verify_drive: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
    /// May be null. Checks that the enable line is at this level, every 16 ticks and after each `enable`.
    pub verify_enable: Option<unsafe extern "C" fn(context: *mut c_void, on: bool) -> bool>,
    /// May be null. Called at a clear: sets up the parts again, which may have lost their supply, and drives 0. If it fails, the
    /// clear is refused.
    pub restore: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
    /// May be null. Tells an external watchdog at the end of a tick that the tick did all its work.
    pub alive: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
}

/// [`RigIo`] after a check that no required function is null.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Callbacks {
    context: *mut c_void,
    read: unsafe extern "C" fn(*mut c_void, *mut Reading) -> bool,
    drive: unsafe extern "C" fn(*mut c_void, f32) -> bool,
    enable: unsafe extern "C" fn(*mut c_void, bool) -> bool,
    tripped: Option<unsafe extern "C" fn(*mut c_void) -> bool>,
    verify_drive: Option<unsafe extern "C" fn(*mut c_void) -> bool>,
    verify_enable: Option<unsafe extern "C" fn(*mut c_void, bool) -> bool>,
    restore: Option<unsafe extern "C" fn(*mut c_void) -> bool>,
    alive: Option<unsafe extern "C" fn(*mut c_void) -> bool>,
}

impl Callbacks {
    fn of(io: &RigIo) -> Result<Self, Error> {
        Ok(Self {
            context: io.context,
            read: io.read.ok_or(Error::Null)?,
            drive: io.drive.ok_or(Error::Null)?,
            enable: io.enable.ok_or(Error::Null)?,
            tripped: io.tripped,
            verify_drive: io.verify_drive,
            verify_enable: io.verify_enable,
            restore: io.restore,
            alive: io.alive,
        })
    }
}

impl Callbacks {
    /// Calls an optional function; without one the call counts as succeeded.
    fn call(
        &self,
        function: Option<unsafe extern "C" fn(*mut c_void) -> bool>,
    ) -> Result<(), Failed> {
        // SAFETY: guaranteed by the caller that provided the callbacks.
        succeeded(function.is_none_or(|function| unsafe { function(self.context) }))
    }
}

/// A callback of C failed.
#[derive(Debug)]
pub(crate) struct Failed;

fn succeeded(did: bool) -> Result<(), Failed> {
    did.then_some(()).ok_or(Failed)
}

impl Sensors for Callbacks {
    type Error = Failed;

    fn read(&mut self) -> Result<rig::Reading, Failed> {
        let mut reading = Reading::NONE;
        // SAFETY: guaranteed by the caller that provided the callbacks.
        succeeded(unsafe { (self.read)(self.context, &raw mut reading) })?;
        Ok(reading.of_crate())
    }

    fn is_tripped(&mut self) -> Result<bool, Failed> {
        // SAFETY: as above.
        Ok(self
            .tripped
            .is_some_and(|tripped| unsafe { tripped(self.context) }))
    }
}

impl Actuator for Callbacks {
    type Error = Failed;

    fn drive(&mut self, value: f32) -> Result<(), Failed> {
        // SAFETY: as above.
        succeeded(unsafe { (self.drive)(self.context, value) })
    }

    fn enable(&mut self, on: bool) -> Result<(), Failed> {
        // SAFETY: as above.
        succeeded(unsafe { (self.enable)(self.context, on) })
    }

    fn verify_drive(&mut self) -> Result<(), Failed> {
        self.call(self.verify_drive)
    }

    fn verify_enable(&mut self, on: bool) -> Result<(), Failed> {
        // SAFETY: as above.
        succeeded(
            self.verify_enable
                .is_none_or(|verify| unsafe { verify(self.context, on) }),
        )
    }

    fn alive(&mut self) -> Result<(), Failed> {
        self.call(self.alive)
    }

    fn restore(&mut self) -> Result<(), Failed> {
        self.call(self.restore)
    }
}

/// Settings of a rig. Begin with `md_rig_defaults`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigSettings {
    /// Largest measured displacement in either direction, mm, 1e-6...1e4.
    pub displacement_limit: f64,
    /// Largest measured force in either direction, kN, 1e-6...1e9.
    pub force_limit: f64,
    /// Largest difference between measured and demanded displacement, mm, 1e-6...1e4.
    pub tracking_limit: f64,
    /// Number of ticks beyond one of these limits until the rig trips, 1...1e6. A tick within takes back an eighth of one.
    pub trip_ticks: u32,
    /// Number of ticks in which the command goes to 0 after a stop or a trip, 1...1e7.
    pub stop_ticks: u32,
    /// Number of ticks without `md_rig_exchange` after which the rig trips, 0...1e7; 0 without a link.
    pub link_ticks: u32,
    /// Rate of the clock whose reading is given at each tick, Hz: 0, or from the tick rate to the smaller of 4e9 and 2e9 times the
    /// tick rate. At 0 it counts the ticks of the timer, one each. A clock independent of the timer also detects a timer with a
    /// wrong rate.
    pub clock_rate: f64,
    /// Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3...3.
    pub observer_damping: f64,
    /// Fraction of the error of amplitude and phase that is corrected at the end of each cycle, 0...1.
    pub correction_gain: f64,
    /// Largest increase of the command by the amplitude correction within a block, as a fraction of it, 0.01...10; twice that in
    /// the first cycles.
    pub correction_limit: f64,
    /// Initial lead, s, 0...0.1: the known lag of the actuator.
    pub lead: f64,
    /// Time constant with which a correction takes effect, s, one tick to 10.
    pub glide: f64,
    /// Integral feedback of the displacement, 1/s, 0 to a hundredth of the tick rate.
    pub feedback: f64,
    /// Lowest plausible measured temperature, degrees Celsius, -273...2000.
    pub temperature_coldest: f64,
    /// Highest plausible measured temperature, degrees Celsius.
    pub temperature_hottest: f64,
    /// Fastest plausible change of the temperature, degrees Celsius per second, 1e-3...1e3.
    pub temperature_rate: f64,
    /// Smallest lasting relative change that the monitor detects, 0.01...0.5.
    pub health_size: f64,
    /// Number of cycles between false alarms by Gaussian noise, 1e2...1e9.
    pub health_false_alarm_cycles: f64,
    /// Number of cycles over which the monitor learns, 8...1000.
    pub health_learning_cycles: u32,
    /// Number of cycles after a start in which a slow change is the run-in, 0...1e6.
    pub health_run_in_cycles: u32,
    /// Largest relative change of a specimen's force by the temperature, per degree Celsius, 0...0.1.
    pub health_temperature_slope: f64,
    /// Largest relative change of stiffness or energy in the run-in, 0.01...1.
    pub health_run_in_size: f64,
    /// Largest adaptation of k1, k3 and c to slow changes, as a fraction of each, 0...0.5; 0 switches adaptation off.
    pub health_follow: f64,
}

/// Default settings, for amplitudes up to 0.3 mm and a few kN, at 0.5 to 10 Hz. Returns MD_ERROR_NONE, MD_ERROR_NULL or
/// MD_ERROR_MISALIGNED.
///
/// # Safety
/// `settings` is null or points to writable memory for them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_defaults(settings: *mut RigSettings) -> Error {
    let defaults = RigSettings::from(&rig::RigSettings::default());
    // SAFETY: guaranteed by the caller.
    code(unsafe { storage::write(settings, defaults) })
}

impl From<&rig::RigSettings> for RigSettings {
    fn from(settings: &rig::RigSettings) -> Self {
        let [temperature_coldest, temperature_hottest] = settings.temperature_range;
        Self {
            displacement_limit: settings.displacement_limit,
            force_limit: settings.force_limit,
            tracking_limit: settings.tracking_limit,
            trip_ticks: settings.trip_ticks,
            stop_ticks: settings.stop_ticks,
            link_ticks: settings.link_ticks,
            clock_rate: settings.clock_rate,
            observer_bandwidth: settings.observer_bandwidth,
            observer_damping: settings.observer_damping,
            correction_gain: settings.correction_gain,
            correction_limit: settings.correction_limit,
            lead: settings.lead,
            glide: settings.glide,
            feedback: settings.feedback,
            temperature_coldest,
            temperature_hottest,
            temperature_rate: settings.temperature_rate,
            health_size: settings.health.size,
            health_false_alarm_cycles: settings.health.false_alarm_cycles,
            health_learning_cycles: settings.health.learning_cycles,
            health_run_in_cycles: settings.health.run_in_cycles,
            health_temperature_slope: settings.health.temperature_slope,
            health_run_in_size: settings.health.run_in_size,
            health_follow: settings.health.follow,
        }
    }
}

impl From<&RigSettings> for rig::RigSettings {
    fn from(settings: &RigSettings) -> Self {
        Self {
            displacement_limit: settings.displacement_limit,
            force_limit: settings.force_limit,
            tracking_limit: settings.tracking_limit,
            trip_ticks: settings.trip_ticks,
            stop_ticks: settings.stop_ticks,
            link_ticks: settings.link_ticks,
            clock_rate: settings.clock_rate,
            observer_bandwidth: settings.observer_bandwidth,
            observer_damping: settings.observer_damping,
            correction_gain: settings.correction_gain,
            correction_limit: settings.correction_limit,
            lead: settings.lead,
            glide: settings.glide,
            feedback: settings.feedback,
            temperature_range: [settings.temperature_coldest, settings.temperature_hottest],
            temperature_rate: settings.temperature_rate,
            health: HealthSettings {
                size: settings.health_size,
                false_alarm_cycles: settings.health_false_alarm_cycles,
                learning_cycles: settings.health_learning_cycles,
                run_in_cycles: settings.health_run_in_cycles,
                temperature_slope: settings.health_temperature_slope,
                run_in_size: settings.health_run_in_size,
                follow: settings.health_follow,
            },
        }
    }
}

/// The programme of a rig.
#[repr(C)]
pub struct Excited {
    /// Tick rate of the rig, Hz, 1...1e6.
    pub tick_rate: f64,
    /// Number of cycles in each ramp, at least 1.
    pub ramp_cycles: u32,
    /// The blocks, as for `md_sine_init`.
    pub blocks: *const Block,
    /// Number of blocks, 1...MD_BLOCKS.
    pub count: usize,
}

/// Initialises an idle rig; the enable line is set low.
///
/// * `programme`: the excitation of the specimen; it is copied
/// * `wiring`: scales of displacement, force and command (mm), each initialised
/// * `io`: the functions that the rig calls; it is copied, and `read`, `drive` and `enable` must not be null
/// * `law`: initialised. It must stay in place while `rig` is used. `md_law_load` between two ticks loads another law, which takes
///   over at the end of a cycle.
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE,
/// MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or MD_ERROR_EMPTY.
///
/// # Safety
/// Each pointer is null or points to memory of its type; the functions of `io` may be called with its context.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_init(
    rig: *mut Rig,
    settings: *const RigSettings,
    programme: *const Excited,
    wiring: *const Wiring,
    io: *const RigIo,
    law: *mut Law,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let make = || {
            let callbacks = Callbacks::of(storage::read(io)?)?;
            let settings = storage::read(settings)?.into();
            let wiring = converter::wiring(wiring)?;
            let law = SharedLaw::of(law)?;
            let Excited {
                tick_rate,
                ramp_cycles,
                blocks,
                count,
            } = *storage::read(programme)?;
            let programme = self::programme(tick_rate, ramp_cycles, blocks, count)?;
            let controller = RigController::new(&settings, &wiring, programme, law)?;
            Ok(Inner::wire(controller, callbacks, callbacks))
        };
        answer(initialize(rig, make), problem)
    }
}

/// Starts the programme from its beginning; the enable line rises.
///
/// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_start(rig: *mut Rig, problem: *mut Problem) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let started = held(rig)
            .map_err(Problem::from)
            .and_then(|rig| Ok(rig.start()?));
        answer(started, problem)
    }
}

/// Stops without a trip; the enable line drops within the call. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_stop(rig: *mut Rig) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(rig) }.map(|rig| rig.stop()))
}

/// Clears the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT, MD_ERROR_MOVING or MD_ERROR_FAULTED,
/// and the codes of `md_rig_stop`; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_clear(rig: *mut Rig, problem: *mut Problem) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let cleared = held(rig)
            .map_err(Problem::from)
            .and_then(|rig| Ok(rig.clear()?));
        answer(cleared, problem)
    }
}

/// Processes one tick, at the programme's tick rate: reads, drives, and sets the enable line. Returns the codes of `md_rig_stop`.
///
/// * `clock`: reading of a counter that runs freely at `clock_rate` and wraps. A time since the tick before of less than half a
///   tick or more than one and a half trips: a stall, a missing tick, or a tick called twice.
/// * `telemetry`: receives the telemetry of this tick; may be null
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_tick(
    rig: *mut Rig,
    clock: u32,
    telemetry: *mut Telemetry,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        code(held(rig).and_then(|rig| {
            let seen = rig.tick(clock);
            if telemetry.is_null() {
                return Ok(());
            }
            storage::write(telemetry, Telemetry::from(&seen))
        }))
    }
}

/// Reports that a tick was late or missing: the rig trips, and the enable line drops. Returns the codes of `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_overrun(rig: *mut Rig) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(rig) }.map(|rig| rig.overrun()))
}

/// Reports that an external stop input is active: the rig trips, unless it has tripped already, and the enable line drops.
/// Returns the codes of `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_external_trip(rig: *mut Rig) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(rig) }.map(|rig| rig.external_trip()))
}

/// Reports a message from the other end of a link. Call it for every message. Returns the codes of `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_exchange(rig: *mut Rig) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(rig) }.map(|rig| rig.exchange()))
}

/// Clears all findings of the monitor; the current condition counts as normal. Returns the codes of `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_clear_events(rig: *mut Rig) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(rig) }.map(|rig| rig.clear_events()))
}

/// Sets the temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns the codes of `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_set_temperature(rig: *mut Rig, temperature: f32) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(rig) }.map(|rig| rig.set_temperature(temperature)))
}

/// Number of ticks so far that were not in time, in every state. A clear does not change it, and it wraps. 0 without a rig.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_late_ticks(rig: *mut Rig) -> u32 {
    // SAFETY: guaranteed by the caller.
    unsafe { held(rig) }.map_or(0, |rig| rig.late_ticks())
}

/// At the next start, the rig keeps the learned corrections of amplitude and phase instead of starting from neutral. Do not call it
/// after sensors or the actuator were repaired. Returns the codes of `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_keep_correction(rig: *mut Rig) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(rig) }.map(|rig| rig.keep_correction()))
}
