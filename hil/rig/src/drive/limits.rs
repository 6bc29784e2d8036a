//! Demands of a motion on actuator and rig, and whether they can meet them, checked before anything moves.
//!
//! Displacement, velocity, acceleration and command follow from the motion. The force is that of a copy of the specimen along it.
//! The following error is that of a copy of the actuator with the command as the rig begins it: demand plus lead times velocity.

use mesh_damper_output::error::{InputError, Place as Where};

use super::Motion;
use crate::actuator::Servo;
use crate::specimen::DamperForce;
use crate::{RigSetup, SetupError};

/// Part of a limit that a motion may use; the rest is for the sensors' noise and the feedback.
const USABLE: f64 = 0.95;

/// Largest demands of a motion, in either direction.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Demands {
    /// Displacement, mm.
    pub displacement_mm: f64,
    /// Velocity, mm/s.
    pub velocity_mm_s: f64,
    /// Acceleration, mm/s².
    pub acceleration_mm_s2: f64,
    /// Command to the actuator, mm.
    pub command_mm: f64,
    /// Force of the specimen and of the actuator's own mass, kN.
    pub force_kn: f64,
    /// Difference between actuator and demand, mm.
    pub following_error_mm: f64,
    /// RMS of that difference, mm.
    pub following_error_rms_mm: f64,
}

/// The demands of the motion of `setup`, to which `scale` was already applied.
///
/// # Errors
/// A setup without a motion, an invalid actuator, or a demand beyond its limit: with its value, the limit, and a scale that meets
/// it.
pub fn checked<S: DamperForce + Clone, const B: usize, const N: usize>(
    setup: &RigSetup<S, B, N>,
    scale: f64,
) -> Result<Demands, SetupError> {
    let Some(motion) = &setup.drive else {
        let remedy = "give the setup a motion";
        return Err(SetupError::Drive(InputError::new(
            "the rig",
            "no motion",
            remedy,
        )));
    };
    let demands = demands(setup, motion)?;
    let (servo, settings) = (&setup.servo, &setup.settings);
    let valve = std::f64::consts::TAU * servo.valve_frequency;
    for (field, value, limit, unit) in [
        (
            "displacement",
            demands.displacement_mm,
            settings
                .displacement_limit
                .min(setup.displacement_sensor.full_scale),
            "mm",
        ),
        (
            "velocity",
            demands.velocity_mm_s,
            setup.stream.velocity_limit.min(servo.flow_velocity),
            "mm/s",
        ),
        // The valve opens no faster than it responds, and the oil gives no more than its force.
        (
            "acceleration",
            demands.acceleration_mm_s2,
            (valve * servo.flow_velocity).min(servo.force_limit / (1e-6 * servo.mass)),
            "mm/s²",
        ),
        (
            "force",
            demands.force_kn,
            settings.force_limit.min(servo.force_limit),
            "kN",
        ),
        ("command", demands.command_mm, setup.command_range, "mm"),
        (
            "following error",
            demands.following_error_mm,
            settings.tracking_limit,
            "mm",
        ),
    ] {
        if value.is_nan() || value > USABLE * limit {
            return Err(SetupError::Drive(beyond(
                field,
                scale,
                value,
                USABLE * limit,
                unit,
            )));
        }
    }
    Ok(demands)
}

fn beyond(field: &str, scale: f64, value: f64, limit: f64, unit: &str) -> InputError {
    // Two digits, rounded down. The effect of friction on the force does not scale with the motion, so a second try may be needed.
    let scale = scale * limit / value;
    let digit = 10f64.powf(scale.abs().log10().floor() - 1.0);
    let scale = (scale / digit).trunc() * digit;
    let problem = format!("{value:.4} {unit} is beyond the {limit:.4} {unit} that the rig drives");
    // Without the residue of a binary fraction after those digits.
    let remedy = format!(
        "run it smaller, with --scale {}",
        format!("{scale:.9}").trim_end_matches('0')
    );
    InputError::new("the motion", problem, remedy).at(Where::Field(field.into()))
}

fn demands<S: DamperForce + Clone, const B: usize, const N: usize>(
    setup: &RigSetup<S, B, N>,
    motion: &Motion,
) -> Result<Demands, SetupError> {
    let step = 1.0 / motion.grid().tick_rate();
    let ticks = (motion.duration() / step).ceil() as usize;
    let mut specimen = setup.specimen.clone();
    let mut servo = Servo::new(setup.servo, step, setup.specimen.clone())?;
    let peaks = motion.peaks();
    let (mut command_peak, mut force_peak) = (0.0_f64, 0.0_f64);
    let (mut error_peak, mut error_squares) = (0.0_f64, 0.0);
    for tick in 0..ticks {
        let time = tick as f64 * step;
        let at = motion.at(time);
        let force = specimen.force(time, at.displacement, at.velocity, at.acceleration, step);
        let inertia = 1e-6 * setup.servo.mass * at.acceleration;
        force_peak = force_peak.max(force.abs()).max((force + inertia).abs());
        let error = servo.displacement() - at.displacement;
        error_peak = error_peak.max(error.abs());
        error_squares += error * error;
        let command = at.displacement + setup.settings.lead * at.velocity;
        command_peak = command_peak.max(command.abs());
        servo.advance(command, true);
    }
    Ok(Demands {
        displacement_mm: peaks.displacement,
        velocity_mm_s: peaks.velocity,
        acceleration_mm_s2: peaks.acceleration,
        command_mm: command_peak,
        force_kn: force_peak,
        following_error_mm: error_peak,
        following_error_rms_mm: (error_squares / ticks.max(1) as f64).sqrt(),
    })
}
