//! Meaning of the words in a column's name, in the languages of test labs.
//!
//! Each quantity has its words in one place, sorted by use: alone, at the end of a longer word, or only next to a unit of it. A
//! word with two meanings is listed in both, and the unit decides. A word for a demand or a count, such as `setpoint` or `cycle`,
//! makes a column another one, whatever else its name contains. A qualifying word, such as `corrected`, leads to a question if
//! another column would be chosen. So does an unknown word, if a sensor's column has no known one.

use std::collections::{BTreeMap, HashMap};
use std::sync::LazyLock;

use super::lexicon::{DOUBTFUL, GENERIC, LEXICON, MEASURED, OTHER, Quantity};
use crate::channel::Channel;

/// How certain a name's meaning is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Certainty {
    /// A short word, which has this meaning only next to a unit of it.
    Weak,
    /// A name of the quantity.
    Strong,
}

/// The most letters of a symbol: `F`, `Fx`.
const SYMBOL: usize = 2;

/// Quantities, one bit each, by their places in the lexicon.
type Quantities = u16;

/// The lists that a word is in.
#[derive(Clone, Copy, Debug, Default)]
struct Listed {
    words: Quantities,
    endings: Quantities,
    weak: Quantities,
    is_other: bool,
    is_doubtful: bool,
    is_generic: bool,
    is_measured: bool,
}

/// All words of the lists.
static LISTED: LazyLock<HashMap<&'static str, Listed>> = LazyLock::new(|| {
    let mut listed: HashMap<&str, Listed> = HashMap::new();
    for (place, lexicon) in LEXICON.iter().enumerate() {
        let bit = 1 << place;
        for &word in lexicon.words {
            listed.entry(word).or_default().words |= bit;
        }
        for &word in lexicon.endings {
            listed.entry(word).or_default().endings |= bit;
        }
        for &word in lexicon.weak {
            listed.entry(word).or_default().weak |= bit;
        }
    }
    for &word in OTHER {
        listed.entry(word).or_default().is_other = true;
    }
    for &word in DOUBTFUL {
        listed.entry(word).or_default().is_doubtful = true;
    }
    for &word in GENERIC {
        listed.entry(word).or_default().is_generic = true;
    }
    for &word in MEASURED {
        listed.entry(word).or_default().is_measured = true;
    }
    listed
});

/// An ending of words, and its quantity.
type Ending = (&'static str, Quantities);

/// Endings of words by their last letters, in the order of these.
static ENDINGS: LazyLock<Vec<(char, Vec<Ending>)>> = LazyLock::new(|| {
    let mut endings: BTreeMap<char, Vec<Ending>> = BTreeMap::new();
    for (place, lexicon) in LEXICON.iter().enumerate() {
        for &ending in lexicon.endings {
            let last = ending.chars().last().unwrap_or_default();
            endings.entry(last).or_default().push((ending, 1 << place));
        }
    }
    endings.into_iter().collect()
});

/// Endings of words with this last letter.
fn endings(last: char) -> &'static [Ending] {
    let place = ENDINGS.binary_search_by_key(&last, |(letter, _)| *letter);
    place.map_or(&[], |place| &ENDINGS[place].1)
}

/// A word in lower case, and what the lists say of it.
#[derive(Clone, Copy)]
struct Word<'w> {
    text: &'w str,
    listed: Listed,
    /// The quantities that it names.
    named: Quantities,
    /// The longest ending of a quantity's words that it has: the most specific, as in `试验时间`.
    ending: Option<&'static str>,
}

impl<'w> Word<'w> {
    fn of(text: &'w str) -> Self {
        let listed = LISTED.get(text).copied().unwrap_or_default();
        let last = text.chars().next_back().unwrap_or_default();
        let mut ended = 0;
        let mut longest: Option<&str> = None;
        for &(ending, quantity) in endings(last) {
            if text.ends_with(ending) {
                ended |= quantity;
                longest = longest
                    .filter(|known| known.len() > ending.len())
                    .or(Some(ending));
            }
        }
        // `Vorspannkraft` is a word of its own.
        let ended = if listed.words == 0 { ended } else { 0 };
        Self {
            text,
            listed,
            named: listed.words | listed.endings | ended,
            ending: longest,
        }
    }

    /// Whether it is understood, also as a compound: `Prüfkraft`, but not `Nennkraft`.
    fn is_understood(self) -> bool {
        match self.ending {
            Some(ending) => {
                let rest = &self.text[..self.text.len() - ending.len()];
                self.listed.words != 0 || Self::of(rest).is_plain()
            }
            None => self.is_plain(),
        }
    }

