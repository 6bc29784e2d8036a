//! TDMS, of LabVIEW and of National Instruments' loggers.
//!
//! It is read by our own parser. The values of a channel are read where its segments place them, so that only wanted values are
//! unpacked. NI's scales, which convert raw values to measured ones, are applied.

mod circuits;
mod cursor;
mod layout;
mod scale;
mod segments;

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use mesh_damper_output::error::InputError;

use super::arrays::{Array, Located, arranged, say_skipped};
use super::beside::Beside;
use super::groups::{Group, Groups};
use super::opened::Opened;
use super::refused::Refused;
use super::{Column, Format, Reading, Source, Table, Tables};
use crate::budget::{Budget, of_list, of_text};
use crate::files::table::Clock;
use crate::room::Room;
use cursor::Property;
use layout::{Read, raw, seconds};
use scale::{Raw, Scales};
use segments::{File, Object};

const NAME: &str = "TDMS";
const PART: &str = "the names of its columns";
/// The name of a column of times that follow from a step that changes.
const TIMES: &str = "times by wf_increment";
/// The most channels about which the same is noted. Convention: a few lines.
const NAMED: usize = 3;

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
        let (name, budget) = (source.name(), source.budget());
        let bytes = source.bytes()?;
        let said = |why: Refused| why.error(NAME, &name);
        let file = File::of(&bytes, &budget).map_err(said)?;
        let mut groups = Groups::new(Rc::clone(&budget));
        let mut channels = Channels::of(&file, &mut groups).map_err(said)?;
        let is_cut = file.is_cut;
        let content = Content {
            file,
            bytes,
            budget: Rc::clone(&budget),
        };
        let mut values = |scaled: &Scaled| content.values(scaled);
        let (mut tables, scaled) =
            arranged(&groups, channels.arrays, Beside::default(), &mut values)?;
        for table in &mut tables {
            budget.work(128 * table.columns.len() as u64, PART)?;
            if let Some(clock) = table.clock
                && !(table.columns.iter()).any(crate::columns::may_be_time)
            {
                budget.hold(of_text(128), PART)?;
                table.guesses.push(format!(
                    "there is no time column; the times are computed from wf_increment = {} s",
                    clock.step
                ));
            }
        }
        say_skipped(&mut tables, channels.skipped);
        if is_cut {
            let note = "its end was cut; the samples that it has in whole are read";
            channels.guesses.push(note.into());
        }
        Table::note_in_all(&mut tables, &channels.guesses, &budget)?;
        let read = move |table: usize, column: usize| {
            let values = content.values(&scaled[table][column]);
            Ok(Some(values?))
        };
        Ok(Box::new(Opened::new(
            NAME,
            budget,
            name,
            tables,
            channels.comments,
            read,
        )?))
    }
}

/// A file and what was found in it.
struct Content {
    file: File,
    bytes: Vec<u8>,
    budget: Rc<Budget>,
}

impl Content {
    /// The measured values of a channel. They are charged as held.
    fn values(&self, scaled: &Scaled) -> Result<Vec<f64>, InputError> {
        const PART: &str = "the values of its columns";
        let object = &self.file.objects[scaled.object];
        if scaled.are_times {
            self.budget.hold(of_list::<f64>(object.rows), PART)?;
            self.budget.work(object.rows as u64, PART)?;
            return Ok(object.times());
        }
        let first = object.first.unwrap_or_default();
        let reads = Raw {
            reads: &object.reads,
            first,
        };
        let (numbers, cost) = match &scaled.scales {
            Some(scales) => (scales.raw(reads), scales.cost()),
            None => (vec![first], 0),
        };
        let (rows, several) = (object.rows as u64, numbers.len() as u64);
        let segments = self
            .file
            .runs
            .iter()
            .map(|run| 1 + run.segments.len() as u64);
        let looks = several * segments.sum::<u64>();
        let each = of_list::<f64>(object.rows);
        let steps = rows.saturating_mul(several + cost);
        self.budget.hold(each.saturating_mul(several), PART)?;
        self.budget.work(steps.saturating_add(looks), PART)?;
        let values = |number: u32| {
            let rows = object.rows;
            raw(&self.file.runs, scaled.object, number, rows, &self.bytes)
        };
        let found: Vec<(u32, Vec<f64>)> = (numbers.into_iter())
            .map(|number| (number, values(number)))
            .collect();
        self.budget.release(each * several.saturating_sub(1));
        Ok(match &scaled.scales {
            Some(scales) => scales.apply(reads, found),
            None => found
                .into_iter()
                .next()
                .map(|(_, values)| values)
                .unwrap_or_default(),
        })
    }
}

