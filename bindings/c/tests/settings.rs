//! Settings in C and in the crate are the same: each field with its own number, both ways, and the defaults.

use std::mem::MaybeUninit;

use mesh_damper::health::HealthSettings;
use mesh_damper::rig::DamperEmulationSettings;
use mesh_damper_c::emulation::{EmulationSettings, md_emulation_defaults};
use mesh_damper_c::error::Error;
use mesh_damper_c::rig::{RigSettings, md_rig_defaults};

#[test]
fn each_setting_of_an_emulation_reaches_its_field() {
    let in_c = EmulationSettings {
        tick_rate: 1.0,
        displacement_limit: 2.0,
        force_limit: 3.0,
        trip_ticks: 4,
        stop_ticks: 5,
        link_ticks: 6,
        clock_rate: 10.5,
        observer_bandwidth: 7.0,
        observer_damping: 8.0,
        rest_band: 11.0,
        stuck_ticks: 12,
        temperature_coldest: 13.0,
        temperature_hottest: 14.0,
        temperature_rate: 15.0,
        hysteresis: 9.0,
    };
    let in_crate = DamperEmulationSettings {
        tick_rate: 1.0,
        displacement_limit: 2.0,
        force_limit: 3.0,
        trip_ticks: 4,
        stop_ticks: 5,
        link_ticks: 6,
        clock_rate: 10.5,
        observer_bandwidth: 7.0,
        observer_damping: 8.0,
        rest_band: 11.0,
        stuck_ticks: 12,
        temperature_range: [13.0, 14.0],
        temperature_rate: 15.0,
        hysteresis: 9.0,
    };
    assert_eq!(DamperEmulationSettings::from(&in_c), in_crate);
    assert_eq!(EmulationSettings::from(&in_crate), in_c);
}

#[test]
fn each_setting_of_a_rig_reaches_its_field() {
    let in_c = RigSettings {
        displacement_limit: 1.0,
        force_limit: 2.0,
        tracking_limit: 3.0,
        trip_ticks: 4,
        stop_ticks: 5,
        link_ticks: 6,
        clock_rate: 20.5,
        observer_bandwidth: 7.0,
        observer_damping: 8.0,
        correction_gain: 9.0,
        correction_limit: 9.5,
        lead: 10.0,
        glide: 11.0,
        feedback: 12.0,
        temperature_coldest: 12.1,
        temperature_hottest: 12.2,
        temperature_rate: 12.3,
        health_size: 13.0,
        health_false_alarm_cycles: 14.0,
        health_learning_cycles: 15,
        health_run_in_cycles: 16,
        health_temperature_slope: 17.0,
        health_run_in_size: 17.5,
        health_follow: 18.0,
    };
    let in_crate = mesh_damper::rig::RigSettings {
        displacement_limit: 1.0,
        force_limit: 2.0,
        tracking_limit: 3.0,
        trip_ticks: 4,
        stop_ticks: 5,
        link_ticks: 6,
        clock_rate: 20.5,
        observer_bandwidth: 7.0,
        observer_damping: 8.0,
        correction_gain: 9.0,
        correction_limit: 9.5,
        lead: 10.0,
        glide: 11.0,
        feedback: 12.0,
        temperature_range: [12.1, 12.2],
        temperature_rate: 12.3,
        health: HealthSettings {
            size: 13.0,
            false_alarm_cycles: 14.0,
            learning_cycles: 15,
            run_in_cycles: 16,
            temperature_slope: 17.0,
            run_in_size: 17.5,
            follow: 18.0,
        },
    };
    assert_eq!(mesh_damper::rig::RigSettings::from(&in_c), in_crate);
    assert_eq!(RigSettings::from(&in_crate), in_c);
}

/// The settings that `defaults` writes.
fn written<T>(defaults: unsafe extern "C" fn(*mut T) -> Error) -> T {
    let mut settings = MaybeUninit::uninit();
    // SAFETY: the memory is large enough for the settings, and a successful call writes all of them.
    unsafe {
        assert_eq!(defaults(settings.as_mut_ptr()), Error::None);
        settings.assume_init()
    }
}

#[test]
fn the_defaults_are_the_crates() {
    let emulation = written(md_emulation_defaults);
    assert_eq!(
        DamperEmulationSettings::from(&emulation),
        DamperEmulationSettings::default()
    );
    let rig = written(md_rig_defaults);
    assert_eq!(
        mesh_damper::rig::RigSettings::from(&rig),
        mesh_damper::rig::RigSettings::default()
    );
}
