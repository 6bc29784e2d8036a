//! The check of a pack, and the law that it writes, in slices, so that a tick that does one slice in addition to its own work stays
//! in time.

use super::info;
use super::{Expectation, HEADER, OLDEST, PackError, Stamp};
use crate::effects::{self, Effect, MOST_WORDS};
use crate::fast_law::FastLaw;
use crate::frame::{CHECKSUM, Reader, checksum_with};
use crate::law::Law;
use crate::passivity;

/// Size of a slice: bytes of the checksum, words of an effect and cells of the table.
const BYTES: usize = 24;
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
    /// Reads this part of the seed, and compares it with the law.
    Damping(usize),
    Effects,
    /// Begins the next effect, if there is one.
    Effect,
    /// Reads its words, from this index on.
    Words(usize),
    /// Puts it into the law.
    Put,
    /// Checks its numbers.
    Numbers,
    Table,
    /// Reads the cells, from this index on.
    Cells(usize),
    End,
    /// The law is complete. Checks that this part of it is passive.
    Passivity(usize),
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
    /// Number of effects still to come, and the known part of the next one.
    left: u8,
    effect: u8,
    count: u8,
    words: [f32; MOST_WORDS],
    /// Of the check that the law is passive.
    bounds: [f32; 2],
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
        left: 0,
        effect: 0,
        count: 0,
        words: [0.0; MOST_WORDS],
        bounds: [0.0; 2],
    };

    /// Does one slice. Returns the stamp once the whole pack has been checked and its law written over `slot`, which holds no law
    /// until then.
    #[inline(never)]
    pub(super) fn step<const N: usize>(
        &mut self,
        pack: &[u8],
        slot: &mut FastLaw<N>,
        expected: &Expectation,
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
                    found.check()?;
                    self.stamp = Some(found);
                    expected.check(self.stamp.as_ref())?;
                    info::numbers(&mut Reader(description))?;
                } else {
                    expected.check(None)?;
                }
                Stage::Law
            }
            Stage::Law => {
                let eq13 = reader.words().ok_or(PackError::Body)?;
                let [k1, k3, c, alpha] = eq13.map(f32::from_bits);
                let law = Law::new(k1, k3, c, alpha)?;
                slot.augmented.begin(law);
                slot.damping.begin(&law);
                Stage::OldTable
            }
            Stage::OldTable => {
                slot.augmented.begin_table();
                Stage::Damping(0)
            }
            Stage::Damping(part) => {
                let next = || reader.f32().ok_or(PackError::Body);
                if slot.damping.read_part(part, next)? {
                    Stage::Effects
                } else {
                    Stage::Damping(part + 1)
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
                Stage::Numbers
            }
            Stage::Numbers => {
                slot.augmented.check_effect(self.effect, self.tick())?;
                self.left = self.left.saturating_sub(1);
                Stage::Effect
            }
            Stage::Table => match reader.u8() {
                Some(0) => Stage::End,
                Some(1) => {
                    let tick = self.tick();
                    slot.augmented.correct_with(|correction| {
                        correction
                            .unpack_head(&mut reader)
                            .ok_or(PackError::Body)??;
                        correction.check()?;
                        if let Some(tick) = tick {
                            correction.check_tick(tick)?;
                        }
                        Ok::<_, PackError>(())
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
                if expected.allow_active {
                    return Ok(Some(self.end(slot)));
                }
                Stage::Passivity(0)
            }
            Stage::Passivity(part) => {
                if passivity::check_part(&slot.augmented, part, &mut self.bounds)? {
                    return Ok(Some(self.end(slot)));
                }
                Stage::Passivity(part + 1)
            }
        };
        self.at = pack.len() - reader.rest().len();
        Ok(None)
    }

    /// The law is complete.
    fn end<const N: usize>(&self, slot: &mut FastLaw<N>) -> Option<Stamp> {
        slot.augmented.finish();
        self.stamp
    }

    /// The tick for which the effects are made, s, if the pack states it.
    fn tick(&self) -> Option<f32> {
        self.stamp.map(|stamp| 1.0 / stamp.tick_rate)
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
