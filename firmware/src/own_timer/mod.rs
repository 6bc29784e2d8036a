//! The rig controller on the board's own timer.
//!
//! SysTick's interrupt owns the rig: it runs a tick, queues telemetry, and then carries out one request of the harness, if there is
//! one. The main loop owns the serial port: it converts between frames and bytes. Neither waits for the other. If the harness does
//! not read, the main loop waits at the port, the queue fills up, and telemetry is lost; ticks continue.

mod ticker;

use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering::Release, compiler_fence};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use heapless::Vec;
use heapless::spsc::{Consumer, Producer, Queue};

use mesh_damper::frame::{FrameBuffer, LARGEST};
use mesh_damper::telemetry::{Channel, Sender};

use crate::board::{OwnTimer, Port};
use crate::port::add;
use crate::rig::Memory;
pub use ticker::Ticker;

/// Rows of telemetry that may wait for the port: at 1 kHz a quarter of a second.
const ROWS: usize = 256;
/// Requests in progress, and one place that stays empty.
const REQUESTS: usize = 2;
/// Rate of the ticks before there is a rig, Hz.
const IDLE_RATE: f32 = 1000.0;
/// Fraction of a second after which an incomplete frame is given up: longer than any gap between two of its bytes.
const PATIENCE: u32 = 20;

type Bytes = Vec<u8, LARGEST>;

/// The state of both sides. It belongs into a static.
pub struct Whole<B: OwnTimer> {
    rig: Memory<B>,
    channel: Channel<ROWS>,
    requests: Queue<Bytes, REQUESTS>,
    answers: Queue<FrameBuffer, REQUESTS>,
    frame: FrameBuffer,
}

impl<B: OwnTimer> Whole<B> {
    /// Initially empty.
    #[expect(clippy::new_without_default, reason = "of use in a static alone")]
    pub const fn new() -> Self {
        Self {
            rig: Memory::new(),
            channel: Channel::new(),
            requests: Queue::new(),
            answers: Queue::new(),
            frame: FrameBuffer::new(),
        }
    }
}

/// Passed from the start code to the interrupt, which then owns it.
pub struct HandedOver<B: OwnTimer>(UnsafeCell<Option<Ticker<B>>>);

// SAFETY: the start code writes it before it enables SysTick's interrupt, and only that interrupt uses it from then on.
unsafe impl<B: OwnTimer> Sync for HandedOver<B> {}

impl<B: OwnTimer> HandedOver<B> {
    /// Initially empty.
    #[expect(clippy::new_without_default, reason = "of use in a static alone")]
    pub const fn new() -> Self {
        Self(UnsafeCell::new(None))
    }

    /// The work of SysTick's interrupt.
    ///
    /// # Safety
    /// Call it only from SysTick's interrupt.
    #[inline]
    pub unsafe fn tick(&self) {
        // SAFETY: nobody else uses it, as above.
        if let Some(ticker) = unsafe { &mut *self.0.get() } {
            ticker.tick();
        }
    }
}

/// SysTick counts for ticks of `rate` Hz, minus one. None if SysTick does not match that rate to 1 part in 10 000; a recording's
/// time would be wrong by the difference.
fn reload<B: OwnTimer>(rate: f32) -> Option<u32> {
    let clock = B::SYSTICK as f32 * 1e6;
    let counts = clock / rate;
    let rounded = (counts + 0.5) as u32;
    let error = (rounded as f32 - counts).abs();
    ((2..=1 << 24).contains(&rounded) && error <= 1e-4 * counts).then(|| rounded - 1)
}

/// Makes SysTick interrupt `reload` counts and one after its last interrupt.
fn set_timer(timer: &mut SYST, reload: u32) {
    timer.set_reload(reload);
    timer.clear_current();
}

