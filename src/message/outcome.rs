//! [`super::Answer::Outcome`]: the result of one tick of the rig, and at the end of a cycle the results of the cycle.

use super::{answer, kind};
use crate::cycle::Cycle;
use crate::fast_law::Adaptation;
use crate::frame::{FrameBuffer, Reader, Writer};
use crate::health::{Event, HealthCause, NO_CAUSE, Statistic};
use crate::rig::{CycleReport, State, Telemetry, TripCause};

/// Result of one tick of the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Outcome {
    /// The DAC's code.
    pub code: u16,
    /// Level of the enable line.
    pub enabled: bool,
    /// Telemetry of the rig.
    pub telemetry: Telemetry,
}

const ENABLED: u8 = 1;
const RAMP: u8 = 2;
const REPORT: u8 = 4;
const REPORT_RAMP: u8 = 8;
const EVENT: u8 = 16;

/// Writes [`super::Answer::Outcome`].
#[inline(never)]
pub fn write_outcome(
    sequence: u32,
    code: u16,
    enabled: bool,
    telemetry: &Telemetry,
    buffer: &mut FrameBuffer,
) {
    let flag = |set: bool, flag: u8| if set { flag } else { 0 };
    let report = telemetry.report.as_ref();
    let flags = flag(enabled, ENABLED)
        | flag(telemetry.ramp, RAMP)
        | flag(report.is_some(), REPORT)
        | flag(report.is_some_and(|report| report.ramp), REPORT_RAMP)
        | flag(telemetry.event.is_some(), EVENT);
    let state = state_code(telemetry.state);
    buffer.write(answer(kind::OUTCOME, sequence, 1), |writer| {
        // Four bytes at a time, because this is done on every tick.
        writer.words([
            u32::from(code) | u32::from(flags) << 16 | u32::from(state) << 24,
            telemetry.tick as u32,
            (telemetry.tick >> 32) as u32,
            telemetry.displacement.to_bits(),
            telemetry.velocity.to_bits(),
            telemetry.measured_force.to_bits(),
            telemetry.model_force.to_bits(),
            telemetry.command.to_bits(),
            telemetry.block as u32,
            telemetry.cycle,
            telemetry.phase,
        ]);
        writer.words(telemetry.controls.map(f32::to_bits));
        if let Some(report) = report {
            write_report(writer, report);
        }
        if let Some(event) = &telemetry.event {
            write_event(writer, event);
        }
    });
}

pub(super) fn read_outcome(reader: &mut Reader<'_>) -> Option<Outcome> {
    let code = reader.u16()?;
    let flags = reader.u8()?;
    let state = state_of(reader.u8()?)?;
    let tick = u64::from(reader.u32()?) | u64::from(reader.u32()?) << 32;
    let telemetry = Telemetry {
        tick,
        displacement: reader.f32()?,
        velocity: reader.f32()?,
        measured_force: reader.f32()?,
        model_force: reader.f32()?,
        command: reader.f32()?,
        block: reader.u32()? as usize,
        cycle: reader.u32()?,
        phase: reader.u32()?,
        controls: reader.words()?.map(f32::from_bits),
        ramp: flags & RAMP != 0,
        state,
        report: if flags & REPORT != 0 {
            Some(read_report(reader, flags & REPORT_RAMP != 0)?)
        } else {
            None
        },
        event: if flags & EVENT != 0 {
            Some(read_event(reader)?)
        } else {
            None
        },
    };
    Some(Outcome {
        code,
        enabled: flags & ENABLED != 0,
        telemetry,
    })
}

#[inline(never)]
pub(super) fn write_report(writer: &mut Writer<'_>, report: &CycleReport) {
    writer.words([
        report.block as u32,
        report.cycle,
        report.nrmse.to_bits(),
        report.followed.k1.to_bits(),
        report.followed.k3.to_bits(),
        report.followed.c.to_bits(),
    ]);
    write_cycle(writer, &report.measured);
    write_cycle(writer, &report.model);
}

#[inline(never)]
pub(super) fn write_event(writer: &mut Writer<'_>, event: &Event) {
    writer.words([
        u32::from(event.cause.number())
            | u32::from(event.statistic.number()) << 8
            | u32::from(event.or.map_or(NO_CAUSE, HealthCause::number)) << 16,
        event.value.to_bits(),
        event.limit.to_bits(),
        event.cycle,
    ]);
}

pub(super) fn read_event(reader: &mut Reader<'_>) -> Option<Event> {
    let [cause, statistic, or, _] = reader.u32()?.to_le_bytes();
    Some(Event {
        cause: HealthCause::of_number(cause),
        or: (or != NO_CAUSE).then(|| HealthCause::of_number(or)),
        statistic: Statistic::of_number(statistic)?,
        value: reader.f32()?,
        limit: reader.f32()?,
        cycle: reader.u32()?,
    })
}

#[inline(never)]
fn write_cycle(writer: &mut Writer<'_>, cycle: &Cycle) {
    writer.words(cycle.values().map(f32::to_bits));
}

pub(super) fn read_report(reader: &mut Reader<'_>, ramp: bool) -> Option<CycleReport> {
    let (block, cycle, nrmse) = (reader.u32()?, reader.u32()?, reader.f32()?);
    let followed = Adaptation {
        k1: reader.f32()?,
        k3: reader.f32()?,
        c: reader.f32()?,
    };
    let mut cycle_of = || {
        Some(Cycle {
            force_max: reader.f32()?,
            force_min: reader.f32()?,
            displacement_max: reader.f32()?,
            displacement_min: reader.f32()?,
            amplitude: reader.f32()?,
            energy: reader.f32()?,
            energy_harmonic: reader.f32()?,
            stiffness: reader.f32()?,
            elastic_energy: reader.f32()?,
            loss_factor: reader.f32()?,
            mean_force: reader.f32()?,
            mean_displacement: reader.f32()?,
            ticks: reader.f32()?,
        })
    };
    Some(CycleReport {
        block: block as usize,
        cycle,
        ramp,
        measured: cycle_of()?,
        model: cycle_of()?,
        nrmse,
        followed,
    })
}

/// The trip causes in the order of their numbers on the link.
const FAULTS: [TripCause; 18] = [
    TripCause::AdcBus,
    TripCause::DacBus,
    TripCause::EnableLine,
    TripCause::DisplacementClipped,
    TripCause::ForceClipped,
    TripCause::CommandClipped,
    TripCause::DisplacementLimit,
    TripCause::ForceLimit,
    TripCause::TrackingLimit,
    TripCause::NoResponse,
    TripCause::NotFinite,
    TripCause::DisplacementLost,
    TripCause::ForceLost,
    TripCause::LinkLost,
    TripCause::TickOverrun,
    TripCause::DemandLimit,
    TripCause::External,
    TripCause::CorrectionLimit,
];
/// Number of the first cause.
const FIRST_FAULT: u8 = 16;

pub(super) fn state_code(state: State) -> u8 {
    match state {
        State::Idle => 0,
        State::Running => 1,
        State::Done => 2,
        State::Faulted(fault) => {
            let code = (FIRST_FAULT..)
                .zip(FAULTS)
                .find(|(_, other)| *other == fault);
            code.map_or(u8::MAX, |(code, _)| code)
        }
    }
}

pub(super) fn state_of(code: u8) -> Option<State> {
    match code {
        0 => Some(State::Idle),
        1 => Some(State::Running),
        2 => Some(State::Done),
        _ => {
            let index = usize::from(code.checked_sub(FIRST_FAULT)?);
            FAULTS.get(index).copied().map(State::Faulted)
        }
    }
}
