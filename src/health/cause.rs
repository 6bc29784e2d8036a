//! Causes of a fault, by name, and the evidence for them.

/// A measured quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Channel {
    /// Displacement.
    Displacement,
    /// Force.
    Force,
}

/// Cause that an event reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum HealthCause {
    /// Stiffness falls, and energy with it.
    WireBreakage,
    /// Energy falls, stiffness stays.
    FrictionWear,
    /// A gap opens: force is missing near zero displacement.
    Loosening,
    /// The mean force changes at once.
    PreloadShift,
    /// A change that no other cause explains.
    Unexplained,
    /// Settled after the start by more than the size of a fault: normal.
    RunIn,
    /// Changed with the temperature by more than the size of a fault: normal.
    Temperature,
    /// The channel repeats one value while its quantity moves.
    SensorStuck(Channel),
    /// The channel shows 0 V while its quantity moves.
    SensorDroppedOut(Channel),
    /// The channel stays at an extreme value until its quantity returns, or at an end of the converter's range.
    SensorClipped(Channel),
    /// Single samples are outliers in both directions.
    SensorSpiking(Channel),
    /// The channel's zero moves, bit by bit.
    SensorDrifting(Channel),
    /// The actuator does not reach the demanded motion, and the shape of its motion differs.
    ActuatorSaturated,
    /// The actuator's motion has the demanded shape, but is late.
    ActuatorLagging,
    /// The actuator stands still.
    ActuatorDead,
    /// Energy rises, stiffness stays: the specimen galls or seizes.
    FrictionRise,
    /// Stiffness rises, with energy or without.
    Stiffening,
    /// The channel shows more or less than before for the same quantity.
    SensorGain(Channel),
    /// The channel has more noise or hum than the monitor learned.
    SensorNoisy(Channel),
    /// The force does not follow the motion at all: there is no specimen.
    SpecimenAbsent,
    /// The channel has the opposite sign.
    SensorReversed(Channel),
    /// The specimen differs much from the law from the start.
    LawMismatch,
    /// The measured temperature is implausible: not finite, out of range, or changing faster than a specimen warms.
    TemperatureImplausible,
}

impl HealthCause {
    /// Every cause.
    pub const ALL: [Self; 31] = [
        Self::WireBreakage,
        Self::FrictionWear,
        Self::Loosening,
        Self::PreloadShift,
        Self::Unexplained,
        Self::RunIn,
        Self::Temperature,
        Self::SensorStuck(Channel::Displacement),
        Self::SensorStuck(Channel::Force),
        Self::SensorDroppedOut(Channel::Displacement),
        Self::SensorDroppedOut(Channel::Force),
        Self::SensorClipped(Channel::Displacement),
        Self::SensorClipped(Channel::Force),
        Self::SensorSpiking(Channel::Displacement),
        Self::SensorSpiking(Channel::Force),
        Self::SensorDrifting(Channel::Displacement),
        Self::SensorDrifting(Channel::Force),
        Self::ActuatorSaturated,
        Self::ActuatorLagging,
        Self::ActuatorDead,
        Self::FrictionRise,
        Self::Stiffening,
        Self::SensorGain(Channel::Displacement),
        Self::SensorGain(Channel::Force),
        Self::SensorNoisy(Channel::Displacement),
        Self::SensorNoisy(Channel::Force),
        Self::SpecimenAbsent,
        Self::SensorReversed(Channel::Displacement),
        Self::SensorReversed(Channel::Force),
        Self::LawMismatch,
        Self::TemperatureImplausible,
    ];

