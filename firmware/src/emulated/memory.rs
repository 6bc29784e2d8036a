//! Link of an image in the emulator through memory shared with the harness.

use core::ptr::{read_volatile, write_volatile};
use core::slice;
use core::sync::atomic::{Ordering::SeqCst, compiler_fence};

use mesh_damper::frame::LARGEST;

use super::link::Pipes;
use crate::board::Link;
use crate::shared_memory::{
    ANSWERS, ANSWERS_TAKEN, FRAME, HARNESS_SLEEPS, IMAGE_SLEEPS, PATIENCE, REQUESTS,
    REQUESTS_TAKEN, has_room, slot,
};

/// The PSRAM of an MPS2+ with AN386, and of one with AN500.
const PSRAM: [usize; 2] = [0x2100_0000, 0x6000_0000];
/// The processor's identification register, and its bits that distinguish AN386's Cortex-M4 from AN500's Cortex-M7.
const CPUID: *const u32 = 0xE000_ED00 as *const u32;
const IS_M7: u32 = 3 << 4;

/// The board's PSRAM, and the pipes with which each end wakes the other; or only the pipes, if the harness does not use the memory.
pub struct SharedMemory {
    words: *mut u32,
    /// Whether the harness uses the memory.
    is_shared: bool,
    /// Requests taken, and answers sent.
    taken: u32,
    sent: u32,
    pipes: Pipes,
}

impl SharedMemory {
    #[inline]
    fn read(&self, at: usize) -> u32 {
        // SAFETY: a word of the board's memory, found by `open`, that only the harness and this link use.
        let word = unsafe { read_volatile(self.words.add(at)) };
        // Later code also runs later in the emulator.
        compiler_fence(SeqCst);
        word
    }

    #[inline]
    fn write(&mut self, at: usize, value: u32) {
        compiler_fence(SeqCst);
        // SAFETY: as above.
        unsafe { write_volatile(self.words.add(at), value) }
    }
}

impl Link for SharedMemory {
    fn open() -> Self {
        // SAFETY: a register that every Cortex-M has.
        let is_m7 = unsafe { read_volatile(CPUID) } & IS_M7 == IS_M7;
        let [an386, an500] = PSRAM;
        let mut link = Self {
            words: if is_m7 { an500 } else { an386 } as *mut u32,
            is_shared: false,
            taken: 0,
            sent: 0,
            pipes: Pipes::open(),
        };
        link.is_shared = link.read(PATIENCE) != 0;
        link
    }

    #[inline]
    fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        if !self.is_shared {
            return self.pipes.receive(buffer);
        }
        let count = self.taken.wrapping_add(1);
        let at = slot(REQUESTS, count);
        let mut looked = 0;
        while self.read(at) != count {
            if looked < self.read(PATIENCE) {
                looked += 1;
                continue;
            }
            looked = 0;
            self.write(IMAGE_SLEEPS, 1);
            if self.read(at) != count {
                self.pipes.receive(buffer);
            }
            self.write(IMAGE_SLEEPS, 0);
        }
        let length = (self.read(at + 1) as usize).min(LARGEST);
        self.taken = count;
        self.write(REQUESTS_TAKEN, count);
        // SAFETY: bytes of a slot, which the harness does not change until the next request is taken.
        unsafe { slice::from_raw_parts(self.words.add(at + FRAME).cast(), length) }
    }

    /// Not inlined: answers are sent from more than one place.
    #[inline(never)]
    fn send(&mut self, bytes: &[u8]) {
        if !self.is_shared {
            return self.pipes.send(bytes);
        }
        if !has_room(self.sent, self.read(ANSWERS_TAKEN)) || bytes.len() > LARGEST {
            return;
        }
        let count = self.sent.wrapping_add(1);
        let at = slot(ANSWERS, count);
        // SAFETY: bytes of a slot, which the harness does not read until this answer is counted.
        let place: &mut [u8] =
            unsafe { slice::from_raw_parts_mut(self.words.add(at + FRAME).cast(), bytes.len()) };
        place.copy_from_slice(bytes);
        self.write(at + 1, bytes.len() as u32);
        self.write(at, count);
        self.sent = count;
        if self.read(HARNESS_SLEEPS) != 0 {
            self.pipes.send(&[0]);
        }
    }
}
