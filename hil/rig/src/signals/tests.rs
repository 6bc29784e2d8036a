//! Each interference changes the signals as documented.

use super::*;

const LSB: f64 = 20.48 / 65536.0;

/// Voltages that arrive for `samples` V of displacement and 1 V of force, while `what` acts, at 10 kHz.
fn arrived(what: Interference, samples: impl IntoIterator<Item = f64>) -> Vec<[f64; 2]> {
    let mut signals = Signals::new(1);
    signals.begin(what);
    let samples = samples.into_iter().enumerate();
    samples
        .map(|(tick, volts)| signals.channels([volts, 1.0], tick as f64 * 1e-4))
        .collect()
}

/// The same for the displacement alone, where the force must stay unchanged.
fn displacement(on: OnChannel, samples: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let both = arrived(Interference::Channel(Channel::Displacement, on), samples);
    both.into_iter()
        .map(|[displacement, force]| {
            assert_eq!(force, 1.0);
            displacement
        })
        .collect()
}

fn constant(ticks: usize) -> impl Iterator<Item = f64> {
    std::iter::repeat_n(2.0, ticks)
}

#[test]
fn a_gain_is_there_at_once_or_comes_bit_by_bit() {
    let step = OnChannel::Gain {
        factor: 0.5,
        ticks: 0.0,
    };
    assert_eq!(displacement(step, constant(3)), [1.0; 3]);
    let drift = OnChannel::Gain {
        factor: 0.5,
        ticks: 4.0,
    };
    let arrived = displacement(drift, constant(6));
    assert_eq!(arrived, [2.0, 1.75, 1.5, 1.25, 1.0, 1.0]);
    let reversed = OnChannel::Gain {
        factor: -1.0,
        ticks: 0.0,
    };
    assert_eq!(displacement(reversed, [0.5, -0.25]), [-0.5, 0.25]);
    assert_eq!(
        displacement(OnChannel::Offset(0.5), [0.5, -0.25]),
        [1.0, 0.25]
    );
}

#[test]
fn drop_outs_begin_at_once_and_come_as_often_as_they_are_to() {
    let on = OnChannel::DropOuts {
        every: 100.0,
        samples: 2,
    };
    let arrived = displacement(on, constant(20_000));
    assert_eq!(arrived[..2], [0.0, 0.0]);
    assert!(arrived.iter().all(|volts| [0.0, 2.0].contains(volts)));
    // From one to the next there are 100 samples in addition to the two; the standard deviation of the count is 14.
    let gone = arrived.iter().filter(|volts| **volts == 0.0).count() / 2;
    assert!((150..250).contains(&gone), "{gone}");
}

#[test]
fn an_open_channel_and_a_frozen_one_show_nothing_of_the_signal() {
    let ramp = || (0..10_000).map(|tick| 1e-4 * f64::from(tick) + 3.0);
    let open = displacement(OnChannel::Open(0.05), ramp());
    let square = open.iter().map(|volts| volts * volts).sum::<f64>() / 1e4;
    assert!((square.sqrt() - 0.05).abs() < 2e-3, "{square}");
    let frozen = displacement(OnChannel::Frozen(LSB), ramp());
    assert!(frozen.iter().all(|volts| (volts - 3.0).abs() <= LSB));
    assert!(frozen.iter().any(|volts| *volts != frozen[0]));
}

#[test]
fn bursts_and_a_hum_are_added() {
    let on = OnChannel::Bursts {
        volts: 0.5,
        every: 50,
        samples: 20,
    };
    for (tick, volts) in displacement(on, constant(200)).into_iter().enumerate() {
        let in_burst = tick % 50 < 20;
        assert_eq!(volts != 2.0, in_burst, "tick {tick}");
        assert!((volts - 2.0).abs() <= 0.5);
    }
    let hum = OnChannel::Hum {
        volts: 0.1,
        frequency: 50.0,
    };
    let arrived = displacement(hum, constant(400));
    // 200 ticks per cycle.
    assert_eq!(arrived[0], 2.0);
    assert!((arrived[50] - 2.1).abs() < 1e-12 && (arrived[150] - 1.9).abs() < 1e-12);
    assert!((arrived[350] - arrived[150]).abs() < 1e-9);
}

