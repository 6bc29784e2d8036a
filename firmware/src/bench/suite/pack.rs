//! A slice of a pack's check: the additional work of a rig that continues to tick.

use mesh_damper::effects::residual_table::Memory;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::pack::{Expectation, LARGEST, PackError, PackInfo, Upload, encode};

use super::Refused;
use super::effects::{correction, each, law};
use super::tally::{Meter, Tally};
use super::tick::TICK_RATE;

/// Most effects of the law.
const EFFECTS: usize = 8;

impl From<PackError> for Refused {
    fn from(_: PackError) -> Self {
        Self
    }
}

/// A pack that has arrived, and the place for its law.
struct Waiting {
    upload: Upload,
    slot: FastLaw<EFFECTS>,
    expected: Expectation,
    /// The result of the last slice, after it ran. It holds no more of an error than that, because a copy would be counted.
    done: Option<bool>,
}

extern "C" fn slice(waiting: &mut Waiting, _: f32, _: f32) -> f32 {
    let slice = waiting
        .upload
        .finish_slice(&mut waiting.slot, &waiting.expected);
    waiting.done = match slice {
        Ok(None) => None,
        Ok(Some(_)) => Some(true),
        Err(_) => Some(false),
    };
    f32::from(u8::from(waiting.done.is_some()))
}

/// For packs that together contain every effect, eight in each, with a residual table in addition.
///
/// # Errors
/// None: the packs are valid.
pub fn run(meter: &mut impl Meter) -> Result<(), Refused> {
    let mut tally = Tally::default();
    let each = each()?;
    let most = each.len().div_ceil(EFFECTS);
    for first in 0..most {
        let effects = each.iter().skip(first * EFFECTS).take(EFFECTS);
        let law = law::<EFFECTS>(effects.map(|(_, effect)| *effect))?;
        // The damping counts at each node of a table over speed.
        let lag = (Memory::Lag { time: 0.05 }, [-0.2, 0.2]);
        let table = correction((first > 0).then_some(lag))?.passive(|_| 0.0);
        let law = FastLaw::new(law.with_residual_table(table)?);
        let mut buffer = [0; LARGEST];
        let pack = encode(&law, &PackInfo::at(TICK_RATE as f32), &mut buffer)?;
        let mut waiting = Waiting {
            upload: Upload::new(),
            slot: FastLaw::EMPTY,
            expected: Expectation::at(TICK_RATE as f32),
            done: None,
        };
        waiting.upload.part(0, pack)?;
        while waiting.done.is_none() {
            tally.add(meter.call(slice, &mut waiting, 0.0, 0.0));
        }
        if waiting.done != Some(true) || waiting.slot != law {
            return Err(Refused);
        }
    }
    meter.report("pack/slice", "call", &tally);
    Ok(())
}
