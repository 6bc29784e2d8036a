//! The guarded command: the output that the state of [`super::state`] allows, and the supervision of the link and the ticks.

use super::fault::{TripCause, clipped};
use super::io::Reading;
use super::pace::{Pace, PaceConfig};
use super::refusal::{ClearRefused, StartRefused};
use super::state::{Happening, Machine, State};
use crate::converter::Scale;
use crate::error::ConfigError;
use crate::real::in_range;

/// `stop_ticks` as in [`super::RigSettings`], if in range.
pub(super) fn valid_stop_ticks(stop_ticks: u32) -> Result<u32, ConfigError> {
    in_range("stop_ticks", f64::from(stop_ticks), 1.0, 1e7).map(|_| stop_ticks)
}

/// `link_ticks` as in [`super::RigSettings`], if in range.
pub(super) fn valid_link_ticks(link_ticks: u32) -> Result<u32, ConfigError> {
    in_range("link_ticks", f64::from(link_ticks), 0.0, 1e7).map(|_| link_ticks)
}

#[derive(Debug)]
pub(super) struct Guard {
    machine: Machine,
    command: f32,
    /// The command of the tick before, which stays the output if the actuator does not accept the new one.
    before: f32,
    /// Ends of the command's range.
    low: f32,
    high: f32,
    /// Decrease of the command per tick after a stop.
    stop_step: f32,
    stop_ticks: f32,
    /// Number of ticks without an exchange that are too many, 0 without a link, and number since the last exchange.
    link_ticks: u32,
    unlinked: u32,
    pace_config: PaceConfig,
    pace: Pace,
}

impl Guard {
    /// Idle at 0. `stop_ticks` and `link_ticks` as in [`super::RigSettings`].
    pub(super) fn new(
        command: &Scale,
        stop_ticks: u32,
        link_ticks: u32,
        pace_config: PaceConfig,
    ) -> Self {
        let [low, high] = command.ends();
        Self {
            // The command is at 0.
            machine: Machine::NEW.after(Happening::AtRest),
            command: 0.0,
            before: 0.0,
            low,
            high,
            stop_step: 0.0,
            stop_ticks: stop_ticks as f32,
            link_ticks,
            unlinked: 0,
            pace_config,
            pace: Pace::default(),
        }
    }

    pub(super) fn state(&self) -> State {
        self.machine.state
    }

    pub(super) fn is_running(&self) -> bool {
        self.machine.state == State::Running
    }

    /// Present output.
    pub(super) fn driven(&self) -> f32 {
        self.command
    }

    /// Applies `happening` to the state machine; returns whether the state has changed.
    fn happens(&mut self, happening: Happening) -> bool {
        let before = self.machine;
        self.machine = before.after(happening);
        before.state != self.machine.state
    }

    /// Whether [`Guard::start`] would succeed.
    pub(super) fn may_start(&self) -> Result<(), StartRefused> {
        if self.machine.after(Happening::Start) == self.machine {
            Err(StartRefused::of(self.machine.state))
        } else {
            Ok(())
        }
    }

    /// Starts from [`State::Idle`] or [`State::Done`], once the command is back at 0.
    pub(super) fn start(&mut self) -> Result<(), StartRefused> {
        self.may_start()?;
        self.happens(Happening::Start);
        self.stop_step = 0.0;
        self.unlinked = 0;
        Ok(())
    }

    /// Number of ticks of the return to 0.
    pub(super) fn stop_ticks(&self) -> f32 {
        self.stop_ticks
    }

    /// After the start `command` is driven from now on. A command beyond the range stops at once, and the output stays as before.
    pub(super) fn begin_at(&mut self, command: f32) -> Result<(), StartRefused> {
        if !(command >= self.low && command <= self.high) {
            self.trip(TripCause::CommandClipped);
            return Err(StartRefused::of(self.machine.state));
        }
        self.before = self.command;
        self.command = command;
        Ok(())
    }

    /// Stops without a trip cause.
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

    /// Lets the command return linearly to 0. Not inlined, because it has many callers.
    #[inline(never)]
    fn come_down(&mut self) {
        // A return in progress is not prolonged, so that every return ends.
        let step = self.command.abs() / self.stop_ticks;
        for least in [step, f32::MIN_POSITIVE] {
            if least > self.stop_step {
                self.stop_step = least;
            }
        }
        self.see_rest();
    }

    /// Not inlined, because both ways to come to rest end here.
    #[inline(never)]
    fn see_rest(&mut self) {
        if self.command == 0.0 {
            self.machine = self.machine.after(Happening::AtRest);
        }
    }

    /// The other end of the link was heard.
    pub(super) fn exchange(&mut self) {
        self.unlinked = 0;
    }

    /// A tick came late.
    #[cold]
    pub(super) fn overrun(&mut self) {
        if self.is_running() {
            self.trip(TripCause::TickOverrun);
        }
    }

