//! The causes that the monitor names, in one list. What is known of a cause stands in its row, and everything else is made from the rows:
//! numbers, words, the constants of C, the tables of the pages.

use core::fmt;

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

impl Channel {
    /// Its name in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Force => "force",
        }
    }
}

/// How long a cause is visible, and what it is to the monitor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CauseKind {
    /// A fault that is found from cycle to cycle and stays until it is cleared. After one the law does not adapt.
    Lasting,
    /// A fault of a sensor or of the actuator that is visible only while it lasts.
    Passing,
    /// A passing fault of a channel that hides its quantity for longer than a sample.
    Hiding,
    /// No fault: a change that is normal.
    Normal,
}

/// What is known of a cause: its row in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CauseDescription {
    /// Name of the variant.
    pub name: &'static str,
    /// What it means, in a sentence. That of a channel begins with "The channel".
    pub meaning: &'static str,
    /// How an event names it; of a channel, what follows "the force sensor".
    pub words: &'static str,
    /// How long it is visible.
    pub kind: CauseKind,
}

/// The list. A row is the meaning, the variant, its number on the link, its kind and its words. A cause of a channel has two numbers:
/// the row's for displacement, and the next one for force.
///
/// Rows are only appended, and a number is never given again: so what an earlier version wrote, in a format of serde too, reads as
/// what it was.
macro_rules! health_causes {
    ($(#[doc = $meaning:literal] $name:ident $(($of:ident: $channel:ident))? = $number:literal $kind:ident $words:literal;)+) => {
        /// Cause that an event reports.
        ///
        /// In words, as [`Display`](fmt::Display) gives it, a cause reads as after "Found:".
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[non_exhaustive]
        pub enum HealthCause {
            $(#[doc = $meaning] $name $(($channel))?,)+
        }

        /// Each row's causes.
        const ROWS: &[&[HealthCause]] = &[$(health_causes!(@each $name $($of)?)),+];

        impl HealthCause {
            /// Its number on the link.
            pub const fn number(self) -> u8 {
                let of_row = match self {
                    $(Self::$name { .. } => $number,)+
                };
                match self.channel() {
                    Some(Channel::Force) => of_row + 1,
                    _ => of_row,
                }
            }

            /// The channel that it is about.
            pub const fn channel(self) -> Option<Channel> {
                match self {
                    $(Self::$name $(($of))? => health_causes!(@some $($of)?),)+
                }
            }

            /// What is known of it.
            pub const fn description(self) -> CauseDescription {
                match self {
                    $(Self::$name { .. } => CauseDescription {
                        name: stringify!($name),
                        meaning: $meaning.trim_ascii(),
                        words: $words,
                        kind: CauseKind::$kind,
                    },)+
                }
            }

            const fn kind(self) -> CauseKind {
                match self {
                    $(Self::$name { .. } => CauseKind::$kind,)+
                }
            }
        }
    };
    (@each $name:ident) => { &[HealthCause::$name] };
    (@each $name:ident $of:ident) => {
        &[HealthCause::$name(Channel::Displacement), HealthCause::$name(Channel::Force)]
    };
    (@some) => { None };
    (@some $of:ident) => { Some($of) };
}

health_causes! {
    /// Stiffness falls, and energy with it.
    WireBreakage = 0 Lasting "wire breakage";
    /// Energy falls, stiffness stays.
    FrictionWear = 1 Lasting "friction wear";
    /// A gap opens: force is missing near zero displacement.
    Loosening = 2 Lasting "loosening";
    /// The mean force changes at once.
    PreloadShift = 3 Lasting "the preload has shifted";
    /// A change that no other cause explains, or one that a newer version names.
    Unexplained = 4 Lasting "a change without a known cause";
    /// Settled after the start by more than the size of a fault.
    RunIn = 5 Normal "the run-in";
    /// Changed with the temperature by more than the size of a fault.
    Temperature = 6 Normal "the temperature";
    /// The channel repeats one value while its quantity moves.
    SensorStuck(of: Channel) = 7 Hiding "is stuck";
    /// The channel shows 0 V while its quantity moves; that of the force also if it no longer follows the motion.
    SensorDroppedOut(of: Channel) = 9 Hiding "has dropped out";
    /// The channel stays at an extreme value until its quantity returns, or is at an end of the converter's range.
    SensorClipped(of: Channel) = 11 Hiding "is clipped";
    /// The channel has single samples that are outliers in both directions.
    SensorSpiking(of: Channel) = 13 Passing "spikes";
    /// The channel's zero moves, bit by bit.
    SensorDrifting(of: Channel) = 15 Lasting "drifts";
    /// The actuator does not reach the demanded motion, and the shape of its motion differs.
    ActuatorSaturated = 17 Passing "the actuator is saturated";
    /// The actuator's motion has the demanded shape, but is late or of another size.
    ActuatorLagging = 18 Passing "the actuator lags";
    /// The actuator stands still.
    ActuatorDead = 19 Passing "the actuator is dead";
    /// Energy rises, stiffness stays: the specimen galls or seizes.
    FrictionRise = 20 Lasting "friction rises";
    /// Stiffness rises, with energy or without.
    Stiffening = 21 Lasting "the specimen stiffens";
    /// The channel shows more or less than before for the same quantity.
    SensorGain(of: Channel) = 22 Lasting "has changed its gain";
    /// The channel has more noise or hum than the monitor learned.
    SensorNoisy(of: Channel) = 24 Passing "has too much noise or hum";
    /// The force does not follow the motion, and never did: there is no specimen.
    SpecimenAbsent = 26 Lasting "there is no specimen";
    /// The channel has the opposite sign.
    SensorReversed(of: Channel) = 27 Lasting "is reversed";
    /// The specimen differs much from the law from the start.
    LawMismatch = 29 Lasting "the specimen is far from the law";
    /// The measured temperature is implausible: not finite, out of range, or changing faster than a specimen warms.
    TemperatureImplausible = 30 Passing "the temperature is implausible";
}

impl HealthCause {
    const COUNT: usize = {
        let (mut count, mut row) = (0, 0);
        while row < ROWS.len() {
            count += ROWS[row].len();
            row += 1;
        }
        count
    };

    /// Every cause.
    pub const ALL: [Self; Self::COUNT] = {
        let mut all = [Self::WireBreakage; Self::COUNT];
        let (mut at, mut row) = (0, 0);
        while row < ROWS.len() {
            let mut place = 0;
            while place < ROWS[row].len() {
                all[at] = ROWS[row][place];
                (at, place) = (at + 1, place + 1);
            }
            row += 1;
        }
        all
    };

    /// The cause with this number. One that this version does not know is [`HealthCause::Unexplained`]: a newer sender has named it.
    pub(crate) fn of_number(number: u8) -> Self {
        let mut all = Self::ALL.into_iter();
        all.find(|each| each.number() == number)
            .unwrap_or(Self::Unexplained)
    }

    /// Whether it is a fault that stays until it is cleared.
    pub(super) const fn is_lasting(self) -> bool {
        matches!(self.kind(), CauseKind::Lasting)
    }

    /// Whether it hides the quantity of `channel` for longer than a sample.
    pub(super) fn hides(self, channel: Channel) -> bool {
        self.kind() == CauseKind::Hiding && self.channel() == Some(channel)
    }

    /// Whether it is a fault; `false` for changes that are normal after a start or with the temperature.
    pub const fn is_fault(self) -> bool {
        !matches!(self.kind(), CauseKind::Normal)
    }
}

impl fmt::Display for HealthCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = self.description().words;
        match self.channel() {
            Some(channel) => write!(f, "the {} sensor {words}", channel.name()),
            None => f.write_str(words),
        }
    }
}

