//! The law with its effects, read from a coefficient pack.

use core::borrow::{Borrow, BorrowMut};

use mesh_damper::fast_law::{Adaptation, RunningLaw};
use mesh_damper::pack::{self, Expectation, Identity, PackError};
use mesh_damper::tick_law::TickLaw;

use crate::error::{Error, Problem, answer, code};
use crate::storage::{self, Storage, assert_fits, held};

/// Largest number of effects in a law.
pub const MD_EFFECTS: usize = 8;
/// Largest number of control inputs of a damper.
pub const MD_CONTROLS: usize = 4;
/// Length of an identity, bytes.
pub const MD_IDENTITY: usize = 8;

/// Bytes of `md_law`, with room for effects to come.
pub const MD_LAW_SIZE: usize = 8192;
/// Alignment of `md_law`, bytes.
pub const MD_LAW_ALIGN: usize = 8;

/// Memory of a law: the mixed damping law k1*y + k3*y^3 + c*|v|^alpha*sgn v with up to MD_EFFECTS effects, their state, and another
/// law that waits. `md_law_init` fills it. It must stay in place: do not copy it.
#[repr(C, align(8))]
pub struct Law {
    storage: [u8; MD_LAW_SIZE],
}

/// cbindgen:ignore
pub(crate) type Running = RunningLaw<MD_EFFECTS>;

// SAFETY: the assertion below.
unsafe impl Storage for Law {
    type Inner = Running;
    const TAG: u32 = u32::from_le_bytes(*b"law1");
    // So that an effect that is added takes no more memory of a program in C.
    const SLACK: usize = 256;
}
const _: () = assert_fits::<Law>();
const _: () = assert!(MD_CONTROLS == mesh_damper::effects::CONTROLS);
const _: () = assert!(MD_IDENTITY == size_of::<Identity>());

/// One tick of motion as the law sees it. Unknown fields stay 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Displacement, mm; limited to -1e4...1e4, and NaN counts as 0.
    pub displacement: f32,
    /// Velocity, mm/s; limited to -1e6...1e6, and NaN counts as 0.
    pub velocity: f32,
    /// Acceleration, mm/s^2; limited to -1e9...1e9, and NaN counts as 0.
    pub acceleration: f32,
    /// Cycles since the test began, including the fraction of the current one.
    pub cycles: f32,
    /// Temperature of the specimen, degrees Celsius; a constant if it is not measured.
    pub temperature: f32,
    /// Control inputs in the units of the effects that depend on them, such as a current in A; 0 for unused ones.
    pub controls: [f32; MD_CONTROLS],
}

/// Requirements on a pack. If all fields are 0, only a passive law is required.
#[repr(C)]
pub struct Expected {
    /// Ticks per second, Hz: the rate at which the law is called. At 0 any rate is accepted, although the effects of a pack are
    /// correct at one rate only.
    pub tick_rate: f32,
    /// Identity of the required model, MD_IDENTITY bytes; null if any model is accepted.
    pub identity: *const u8,
    /// The revision must be above this; null if any revision is accepted.
    pub newer_than: *const u32,
    /// Whether a law that is not passive is accepted, such as one with damping below 0. It can drive a system to ever larger
    /// motion.
    pub allow_active: bool,
}

/// # Safety
/// As [`md_law_init`].
unsafe fn expectation(expected: *const Expected) -> Result<Expectation, Error> {
    // SAFETY: guaranteed by the caller, here and below.
    let asked = unsafe { storage::read(expected) }?;
    let identity = if asked.identity.is_null() {
        None
    } else {
        let bytes: &[u8; MD_IDENTITY] = unsafe { storage::read(asked.identity.cast()) }?;
        Some(Identity(*bytes))
    };
    let newer_than = if asked.newer_than.is_null() {
        None
    } else {
        Some(*unsafe { storage::read(asked.newer_than) }?)
    };
    Ok(Expectation {
        tick_rate: (asked.tick_rate != 0.0).then_some(asked.tick_rate),
        identity,
        newer_than,
        allow_active: asked.allow_active,
    })
}

/// # Safety
/// As [`md_law_init`].
unsafe fn swap(
    law: &mut Running,
    pack: *const u8,
    length: usize,
    expected: *const Expected,
) -> Result<(), Problem> {
    // SAFETY: guaranteed by the caller.
    let (pack, expected) = unsafe { (storage::slice(pack, length)?, expectation(expected)?) };
    law.swap_with(|slot| pack::decode(pack, slot, &expected).map(|_| ()))
        .map_err(|error: PackError| error.into())
}

