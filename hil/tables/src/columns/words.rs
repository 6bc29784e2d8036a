//! Meaning of the words in a column's name, in the languages of test labs.
//!
//! Each quantity has its words in one place, sorted by use: alone, at the end of a longer word, or only next to a unit of it. A
//! word with two meanings is listed in both, and the unit decides. A word for a demand or a count, such as `setpoint` or `cycle`,
//! makes a column another one, whatever else its name contains. A qualifying word, such as `corrected`, leads to a question if
//! another column would be chosen. So does an unknown word, if a sensor's column has no known one.

use super::lexicon::{DOUBTFUL, GENERIC, LEXICON, Lexicon, MEASURED, OTHER, Quantity};
use crate::channel::Channel;

/// How certain a name's meaning is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Certainty {
    /// A short word, which has this meaning only next to a unit of it.
    Weak,
    /// A name of the quantity.
    Strong,
}

/// How certain these words mean a channel.
pub(super) fn of_channel(words: &[String], channel: Channel) -> Option<Certainty> {
    let mut mine = LEXICON
        .iter()
        .filter(|lexicon| lexicon.quantity == Quantity::Channel(channel));
    mine.find_map(|lexicon| lexicon.certainty(words))
}

/// The control input that the words mean with this unit.
pub(super) fn of_control(words: &[String], unit: &str) -> Option<&'static str> {
    let mut inputs = control_inputs(words);
    let found = inputs.find(|(_, units)| units.contains(&unit));
    found.map(|(name, _)| name)
}

/// Whether the words can stand before this unit: they mean no control input, or one that has it.
pub(super) fn may_have(words: &[String], unit: &str) -> bool {
    !is_control(words) || of_control(words, unit).is_some()
}

/// Whether the words mean a control input.
pub(super) fn is_control(words: &[String]) -> bool {
    control_inputs(words).next().is_some()
}

/// The control inputs that the words mean with one of its units.
fn control_inputs(
    words: &[String],
) -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    LEXICON.iter().filter_map(|lexicon| match lexicon.quantity {
        Quantity::Control(name, units) => lexicon.certainty(words).map(|_| (name, units)),
        _ => None,
    })
}

/// Whether the words say that the column is not a measurement of a channel, or may be something else.
pub(super) fn is_other(words: &[String]) -> bool {
    let is_doubtful = |word: &String| {
        DOUBTFUL.contains(&word.as_str())
            || ["应力", "応力", "应变"]
                .iter()
                .any(|ending| word.ends_with(ending))
    };
    is_surely_other(words) || words.iter().any(is_doubtful)
}

/// Whether the words say that the column is not a measurement of a channel.
pub(super) fn is_surely_other(words: &[String]) -> bool {
    let is_it = |word: &String| {
        OTHER.contains(&word.as_str())
            // Kraftsollwert, Sollweg.
            || word.starts_with("soll")
            || word.ends_with("sollwert")
            || ["指令", "目标", "目標"].iter().any(|ending| word.ends_with(ending))
    };
    words.iter().any(is_it)
}

/// Whether all words are understood, including compounds: `Prüfkraft`, but not `Nennkraft`.
pub(super) fn are_understood(words: &[String]) -> bool {
    let is_weak = |word: &str| LEXICON.iter().any(|lexicon| lexicon.weak.contains(&word));
    let is_plain = |word: &str| {
        word.chars().count() <= 1
            || is_known(word)
            || is_weak(word)
            || GENERIC.contains(&word)
            || MEASURED.contains(&word)
    };
    let is_it = |word: &String| {
        let mut endings = LEXICON.iter().flat_map(|lexicon| {
            let all = lexicon.endings.iter();
            all.filter_map(|ending| word.strip_suffix(ending))
        });
        match endings.next() {
            // The longest ending is the most specific: `试验时间`.
            Some(first) => {
                let shortest = endings.fold(first, |a, b| if b.len() < a.len() { b } else { a });
                let is_alone = |lexicon: &Lexicon| lexicon.words.contains(&word.as_str());
                is_plain(shortest) || LEXICON.iter().any(is_alone)
            }
            None => is_plain(word),
        }
    };
    words.iter().all(is_it)
}

/// Whether the words contain no information about a quantity.
pub(super) fn is_generic(words: &[String]) -> bool {
    words
        .iter()
        .all(|word| GENERIC.contains(&word.as_str()) || (word.len() == 1 && words.len() > 1))
}