/// No two causes have a number in common, and none has that of no cause.
const _: () = {
    let mut place = 0;
    while place < HealthCause::COUNT {
        let number = HealthCause::ALL[place].number();
        assert!(number != NO_CAUSE, "255 stands for no cause");
        let mut other = 0;
        while other < place {
            assert!(
                HealthCause::ALL[other].number() != number,
                "two causes have the same number"
            );
            other += 1;
        }
        place += 1;
    }
};

/// Number on the link in place of a cause, where there is none.
pub(crate) const NO_CAUSE: u8 = u8::MAX;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_of_its_cause_and_any_other_is_of_an_unexplained_fault() {
        for number in 0..=u8::MAX {
            let known = HealthCause::ALL.iter().find(|each| each.number() == number);
            let cause = HealthCause::of_number(number);
            assert_eq!(cause, *known.unwrap_or(&HealthCause::Unexplained));
        }
    }

    /// The page and the header of C turn "The channel" into the name of one.
    #[test]
    fn a_cause_reads_as_a_sentence_and_is_told_in_words() {
        for cause in HealthCause::ALL {
            let CauseDescription { meaning, words, .. } = cause.description();
            assert!(meaning.ends_with('.') && !words.is_empty(), "{cause:?}");
            let of_channel = meaning.starts_with("The channel");
            assert_eq!(of_channel, cause.channel().is_some(), "{cause:?}");
        }
        let said = std::format!("{}", HealthCause::SensorStuck(Channel::Force));
        assert_eq!(said, "the force sensor is stuck");
        assert_eq!(std::format!("{}", HealthCause::RunIn), "the run-in");
    }
}
