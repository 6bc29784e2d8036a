//! Programmes and trials of a campaign with an image as the controller.

use mesh_damper_rig::campaign::{Outcome, Trial, run_trial_with};
use mesh_damper_rig::specimen::DamperForce;
use mesh_damper_rig::{Plan, RigRun, RigSetup, SetupError, Watch, run_controlled};

use super::{Image, ImageBench, Wire};

/// [`mesh_damper_rig::run_rig`] with an image as the controller, which must not have a rig yet.
///
/// # Errors
/// The error of a part, of the image or of the link to it, or the error of `watch`.
pub fn run_rig_on<S: DamperForce + Clone, W: Wire, const B: usize, const N: usize>(
    image: &mut Image<W>,
    setup: RigSetup<S, B, N>,
    watch: impl Watch,
) -> Result<RigRun, SetupError> {
    let plan = Plan::of(&setup);
    run_controlled(&mut ImageBench::new(setup, image)?, &plan, watch)
}

/// [`mesh_damper_rig::campaign::run_trial`] with an image as the controller, which must not have a rig yet.
///
/// # Errors
/// The errors of that function, and those of the link to the image.
pub fn run_trial_on<W: Wire>(image: &mut Image<W>, trial: &Trial) -> Result<Outcome, SetupError> {
    run_trial_with(trial, |setup| ImageBench::new(setup, image))
}