/// Whether a word alone names a quantity.
pub(super) fn is_known(word: &str) -> bool {
    LEXICON.iter().any(|lexicon| lexicon.has(word))
}

impl Lexicon {
    fn certainty(&self, words: &[String]) -> Option<Certainty> {
        if words.iter().any(|word| self.has(word)) {
            return Some(Certainty::Strong);
        }
        // Next to other words a short one may mean anything: `x axis`, `load p`.
        let is_weak = matches!(words, [word] if self.weak.contains(&word.as_str()));
        is_weak.then_some(Certainty::Weak)
    }

    fn has(&self, word: &str) -> bool {
        if self.words.contains(&word) || self.endings.contains(&word) {
            return true;
        }
        // `Vorspannkraft` is a word of its own.
        let ends = self.endings.iter().any(|ending| word.ends_with(ending));
        ends && !LEXICON.iter().any(|other| other.words.contains(&word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn words_mean_what_labs_mean_by_them() {
        use Channel::{Displacement, Force, Temperature, Time, Velocity};
        for (text, channel) in [
            ("prüfkraft", Force),
            ("standardkraft", Force),
            ("kolbenweg", Displacement),
            ("messzeit", Time),
            ("axial displacement", Displacement),
            ("试验力", Force),
            ("试验时间", Time),
            ("temps", Time),
            ("temp", Temperature),
            ("tempo", Time),
            ("prüfgeschwindigkeit", Velocity),
        ] {
            let found: Vec<Channel> = (Channel::ALL.into_iter())
                .filter(|&each| of_channel(&words(text), each) == Some(Certainty::Strong))
                .collect();
            assert_eq!(found, [channel], "{text}");
        }
        // Words with other meanings need a unit.
        for (text, channel) in [
            ("last", Force),
            ("charge", Force),
            ("course", Displacement),
            ("x", Displacement),
        ] {
            assert_eq!(
                of_channel(&words(text), channel),
                Some(Certainty::Weak),
                "{text}"
            );
        }
        for text in [
            "压力",
            "应力",
            "vorspannkraft",
            "workload",
            "position error",
        ] {
            let force = of_channel(&words(text), Force);
            assert!(force.is_none() || is_other(&words(text)), "{text}");
        }
    }

    #[test]
    fn what_was_asked_computed_or_counted_is_another_column() {
        for text in [
            "axial displacement command",
            "sollweg",
            "kraftsollwert",
            "position setpoint",
            "cycle time",
            "load step",
            "strain",
            "force rate",
            "应力",
        ] {
            assert!(is_other(&words(text)), "{text}");
        }
        for text in [
            "axial displacement",
            "position feedback",
            "istweg",
            "running time",
        ] {
            assert!(!is_other(&words(text)), "{text}");
        }
    }

    #[test]
    fn a_word_that_is_not_understood_is_told() {
        for (text, is) in [
            ("prüfkraft", true),
            ("axial force", true),
            ("running time", true),
            ("kraft b", true),
            ("试验力", true),
            ("试验时间", true),
            ("vorspannkraft", true),
            ("nennkraft", false),
            ("vorgabeweg", false),
            ("nominal displacement", false),
            ("déplacement demandé", false),
            ("设定位移", false),
        ] {
            assert_eq!(are_understood(&words(text)), is, "{text}");
        }
    }

    #[test]
    fn a_unit_tells_the_two_meanings_of_tension_apart() {
        assert_eq!(of_control(&words("tension"), "V"), Some("voltage"));
        assert_eq!(of_control(&words("tension"), "N"), Some("tension"));
        assert_eq!(of_control(&words("extension"), "V"), None);
        assert_eq!(of_control(&words("spannung"), "MPa"), None);
    }

    #[test]
    fn no_word_of_two_channels_is_sure() {
        let channels = || {
            LEXICON
                .iter()
                .filter(|lexicon| matches!(lexicon.quantity, Quantity::Channel(_)))
        };
        for lexicon in channels() {
            for word in lexicon.words.iter().chain(lexicon.endings) {
                let count = channels().filter(|other| other.has(word)).count();
                assert_eq!(count, 1, "{word}");
                let lists = [OTHER, DOUBTFUL, GENERIC, MEASURED];
                assert!(!lists.iter().any(|list| list.contains(word)), "{word}");
            }
        }
    }
}
