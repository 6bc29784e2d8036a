//! Values from the bytes of an input.

/// Takes bytes from the front; gives 0 when none are left.
pub struct Feed<'a>(pub &'a [u8]);

impl Feed<'_> {
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        first
    }

    /// 0…1
    pub fn part(&mut self) -> f64 {
        let bytes = [self.byte(), self.byte()];
        f64::from(u16::from_le_bytes(bytes)) / f64::from(u16::MAX)
    }

    /// `low`…`high`, both above 0, uniform over the orders of magnitude.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        (low * (high / low).powf(self.part())).clamp(low, high)
    }

    /// The same with either sign.
    pub fn either(&mut self, low: f64, high: f64) -> f64 {
        let sign = if self.byte().is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        sign * self.between(low, high)
    }

    pub fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[usize::from(self.byte()) % values.len()]
    }
}

/// Pseudo-random numbers from a seed (SplitMix64).
pub struct Random(u64);

impl Random {
    /// A generator whose seed depends on all of `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        let mix = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        Self(bytes.iter().fold(0xcbf2_9ce4_8422_2325, mix))
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Any float: a special value, one of ordinary size, or any bit pattern.
    pub fn float(&mut self) -> f32 {
        const ODD: [f32; 12] = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN,
            f32::MIN_POSITIVE,
            1e-45,
            -1e-45,
            1e-40,
            -0.0,
            0.0,
            -1.0,
        ];
        let drawn = self.next();
        let bits = (drawn >> 32) as u32;
        match drawn % 4 {
            0 => ODD[(bits % ODD.len() as u32) as usize],
            1 => f32::from_bits(bits),
            // −1…1
            _ => (bits as i32) as f32 * (1.0 / (1u32 << 31) as f32),
        }
    }
}
