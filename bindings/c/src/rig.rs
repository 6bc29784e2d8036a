//! The rig: it excites a specimen, runs the law beside it, and calls back for its sensors and its actuator.

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
pub const MD_RIG_SIZE: usize = 4112;
/// Bytes of `md_rig`.
#[cfg(target_pointer_width = "64")]
pub const MD_RIG_SIZE: usize = 4288;
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
}
const _: () = assert_fits::<Rig>();

/// What a rig calls at each tick: in order `tripped`, `read`, `enable` where the line changes, `drive`, the two read-backs, and `alive`.
/// Each but `tripped` returns whether it succeeded; where one other than `alive` did not, the rig stops. None may call a function of
/// the same rig or of its law.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RigIo {
    /// Goes to each of them as it is; may be null.
    pub context: *mut c_void,
    /// Fills in displacement, force and control inputs of now. A channel that is not filled in counts as missing.
    pub read: Option<unsafe extern "C" fn(context: *mut c_void, reading: *mut Reading) -> bool>,
    /// Drives `command`, mm.
    pub drive: Option<unsafe extern "C" fn(context: *mut c_void, command: f32) -> bool>,
    /// Sets the enable line; low stops the actuator.
    pub enable: Option<unsafe extern "C" fn(context: *mut c_void, on: bool) -> bool>,
    /// May be null. Returns true while an input from outside says stop, and where it cannot be read: asked at each tick, start and
    /// clear. It trips, and refuses a start and a clear.
    pub tripped: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
    /// May be null. Reads back that the last command is driven, every 16 ticks.
    pub verify_drive: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
    /// May be null. Reads back that the enable line is at this level, every 16 ticks and after each `enable`.
    pub verify_enable: Option<unsafe extern "C" fn(context: *mut c_void, on: bool) -> bool>,
    /// May be null. Sets the parts up again, which may have lost their supply, and drives 0: at a clear, which is refused where it
    /// does not succeed.
    pub restore: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
    /// May be null. Tells an external watchdog that a tick did all it had to, at the end of each that did.
    pub alive: Option<unsafe extern "C" fn(context: *mut c_void) -> bool>,
}

/// [`RigIo`] without a function that is null and may not be.
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
    /// What an optional function says; that it succeeded where there is none.
    fn call(
        &self,
        function: Option<unsafe extern "C" fn(*mut c_void) -> bool>,
    ) -> Result<(), Failed> {
        // SAFETY: as whoever gave the callbacks vouches.
        succeeded(function.is_none_or(|function| unsafe { function(self.context) }))
    }
}

/// What C said to a call: it did not succeed.
#[derive(Debug)]
pub(crate) struct Failed;

fn succeeded(did: bool) -> Result<(), Failed> {
    did.then_some(()).ok_or(Failed)
}

impl Sensors for Callbacks {
    type Error = Failed;

    fn read(&mut self) -> Result<rig::Reading, Failed> {
        let mut reading = Reading::NONE;
        // SAFETY: as whoever gave the callbacks vouches.
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

/// What a rig is set to. Begin with `md_rig_defaults`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigSettings {
    /// Largest measured displacement in either direction, mm, 1e-6...1e4.
    pub displacement_limit: f64,
    /// Largest measured force in either direction, kN, 1e-6...1e9.
    pub force_limit: f64,
    /// Largest distance of the measured displacement from the demanded one, mm, 1e-6...1e4.
    pub tracking_limit: f64,
    /// For how many ticks on end one of these must be exceeded to stop the rig, 1...1e6.
    pub trip_ticks: u32,
    /// In how many ticks the command goes to 0 once stopped, 1...1e7.
    pub stop_ticks: u32,
    /// After how many ticks without `md_rig_exchange` it stops, 0...1e7; 0 where nobody is linked.
    pub link_ticks: u32,
    /// Rate of the counter whose reading each tick is given, Hz: 0, or the tick rate to 4e9 and to 2e9 times the tick rate. At 0 it
    /// counts the ticks of the timer, one each. A clock that is independent of the timer also finds a timer at a wrong rate.
    pub clock_rate: f64,
    /// Bandwidth of the observer that estimates the velocity, Hz, 1e-3 to a tenth of the tick rate.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3...3.
    pub observer_damping: f64,
    /// Part of the error of amplitude and phase that is corrected at the end of each cycle, 0...1.
    pub correction_gain: f64,
    /// Most by which amplitude's correction may have the command grow within a block, part of it, 0.01...10; twice that in its first cycles.
    pub correction_limit: f64,
    /// Lead to begin with, s, 0...0.1: what the actuator is known to lag.
    pub lead: f64,
    /// Time constant with which a correction takes effect, s, one tick to 10.
    pub glide: f64,
    /// Integral feedback of the displacement, 1/s, 0 to a hundredth of the tick rate.
    pub feedback: f64,
    /// Coldest that a measured temperature can be, degrees Celsius, -273...2000.
    pub temperature_coldest: f64,
    /// Hottest that it can be.
    pub temperature_hottest: f64,
    /// Fastest that it can change, degrees a second, 1e-3...1e3.
    pub temperature_rate: f64,
    /// Smallest lasting change that the monitor is to find, part of it, 0.01...0.5.
    pub health_size: f64,
    /// Cycles between false alarms of Gaussian noise, 1e2...1e9.
    pub health_false_alarm_cycles: f64,
    /// Cycles over which the monitor learns, 8...1000.
    pub health_learning_cycles: u32,
    /// Cycles after a start within which a slow change is the run-in, 0...1e6.
    pub health_run_in_cycles: u32,
    /// Most by which temperature changes a specimen's force, part of it per degree, 0...0.1.
    pub health_temperature_slope: f64,
    /// Most by which stiffness or energy may change in the run-in, part of them, 0.01...1.
    pub health_run_in_size: f64,
    /// Most by which the law follows a slow change of its coefficients, part of each, 0...0.5.
    pub health_follow: f64,
}

/// Settings for amplitudes up to 0.3 mm and a few kN, at 0.5 to 10 Hz. Returns MD_ERROR_NONE, MD_ERROR_NULL or MD_ERROR_MISALIGNED.
///
/// # Safety
/// `settings` is null or points to writable memory for them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_defaults(settings: *mut RigSettings) -> Error {
    let defaults = RigSettings::from(&rig::RigSettings::default());
    // SAFETY: as the caller vouches.
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
    /// Ticks per second of the rig, Hz, 1...1e6.
    pub tick_rate: f64,
    /// Cycles of each ramp, at least 1.
    pub ramp_cycles: u32,
    /// As `md_sine_init` takes them.
    pub blocks: *const Block,
    /// How many blocks, 1...MD_BLOCKS.
    pub count: usize,
}