/// A channel, and the conversion of its raw values to measured ones.
#[derive(Clone, Debug)]
struct Scaled {
    object: usize,
    scales: Option<Rc<Scales>>,
    /// Whether it is the times of the channel, whose step changes.
    are_times: bool,
}

impl Located for Scaled {
    fn key(&self) -> [usize; 4] {
        [self.object, self.are_times.into(), 0, 0]
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
    fn of(file: &File, groups: &mut Groups) -> Result<Self, Refused> {
        let budget = &Rc::clone(groups.budget());
        let mut channels = Self::default();
        let objects = || file.objects.iter().enumerate();
        let above: HashMap<&[Rc<str>], usize> = objects()
            .filter(|(_, object)| object.path.len() < 2)
            .map(|(place, object)| (&object.path[..], place))
            .collect();
        let starts = Starts::of(file);
        let (mut dates, mut restarted) = (Named::default(), Named::default());
        let (mut changed, mut changing) = (Named::default(), HashSet::new());
        let mut known = HashMap::new();
        for (place, object) in objects() {
            let [group, name] = &object.path[..] else {
                channels.comment(object, budget)?;
                continue;
            };
            let of_label = of_text(group.len() + name.len());
            budget.work(64 + of_label, PART)?;
            let label = || format!("{group}/{name}");
            let mut skip = |what: &str| {
                budget.hold(of_label + what.len() as u64, PART)?;
                channels.skipped.push(format!("{} ({what})", label()));
                Ok::<_, Refused>(())
            };
            let Some(first) = object.first.filter(|_| object.rows > 0) else {
                skip(object.unread.unwrap_or("no samples"))?;
                continue;
            };
            let raw = Raw {
                reads: &object.reads,
                first,
            };
            // The scales of the channel, of its group or of the file: the first that has any.
            let around = [&object.path[..1], &[]].map(|path| above.get(path).copied());
            let mut owners = [Some(place), around[0], around[1]].into_iter().flatten();
            let owner =
                owners.find(|&owner| Scales::count(&file.objects[owner].properties).is_some());
            let scales = match owner {
                Some(owner) => of_owner(&file.objects[owner], owner, raw, &mut known, budget)?,
                // For DAQmx without scales, several values at once are not one channel.
                None if object.reads.len() > 1 => Err("several raw values without scales".into()),
                None => Ok(None),
            };
            let scales = match scales {
                Ok(scales) => scales,
                Err(what) => {
                    skip(&what)?;
                    continue;
                }
            };
            let is_date = object.reads.values().any(|read| *read == Read::Date);
            let clock = starts.clock(object);
            if is_date {
                dates.add(label);
            }
            if clock.is_some() && object.is_restarted {
                restarted.add(label);
            }
            let unit = if is_date { Some("s") } else { unit(object) };
            let array = Array {
                group: groups.inside(Group::FILE, group)?,
                column: Column {
                    name: name.trim().to_owned(),
                    unit: unit.map(str::to_owned),
                    is_numeric: true,
                    is_stamp: is_date,
                    ..Column::default()
                },
                rows: object.rows as u64,
                clock,
                source: Scaled {
                    object: place,
                    scales,
                    are_times: false,
                },
            };
            let times = (object.steps.len() > 1).then(|| Array {
                column: Column {
                    name: TIMES.to_owned(),
                    unit: Some("s".to_owned()),
                    is_numeric: true,
                    is_time: true,
                    ..Column::default()
                },
                source: Scaled {
                    object: place,
                    scales: None,
                    are_times: true,
                },
                ..array.clone()
            });
            let in_group = array.group;
            array.add_to(&mut channels.arrays, budget)?;
            // Channels of a group with the same steps share their times.
            if let Some(times) = times {
                let mut room = Room::of(budget);
                room.more(of_list::<(usize, u64)>(object.steps.len()), PART)?;
                if changing.insert((in_group, object.rows, bits_of(&object.steps))) {
                    room.keep();
                    changed.add(label);
                    times.add_to(&mut channels.arrays, budget)?;
                }
            }
        }
        channels.guesses.extend(dates.said(
            "the dates of",
            "are taken as seconds after the first of them",
        ));
        channels.guesses.extend(restarted.said(
            "the clock of",
            "restarted within the file (wf_start_time); its samples are read as one continuous stretch",
        ));
        channels.guesses.extend(changed.said(
            "the step of",
            "changes within the file (wf_increment); its times follow it",
        ));
        channels.guesses.extend(starts.said);
        Ok(channels)
    }

    /// The texts of a file or of a group.
    fn comment(&mut self, object: &Object, budget: &Budget) -> Result<(), Refused> {
        let mut all: Vec<(&Rc<str>, &Property)> = object.properties.iter().collect();
        all.sort_unstable_by_key(|(key, _)| *key);
        for (key, value) in all {
            if let Property::Text(text) = value {
                let path: Vec<&str> = object
                    .path
                    .iter()
                    .chain([key])
                    .map(|part| &**part)
                    .collect();
                let of_path: usize = path.iter().map(|part| part.len() + 1).sum();
                budget.hold(of_text(of_path + text.len()), "its comments")?;
                self.comments.push([&path.join("/"), ": ", text].concat());
            }
        }
        Ok(())
    }
}

/// Scales, or why they are not known.
type Found = Result<Option<Rc<Scales>>, String>;

/// The scales that an object states, for a channel with some raw values. They are made once for all channels of a group.
fn of_owner(
    object: &Object,
    owner: usize,
    raw: Raw<'_>,
    known: &mut HashMap<usize, Found>,
    budget: &Budget,
) -> Result<Found, Refused> {
    let properties = &object.properties;
    let count = Scales::count(properties).unwrap_or_default();
    // A scale has properties, or takes raw values of its own.
    if count > properties.len() + raw.reads.len() {
        return Ok(Err(format!("{count} scales")));
    }
    let found = match known.get(&owner) {
        Some(found) => found.clone(),
        None => {
            let found = Scales::of(properties, count, budget)?.map(|found| found.map(Rc::new));
            known.insert(owner, found.clone());
            found
        }
    };
    if let Ok(Some(scales)) = &found {
        budget.work(count as u64, PART)?;
        if !scales.fit(raw) {
            return Ok(Err("raw values of no scale".into()));
        }
    }
    Ok(found)
}

/// The unit that a channel states.
fn unit(object: &Object) -> Option<&str> {
    let keys = [
        "unit_string",
        "NI_UnitDescription",
        "Unit",
        "unit",
        "Units",
        "units",
    ];
    let mut found = keys.iter().filter_map(|key| object.properties.get(*key));
    found.find_map(|value| match value {
        Property::Text(text) if !text.trim().is_empty() => Some(text.trim()),
        _ => None,
    })
}

/// Channels about which the same is noted.
#[derive(Default)]
struct Named {
    some: Vec<String>,
    count: usize,
}

impl Named {
    fn add(&mut self, label: impl FnOnce() -> String) {
        self.count += 1;
        if self.some.len() < NAMED {
            self.some.push(label());
        }
    }

    /// A note for each of some, and one for the others.
    fn said(self, of: &str, what: &str) -> Vec<String> {
        let more = self.count - self.some.len();
        let more = (more > 0).then(|| format!("{more} more channels"));
        let all = self.some.into_iter().chain(more);
        all.map(|one| format!("{of} {one} {what}")).collect()
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
        let clocked =
            || (file.objects.iter()).filter(|object| step(object).is_some() && object.rows > 0);
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

/// The step of a channel's clock, if it is one.
fn step(object: &Object) -> Option<f64> {
    match object.steps[..] {
        [(_, step)] => Some(step),
        _ => None,
    }
}

/// Steps as keys of a set.
fn bits_of(steps: &[(usize, f64)]) -> Vec<(usize, u64)> {
    let each = steps.iter();
    each.map(|(from, step)| (*from, step.to_bits())).collect()
}

fn number(object: &Object, key: &str) -> Option<f64> {
    match object.properties.get(key) {
        Some(Property::Number(number)) if number.is_finite() => Some(*number),
        _ => None,
    }
}
