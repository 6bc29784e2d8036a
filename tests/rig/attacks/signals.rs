//! Attacks on the displacement and force channels stop the rig in time, or are distinguished from damage.

use std::f64::consts::TAU;

use mesh_damper::health::{Channel, HealthCause};
use mesh_damper::rig::{State, TripCause};
use mesh_damper_rig::TICK_RATE;

use super::{Attacked, BEGINS, FULL, Rig, SEEDS, noise, run};

#[test]
fn a_force_channel_that_shows_no_force_stops_the_rig_within_a_cycle() {
    for seed in 0..SEEDS {
        let mut frozen = None;
        let runs = [
            run(seed, |a| {
                if a.is_on() {
                    *a.volts[1] = 0.05 * noise(a.tick);
                }
            }),
            run(seed, |a| {
                if a.is_on() {
                    let at = *frozen.get_or_insert(*a.volts[1]);
                    *a.volts[1] = at + 3.0 * noise(a.tick) * 2.0 * FULL / 65_536.0;
                }
            }),
            run(seed, |a| {
                if a.is_on() {
                    a.condition.stiffness = 0.0;
                    a.condition.friction = 0.0;
                }
            }),
        ];
        for run in runs {
            assert_eq!(run.state, State::Faulted(TripCause::ForceLost));
            assert!(run.cycles - BEGINS < 1.0, "{}", run.cycles);
            let lost = [
                HealthCause::SensorDroppedOut(Channel::Force),
                HealthCause::SpecimenAbsent,
            ];
            let (_, event) = *run.events.last().unwrap();
            assert_eq!([Some(event.cause), event.or], lost.map(Some));
        }
    }
}

#[test]
fn a_force_that_never_was_stops_the_rig_in_its_ramp() {
    for seed in 0..SEEDS {
        let mut at = 0.0;
        let mut attack = |a: &mut Attacked<'_>| {
            *a.volts[1] = 0.05 * noise(a.tick);
            at = a.cycle;
        };
        let run = run(seed, &mut attack);
        assert_eq!(run.state, State::Faulted(TripCause::ForceLost));
        assert!(run.cycles < 2.0, "{}", run.cycles);
        let (_, event) = run.events[0];
        assert_eq!(event.cause, HealthCause::SpecimenAbsent);
        assert_eq!(
            event.or,
            Some(HealthCause::SensorDroppedOut(Channel::Force))
        );
    }
}

/// Three times the force, together with a channel that shows zero, or less than the limit, in one tick of ten.
#[test]
fn one_good_sample_in_ten_does_not_hold_a_limit_off() {
    for seed in 0..SEEDS {
        for good in [0.0, 0.8] {
            let limit = 1.5;
            let mut rig = Rig::limited(1, 45, seed, limit);
            let run = rig.run(|a| {
                if a.is_on() {
                    a.condition.stiffness = 2.5;
                    a.condition.friction = 2.5;
                    // The range is twice the amplitude, and clips beyond that.
                    let most = limit * a.amplitudes[1];
                    let shown = if a.tick.is_multiple_of(10) {
                        good * most
                    } else {
                        1.25 * most
                    };
                    *a.volts[1] = a.volts[1].clamp(-shown, shown);
                }
            });
            assert!(matches!(run.state, State::Faulted(_)), "{:?}", run.state);
            // Ten ticks, one tick in ten that reduces the count by an eighth, and the lag of the channel.
            assert!(run.beyond <= 20, "{}", run.beyond);
        }
    }
}

#[test]
fn a_displacement_that_fades_stops_the_rig_before_it_goes_a_third_too_far() {
    for seed in 0..SEEDS {
        // During the run-in, over 100 cycles; and at once.
        for over in [100.0, 0.0] {
            let run = Rig::new(1, 150, seed).run(|a| {
                let part = if over > 0.0 {
                    ((a.cycle - BEGINS) / over).clamp(0.0, 1.0)
                } else {
                    f64::from(u8::from(a.is_on()))
                };
                *a.volts[0] *= 1.0 - 0.4 * part;
            });
            assert_eq!(run.state, State::Faulted(TripCause::CorrectionLimit));
            assert!(run.furthest < 1.34, "{}", run.furthest);
            let (_, event) = *run.events.last().unwrap();
            assert_eq!(event.cause, HealthCause::SensorGain(Channel::Displacement));
        }
    }
}

