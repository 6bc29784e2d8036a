//! The compiled part of the Python package `mesh_damper`: the module `mesh_damper._core`.
//!
//! It passes arrays, numbers and strings to the crates of `hil/` and back. The functions that a user calls are written in Python,
//! in `python/mesh_damper`. Each file here has a counterpart of the same subject there.
//!
//! | file | for |
//! |---|---|
//! | `recording.rs` | recordings of files and of columns |
//! | `trace.rs` | a trace, its result and its files |
//! | `batch.rs` | traces of many recordings, and models over time |
//! | `model.rs` | a model, and the force that it predicts |
//! | `characterize.rs` | stiffness and loss factor of a recording |
//! | `respond.rs` | the motion of a mass on a model |
//! | `export.rs` | a model in files for firmware and simulations |
//! | `simulate.rs` | tests of the simulated rig |
//! | `error.rs` | refused input, as an exception with the text that the command prints |
//! | `work.rs` | long work next to the interpreter, which stays free and can interrupt it |

mod batch;
mod characterize;
mod error;
mod export;
mod model;
mod recording;
mod respond;
mod simulate;
mod trace;
mod work;

use pyo3::prelude::*;

/// The module.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    recording::add_to(module)?;
    trace::add_to(module)?;
    batch::add_to(module)?;
    model::add_to(module)?;
    characterize::add_to(module)?;
    respond::add_to(module)?;
    export::add_to(module)?;
    simulate::add_to(module)
}
