//! Shared by the tests of this program.

use mesh_damper_identify::trace::result::TraceResult;

/// The families of the effects that were found.
pub fn families(result: &TraceResult) -> Vec<&str> {
    let effects = result.effects.iter();
    effects.map(|effect| effect.family.as_str()).collect()
}
