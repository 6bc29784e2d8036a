//! The simulated actuator, sensors and converters against closed forms and their datasheets.

use std::f64::consts::TAU;
use std::rc::Rc;

use embedded_hal::spi::SpiDevice;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_rig::actuator::{
    AdcPins, DacPins, Sensor, SensorConfig, SensorFault, Servo, ServoConfig, SimulatedAd5761,
    SimulatedAds8688,
};
use mesh_damper_rig::specimen::{DamperForce, Specimen};

const STEP: f64 = 1e-4;

/// F = k·y, or a wall that starts at 0.
#[derive(Clone)]
struct Spring(f64);

impl DamperForce for Spring {
    fn force(&mut self, _: f64, y: f64, _: f64, _: f64, _: f64) -> f64 {
        self.0 * y
    }
    fn temperature(&self) -> f64 {
        20.0
    }
}

/// A small machine with limits within reach.
fn frictionless() -> ServoConfig {
    ServoConfig {
        force_limit: 25.0,
        oil_stiffness: 2000.0,
        leakage: 0.1,
        coulomb: 0.0,
        stiction: 0.0,
        ..ServoConfig::default()
    }
}

#[test]
fn leakage_gives_the_position_loop_its_droop() {
    let config = frictionless();
    let k = 9.0;
    let mut servo = Servo::new(config, STEP, Spring(k)).unwrap();
    for _ in 0..20_000 {
        servo.advance(0.1, true);
    }
    // At rest q = leakage·P with P = k·x, and gain·(command − x) = q/√(1 − P/force_limit).
    let x = servo.displacement();
    // Without throttling, which contributes 2 % of a droop of 6e-4 mm:
    assert!(config.gain == 150.0 && config.leakage == 0.1);
    let throttling = (1.0 - k * x / config.force_limit).sqrt();
    let balance = config.gain * (0.1 - x) * throttling - config.leakage * k * x;
    // The balance of forces is met to 2e-5 kN; leakage turns that into 6e-6 mm/s.
    assert!(balance.abs() < 1e-5, "{balance}");
    assert!((x - 0.1 * 150.0 / 150.9).abs() < 2e-5, "{x}");
}

/// Linear for small opening and load: the transfer function of valve, oil column and mass, calculated in complex numbers.
#[test]
fn frequency_response_is_the_transfer_function() {
    let config = frictionless();
    let (k, amplitude) = (5.0, 1e-3);
    for frequency in [1.0, 5.0, 10.0, 20.0] {
        let mut servo = Servo::new(config, STEP, Spring(k)).unwrap();
        let w = TAU * frequency;
        let cycle = (1.0 / (frequency * STEP)).round() as usize;
        let (mut re, mut im) = (0.0, 0.0);
        for tick in 0..cycle * 30 {
            let phase = w * STEP * tick as f64;
            servo.advance(amplitude * phase.sin(), true);
            if tick >= cycle * 10 {
                // After `advance` the time is one step past its command.
                let now = phase + w * STEP;
                re += servo.displacement() * now.sin();
                im += servo.displacement() * now.cos();
            }
        }
        let scale = 2.0 / (amplitude * (cycle * 20) as f64);
        let measured = C(re * scale, im * scale);

        let s = C(0.0, w);
        let wv = TAU * config.valve_frequency;
        let valve = C(wv * wv, 0.0)
            / (s * s + C(2.0 * config.valve_damping * wv, 0.0) * s + C(wv * wv, 0.0));
        // P = K·(q − v)/(s + K·leakage) = m·s·v + viscous·v + k·x, v = s·x.
        let column =
            C(config.oil_stiffness, 0.0) / (s + C(config.oil_stiffness * config.leakage, 0.0));
        let mass = C(config.mass * 1e-6, 0.0);
        let per_flow =
            column / (mass * s * s + C(config.viscous, 0.0) * s + C(k, 0.0) + column * s);
        let open = C(config.gain, 0.0) * valve * per_flow;
        let expected = open / (C(1.0, 0.0) + open) * C(0.0, -w * config.dead_time).exp();
        let error = (measured - expected).abs();
        // First-order integration: half a step or one step of delay at each of five integrators, ω·STEP each.
        assert!(error < 2.5 * w * STEP + 1e-3, "{error} at {frequency} Hz");
        assert!(expected.1 < -0.03, "the lag is there to be corrected");
    }
}

#[derive(Clone, Copy)]
struct C(f64, f64);
impl C {
    fn abs(self) -> f64 {
        self.0.hypot(self.1)
    }
    fn exp(self) -> C {
        C(self.0.exp() * self.1.cos(), self.0.exp() * self.1.sin())
    }
}
impl std::ops::Add for C {
    type Output = C;
    fn add(self, o: C) -> C {
        C(self.0 + o.0, self.1 + o.1)
    }
}
impl std::ops::Sub for C {
    type Output = C;
    fn sub(self, o: C) -> C {
        C(self.0 - o.0, self.1 - o.1)
    }
}
impl std::ops::Mul for C {
    type Output = C;
    fn mul(self, o: C) -> C {
        C(self.0 * o.0 - self.1 * o.1, self.0 * o.1 + self.1 * o.0)
    }
}
impl std::ops::Div for C {
    type Output = C;
    fn div(self, o: C) -> C {
        let square = o.0 * o.0 + o.1 * o.1;
        let up = self * C(o.0, -o.1);
        C(up.0 / square, up.1 / square)
    }
}

