//! Log messages, encoded by defmt, to the board's channel: the work of the image's logger.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use critical_section::RestoreState;

use crate::board::Log;

/// Ticks of the rig so far: the time of the messages.
pub static TICKS: AtomicU32 = AtomicU32::new(0);
/// Messages that were too long or that the channel did not accept.
pub static LOST: AtomicU32 = AtomicU32::new(0);

defmt::timestamp!("{=u32}", TICKS.load(Relaxed));

/// Longest message as encoded.
const LONGEST: usize = 96;

/// Data that only the logger uses, within its critical section.
struct Owned<T>(UnsafeCell<T>);

// SAFETY: as stated above.
unsafe impl<T> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// # Safety
    /// Call it within the critical section, with one borrow at a time.
    #[expect(clippy::mut_from_ref, reason = "the caller's promise")]
    unsafe fn get(&self) -> &mut T {
        // SAFETY: the caller's promise.
        unsafe { &mut *self.0.get() }
    }
}

/// The current message.
struct Message {
    bytes: [u8; LONGEST],
    length: usize,
    whole: bool,
}

static ENCODER: Owned<defmt::Encoder> = Owned(UnsafeCell::new(defmt::Encoder::new()));
static MESSAGE: Owned<Message> = Owned(UnsafeCell::new(Message {
    bytes: [0; LONGEST],
    length: 0,
    whole: false,
}));
static INTERRUPTS: Owned<RestoreState> = Owned(UnsafeCell::new(RestoreState::invalid()));

/// Accepts a part of the message; only the encoder calls it.
fn put(bytes: &[u8]) {
    // SAFETY: the encoder runs within the critical section, and nobody else uses the message then.
    let message = unsafe { MESSAGE.get() };
    for byte in bytes {
        match message.bytes.get_mut(message.length) {
            Some(place) => *place = *byte,
            None => message.whole = false,
        }
        message.length = message.length.saturating_add(1);
    }
}

/// The channel of an image's messages; open from the first one on.
pub struct Channel<L>(Owned<Option<L>>);

impl<L> Channel<L> {
    /// Not yet open.
    #[expect(clippy::new_without_default, reason = "of use in a static alone")]
    pub const fn new() -> Self {
        Self(Owned(UnsafeCell::new(None)))
    }
}

/// Begins a message, in a critical section that lasts until [`release`].
#[inline]
pub fn acquire() {
    // SAFETY: given back in `release`; and within it from here on.
    unsafe {
        *INTERRUPTS.get() = critical_section::acquire();
        let message = MESSAGE.get();
        message.length = 0;
        message.whole = true;
        ENCODER.get().start_frame(put);
    }
}

/// Sends the message.
///
/// # Safety
/// Call it once after [`acquire`].
#[inline]
pub unsafe fn release<L: Log>(channel: &Channel<L>) {
    // SAFETY: within the critical section of `acquire`, until it is released.
    unsafe {
        ENCODER.get().end_frame(put);
        let message = MESSAGE.get();
        let channel = channel.0.get().get_or_insert_with(|| {
            let mut channel = L::open();
            // Ends any output that the board itself has written there.
            channel.send(&[0]);
            channel
        });
        let bytes = message.bytes.get(..message.length).unwrap_or_default();
        if !message.whole || !channel.send(bytes) {
            LOST.store(LOST.load(Relaxed).wrapping_add(1), Relaxed);
        }
        critical_section::release(*INTERRUPTS.get());
    }
}

/// Adds to the message.
///
/// # Safety
/// Between [`acquire`] and [`release`].
#[inline]
pub unsafe fn write(bytes: &[u8]) {
    // SAFETY: within the critical section.
    unsafe { ENCODER.get() }.write(bytes, put);
}
