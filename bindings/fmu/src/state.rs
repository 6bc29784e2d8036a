//! Everything that changes in an instance, and its bytes.
//!
//! The bytes are: 8 that name the format, 8 of the GUID's SHA-256, the state by `postcard`, and 8 of the SHA-256 of everything
//! before. Floats keep every bit.

use mesh_damper::effects::AugmentedState;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::refusal::Refusal;
use crate::variables::INPUTS;

/// The phase, by the standard's names: it determines the permitted calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Start values may be set.
    Instantiated,
    /// The first force is computed from the present inputs.
    Initialization,
    /// A step is complete, or none was made yet.
    Stepping,
    /// Values may be read.
    Terminated,
}

/// Everything that a step, a set value or a change of phase alters.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    pub(crate) phase: Phase,
    pub(crate) is_set_up: bool,
    /// s
    pub(crate) start: f64,
    /// s
    pub(crate) stop: Option<f64>,
    /// Since the start.
    pub(crate) ticks: u64,
    /// End of the last step by the master's clock, s. Its roundings add up, those of [`State::ticks`] do not.
    pub(crate) reached: f64,
    /// As set, in the units of their variables.
    pub(crate) inputs: [f64; INPUTS],
    /// Their first and second derivatives over time, for the next step.
    pub(crate) slopes: [[f64; 2]; INPUTS],
    /// mm
    pub(crate) amplitude: f64,
    /// kN
    pub(crate) force: f64,
    pub(crate) is_within: bool,
    pub(crate) law: AugmentedState<f64>,
}

/// First bytes of a state.
const MAGIC: &[u8; 8] = b"MDFMUst2";
/// Bytes of the checksum.
const CHECKSUM: usize = 8;

fn checksum(parts: &[&[u8]]) -> [u8; CHECKSUM] {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update(part);
    }
    let mut first = [0; CHECKSUM];
    first.copy_from_slice(&hash.finalize()[..CHECKSUM]);
    first
}

impl State {
    /// As bytes, for an FMU of this `guid`.
    ///
    /// # Errors
    /// Never occurs: a state consists of numbers.
    pub fn to_bytes(&self, guid: &str) -> Result<Vec<u8>, Refusal> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(checksum(&[guid.as_bytes()]));
        let state = postcard::to_stdvec(self)
            .map_err(|error| Refusal::new("FMUstate", "?", error, "save the state again"))?;
        bytes.extend(state);
        let sum = checksum(&[&bytes]);
        bytes.extend(sum);
        Ok(bytes)
    }

    /// From the bytes of [`State::to_bytes`].
    ///
    /// # Errors
    /// The bytes are no state, belong to another FMU, or are damaged.
    pub fn from_bytes(bytes: &[u8], guid: &str) -> Result<Self, Refusal> {
        let refused = |problem: &str| {
            let size = format_args!("{} bytes", bytes.len()).to_string();
            Refusal::new(
                "serializedState",
                size,
                problem,
                "give all bytes that fmi2SerializeFMUstate of this FMU wrote",
            )
        };
        let rest = bytes
            .strip_prefix(MAGIC)
            .ok_or_else(|| refused("no state of such an FMU"))?;
        let (whole, sum) = bytes
            .split_last_chunk::<CHECKSUM>()
            .filter(|_| rest.len() > 2 * CHECKSUM)
            .ok_or_else(|| refused("too short for a state"))?;
        if checksum(&[whole]) != *sum {
            return Err(refused("damaged or cut"));
        }
        let (of, state) = rest[..rest.len() - CHECKSUM].split_at(CHECKSUM);
        if checksum(&[guid.as_bytes()]) != of {
            return Err(refused("a state of another FMU"));
        }
        postcard::from_bytes(state).map_err(|_| refused("no state of this version"))
    }
}
