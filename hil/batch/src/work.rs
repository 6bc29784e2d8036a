//! Workers that take one task after another.

use std::any::Any;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use mesh_damper_output::error::InputError;
use rayon::ThreadPoolBuilder;

/// The threads that do the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Workers {
    /// Tasks at the same time.
    count: usize,
    /// Threads of each task.
    threads: usize,
}

impl Workers {
    /// `jobs` workers with one thread each: a single trace is only partly parallel, and traces next to each other do not wait for
    /// each other. With fewer tasks, each has several threads.
    pub fn for_tasks(jobs: NonZeroUsize, tasks: usize) -> Self {
        let count = jobs.get().min(tasks.max(1));
        Self {
            count,
            threads: jobs.get() / count,
        }
    }
}

/// Calls `work` for 0 to `tasks`, each once, in order. After an error no further task begins.
///
/// # Errors
/// The first error of `work`, or threads that cannot be started.
///
/// # Panics
/// If `work` panics.
pub(crate) fn each(
    workers: Workers,
    tasks: usize,
    work: impl Fn(usize) -> Result<(), InputError> + Sync,
) -> Result<(), InputError> {
    let next = AtomicUsize::new(0);
    let broken = AtomicBool::new(false);
    let first = Mutex::new(None);
    let fail = |end| {
        broken.store(true, Ordering::Relaxed);
        let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(end);
    };
    let worker = || {
        // A trace in this pool takes no thread of another.
        let pool = match ThreadPoolBuilder::new()
            .num_threads(workers.threads)
            .build()
        {
            Ok(pool) => pool,
            Err(error) => {
                let problem = format!("cannot start its threads: {error}");
                return fail(End::Error(InputError::new("--jobs", problem, "give fewer")));
            }
        };
        while !broken.load(Ordering::Relaxed) {
            let which = next.fetch_add(1, Ordering::Relaxed);
            if which >= tasks {
                return;
            }
            // Nothing of it is used after a panic, which continues in the calling thread.
            match catch_unwind(AssertUnwindSafe(|| pool.install(|| work(which)))) {
                Ok(Ok(())) => {}
                Ok(Err(error)) => fail(End::Error(error)),
                Err(panic) => fail(End::Panic(panic)),
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers.count {
            scope.spawn(worker);
        }
    });
    match first.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(End::Error(error)) => Err(error),
        Some(End::Panic(panic)) => resume_unwind(panic),
        None => Ok(()),
    }
}

/// The reason why the work ended early.
enum End {
    Error(InputError),
    Panic(Box<dyn Any + Send>),
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn workers(jobs: usize, tasks: usize) -> Workers {
        Workers::for_tasks(NonZeroUsize::new(jobs).unwrap(), tasks)
    }

    #[test]
    fn every_task_is_done_once_and_within_the_threads_asked_for() {
        for (jobs, tasks, threads) in [(1, 20, 1), (3, 20, 1), (4, 2, 2), (8, 3, 2), (4, 0, 4)] {
            let workers = workers(jobs, tasks);
            let done = Mutex::new(Vec::new());
            each(workers, tasks, |which| {
                assert_eq!(rayon::current_num_threads(), threads);
                done.lock().unwrap().push(which);
                Ok(())
            })
            .unwrap();
            let done = done.into_inner().unwrap();
            assert_eq!(done.len(), tasks);
            assert_eq!(done.into_iter().collect::<BTreeSet<_>>().len(), tasks);
        }
    }

    #[test]
    fn after_an_error_no_task_is_begun() {
        let done = AtomicUsize::new(0);
        let error = each(workers(1, 10), 10, |which| {
            done.fetch_add(1, Ordering::Relaxed);
            match which {
                4 => Err(InputError::new("5", "is odd", "leave it out")),
                _ => Ok(()),
            }
        });
        assert!(error.unwrap_err().to_string().contains("is odd"));
        assert_eq!(done.into_inner(), 5);
    }
}