#[test]
fn the_valve_limits_the_velocity() {
    let config = frictionless();
    let mut servo = Servo::new(config, STEP, Spring(0.0)).unwrap();
    for _ in 0..3000 {
        servo.advance(1000.0, true);
    }
    // Steady: the pressure carries the viscous friction alone, and leaks.
    let v = servo.velocity();
    let p = config.viscous * v;
    let expected =
        config.flow_velocity * (1.0 - p / config.force_limit).sqrt() - config.leakage * p;
    // The balance of forces is met to 2e-5 kN, which viscous friction and leakage turn into less than 0.01 mm/s.
    assert!((v - expected).abs() < 0.01, "{v}, not {expected}");
    assert!(v > 147.0);
}

#[test]
fn the_supply_limits_the_force() {
    // A light piston: a heavy one would keep swinging on the specimen, beyond the supply's force.
    let config = ServoConfig {
        mass: 1.0,
        ..frictionless()
    };
    let mut servo = Servo::new(config, STEP, Spring(100.0)).unwrap();
    for _ in 0..20_000 {
        servo.advance(10.0, true);
    }
    // Full opening against 25 kN: flow·√(1 − P/limit) = leakage·P leaves P 0.03 % short, and the throttling of the step before lets
    // P swing about it.
    let p = servo.force();
    assert!((p / config.force_limit - 1.0).abs() < 5e-3, "{p}");
}

#[test]
fn friction_holds_the_piston() {
    let config = ServoConfig {
        leakage: 0.3,
        coulomb: 0.02,
        stiction: 0.03,
        ..ServoConfig::default()
    };
    let mut servo = Servo::new(config, STEP, Spring(1.0)).unwrap();
    // P settles at gain·command/leakage = 0.02 kN, below the 0.03 kN of stiction.
    for _ in 0..20_000 {
        servo.advance(4e-5, true);
    }
    assert_eq!(servo.displacement(), 0.0);
    for _ in 0..20_000 {
        servo.advance(8e-5, true);
    }
    assert!(servo.displacement() > 1e-5);
}

#[test]
fn without_enable_it_stays() {
    let mut servo = Servo::new(ServoConfig::default(), STEP, Spring(1.0)).unwrap();
    for _ in 0..5_000 {
        servo.advance(0.2, false);
    }
    assert_eq!(servo.displacement(), 0.0);
}

/// The damping force of the stiffest cell of Tables 8 and 9 nearly jumps where the velocity changes sign.
#[test]
fn a_steep_damping_force_does_not_rattle() {
    let specimen = Specimen::new(Coefficients::new(9.3548, 18.5, 0.6592, 0.1581));
    let mut servo = Servo::new(ServoConfig::default(), STEP, specimen).unwrap();
    let mut reversals = 0;
    let mut last = 0.0;
    let mut largest_step: f64 = 0.0;
    let mut force = 0.0;
    for tick in 0..40_000 {
        servo.advance(0.25 * (TAU * STEP * f64::from(tick)).sin(), true);
        if servo.velocity() * last < 0.0 {
            reversals += 1;
        }
        if servo.velocity() != 0.0 {
            last = servo.velocity();
        }
        if tick > 1_000 {
            largest_step = largest_step.max((servo.force() - force).abs());
        }
        force = servo.force();
    }
    assert_eq!(reversals, 8);
    // While the piston is at rest the force can only follow the oil column, K·h·q: 5000 kN/mm·1e-4 s·q. It rests until the reversed
    // flow has loaded the column with the force's jump of 2·c·|v|^α = 1 kN, which takes 1 kN/5000 kN/mm = 2e-4 mm. With a flow of
    // 0.25 mm·(2π)²·t the flow rises to q = √(2·2e-4·9.9) = 0.063 mm/s, which is 0.03 kN per step.
    assert!(largest_step < 0.03, "{largest_step}");
}

#[test]
fn a_sensor_has_the_noise_lag_and_offset_it_is_given() {
    let config = SensorConfig {
        full_scale: 5.0,
        noise: 0.01,
        offset: 0.2,
        lag: 2e-3,
    };
    let mut sensor = Sensor::new(config, STEP, 7, 0).unwrap();
    let quantity = |volts: f64| volts * 5.0 / 10.24;
    // After one time constant the lag has passed 1 − 1/e: 20 steps.
    let quiet = SensorConfig {
        noise: 0.0,
        ..config
    };
    let mut lagging = Sensor::new(quiet, STEP, 7, 0).unwrap();
    let after = (0..20).map(|_| lagging.sample(1.0)).last().unwrap();
    assert!((quantity(after) - 0.2 - (1.0 - (-1.0f64).exp())).abs() < 1e-12);

    let n = 100_000;
    let values: Vec<f64> = (0..n).map(|_| quantity(sensor.sample(0.0))).collect();
    let mean = values.iter().sum::<f64>() / f64::from(n);
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n);
    // Five standard errors: σ/√n of the mean, σ/√(2n) of σ.
    assert!((mean - 0.2).abs() < 5.0 * 0.01 / f64::from(n).sqrt());
    assert!((variance.sqrt() - 0.01).abs() < 5.0 * 0.01 / f64::from(2 * n).sqrt());

    let mut again = Sensor::new(config, STEP, 7, 0).unwrap();
    assert_eq!(quantity(again.sample(0.0)), values[0]);
    let mut other = Sensor::new(config, STEP, 7, 1).unwrap();
    assert_ne!(quantity(other.sample(0.0)), values[0]);

    again.fault = SensorFault::Stuck;
    assert_eq!(quantity(again.sample(3.0)), values[0]);
    again.fault = SensorFault::Open;
    assert!(again.sample(0.0) > 10.24);
}

