//! The instances by their handles. A handle is a number that is never reused, so that a freed or invented handle is detected.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::functions::Shared;

static INSTANCES: Mutex<(usize, BTreeMap<usize, Arc<Shared>>)> = Mutex::new((0, BTreeMap::new()));

fn instances() -> MutexGuard<'static, (usize, BTreeMap<usize, Arc<Shared>>)> {
    // No holder of the lock panics between two changes.
    INSTANCES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Stores an instance, and returns its handle, which is not 0.
pub fn keep(shared: Shared) -> usize {
    let mut all = instances();
    all.0 += 1;
    let handle = all.0;
    all.1.insert(handle, Arc::new(shared));
    handle
}

/// The instance of a handle.
pub fn get(handle: usize) -> Option<Arc<Shared>> {
    instances().1.get(&handle).cloned()
}

/// Releases the instance of a handle.
pub fn remove(handle: usize) -> Option<Arc<Shared>> {
    instances().1.remove(&handle)
}
