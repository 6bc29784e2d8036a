//! Harness and emulator on one processor.
//!
//! Only one of them works at a time. On one processor the other is there as soon as this one waits; on two, each tick wakes
//! a sleeping processor twice, and a tick was seen to take six times as long.

/// While it lives, this thread and the processes that it starts stay on the processor where it was made. On systems without
/// affinity it does nothing.
#[derive(Debug)]
pub(super) struct Pin {
    #[cfg(target_os = "linux")]
    before: Option<(rustix::thread::Pid, rustix::thread::CpuSet)>,
}

#[cfg(target_os = "linux")]
impl Pin {
    pub(super) fn here() -> Self {
        use rustix::thread::{CpuSet, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};
        let before = sched_getaffinity(None).ok().map(|set| (gettid(), set));
        let mut here = CpuSet::new();
        here.set(sched_getcpu());
        // Where it may not be chosen the link is slower, and no less right.
        let _ = sched_setaffinity(None, &here);
        Self { before }
    }
}

#[cfg(target_os = "linux")]
impl Drop for Pin {
    fn drop(&mut self) {
        if let Some((thread, set)) = &self.before {
            let _ = rustix::thread::sched_setaffinity(Some(*thread), set);
        }
    }
}

#[cfg(not(target_os = "linux"))]
impl Pin {
    pub(super) fn here() -> Self {
        Self {}
    }
}
