//! The compiled part of the Python package `mesh_damper`, which is `mesh_damper._core` there.
//!
//! It hands arrays, numbers and texts to the crates of `hil/` and back; what a user calls is written in Python, in `python/mesh_damper`.
//! Each file here has one of the same subject there.
//!
//! | file | for |
//! |---|---|
//! | `recording.rs` | recordings of files and of columns |
//! | `trace.rs` | a trace and what it found |
//! | `model.rs` | a model, and the force that it predicts |
//! | `error.rs` | what is refused, as an exception with the text that the command prints |
//! | `work.rs` | long work beside the interpreter, which stays free and can interrupt it |

mod error;
mod model;
mod recording;
mod trace;
mod work;

use pyo3::prelude::*;

/// The module.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    recording::add_to(module)?;
    trace::add_to(module)?;
    model::add_to(module)
}
