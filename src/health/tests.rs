//! Cycles without noise: the cause that is named, and the cycle in which it is.

use super::*;

/// y = sin φ, law y + 0.3·sgn v, and a specimen with `part` of its force in each cycle: returns when a cause is named, and
/// which.
fn named(ticks: u32, cycles: u32, part: impl Fn(u32) -> f32) -> Option<(u32, HealthCause)> {
    let config = HealthSettings::default().config().unwrap();
    let mut monitor = monitor();
    for tick in 1..ticks * cycles {
        let (cycle, turn) = (tick / ticks, (tick % ticks) as f32 / ticks as f32);
        if tick % ticks == 0 {
            let energy = 1.2;
            monitor.cycle(Ended {
                block: 0,
                temperature: 20.0,
                command: 0.0,
                ticks,
                another_law: false,
                steady: Some(Steady {
                    energy: part(cycle - 1) * energy,
                    law_energy: energy,
                    mean: 0.0,
                }),
            });
        }
        let phase = (f64::from(turn) * (1u64 << 32) as f64) as u32;
        if !monitor.is_due(phase) {
            continue;
        }
        let angle = core::f32::consts::TAU * turn;
        let (y, v) = (libm::sinf(angle), libm::cosf(angle));
        let law = y + 0.3 * v.signum();
        let look = Look {
            displacement: y,
            velocity: v,
            measured: y,
            demand: (y, v),
            force: part(cycle) * law,
            law,
            parts: [0.0; 3],
            phase,
            ramp: false,
        };
        assert_eq!(monitor.look(&config, &look), None);
        if let Some(event) = monitor.take_fresh() {
            return Some((cycle, event.cause));
        }
    }
    None
}

#[test]
fn a_break_is_named_with_any_number_of_ticks_to_the_cycle() {
    for ticks in [16, 20, 23, 24, 25, 26, 31, 32, 33, 47, 64, 100, 1000] {
        let (cycle, cause) = named(ticks, 60, |cycle| if cycle < 40 { 1.0 } else { 0.9 })
            .unwrap_or_else(|| panic!("{ticks} ticks"));
        assert_eq!(cause, HealthCause::WireBreakage, "{ticks} ticks");
        // With fewer ticks than pieces of work, a cycle is left out.
        let last = if ticks < 22 { 48 } else { 44 };
        assert!((42..=last).contains(&cycle), "{ticks} ticks: {cycle}");
        assert_eq!(named(ticks, 60, |_| 0.95), None);
    }
}

fn monitor() -> HealthMonitor {
    let scale = Scale::new(2.0, 0.0).unwrap();
    HealthMonitor::new(&scale, &scale, [2.0, 2.0])
}

fn event(cause: HealthCause) -> Event {
    Event {
        cause,
        or: None,
        statistic: Statistic::Sample,
        value: 0.0,
        limit: 0.0,
        cycle: 0,
    }
}

#[test]
fn only_a_lasting_fault_ends_the_adaptation() {
    let mut monitor = monitor();
    for cause in HealthCause::ALL {
        let lasts = cause.description().kind == CauseKind::Lasting;
        monitor.latch(event(cause));
        assert_eq!(monitor.is_damaged, lasts, "{cause:?}");
        monitor.clear();
        assert!(!monitor.is_damaged);
    }
}

/// There is room for every cause, however many there are, and none takes another's.
#[test]
fn each_cause_is_kept_once_until_it_is_cleared() {
    let mut monitor = monitor();
    for _ in 0..2 {
        for cause in HealthCause::ALL {
            monitor.latch(event(cause));
            monitor.latch(event(cause));
        }
        let kept = monitor.events().iter().map(|event| event.cause);
        assert!(kept.eq(HealthCause::ALL));
        monitor.clear();
        assert!(monitor.events().is_empty());
    }
}
