//! The rig controller on a Cortex-M4F: the crate's [`mesh_damper::rig::Rig`], driven tick by tick over a link.
//!
//! [`board`] is all that is of the emulated board; [`controller`] is what remains on a real one.
#![no_std]
#![no_main]

#[path = "firmware/board.rs"]
mod board;
#[path = "firmware/controller.rs"]
mod controller;
#[path = "firmware/log.rs"]
mod log;

use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use cortex_m as _;
use cortex_m_rt::{ExceptionFrame, entry, exception};
use mesh_damper::frame::{FrameBuffer, Frames, LARGEST};
use mesh_damper::message::{MAX_BLOCKS, write_again};
use mesh_damper::pack::Upload;
use mesh_damper::sine::Programme;
use mesh_damper::tabulated::RunningLaw;

use controller::{Controller, EFFECTS, Parts, WiredRig};

#[entry]
fn main() -> ! {
    // In statics, of which cortex-m-rt makes references: none of it passes through the stack.
    static mut PROGRAMME: Programme<MAX_BLOCKS> = Programme::empty();
    static mut LAW: RunningLaw<EFFECTS> = RunningLaw::empty();
    static mut RIG: MaybeUninit<WiredRig> = MaybeUninit::uninit();
    static mut UPLOAD: Upload = Upload::new();
    static mut RECEIVED: [u8; LARGEST] = [0; LARGEST];
    static mut ANSWER: FrameBuffer = FrameBuffer::new();
    static mut AGAIN: FrameBuffer = FrameBuffer::new();

    let mut link = board::Link::open();
    let parts = Parts {
        programme: PROGRAMME,
        law: LAW,
        rig: RIG,
    };
    let mut controller = Controller::new(parts, UPLOAD);
    // Number of the next request. The one before is answered again with the same answer: it is not carried out twice.
    let mut next: u32 = 0;
    loop {
        let bytes = link.receive(RECEIVED);
        let mut understood = false;
        for frame in Frames(bytes) {
            let sequence = frame.header.sequence;
            if sequence == next && controller.answer(&frame, ANSWER) {
                next = next.wrapping_add(1);
                link.send(ANSWER.bytes());
            } else if sequence == next.wrapping_sub(1) {
                link.send(ANSWER.bytes());
            }
            understood = true;
        }
        if !understood {
            write_again(AGAIN);
            link.send(AGAIN.bytes());
        }
    }
}

/// A hard fault is an error in the image: the emulator ends at once, and the harness says so.
#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    board::exit(false)
}

/// No other exception is due either. Without this the image would wait for ever, deaf to the harness's end.
#[exception]
unsafe fn DefaultHandler(_: i16) -> ! {
    board::exit(false)
}

/// The image takes no interrupts; cortex-m-rt wants one at least, and fills 1 KiB where it is told of none.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 1] = [default_handler];

unsafe extern "C" {
    /// The one above, as cortex-m-rt names it for the vector table.
    #[link_name = "DefaultHandler"]
    fn default_handler();
    /// Defined nowhere: the image links only where no panic can be reached.
    fn a_panic_can_be_reached() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never linked.
    unsafe { a_panic_can_be_reached() }
}