    fn is_plain(self) -> bool {
        let listed = self.listed;
        is_letter(self.text)
            || self.text.is_empty()
            || self.named | listed.weak != 0
            || listed.is_generic
            || listed.is_measured
    }

    fn is_surely_other(self) -> bool {
        let text = self.text;
        self.listed.is_other
            // Kraftsollwert, Sollweg.
            || text.starts_with("soll")
            || text.ends_with("sollwert")
            || ["指令", "目标", "目標"].iter().any(|ending| text.ends_with(ending))
    }

    fn is_doubtful(self) -> bool {
        let mut endings = ["应力", "応力", "应变"].into_iter();
        self.listed.is_doubtful || endings.any(|ending| self.text.ends_with(ending))
    }
}

fn is_letter(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some() && letters.next().is_none()
}

/// What the words of a name say together. The words themselves are not kept, because a name may have any number of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Words {
    count: usize,
    /// Those for quantities.
    known: usize,
    named: Quantities,
    /// The quantities that the last word names next to a unit of them, and those that the first does.
    weak: Quantities,
    first: Quantities,
    is_surely_other: bool,
    is_doubtful: bool,
    has_letter: bool,
    /// Whether some word carries information about a quantity; whether one does that is no single letter.
    is_special: bool,
    is_long_and_special: bool,
    /// Whether some word is not understood.
    is_strange: bool,
}

impl Words {
    /// Those of a text.
    pub fn of(text: &str) -> Self {
        let mut words = Self::default();
        words.read(text);
        words
    }

    /// Those of a text, and those before each of the places of `cuts`, in rising order, where a unit begins: without an `in` before
    /// it.
    pub fn before<const N: usize>(text: &str, cuts: [usize; N]) -> (Self, [Self; N]) {
        let (mut words, mut others) = (Self::default(), Self::default());
        let mut is_in = false;
        let mut before = [Self::default(); N];
        let mut cuts = cuts.into_iter().zip(&mut before).peekable();
        each_word_at(text, |word, begin| {
            while let Some((_, before)) = cuts.next_if(|(cut, _)| *cut <= begin) {
                *before = if is_in && words.count > 1 {
                    others
                } else {
                    words
                };
            }
            others = words;
            words.add(word);
            is_in = word == "in";
        });
        for (_, before) in cuts {
            *before = if is_in && words.count > 1 {
                others
            } else {
                words
            };
        }
        (words, before)
    }

    /// Adds those of a further text.
    pub fn read(&mut self, text: &str) {
        each_word(text, |word| self.add(word));
    }

    fn add(&mut self, text: &str) {
        let word = Word::of(text);
        self.count += 1;
        self.known += usize::from(word.named != 0);
        self.named |= word.named;
        self.weak = word.listed.weak;
        if self.count == 1 && text.chars().count() <= SYMBOL {
            self.first = word.listed.weak;
        }
        self.is_surely_other |= word.is_surely_other();
        self.is_doubtful |= word.is_doubtful();
        self.has_letter |= is_letter(text);
        self.is_special |= !word.listed.is_generic;
        self.is_long_and_special |= !word.listed.is_generic && text.len() > 1;
        self.is_strange |= !word.is_understood();
    }

    /// Number of words.
    pub fn count(self) -> usize {
        self.count
    }

    /// Number of words for quantities.
    pub fn known(self) -> usize {
        self.known
    }

    /// Whether one of them is a single letter.
    pub fn has_letter(self) -> bool {
        self.has_letter
    }

    fn certainty(self, place: usize) -> Option<Certainty> {
        let bit = 1 << place;
        if self.named & bit != 0 {
            return Some(Certainty::Strong);
        }
        // Next to other words a short one may mean anything: `x axis`, `load p`.
        (self.count == 1 && self.weak & bit != 0).then_some(Certainty::Weak)
    }

    /// How certain they mean a channel.
    pub fn of_channel(self, channel: Channel) -> Option<Certainty> {
        let mut lexicon = LEXICON.iter().enumerate();
        lexicon.find_map(|(place, lexicon)| match lexicon.quantity {
            Quantity::Channel(of) if of == channel => self.certainty(place),
            _ => None,
        })
    }

    /// Whether the first of several words is a symbol of a channel, and no word means a quantity: the `F` of `F_AX_LC1`.
    pub fn begin_with_symbol(self, channel: Channel) -> bool {
        let mut lexicon = LEXICON.iter().enumerate();
        let of_channel =
            |lexicon: &super::lexicon::Lexicon| lexicon.quantity == Quantity::Channel(channel);
        let place = lexicon.position(|(_, lexicon)| of_channel(lexicon));
        let is_symbol = place.is_some_and(|place| self.first & (1 << place) != 0);
        self.count > 1 && self.named == 0 && is_symbol
    }

