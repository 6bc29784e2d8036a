//! Protection against decoders of other authors that panic.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind, set_hook, take_hook};
use std::path::Path;
use std::sync::Once;

use mesh_damper_output::error::InputError;

thread_local! {
    /// Whether this thread is in a decoder, whose panics mean a file that it cannot read.
    static DECODES: Cell<bool> = const { Cell::new(false) };
    /// Whether the last panic of this thread is a defect of this crate, which a test must notice.
    static IS_DEFECT: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work` with a decoder of `format`; a panic of the decoder becomes an error and writes nothing to standard error.
///
/// `work` holds code of this crate too. Its panics become errors in a release build alone; with debug assertions, as in tests and
/// under the fuzzer, they remain panics. A library's function that the compiler inlines into this crate counts as its own.
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
            let is_own = panic.location().is_some_and(|place| is_own(place.file()));
            IS_DEFECT.set(cfg!(debug_assertions) && is_own);
            if !DECODES.get() || IS_DEFECT.get() {
                before(panic);
            }
        }));
    });
    let outer = DECODES.replace(true);
    IS_DEFECT.set(false);
    let done = catch_unwind(AssertUnwindSafe(work));
    DECODES.set(outer);
    done.unwrap_or_else(|panic| match IS_DEFECT.get() {
        true => resume_unwind(panic),
        false => Err(damaged(format, file, "its decoder gave up")),
    })
}

/// Whether `file`, the source of a panic, is of this crate: it lies in the folder that this source has in the compiler's words.
/// Libraries lie in the registry.
fn is_own(file: &str) -> bool {
    let file = Path::new(file);
    // `hil/tables`, or nothing where the compiler runs in the crate's folder.
    let folder = Path::new(file!())
        .ancestors()
        .nth(3)
        .unwrap_or(Path::new(""));
    file.is_absolute() == folder.is_absolute() && file.starts_with(folder)
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

    /// Panics within a library: it is called through a pointer, because an inlined function has the place of its caller.
    fn panics_in_library() -> usize {
        type Cells = csv::StringRecord;
        let index: fn(&Cells, usize) -> &str = <Cells as std::ops::Index<usize>>::index;
        std::hint::black_box(index)(&Cells::new(), 5).len()
    }

    #[test]
    fn a_panic_of_a_library_is_an_error_of_the_file() {
        let error = guarded("MDF4", "a.mf4", || Ok(panics_in_library())).unwrap_err();
        assert!(
            error.to_string().contains("is not a complete MDF4 file"),
            "{error}"
        );
        assert!(!DECODES.get());
        assert_eq!(guarded("MDF4", "a.mf4", || Ok(1)), Ok(1));
    }

    /// The bounded fuzzing, which is built as this test, must not take a defect for a refused file.
    #[cfg(debug_assertions)]
    #[test]
    fn a_panic_of_this_crate_stays_a_panic() {
        let cells: &[u8] = &[];
        let defect = || guarded("MDF4", "a.mf4", || Ok(cells[cells.len()]));
        let panic = catch_unwind(AssertUnwindSafe(defect)).unwrap_err();
        let said = panic.downcast_ref::<String>().unwrap();
        assert!(said.contains("index out of bounds"), "{said}");
        assert!(!DECODES.get());
        // It marks no later panic of a library.
        assert!(guarded("MDF4", "a.mf4", || Ok(panics_in_library())).is_err());
    }

    #[test]
    fn a_source_of_this_crate_is_known_by_its_folder() {
        assert!(is_own(file!()));
        let beside = Path::new(file!()).with_file_name("mdf.rs");
        assert!(is_own(beside.to_str().unwrap()));
        for other in [
            "/root/.cargo/registry/src/index.crates.io-1949cf8c6b5b557f/calamine-0.38.0/src/files/guard.rs",
            "/rustc/0000000000000000000000000000000000000000/library/core/src/slice/mod.rs",
        ] {
            assert!(!is_own(other), "{other}");
        }
    }
}
