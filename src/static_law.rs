//! The mixed damping law with the effects named in its type: only those are linked, and only they hold state.

use crate::effects::{EffectSet, LawForce, Motion};
use crate::error::ConfigError;
use crate::fast_law::Adaptation;
use crate::law::Law;
use crate::power::{PowerSeed, PowerTable};
use crate::real::{Real, in_range};
use crate::tick_law::TickLaw;

/// The running mixed damping law, with its damping from a table of 4 KiB, and the effects of the tuple `E`.
///
/// It is filled in place, so that no law passes through the stack:
///
/// ```
/// use mesh_damper::effects::{Motion, StickSlip};
/// use mesh_damper::law::Law;
/// use mesh_damper::static_law::StaticLaw;
/// use mesh_damper::tick_law::TickLaw as _;
///
/// // In firmware a static.
/// let mut law = StaticLaw::<(StickSlip<f32>,)>::empty();
/// law.set(Law::new(1.2, 30.0, 0.1, 0.3)?, (StickSlip::new(&[(0.5, 0.02)])?,));
/// let force = law.force(&Motion { displacement: 0.1, velocity: 2.0, ..Motion::default() });
/// assert!((force - (0.12 + 0.03 + 0.1 * 2f32.powf(0.3))).abs() < 1e-6);
/// # Ok::<(), mesh_damper::error::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
// The table comes last, so that all other fields are within the offset of a load.
#[repr(C)]
pub struct StaticLaw<E: EffectSet<f32>> {
    in_force: Law<f32>,
    damping_part: f32,
    effects: E,
    state: E::State,
    given: Law<f32>,
    followed: Adaptation,
    table: PowerTable,
}

impl<E: EffectSet<f32>> StaticLaw<E> {
    /// A law without force, until it is set. All bits are 0, so that it takes no flash in a static.
    pub const fn empty() -> Self {
        const NOTHING: Law<f32> = Law::from_valid(0.0, 0.0, 0.0, 0.0);
        Self {
            in_force: NOTHING,
            damping_part: 0.0,
            effects: E::NONE,
            state: E::AT_REST,
            given: NOTHING,
            followed: Adaptation {
                k1: 0.0,
                k3: 0.0,
                c: 0.0,
            },
            table: PowerTable::empty(),
        }
    }

    /// Sets `law` and `effects`, at rest. Computes 64 powers in f64: not for the hot path.
    pub fn set(&mut self, law: Law<f32>, effects: E) {
        let seed = PowerSeed::from_valid(law.c().to_f64(), law.alpha().to_f64());
        self.fill(law, &seed, effects);
    }

    /// [`StaticLaw::set`] with the seed of the damping table that the host computed for `law`. It fills the 256 rows of the table.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`] if `seed` is for another `c` or `alpha`.
    pub fn set_with_seed(
        &mut self,
        law: Law<f32>,
        seed: &PowerSeed,
        effects: E,
    ) -> Result<(), ConfigError> {
        in_range("c", seed.c(), law.c().to_f64(), law.c().to_f64())?;
        in_range(
            "alpha",
            seed.alpha(),
            law.alpha().to_f64(),
            law.alpha().to_f64(),
        )?;
        self.fill(law, seed, effects);
        Ok(())
    }

    fn fill(&mut self, law: Law<f32>, seed: &PowerSeed, effects: E) {
        self.table.fill(seed);
        self.given = law;
        self.effects = effects;
        self.rest();
        self.follow(Adaptation::default());
    }

    /// The law as given.
    pub fn law(&self) -> &Law<f32> {
        &self.given
    }

    /// The effects.
    pub fn effects(&self) -> &E {
        &self.effects
    }
}

impl<E: EffectSet<f32>> TickLaw for StaticLaw<E> {
    #[inline]
    fn force(&mut self, motion: &Motion<f32>) -> f32 {
        let motion = motion.clamped();
        let damping = |v| self.damping_part * self.table.damping_force(v);
        if E::HAS_STAGES {
            return self.effects.force_through_stages(
                &mut self.state,
                &motion,
                &self.in_force,
                damping,
            );
        }
        let law = LawForce::of(&self.in_force, &motion, damping);
        self.effects.force(&mut self.state, &motion, law)
    }

    fn rest(&mut self) {
        self.state = E::AT_REST;
    }

    /// No law can wait here.
    #[inline(always)]
    fn boundary(&mut self) -> bool {
        false
    }

    fn follow(&mut self, followed: Adaptation) {
        let followed = followed.clamped();
        self.in_force = followed.of(&self.given);
        self.damping_part = 1.0 + followed.c;
        self.followed = followed;
    }

    fn followed(&self) -> Adaptation {
        self.followed
    }

    fn parts(&self, motion: &Motion<f32>) -> [f32; 3] {
        if E::HAS_STAGES {
            return [0.0; 3];
        }
        let motion = motion.clamped();
        let scales = LawForce::units().map(|law| self.effects.scaled(&motion, law));
        let damping = self.table.damping_force(motion.velocity());
        crate::fast_law::parts(&self.given, &motion, scales, damping)
    }
}