/// An idle rig; the enable line is set low.
///
/// * `programme`: what it excites the specimen by; it is copied
/// * `wiring`: scales of displacement, force and command (mm), each initialised
/// * `io`: what it calls; it is copied, and `read`, `drive` and `enable` may not be null
/// * `law`: initialised; it stays where it is as long as `rig` is used. `md_law_load` between two ticks gives another law, which takes
///   over at the end of a cycle.
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NOT_INITIALIZED (of `law` or a scale), MD_ERROR_NON_FINITE,
/// MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or MD_ERROR_EMPTY.
///
/// # Safety
/// Each pointer is null or points to what its type says; the functions of `io` may be called with its context.
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
    // SAFETY: as the caller vouches.
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

/// Begins the programme from its start; the enable line rises.
///
/// Returns MD_ERROR_NONE, MD_ERROR_RUNNING, MD_ERROR_MOVING, MD_ERROR_FAULTED, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_start(rig: *mut Rig, problem: *mut Problem) -> Error {
    // SAFETY: as the caller vouches.
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
    // SAFETY: as the caller vouches.
    code(unsafe { held(rig) }.map(|rig| rig.stop()))
}

/// Forgets the trip, once the command is back at 0. Returns MD_ERROR_NONE, MD_ERROR_NO_FAULT, MD_ERROR_MOVING or MD_ERROR_FAULTED,
/// and as `md_rig_stop`; `problem` may be null.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_clear(rig: *mut Rig, problem: *mut Problem) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        let cleared = held(rig)
            .map_err(Problem::from)
            .and_then(|rig| Ok(rig.clear()?));
        answer(cleared, problem)
    }
}

/// One tick, at the programme's tick rate: reads, drives, and sets the enable line. Returns as `md_rig_stop`.
///
/// * `clock`: what a counter reads that runs freely at `clock_rate` and wraps. Less than half a tick or more than one and a half since
///   the tick before trips: a stall, a tick that is missing or called twice.
/// * `telemetry`: gets what it saw, and may be null
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_tick(
    rig: *mut Rig,
    clock: u32,
    telemetry: *mut Telemetry,
) -> Error {
    // SAFETY: as the caller vouches.
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

/// A tick came late, or not at all: it trips, and the enable line drops. Returns as `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_overrun(rig: *mut Rig) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(rig) }.map(|rig| rig.overrun()))
}

/// An input outside of the rig says stop: it trips in any state without a trip, and the enable line drops. Returns as `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_external_trip(rig: *mut Rig) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(rig) }.map(|rig| rig.external_trip()))
}

/// Whoever is at the other end of a link was heard: call it as often as that is so. Returns as `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_exchange(rig: *mut Rig) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(rig) }.map(|rig| rig.exchange()))
}

/// Forgets all that the monitor found; what is now counts as normal. Returns as `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_clear_events(rig: *mut Rig) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(rig) }.map(|rig| rig.clear_events()))
}

/// Temperature of the specimen for the law's effects, degrees Celsius; 20 until set. Returns as `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_set_temperature(rig: *mut Rig, temperature: f32) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(rig) }.map(|rig| rig.set_temperature(temperature)))
}

/// Ticks so far that did not come in time, in every state; a clear leaves them. It wraps. 0 of no rig.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_late_ticks(rig: *mut Rig) -> u32 {
    // SAFETY: as the caller vouches.
    unsafe { held(rig) }.map_or(0, |rig| rig.late_ticks())
}

/// The next start keeps what the corrections of amplitude and phase have learned, instead of starting from neutral. Not after sensors or
/// actuator were repaired. Returns as `md_rig_stop`.
///
/// # Safety
/// `rig` is null or points to an `md_rig`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_rig_keep_correction(rig: *mut Rig) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(rig) }.map(|rig| rig.keep_correction()))
}
