//! The cause of a change in the statistics of whole cycles, by its pattern.

use super::cause::{Channel, HealthCause};
use super::event::Statistic;

/// Changes of the statistics of whole cycles, in the order of [`Statistic::ALL`].
pub(super) type Shift = [f32; Statistic::OF_CYCLES];

/// Time course of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Course {
    /// Within a cycle or two, and permanent.
    Step,
    /// Bit by bit.
    Slow,
}

/// Third harmonic divided by the first, in excess of the law's own `law_third`, of the force that a gap removes. Breakage removes a
/// part of the law's force, third harmonic included. A gap of g removes g·(k1 + 3·k3·y²)·sgn y. With κ = k3·A²/k1 its ratio is
/// larger by (4/3 − 8κ/5)/(4 + 8κ) + κ/(4 + 3κ): ⅓ without k3, at least 0.106, 2/15 with k3 alone. The law's own is −κ/(4 + 3κ).
fn gap_harmonic(law_third: f32) -> f32 {
    let hardening = -4.0 * law_third / (1.0 + 3.0 * law_third);
    if hardening > 0.0 && hardening < 1e3 {
        (4.0 / 3.0 - 1.6 * hardening) / (4.0 + 8.0 * hardening) - law_third
    } else if law_third < 0.0 {
        2.0 / 15.0
    } else {
        1.0 / 3.0
    }
}

/// Energy divided by stiffness for a gap: a fault that removes force near zero removes little or no friction.
const GAP_ENERGY: f32 = 0.6;
/// Stiffness divided by energy below which only friction is lost.
const FRICTION_ALONE: f32 = 0.35;
/// Energy divided by residual above which only friction rises: an increase of friction changes the residual by the same part of its
/// own RMS, which is less than the force's.
const FRICTION_OF_RESIDUAL: f32 = 0.5;
/// Mean of the command divided by mean of the force, both as parts of their amplitudes, above which the specimen really moved: the
/// rig keeps the mean that the sensor shows.
const MOVED_MEAN: f32 = 0.3;

/// Relative change of stiffness and energy below which the force has the opposite sign: noise and warming cannot cause it.
const REVERSED: f32 = -1.2;
/// Largest difference between the changes of stiffness and energy, as a part of the larger, for which the whole force changes in
/// proportion.
const ALIKE: f32 = 0.4;

/// A cause, an alternative cause, and the statistic that is the evidence.
pub(super) type Verdict = (HealthCause, Option<HealthCause>, Statistic);

/// The cause whose pattern `shift` has, and the statistic that is the evidence. `law_third` is the third harmonic divided by the
/// first of the law's force in phase with displacement.
///
/// If stiffness and energy change in proportion, the gain of the force channel may have changed instead: no measurement
/// distinguishes that from a specimen that breaks or hardens. If they do not, the gain of the displacement channel may have: the
/// specimen moves further than shown, or less.
pub(super) fn cause(shift: &Shift, law_third: f32, course: Course) -> Verdict {
    let &[stiffness, energy, mean, residual, third, command] = shift;
    let largest = |a: f32, b: f32| if a.abs() > b.abs() { a.abs() } else { b.abs() };
    if mean.abs() > largest(stiffness, energy) {
        let displaced = command * mean > 0.0 && command.abs() > MOVED_MEAN * mean.abs();
        let cause = match (displaced, course) {
            (true, _) => HealthCause::SensorDrifting(Channel::Displacement),
            (false, Course::Slow) => HealthCause::SensorDrifting(Channel::Force),
            (false, Course::Step) => HealthCause::PreloadShift,
        };
        return (cause, None, Statistic::MeanForce);
    }
    if stiffness < REVERSED && energy < REVERSED {
        let (cause, or) = reversed();
        return (cause, Some(or), Statistic::Stiffness);
    }
    // No specimen supplies energy.
    if energy < REVERSED {
        return (HealthCause::Unexplained, None, Statistic::Energy);
    }
    if stiffness.abs() < FRICTION_ALONE * energy.abs() {
        if energy < 0.0 {
            return (HealthCause::FrictionWear, None, Statistic::Energy);
        }
        if energy > FRICTION_OF_RESIDUAL * residual.abs() {
            return (HealthCause::FrictionRise, None, Statistic::Energy);
        }
    }
    let alike = (stiffness - energy).abs() < ALIKE * largest(stiffness, energy);
    let gain = Some(HealthCause::SensorGain(if alike {
        Channel::Force
    } else {
        Channel::Displacement
    }));
    let flat = third < (law_third + 0.5 * gap_harmonic(law_third)) * stiffness;
    if stiffness < 0.0 && (flat || energy > GAP_ENERGY * stiffness) {
        return (HealthCause::Loosening, None, Statistic::Stiffness);
    }
    if stiffness < 0.0 && energy < 0.0 {
        return (HealthCause::WireBreakage, gain, Statistic::Stiffness);
    }
    if stiffness > 0.0 && stiffness > FRICTION_ALONE * residual.abs() {
        return (HealthCause::Stiffening, gain, Statistic::Stiffness);
    }
    let statistic = if residual.abs() > largest(stiffness, energy) {
        Statistic::Residual
    } else if stiffness.abs() > energy.abs() {
        Statistic::Stiffness
    } else {
        Statistic::Energy
    };
    (HealthCause::Unexplained, None, statistic)
}

