//! Requests and answers over a wire that may lose, repeat, cut and damage them.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use mesh_damper::frame::{Frame, FrameBuffer, Frames, other_version};
use mesh_damper::message::{Answer, Note, Request, Row, Telemetered};

use super::LinkError;
use super::emulator::Wire;

/// Room for answers that come together.
const ROOM: usize = 4096;

/// For how long an answer may stay away while telemetry comes, before its request is sent again: a board whose queue is full of telemetry
/// has that ahead of the answer.
const PATIENCE: Duration = Duration::from_millis(500);

/// What a board has sent by itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Sent {
    /// Rows, one after the other.
    Rows(Vec<Row>),
    /// A cycle's end, an event, or a change of the rig's state.
    Note(Note),
}

/// The harness's end of the link.
#[derive(Debug)]
pub struct Exchange<W> {
    wire: W,
    sequence: u32,
    request: FrameBuffer,
    received: Box<[u8; ROOM]>,
    /// Telemetry that has come, each with its frame's number.
    telemetry: VecDeque<(u32, Sent)>,
    /// How often a request was sent again.
    pub repeated: u64,
    /// How often the one that took most was sent.
    pub most_tries: u32,
}

impl<W: Wire> Exchange<W> {
    /// With an image that has not been asked anything yet.
    pub fn new(wire: W) -> Self {
        Self::from_number(wire, 0)
    }

    /// With a board that goes on with what it does. Its first request has another number than that of who has it restart, which is 0.
    pub fn joined(wire: W) -> Self {
        Self::from_number(wire, 1 << 31)
    }

    fn from_number(wire: W, sequence: u32) -> Self {
        Self {
            wire,
            sequence,
            request: FrameBuffer::new(),
            received: Box::new([0; ROOM]),
            telemetry: VecDeque::new(),
            repeated: 0,
            most_tries: 0,
        }
    }

    /// The answer to `request`, as `take` sees it.
    ///
    /// # Errors
    /// The image's refusal, an answer that `take` does not want, or nobody there.
    pub fn ask<T>(
        &mut self,
        request: &Request<'_>,
        take: impl FnOnce(Answer<'_>) -> Option<T>,
    ) -> Result<T, LinkError> {
        let sequence = self.sequence;
        request.write(sequence, &mut self.request);
        self.wire.send(self.request.bytes())?;
        let mut tries = 1;
        let mut telemetry_since = None;
        while tries < self.wire.most_tries() {
            let came = self.wire.receive(&mut self.received[..])?;
            let mut stale = false;
            let mut again = false;
            let mut telemetered = false;
            for frame in Frames(&self.received[..came]) {
                if let Some(sent) = sent_in(&frame) {
                    self.telemetry.push_back((frame.header.sequence, sent));
                    telemetered = true;
                    continue;
                }
                match Answer::read(&frame) {
                    Some(Answer::Again) => again = true,
                    Some(answer) if frame.header.sequence == sequence => {
                        self.sequence = sequence.wrapping_add(1);
                        return match answer {
                            Answer::Refused(refusal) => Err(LinkError::refused(&refusal)),
                            answer => take(answer).ok_or(LinkError::OtherAnswer),
                        };
                    }
                    // To an earlier request, because it came twice: the own one's is still to come.
                    Some(_) => stale = true,
                    None => {}
                }
            }
            if stale && !again {
                continue;
            }
            if telemetered {
                let since: &mut Instant = telemetry_since.get_or_insert_with(Instant::now);
                if since.elapsed() < PATIENCE {
                    continue;
                }
                *since = Instant::now();
            }
            if let Some(version) = other_version(&self.received[..came]) {
                return Err(LinkError::OtherVersion(version));
            }
            tries += 1;
            self.repeated += 1;
            self.most_tries = self.most_tries.max(tries);
            self.wire.send(self.request.bytes())?;
        }
        Err(self.wire.silence())
    }

    /// The next telemetry with its frame's number; none where nothing comes for a while.
    ///
    /// # Errors
    /// Nobody there.
    pub fn telemetry(&mut self) -> Result<Option<(u32, Sent)>, LinkError> {
        if self.telemetry.is_empty() {
            let came = self.wire.receive(&mut self.received[..])?;
            for frame in Frames(&self.received[..came]) {
                if let Some(sent) = sent_in(&frame) {
                    self.telemetry.push_back((frame.header.sequence, sent));
                }
            }
        }
        Ok(self.telemetry.pop_front())
    }

    /// The wire.
    pub fn wire(&mut self) -> &mut W {
        &mut self.wire
    }
}

fn sent_in(frame: &Frame<'_>) -> Option<Sent> {
    Some(match Telemetered::read(frame)? {
        Telemetered::Rows(rows) => Sent::Rows(rows.collect()),
        Telemetered::Note(note) => Sent::Note(note),
    })
}
