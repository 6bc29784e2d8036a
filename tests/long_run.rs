//! 10⁶ cycles: nothing drifts, and nothing is allocated on the heap.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::adc::{Ads8688, INPUT_RANGE};
use mesh_damper::converter::Scale;
use mesh_damper::cycle::CycleAccumulator;
use mesh_damper::dac::{Ad5761, OUTPUT_RANGE};
use mesh_damper::effects::{AugmentedLaw, Effect, Motion, Relaxation, StickSlip};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::rig::{CycleReport, Rig, RigSettings, State};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use mesh_damper_rig::actuator::{AdcPins, DacPins, SimulatedAd5761, SimulatedAds8688, enable_line};

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: all calls are passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: guaranteed by the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: guaranteed by the caller.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations() -> u64 {
    ALLOCATIONS.with(Cell::get)
}

const CYCLES: u32 = 1_000_000;
const TICK_RATE: f64 = 10_000.0;
/// Ticks per cycle.
const TICKS: u32 = 20;
const FREQUENCY: f64 = TICK_RATE / TICKS as f64;
/// mm
const AMPLITUDE: f64 = 0.1;
/// Cycles whose mean is taken at the start and at the end.
const MEAN_OF: u32 = 1000;

fn programme() -> Programme<1> {
    Programme::new(TICK_RATE, 1)
        .and_then(|programme| programme.with(Block::sine(AMPLITUDE, FREQUENCY, CYCLES)?))
        .unwrap()
}

fn law() -> AugmentedLaw<f32, 2> {
    let joints = StickSlip::new(&[(1.2, 0.03), (0.5, 0.08)]).unwrap();
    let branch = Relaxation::new(&[(0.5, 2e-4)], 1e-4).unwrap();
    AugmentedLaw::new(PAPER.lookup(3.0, AMPLITUDE as f32).law)
        .with(Effect::StickSlip(joints))
        .and_then(|law| law.with(Effect::Relaxation(branch)))
        .unwrap()
}

/// Means of stiffness, energy and loss factor over [`MEAN_OF`] cycles, starting at one.
#[derive(Clone, Copy, Debug, Default)]
struct Means {
    from: u32,
    sums: [f64; 3],
}

impl Means {
    fn from(cycle: u32) -> Self {
        Self {
            from: cycle,
            ..Self::default()
        }
    }

    fn add(&mut self, number: u32, values: [f32; 3]) {
        if (self.from..self.from + MEAN_OF).contains(&number) {
            for (sum, value) in self.sums.iter_mut().zip(values) {
                *sum += f64::from(value) / f64::from(MEAN_OF);
            }
        }
    }

    #[track_caller]
    fn check(&self, end: &Self) {
        for (start, end) in self.sums.iter().zip(end.sums) {
            let drift = (end - start) / start;
            println!("{start} at the start, {drift:e} of it more at the end");
            assert!(start.abs() > 1e-3 && drift.abs() < 1e-6, "{drift:e}");
        }
    }
}

#[test]
fn generator_law_and_cycles_end_as_they_began() {
    let mut generator = SineGenerator::new(programme()).unwrap();
    let mut law = RunningLaw::new(FastLaw::new(law()));
    let mut accumulator = CycleAccumulator::<1>::new();
    // The ramp, and some cycles until the effects no longer depend on it.
    let (mut start, mut end) = (Means::from(100), Means::from(CYCLES - MEAN_OF));
    let before = allocations();
    let mut ticks = 0u64;
    loop {
        let now = generator.tick();
        if now.done {
            break;
        }
        // The phase depends only on the tick's number.
        let phase = ticks % u64::from(TICKS) * (1 << 32) / u64::from(TICKS);
        assert!(
            now.phase.wrapping_sub(phase as u32).cast_signed().abs() <= 1,
            "tick {ticks}"
        );
        assert_eq!(u64::from(now.cycle), ticks / u64::from(TICKS));
        let force = law.force(&Motion {
            acceleration: now.acceleration,
            ..Motion::at(now.displacement, now.velocity)
        });
        if let Some([cycle]) = accumulator.update(now.displacement, [force], now.phase) {
            let values = [cycle.stiffness, cycle.energy, cycle.loss_factor];
            start.add(now.cycle - 1, values);
            end.add(now.cycle - 1, values);
        }
        ticks += 1;
    }
    assert_eq!(allocations(), before);
    // Each ramp is one cycle.
    assert_eq!(ticks, u64::from(TICKS) * u64::from(CYCLES + 2));
    start.check(&end);
}

/// Actuator and specimen are as simple as possible: the displacement is the last value of the DAC, the force is that of a spring and
/// a dashpot. Only the rig's own state could drift.
#[test]
fn a_rig_in_closed_loop_ends_as_it_began() {
    let (adc, dac) = (Rc::<AdcPins>::default(), Rc::<DacPins>::default());
    let (enable, enabled) = enable_line();
    let unit = Scale::new(1.0, 0.0).unwrap();
    let settings = RigSettings {
        stop_ticks: 100,
        ..RigSettings::default()
    };
    let mut rig = Rig::new(
        Ads8688::new(SimulatedAds8688::new(adc.clone()), unit, unit).unwrap(),
        Ad5761::new(SimulatedAd5761::new(dac.clone()), unit).unwrap(),
        enable,
        &settings,
        programme(),
        RunningLaw::new(FastLaw::new(law())),
    )
    .unwrap();
    let settled = 10_000;
    let (mut start, mut end) = (Means::from(settled), Means::from(CYCLES - MEAN_OF));
    let (mut model_start, mut model_end) = (start, end);
    rig.start().unwrap();
    let before = allocations();
    let (mut ticks, mut last) = (0u64, 0.0);
    while rig.state() == State::Running {
        let displacement = dac.volts.get() / OUTPUT_RANGE;
        let force = displacement + 0.3 * (displacement - last);
        last = displacement;
        adc.volts[0].set(displacement * INPUT_RANGE);
        adc.volts[1].set(force * INPUT_RANGE);
        let telemetry = rig.tick(ticks as u32);
        ticks += 1;
        if let Some(CycleReport {
            cycle,
            measured,
            model,
            ..
        }) = telemetry.report
        {
            let values = [measured.stiffness, measured.energy, measured.loss_factor];
            start.add(cycle, values);
            end.add(cycle, values);
            let values = [model.stiffness, model.energy, model.loss_factor];
            model_start.add(cycle, values);
            model_end.add(cycle, values);
            assert_eq!(measured.ticks, TICKS as f32);
            assert!(telemetry.phase.wrapping_add(1) <= 2, "{}", telemetry.phase);
        }
    }
    assert_eq!(allocations(), before);
    assert_eq!(rig.state(), State::Done);
    assert!(!enabled.get());
    assert_eq!(ticks, u64::from(TICKS) * u64::from(CYCLES + 2) + 1);
    start.check(&end);
    model_start.check(&model_end);
}
