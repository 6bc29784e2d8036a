//! The stack of each constructor that a target calls.

use core::hint::black_box;

use cortex_m::singleton;
use mesh_damper::amplitude_independent::{self, Effects};
use mesh_damper::converter::Scale;
use mesh_damper::fast_law::RunningLaw;
use mesh_damper::pack::{self, Expectation, Upload};
use mesh_damper::power::PowerSeed;
use mesh_damper::rig::{
    DamperEmulation, DamperEmulationSettings, EmulationController, Rig, RigController, RigSettings,
    Wiring,
};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::static_law::StaticLaw;

use super::call::stack_of;
use super::{PACK, say};
use crate::board::{Board, Converters as _};

type DamperLaw = StaticLaw<Effects>;
type Running = RunningLaw<8>;
type Blocks = Programme<16>;

/// Reports the stack of each.
pub fn constructors<B: Board>(link: &mut B::Link) -> Option<()> {
    let mut named = |name: &str, work: &mut dyn FnMut() -> Option<()>| {
        let mut done = None;
        let bytes = stack_of(|| done = work());
        say(link, name, bytes);
        done
    };
    let fixed = singleton!(: DamperLaw = DamperLaw::empty())?;
    let running = singleton!(: Running = Running::empty())?;
    let any = Expectation::default();
    let upload = singleton!(: Upload = Upload::new())?;
    let programme = singleton!(: Option<Blocks> = None)?;
    let (mixed, effects) = amplitude_independent::parts(black_box(3.0)).ok()?;
    named("PowerSeed::new", &mut || {
        black_box(PowerSeed::new(black_box(0.1), 0.3).ok()?);
        Some(())
    })?;
    named("amplitude_independent::parts", &mut || {
        black_box(amplitude_independent::parts(black_box(3.0)).ok()?);
        Some(())
    })?;
    named("StaticLaw::set", &mut || {
        fixed.set(mixed, effects);
        Some(())
    })?;
    named("RunningLaw::swap_with, pack::decode", &mut || {
        running
            .swap_with(|slot| pack::decode(black_box(PACK), slot, &any).map(|_| ()))
            .ok()
    })?;
    named("Upload::part, Upload::finish", &mut || {
        upload.part(0, black_box(PACK)).ok()?;
        running
            .swap_with(|slot| upload.finish(slot, &any).map(|_| ()))
            .ok()
    })?;
    named("Programme::with", &mut || {
        let block = Block::sine(black_box(0.1), 5.0, 2).ok()?;
        *programme = Some(Blocks::new(10_000.0, 1000).ok()?.with(block).ok()?);
        Some(())
    })?;
    let programme = programme.as_ref()?;
    named("SineGenerator::new", &mut || {
        black_box(SineGenerator::<16, _>::new(programme).ok()?);
        Some(())
    })?;
    let scale = Scale::new(black_box(1.0), 0.0).ok()?;
    let wiring = Wiring {
        displacement: scale,
        force: scale,
        command: scale,
    };
    named("Rig::new", &mut || {
        let (sensors, actuator) = B::Converters::open(&wiring)?;
        let settings = RigSettings::default();
        let controller = RigController::new(&settings, &wiring, programme, &mut *running).ok()?;
        black_box(Rig::wire(controller, sensors, actuator));
        Some(())
    })?;
    named("DamperEmulation::new", &mut || {
        let (sensors, actuator) = B::Converters::open(&wiring)?;
        let settings = DamperEmulationSettings::default();
        let controller = EmulationController::new(&settings, &wiring, &mut *fixed).ok()?;
        black_box(DamperEmulation::wire(controller, sensors, actuator));
        Some(())
    })
}
