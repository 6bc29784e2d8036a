//! Long work beside the interpreter, which stays free and can interrupt it.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// How long an interrupt may have to wait. Convention: a person does not notice it.
const LOOK: Duration = Duration::from_millis(50);

/// What a thread ends with whose work nobody waits for any more.
struct Abandoned;

/// What a thread at work says.
enum Said<T> {
    Step(String),
    Done(thread::Result<T>),
}

/// Does `work` on a thread of its own, without the interpreter's lock. What `work` says of its progress is passed to `progress` on the
/// thread that called. That thread looks for signals meanwhile: after Ctrl-C, or when `progress` raises, it goes on with the
/// exception at once, and the work ends at its next step.
///
/// # Errors
/// What `progress` raised, and what a signal's handler did.
///
/// # Panics
/// Where `work` does.
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
                // Unlike a panic it says nothing.
                resume_unwind(Box::new(Abandoned));
            }
            // Nobody waits where it fails.
            let _ = sender.send(Said::Step(what.to_owned()));
        };
        // What it leaves half done is dropped with it.
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
