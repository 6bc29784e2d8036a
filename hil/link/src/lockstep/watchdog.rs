//! Wakes a link on which bytes were lost.
//!
//! Both ends wait for one another without a limit, because a limit would cost a system call per tick. If nothing moves for a while,
//! the watchdog sends the image a byte that is no frame. The image answers that it did not understand, and the request is repeated.

use std::fs::File;
use std::io::Write as _;
use std::os::fd::AsFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time for which nothing may move.
const PATIENCE: Duration = Duration::from_millis(50);

/// The watchdog's thread, which ends when this is dropped.
#[derive(Debug)]
pub(super) struct Watchdog {
    /// Increases when a wait begins and when it ends: odd while waiting.
    moves: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
    /// Dropped to end the thread.
    alive: Option<std::sync::mpsc::Sender<()>>,
}

impl Watchdog {
    /// A watchdog for the link whose requests go into `requests`.
    ///
    /// # Errors
    /// An error of the pipe.
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
                // The waiting end notices if the other one is gone.
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
            // It cannot have failed, because it only waits and writes.
            let _ = thread.join();
        }
    }
}
