//! Wakes a link on which something was lost.
//!
//! Both ends wait for one another without a limit, as a limit would cost a system call a tick. Where nothing moves for a
//! while, this sends the image a byte that is no frame: it answers that it did not understand, and is asked again.

use std::fs::File;
use std::io::Write as _;
use std::os::fd::AsFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

/// For how long nothing may move.
const PATIENCE: Duration = Duration::from_millis(50);

/// The thread that watches; it ends when this is dropped.
#[derive(Debug)]
pub(super) struct Watchdog {
    /// Goes up when a wait begins and when it ends: odd while waiting.
    moves: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
    /// Dropped to end the thread.
    alive: Option<std::sync::mpsc::Sender<()>>,
}

impl Watchdog {
    /// Over the link whose requests go into `requests`.
    ///
    /// # Errors
    /// The pipe's.
    pub(super) fn over(requests: &impl AsFd) -> std::io::Result<Self> {
        let mut requests = File::from(requests.as_fd().try_clone_to_owned()?);
        let moves = Arc::new(AtomicU64::new(0));
        let (alive, dropped) = std::sync::mpsc::channel::<()>();
        let seen = moves.clone();
        let thread = std::thread::spawn(move || {
            let mut last = 0;
            while dropped.recv_timeout(PATIENCE) == Err(std::sync::mpsc::RecvTimeoutError::Timeout)
            {
                let now = seen.load(Relaxed);
                // Nobody there is seen by who waits.
                if now == last && now % 2 == 1 && requests.write_all(&[0]).is_err() {
                    return;
                }
                last = now;
            }
        });
        Ok(Self {
            moves,
            thread: Some(thread),
            alive: Some(alive),
        })
    }

    /// The link waits for the image.
    pub(super) fn wait_begins(&self) {
        self.moves.fetch_add(1, Relaxed);
    }

    /// The image has answered.
    pub(super) fn wait_ends(&self) {
        self.moves.fetch_add(1, Relaxed);
    }
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        self.alive.take();
        if let Some(thread) = self.thread.take() {
            // It cannot have failed: it only waits and writes.
            let _ = thread.join();
        }
    }
}
