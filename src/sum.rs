//! Sums of many floats.

/// Terms between two folds of a [`Sum`].
pub(crate) const FOLD: u32 = 16;

/// A long sum of floats with the rounding error of a short one.
///
/// [`FOLD`] terms are added plainly, which costs half as much as compensating every term, with an error of at most 16·2⁻²⁴ of those
/// sixteen. Their sum is then added with its rounding error kept (Knuth's two-sum).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    part: f32,
    high: f32,
    low: f32,
}

impl Sum {
    /// An empty sum.
    pub(crate) const ZERO: Self = Self {
        part: 0.0,
        high: 0.0,
        low: 0.0,
    };

    /// Adds one term.
    #[inline(always)]
    pub(crate) fn add(&mut self, term: f32) {
        self.part += term;
    }

    /// Call it after every [`FOLD`] terms.
    #[inline(always)]
    pub(crate) fn fold(&mut self) {
        let sum = self.high + self.part;
        let added = sum - self.high;
        self.low += (self.high - (sum - added)) + (self.part - added);
        self.high = sum;
        self.part = 0.0;
    }

    /// The sum so far.
    pub(crate) fn total(self) -> f32 {
        self.high + (self.low + self.part)
    }
}
