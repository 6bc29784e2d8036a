//! The interface of a law for a firmware's tick. The law is either composed by its type, or read while the rig runs.

use crate::effects::Motion;
use crate::fast_law::Adaptation;

/// A running law: its configuration and its state.
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

    /// Puts all effects at rest.
    fn rest(&mut self);

    /// Marks the end of a cycle: a waiting law takes over. Returns whether one did.
    fn boundary(&mut self) -> bool;

    /// From now on k1, k3 and c differ from the law as given by these parts, clamped to −1…1.
    fn follow(&mut self, followed: Adaptation);

    /// Relative difference between the running law and the law as given.
    fn followed(&self) -> Adaptation;

    /// k1·y, k3·y³ and c·|v|^α·sgn v of the law as given, kN, each as its effects change it. 0 where a stage lies between the
    /// specimen and the measurement. Not for every tick.
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
