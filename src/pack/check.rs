//! The check of a pack, and the law that it writes, in slices, so that a tick that does one slice in addition to its own work stays
//! in time.

use super::info;
use super::{Expectation, HEADER, OLDEST, PackError, SILENT_RATE, Stamp};
use crate::effects::{self, Effect, MOST_WORDS};
use crate::fast_law::FastLaw;
use crate::frame::{CHECKSUM, Reader, checksum_with};
use crate::law::Law;
use crate::operating_range::OperatingRange;
use crate::passivity::{Active, Passivity};

/// Size of a slice: bytes of the checksum, numbers of the damping, words of an effect and cells of the table. Each takes at most
/// 380 instructions of a Cortex-M4F, as `cargo hil bench` counts them. The ranges of six sliders, which are checked in one slice,
/// take 600.
const BYTES: usize = 24;
const NUMBERS: usize = 8;
const WORDS: usize = 8;
const CELLS: usize = 24;

/// The next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Header,
    Checksum,
    Info,
    Law,
    /// Removes the table of the law before.
    OldTable,
    /// Reads the seed, from this index on.
    Damping(usize),
    Effects,
    /// Begins the next effect, if there is one.
    Effect,
    /// Reads its words, from this index on.
    Words(usize),
    /// Puts it into the law.
    Put,
    /// Checks its ranges.
    Ranges,
    Table,
    /// Reads the cells, from this index on.
    Cells(usize),
    End,
    /// The law is complete; checks that it is passive.
    Passivity,
}

/// Progress of a pack's check.
#[derive(Clone, Copy, Debug)]
pub(super) struct Check {
    stage: Stage,
    /// Bytes of the pack that have been read, or covered by the checksum.
    at: usize,
    /// The checksum so far, and its expected value.
    checksum: u32,
    expected: u32,
    version: u16,
    stamp: Option<Stamp>,
    range: Option<OperatingRange<f32>>,
    /// Number of effects still to come, and the known part of the next one.
    left: u8,
    effect: u8,
    count: u8,
    words: [f32; MOST_WORDS],
}

impl Check {
    /// A check from the first byte on. All bits are 0, so that an upload takes no flash in a static.
    pub(super) const START: Self = Self {
        stage: Stage::Header,
        at: 0,
        checksum: 0,
        expected: 0,
        version: 0,
        stamp: None,
        range: None,
        left: 0,
        effect: 0,
        count: 0,
        words: [0.0; MOST_WORDS],
    };

