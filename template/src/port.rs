//! The serial port to the harness: USART2 at 115 200 baud.
//!
//! The receiver holds one byte, and the main loop sleeps from tick to tick. Hence its interrupt takes each byte into a queue.

use cortex_m::singleton;
use heapless::spsc::{Consumer, Producer, Queue};
use mesh_damper_firmware::Port;
use stm32f4xx_hal::pac::{NVIC, USART2, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::serial::{Rx, Serial, Tx};

use crate::handed::Handed;

/// Bytes that wait for the main loop: more than the longest frame, so that a request is never cut.
const RECEIVED: usize = 1024;
/// Bytes that wait for the line: as many as it takes in 22 ms.
const TO_SEND: usize = 256;

/// The main loop's end.
pub struct Uart {
    received: Consumer<'static, u8>,
    to_send: Producer<'static, u8>,
}

/// The interrupt's end.
struct Line {
    receiver: Rx<USART2>,
    transmitter: Tx<USART2>,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
}

static UART: Handed<Uart> = Handed::new();
static LINE: Handed<Line> = Handed::new();

/// Hands `serial` to the port, and lets its interrupt come. Once.
pub fn prepare(serial: Serial<USART2>) {
    let received = singleton!(: Queue<u8, RECEIVED> = Queue::new()).expect("prepared once");
    let to_send = singleton!(: Queue<u8, TO_SEND> = Queue::new()).expect("prepared once");
    let (put_received, received) = received.split();
    let (put_to_send, to_send) = to_send.split();
    let (transmitter, mut receiver) = serial.split();
    receiver.listen();
    UART.put(Uart {
        received,
        to_send: put_to_send,
    });
    LINE.put(Line {
        receiver,
        transmitter,
        received: put_received,
        to_send,
    });
    // SAFETY: no critical section is open that this would break.
    unsafe { NVIC::unmask(interrupt::USART2) };
}

impl Port for Uart {
    fn open() -> Self {
        UART.take().expect("prepared, and opened once")
    }

    fn take(&mut self) -> Option<u8> {
        self.received.dequeue()
    }

    fn put(&mut self, byte: u8) -> bool {
        let room = self.to_send.enqueue(byte).is_ok();
        // The interrupt owns the transmitter, and begins where that stands still.
        NVIC::pend(interrupt::USART2);
        room
    }
}

impl Line {
    fn serve(&mut self) {
        // A frame with a byte that was damaged, or that found no room, has a wrong checksum, and the harness asks again.
        if let Ok(byte) = self.receiver.read() {
            let _ = self.received.enqueue(byte);
        }
        if self.transmitter.is_tx_empty() {
            match self.to_send.dequeue() {
                Some(byte) => {
                    // It is empty, so that it takes the byte.
                    let _ = self.transmitter.write(byte);
                    self.transmitter.listen();
                }
                None => self.transmitter.unlisten(),
            }
        }
    }
}

/// A byte has come, or one has gone.
#[interrupt]
fn USART2() {
    static mut OWNED: Option<Line> = None;

    if OWNED.is_none() {
        *OWNED = LINE.take();
    }
    if let Some(line) = OWNED {
        line.serve();
    }
}