    /// Takes tick number `tick`, from 1, at which the caller's counter reads `clock`: a tick that is not in time stops the
    /// controller.
    #[inline]
    pub(super) fn pace(&mut self, clock: u32, tick: u64) {
        if !self.pace.tick(&self.pace_config, clock, tick == 1) {
            self.overrun();
        }
    }

    /// Ticks that were not in time; wraps.
    pub(super) fn late_ticks(&self) -> u32 {
        self.pace.late()
    }

    /// An external stop input is active.
    pub(super) fn external_trip(&mut self) {
        self.trip(TripCause::External);
    }

    /// One more tick without an exchange.
    #[inline]
    pub(super) fn watch_link(&mut self) {
        if self.link_ticks > 0 {
            self.unlinked = self.unlinked.saturating_add(1);
            if self.unlinked > self.link_ticks && self.is_running() {
                self.trip(TripCause::LinkLost);
            }
        }
    }

    /// Takes `read` as the new `reading`, and stops for failed sensors or a channel at the end of its range. Without a new reading
    /// the last one stays.
    #[inline]
    pub(super) fn take(&mut self, read: Option<Reading>, reading: &mut Reading) {
        match read {
            Some(new) => {
                *reading = new;
                if let Some(fault) = clipped(&new) {
                    self.trip(fault);
                }
            }
            None => self.trip(TripCause::AdcBus),
        }
    }

    /// Whether [`Guard::clear`] would succeed.
    pub(super) fn may_clear(&self) -> Result<(), ClearRefused> {
        let cleared = self.machine.after(Happening::Clear);
        if cleared == self.machine {
            Err(ClearRefused::of(self.machine.state))
        } else {
            Ok(())
        }
    }

    /// From [`State::Faulted`] to [`State::Idle`], once the command is back at 0.
    pub(super) fn clear(&mut self) -> Result<(), ClearRefused> {
        self.may_clear()?;
        self.happens(Happening::Clear);
        Ok(())
    }

    /// The next output: `demanded` while running, else the return to 0.
    #[inline]
    pub(super) fn command(&mut self, demanded: f32) {
        self.before = self.command;
        if self.is_running() {
            // NaN is in no range.
            if demanded >= self.low && demanded <= self.high {
                self.command = demanded;
            } else {
                self.refuse(demanded);
            }
        } else {
            self.step_back();
        }
    }

    /// Stops for a demand beyond the range, and drives the end of the range, where the return begins. A demand that is not finite
    /// is not driven at all.
    #[cold]
    #[inline(never)]
    fn refuse(&mut self, demanded: f32) {
        if !demanded.is_finite() {
            self.trip(TripCause::NotFinite);
            return self.step_back();
        }
        self.command = if demanded > self.high {
            self.high
        } else {
            self.low
        };
        self.trip(TripCause::CommandClipped);
    }

    #[inline(never)]
    fn step_back(&mut self) {
        let left = self.command.abs() - self.stop_step;
        self.command = if left > 0.0 {
            left.copysign(self.command)
        } else {
            0.0
        };
        self.see_rest();
    }

    /// The actuator did not accept the command of this tick: it keeps the one before, and the return begins there.
    #[cold]
    #[inline(never)]
    pub(super) fn command_failed(&mut self) {
        self.command = self.before;
        if self.command != 0.0 {
            self.machine.resting = false;
        }
        self.trip(TripCause::DacBus);
    }

    /// The output as read back is not the command. A return continues.
    #[cold]
    pub(super) fn command_unverified(&mut self) {
        self.trip(TripCause::DacBus);
    }

    /// The enable line could not be set.
    #[cold]
    pub(super) fn enable_failed(&mut self) {
        self.trip(TripCause::EnableLine);
    }
}

/// What a [`Controller`](super::Controller) leaves to its field `guard`: everything except its start, its clear and its tick.
macro_rules! answered_by_guard {
    () => {
        fn stop(&mut self) {
            self.guard.stop();
        }

        fn may_clear(&self) -> Result<(), ClearRefused> {
            self.guard.may_clear()
        }

        fn exchange(&mut self) {
            self.guard.exchange();
        }

        fn overrun(&mut self) {
            self.guard.overrun();
        }

        fn external_trip(&mut self) {
            self.guard.external_trip();
        }

        fn late_ticks(&self) -> u32 {
            self.guard.late_ticks()
        }

        fn command_failed(&mut self) {
            self.guard.command_failed();
        }

        fn command_unverified(&mut self) {
            self.guard.command_unverified();
        }

        fn enable_failed(&mut self) {
            self.guard.enable_failed();
        }

        fn state(&self) -> State {
            self.guard.state()
        }

        fn driven(&self) -> f32 {
            self.guard.driven()
        }
    };
}

pub(super) use answered_by_guard;

#[cfg(test)]
mod tests {
    use super::*;

