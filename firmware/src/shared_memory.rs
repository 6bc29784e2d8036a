//! Memory that an emulated board shares with the harness, and through which frames go between them.
//!
//! A pipe costs each end two system calls and a sleep for a frame that goes and one that comes back, some 5 µs in all: as long as all else
//! that a tick takes. Here each end looks for the other's next frame for a while before it sleeps. One that sleeps says so, and is woken by
//! a byte through the pipe that it reads: the emulator's standard input, or its standard output.
//!
//! All numbers are words of 32 bits, little-endian, at these indices. Those up to 15 are written by the harness and those up to 31 by the
//! image, each in a cache line of its own. Frames lie in slots, [`SLOTS`] for each way; each way counts its frames from 1 on. A slot is
//! the frame's count, its bytes' number, and the bytes. The count is written last, and is what the other end looks for: count and small
//! frame come in one cache line. A frame for which there is no slot is lost, as it may be on any link. So that the slot looked at stays as it
//! is, one is left free.
//!
//! Neither end relies on the order in which the other sees two of its words, as an emulator of one processor passes on no barriers: a frame
//! that is seen half is a damaged one, and whoever sleeps looks again after a while, or is woken then.

use mesh_damper::frame::LARGEST;

/// Bytes of the memory: the PSRAM of an MPS2+, which nothing else uses.
pub const BYTES: usize = 16 << 20;
/// How often the image looks for the next request before it sleeps. Where it is 0 at the image's start there is no harness at this memory,
/// and frames go through the pipes.
pub const PATIENCE: usize = 0;
/// Answers taken.
pub const ANSWERS_TAKEN: usize = 1;
/// The harness sleeps until it is woken.
pub const HARNESS_SLEEPS: usize = 2;
/// Requests taken.
pub const REQUESTS_TAKEN: usize = 16;
/// The image sleeps until it is woken.
pub const IMAGE_SLEEPS: usize = 17;
/// First slot of requests.
pub const REQUESTS: usize = 32;
/// First slot of answers.
pub const ANSWERS: usize = REQUESTS + SLOTS as usize * SLOT;
/// Words in use.
pub const WORDS: usize = ANSWERS + SLOTS as usize * SLOT;
/// Slots of each way.
pub const SLOTS: u32 = 8;
/// Words of a slot: count, length, and the largest frame.
pub const SLOT: usize = 128;
/// Where the frame lies in a slot.
pub const FRAME: usize = 2;

const _: () = assert!(4 * (SLOT - FRAME) >= LARGEST && SLOTS.is_power_of_two());

/// Whether there is a slot for one frame more, of `sent` ones, `taken` of which are taken.
pub fn has_room(sent: u32, taken: u32) -> bool {
    sent.wrapping_sub(taken) < SLOTS - 1
}

/// First word of the slot of frame number `count`, of those from `first` on.
pub fn slot(first: usize, count: u32) -> usize {
    first + (count % SLOTS) as usize * SLOT
}
