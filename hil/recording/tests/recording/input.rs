//! A single channel as an input that drives something.

use std::fs;

use mesh_damper_recording::input::InputSignal;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::files::Reading;

fn read(text: &str, channel: Channel) -> Result<InputSignal, String> {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("in.csv");
    fs::write(&path, text).unwrap();
    InputSignal::read(&path, channel, &Reading::default()).map_err(|e| e.to_string())
}

fn rows(header: &str, row: impl Fn(i32) -> String) -> String {
    let rows: String = (0..40).map(|i| row(i) + "\n").collect();
    format!("{header}\n{rows}")
}

#[test]
fn a_force_needs_no_displacement_and_comes_in_kilonewtons() {
    let text = rows("time_ms,force_N,temperature_degC", |i| {
        format!("{},{},{}", 1000 + 2 * i, 5 * i, 20 + i)
    });
    let force = read(&text, Channel::Force).unwrap();
    assert!((force.start - 1.0).abs() < 1e-12 && (force.tick - 0.002).abs() < 1e-12);
    assert_eq!(force.values.len(), 40);
    assert!((force.values[39] - 0.195).abs() < 1e-12);
    assert!((force.temperature.unwrap()[39] - 59.0).abs() < 1e-9);
    assert_eq!(force.warning, None);
}

/// A load that is applied at once.
#[test]
fn a_channel_may_be_constant() {
    let text = rows("time_s,force_kN", |i| {
        format!("{},0.2", 0.01 * f64::from(i))
    });
    assert_eq!(read(&text, Channel::Force).unwrap().values, vec![0.2; 40]);
}

#[test]
fn a_displacement_needs_no_force_and_gaps_are_told() {
    let text = rows("time_s,displacement_um", |i| {
        let i = if i < 20 { i } else { i + 5 };
        format!(
            "{},{}",
            0.01 * f64::from(i),
            100.0 * (0.3 * f64::from(i)).sin()
        )
    });
    let base = read(&text, Channel::Displacement).unwrap();
    assert_eq!(base.values.len(), 45);
    assert!((base.values[44] - 0.1 * (0.3_f64 * 44.0).sin()).abs() < 1e-9);
    assert!(base.warning.is_some());
}

#[test]
fn what_is_missing_is_said() {
    let text = rows("time_s,force_kN", |i| format!("{},1", 0.01 * f64::from(i)));
    let error = read(&text, Channel::Displacement).unwrap_err();
    assert!(error.contains("there is no displacement column"), "{error}");
    let error = read(&text, Channel::Temperature).unwrap_err();
    assert!(error.contains("there is no temperature column"), "{error}");
    let error = read("time_s,force_kN\n0,1\n", Channel::Force).unwrap_err();
    assert!(error.contains("holds only 1 sample"), "{error}");
}

#[test]
fn noise_of_a_displacement_is_told_as_a_part_of_its_rate() {
    let base = |noise: f64| {
        // The generator of Numerical Recipes: a repeating pattern would be a tone.
        let mut random = 1_u32;
        let rows: String = (0..400)
            .map(|i| {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let shaken = noise * (f64::from(random) / f64::from(u32::MAX) - 0.5);
                let wave = (0.05 * f64::from(i)).sin();
                format!("{},{}\n", 0.01 * f64::from(i), wave + shaken)
            })
            .collect();
        let text = format!("time_s,displacement_mm\n{rows}");
        read(&text, Channel::Displacement).unwrap()
    };
    assert!(base(0.0).noise_of_rate() < 0.01);
    // Steps of 0.035 mm RMS, and differences of uniform noise of √2·0.04/√12 = 0.016 mm.
    let part = base(0.04).noise_of_rate();
    assert!((0.3..0.55).contains(&part), "{part}");
}
