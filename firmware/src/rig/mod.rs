//! The rig controller: the crate's [`mesh_damper::rig::RigController`] on a board, driven tick by tick over its link.

mod controller;
#[doc(hidden)]
pub mod log;

use core::mem::MaybeUninit;

use cortex_m as _;
/// What [`rig_image!`](crate::rig_image) names.
#[doc(hidden)]
pub use {defmt, mesh_damper::frame::FrameBuffer};

use mesh_damper::fast_law::RunningLaw;
use mesh_damper::frame::{Frames, LARGEST};
use mesh_damper::message::{MAX_BLOCKS, Refusal, is_hello, write_again, write_refusal};
use mesh_damper::pack::Upload;
use mesh_damper::passivity::Passivity;
use mesh_damper::rig::StreamConfig;
use mesh_damper::sine::Programme;

use crate::board::{Board, Link as _};
use controller::{Controller, EFFECTS, Excitation, Parts, WiredRig};

/// What the controller works on. It belongs into a static: none of it fits on a small stack.
pub struct Memory<B: Board> {
    programme: Programme<MAX_BLOCKS>,
    law: RunningLaw<EFFECTS>,
    stream: Option<StreamConfig>,
    rig: MaybeUninit<WiredRig<B>>,
    controller: MaybeUninit<Excitation>,
    upload: Upload,
    passivity: Passivity<EFFECTS>,
    received: [u8; LARGEST],
    again: FrameBuffer,
}

impl<B: Board> Memory<B> {
    /// Nothing in it yet.
    #[expect(clippy::new_without_default, reason = "of use in a static alone")]
    pub const fn new() -> Self {
        Self {
            programme: Programme::empty(),
            law: RunningLaw::empty(),
            stream: None,
            rig: MaybeUninit::uninit(),
            controller: MaybeUninit::uninit(),
            upload: Upload::new(),
            passivity: Passivity::EMPTY,
            received: [0; LARGEST],
            again: FrameBuffer::new(),
        }
    }
}

/// Answers requests for ever, each in `answer`.
pub fn run<B: Board>(memory: &'static mut Memory<B>, answer: &'static mut FrameBuffer) -> ! {
    let mut link = B::Link::open();
    let parts = Parts::<B> {
        programme: &mut memory.programme,
        law: &mut memory.law,
        stream: &mut memory.stream,
        rig: &mut memory.rig,
        controller: &mut memory.controller,
    };
    let mut controller = Controller::new(parts, &mut memory.upload, &mut memory.passivity);
    // Number of the next request. The one before is answered again with the same answer: it is not carried out twice.
    let mut next: u32 = 0;
    loop {
        let bytes = link.receive(&mut memory.received);
        let mut understood = false;
        for frame in Frames(bytes) {
            let sequence = frame.header.sequence;
            if sequence == next && controller.answer(&frame, answer) {
                next = next.wrapping_add(1);
                link.send(answer.bytes());
            } else if next > 0 && sequence == next.wrapping_sub(1) {
                link.send(answer.bytes());
            } else if next == 0 {
                write_refusal(sequence, &Refusal::Restarted, answer);
                link.send(answer.bytes());
            } else if sequence == 0 && is_hello(&frame) {
                B::reset();
            }
            understood = true;
        }
        if !understood {
            write_again(&mut memory.again);
            link.send(memory.again.bytes());
        }
    }
}

/// The image of the rig controller on a board: its entry, its handlers and its log.
///
/// A hard fault, or an exception that is not due, ends the image at once: it would wait for ever otherwise, deaf to the harness's
/// end. It links only where no panic can be reached.
#[macro_export]
macro_rules! rig_image {
    ($board:ty) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            // In statics, of which cortex-m-rt makes references: none of it passes through the stack. The answer has one of
            // its own: the compiler knows its address then, which saves 140 bytes of flash.
            static mut MEMORY: $crate::rig::Memory<$board> = $crate::rig::Memory::new();
            static mut ANSWER: $crate::rig::FrameBuffer = $crate::rig::FrameBuffer::new();
            $crate::rig::run(MEMORY, ANSWER)
        }

        #[cortex_m_rt::exception]
        unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
            <$board as $crate::Board>::exit(false)
        }

        #[cortex_m_rt::exception]
        unsafe fn DefaultHandler(_: i16) -> ! {
            <$board as $crate::Board>::exit(false)
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo) -> ! {
            unsafe extern "C" {
                /// Defined nowhere: the image links only where no panic can be reached.
                fn a_panic_can_be_reached() -> !;
            }
            // SAFETY: never linked.
            unsafe { a_panic_can_be_reached() }
        }

        const _: () = {
            use $crate::rig::{defmt, log};

            static CHANNEL: log::Channel<<$board as $crate::Board>::Log> = log::Channel::new();

            #[defmt::global_logger]
            struct Logger;

            // SAFETY: what `acquire` takes, `release` gives back, and defmt does not nest them.
            unsafe impl defmt::Logger for Logger {
                fn acquire() {
                    log::acquire();
                }
                unsafe fn flush() {}
                unsafe fn release() {
                    // SAFETY: defmt has acquired it.
                    unsafe { log::release(&CHANNEL) }
                }
                unsafe fn write(bytes: &[u8]) {
                    // SAFETY: as above.
                    unsafe { log::write(bytes) }
                }
            }
        };
    };
}