    /// Its number on the link. It is below 32, because the monitor keeps one bit for each.
    pub const fn number(self) -> u8 {
        match self {
            Self::WireBreakage => 0,
            Self::FrictionWear => 1,
            Self::Loosening => 2,
            Self::PreloadShift => 3,
            Self::Unexplained => 4,
            Self::RunIn => 5,
            Self::Temperature => 6,
            Self::SensorStuck(Channel::Displacement) => 7,
            Self::SensorStuck(Channel::Force) => 8,
            Self::SensorDroppedOut(Channel::Displacement) => 9,
            Self::SensorDroppedOut(Channel::Force) => 10,
            Self::SensorClipped(Channel::Displacement) => 11,
            Self::SensorClipped(Channel::Force) => 12,
            Self::SensorSpiking(Channel::Displacement) => 13,
            Self::SensorSpiking(Channel::Force) => 14,
            Self::SensorDrifting(Channel::Displacement) => 15,
            Self::SensorDrifting(Channel::Force) => 16,
            Self::ActuatorSaturated => 17,
            Self::ActuatorLagging => 18,
            Self::ActuatorDead => 19,
            Self::FrictionRise => 20,
            Self::Stiffening => 21,
            Self::SensorGain(Channel::Displacement) => 22,
            Self::SensorGain(Channel::Force) => 23,
            Self::SensorNoisy(Channel::Displacement) => 24,
            Self::SensorNoisy(Channel::Force) => 25,
            Self::SpecimenAbsent => 26,
            Self::SensorReversed(Channel::Displacement) => 27,
            Self::SensorReversed(Channel::Force) => 28,
            Self::LawMismatch => 29,
            Self::TemperatureImplausible => 30,
        }
    }

    /// The cause with this number.
    pub(crate) fn of_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|each| each.number() == number)
    }

    /// Whether a fault of a sensor or of the actuator is visible only while it lasts. The other faults are found from cycle to
    /// cycle and stay until they are cleared.
    pub(super) const fn is_passing(self) -> bool {
        matches!(
            self,
            Self::SensorStuck(_)
                | Self::SensorDroppedOut(_)
                | Self::SensorClipped(_)
                | Self::SensorSpiking(_)
                | Self::ActuatorSaturated
                | Self::ActuatorLagging
                | Self::ActuatorDead
                | Self::SensorNoisy(_)
                | Self::TemperatureImplausible
        )
    }

    /// Whether it hides the quantity of `channel` for longer than a sample.
    pub(super) fn hides(self, channel: Channel) -> bool {
        matches!(
            self,
            Self::SensorStuck(of) | Self::SensorDroppedOut(of) | Self::SensorClipped(of)
                if of == channel
        )
    }

    /// Whether it is a fault; `false` for changes that are normal after a start or with the temperature.
    pub const fn is_fault(self) -> bool {
        !matches!(self, Self::RunIn | Self::Temperature)
    }
}

/// Quantity of an event's value. The first [`Statistic::OF_CYCLES`] belong to whole cycles, and are relative to the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Statistic {
    /// Force in phase with displacement, divided by the law's.
    Stiffness,
    /// ∮F dy, divided by the law's.
    Energy,
    /// Mean force, divided by the amplitude of the law's force in phase with displacement.
    MeanForce,
    /// RMS of the residual divided by that of the law's force.
    Residual,
    /// Third harmonic of the residual in phase with displacement, divided by the amplitude of the law's force in phase with it.
    ThirdHarmonic,
    /// Mean of the command divided by the amplitude.
    MeanCommand,
    /// A channel's sample, in its unit.
    Sample,
    /// Distance of the response to the demanded motion from the learned one.
    Response,
    /// RMS of the signal that neither a motion nor a specimen explains, divided by the amplitude.
    Noise,
    /// Part of the force's variance that the motion explains, 0…1.
    Explained,
}

impl Statistic {
    /// Every statistic. The first [`Statistic::OF_CYCLES`] are those of whole cycles.
    pub const ALL: [Self; 10] = [
        Self::Stiffness,
        Self::Energy,
        Self::MeanForce,
        Self::Residual,
        Self::ThirdHarmonic,
        Self::MeanCommand,
        Self::Sample,
        Self::Response,
        Self::Noise,
        Self::Explained,
    ];
    /// Number of statistics of whole cycles.
    pub const OF_CYCLES: usize = 6;
    /// Number of those that are watched; the others only distinguish causes.
    pub const WATCHED: usize = 4;

    /// Its index in [`Statistic::ALL`].
    pub(super) fn place(self) -> u8 {
        let mut all = (0..).zip(Self::ALL);
        all.find(|(_, other)| *other == self)
            .map_or(u8::MAX, |(place, _)| place)
    }

