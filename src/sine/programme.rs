//! A programme plans its blocks and the ramps between them, and goes over a link in parts.

use super::block::Block;
use super::segment::{Segment, duration};
use super::{FREQUENCY_MIN, TICK_RATE_MAX};
use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer, halves, whole};
use crate::real::in_range;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Planned {
    block: Block,
    pub(super) ramp: Segment,
    pub(super) steady: Segment,
}

/// A [`Programme`] without its blocks: the part of it that goes over a link first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgrammeHead {
    tick_rate: f64,
    ramp_cycles: u32,
    to_rest: Segment,
    duration: f64,
}

/// A block of a [`Programme`] with the ramp before it, as it goes over a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedBlock(Planned);

impl Fields for ProgrammeHead {
    fn write(&self, writer: &mut Writer<'_>) {
        writer.words(halves(self.tick_rate.to_bits()));
        writer.words(halves(self.duration.to_bits()));
        writer.u32(self.ramp_cycles);
        self.to_rest.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            tick_rate: f64::from_bits(whole(reader.words()?)),
            duration: f64::from_bits(whole(reader.words()?)),
            ramp_cycles: reader.u32()?,
            to_rest: Segment::read(reader)?,
        })
    }
}

impl Fields for PlannedBlock {
    fn write(&self, writer: &mut Writer<'_>) {
        let Planned {
            block,
            ramp,
            steady,
        } = &self.0;
        for value in [block.amplitude, block.from, block.to] {
            writer.words(halves(value.to_bits()));
        }
        writer.u32(block.cycles);
        ramp.write(writer);
        steady.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let mut value = || reader.words().map(whole).map(f64::from_bits);
        let (amplitude, from, to) = (value()?, value()?, value()?);
        Some(Self(Planned {
            block: Block {
                amplitude,
                from,
                to,
                cycles: reader.u32()?,
            },
            ramp: Segment::read(reader)?,
            steady: Segment::read(reader)?,
        }))
    }
}

/// Up to `N` blocks with the ramps around them.
///
/// A target without f64 receives one in parts: its [`Programme::head`] and its [`Programme::planned`] blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Programme<const N: usize> {
    tick_rate: f64,
    ramp_cycles: u32,
    pub(super) planned: heapless::Vec<Planned, N>,
    /// The ramp after the last block.
    pub(super) to_rest: Segment,
    duration: f64,
}

#[cfg(feature = "defmt")]
impl<const N: usize> defmt::Format for Programme<N> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(
            f,
            "Programme {{ tick_rate: {=f64}, ramp_cycles: {=u32}, blocks: {=usize} }}",
            self.tick_rate,
            self.ramp_cycles,
            self.planned.len()
        );
        for planned in &self.planned {
            defmt::write!(f, " {}", planned.block);
        }
    }
}

impl<const N: usize> Programme<N> {
    /// A programme without blocks.
    ///
    /// * `tick_rate`: Hz, 1…[`TICK_RATE_MAX`]
    /// * `ramp_cycles`: cycles of each ramp, at least 1. A ramp has the frequency of its block, or changes from the frequency of
    ///   one block to that of the next.
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(tick_rate: f64, ramp_cycles: u32) -> Result<Self, ConfigError> {
        in_range(
            "ramp_cycles",
            f64::from(ramp_cycles),
            1.0,
            f64::from(u32::MAX),
        )?;
        Ok(Self {
            tick_rate: in_range("tick_rate", tick_rate, 1.0, TICK_RATE_MAX)?,
            ramp_cycles,
            ..Self::empty()
        })
    }

    /// A programme that takes no block before [`Programme::begin_planned`]. All bits are 0, so that it takes no flash in a static.
    pub const fn empty() -> Self {
        Self {
            tick_rate: 0.0,
            ramp_cycles: 0,
            planned: heapless::Vec::new(),
            to_rest: Segment::EMPTY,
            duration: 0.0,
        }
    }

    /// Adds one block at the end.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`] if a frequency exceeds a quarter of the tick rate, [`ConfigError::Full`] if the programme has
    /// `N` blocks already.
    pub fn with(mut self, block: Block) -> Result<Self, ConfigError> {
        for (field, frequency) in [("from", block.from), ("to", block.to)] {
            let field = if block.from == block.to {
                "frequency"
            } else {
                field
            };
            in_range(field, frequency, FREQUENCY_MIN, self.tick_rate / 4.0)?;
        }
        let segment = |amplitude, frequency, cycles| {
            Segment::new(amplitude, frequency, cycles, self.tick_rate)
        };
        let (amplitude, frequency) = match self.planned.last() {
            Some(last) => (last.block.amplitude, last.block.to),
            None => (0.0, block.from),
        };
        let planned = Planned {
            block,
            ramp: segment(
                (amplitude, block.amplitude),
                (frequency, block.from),
                self.ramp_cycles,
            ),
            steady: segment(
                (block.amplitude, block.amplitude),
                (block.from, block.to),
                block.cycles,
            ),
        };
        let to_rest = segment(
            (block.amplitude, 0.0),
            (block.to, block.to),
            self.ramp_cycles,
        );
        self.planned.push(planned).map_err(|_| ConfigError::Full {
            field: "blocks",
            capacity: N,
        })?;
        self.to_rest = to_rest;
        self.duration += duration(frequency, block.from, self.ramp_cycles)
            + duration(block.from, block.to, block.cycles);
        Ok(self)
    }

    /// Everything except the blocks.
    pub fn head(&self) -> ProgrammeHead {
        ProgrammeHead {
            tick_rate: self.tick_rate,
            ramp_cycles: self.ramp_cycles,
            to_rest: self.to_rest,
            duration: self.duration,
        }
    }

    /// The blocks with their ramps, in order.
    pub fn planned(&self) -> impl ExactSizeIterator<Item = PlannedBlock> {
        self.planned.iter().copied().map(PlannedBlock)
    }

    /// Replaces this programme with that of `head`, without its blocks.
    pub fn begin_planned(&mut self, head: &ProgrammeHead) {
        self.tick_rate = head.tick_rate;
        self.ramp_cycles = head.ramp_cycles;
        self.to_rest = head.to_rest;
        self.duration = head.duration;
        self.planned.clear();
    }

    /// Adds the next block of the programme to which `head` belongs.
    ///
    /// # Errors
    /// [`ConfigError::Full`] if the programme has `N` blocks already.
    pub fn push_planned(&mut self, block: &PlannedBlock) -> Result<(), ConfigError> {
        self.planned.push(block.0).map_err(|_| ConfigError::Full {
            field: "blocks",
            capacity: N,
        })
    }

    /// Ticks per second.
    pub fn tick_rate(&self) -> f64 {
        self.tick_rate
    }

    /// Cycles of each ramp.
    pub fn ramp_cycles(&self) -> u32 {
        self.ramp_cycles
    }

    /// The blocks, in order.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = &Block> {
        self.planned.iter().map(|planned| &planned.block)
    }

    /// Time from rest to rest, s.
    pub fn duration(&self) -> f64 {
        match self.planned.last() {
            Some(last) => self.duration + duration(last.block.to, last.block.to, self.ramp_cycles),
            None => 0.0,
        }
    }
}
