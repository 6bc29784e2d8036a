//! MDF 4, as loggers and asammdf write it.
//!
//! The library parses single blocks. It does not follow links, because it would read what many blocks share once for each of them.

mod blocks;
mod channels;
mod conversion;
mod elements;
mod field;
mod records;

use std::collections::HashMap;
use std::rc::Rc;

use falcon_mdf::blocks::IdBlock;
use falcon_mdf::{Mf4Error, Mf4Version};
use mesh_damper_output::error::InputError;

use super::arrays::{Array, Located, MOST_OF_ARRAY, arranged, name_of, say_skipped};
use super::beside::Beside;
use super::groups::{Group as Inside, Groups};
use super::guard::guarded;
use super::opened::Opened;
use super::refused::Refused;
use super::{Column, Format, Reading, Source, Table, Tables};
use crate::budget::{Budget, of_list, of_text};
use blocks::Blocks;
use channels::{Channel, Channels, Group};
use records::{Kept, Stream};

const NAME: &str = "MDF4";

/// Measurement Data Format of ASAM, version 4.
pub(super) struct Mdf;

impl Format for Mdf {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["mf4"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        let is_mdf = head.starts_with(b"MDF     ") || head.starts_with(b"UnFinMF ");
        is_mdf && head.get(8) == Some(&b'4')
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        _: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, budget) = (source.name(), source.budget());
        let bytes = source.bytes()?;
        guarded(NAME, &name, || {
            let opened = open(&name, bytes, budget);
            opened.map_err(|why| why.error(NAME, &name))
        })
    }
}

/// Position of a column's values: the group, the channel, and the element of its array.
#[derive(Clone, Copy, Debug)]
struct Place {
    group: usize,
    channel: usize,
    element: u64,
}

impl Located for Place {
    fn key(&self) -> [usize; 4] {
        [self.group, self.channel, self.element as usize, 0]
    }
}

/// A file whose blocks were read.
struct Mdf4 {
    blocks: Blocks,
    channels: Channels,
    kept: Kept,
}

fn open<'a>(
    name: &str,
    bytes: Vec<u8>,
    budget: Rc<Budget>,
) -> Result<Box<dyn Tables + 'a>, Refused> {
    let identity = IdBlock::parse(&bytes)?;
    Mf4Version::from_id_block(&identity).validate()?;
    let blocks = Blocks::new(bytes, budget);
    let header = blocks.header()?;
    let kept = Kept::new();
    let is_unfinished = identity.is_unfinished();
    let channels = Channels::of(&blocks, &kept, header.dg_first, is_unfinished)?;
    let comments = comments(&blocks, header.md_comment)?;
    let mdf = Mdf4 {
        blocks,
        channels,
        kept,
    };
    let budget = Rc::clone(&mdf.blocks.budget);
    let mut groups = Groups::new(Rc::clone(&budget));
    let (arrays, skipped) = mdf.arrays(&mut groups)?;
    let mut values = |place: &Place| mdf.values(*place).map_err(|why| why.error(NAME, name));
    let (mut tables, places) = arranged(&groups, arrays, Beside::default(), &mut values)?;
    say_skipped(&mut tables, skipped);
    if is_unfinished {
        let note = "the file was never finalized; what had been written to it is read";
        Table::note_in_all(&mut tables, &[note.to_owned()], &budget)?;
    }
    let read = move |table: usize, column: usize| mdf.values(places[table][column]).map(Some);
    Ok(Box::new(Opened::new(
        NAME,
        budget,
        name.to_owned(),
        tables,
        comments,
        read,
    )?))
}

impl Mdf4 {
    /// The channels that are numbers, and other contents of the file.
    fn arrays(&self, groups: &mut Groups) -> Result<(Vec<Array<Place>>, Vec<String>), Refused> {
        const PART: &str = "the names of its columns";
        let budget = &self.blocks.budget;
        let mut arrays = Vec::new();
        let mut skipped = Vec::new();
        let mut names = HashMap::new();
        let mut skip = |said: String| {
            budget.hold(of_text(said.len()), PART)?;
            skipped.push(said);
            Ok::<_, Refused>(())
        };
        for (index, group) in self.channels.groups.iter().enumerate() {
            budget.hold(2 * group.name.len() as u64 + 64, PART)?;
            let label = label(group, &mut names);
            if group.is_other {
                skip(format!("the bus frames or texts of group {label}"))?;
                continue;
            }
            if group.samples == 0 {
                skip(format!("group {label}, which has no samples"))?;
                continue;
            }
            let inside = groups.inside(Inside::FILE, &label)?;
            for (channel, each) in group.channels.iter().enumerate() {
                if let Some(why) = each.unread {
                    skip(format!("channel {} ({why})", each.name))?;
                    continue;
                }
                let elements = each
                    .elements
                    .as_ref()
                    .map_or(1, |elements| elements.count());
                if elements > MOST_OF_ARRAY {
                    skip(format!("channel {} (arrays of {elements})", each.name))?;
                    continue;
                }
                for element in 0..elements {
                    let array = Array {
                        group: inside,
                        column: column(each, element, elements),
                        rows: group.samples,
                        clock: None,
                        source: Place {
                            group: index,
                            channel,
                            element,
                        },
                    };
                    array.add_to(&mut arrays, budget)?;
                }
            }
        }
        Ok((arrays, skipped))
    }

    /// The records of a group: their bytes, and the first byte and the length of each.
    fn records(&self, group: &Group) -> Result<Records, Refused> {
        let data = &self.channels.data[group.data];
        let stream = self
            .kept
            .stream(&self.blocks, group.data, &data.list, group.layout)?;
        let size = group.layout.values + group.layout.invalid;
        let Some(places) = &data.places else {
            return Ok(Records {
                stream,
                first: data.width,
                step: data.width + size,
            });
        };
        let key = (group.data, group.place);
        Ok(Records {
            stream: (self.kept).gathered(&self.blocks, key, &stream, &places[group.place], size)?,
            first: 0,
            step: size,
        })
    }