    /// The control inputs that they mean, each with its units.
    fn control_inputs(self) -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
        let lexicon = LEXICON.iter().enumerate();
        lexicon.filter_map(move |(place, lexicon)| match lexicon.quantity {
            Quantity::Control(name, units) => self.certainty(place).map(|_| (name, units)),
            Quantity::Channel(_) => None,
        })
    }

    /// The control input that they mean with this unit.
    pub fn of_control(self, unit: &str) -> Option<&'static str> {
        let mut inputs = self.control_inputs();
        let found = inputs.find(|(_, units)| units.contains(&unit));
        found.map(|(name, _)| name)
    }

    /// Whether they can stand before this unit: they mean no control input, or one that has it.
    pub fn may_have(self, unit: &str) -> bool {
        !self.is_control() || self.of_control(unit).is_some()
    }

    /// Whether they mean a control input.
    pub fn is_control(self) -> bool {
        self.control_inputs().next().is_some()
    }

    /// Whether they say that the column is not a measurement of a channel, or may be something else.
    pub fn is_other(self) -> bool {
        self.is_surely_other || self.is_doubtful
    }

    /// Whether they say that the column is not a measurement of a channel.
    pub fn is_surely_other(self) -> bool {
        self.is_surely_other
    }

    /// Whether all of them are understood.
    pub fn are_understood(self) -> bool {
        !self.is_strange
    }

    /// Whether they contain no information about a quantity.
    pub fn are_generic(self) -> bool {
        if self.count > 1 {
            !self.is_long_and_special
        } else {
            !self.is_special
        }
    }
}

/// Calls `take` with each word of a text, in lower case: `AxialForce` has two, and digits belong to none.
pub(crate) fn each_word(text: &str, mut take: impl FnMut(&str)) {
    each_word_at(text, |word, _| take(word));
}

/// The same with the place where the word begins.
fn each_word_at(text: &str, mut take: impl FnMut(&str, usize)) {
    let mut word = String::new();
    let mut begin = 0;
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        let is_inner = c.is_alphabetic();
        // `AxialForce`, and not `FORCE`.
        let begins = c.is_uppercase() && before.is_lowercase();
        if (!is_inner || begins) && !word.is_empty() {
            take(&word, begin);
            word.clear();
        }
        if is_inner {
            if word.is_empty() {
                begin = at;
            }
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    if !word.is_empty() {
        take(&word, begin);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_split_where_words_begin() {
        for (text, is) in [
            ("AxialForce", &["axial", "force"][..]),
            ("AXIAL FORCE 2", &["axial", "force"]),
            ("Time (HH:MM:SS,ms)", &["time", "hh", "mm", "ss", "ms"]),
            ("42", &[]),
        ] {
            let mut words = Vec::new();
            each_word(text, |word| words.push(word.to_owned()));
            assert_eq!(words, is, "{text}");
        }
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
                .filter(|&each| Words::of(text).of_channel(each) == Some(Certainty::Strong))
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
                Words::of(text).of_channel(channel),
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
            let words = Words::of(text);
            let force = words.of_channel(Force);
            assert!(force.is_none() || words.is_other(), "{text}");
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
            assert!(Words::of(text).is_other(), "{text}");
        }
        for text in [
            "axial displacement",
            "position feedback",
            "istweg",
            "running time",
        ] {
            assert!(!Words::of(text).is_other(), "{text}");
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
            assert_eq!(Words::of(text).are_understood(), is, "{text}");
        }
    }

    #[test]
    fn a_unit_tells_the_two_meanings_of_tension_apart() {
        assert_eq!(Words::of("tension").of_control("V"), Some("voltage"));
        assert_eq!(Words::of("tension").of_control("N"), Some("tension"));
        assert_eq!(Words::of("extension").of_control("V"), None);
        assert_eq!(Words::of("spannung").of_control("MPa"), None);
    }

    #[test]
    fn no_word_of_two_channels_is_sure() {
        let is_channel = |quantity| matches!(quantity, Quantity::Channel(_));
        for lexicon in LEXICON.iter().filter(|each| is_channel(each.quantity)) {
            for word in lexicon.words.iter().chain(lexicon.endings) {
                let named = Word::of(word).named;
                let channels = LEXICON.iter().enumerate();
                let channels = channels
                    .filter(|(place, each)| is_channel(each.quantity) && named & (1 << place) != 0);
                assert_eq!(channels.count(), 1, "{word}");
                let lists = [OTHER, DOUBTFUL, GENERIC, MEASURED];
                assert!(!lists.iter().any(|list| list.contains(word)), "{word}");
            }
        }
    }
}
