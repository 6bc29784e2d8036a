//! Long work next to the interpreter, which stays free and can interrupt it.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// Longest wait of an interrupt. Convention: a person does not notice it.
const LOOK: Duration = Duration::from_millis(50);

/// The payload with which a worker thread ends if no caller waits for it any more.
struct Abandoned;

/// A message of a worker thread.
enum Said<T> {
    Step(String),
    Done(thread::Result<T>),
}

/// Runs `work` on its own thread, without the interpreter's lock. The progress of `work` is passed to `progress` on the calling
/// thread, which also checks for signals. After Ctrl-C, or if `progress` raises, that thread continues with the exception at once,
/// and the work ends at its next step.
///
/// # Errors
/// The exception raised by `progress`, or by the handler of a signal.
///
/// # Panics
/// If `work` panics.
pub fn beside<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&(dyn Fn(&str) + Sync)) -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    let is_abandoned = Arc::new(AtomicBool::new(false));
    let abandoned = Arc::clone(&is_abandoned);
    thread::spawn(move || {
        let step = |what: &str| {
            if abandoned.load(Ordering::Relaxed) {
                // Unlike a panic, it prints nothing.
                resume_unwind(Box::new(Abandoned));
            }
            // If sending fails, no caller waits.
            let _ = sender.send(Said::Step(what.to_owned()));
        };
        // Anything that the work leaves half done is dropped with it.
        let done = catch_unwind(AssertUnwindSafe(|| work(&step)));
        let _ = sender.send(Said::Done(done));
    });
    let mut receiver = receiver;
    let wait = || {
        loop {
            let said;
            (receiver, said) = py.detach(|| {
                let said = receiver.recv_timeout(LOOK);
                (receiver, said)
            });
            match said {
                Ok(Said::Done(done)) => return Ok(done),
                Ok(Said::Step(what)) => {
                    if let Some(progress) = progress {
                        progress.call1((what,))?;
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(Err(Box::new(Abandoned))),
            }
            py.check_signals()?;
        }
    };
    match wait() {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(panic)) => resume_unwind(panic),
        Err(raised) => {
            is_abandoned.store(true, Ordering::Relaxed);
            Err(raised)
        }
    }
}