/// Loads the law of a pack into `law`, with its effects at rest. If the pack is rejected, `law` is not initialised: its force is 0,
/// and no emulation and no rig accepts it.
///
/// * `pack`: `length` bytes, as written by `hil export`
/// * `expected`: requirements on the pack
/// * `problem`: receives the details of an error; may be null
///
/// Returns MD_ERROR_NONE, or MD_ERROR_NULL, MD_ERROR_MISALIGNED, an MD_ERROR_PACK_..., or the code of a field in the pack that is
/// out of its range.
///
/// # Safety
/// Each pointer is null or points to memory of its type; `pack` points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_law_init(
    law: *mut Law,
    pack: *const u8,
    length: usize,
    expected: *const Expected,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        // The pack is read into the memory of the law: a second law is more than a stack may hold.
        let filled = storage::initialize(law, || Ok(Running::empty())).and_then(|()| {
            let law = held(law)?;
            swap(law, pack, length, expected)?;
            law.boundary();
            Ok(())
        });
        if filled.is_err() {
            storage::forget(law);
        }
        answer(filled, problem)
    }
}

/// Loads the law of another pack in addition to the one in use. It takes over with the next `md_law_boundary`, or at the end of a
/// cycle of the emulation or the rig that has `law`. If the pack is rejected, no law waits and the one in use stays. The state of
/// the effects is kept if both laws have the same kinds of effects in the same order.
///
/// Parameters and codes are those of `md_law_init`, and MD_ERROR_NOT_INITIALIZED. Call it between two ticks, not from an interrupt
/// that may come within a tick.
///
/// # Safety
/// As `md_law_init`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_law_load(
    law: *mut Law,
    pack: *const u8,
    length: usize,
    expected: *const Expected,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let loaded = held(law)
            .map_err(Problem::from)
            .and_then(|law| swap(law, pack, length, expected));
        answer(loaded, problem)
    }
}

/// Ends a cycle: a waiting law takes over. Returns whether one did; false for a law that is null or not initialised.
///
/// # Safety
/// `law` is null or points to an `md_law`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_law_boundary(law: *mut Law) -> bool {
    // SAFETY: guaranteed by the caller.
    unsafe { held(law) }.is_ok_and(RunningLaw::boundary)
}

/// Resets all effects to rest, as before the first tick. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED.
///
/// # Safety
/// `law` is null or points to an `md_law`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_law_rest(law: *mut Law) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(law) }.map(RunningLaw::rest))
}

/// The force of this tick, kN: the mixed damping law's plus every effect's. Call it once per tick, in order, at the pack's tick
/// rate. It cannot fail, and it is finite for every motion. It is 0 for a pointer that is null or misaligned, and for a law that is
/// not initialised or whose pack was rejected.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_law_force(law: *mut Law, motion: *const Motion) -> f32 {
    // Read one after the other: as a pair, both results take seven instructions more.
    // SAFETY: guaranteed by the caller, for both.
    let Ok(law) = (unsafe { held(law) }) else {
        return 0.0;
    };
    let Ok(motion) = (unsafe { storage::read(motion) }) else {
        return 0.0;
    };
    law.force(&motion.of_crate())
}

impl Motion {
    #[inline(always)]
    fn of_crate(&self) -> mesh_damper::effects::Motion<f32> {
        mesh_damper::effects::Motion {
            displacement: self.displacement,
            velocity: self.velocity,
            acceleration: self.acceleration,
            cycles: self.cycles,
            temperature: self.temperature,
            controls: self.controls,
        }
    }
}

/// A law that C owns and a controller calls. C may load another law into it between two ticks, so no reference to it outlives a
/// call.
///
/// The pointer is C's own pointer, never derived from a reference: `md_law_load` makes a `&mut` of C's pointer, which would
/// invalidate every pointer derived from an earlier `&mut`.
#[derive(Debug)]
pub(crate) struct SharedLaw(*mut Running);

impl SharedLaw {
    /// # Safety
    /// As [`held`]; the memory outlives the value.
    pub(crate) unsafe fn of(law: *mut Law) -> Result<Self, Error> {
        // SAFETY: guaranteed by the caller.
        unsafe { storage::value_place(law) }.map(Self)
    }

    #[inline(always)]
    fn law(&self) -> &Running {
        // SAFETY: it was initialised, stays in place, and nothing else uses it within a call.
        unsafe { &*self.0 }
    }

    #[inline(always)]
    fn law_mut(&mut self) -> &mut Running {
        // SAFETY: as above.
        unsafe { &mut *self.0 }
    }
}

impl Borrow<Running> for SharedLaw {
    #[inline(always)]
    fn borrow(&self) -> &Running {
        self.law()
    }
}

impl BorrowMut<Running> for SharedLaw {
    #[inline(always)]
    fn borrow_mut(&mut self) -> &mut Running {
        self.law_mut()
    }
}

impl TickLaw for SharedLaw {
    #[inline(always)]
    fn force(&mut self, motion: &mesh_damper::effects::Motion<f32>) -> f32 {
        self.law_mut().force(motion)
    }
    fn rest(&mut self) {
        self.law_mut().rest();
    }
    #[inline(always)]
    fn boundary(&mut self) -> bool {
        self.law_mut().boundary()
    }
    fn follow(&mut self, followed: Adaptation) {
        self.law_mut().follow(followed);
    }
    fn followed(&self) -> Adaptation {
        self.law().followed()
    }
    fn parts(&self, motion: &mesh_damper::effects::Motion<f32>) -> [f32; 3] {
        TickLaw::parts(self.law(), motion)
    }
}
