//! The guarded output: DAC, enable line and the state that decides what they do.

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

use super::fault::{Fault, clipped};
use crate::adc::{Ads8688, Reading};
use crate::dac::Ad5761;
use crate::error::ConfigError;
use crate::real::in_range;

/// What a rig is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// Enable line low, command at 0 or on its way there.
    Idle,
    /// Enable line high, command as controlled.
    Running,
    /// The programme is over; otherwise as [`State::Idle`].
    Done,
    /// Stopped for this cause, until cleared; otherwise as [`State::Idle`].
    Faulted(Fault),
}

/// `stop_ticks` as in [`super::RigSettings`], where they are in range.
pub(super) fn valid_stop_ticks(stop_ticks: u32) -> Result<u32, ConfigError> {
    in_range("stop_ticks", f64::from(stop_ticks), 1.0, 1e7).map(|_| stop_ticks)
}

#[derive(Debug)]
pub(super) struct Output<D, E> {
    dac: Ad5761<D>,
    enable: E,
    /// The line took the last level it was given, and that was low.
    low: bool,
    state: State,
    command: f32,
    /// By how much the command goes back to 0 per tick once stopped.
    stop_step: f32,
    stop_ticks: f32,
}

impl<D: SpiDevice, E: OutputPin> Output<D, E> {
    /// Idle at 0. `stop_ticks` as in [`super::RigSettings`].
    pub(super) fn new(dac: Ad5761<D>, enable: E, stop_ticks: u32) -> Self {
        let mut new = Self {
            dac,
            enable,
            low: false,
            state: State::Idle,
            command: 0.0,
            stop_step: 0.0,
            stop_ticks: stop_ticks as f32,
        };
        new.stop(State::Idle);
        new
    }

    pub(super) fn state(&self) -> State {
        self.state
    }

    pub(super) fn is_running(&self) -> bool {
        self.state == State::Running
    }

    pub(super) fn command(&self) -> f32 {
        self.command
    }

    /// From [`State::Idle`] or [`State::Done`], once the command is back at 0.
    pub(super) fn start(&mut self) -> bool {
        if !matches!(self.state, State::Idle | State::Done) || self.command != 0.0 {
            return false;
        }
        self.low = false;
        if self.enable.set_high().is_err() {
            self.trip(Fault::EnableLine);
            return false;
        }
        self.state = State::Running;
        self.stop_step = 0.0;
        true
    }

    /// Drops the line in this very tick and lets the command go to 0 in a straight line. Not inlined: there are many causes.
    #[inline(never)]
    pub(super) fn stop(&mut self, state: State) {
        self.state = state;
        self.low = self.enable.set_low().is_ok();
        if !self.low && !matches!(state, State::Faulted(_)) {
            self.state = State::Faulted(Fault::EnableLine);
        }
        // A way back that has begun is not prolonged, and every way ends.
        let step = self.command.abs() / self.stop_ticks;
        for least in [step, f32::MIN_POSITIVE] {
            if least > self.stop_step {
                self.stop_step = least;
            }
        }
    }

    /// Stops for `fault`. The first cause stays.
    #[cold]
    #[inline(never)]
    pub(super) fn trip(&mut self, fault: Fault) {
        if !matches!(self.state, State::Faulted(_)) {
            self.stop(State::Faulted(fault));
        }
    }

    /// Takes a new `reading`, and stops for a bus that fails or a channel at its end; the last reading stays where there
    /// is no new one.
    pub(super) fn read<A: SpiDevice>(&mut self, adc: &mut Ads8688<A>, reading: &mut Reading) {
        match adc.read() {
            Ok(new) => {
                *reading = new;
                if let Some(fault) = clipped(&new) {
                    self.trip(fault);
                }
            }
            Err(_) => self.trip(Fault::AdcBus),
        }
    }

    /// From [`State::Faulted`] to [`State::Idle`], once the command is back at 0.
    pub(super) fn clear(&mut self) -> bool {
        let stopped = matches!(self.state, State::Faulted(_)) && self.command == 0.0;
        if stopped {
            self.stop(State::Idle);
        }
        stopped && self.state == State::Idle
    }

    /// Writes the command where running, the way back to 0 where not. A line that did not drop is tried again.
    #[inline]
    pub(super) fn drive(&mut self, command: f32) {
        if self.is_running() && !command.is_finite() {
            self.trip(Fault::NotFinite);
        }
        if !self.is_running() && !self.low {
            self.low = self.enable.set_low().is_ok();
        }
        let command = if self.is_running() {
            command
        } else if self.command > self.stop_step {
            self.command - self.stop_step
        } else if self.command < -self.stop_step {
            self.command + self.stop_step
        } else {
            0.0
        };
        // The way back starts from what the DAC really drives.
        match self.dac.write(command) {
            Err(_) => self.trip(Fault::DacBus),
            Ok(code) if code.clipped => {
                self.command = self.dac.scale().decode(code.code).value;
                self.trip(Fault::CommandClipped);
            }
            Ok(_) => self.command = command,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use embedded_hal_mock::eh1::digital::{Mock as Line, State as Level, Transaction as Set};
    use embedded_hal_mock::eh1::spi::{Mock as Bus, Transaction};
    use std::vec::Vec;

    use super::*;
    use crate::converter::Scale;

    /// A command can only be NaN through an error elsewhere; the law and the generator never give one.
    #[test]
    fn a_command_that_is_no_number_never_reaches_the_dac() {
        let write = |bytes: &[u8]| {
            [
                Transaction::transaction_start(),
                Transaction::write_vec(bytes.to_vec()),
                Transaction::transaction_end(),
            ]
        };
        let read_control = [
            Transaction::transaction_start(),
            Transaction::transfer_in_place(std::vec![0; 3], std::vec![0, 0x02, 0x68]),
            Transaction::transaction_end(),
        ];
        let expected: Vec<_> = [
            write(&[0x0F, 0, 0]),
            write(&[0x04, 0x02, 0x68]),
            write(&[0x0C, 0, 0]),
            read_control,
            write(&[0x03, 0x80, 0]),
            // 0.5, then on the way back from it in two ticks.
            write(&[0x03, 0xC0, 0]),
            write(&[0x03, 0xA0, 0]),
            write(&[0x03, 0x80, 0]),
        ]
        .concat();
        let mut bus = Bus::new(&expected);
        let mut line = Line::new(&[Level::Low, Level::High, Level::Low].map(Set::set));
        let dac = Ad5761::new(bus.clone(), Scale::new(1.0, 0.0).unwrap()).unwrap();
        let mut output = Output::new(dac, line.clone(), 2);
        assert!(output.start());
        output.drive(0.5);
        output.drive(f32::NAN);
        assert_eq!(output.state(), State::Faulted(Fault::NotFinite));
        output.drive(f32::NAN);
        assert_eq!(output.command(), 0.0);
        bus.done();
        line.done();
    }
}
