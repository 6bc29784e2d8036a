//! A law whose type contains its effects gives the same force as one that is assembled at run time.

use std::f64::consts::TAU;
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::{
    AugmentedLaw, Compliance, Delay, Drift, Effect, EffectSet, ForceFilter, Gap, LoadFriction,
    Motion, Offset, Periodic, Relaxation, StickSlip, Temperature, Viscous,
};
use mesh_damper::fast_law::{Adaptation, FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::rig::{DamperEmulation, DamperEmulationSettings};
use mesh_damper::static_law::StaticLaw;
use mesh_damper::tick_law::TickLaw;
use mesh_damper_rig::actuator::{AdcPins, SimulatedAd5761, SimulatedAds8688, enable_line};
use proptest::prelude::*;

const TICK: f32 = 1e-4;

fn law() -> Law<f32> {
    Law::new(1.2, 30.0, 0.1, 0.3).unwrap()
}

fn running(effects: &[Effect<f32>]) -> RunningLaw<8> {
    let with = |law: AugmentedLaw<f32, 8>, effect: &Effect<f32>| law.with(*effect).unwrap();
    let augmented = effects.iter().fold(AugmentedLaw::new(law()), with);
    RunningLaw::new(FastLaw::new(augmented))
}

fn fixed<E: EffectSet<f32>>(effects: E) -> StaticLaw<E> {
    let mut fixed = StaticLaw::empty();
    fixed.set(law(), effects);
    fixed
}

/// A motion of two sines, with temperature and cycles that rise.
fn motion(tick: u32, phase: f32) -> Motion<f32> {
    let t = tick as f32 * TICK;
    let (slow, fast) = (6.0 * t + phase, 190.0 * t);
    Motion {
        acceleration: -3.6 * slow.sin() - 722.0 * fast.sin(),
        cycles: t,
        temperature: 20.0 + 5.0 * t,
        ..Motion::at(
            0.1 * slow.sin() + 0.02 * fast.sin(),
            0.6 * slow.cos() + 3.8 * fast.cos(),
        )
    }
}

/// Both laws over the same ticks, with an adaptation from the middle on, and at rest again for the last third.
fn agree(fixed: &mut impl TickLaw, running: &mut impl TickLaw, phase: f32) {
    for tick in 0..3000 {
        if tick == 1500 {
            let followed = Adaptation {
                k1: 0.1,
                k3: -0.2,
                c: 0.3,
            };
            fixed.follow(followed);
            running.follow(followed);
            assert_eq!(fixed.followed(), running.followed());
        }
        if tick == 2000 {
            fixed.rest();
            running.rest();
        }
        let motion = motion(tick, phase);
        assert_eq!(fixed.parts(&motion), running.parts(&motion), "tick {tick}");
        let (one, other) = (fixed.force(&motion), running.force(&motion));
        assert_eq!(one.to_bits(), other.to_bits(), "tick {tick}: {one} {other}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn both_compositions_give_the_same_bits(phase in 0.0f32..6.0, size in 0.1f32..2.0) {
        agree(&mut fixed(()), &mut running(&[]), phase);
        let slider = StickSlip::new(&[(size, 0.02), (0.3, 0.05)]).unwrap();
        agree(&mut fixed((slider,)), &mut running(&[Effect::StickSlip(slider)]), phase);
        let offset = Offset::new(0.02 * size).unwrap();
        let viscous = Viscous::new(1e-3 * size).unwrap();
        let load = LoadFriction::new(size).unwrap();
        let warm = Temperature::new(2e-3, 20.0).unwrap().with_damping(-1e-3).unwrap();
        let drift = Drift::new(-0.2, 4.0).unwrap().with_forces(0.1, -0.3).unwrap();
        let branch = Relaxation::new(&[(0.4 * size, 0.05)], TICK).unwrap();
        let tone = Periodic::new(&[(0.02, 49.9, 1.0)], f64::from(TICK)).unwrap();
        let effects = [
            Effect::Periodic(tone),
            Effect::Relaxation(branch),
            Effect::Drift(drift),
            Effect::Temperature(warm),
            Effect::LoadFriction(load),
            Effect::Viscous(viscous),
            Effect::Offset(offset),
        ];
        let named = (offset, viscous, load, warm, drift, branch, tone);
        agree(&mut fixed(named), &mut running(&effects), phase);
        let delay = Delay::new(1.23e-3, TICK).unwrap();
        let filter = ForceFilter::new(90.0, TICK).unwrap();
        let gap = Gap::new(0.01, true).unwrap();
        let spring = Compliance::new(25.0, TICK).unwrap();
        let effects = [
            Effect::Compliance(spring),
            Effect::Viscous(viscous),
            Effect::StickSlip(slider),
            Effect::Gap(gap),
            Effect::Delay(delay),
            Effect::ForceFilter(filter),
        ];
        let named = (viscous, slider, delay, filter, gap, spring);
        agree(&mut fixed(named), &mut running(&effects), phase);
    }
}

/// A table of 4 KiB, and the configuration and state of its effects.
#[test]
fn a_law_takes_memory_in_proportion_to_its_effects() {
    let without = size_of::<StaticLaw<()>>();
    assert!(without < 4096 + 80, "{without}");
    let slider = size_of::<StaticLaw<(StickSlip<f32>,)>>() - without;
    assert!(slider < 100, "{slider}");
    assert!(size_of::<RunningLaw<8>>() > without + 3000);
}

type Slider = (StickSlip<f32>,);

fn slider() -> StickSlip<f32> {
    StickSlip::new(&[(0.5, 0.02)]).unwrap()
}

/// A measured sine of 5 Hz at 1 kHz.
fn measured(pins: &AdcPins, tick: u32) {
    let turn = TAU * f64::from(tick) / 200.0;
    pins.volts[0].set(2.0 * turn.sin());
    pins.volts[1].set(1.5 * turn.cos());
}

fn converters() -> (
    Rc<AdcPins>,
    Ads8688<SimulatedAds8688>,
    Ad5761<SimulatedAd5761>,
) {
    let pins = Rc::<AdcPins>::default();
    let one = Scale::new(1.0, 0.0).unwrap();
    let adc = Ads8688::new(SimulatedAds8688::new(pins.clone()), one, one).unwrap();
    let dac = Ad5761::new(SimulatedAd5761::new(Rc::default()), one).unwrap();
    (pins, adc, dac)
}

/// A damper emulation that borrows a law whose type contains its effect, and one that owns a running law.
#[test]
fn an_emulator_runs_either_law() {
    let mut law = StaticLaw::<Slider>::empty();
    law.set(self::law(), (slider(),));
    let settings = DamperEmulationSettings {
        tick_rate: 1000.0,
        observer_bandwidth: 50.0,
        stop_ticks: 10,
        ..DamperEmulationSettings::default()
    };
    let (pins, adc, dac) = converters();
    let (others, other_adc, other_dac) = converters();
    let (enable, other) = (enable_line().0, enable_line().0);
    let mut damper = DamperEmulation::new(adc, dac, enable, &settings, &mut law).unwrap();
    let running = running(&[Effect::StickSlip(slider())]);
    let mut other = DamperEmulation::new(other_adc, other_dac, other, &settings, running).unwrap();
    damper.start().unwrap();
    other.start().unwrap();
    let mut cycles = 0;
    for tick in 0..2000 {
        measured(&pins, tick);
        measured(&others, tick);
        let (one, two) = (damper.tick(tick), other.tick(tick));
        assert_eq!(one, two, "tick {tick}");
        cycles += u32::from(one.report.is_some());
    }
    assert!(cycles >= 3, "{cycles}");
}
