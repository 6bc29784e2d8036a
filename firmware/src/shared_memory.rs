//! Memory that an emulated board shares with the harness, and through which frames go between them.
//!
//! With pipes, a frame in each direction costs each end two system calls and a sleep, some 5 µs in all: as much as the rest of a
//! tick. Here each end polls for the other's next frame for a while before it sleeps. An end that sleeps announces it, and is woken
//! by a byte through its input pipe: the emulator's standard input, or its standard output.
//!
//! All numbers are words of 32 bits, little-endian, at these indices. The harness writes the words up to 15 and the image those up
//! to 31, each in a separate cache line. Frames are in slots, [`SLOTS`] in each direction; each direction counts its frames from 1.
//! A slot holds the frame's count, its number of bytes, and the bytes. The count is written last, and the other end polls it: count
//! and small frame arrive in one cache line. A frame without a free slot is lost, as may happen on any link. One slot is left free,
//! so that the polled slot does not change.
//!
//! Neither end relies on the order in which the other sees two of its words, because an emulator of one processor passes on no
//! barriers. A frame that is seen incomplete counts as damaged, and an end that sleeps polls again after a while, or is woken then.

use mesh_damper::frame::LARGEST;

/// Bytes of the memory: the PSRAM of an MPS2+, which nothing else uses.
pub const BYTES: usize = 16 << 20;
/// Number of polls of the image for the next request before it sleeps. If it is 0 at the image's start, there is no harness at this
/// memory, and frames go through the pipes.
pub const PATIENCE: usize = 0;
/// Answers taken.
pub const ANSWERS_TAKEN: usize = 1;
/// Whether the harness sleeps until it is woken.
pub const HARNESS_SLEEPS: usize = 2;
/// Requests taken.
pub const REQUESTS_TAKEN: usize = 16;
/// Whether the image sleeps until it is woken.
pub const IMAGE_SLEEPS: usize = 17;
/// First slot of requests.
pub const REQUESTS: usize = 32;
/// First slot of answers.
pub const ANSWERS: usize = REQUESTS + SLOTS as usize * SLOT;
/// Words in use.
pub const WORDS: usize = ANSWERS + SLOTS as usize * SLOT;
/// Slots in each direction.
pub const SLOTS: u32 = 8;
/// Words of a slot: count, length, and the largest frame.
pub const SLOT: usize = 128;
/// Offset of the frame in a slot.
pub const FRAME: usize = 2;

const _: () = assert!(4 * (SLOT - FRAME) >= LARGEST && SLOTS.is_power_of_two());

/// Whether there is a slot for one more frame after `sent` frames, `taken` of which are taken.
pub fn has_room(sent: u32, taken: u32) -> bool {
    sent.wrapping_sub(taken) < SLOTS - 1
}

/// First word of the slot of frame number `count`, with slots starting at `first`.
pub fn slot(first: usize, count: u32) -> usize {
    first + (count % SLOTS) as usize * SLOT
}