    /// Does one slice. Returns the stamp once the whole pack has been checked and its law written over `slot`, which holds no law
    /// until then. `passivity` checks whether the law is passive, unless an active one is allowed: pass the same one each time.
    /// Without it, the caller has to check.
    #[inline(never)]
    pub(super) fn step<const N: usize>(
        &mut self,
        pack: &[u8],
        slot: &mut FastLaw<N>,
        expected: &Expectation,
        passivity: Option<&mut Passivity<N>>,
    ) -> Result<Option<Option<Stamp>>, PackError> {
        let is_before_the_law = matches!(
            self.stage,
            Stage::Header | Stage::Checksum | Stage::Info | Stage::Law
        );
        if !is_before_the_law && !slot.augmented.is_unfinished() {
            // Another law was written over the slot between two slices, or has come into force: the slot no longer holds a part of
            // this law.
            *self = Self::START;
            return Ok(None);
        }
        let mut reader = Reader(pack.get(self.at..).unwrap_or_default());
        self.stage = match self.stage {
            Stage::Header => return self.header(pack).map(|()| None),
            Stage::Checksum => return self.sum(pack).map(|()| None),
            Stage::Info => {
                if self.version != OLDEST {
                    let (found, description) = info::stamp(&mut reader).ok_or(PackError::Body)?;
                    self.stamp = Some(found);
                    expected.check(self.stamp.as_ref())?;
                    self.range = info::operating_range(&mut Reader(description))?;
                } else {
                    expected.check(None)?;
                }
                Stage::Law
            }
            Stage::Law => {
                let eq13 = reader.words().ok_or(PackError::Body)?;
                let [k1, k3, c, alpha] = eq13.map(f32::from_bits);
                slot.augmented.begin(Law::new(k1, k3, c, alpha)?);
                Stage::OldTable
            }
            Stage::OldTable => {
                slot.augmented.begin_table();
                Stage::Damping(0)
            }
            Stage::Damping(from) => {
                let to = from + NUMBERS;
                let next = || reader.f32().ok_or(PackError::Body);
                if slot.damping.read_part(from, to, next)? {
                    Stage::Effects
                } else {
                    Stage::Damping(to)
                }
            }
            Stage::Effects => {
                self.left = reader.u8().ok_or(PackError::Body)?;
                Stage::Effect
            }
            Stage::Effect if self.left == 0 => Stage::Table,
            Stage::Effect => {
                self.effect = reader.u8().ok_or(PackError::Body)?;
                self.count = reader.u8().ok_or(PackError::Body)?;
                Stage::Words(0)
            }
            Stage::Words(from) => {
                let words = self.words.get_mut(..usize::from(self.count));
                let words = words.and_then(|words| words.get_mut(from..));
                for word in words.ok_or(PackError::Body)?.iter_mut().take(WORDS) {
                    *word = reader.f32().ok_or(PackError::Body)?;
                }
                let to = from + WORDS;
                if to < usize::from(self.count) {
                    Stage::Words(to)
                } else {
                    Stage::Put
                }
            }
            Stage::Put => {
                slot.augmented.push(self.effect()?)?;
                Stage::Ranges
            }
            Stage::Ranges => {
                slot.augmented.check_effect(self.effect)?;
                self.left = self.left.saturating_sub(1);
                Stage::Effect
            }
            Stage::Table => match reader.u8() {
                Some(0) => Stage::End,
                Some(1) => {
                    slot.augmented.correct_with(|correction| {
                        correction
                            .unpack_head(&mut reader)
                            .ok_or(PackError::Body)??;
                        Ok::<_, PackError>(correction.check()?)
                    })?;
                    Stage::Cells(0)
                }
                _ => return Err(PackError::Body),
            },
            Stage::Cells(from) => {
                let to = from + CELLS;
                let read = slot.augmented.read_cells(&mut reader, from, to);
                if read.ok_or(PackError::Body)? {
                    Stage::End
                } else {
                    Stage::Cells(to)
                }
            }
            Stage::End => {
                if !reader.rest().is_empty() {
                    return Err(PackError::Body);
                }
                match passivity {
                    Some(passivity) if !expected.allow_active => {
                        passivity.begin(self.range.as_ref(), self.tick_rate());
                        Stage::Passivity
                    }
                    _ => return Ok(Some(self.end(slot))),
                }
            }
            Stage::Passivity => match passivity.and_then(|passivity| passivity.step(slot)) {
                Some(verdict) => {
                    verdict?;
                    return Ok(Some(self.end(slot)));
                }
                None => return Ok(None),
            },
        };
        self.at = pack.len() - reader.rest().len();
        Ok(None)
    }

    /// The law is complete.
    fn end<const N: usize>(&self, slot: &mut FastLaw<N>) -> Option<Stamp> {
        slot.augmented.finish();
        self.stamp
    }

    /// Checks all at once whether the law that was read is passive. Not inlined, so that its stack is free again afterwards, and a
    /// load that allows an active law uses none of it.
    ///
    /// # Errors
    /// The motion in which it is active.
    #[inline(never)]
    pub(super) fn check_passivity<const N: usize>(&self, law: &FastLaw<N>) -> Result<(), Active> {
        Passivity::new(self.range.as_ref(), self.tick_rate()).check(law)
    }

    /// Tick rate for which the effects are made, Hz: 10 kHz if the pack does not state one.
    fn tick_rate(&self) -> f32 {
        self.stamp.map_or(SILENT_RATE, |stamp| stamp.tick_rate)
    }

    /// The effect from the words that were read. Its numbers are not checked yet.
    fn effect(&self) -> Result<Effect<f32>, PackError> {
        let words = self.words.get(..usize::from(self.count));
        let effect = words.and_then(|words| Effect::unpack(self.effect, words));
        effect.ok_or_else(|| {
            if Effect::is_known(self.effect) {
                PackError::Body
            } else {
                PackError::Refused(effects::unknown(self.effect))
            }
        })
    }

    /// Checks that the pack begins correctly and has the length that it states.
    fn header(&mut self, pack: &[u8]) -> Result<(), PackError> {
        let (header, _) = super::header(pack)?;
        self.version = header.version;
        self.expected = header.checksum;
        self.checksum = checksum_with(CHECKSUM, &header.stamp);
        self.at = HEADER;
        self.stage = Stage::Checksum;
        Ok(())
    }

    /// Continues the checksum.
    fn sum(&mut self, pack: &[u8]) -> Result<(), PackError> {
        let to = pack.len().min(self.at + BYTES);
        let part = pack.get(self.at..to).unwrap_or_default();
        self.checksum = checksum_with(self.checksum, part);
        self.at = to;
        if to == pack.len() {
            if !self.checksum != self.expected {
                return Err(PackError::Checksum);
            }
            self.at = HEADER;
            self.stage = Stage::Info;
        }
        Ok(())
    }
}