    fn paced() -> PaceConfig {
        PaceConfig::new(1000.0, 0.0).unwrap()
    }

    fn started(stop_ticks: u32) -> Guard {
        let mut guard = Guard::new(&Scale::new(1.0, 0.0).unwrap(), stop_ticks, 0, paced());
        guard.start().unwrap();
        guard
    }

    /// The output after `demanded`, and whether the controller runs.
    fn driven(guard: &mut Guard, demanded: f32) -> (f32, bool) {
        guard.command(demanded);
        (guard.driven(), guard.is_running())
    }

    /// A command can only be NaN through an error elsewhere; the law and the generator never give one.
    #[test]
    fn a_command_that_is_no_number_is_never_driven() {
        for demanded in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut guard = started(2);
            assert_eq!(driven(&mut guard, 0.5), (0.5, true));
            // Returns from there in two ticks.
            assert_eq!(driven(&mut guard, demanded), (0.25, false));
            assert_eq!(guard.state(), State::Faulted(TripCause::NotFinite));
            assert_eq!(driven(&mut guard, demanded), (0.0, false));
        }
    }

    #[test]
    fn a_command_beyond_the_range_is_its_end() {
        for (full_scale, [low, high]) in [(1.0, [-1.0, 1.0]), (-1.0, [-1.0, 1.0])] {
            let scale = Scale::new(full_scale, 0.0).unwrap();
            let step = scale.step().abs();
            for (demanded, end) in [(1.5, high), (-1.5, low)] {
                let mut guard = Guard::new(&scale, 2, 0, paced());
                guard.start().unwrap();
                let (command, running) = driven(&mut guard, demanded);
                assert!((command - end).abs() <= step && !running);
                assert_eq!(guard.state(), State::Faulted(TripCause::CommandClipped));
                assert!(!scale.encode(command).clipped);
                assert_eq!(driven(&mut guard, demanded), (0.5 * command, false));
            }
        }
    }

    /// A return that ended only in the controller's state has not ended.
    #[test]
    fn a_command_that_was_not_taken_does_not_count() {
        let mut guard = started(4);
        guard.command(0.5);
        guard.command(0.25);
        guard.command_failed();
        assert_eq!(guard.state(), State::Faulted(TripCause::DacBus));
        assert_eq!(guard.driven(), 0.5);
        for value in [0.375, 0.25, 0.125, 0.0] {
            assert_eq!(driven(&mut guard, 0.0), (value, false));
        }
        guard.command_failed();
        assert_eq!(guard.clear(), Err(ClearRefused::Moving));
        assert_eq!(driven(&mut guard, 0.0), (0.0, false));
        assert_eq!(guard.clear(), Ok(()));
    }

    /// A late tick stops a running controller, and is always counted.
    #[test]
    fn a_late_tick_stops_a_running_controller() {
        let mut guard = Guard::new(&Scale::new(1.0, 0.0).unwrap(), 2, 0, paced());
        for (tick, clock) in (1..).zip([7, 8, 10]) {
            guard.pace(clock, tick);
        }
        assert_eq!((guard.state(), guard.late_ticks()), (State::Idle, 1));
        guard.start().unwrap();
        guard.pace(11, 4);
        assert_eq!((guard.state(), guard.late_ticks()), (State::Running, 1));
        guard.pace(11, 4);
        let late = State::Faulted(TripCause::TickOverrun);
        assert_eq!((guard.state(), guard.late_ticks()), (late, 2));
        guard.clear().unwrap();
        guard.pace(11, 4);
        assert_eq!((guard.state(), guard.late_ticks()), (State::Idle, 3));
    }

    #[test]
    fn an_external_trip_holds_in_any_state_without_a_fault() {
        let external = State::Faulted(TripCause::External);
        let mut idle = Guard::new(&Scale::new(1.0, 0.0).unwrap(), 2, 0, paced());
        idle.external_trip();
        let mut running = started(2);
        running.external_trip();
        let mut done = started(2);
        done.finish();
        done.external_trip();
        for guard in [idle, running, done] {
            assert_eq!(guard.state(), external);
        }
        let mut faulted = started(2);
        faulted.trip(TripCause::ForceLimit);
        faulted.external_trip();
        assert_eq!(faulted.state(), State::Faulted(TripCause::ForceLimit));
    }

    #[test]
    fn it_says_beforehand_whether_it_would_forget_its_fault() {
        let mut guard = started(2);
        assert_eq!(guard.may_clear(), Err(ClearRefused::NoFault));
        guard.command(0.5);
        guard.trip(TripCause::ForceLimit);
        assert_eq!(guard.may_clear(), Err(ClearRefused::Moving));
        guard.command(0.0);
        guard.command(0.0);
        assert_eq!(guard.may_clear(), Ok(()));
        assert_eq!(guard.state(), State::Faulted(TripCause::ForceLimit));
        assert_eq!(guard.clear(), Ok(()));
    }
}