#[test]
fn nonsense_is_refused_by_name() {
    let config = ServoConfig {
        mass: 0.0,
        ..ServoConfig::default()
    };
    let refused = Servo::new(config, STEP, Spring(1.0)).err().unwrap();
    assert_eq!(refused.to_string(), "mass = 0: must be positive");
    let config = SensorConfig {
        full_scale: 1.0,
        noise: f64::INFINITY,
        offset: 0.0,
        lag: 0.0,
    };
    let refused = Sensor::new(config, STEP, 0, 0).err().unwrap();
    assert_eq!(refused.field, "noise");
}

fn exchange(part: &mut impl SpiDevice, sent: &[u8]) -> Vec<u8> {
    let mut words = sent.to_vec();
    part.transfer_in_place(&mut words).unwrap();
    words
}

#[test]
fn the_adc_answers_as_its_datasheet_says() {
    let pins = Rc::new(AdcPins::default());
    let mut adc = SimulatedAds8688::new(pins.clone());
    pins.volts[0].set(5.12);
    pins.volts[1].set(-20.0);
    pins.volts[2].set(20.0);
    // Nothing selected yet, then channel 0 at ±10.24 V, 1, 2, and 0 again by a command that only continues.
    assert_eq!(exchange(&mut adc, &[0xC0, 0, 0, 0]), [0, 0, 0, 0]);
    assert_eq!(exchange(&mut adc, &[0xC4, 0, 0, 0]), [0, 0, 0xC0, 0]);
    assert_eq!(exchange(&mut adc, &[0xC8, 0, 0, 0]), [0, 0, 0, 0]);
    assert_eq!(exchange(&mut adc, &[0xC0, 0, 0, 0]), [0, 0, 0xFF, 0xFF]);
    assert_eq!(exchange(&mut adc, &[0, 0, 0, 0]), [0, 0, 0xC0, 0]);
    // ±5.12 V on channel 0, echoed and read back; 5.12 V is then beyond the last code.
    assert_eq!(exchange(&mut adc, &[0x0B, 1, 0]), [0, 0, 1]);
    assert_eq!(exchange(&mut adc, &[0x0A, 0, 0]), [0, 0, 1]);
    assert_eq!(exchange(&mut adc, &[0, 0, 0, 0]), [0, 0, 0xFF, 0xFF]);
    // Reset.
    exchange(&mut adc, &[0x85, 0, 0, 0]);
    assert_eq!(exchange(&mut adc, &[0x0A, 0, 0]), [0, 0, 0]);
    assert_eq!(exchange(&mut adc, &[0, 0, 0, 0]), [0, 0, 0, 0]);
    pins.bus_failing.set(true);
    assert!(adc.write(&[0, 0, 0, 0]).is_err());
}

#[test]
fn the_dac_answers_as_its_datasheet_says() {
    let pins = Rc::new(DacPins::default());
    let mut dac = SimulatedAd5761::new(pins.clone());
    let mut drive = |frame: [u8; 3]| {
        dac.write(&frame).unwrap();
        pins.volts.get()
    };
    // Clamped to ground until the range is chosen, then at midscale as requested.
    assert_eq!(drive([0x03, 0xFF, 0xFF]), 0.0);
    assert_eq!(drive([0x0F, 0, 0]), 0.0);
    assert_eq!(drive([0x04, 0x02, 0x68]), 0.0);
    assert_eq!(drive([0x03, 0, 0]), -10.0);
    assert_eq!(drive([0x03, 0xC0, 0]), 5.0);
    // The input register waits for the update.
    assert_eq!(drive([0x01, 0x40, 0]), 5.0);
    assert_eq!(drive([0x02, 0, 0]), -5.0);
    // Two's complement, then 0…5 V.
    assert_eq!(drive([0x04, 0x00, 0x80]), 5.0);
    assert_eq!(drive([0x04, 0x00, 0x03]), 1.25);
    assert_eq!(exchange(&mut dac, &[0x0C, 0, 0]), [0, 0, 0]);
    assert_eq!(exchange(&mut dac, &[0, 0, 0]), [0, 0, 0x03]);
    pins.bus_failing.set(true);
    assert!(dac.write(&[0, 0, 0]).is_err());
}
