//! MDF 4, as loggers and asammdf write it.

use std::collections::HashMap;

use falcon_mdf::{Channel, ChannelGroup, Mf4Error, Mf4File, OpenOptions, SignalValues, ValueKind};
use mesh_damper_output::error::InputError;

use super::arrays::{Array, MOST_COLUMNS, MOST_OF_ARRAY, arranged, name_of};
use super::beside::Beside;
use super::guard::{damaged, guarded};
use super::opened::Opened;
use super::{Column, Format, Reading, Source, Table, Tables};
use crate::read_limit::ReadLimit;

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
        let (name, limit) = (source.name(), source.limit());
        let bytes = source.bytes()?;
        guarded(NAME, &name, || open(&name, bytes, limit))
    }
}

/// Position of a column's values: the data group, the channel group, the channel, and the element of its array.
#[derive(Clone, Copy, Debug)]
struct Place {
    group: (usize, usize),
    channel: usize,
    element: usize,
}

struct Mdf4 {
    name: String,
    file: Mf4File,
    limit: ReadLimit,
}

fn open<'a>(
    name: &str,
    bytes: Vec<u8>,
    limit: ReadLimit,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    if has_endless_formula(&bytes) {
        let why = format!("a formula has more than {MOST_OF_FORMULA} operations");
        return Err(damaged(NAME, name, why));
    }
    let options = OpenOptions {
        build_channels_db: false,
        parallel_parsing: false,
        max_alloc: usize::try_from(limit.file()).unwrap_or(usize::MAX),
        max_decompressed: limit.file(),
        ..OpenOptions::default()
    };
    let file =
        Mf4File::from_bytes_with_options(bytes, options).map_err(|error| refused(name, &error))?;
    let mdf = Mdf4 {
        name: name.to_owned(),
        file,
        limit,
    };
    let (arrays, skipped) = mdf.arrays()?;
    let (mut tables, places) =
        arranged(arrays, &Beside::default(), &mut |&place| mdf.values(place))?;
    // The rate of a table follows from its first times.
    for (table, places) in tables.iter_mut().zip(&places) {
        let time = table
            .columns
            .iter_mut()
            .zip(places)
            .find(|(each, _)| each.is_time);
        if let Some((column, &place)) = time {
            let mut times = mdf.values(place)?;
            times.truncate(Column::FIRST);
            column.first = times;
        }
    }
    if let Some(table) = tables.first_mut() {
        table.skipped.extend(skipped);
    }
    if mdf.file.unfinalized().is_some() {
        let note = "the file was never finalized; what had been written to it is read";
        Table::note_in_all(&mut tables, &[note.to_owned()]);
    }
    let comments = comments(&mdf.file);
    let read = move |table: usize, column: usize| {
        let name = mdf.name.clone();
        guarded(NAME, &name, || mdf.values(places[table][column]).map(Some))
    };
    Ok(Box::new(Opened::new(
        name.to_owned(),
        tables,
        comments,
        read,
    )?))
}

impl Mdf4 {
    /// The channels that are numbers, and other contents of the file.
    fn arrays(&self) -> Result<(Vec<Array<Place>>, Vec<String>), InputError> {
        let mut arrays = Vec::new();
        let mut skipped = Vec::new();
        let mut names = HashMap::new();
        for (data, group) in self.file.data_groups().iter().enumerate() {
            for (place, group) in group.channel_groups.iter().enumerate() {
                let label = label(group, &mut names);
                if group.is_vlsd() || group.is_plain_bus_event() {
                    skipped.push(format!("the bus frames or texts of group {label}"));
                    continue;
                }
                if group.sample_count == 0 {
                    skipped.push(format!("group {label}, which has no samples"));
                    continue;
                }
                for (channel, each) in group.channels.iter().enumerate() {
                    if let Some(why) = unread(each) {
                        skipped.push(format!("channel {} ({why})", each.name));
                        continue;
                    }
                    let elements = each.array_shape().map_or(1, |shape| {
                        shape
                            .iter()
                            .fold(1_u64, |all, &size| all.saturating_mul(size))
                    });
                    if elements > MOST_OF_ARRAY {
                        skipped.push(format!("channel {} (arrays of {elements})", each.name));
                        continue;
                    }
                    for element in 0..elements {
                        arrays.push(Array {
                            group: vec![label.clone()],
                            column: column(each, element, elements),
                            rows: group.sample_count,
                            clock: None,
                            source: Place {
                                group: (data, place),
                                channel,
                                element: element as usize,
                            },
                        });
                    }
                    if arrays.len() > MOST_COLUMNS {
                        return Err(damaged(
                            NAME,
                            &self.name,
                            format!("more than {MOST_COLUMNS} channels"),
                        ));
                    }
                }
            }
        }
        Ok((arrays, skipped))
    }

