//! The damper of docs/firmware.md: measured motion in, the law's force out.

use core::hint::black_box;

use mesh_damper::amplitude_independent::{self, Effects};
use mesh_damper::converter::Scale;
use mesh_damper::rig::{DamperEmulation, DamperEmulationSettings, EmulationController, Wiring};
use mesh_damper::static_law::StaticLaw;

use super::TICKS;
use crate::board::{Board, Converters as _};

static mut LAW: StaticLaw<Effects> = StaticLaw::empty();

/// Fills the law in place, connects the converters, and ticks.
pub fn damper<B: Board>(_: &mut B::Link) -> Option<()> {
    // SAFETY: an image calls this once.
    let law = unsafe { (&raw mut LAW).as_mut() }?;
    let (mixed, effects) = amplitude_independent::parts(black_box(3.0)).ok()?;
    law.set(mixed, effects);
    let (travel, force) = (Scale::new(0.5, 0.0).ok()?, Scale::new(5.0, 0.0).ok()?);
    let wiring = Wiring {
        displacement: travel,
        force,
        command: force,
    };
    let (sensors, actuator) = B::Converters::open(&wiring)?;
    let settings = DamperEmulationSettings::default();
    let controller = EmulationController::new(&settings, &wiring, law).ok()?;
    let mut damper = DamperEmulation::wire(controller, sensors, actuator);
    damper.start().ok()?;
    for clock in 0..TICKS {
        black_box(damper.tick(clock.into()));
    }
    Some(())
}
