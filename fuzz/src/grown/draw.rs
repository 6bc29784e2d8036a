//! What grows in a file: counts, sizes and names, drawn by a seed.

use crate::feed::Random;

/// Bytes that a drawn file may have, and that it may unpack to.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Of the file.
    pub file: usize,
    /// Of what it unpacks to.
    pub unpacked: usize,
}

impl Size {
    /// Bytes that count as read at most.
    #[cfg(test)]
    pub fn read(self) -> usize {
        self.file.max(self.unpacked)
    }
}

/// Draws of one file.
pub struct Draw {
    random: Random,
    pub size: Size,
}

/// The names of a file's many things: all of one kind.
#[derive(Clone, Copy, Debug)]
pub enum Names {
    /// As few letters as make them different.
    Short,
    /// All the same.
    Same,
    /// Different, and this long.
    Long(usize),
    /// Words of quantities with a unit, which readers look up.
    Quantities,
    /// Brackets and signs about nothing, in which readers look for a unit.
    Signs(usize),
}

impl Draw {
    pub fn of(seed: u64, size: Size) -> Self {
        Self {
            random: Random::of(&seed.to_le_bytes()),
            size,
        }
    }

    /// 0…`end` − 1; 0 if there is none.
    pub fn below(&mut self, end: usize) -> usize {
        self.random.next() as usize % end.max(1)
    }

    pub fn chance(&mut self) -> bool {
        self.below(2) == 0
    }

    pub fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// 1…`most`: half of the time close to it, else of any order of magnitude.
    pub fn count(&mut self, most: usize) -> usize {
        let most = most.max(1);
        if self.chance() {
            return most - self.below(most / 4 + 1);
        }
        let digits = usize::BITS - most.leading_zeros();
        let high = 1 << self.below(digits as usize);
        (high + self.below(high)).clamp(1, most)
    }

    /// The number of things of this size in bytes that a file has.
    pub fn fit(&mut self, each: usize) -> usize {
        let most = self.size.file / each.max(1);
        self.count(most - most / 8)
    }

    /// Two counts, of which the larger comes first half of the time, whose product with `each` bytes is at most `room`.
    pub fn pair(&mut self, each: usize, room: usize) -> (usize, usize) {
        let first = self.count(room / each.max(1));
        let second = self.count(room / (each.max(1) * first));
        if self.chance() {
            (first, second)
        } else {
            (second, first)
        }
    }

    pub fn names(&mut self) -> Names {
        let long = self.count(300);
        match self.below(6) {
            0 | 1 => Names::Short,
            2 => Names::Same,
            3 => Names::Long(long),
            4 => Names::Quantities,
            _ => Names::Signs(long),
        }
    }
}

impl Names {
    /// The name of the thing with this index.
    pub fn of(self, index: usize) -> String {
        match self {
            Self::Short => short(index),
            Self::Same => "F".to_owned(),
            Self::Long(length) => {
                let name = short(index);
                "n".repeat(length.saturating_sub(name.len())) + &name
            }
            Self::Quantities => {
                const WORDS: [&str; 6] = ["Force", "Weg", "Time", "Temp", "Strom", "Load cell"];
                const UNITS: [&str; 6] = ["[kN]", "(mm)", "/ s", "degC", "in A", "[furlong]"];
                let (word, unit) = (WORDS[index % 6], UNITS[index / 6 % 6]);
                format!("{word} {} {unit}", short(index / 36))
            }
            Self::Signs(length) => {
                let signs = "([{<_ -./,>}])".repeat(length / 14 + 1);
                format!("{}{}", &signs[..length.clamp(1, signs.len())], short(index))
            }
        }
    }

    /// The most bytes of a name.
    pub fn longest(self) -> usize {
        match self {
            Self::Short | Self::Same => 5,
            Self::Long(length) => length.max(5),
            Self::Quantities => 25,
            Self::Signs(length) => length + 5,
        }
    }
}

/// A number in letters and digits.
fn short(mut index: usize) -> String {
    const SIGNS: &[u8; 36] = b"abcdefghijklmnopqrstuvwxyz0123456789";
    let mut name = vec![SIGNS[index % 26]];
    index /= 26;
    while index > 0 {
        name.push(SIGNS[index % 36]);
        index /= 36;
    }
    name.iter().map(|&sign| char::from(sign)).collect()
}
