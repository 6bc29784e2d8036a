//! Protection against decoders of other authors that panic.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use crate::error::InputError;

thread_local! {
    /// Whether this thread is in a decoder, whose panics mean a file that it cannot read.
    static DECODES: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work` with a decoder of `format`; a panic becomes an error and writes nothing to standard error.
///
/// # Errors
/// The errors of `work`, and a panic.
pub(super) fn guarded<T>(
    format: &str,
    file: &str,
    work: impl FnOnce() -> Result<T, InputError>,
) -> Result<T, InputError> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !DECODES.get() {
                before(panic);
            }
        }));
    });
    let outer = DECODES.replace(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    DECODES.set(outer);
    done.unwrap_or_else(|_| Err(damaged(format, file, "its decoder gave up")))
}

/// A malformed file of `format`; `why` is the decoder's message.
pub(super) fn damaged(format: &str, file: &str, why: impl std::fmt::Display) -> InputError {
    InputError::new(
        file,
        format!("is not a complete {format} file: {why}"),
        "check that it was written and copied completely",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_of_the_file() {
        let error = guarded::<()>("MDF4", "a.mf4", || panic!("index out of range")).unwrap_err();
        assert!(
            error.to_string().contains("is not a complete MDF4 file"),
            "{error}"
        );
        assert!(!DECODES.get());
        assert_eq!(guarded("MDF4", "a.mf4", || Ok(1)), Ok(1));
    }
}
