//! An event of the monitor: a cause with its evidence.

use super::cause::HealthCause;

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

#[cfg(test)]
mod tests {
    use super::*;

    /// An image and a harness of different versions understand each other as long as these numbers stay.
    #[test]
    fn numbers_on_the_link_are_those_of_the_table() {
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
        for (number, statistic) in statistics {
            assert_eq!(statistic.number(), number);
            assert_eq!(Statistic::of_number(number), Some(statistic));
        }
        assert_eq!(Statistic::ALL.len(), statistics.len());
        assert_eq!(Statistic::of_number(10), None);
    }
}