#[test]
fn a_bit_that_is_stuck_is_so_in_every_code() {
    use crate::actuator::adc_code;
    for (bit, high) in [(11, false), (13, true)] {
        let samples: Vec<f64> = (-100..100).map(|step| 0.1 * f64::from(step)).collect();
        let arrived = displacement(OnChannel::StuckBit { bit, high }, samples.clone());
        for (before, after) in samples.into_iter().zip(arrived) {
            let (before, after) = (adc_code(before), adc_code(after));
            assert_eq!(after >> bit & 1, u16::from(high));
            assert_eq!((before ^ after) & !(1 << bit), 0);
        }
    }
}

#[test]
fn one_sample_in_many_is_another() {
    let zeros = displacement(OnChannel::ZeroOneIn(3), constant(6));
    assert_eq!(zeros, [0.0, 2.0, 2.0, 0.0, 2.0, 2.0]);
    let good = displacement(OnChannel::GoodOneIn(3), constant(6));
    assert_eq!(good, [2.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let on = OnChannel::ClampedOneIn {
        volts: 1.5,
        every: 2,
    };
    assert_eq!(displacement(on, [2.0, 2.0, -2.0]), [1.5, 2.0, -1.5]);
    let spike = displacement(OnChannel::Spike(0.5), constant(3));
    assert_eq!(spike, [2.5, 2.0, 2.0]);
}

#[test]
fn swapped_cables_show_each_the_other_and_what_ended_acts_no_more() {
    assert_eq!(arrived(Interference::Swapped, [2.0]), [[1.0, 2.0]]);
    let mut signals = Signals::new(1);
    let swapped = signals.begin(Interference::Swapped);
    let half = OnChannel::Gain {
        factor: 0.5,
        ticks: 0.0,
    };
    signals.begin(Interference::Channel(Channel::Force, half));
    // In the order in which they began.
    assert_eq!(signals.channels([2.0, 1.0], 0.0), [1.0, 1.0]);
    signals.end(swapped);
    assert_eq!(signals.channels([2.0, 1.0], 0.0), [2.0, 0.5]);
    let sensed = signals.sensed();
    assert_eq!((sensed.put_out, sensed.arrived), ([2.0, 1.0], [2.0, 0.5]));
}

#[test]
fn temperature_and_control_inputs_are_what_is_made_of_them() {
    let mut signals = Signals::new(1);
    assert_eq!(signals.temperature(20.0), 20.0);
    signals.begin(Interference::Temperature(OnTemperature::Added(30.0)));
    assert_eq!(signals.temperature(20.0), 50.0);
    signals.begin(Interference::Temperature(OnTemperature::Noise(15.0)));
    assert!((35.0..=65.0).contains(&signals.temperature(20.0)));
    signals.begin(Interference::Temperature(OnTemperature::Reads(f32::NAN)));
    assert!(signals.temperature(20.0).is_nan());
    signals.begin(Interference::Controls(9.0));
    assert_eq!(signals.controls([0.0; CONTROLS]), [9.0; CONTROLS]);
    assert!(signals.is_heard());
    signals.begin(Interference::Silence);
    assert!(!signals.is_heard());
}

#[test]
fn the_output_reaches_the_servo_as_it_is_left() {
    let output = |on, volts: &[f64]| -> Vec<(f64, bool)> {
        let mut signals = Signals::new(1);
        signals.begin(Interference::Output(on));
        volts.iter().map(|v| signals.output(*v, true)).collect()
    };
    let volts = [1.0, 2.0];
    assert_eq!(output(OnOutput::BrownOut, &volts), [(0.0, true); 2]);
    assert_eq!(output(OnOutput::Holds, &volts), [(1.0, true); 2]);
    assert_eq!(
        output(OnOutput::Gain(0.5), &volts),
        [(0.5, true), (1.0, true)]
    );
    let low = output(OnOutput::Enable(false), &volts);
    assert_eq!(low, [(1.0, false), (2.0, false)]);
}

#[test]
fn the_plant_goes_on_while_ticks_are_missing() {
    let steps = |on| -> Vec<u32> {
        let mut signals = Signals::new(1);
        signals.begin(Interference::Clock(on));
        (0..4).map(|_| signals.steps()).collect()
    };
    assert_eq!(steps(OnClock::HalfRate), [2; 4]);
    assert_eq!(steps(OnClock::Stall(500)), [501, 1, 1, 1]);
    assert_eq!(steps(OnClock::Loses(2)), [1, 2, 1, 2]);
}