    /// Its number on the link.
    pub const fn number(self) -> u8 {
        match self {
            Self::Stiffness => 0,
            Self::Energy => 1,
            Self::MeanForce => 2,
            Self::Residual => 3,
            Self::ThirdHarmonic => 4,
            Self::MeanCommand => 5,
            Self::Sample => 6,
            Self::Response => 7,
            Self::Noise => 8,
            Self::Explained => 9,
        }
    }

    /// The statistic with this number.
    pub(crate) fn of_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|each| each.number() == number)
    }
}

/// A change with its evidence.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// Its cause.
    pub cause: HealthCause,
    /// An alternative cause, where the rig's measurements cannot distinguish the two.
    pub or: Option<HealthCause>,
    /// The statistic that changed.
    pub statistic: Statistic,
    /// Amount of the change; for a sample its value.
    pub value: f32,
    /// Limit of the value.
    pub limit: f32,
    /// Cycles completed since the start.
    pub cycle: u32,
}

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

    /// An image and a harness of different versions understand each other as long as these numbers stay.
    #[test]
    fn numbers_on_the_link_are_those_of_the_table() {
        let causes = [
            (0, HealthCause::WireBreakage),
            (1, HealthCause::FrictionWear),
            (2, HealthCause::Loosening),
            (3, HealthCause::PreloadShift),
            (4, HealthCause::Unexplained),
            (5, HealthCause::RunIn),
            (6, HealthCause::Temperature),
            (7, HealthCause::SensorStuck(Channel::Displacement)),
            (8, HealthCause::SensorStuck(Channel::Force)),
            (9, HealthCause::SensorDroppedOut(Channel::Displacement)),
            (10, HealthCause::SensorDroppedOut(Channel::Force)),
            (11, HealthCause::SensorClipped(Channel::Displacement)),
            (12, HealthCause::SensorClipped(Channel::Force)),
            (13, HealthCause::SensorSpiking(Channel::Displacement)),
            (14, HealthCause::SensorSpiking(Channel::Force)),
            (15, HealthCause::SensorDrifting(Channel::Displacement)),
            (16, HealthCause::SensorDrifting(Channel::Force)),
            (17, HealthCause::ActuatorSaturated),
            (18, HealthCause::ActuatorLagging),
            (19, HealthCause::ActuatorDead),
            (20, HealthCause::FrictionRise),
            (21, HealthCause::Stiffening),
            (22, HealthCause::SensorGain(Channel::Displacement)),
            (23, HealthCause::SensorGain(Channel::Force)),
            (24, HealthCause::SensorNoisy(Channel::Displacement)),
            (25, HealthCause::SensorNoisy(Channel::Force)),
            (26, HealthCause::SpecimenAbsent),
            (27, HealthCause::SensorReversed(Channel::Displacement)),
            (28, HealthCause::SensorReversed(Channel::Force)),
            (29, HealthCause::LawMismatch),
            (30, HealthCause::TemperatureImplausible),
        ];
        let statistics = [
            (0, Statistic::Stiffness),
            (1, Statistic::Energy),
            (2, Statistic::MeanForce),
            (3, Statistic::Residual),
            (4, Statistic::ThirdHarmonic),
            (5, Statistic::MeanCommand),
            (6, Statistic::Sample),
            (7, Statistic::Response),
            (8, Statistic::Noise),
            (9, Statistic::Explained),
        ];
        for (number, cause) in causes {
            assert_eq!(cause.number(), number);
            assert_eq!(HealthCause::of_number(number), Some(cause));
        }
        for (number, statistic) in statistics {
            assert_eq!(statistic.number(), number);
            assert_eq!(Statistic::of_number(number), Some(statistic));
        }
        assert_eq!(HealthCause::ALL.len(), causes.len());
        assert_eq!(Statistic::ALL.len(), statistics.len());
        assert_eq!(HealthCause::of_number(31), None);
        assert_eq!(Statistic::of_number(10), None);
    }

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
