//! A damper model as an FMI 2.0 co-simulation unit (FMU). `docs/fmu.md` is its page.
//!
//! The library is the same for every model: [`fmi2Instantiate`](functions::fmi2Instantiate) reads the model and the tick rate from the
//! FMU's resources. `hil export --format fmu` packs it with them, and with the description of its variables.
//!
//! | file | for |
//! |---|---|
//! | `contents.rs` | the contents of an FMU for one model: its resources, and the GUID made from them |
//! | `variables.rs` | the variables of a model and their value references |
//! | `units.rs` | their units in SI base units |
//! | `description.rs` | `modelDescription.xml` |
//! | `location.rs` | the folder of a resource location |
//! | `instance.rs`, `instance/` | an instance: the order of calls, a step, values, saved states |
//! | `state.rs` | everything that changes in an instance, and its bytes |
//! | `refusal.rs` | the reason why a call is refused |
//! | `handles.rs` | the instances by their handles |
//! | `types.rs` | the types of the standard's header |
//! | `functions.rs`, `functions/` | the functions of the standard, with all unsafe code |
//!
//! At the boundary the units are SI units; inside they are mm, s and kN.

pub mod contents;
pub mod description;
pub mod functions;
mod handles;
pub mod instance;
pub mod location;
pub mod refusal;
pub mod state;
pub mod types;
pub mod units;
pub mod variables;

/// Name of the library's file without its ending, as the description's `modelIdentifier`.
pub const IDENTIFIER: &str = "mesh_damper_fmu";

/// Present in every build of the library: with it a packer checks whether a file is this library, and of the same version.
pub const MARK: &str = concat!("mesh-damper-fmu ", env!("CARGO_PKG_VERSION"), " layout 1");

/// [`MARK`] in a place where a packer finds it, even if nothing else uses it.
#[used]
static MARKED: [u8; MARK.len()] = {
    let mut bytes = [0; MARK.len()];
    bytes.copy_from_slice(MARK.as_bytes());
    bytes
};
