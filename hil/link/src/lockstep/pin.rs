//! Processors of the harness and of the emulators that it runs.
//!
//! Only one of harness and emulator works at a time. Where each has a processor of its own, neither needs to sleep: it looks for
//! what comes next until it is there. Where there are no two free ones, because this process runs other emulators or somebody else keeps
//! them busy, both stay on one: the other is there as soon as this one sleeps; on two, each tick would wake a sleeping processor twice,
//! and a tick was seen to take six times as long.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Numbers of those that are given away.
static TAKEN: Mutex<Vec<usize>> = Mutex::new(Vec::new());

fn taken() -> MutexGuard<'static, Vec<usize>> {
    // It is whole whoever panicked.
    TAKEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While it lives, this thread stays on one processor, and the emulator on another or the same. On systems without affinity they are
/// only counted.
#[derive(Debug)]
pub(super) struct Pin {
    harness: usize,
    emulator: usize,
    before: affinity::Before,
}

impl Pin {
    /// Takes processors, two where two are free that this thread may use. What the thread starts from now on stays on the emulator's.
    pub(super) fn of_emulator() -> Self {
        let (here, before) = affinity::now();
        let mut taken = taken();
        let mut free = before.processors();
        free.retain(|processor| !taken.contains(processor));
        // Where it is, if that is free.
        free.sort_by_key(|processor| *processor != here);
        let (harness, emulator) = match free[..] {
            [harness, emulator, ..] => (harness, emulator),
            [one] => (one, one),
            [] => (here, here),
        };
        taken.extend([harness, emulator]);
        affinity::stay_on(emulator);
        Self {
            harness,
            emulator,
            before,
        }
    }

    /// This thread stays on the harness's processor from now on, where it is to be `apart`, and on the emulator's otherwise.
    pub(super) fn of_harness(&self, apart: bool) {
        affinity::stay_on(if apart { self.harness } else { self.emulator });
    }

    /// Whether each has a processor of its own.
    pub(super) fn is_apart(&self) -> bool {
        self.harness != self.emulator
    }
}

impl Drop for Pin {
    fn drop(&mut self) {
        let mut taken = taken();
        for given in [self.harness, self.emulator] {
            if let Some(at) = taken.iter().position(|processor| *processor == given) {
                taken.swap_remove(at);
            }
        }
        self.before.restore();
    }
}

#[cfg(target_os = "linux")]
mod affinity {
    use rustix::thread::{CpuSet, Pid, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};

    /// Where a thread could be.
    #[derive(Debug)]
    pub struct Before(Option<(Pid, CpuSet)>);

    /// Where this thread is and may be.
    pub fn now() -> (usize, Before) {
        let set = sched_getaffinity(None).ok();
        (sched_getcpu(), Before(set.map(|set| (gettid(), set))))
    }

    /// Keeps this thread on `processor`. Where it may not be chosen the link is slower, and no less right.
    pub fn stay_on(processor: usize) {
        let mut set = CpuSet::new();
        set.set(processor);
        let _ = sched_setaffinity(None, &set);
    }

    impl Before {
        pub fn processors(&self) -> Vec<usize> {
            let Some((_, set)) = &self.0 else {
                return Vec::new();
            };
            (0..CpuSet::MAX_CPU).filter(|at| set.is_set(*at)).collect()
        }

        pub fn restore(&self) {
            if let Some((thread, set)) = &self.0 {
                let _ = sched_setaffinity(Some(*thread), set);
            }
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod affinity {
    #[derive(Debug)]
    pub struct Before;

    pub fn now() -> (usize, Before) {
        (0, Before)
    }

    pub fn stay_on(_: usize) {}

    impl Before {
        pub fn processors(&self) -> Vec<usize> {
            (0..std::thread::available_parallelism().map_or(1, usize::from)).collect()
        }

        pub fn restore(&self) {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_has_its_own_processor_as_long_as_two_are_free() {
        let count = affinity::now().1.processors().len();
        // Each in a thread of its own, as it stays on one processor from then on.
        let pins: Vec<Pin> = std::thread::scope(|scope| {
            (0..count)
                .map(|_| scope.spawn(Pin::of_emulator).join().unwrap())
                .collect()
        });
        let apart = pins.iter().filter(|pin| pin.is_apart()).count();
        assert_eq!(apart, count / 2);
        assert!(pins[..apart].iter().all(Pin::is_apart));
        let mut given = taken().clone();
        assert_eq!(given.len(), 2 * count);
        given.sort_unstable();
        given.dedup();
        assert_eq!(given.len(), count);
        drop(pins);
        assert!(taken().is_empty());
    }
}
