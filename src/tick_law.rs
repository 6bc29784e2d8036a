//! What firmware asks of a law every tick, whether the law was composed by its type or is read while it runs.

use crate::effects::Motion;
use crate::fast_law::Adaptation;

/// A law at work: its configuration and what it remembers.
///
/// | law | use it where |
/// |---|---|
/// | [`crate::static_law::StaticLaw`] | the firmware knows its law: only the effects that its type names are linked and hold state |
/// | [`crate::fast_law::RunningLaw`] | the law is read from a pack, or swapped while it runs, as in a [`crate::rig::Rig`] |
///
/// Both give the same force, bit for bit.
pub trait TickLaw {
    /// Force in kN on this tick. Call it once per tick, in order.
    fn force(&mut self, motion: &Motion<f32>) -> f32;

    /// All effects at rest.
    fn rest(&mut self);

    /// A cycle has ended: another law that waited takes over, and says so.
    fn boundary(&mut self) -> bool;

    /// From here on k1, k3 and c differ by these parts, clamped to −1…1, from the law as it was given.
    fn follow(&mut self, followed: Adaptation);

    /// By how much the law in force differs from the law as it was given.
    fn followed(&self) -> Adaptation;

    /// k1·y, k3·y³ and c·|v|^α·sgn v of the law as it was given, kN, with what its effects make of each. 0 where something lies
    /// between the specimen and what is measured. Not for every tick.
    fn parts(&self, motion: &Motion<f32>) -> [f32; 3];
}

impl<T: TickLaw> TickLaw for &mut T {
    #[inline(always)]
    fn force(&mut self, motion: &Motion<f32>) -> f32 {
        T::force(self, motion)
    }
    #[inline(always)]
    fn rest(&mut self) {
        T::rest(self);
    }
    #[inline(always)]
    fn boundary(&mut self) -> bool {
        T::boundary(self)
    }
    #[inline(always)]
    fn follow(&mut self, followed: Adaptation) {
        T::follow(self, followed);
    }
    #[inline(always)]
    fn followed(&self) -> Adaptation {
        T::followed(self)
    }
    #[inline(always)]
    fn parts(&self, motion: &Motion<f32>) -> [f32; 3] {
        T::parts(self, motion)
    }
}
