//! TDMS, of LabVIEW and of National Instruments' loggers.
//!
//! It is read by our own parser. The values of a channel are read where its segments place them, so that only wanted values are
//! unpacked. NI's scales, which convert raw values to measured ones, are applied.

mod scale;
mod segments;

use std::collections::HashMap;
use std::sync::Arc;

use mesh_damper_output::error::InputError;

use super::arrays::{Array, arranged};
use super::beside::Beside;
use super::guard::damaged;
use super::opened::Opened;
use super::{Column, Format, Reading, Source, Table, Tables};
use crate::files::table::Clock;
use scale::Scales;
use segments::{File, Object, Pieces, Property, Read, seconds};

const NAME: &str = "TDMS";

/// The error in a file, in words.
#[derive(Debug)]
struct Broken(&'static str);

/// Technical Data Management Streaming.
pub(super) struct Tdms;

impl Format for Tdms {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["tdms"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        head.starts_with(b"TDSm")
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        _: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, limit) = (source.name(), source.limit());
        let bytes = Arc::new(source.bytes()?);
        let file = File::of(&bytes).map_err(|why| damaged(NAME, &name, why.0))?;
        let mut channels = Channels::of(&file);
        let values = move |values: &Scaled| {
            // The file does not limit the number of values that take no bytes.
            if (values.rows as u64).saturating_mul(8) > limit.file() {
                return None;
            }
            Some(values.of(&bytes))
        };
        let too_large = || limit.exceeded(&name);
        let (mut tables, scaled) = arranged(channels.arrays, &Beside::default(), &mut |each| {
            values(each).ok_or_else(too_large)
        })?;
        for (table, scaled) in tables.iter_mut().zip(&scaled) {
            if let Some(clock) = table.clock
                && !(table.columns.iter()).any(crate::columns::may_be_time)
            {
                table.guesses.push(format!(
                    "there is no time column; the times are computed from wf_increment = {} s",
                    clock.step
                ));
            }
            let time = table.columns.iter_mut().zip(scaled);
            let is_time = |(each, _): &(&mut Column, &Scaled)| crate::columns::is_time(each);
            if let Some((column, scaled)) = time.into_iter().find(is_time) {
                column.first = values(scaled).ok_or_else(too_large)?;
                column.first.truncate(Column::FIRST);
            }
        }
        if tables.is_empty() {
            tables.push(Table::default());
        }
        tables[0].skipped.extend(channels.skipped);
        if file.is_cut {
            let note = "its end was cut; the samples that it has in whole are read";
            channels.guesses.push(note.into());
        }
        Table::note_in_all(&mut tables, &channels.guesses);
        let owned = name.clone();
        let read = move |table: usize, column: usize| match values(&scaled[table][column]) {
            Some(values) => Ok(Some(values)),
            None => Err(limit.exceeded(&owned)),
        };
        Ok(Box::new(Opened::new(
            name,
            tables,
            channels.comments,
            read,
        )?))
    }
}

/// Raw values of a channel, and their conversion to measured ones.
#[derive(Clone, Debug)]
struct Scaled {
    rows: usize,
    /// By the number of the scale that takes them; DAQmx has several per channel.
    raw: Vec<(u32, Pieces)>,
    scales: Option<Arc<Scales>>,
}

impl Scaled {
    fn of(&self, bytes: &[u8]) -> Vec<f64> {
        let raw: Vec<(u32, Vec<f64>)> = (self.raw.iter())
            .map(|(scale, pieces)| (*scale, pieces.values(bytes)))
            .collect();
        match &self.scales {
            Some(scales) => scales.apply(&raw),
            None => raw
                .into_iter()
                .next()
                .map(|(_, values)| values)
                .unwrap_or_default(),
        }
    }
}

/// The channels that are numbers, and other contents of the file.
#[derive(Default)]
struct Channels {
    arrays: Vec<Array<Scaled>>,
    skipped: Vec<String>,
    guesses: Vec<String>,
    comments: Vec<String>,
}