/// The channel shows two fifths too little from the start. In the first cycles the requested correction is compared with neutral.
#[test]
fn a_displacement_that_shows_too_little_from_the_start_stops_the_rig_in_the_first_cycles() {
    for seed in 0..SEEDS {
        let run = Rig::new(1, 30, seed).run(|a| *a.volts[0] *= 0.6);
        assert_eq!(run.state, State::Faulted(TripCause::CorrectionLimit));
        assert!(run.cycles < 6.0, "{}", run.cycles);
        let (_, event) = *run.events.last().unwrap();
        assert_eq!(event.cause, HealthCause::SensorGain(Channel::Displacement));
        assert!((0.5..0.7).contains(&event.value), "{event:?}");
    }
}

/// 50 Hz on either channel.
#[test]
fn hum_is_no_damage() {
    for seed in 0..SEEDS {
        for (channel, name, part) in [
            (0, Channel::Displacement, 0.02),
            (0, Channel::Displacement, 0.1),
            (1, Channel::Force, 0.05),
            (1, Channel::Force, 0.2),
        ] {
            let run = run(seed, |a| {
                if a.is_on() {
                    let hum = (TAU * 50.0 * a.tick as f64 / TICK_RATE).sin();
                    *a.volts[channel] += part * a.amplitudes[channel] * hum;
                }
            });
            assert_eq!(
                run.causes(),
                [HealthCause::SensorNoisy(name)],
                "{part}, {seed}"
            );
        }
    }
}

/// While every cycle contains hum, no cycle is monitored until the hum is learned as normal. Damage from that time is not learned as
/// normal.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_break_behind_hum_is_reported_once_the_hum_is_normal() {
    for seed in 0..SEEDS {
        for (channel, part) in [(0, 0.05), (1, 0.2)] {
            for broken in [1.0, 0.7] {
                let run = Rig::new(1, 80, seed).run(|a| {
                    if a.is_on() {
                        let hum = (TAU * 50.0 * a.tick as f64 / TICK_RATE).sin();
                        *a.volts[channel] += part * a.amplitudes[channel] * hum;
                    }
                    if a.cycle > BEGINS + 6.0 {
                        a.condition.stiffness = broken;
                        a.condition.friction = broken;
                    }
                });
                let causes = run.causes();
                assert!(
                    matches!(causes[0], HealthCause::SensorNoisy(_)),
                    "{causes:?}"
                );
                let broke = HealthCause::WireBreakage;
                let expected = if broken < 1.0 {
                    vec![broke]
                } else {
                    Vec::new()
                };
                assert_eq!(causes[1..], expected, "{channel}, {seed}");
            }
        }
    }
}

#[test]
fn a_fault_from_the_start_is_reported_in_the_first_cycles() {
    for seed in 0..SEEDS {
        let reversed = run(seed, |a| *a.volts[1] = -*a.volts[1]);
        let (cycle, event) = reversed.events[0];
        assert_eq!(event.cause, HealthCause::SensorReversed(Channel::Force));
        assert!(cycle < 5.0, "{cycle}");
        let halved = run(seed, |a| *a.volts[1] *= 0.5);
        let (cycle, event) = halved.events[0];
        assert_eq!(event.cause, HealthCause::LawMismatch);
        assert_eq!(event.or, Some(HealthCause::SensorGain(Channel::Force)));
        assert!(cycle < 5.0, "{cycle}");
        // The channels are swapped, or the displacement is reversed: a limit trips the rig.
        let mut swapped = run(seed, |a| {
            let [displacement, force] = &mut a.volts;
            std::mem::swap(*displacement, *force);
        });
        assert!(matches!(swapped.state, State::Faulted(_)) && swapped.cycles < 3.0);
        swapped = run(seed, |a| *a.volts[0] = -*a.volts[0]);
        assert!(matches!(swapped.state, State::Faulted(_)) && swapped.cycles < 3.0);
    }
}
