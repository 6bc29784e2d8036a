//! The sine in integers against f64, over a million cycles and in its ramps.

use std::f64::consts::TAU;

use mesh_damper::fixed_point::{Part, RAMP_CYCLES_MAX, Scales, Sine};

use super::{TICK_RATE, generator, tolerance, value};
use crate::largest::Largest;

#[test]
fn the_sine_stays_with_f64_over_a_million_cycles() {
    // 2469/20000 of a cycle a tick, and an amplitude that 16 bits represent exactly, so that only the sine's error appears.
    let (amplitude, frequency) = (0.75, 1234.5);
    let omega = TAU * frequency;
    let scales = Scales::new(1.0, omega, 1.0).unwrap();
    let sine = Sine {
        amplitude,
        frequency,
        cycles: 1_000_000,
        ramp_cycles: 1,
    };
    let mut generator = generator(sine, &scales);
    let [mut position, mut velocity] = [const { Largest(0.0) }; 2];
    let (mut n, mut ends) = (0_u64, 0);
    while let Some(now) = generator.tick() {
        let turn = (n * 2469) % 20_000;
        assert_eq!(u64::from(now.cycle), n * 2469 / 20_000);
        ends += u32::from(now.cycle_end);
        if !now.ramp {
            let (sin, cos) = (TAU * turn as f64 / 20_000.0).sin_cos();
            position.see(value(now.displacement) / amplitude - sin);
            velocity.see(value(now.velocity) / amplitude - cos);
            if turn % 10_000 == 0 {
                assert_eq!(now.displacement, Part::ZERO);
            }
            if turn % 10_000 == 5000 {
                assert_eq!(now.velocity, Part::ZERO);
            }
        }
        n += 1;
    }
    assert_eq!(n, (1_000_002 * 20_000_u64).div_ceil(2469));
    assert_eq!(ends, 1_000_001);
    position.check("position", tolerance::SINE);
    velocity.check("velocity", tolerance::SINE);
}

/// Velocity is the derivative of displacement from rest to rest, by differences over two ticks.
#[test]
fn ramps_begin_and_end_at_rest_and_are_smooth() {
    for ramp_cycles in [1, 3, 10] {
        let (amplitude, frequency) = (0.1, 2.0);
        let speed = TAU * frequency * amplitude;
        let scales = Scales::new(0.125, 2.0, 1.0).unwrap();
        let sine = Sine {
            amplitude,
            frequency,
            cycles: 2,
            ramp_cycles,
        };
        let mut generator = generator(sine, &scales);
        let mut samples = Vec::new();
        while let Some(now) = generator.tick() {
            samples.push((value(now.displacement) * 0.125, value(now.velocity) * 2.0));
        }
        assert!(generator.tick().is_none());
        assert_eq!(samples.len() as u32, (2 + 2 * ramp_cycles) * 5000);
        assert_eq!(samples[0], (0.0, 0.0));
        let (last, _) = samples[samples.len() - 1];
        assert!(last.abs() < 1e-9);
        let (mut error, mut peak) = (Largest::default(), Largest::default());
        for three in samples.windows(3) {
            let slope = (three[2].0 - three[0].0) * 0.5 * TICK_RATE;
            error.see((slope - three[1].1) / speed);
            peak.see(three[1].0);
        }
        // (ω·h)²/6 of the differences is 2.6e-7, in the ramp about ten times that. A position error of 2⁻²² of the amplitude between
        // two ticks, ω·h = 1.3e-3 apart, is 4e-4 of the speed.
        error.check("velocity over peak speed", 5e-4);
        assert!((peak.0 / amplitude - 1.0).abs() < tolerance::POSITION);
    }
}

/// 10s³ − 15s⁴ + 6s⁵ of the amplitude after the fraction s of the ramp, measured over stretches of 40 cycles.
#[test]
fn the_longest_ramp_goes_up_and_down_by_its_quintic() {
    const STRETCHES: u32 = RAMP_CYCLES_MAX / 40;
    let (amplitude, frequency) = (0.9, 1234.5);
    let scales = Scales::new(1.0, TAU * frequency, 1.0).unwrap();
    let sine = Sine {
        amplitude,
        frequency,
        cycles: 1,
        ramp_cycles: RAMP_CYCLES_MAX,
    };
    let mut generator = generator(sine, &scales);
    let [mut up, mut down] = [const { [const { Largest(0.0) }; STRETCHES as usize] }; 2];
    while let Some(now) = generator.tick() {
        let stretch = if !now.ramp {
            continue;
        } else if now.cycle < RAMP_CYCLES_MAX {
            &mut up[(now.cycle / 40) as usize]
        } else {
            &mut down[(STRETCHES - 1 - (now.cycle - RAMP_CYCLES_MAX - 1) / 40) as usize]
        };
        stretch.see(value(now.displacement) / amplitude);
        stretch.see(value(now.velocity) / amplitude);
    }
    let quintic = |stretch: u32| {
        let s = f64::from(stretch) / f64::from(STRETCHES);
        s * s * s * (10.0 - s * (15.0 - 6.0 * s))
    };
    for (stretch, (up, down)) in (0..STRETCHES).zip(up.iter().zip(&down)) {
        let (lowest, highest) = (quintic(stretch), quintic(stretch + 1));
        for peak in [up.0, down.0] {
            // 324 samples of a stretch miss the peak by at most (π/324)²/2 = 5e-5 of it.
            let range = lowest * (1.0 - 5e-5) - tolerance::POSITION..highest + tolerance::POSITION;
            assert!(range.contains(&peak), "{stretch}: {peak} not in {range:?}");
        }
    }
}
