//! The guarded output: DAC and enable line, which do what the state of [`super::state`] says, and the watch over the link.

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

use super::fault::{TripCause, clipped};
use super::state::{Happening, Machine, State};
use crate::adc::{Ads8688, Reading};
use crate::dac::Ad5761;
use crate::error::ConfigError;
use crate::real::in_range;

/// `stop_ticks` as in [`super::RigSettings`], where they are in range.
pub(super) fn valid_stop_ticks(stop_ticks: u32) -> Result<u32, ConfigError> {
    in_range("stop_ticks", f64::from(stop_ticks), 1.0, 1e7).map(|_| stop_ticks)
}

/// `link_ticks` as in [`super::RigSettings`], where they are in range.
pub(super) fn valid_link_ticks(link_ticks: u32) -> Result<u32, ConfigError> {
    in_range("link_ticks", f64::from(link_ticks), 0.0, 1e7).map(|_| link_ticks)
}

#[derive(Debug)]
pub(super) struct Output<D, E> {
    dac: Ad5761<D>,
    enable: E,
    /// The line took the last level it was given, and that was low.
    low: bool,
    machine: Machine,
    command: f32,
    /// By how much the command goes back to 0 per tick once stopped.
    stop_step: f32,
    stop_ticks: f32,
    /// Ticks without an exchange that are too many, 0 where nobody is linked, and those since the last one.
    link_ticks: u32,
    unlinked: u32,
}

impl<D: SpiDevice, E: OutputPin> Output<D, E> {
    /// Idle at 0. `stop_ticks` and `link_ticks` as in [`super::RigSettings`].
    pub(super) fn new(dac: Ad5761<D>, enable: E, stop_ticks: u32, link_ticks: u32) -> Self {
        let mut new = Self {
            dac,
            enable,
            low: false,
            machine: Machine::NEW,
            command: 0.0,
            stop_step: 0.0,
            stop_ticks: stop_ticks as f32,
            link_ticks,
            unlinked: 0,
        };
        new.come_down();
        new
    }

    pub(super) fn state(&self) -> State {
        self.machine.state
    }

    pub(super) fn is_running(&self) -> bool {
        self.machine.state == State::Running
    }

    pub(super) fn command(&self) -> f32 {
        self.command
    }

    /// What the table makes of `happening`; says whether the state is another.
    fn happens(&mut self, happening: Happening) -> bool {
        let before = self.machine;
        self.machine = before.after(happening);
        before.state != self.machine.state
    }

    /// From [`State::Idle`] or [`State::Done`], once the command is back at 0.
    pub(super) fn start(&mut self) -> bool {
        if !self.happens(Happening::Start) {
            return false;
        }
        self.low = false;
        self.stop_step = 0.0;
        self.unlinked = 0;
        if self.enable.set_high().is_err() {
            self.trip(TripCause::EnableLine);
            return false;
        }
        true
    }

    /// Stops without a fault.
    pub(super) fn stop(&mut self) {
        if self.happens(Happening::Stop) {
            self.come_down();
        }
    }

    /// The programme is over.
    pub(super) fn finish(&mut self) {
        if self.happens(Happening::Finish) {
            self.come_down();
        }
    }

    /// Stops for `fault`. The first cause stays.
    #[cold]
    #[inline(never)]
    pub(super) fn trip(&mut self, fault: TripCause) {
        if self.happens(Happening::Trip(fault)) {
            self.come_down();
        }
    }

    /// Drops the line in this very tick and lets the command go to 0 in a straight line. Not inlined: there are many causes.
    #[inline(never)]
    fn come_down(&mut self) {
        self.low = self.enable.set_low().is_ok();
        if !self.low {
            self.machine = self.machine.after(Happening::Trip(TripCause::EnableLine));
        }
        // A way back that has begun is not prolonged, and every way ends.
        let step = self.command.abs() / self.stop_ticks;
        for least in [step, f32::MIN_POSITIVE] {
            if least > self.stop_step {
                self.stop_step = least;
            }
        }
        self.see_rest();
    }

    fn see_rest(&mut self) {
        if self.command == 0.0 {
            self.machine = self.machine.after(Happening::AtRest);
        }
    }

    /// Whoever is at the other end of the link has been heard.
    pub(super) fn exchange(&mut self) {
        self.unlinked = 0;
    }

    /// A tick came late.
    pub(super) fn overrun(&mut self) {
        if self.is_running() {
            self.trip(TripCause::TickOverrun);
        }
    }

    /// A tick more without an exchange.
    #[inline]
    pub(super) fn watch_link(&mut self) {
        if self.link_ticks > 0 {
            self.unlinked = self.unlinked.saturating_add(1);
            if self.unlinked > self.link_ticks && self.is_running() {
                self.trip(TripCause::LinkLost);
            }
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
            Err(_) => self.trip(TripCause::AdcBus),
        }
    }

    /// From [`State::Faulted`] to [`State::Idle`], once the command is back at 0.
    pub(super) fn clear(&mut self) -> bool {
        let cleared = self.happens(Happening::Clear);
        if cleared {
            self.come_down();
        }
        cleared && self.machine.state == State::Idle
    }

    /// Writes the command where running, the way back to 0 where not. A line that did not drop is tried again.
    #[inline]
    pub(super) fn drive(&mut self, command: f32) {
        if self.is_running() && !command.is_finite() {
            self.trip(TripCause::NotFinite);
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
            Err(_) => self.trip(TripCause::DacBus),
            Ok(code) if code.clipped => {
                self.command = self.dac.scale().decode(code.code).value;
                self.trip(TripCause::CommandClipped);
            }
            Ok(_) => self.command = command,
        }
        if !self.machine.resting {
            self.see_rest();
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
        let mut output = Output::new(dac, line.clone(), 2, 0);
        assert!(output.start());
        output.drive(0.5);
        output.drive(f32::NAN);
        assert_eq!(output.state(), State::Faulted(TripCause::NotFinite));
        output.drive(f32::NAN);
        assert_eq!(output.command(), 0.0);
        bus.done();
        line.done();
    }
}