/// Runs the board forever.
pub fn run<B: OwnTimer>(whole: &'static mut Whole<B>, handed_over: &'static HandedOver<B>) -> ! {
    B::prepare();
    let port = B::Port::open();
    B::start_clock();
    let (recorder, telemetry) = whole.channel.split();
    let (put_request, requests) = whole.requests.split();
    let (put_answer, answers) = whole.answers.split();
    // SAFETY: nobody else uses SysTick.
    let mut timer = unsafe { cortex_m::Peripherals::steal() }.SYST;
    timer.set_clock_source(SystClkSource::Core);
    set_timer(&mut timer, reload::<B>(IDLE_RATE).unwrap_or((1 << 24) - 1));
    let ticker = Ticker::new(&mut whole.rig, recorder, requests, put_answer);
    // SAFETY: SysTick does not interrupt yet, and the fence orders this before it is enabled.
    unsafe { *handed_over.0.get() = Some(ticker) };
    compiler_fence(Release);
    timer.enable_interrupt();
    timer.enable_counter();
    let mut talker = Talker::<B> {
        port,
        begun: [0; LARGEST],
        came: 0,
        last: 0,
        requests: put_request,
        answers,
        telemetry,
        frame: &mut whole.frame,
    };
    loop {
        talker.turn();
        B::wait();
    }
}

/// The main loop's side.
struct Talker<B: OwnTimer> {
    port: B::Port,
    /// An incomplete frame, its bytes so far, and the arrival time of the last one.
    begun: [u8; LARGEST],
    came: usize,
    last: u32,
    requests: Producer<'static, Bytes>,
    answers: Consumer<'static, FrameBuffer>,
    telemetry: Sender<'static>,
    frame: &'static mut FrameBuffer,
}

impl<B: OwnTimer> Talker<B> {
    fn turn(&mut self) {
        if let Some(answer) = self.answers.peek() {
            send::<B>(&mut self.port, answer.bytes());
            self.answers.dequeue();
        }
        if self.telemetry.next(self.frame) {
            send::<B>(&mut self.port, self.frame.bytes());
        }
        self.receive();
    }

    fn receive(&mut self) {
        // A waiting request is not overtaken.
        while self.requests.ready() {
            let Some(byte) = self.port.take() else { break };
            self.last = B::clock();
            if add(byte, &mut self.begun, &mut self.came) {
                let bytes = self.begun.get(..self.came).unwrap_or_default();
                // It is as long as the longest frame.
                if let Ok(bytes) = Bytes::from_slice(bytes) {
                    let _ = self.requests.enqueue(bytes);
                }
                self.came = 0;
            }
        }
        if self.came > 0 && B::clock().wrapping_sub(self.last) > B::CLOCK / PATIENCE {
            self.came = 0;
        }
    }
}

/// Waits for room: a port accepts nothing if its other end does not read.
fn send<B: OwnTimer>(port: &mut B::Port, bytes: &[u8]) {
    for byte in bytes {
        while !port.put(*byte) {
            B::wait();
        }
    }
}

/// The image of the rig controller on the board's own timer.
///
/// A hard fault, an unexpected exception, or a panic restarts the board: its enable line is low then, and the harness learns of it
/// at its next request. The only remaining panics are the queues' remainders, of a division by their length, which the compiler
/// cannot exclude.
#[macro_export]
macro_rules! own_timer_image {
    ($board:ty) => {
        static TICKER: $crate::own_timer::HandedOver<$board> = $crate::own_timer::HandedOver::new();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            // In a static, to which cortex-m-rt gives a reference: none of it passes through the stack.
            static mut WHOLE: $crate::own_timer::Whole<$board> = $crate::own_timer::Whole::new();
            $crate::own_timer::run(WHOLE, &TICKER)
        }

        #[cortex_m_rt::exception]
        fn SysTick() {
            // SAFETY: this is SysTick's interrupt.
            unsafe { TICKER.tick() }
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo) -> ! {
            <$board as $crate::Board>::reset()
        }

        $crate::rig_handlers!($board, <$board as $crate::Board>::reset());
    };
}
