//! The work of the timer's interrupt.

use heapless::spsc::{Consumer, Producer};

use mesh_damper::frame::{Frame, FrameBuffer, Frames};
use mesh_damper::message::{
    Answer, Refusal, Request, write_about, write_again, write_done, write_refusal,
};
use mesh_damper::telemetry::Recorder;

use super::{Bytes, reload, set_timer};
use crate::board::{Converters, OwnTimer};
use crate::rig::{Controller, Memory, Turn, Turns};

/// The rig, its telemetry and its requests.
pub struct Ticker<B: OwnTimer> {
    controller: Controller<B>,
    recorder: Recorder<'static>,
    requests: Consumer<'static, Bytes>,
    answers: Producer<'static, FrameBuffer>,
    turns: Turns,
    answer: &'static mut FrameBuffer,
    /// Number of completed slices of the current pack check.
    slices: u32,
}

/// Slices of a pack's check, one per tick, after which the answer says that there are more. The harness gives up a board that
/// is silent for two seconds, and a rig ticks at least 100 times a second.
const SLICES: u32 = 100;

impl<B: OwnTimer> Ticker<B> {
    pub(super) fn new(
        memory: &'static mut Memory<B>,
        recorder: Recorder<'static>,
        requests: Consumer<'static, Bytes>,
        answers: Producer<'static, FrameBuffer>,
    ) -> Self {
        let (controller, _, answer) = memory.controller();
        Self {
            controller,
            recorder,
            requests,
            answers,
            turns: Turns::NEW,
            answer,
            slices: 0,
        }
    }

    /// One tick, and then one request.
    #[inline]
    pub(super) fn tick(&mut self) {
        let temperature = B::Converters::temperature();
        match self.controller.own_tick(B::clock(), temperature) {
            Some(telemetry) => self.recorder.tick(&telemetry, temperature),
            None => B::Converters::idle(),
        }
        if self.answers.ready()
            && let Some(bytes) = self.requests.peek().cloned()
            && self.answer(&bytes)
        {
            self.requests.dequeue();
        }
    }

    /// Carries out a slice of a request, and writes the answer when the request is complete. Returns whether it is.
    #[inline(never)]
    fn answer(&mut self, bytes: &[u8]) -> bool {
        let Some(frame) = Frames(bytes).next() else {
            write_again(self.answer);
            self.send();
            return true;
        };
        self.controller.exchange();
        let sequence = frame.header.sequence;
        match self.turns.of(&frame) {
            Turn::New => match self.carry_out(&frame) {
                Carried::Out => self.turns.taken(sequence),
                Carried::InPart => return false,
                Carried::Not => return true,
            },
            Turn::Repeated => {}
            Turn::Restarted => write_refusal(sequence, &Refusal::Restarted, self.answer),
            Turn::Greeting => B::reset(),
            Turn::Stale => return true,
        }
        self.send();
        true
    }

    fn send(&mut self) {
        // There was room when the request was taken.
        let _ = self.answers.enqueue(self.answer.clone());
    }

    /// Carries out `frame` and writes the answer.
    fn carry_out(&mut self, frame: &Frame<'_>) -> Carried {
        let sequence = frame.header.sequence;
        match Request::read(frame) {
            Some(Request::Telemetry(config)) => {
                self.recorder.set(config);
                write_done(sequence, true, self.answer);
                Carried::Out
            }
            Some(Request::Join) => {
                write_about(sequence, &self.controller.about(B::CLOCK), self.answer);
                Carried::Out
            }
            Some(Request::Setup(_)) => {
                let Some(reload) = self.controller.rate().and_then(reload::<B>) else {
                    write_refusal(sequence, &Refusal::Field("tick_rate"), self.answer);
                    return Carried::Out;
                };
                let had_rig = self.controller.has_rig();
                let carried = self.others(frame);
                // A running rig keeps its ticks.
                if !had_rig && self.controller.has_rig() {
                    // SAFETY: nobody else uses SysTick.
                    set_timer(&mut unsafe { cortex_m::Peripherals::steal() }.SYST, reload);
                }
                carried
            }
            Some(Request::PackEnd) => {
                let carried = self.others(frame);
                let answer = Frames(self.answer.bytes()).next();
                let more =
                    answer.is_some_and(|answer| Answer::read(&answer) == Some(Answer::Done(false)));
                self.slices = if more { self.slices + 1 } else { 0 };
                // The next slice needs no further request, until somebody waits for too long.
                if more && !self.slices.is_multiple_of(SLICES) {
                    Carried::InPart
                } else {
                    carried
                }
            }
            _ => self.others(frame),
        }
    }

    fn others(&mut self, frame: &Frame<'_>) -> Carried {
        if self.controller.answer_others(frame, self.answer) {
            Carried::Out
        } else {
            Carried::Not
        }
    }
}

/// The progress of a request.
enum Carried {
    /// Complete, and its answer is written.
    Out,
    /// The rest follows at the next tick.
    InPart,
    /// It requires nothing.
    Not,
}
