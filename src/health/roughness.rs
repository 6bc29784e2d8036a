//! Noise and hum on a channel: the part of its error that neither a motion nor a specimen causes.
//!
//! The error of a channel is that of the displacement against the demand, or of the force against the law. From one close look to
//! the next, a 32nd of a cycle, it changes smoothly, so its third difference is small: 0.0075 for a sine. Noise is different, and
//! so is hum, which at most frequencies goes through a large part of its period between two looks. Friction makes the force jump
//! where the velocity changes its sign; differences across that do not count. A gap that opens bends the force at four places of a
//! cycle; noise is everywhere. The monitor therefore counts the looks whose third difference exceeds three times the learned mean:
//! for Gaussian noise one in 60.

/// Third difference divided by the learned mean above which a look is rough.
pub(super) const FACTOR: f32 = 3.0;
/// Number of rough looks among the last 32 at which the channel is noisy. With Gaussian noise at the learned level one look in 60
/// is rough. A gap bends the force at four places of a cycle, three looks each, which are 15 among 32.
const ROUGH: u32 = 20;
/// Number of rough looks at which a channel may soon be noisy.
pub(super) const SOME: u32 = 8;
/// Fewest ticks per cycle: with fewer, the looks are spaced too unevenly, by up to a tick in a 32nd of the cycle.
pub(super) const LEAST_TICKS: u32 = 400;
/// Lower limit of the learned third difference, as a part of the amplitude.
const LEAST: f32 = 0.002;

/// A channel's error, look by look.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Roughness {
    /// The last three errors, and the number of looks since the velocity's sign changed, this one included, up to 4.
    errors: [f32; 3],
    looks: u8,
    positive: bool,
    /// Sum and number of the third differences while learning, and the learned mean, or its lower limit.
    sum: f32,
    learned: f32,
    usual: f32,
    /// One bit for each of the last looks that counted.
    rough: u32,
    /// Number of bits that are set.
    count: u32,
}

impl Roughness {
    /// Starts to learn again.
    pub(super) fn relearn(&mut self) {
        *self = Self::default();
    }

    /// Another motion begins, or a sample was bad: no difference spans it.
    pub(super) fn interrupt(&mut self) {
        self.looks = 0;
        self.rough = 0;
        self.count = 0;
    }

    /// Number of the last looks that were rough.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// Takes one look at the `error` of a channel with this `amplitude`, at this `velocity`. Outside learning, if the channel is
    /// noisy, returns the learned mean third difference divided by the amplitude.
    #[inline]
    pub(super) fn update(
        &mut self,
        error: f32,
        velocity: f32,
        amplitude: f32,
        learns: bool,
    ) -> Option<f32> {
        let positive = velocity > 0.0;
        self.looks = if positive == self.positive {
            self.looks.saturating_add(1).min(4)
        } else {
            1
        };
        self.positive = positive;
        let [first, second, third] = self.errors;
        self.errors = [second, third, error];
        if self.looks < 4 {
            return None;
        }
        let difference = (error - first + 3.0 * (second - third)).abs();
        if learns {
            self.sum += difference;
            self.learned += 1.0;
            return None;
        }
        if self.learned > 0.0 {
            self.take_learned(amplitude);
        }
        let is_rough = difference > FACTOR * self.usual;
        // The oldest look drops out as the new one comes in.
        self.count = self.count + u32::from(is_rough) - (self.rough >> 31);
        self.rough = self.rough << 1 | u32::from(is_rough);
        (self.count >= ROUGH).then(|| self.usual / amplitude)
    }

    #[cold]
    #[inline(never)]
    fn take_learned(&mut self, amplitude: f32) {
        let (mean, least) = (self.sum / self.learned, LEAST * amplitude);
        self.usual = if mean > least { mean } else { least };
        self.sum = 0.0;
        self.learned = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::TAU;

    fn noise(look: u32) -> f32 {
        let bits = |shift: u32| {
            let x = (look ^ shift).wrapping_mul(2_654_435_761).rotate_left(13);
            (x.wrapping_mul(0x9E37_79B9) >> 8) as f32 / (1 << 24) as f32 - 0.5
        };
        // Nearly Gaussian, with a standard deviation of 1.
        (0..12u32).map(|shift| bits(shift << 24)).sum()
    }

    /// Looks after which a channel is noisy whose error becomes `after`, following 20 cycles of `before`.
    fn noisy_after(
        before: impl Fn(f32, f32) -> f32,
        after: impl Fn(f32, f32) -> f32,
    ) -> Option<u32> {
        let mut roughness = Roughness::default();
        for look in 0..32 * 60u32 {
            let (cycle, part) = (look / 32, look % 32);
            let turns = (4 * part + 1 + 2 * (cycle % 2)) as f32 / 128.0 + cycle as f32;
            let error = if cycle < 20 {
                before(turns, noise(look))
            } else {
                after(turns, noise(look))
            };
            let velocity = libm::cosf(TAU * turns);
            let learns = cycle < 16;
            if roughness.update(error, velocity, 1.0, learns).is_some() {
                assert!(cycle >= 20, "{cycle}");
                return Some(look - 32 * 20);
            }
        }
        None
    }

    /// 50 Hz on motion of 2, 3, 5 and 10 Hz.
    #[test]
    fn hum_and_noise_are_found_within_a_cycle_and_a_half() {
        for level in [0.002, 0.004] {
            let quiet = |_: f32, noise: f32| level * noise;
            for harmonic in [25.0, 16.7, 10.0, 5.0] {
                let hum = |turns: f32, noise: f32| {
                    level * noise + 0.05 * libm::sinf(TAU * harmonic * turns + 0.7)
                };
                let found = noisy_after(quiet, hum);
                assert!(
                    found.is_some_and(|looks| looks < 48),
                    "{harmonic}: {found:?}"
                );
            }
            let louder = |_: f32, noise: f32| 10.0 * level * noise;
            let found = noisy_after(quiet, louder);
            assert!(found.is_some_and(|looks| looks < 48), "{found:?}");
            assert_eq!(noisy_after(quiet, quiet), None);
        }
    }

    /// Breakage, a gap, and rising friction.
    #[test]
    fn the_residual_of_a_specimen_is_smooth() {
        for level in [0.002, 0.004, 0.01] {
            let quiet = |_: f32, noise: f32| level * noise;
            let y = |turns: f32| libm::sinf(TAU * turns);
            let changes: [&dyn Fn(f32) -> f32; 3] = [
                &|turns| -0.3 * (y(turns) + 0.5 * y(turns) * y(turns) * y(turns)),
                &|turns| -y(turns).clamp(-0.2, 0.2),
                &|turns| 0.2 * libm::cosf(TAU * turns).signum(),
            ];
            for change in changes {
                let changed = |turns: f32, noise: f32| level * noise + change(turns);
                assert_eq!(noisy_after(quiet, changed), None);
            }
        }
    }
}
