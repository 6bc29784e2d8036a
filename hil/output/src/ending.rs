//! The end of the program by a signal: what must be whole is finished first, and what must not outlast the program is ended with it.
//!
//! The program itself listens for signals, and calls [`end`]. Everything else says here what an end has to wait for or to do.

use std::collections::BTreeMap;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{ThreadId, current};

/// What an end has to do; it is given the end's cause in words.
type Action = Box<dyn FnOnce(&str) + Send>;

/// What an end has to wait for and to do.
struct Ending {
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    /// The thread that ends the program, once one does.
    ending: Option<ThreadId>,
    /// The threads of the pieces of work that must be whole.
    under_way: Vec<ThreadId>,
    next: u64,
    /// In the order in which they were added.
    actions: BTreeMap<u64, Action>,
}

/// That of this program.
static ENDING: Ending = Ending::new();

/// Work that is done whole or not at all: an end waits until this is dropped.
#[must_use = "the work has to be done while this is held"]
pub struct Whole {
    ending: &'static Ending,
    thread: ThreadId,
}

/// Begins work that an end must not cut, which should take no longer than the writing of files. Once the program is ending, this never
/// returns, unless it is a part of such work of the same thread: other work does not begin.
pub fn whole() -> Whole {
    ENDING.whole()
}

/// Has `action` done at an end, as long as the result is held. The latest action is done first.
pub fn at_end(action: impl FnOnce(&str) + Send + 'static) -> AtEnd {
    ENDING.at_end(action)
}

/// Waits for what must be whole, begins nothing more of that kind, and does what an end has to do, all of it even if a part fails.
/// `cause` says in words what ends the program. Its caller then lets the process end.
pub fn end(cause: &str) {
    ENDING.end(cause);
}

/// An action at an end, until this is dropped.
#[must_use = "nothing is done once this is dropped"]
pub struct AtEnd {
    ending: &'static Ending,
    number: u64,
}

impl Ending {
    const fn new() -> Self {
        let state = State {
            ending: None,
            under_way: Vec::new(),
            next: 0,
            actions: BTreeMap::new(),
        };
        Self {
            state: Mutex::new(state),
            changed: Condvar::new(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // No action and no work is done while it is locked, so that no panic leaves it half changed.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn once(&self, is_so: impl Fn(&State) -> bool) -> MutexGuard<'_, State> {
        let waited = self.changed.wait_while(self.lock(), |state| !is_so(state));
        waited.unwrap_or_else(PoisonError::into_inner)
    }

    fn whole(&'static self) -> Whole {
        let thread = current().id();
        // What the end itself has to do is not held up by it, nor a part of work for which it waits.
        let may_begin = |state: &State| {
            state.ending.is_none_or(|ending| ending == thread) || state.under_way.contains(&thread)
        };
        self.once(may_begin).under_way.push(thread);
        Whole {
            ending: self,
            thread,
        }
    }

    fn at_end(&'static self, action: impl FnOnce(&str) + Send + 'static) -> AtEnd {
        let mut state = self.lock();
        let number = state.next;
        state.next += 1;
        state.actions.insert(number, Box::new(action));
        AtEnd {
            ending: self,
            number,
        }
    }

    fn end(&self, cause: &str) {
        self.lock().ending = Some(current().id());
        let mut state = self.once(|state| state.under_way.is_empty());
        let actions = std::mem::take(&mut state.actions);
        drop(state);
        for action in actions.into_values().rev() {
            // A panic in one has been said, and the others are due all the same.
            let _ = catch_unwind(AssertUnwindSafe(|| action(cause)));
        }
    }
}

impl fmt::Debug for AtEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("AtEnd").field(&self.number).finish()
    }
}

impl Drop for Whole {
    fn drop(&mut self) {
        let mut state = self.ending.lock();
        let place = state.under_way.iter().position(|each| *each == self.thread);
        place.map(|place| state.under_way.swap_remove(place));
        drop(state);
        self.ending.changed.notify_all();
    }
}

impl Drop for AtEnd {
    fn drop(&mut self) {
        // Outside of the lock, because an action may hold what locks it too.
        let action = self.ending.lock().actions.remove(&self.number);
        drop(action);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::mpsc::channel;
    use std::thread;

    use super::*;

    fn fresh() -> &'static Ending {
        Box::leak(Box::new(Ending::new()))
    }

    #[test]
    fn the_latest_action_is_done_first_and_a_dropped_one_not_at_all() {
        let ending = fresh();
        let done = Arc::new(Mutex::new(Vec::new()));
        let note = |name: &'static str| {
            let done = done.clone();
            ending.at_end(move |cause| done.lock().unwrap().push(format!("{name} by {cause}")))
        };
        let _kept = [note("a"), note("b")];
        drop(note("c"));
        let _last = note("d");
        ending.end("SIGTERM");
        let done = done.lock().unwrap().clone();
        assert_eq!(done, ["d by SIGTERM", "b by SIGTERM", "a by SIGTERM"]);
    }

    #[test]
    fn an_end_waits_for_work_under_way() {
        let ending = fresh();
        let (said, heard) = channel();
        let whole = ending.whole();
        let say = said.clone();
        let end = thread::spawn(move || {
            let at_end = ending.at_end(move |_| say.send("ended").unwrap());
            ending.end("");
            drop(at_end);
        });
        while ending.lock().ending.is_none() {
            thread::yield_now();
        }
        said.send("done").unwrap();
        drop(whole);
        end.join().unwrap();
        assert_eq!(heard.try_iter().collect::<Vec<_>>(), ["done", "ended"]);
    }

    #[test]
    fn a_part_of_work_under_way_begins_though_the_program_ends() {
        let ending = fresh();
        let whole = ending.whole();
        let end = thread::spawn(move || ending.end(""));
        while ending.lock().ending.is_none() {
            thread::yield_now();
        }
        drop(ending.whole());
        assert!(!end.is_finished());
        drop(whole);
        end.join().unwrap();
    }

    #[test]
    fn an_action_that_panics_leaves_the_others_to_be_done() {
        let ending = fresh();
        let (said, heard) = channel();
        let _kept = ending.at_end(move |_| said.send(()).unwrap());
        let _panics = ending.at_end(|_| panic!("it fails"));
        ending.end("");
        assert!(heard.try_recv().is_ok());
    }
}
