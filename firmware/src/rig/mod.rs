//! The rig controller: the crate's [`mesh_damper::rig::RigController`] on a board, driven tick by tick over its link.

mod controller;
#[doc(hidden)]
pub mod log;

use core::mem::MaybeUninit;

use cortex_m as _;
/// Names that [`rig_image!`](crate::rig_image) uses.
#[doc(hidden)]
pub use {defmt, mesh_damper::frame::FrameBuffer};

use mesh_damper::fast_law::RunningLaw;
use mesh_damper::frame::{Frame, Frames, LARGEST};
use mesh_damper::message::{MAX_BLOCKS, Refusal, is_hello, is_join, write_again, write_refusal};
use mesh_damper::pack::Upload;
use mesh_damper::rig::StreamConfig;
use mesh_damper::sine::Programme;

use crate::board::{Board, Harnessed, Link as _};
pub(crate) use controller::Controller;
use controller::{EFFECTS, Excitation, Parts, WiredRig};

/// The controller's state. It belongs into a static: it would not fit on a small stack.
pub struct Memory<B: Board> {
    programme: Programme<MAX_BLOCKS>,
    law: RunningLaw<EFFECTS>,
    stream: Option<StreamConfig>,
    rig: MaybeUninit<WiredRig<B>>,
    controller: MaybeUninit<Excitation>,
    upload: Upload,
    received: [u8; LARGEST],
    again: FrameBuffer,
}

impl<B: Board> Memory<B> {
    /// Initially empty.
    #[expect(clippy::new_without_default, reason = "of use in a static alone")]
    pub const fn new() -> Self {
        Self {
            programme: Programme::empty(),
            law: RunningLaw::empty(),
            stream: None,
            rig: MaybeUninit::uninit(),
            controller: MaybeUninit::uninit(),
            upload: Upload::new(),
            received: [0; LARGEST],
            again: FrameBuffer::new(),
        }
    }
}

/// The request that an answer belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Turn {
    /// A request that has not been carried out.
    New,
    /// The previous request: the same answer is sent again.
    Repeated,
    /// A request that continues the work of the board before its restart.
    Restarted,
    /// A new partner, for whom the board is as after power-on.
    Greeting,
    /// No request.
    Stale,
}

/// Both ends take turns. A repeated request gets the same answer again: it is not carried out twice.
pub(crate) struct Turns {
    /// Number of the next request; none before the first one.
    next: Option<u32>,
}

impl Turns {
    pub(crate) const NEW: Self = Self { next: None };

    #[inline]
    pub(crate) fn of(&self, frame: &Frame<'_>) -> Turn {
        let sequence = frame.header.sequence;
        match self.next {
            Some(next) if sequence == next => Turn::New,
            _ if is_join(frame) => Turn::New,
            None if sequence == 0 => Turn::New,
            None => Turn::Restarted,
            Some(next) if sequence == next.wrapping_sub(1) => Turn::Repeated,
            Some(_) if sequence == 0 && is_hello(frame) => Turn::Greeting,
            Some(_) => Turn::Stale,
        }
    }

    /// Records that the request with this number was carried out.
    #[inline]
    pub(crate) fn taken(&mut self, sequence: u32) {
        self.next = Some(sequence.wrapping_add(1));
    }
}

impl<B: Board> Memory<B> {
    /// Answers requests, and holds the buffers for requests and for an answer to invalid ones.
    pub(crate) fn controller(
        &'static mut self,
    ) -> (
        Controller<B>,
        &'static mut [u8; LARGEST],
        &'static mut FrameBuffer,
    ) {
        let parts = Parts::<B> {
            programme: &mut self.programme,
            law: &mut self.law,
            stream: &mut self.stream,
            rig: &mut self.rig,
            controller: &mut self.controller,
        };
        let controller = Controller::new(parts, &mut self.upload);
        (controller, &mut self.received, &mut self.again)
    }
}

/// Answers requests forever, each in `answer`.
pub fn run<B: Board<Converters: Harnessed>>(
    memory: &'static mut Memory<B>,
    answer: &'static mut FrameBuffer,
) -> ! {
    B::prepare();
    let mut link = B::Link::open();
    let (mut controller, received, again) = memory.controller();
    let mut turns = Turns::NEW;
    loop {
        let bytes = link.receive(received);
        if bytes.is_empty() {
            controller.silent();
            continue;
        }
        let mut understood = false;
        for frame in Frames(bytes) {
            understood = true;
            match turns.of(&frame) {
                Turn::New => {
                    if controller.answer(&frame, answer) {
                        turns.taken(frame.header.sequence);
                    } else {
                        continue;
                    }
                }
                Turn::Repeated => {}
                Turn::Restarted => {
                    write_refusal(frame.header.sequence, &Refusal::Restarted, answer);
                }
                Turn::Greeting => B::reset(),
                Turn::Stale => continue,
            }
            link.send(answer.bytes());
        }
        if !understood {
            write_again(again);
            link.send(again.bytes());
        }
    }
}

/// The image of the rig controller on a board: its entry, its handlers and its log.
///
/// A hard fault, or an unexpected exception, ends the image at once: otherwise it would wait forever and not notice the harness's
/// end. The image links only if no panic can be reached.
#[macro_export]
macro_rules! rig_image {
    ($board:ty) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            // In statics, to which cortex-m-rt gives references: none of it passes through the stack. The answer has a separate
            // static: then the compiler knows its address, which saves 140 bytes of flash.
            static mut MEMORY: $crate::rig::Memory<$board> = $crate::rig::Memory::new();
            static mut ANSWER: $crate::rig::FrameBuffer = $crate::rig::FrameBuffer::new();
            $crate::rig::run(MEMORY, ANSWER)
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo) -> ! {
            unsafe extern "C" {
                /// Defined nowhere: the image links only if no panic can be reached.
                fn a_panic_can_be_reached() -> !;
            }
            // SAFETY: never linked.
            unsafe { a_panic_can_be_reached() }
        }

        $crate::rig_handlers!($board, <$board as $crate::Board>::exit(false));
    };
}

/// The handlers and the log of an image with a rig; it `ends` if it cannot continue.
#[doc(hidden)]
#[macro_export]
macro_rules! rig_handlers {
    ($board:ty, $ends:expr) => {
        #[cortex_m_rt::exception]
        unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
            $ends
        }

        #[cortex_m_rt::exception]
        unsafe fn DefaultHandler(_: i16) -> ! {
            $ends
        }

        const _: () = {
            use $crate::rig::{defmt, log};

            static CHANNEL: log::Channel<<$board as $crate::Board>::Log> = log::Channel::new();

            #[defmt::global_logger]
            struct Logger;

            // SAFETY: `release` gives back the critical section of `acquire`, and defmt does not nest them.
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
