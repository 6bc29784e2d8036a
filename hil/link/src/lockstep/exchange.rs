//! Requests and answers over a wire that may lose, repeat, cut and damage them.

use mesh_damper::frame::{FrameBuffer, Frames, other_version};
use mesh_damper::message::{Answer, Request};

use super::LinkError;
use super::emulator::Wire;

/// Room for answers that come together.
const ROOM: usize = 4096;

/// The harness's end of the link.
#[derive(Debug)]
pub struct Exchange<W> {
    wire: W,
    sequence: u32,
    request: FrameBuffer,
    received: Box<[u8; ROOM]>,
    /// How often a request was sent again.
    pub repeated: u64,
    /// How often the one that took most was sent.
    pub most_tries: u32,
}

impl<W: Wire> Exchange<W> {
    /// With an image that has not been asked anything yet.
    pub fn new(wire: W) -> Self {
        Self {
            wire,
            sequence: 0,
            request: FrameBuffer::new(),
            received: Box::new([0; ROOM]),
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
        while tries < self.wire.most_tries() {
            let came = self.wire.receive(&mut self.received[..])?;
            let mut stale = false;
            let mut again = false;
            for frame in Frames(&self.received[..came]) {
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

    /// The wire.
    pub fn wire(&mut self) -> &mut W {
        &mut self.wire
    }
}