impl Channels {
    fn of(file: &File) -> Self {
        let mut channels = Self::default();
        let none = HashMap::new();
        let objects = file.objects.iter();
        let above: HashMap<&[String], _> = (objects.filter(|object| object.path.len() < 2))
            .map(|object| (&object.path[..], &object.properties))
            .collect();
        let starts = Starts::of(file);
        for object in &file.objects {
            let path = &object.path[..];
            let [group, name] = path else {
                for (key, value) in &object.properties {
                    if let Property::Text(text) = value {
                        let key = path
                            .iter()
                            .chain([key])
                            .cloned()
                            .collect::<Vec<_>>()
                            .join("/");
                        channels.comments.push(format!("{key}: {text}"));
                    }
                }
                continue;
            };
            let above = |path: &[String]| above.get(path).copied().unwrap_or(&none);
            let label = format!("{group}/{name}");
            if object.raw.is_empty() {
                channels.skipped.push(match object.unread {
                    Some(what) => format!("{label} ({what})"),
                    None => format!("{label} (no samples)"),
                });
                continue;
            }
            let said = [&object.properties, above(&path[..1]), above(&[])];
            let scales = match Scales::of(&said, &object.raw) {
                Ok(scales) => scales.map(Arc::new),
                Err(what) => {
                    channels.skipped.push(format!("{label} ({what})"));
                    continue;
                }
            };
            let is_date = object
                .raw
                .iter()
                .any(|(_, pieces)| pieces.read == Some(Read::Date));
            if is_date {
                channels.guesses.push(format!(
                    "the dates of {label} are taken as seconds after the first of them"
                ));
            }
            let text = |keys: &[&str]| {
                let mut found = keys.iter().filter_map(|key| object.properties.get(*key));
                found.find_map(|value| match value {
                    Property::Text(text) if !text.trim().is_empty() => Some(text.trim().to_owned()),
                    _ => None,
                })
            };
            let unit = text(&[
                "unit_string",
                "NI_UnitDescription",
                "Unit",
                "unit",
                "Units",
                "units",
            ]);
            let rows = object.raw[0].1.count();
            let clock = starts.clock(object);
            if clock.is_some() && object.is_restarted {
                channels.guesses.push(format!(
                    "the clock of {label} restarted within the file (wf_start_time); its samples are read as one continuous stretch"
                ));
            }
            channels.arrays.push(Array {
                group: vec![group.clone()],
                column: Column {
                    name: name.trim().to_owned(),
                    unit: if is_date { Some("s".into()) } else { unit },
                    is_numeric: true,
                    is_stamp: is_date,
                    ..Column::default()
                },
                rows: rows as u64,
                clock,
                source: Scaled {
                    rows,
                    raw: object.raw.clone(),
                    scales,
                },
            });
        }
        channels.guesses.extend(starts.said);
        channels
    }
}

/// Start times of the clocks of a file's channels.
struct Starts {
    /// The earliest stated, in 2⁻⁶⁴ s.
    first: Option<i128>,
    /// Whether all stated ones are the same.
    is_one: bool,
    said: Option<String>,
}

impl Starts {
    fn of(file: &File) -> Self {
        let clocked = || {
            (file.objects.iter()).filter(|object| step(object).is_some() && !object.raw.is_empty())
        };
        let first = clocked().filter_map(|object| object.start).min();
        let is_one = clocked().all(|object| object.start.is_none() || object.start == first);
        let mut silent = clocked().filter(|object| object.start.is_none());
        let said = match (first, silent.next()) {
            (Some(_), Some(object)) if is_one => Some(format!(
                "{} gives no start time (wf_start_time); it is assumed to start with the others",
                object.path.join("/")
            )),
            _ => None,
        };
        Self {
            first,
            is_one,
            said,
        }
    }

    /// The clock of a channel; `None` if its step is not stated, or if it states no start and the others' starts differ.
    fn clock(&self, object: &Object) -> Option<Clock> {
        let late = match (object.start, self.first) {
            (Some(start), Some(first)) => seconds(start.wrapping_sub(first)),
            _ if self.is_one => 0.0,
            _ => return None,
        };
        let offset = number(object, "wf_start_offset").unwrap_or(0.0);
        Some(Clock {
            start: late + offset,
            step: step(object)?,
        })
    }
}

fn step(object: &Object) -> Option<f64> {
    number(object, "wf_increment").filter(|step| *step > 0.0)
}

fn number(object: &Object, key: &str) -> Option<f64> {
    match object.properties.get(key) {
        Some(Property::Number(number)) if number.is_finite() => Some(*number),
        _ => None,
    }
}