/// The force has the opposite sign relative to the displacement. The data cannot tell which of the two channels is reversed.
pub(super) const fn reversed() -> (HealthCause, HealthCause) {
    (
        HealthCause::SensorReversed(Channel::Force),
        HealthCause::SensorReversed(Channel::Displacement),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_removes_more_of_the_third_harmonic_than_a_break() {
        for (law_third, gap) in [(0.1, 1.0 / 3.0), (0.0, 1.0 / 3.0), (-1.0 / 3.0, 2.0 / 15.0)] {
            assert!((gap_harmonic(law_third) - gap).abs() < 1e-6);
        }
        let harmonics = (0..100u8).map(|part| gap_harmonic(-f32::from(part) / 300.0));
        let least = harmonics.fold(f32::MAX, |a, b| if a < b { a } else { b });
        assert!((least - 0.106).abs() < 0.001, "{least}");
    }

    /// The first and third harmonic that each fault removes from F = k1·y + k3·y³ and its friction, calculated by hand.
    #[test]
    fn closed_forms_have_their_names() {
        use core::f32::consts::PI;
        // From no cubic stiffness to almost only cubic stiffness.
        for hardening in [0.0f32, 0.3, 1.0, 10.0] {
            let first = 1.0 + 0.75 * hardening;
            let law_third = -0.25 * hardening / first;
            let name = |shift: Shift, course| cause(&shift, law_third, course).0;
            for size in [0.05f32, 0.1, 0.3] {
                // The whole force falls in proportion.
                let broken = [-size, -size, 0.0, size, -size * law_third, 0.0];
                assert_eq!(name(broken, Course::Step), HealthCause::WireBreakage);
                let worn = [0.0, -size, 0.0, 0.4 * size, 0.0, 0.0];
                assert_eq!(name(worn, Course::Slow), HealthCause::FrictionWear);
                // −g·(k1 + 3·k3·y²)·sgn y, in which sgn y has 4/π and 4/3π, and sin²φ·sgn y 8/3π and −8/15π.
                let gap_first = 4.0 / PI + hardening * 8.0 / PI;
                let gap_third = 4.0 / (3.0 * PI) - hardening * 8.0 / (5.0 * PI);
                let third = -size * gap_third / gap_first;
                for friction_too in [0.0, 0.9] {
                    let loose = [-size, -size * friction_too, 0.0, size, third, 0.0];
                    assert_eq!(name(loose, Course::Step), HealthCause::Loosening);
                }
                for sign in [1.0, -1.0] {
                    let mean = [0.0, 0.0, sign * size, size, 0.0, 0.0];
                    assert_eq!(name(mean, Course::Step), HealthCause::PreloadShift);
                    let drifting = HealthCause::SensorDrifting(Channel::Force);
                    assert_eq!(name(mean, Course::Slow), drifting);
                    // The specimen is displaced by size·A, and its mean force is that times its stiffness.
                    let elsewhere = [size * size, 0.0, sign * size, size, 0.0, sign * size];
                    let drifting = HealthCause::SensorDrifting(Channel::Displacement);
                    assert_eq!(name(elsewhere, Course::Step), drifting);
                }
            }
        }
        let gain = Some(HealthCause::SensorGain(Channel::Force));
        let named = |shift: Shift| {
            let (cause, or, _) = cause(&shift, 0.0, Course::Step);
            (cause, or)
        };
        assert_eq!(
            named([0.1, 0.1, 0.0, 0.1, 0.0, 0.0]),
            (HealthCause::Stiffening, gain)
        );
        let far = Some(HealthCause::SensorGain(Channel::Displacement));
        assert_eq!(
            named([0.2, 0.02, 0.0, 0.1, 0.0, 0.0]),
            (HealthCause::Stiffening, far)
        );
        let unexplained = (HealthCause::Unexplained, None);
        assert_eq!(named([0.0, -1.8, 0.0, 1.5, 0.0, 0.0]), unexplained);
        assert_eq!(named([0.001, 0.003, 0.0, 0.1, 0.0, 0.0]), unexplained);
        assert_eq!(
            named([-0.1, -0.1, 0.0, 0.1, 0.0, 0.0]),
            (HealthCause::WireBreakage, gain)
        );
        assert_eq!(
            named([-0.02, 0.2, 0.0, 0.1, 0.0, 0.0]),
            (HealthCause::FrictionRise, None)
        );
        let evidence = |shift: Shift| cause(&shift, 0.0, Course::Step).2;
        let by_residual = [0.001, 0.003, 0.0, 0.1, 0.0, 0.0];
        assert_eq!(evidence(by_residual), Statistic::Residual);
        // Stiffness rises by less than a part of the residual.
        let by_stiffness = [0.05, -0.04, 0.0, 0.04, 0.0, 0.0];
        assert_eq!(evidence(by_stiffness), Statistic::Stiffness);
        let reversed = HealthCause::SensorReversed(Channel::Force);
        let (cause, or) = named([-2.0, -2.0, 0.0, 2.0, 0.0, 0.0]);
        assert_eq!(
            (cause, or),
            (
                reversed,
                Some(HealthCause::SensorReversed(Channel::Displacement))
            )
        );
        assert_eq!(
            named([0.001, 0.0, 0.0, 0.2, 0.0, 0.0]),
            (HealthCause::Unexplained, None)
        );
    }
}
