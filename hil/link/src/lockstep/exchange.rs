//! Requests and answers over a wire that may lose, repeat, cut and damage them.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use mesh_damper::frame::{Frame, FrameBuffer, Frames, other_version};
use mesh_damper::message::{Answer, Note, Request, Row, Telemetered};

use super::LinkError;
use super::emulator::Wire;

/// Buffer for answers that arrive together.
const ROOM: usize = 4096;

/// Time for which an answer may be missing while telemetry arrives, before its request is repeated: a board whose queue is full of
/// telemetry sends that before the answer.
const PATIENCE: Duration = Duration::from_millis(500);

/// Telemetry that a board has sent by itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Sent {
    /// Successive rows.
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
    /// Telemetry received, each with its frame's number.
    telemetry: VecDeque<(u32, Sent)>,
    /// Number of repeated requests.
    pub repeated: u64,
    /// Largest number of times that a single request was sent.
    pub most_tries: u32,
}

impl<W: Wire> Exchange<W> {
    /// The link to an image that has had no request yet.
    pub fn new(wire: W) -> Self {
        Self::from_number(wire, 0)
    }

    /// The link to a board that continues its work. Its first request has a number other than 0, which would restart the board.
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

    /// The answer to `request`, converted by `take`.
    ///
    /// # Errors
    /// The image's refusal, an answer that `take` rejects, or no other end.
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
                    // An answer to an earlier request, which arrived twice: the answer to this one is still to come.
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

    /// The next telemetry with its frame's number; `None` if nothing arrives for a while.
    ///
    /// # Errors
    /// The other end is gone.
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