    /// The values of a column. They are charged as held.
    fn values(&self, place: Place) -> Result<Vec<f64>, Refused> {
        const PART: &str = "the values of its columns";
        let group = &self.channels.groups[place.group];
        let channel = &group.channels[place.channel];
        let (of, field, count_of) = match &channel.elements {
            None => (group, channel.field, None),
            Some(elements) if elements.groups.is_empty() => {
                (group, elements.field(place.element), elements.count_of)
            }
            // An element in each of several groups.
            Some(elements) => {
                let at = elements
                    .group(place.element)
                    .and_then(|at| self.channels.at.get(&at));
                let of = at.and_then(|&at| self.channels.groups.get(at));
                let of = of.ok_or("a group of an array is missing")?;
                (of, elements.field, None)
            }
        };
        let rows = usize::try_from(of.samples).unwrap_or(usize::MAX);
        let budget = &self.blocks.budget;
        budget.hold(of_list::<f64>(rows), PART)?;
        let texts = channel
            .conversion
            .is_of_texts()
            .then_some(field.width() as u64);
        let cost = 1 + channel.conversion.cost() + texts.unwrap_or_default();
        budget.work(cost.saturating_mul(of.samples), PART)?;
        let convert = |values: &mut [f64]| {
            channel.conversion.convert(values, channel.field.is_float());
        };
        let mut values: Vec<f64> = Vec::with_capacity(rows);
        if channel.is_virtual {
            values.extend((0..rows).map(|row| row as f64));
            convert(&mut values);
            return Ok(values);
        }
        let records = self.records(of)?;
        let bytes = records.stream.bytes(&self.blocks);
        let end = rows
            .checked_sub(1)
            .map(|last| records.start(last) + field.at + field.width());
        if end.is_some_and(|end| end > bytes.len()) {
            let (at, needed) = (records.first as u64, end.unwrap_or_default());
            return Err(Mf4Error::truncated(at, needed, bytes.len()).into());
        }
        let starts = (0..rows).map(|row| records.start(row));
        if texts.is_some() {
            let texts = starts.map(|start| field.text(bytes, start));
            values.extend(texts.map(|text| channel.conversion.of_text(&text)));
        } else {
            field.read_each(bytes, starts, |raw| values.push(raw));
            convert(&mut values);
        }
        if let Some(count_of) = count_of {
            for (row, value) in values.iter_mut().enumerate() {
                if place.element as f64 >= count_of.read(bytes, records.start(row)) {
                    *value = f64::NAN;
                }
            }
        }
        self.mark_invalid(group, channel, &mut values)?;
        Ok(values)
    }

    /// Makes values missing that the file says are invalid.
    fn mark_invalid(
        &self,
        group: &Group,
        channel: &Channel,
        values: &mut [f64],
    ) -> Result<(), Refused> {
        if channel.is_invalid {
            values.fill(f64::NAN);
        }
        let Some(bit) = channel.invalid else {
            return Ok(());
        };
        let byte = bit as usize / 8;
        if byte >= group.layout.invalid {
            return Ok(());
        }
        let records = self.records(group)?;
        let bytes = records.stream.bytes(&self.blocks);
        for (row, value) in values.iter_mut().enumerate() {
            let at = records.start(row) + group.layout.values + byte;
            if bytes.get(at).is_none_or(|byte| byte >> (bit % 8) & 1 == 1) {
                *value = f64::NAN;
            }
        }
        Ok(())
    }
}

/// The records of a group.
struct Records {
    stream: Stream,
    first: usize,
    step: usize,
}

impl Records {
    /// The first byte of a record, after the number before it.
    fn start(&self, row: usize) -> usize {
        (row.saturating_mul(self.step)).saturating_add(self.first)
    }
}

fn column(channel: &Channel, element: u64, elements: u64) -> Column {
    let unit = channel.unit.trim();
    // Times are in seconds by the standard, and programs omit the unit.
    let unit = if unit.is_empty() && channel.is_time {
        "s"
    } else {
        unit
    };
    Column {
        name: name_of(channel.name.trim(), element, elements),
        unit: (!unit.is_empty()).then(|| unit.to_owned()),
        is_numeric: true,
        is_time: channel.is_time,
        ..Column::default()
    }
}

/// The group's name, or its index among those without a name or with the same name.
fn label(group: &Group, names: &mut HashMap<String, usize>) -> String {
    let name = group.name.trim();
    let name = if name.is_empty() { "group" } else { name };
    let times = names.entry(name.to_owned()).or_insert(0);
    *times += 1;
    match (*times, name) {
        (1, name) if name != "group" => name.to_owned(),
        (times, name) => format!("{name} {times}"),
    }
}

/// The file's comment as lines, those of its properties as `key: text`.
fn comments(blocks: &Blocks, link: u64) -> Result<Vec<String>, Refused> {
    if link == 0 || &blocks.head(link)?.block_type != b"##MD" {
        return Ok(Vec::new());
    }
    let metadata = blocks.metadata(link)?;
    let text = metadata.text().lines().map(|line| line.trim().to_owned());
    let said = metadata
        .properties()
        .map(|(key, value)| format!("{key}: {value}"));
    let lines: Vec<String> = text.chain(said).filter(|line| !line.is_empty()).collect();
    let size: usize = lines
        .iter()
        .map(|line| line.len() + size_of::<String>())
        .sum();
    blocks.budget.hold(size as u64, "its comments")?;
    Ok(lines)
}