    fn values(&self, place: Place) -> Result<Vec<f64>, InputError> {
        let refused = |error| refused(&self.name, &error);
        let data = &self.file.data_groups()[place.group.0];
        let group = &data.channel_groups[place.group.1];
        let channel = &group.channels[place.channel];
        // Compressed data states its size, and a channel without its own data may state any number.
        let elements = channel.array_shape().map_or(1, |shape| {
            shape
                .iter()
                .fold(1_u64, |all, &size| all.saturating_mul(size))
        });
        let bytes = (group.sample_count.saturating_mul(elements)).saturating_mul(8);
        if bytes.max(data.block_index().total_size()) > self.limit.file() {
            return Err(self.limit.exceeded(&self.name));
        }
        let signal = self.file.signal(channel).map_err(refused)?;
        let mut values = match signal.values().map_err(refused)? {
            SignalValues::F64(values) => values,
            SignalValues::Array {
                values,
                elements_per_sample,
            } => (values.chunks_exact(elements_per_sample.max(1)))
                .map(|sample| sample.get(place.element).copied().unwrap_or(f64::NAN))
                .collect(),
            SignalValues::ArrayVarLen { values, starts } => (starts.windows(2))
                .map(|pair| {
                    let sample = values.get(pair[0]..pair[1]).unwrap_or_default();
                    sample.get(place.element).copied().unwrap_or(f64::NAN)
                })
                .collect(),
            other => other.to_f64(),
        };
        if let Some(validity) = signal.validity() {
            for (value, is_valid) in values.iter_mut().zip(validity) {
                if !is_valid {
                    *value = f64::NAN;
                }
            }
        }
        Ok(values)
    }
}

/// The most operations and brackets of a formula. Convention: ten times as many as a sensor's conversion has.
const MOST_OF_FORMULA: usize = 500;

/// Whether a text of the file is a formula that its decoder would follow by nested calls, beyond any stack.
fn has_endless_formula(bytes: &[u8]) -> bool {
    // Blocks begin at multiples of eight.
    bytes.chunks_exact(8).enumerate().any(|(index, head)| {
        if !head.starts_with(b"##TX") {
            return false;
        }
        let text = &bytes[8 * index..];
        let length = text.get(8..16).and_then(|word| word.try_into().ok());
        let length = usize::try_from(u64::from_le_bytes(length.unwrap_or_default()));
        let end = length.unwrap_or(usize::MAX).min(text.len());
        let text = text.get(24..end).unwrap_or_default();
        let signs = text.iter().filter(|byte| b"+-*/^(".contains(byte)).count();
        // Any other character means that it is not a formula.
        let is_of_formula = |byte: &u8| {
            let is_plain = byte.is_ascii_alphanumeric() || byte.is_ascii_whitespace();
            is_plain || !byte.is_ascii() || b"\0_.,+-*/^()".contains(byte)
        };
        signs > MOST_OF_FORMULA && text.iter().all(is_of_formula)
    })
}

/// Why a channel is not read, if it is not.
fn unread(channel: &Channel) -> Option<&'static str> {
    if let Some(reason) = channel.unreadable() {
        return Some(reason.detail());
    }
    match channel.value_kind() {
        ValueKind::Str => Some("texts"),
        ValueKind::Bytes => Some("bytes"),
        ValueKind::Complex => Some("complex numbers"),
        ValueKind::CanopenDate | ValueKind::CanopenTime => Some("dates"),
        _ => None,
    }
}

fn column(channel: &Channel, element: u64, elements: u64) -> Column {
    let unit = channel.unit.trim();
    let is_time = channel.is_time_channel();
    // Times are in seconds by the standard, and programs omit the unit.
    let unit = if unit.is_empty() && is_time {
        "s"
    } else {
        unit
    };
    Column {
        name: name_of(channel.name.trim(), element, elements),
        unit: (!unit.is_empty()).then(|| unit.to_owned()),
        is_numeric: true,
        is_time,
        ..Column::default()
    }
}

/// The group's name, or its index among those without a name or with the same name.
fn label(group: &ChannelGroup, names: &mut HashMap<String, usize>) -> String {
    let name = group.acquisition_name.trim();
    let name = if name.is_empty() { "group" } else { name };
    let times = names.entry(name.to_owned()).or_insert(0);
    *times += 1;
    match (*times, name) {
        (1, name) if name != "group" => name.to_owned(),
        (times, name) => format!("{name} {times}"),
    }
}

/// The file's header as lines `key: text`.
fn comments(file: &Mf4File) -> Vec<String> {
    let metadata = file.metadata();
    let text = metadata.text().lines().map(|line| line.trim().to_owned());
    let said = metadata
        .properties()
        .map(|(key, value)| format!("{key}: {value}"));
    text.chain(said).filter(|line| !line.is_empty()).collect()
}

fn refused(name: &str, error: &Mf4Error) -> InputError {
    match error {
        Mf4Error::Unsupported { .. } => InputError::new(
            name,
            format!("uses a part of MDF4 that hil does not read: {error}"),
            "write it again with asammdf: mdf.convert('4.10').save(NAME)",
        ),
        error => damaged(NAME, name, error),
    }
}
