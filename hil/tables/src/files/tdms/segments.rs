//! The segments of a file: their objects, the properties of these, and the position of their values.

use std::collections::HashMap;
use std::rc::Rc;

use super::cursor::{Cursor, Properties, Property, Texts};
use super::layout::{Layout, Member, Plan, Read, Run, Scalers, seconds};
use crate::budget::Budget;
use crate::files::refused::Refused;
use crate::room::Room;

const PART: &str = "its segments";
/// Bytes before a segment's metadata.
const LEAD: usize = 28;
/// Meaning of the bits in a segment's second word.
const METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

/// A file, a group or a channel.
#[derive(Debug, Default)]
pub(super) struct Object {
    /// Names of the group and the channel; empty for the file.
    pub path: Vec<Rc<str>>,
    pub properties: Properties,
    /// The scale that takes its first raw values.
    pub first: Option<u32>,
    /// How its raw values are read, by the scale that takes them.
    pub reads: HashMap<u32, Read>,
    /// The number of its values.
    pub rows: usize,
    /// Why it has no values, if it is not a channel of numbers.
    pub unread: Option<&'static str>,
    /// Time of its first sample, in 2⁻⁶⁴ s, if the file states it.
    pub start: Option<i128>,
    /// Whether its clock was restarted among its samples, at a time that does not agree with its steps.
    pub is_restarted: bool,
    /// The steps of its clock, `wf_increment` in s, each with the sample from which on it is stated.
    pub steps: Vec<(usize, f64)>,
    /// The time of the sample from which on the last of them is stated, after the first, s.
    changed: f64,
    /// The layout of its values in a chunk, as stated last.
    layout: Option<Layout>,
    /// The layout of DAQmx that its `reads` are known to agree with.
    agreed: Option<Rc<Scalers>>,
    /// Its place among the objects of the segments from here on; `None` if it is none of them.
    listed: Option<usize>,
}

/// The contents of a file.
pub(super) struct File {
    pub objects: Vec<Object>,
    pub runs: Vec<Run>,
    pub is_cut: bool,
}

/// A file that is read up to some segment.
struct Reading<'b> {
    file: File,
    texts: Texts<'b>,
    places: HashMap<Rc<str>, usize>,
    /// The objects of the segments from here on, in the order of their values. One that is listed elsewhere now is no longer meant.
    list: Vec<usize>,
    /// The last plan of the chunks, with the bits on which it depends; `None` if the list was changed after it.
    plan: Option<(u32, Rc<Plan>)>,
}

impl File {
    pub fn of(bytes: &[u8], budget: &Budget) -> Result<Self, Refused> {
        let mut reading = Reading {
            file: Self {
                objects: Vec::new(),
                runs: Vec::new(),
                is_cut: false,
            },
            texts: Texts::new(budget),
            places: HashMap::new(),
            list: Vec::new(),
            plan: None,
        };
        let mut at = 0;
        while let Some(lead) = bytes.get(at..at + LEAD) {
            budget.work(32, PART)?;
            if !lead.starts_with(b"TDSm") {
                return Err("a segment does not begin where it should".into());
            }
            let mut cursor = Cursor {
                bytes,
                at: at + 4,
                is_little: true,
            };
            let bits = cursor.u32()?;
            cursor.is_little = bits & BIG == 0;
            cursor.u32()?;
            let (next, raw) = (cursor.u64()?, cursor.u64()?);
            // A program that was interrupted has not written the length.
            let is_open = next == u64::MAX;
            let inside = |offset: u64| {
                let offset = usize::try_from(offset).unwrap_or(usize::MAX);
                offset.saturating_add(at + LEAD).min(bytes.len())
            };
            let end = if is_open { bytes.len() } else { inside(next) };
            reading.file.is_cut |= is_open || next > (bytes.len() - at - LEAD) as u64;
            if bits & METADATA != 0 {
                if bits & NEW_LIST != 0 {
                    reading.clear()?;
                }
                match reading.metadata(&mut cursor) {
                    // In a segment that was being written the contents are unknown.
                    Err(Refused::Damaged(_)) if is_open => break,
                    done => done?,
                }
            }
            if bits & RAW != 0 {
                let raw = inside(raw).max(cursor.at);
                if raw < end {
                    reading.values(raw, end, bits)?;
                }
            }
            at = end;
        }
        reading.flush()?;
        Ok(reading.file)
    }
}

impl Reading<'_> {
    /// Begins a new list of objects.
    fn clear(&mut self) -> Result<(), Refused> {
        self.texts.budget.work(self.list.len() as u64, PART)?;
        for &place in &self.list {
            self.file.objects[place].listed = None;
        }
        self.list.clear();
        self.plan = None;
        Ok(())
    }

    fn metadata(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Refused> {
        let count = cursor.u32()?;
        for _ in 0..count {
            let path = cursor.text()?;
            let place = self.place(&path)?;
            let header = cursor.u32()?;
            let object = &mut self.file.objects[place];
            let stated = match header {
                // It keeps its layout, or has none.
                0 | 0xffff_ffff => None,
                // NI's documented values, and those that its programs write.
                0x1269 | 0x126a | 0x6912_0000 | 0x6913_0000 | 0x1369 => {
                    let is_digital = header == 0x126a || header == 0x1369;
                    Some(cursor.daqmx(is_digital, self.texts.budget)?)
                }
                _ => Some(cursor.plain()?),
            };
            if let Some(layout) = stated {
                object.layout = Some(layout);
                self.plan = None;
            }
            let is_listed = object.listed.is_some();
            if (header != 0xffff_ffff) != is_listed {
                self.plan = None;
                object.listed = (!is_listed).then_some(self.list.len());
                if !is_listed {
                    self.texts
                        .budget
                        .hold(2 * size_of::<usize>() as u64, PART)?;
                    self.list.push(place);
                }
            }
            for _ in 0..cursor.u32()? {
                self.property(cursor, place)?;
            }
        }
        // The places of objects that are no longer listed there are given up once for the whole segment.
        if self.plan.is_none() {
            self.texts.budget.work(self.list.len() as u64, PART)?;
            let before = std::mem::take(&mut self.list);
            let objects = &mut self.file.objects;
            for (at, place) in before.into_iter().enumerate() {
                if objects[place].listed == Some(at) {
                    objects[place].listed = Some(self.list.len());
                    self.list.push(place);
                }
            }
        }
        Ok(())
    }

    /// The place of the object at a path.
    fn place(&mut self, path: &str) -> Result<usize, Refused> {
        let budget = self.texts.budget;
        budget.work(16 + path.len() as u64, PART)?;
        if let Some(place) = self.places.get(path) {
            return Ok(*place);
        }
        let place = self.file.objects.len();
        let size = size_of::<Object>() + path.len() + size_of::<(Rc<str>, usize)>();
        budget.hold(2 * size as u64, PART)?;
        let mut parts = Vec::new();
        // A name takes two signs at least.
        let names_take = (size_of::<String>() * path.len()) as u64;
        let mut room = Room::of(budget);
        room.more(names_take, PART)?;
        for name in names(path) {
            budget.hold(size_of::<Rc<str>>() as u64, PART)?;
            parts.push(self.texts.once(&name)?);
        }
        self.file.objects.push(Object {
            path: parts,
            ..Object::default()
        });
        self.places.insert(path.into(), place);
        Ok(place)
    }

    fn property(&mut self, cursor: &mut Cursor<'_>, place: usize) -> Result<(), Refused> {
        let name = cursor.text()?;
        let name = self.texts.once(&name)?;
        let value = cursor.property(&mut self.texts)?;
        match (&*name, &value) {
            ("wf_start_time", Property::Date(now)) => {
                let samples = self.samples(place);
                self.file.objects[place].begins(*now, samples);
            }
            ("wf_increment", Property::Number(step)) if step.is_finite() && *step > 0.0 => {
                let samples = self.samples(place);
                self.file.objects[place].steps_by(*step, samples, self.texts.budget)?;
            }
            _ => {}
        }
        let size = size_of::<(Rc<str>, Property)>();
        let known = &mut self.file.objects[place].properties;
        if !known.contains_key(&name) {
            self.texts.budget.hold(2 * size as u64, PART)?;
        }
        known.insert(name, value);
        Ok(())
    }

    /// The number of an object's values so far.
    fn samples(&self, place: usize) -> usize {
        let now = self
            .file
            .runs
            .last()
            .map_or(0, |run| run.plan.count(place).saturating_mul(run.chunks));
        self.file.objects[place].rows.saturating_add(now)
    }

    /// Adds the values of the last run to the objects.
    fn flush(&mut self) -> Result<(), Refused> {
        let Some(run) = self.file.runs.last() else {
            return Ok(());
        };
        for member in run.plan.members() {
            self.texts.budget.work(2, PART)?;
            let object = &mut self.file.objects[member.object];
            let more = member.count.saturating_mul(run.chunks);
            object.rows = object.rows.saturating_add(more);
        }
        Ok(())
    }

    /// Adds the raw values between two positions.
    fn values(&mut self, from: usize, end: usize, bits: u32) -> Result<(), Refused> {
        let bits = bits & (BIG | DAQMX | INTERLEAVED);
        let plan = match &self.plan {
            Some((known, plan)) if *known == bits => plan.clone(),
            _ => self.planned(bits)?,
        };
        self.plan = Some((bits, plan.clone()));
        if plan.size == 0 {
            return Ok(());
        }
        let chunks = (end - from) / plan.size;
        self.file.is_cut |= !(end - from).is_multiple_of(plan.size);
        for &place in &plan.others {
            self.file.objects[place].unread = Some("texts or other things than numbers");
        }
        if chunks == 0 {
            return Ok(());
        }
        let is_same = |run: &Run| Rc::ptr_eq(&run.plan, &plan);
        if !self.file.runs.last().is_some_and(is_same) {
            for member in plan.members().filter(|member| member.count > 0) {
                self.file.objects[member.object].agree(&member, self.texts.budget)?;
            }
            self.flush()?;
            self.texts.budget.hold(2 * size_of::<Run>() as u64, PART)?;
            self.file.runs.push(Run {
                plan: plan.clone(),
                segments: Vec::new(),
                chunks: 0,
            });
        }
        if let Some(run) = self.file.runs.last_mut() {
            self.texts
                .budget
                .hold(2 * size_of::<(usize, usize)>() as u64, PART)?;
            run.segments.push((from, chunks));
            run.chunks = run.chunks.saturating_add(chunks);
        }
        Ok(())
    }

    /// The plan of chunks with the objects of the list; the last one if it is the same.
    fn planned(&self, bits: u32) -> Result<Rc<Plan>, Refused> {
        let budget = self.texts.budget;
        budget.work(4 * self.list.len() as u64, PART)?;
        let (objects, is_little) = (&self.file.objects, bits & BIG == 0);
        let list = self.list.iter();
        let plan = if bits & DAQMX != 0 {
            let daqmx = list.filter_map(|&place| match &objects[place].layout {
                Some(Layout::Daqmx(scalers)) => Some((place, scalers.clone())),
                _ => None,
            });
            Plan::daqmx(daqmx, is_little, budget)?
        } else {
            let plain = list.filter_map(|&place| match objects[place].layout {
                Some(Layout::Plain(plain)) => Some((place, plain)),
                _ => None,
            });
            Plan::plain(plain, bits & INTERLEAVED != 0, is_little, budget)?
        };
        match self.file.runs.last() {
            Some(run) if *run.plan == plan => {
                budget.release(plan.held());
                Ok(run.plan.clone())
            }
            _ => Ok(Rc::new(plan)),
        }
    }
}

impl Object {
    /// Sets the time of the samples from here on, of which there were `samples` before.
    fn begins(&mut self, now: i128, samples: usize) {
        match (self.start, self.steps.last()) {
            (Some(first), Some(&(_, step))) if samples > 0 => {
                let off = seconds(now.wrapping_sub(first)) - self.after(samples);
                // Some programs repeat the first start in every segment.
                self.is_restarted |= now != first && off.abs() > 0.5 * step;
            }
            _ => self.start = Some(now),
        }
    }

    /// Sets the step of the samples from here on, of which there were `samples` before.
    fn steps_by(&mut self, step: f64, samples: usize, budget: &Budget) -> Result<(), Refused> {
        match self.steps.last_mut() {
            Some((from, known)) if *from == samples => *known = step,
            Some((_, known)) if *known == step => {}
            _ => {
                budget.hold(2 * size_of::<(usize, f64)>() as u64, PART)?;
                let from = if self.steps.is_empty() { 0 } else { samples };
                self.changed = self.after(from);
                self.steps.push((from, step));
            }
        }
        Ok(())
    }

    /// Time of a sample after the first, s. It is one from the last change of the step on.
    fn after(&self, sample: usize) -> f64 {
        let since = |&(from, step): &(usize, f64)| sample.saturating_sub(from) as f64 * step;
        self.changed + self.steps.last().map_or(0.0, since)
    }

    /// Times of all samples after the first, s.
    pub fn times(&self) -> Vec<f64> {
        let mut steps = self.steps.iter().peekable();
        let (mut begin, mut of_begin, mut step) = (0, 0.0, 0.0);
        (0..self.rows)
            .map(|sample| {
                if let Some((_, next)) = steps.next_if(|(from, _)| *from == sample) {
                    of_begin += step * (sample - begin) as f64;
                    (begin, step) = (sample, *next);
                }
                of_begin + step * (sample - begin) as f64
            })
            .collect()
    }

    /// Checks that values of another layout have the types that the object's have so far.
    fn agree(&mut self, member: &Member<'_>, budget: &Budget) -> Result<(), Refused> {
        if member.is_of(self.agreed.as_ref()) {
            return Ok(());
        }
        for (scale, read) in member.reads() {
            budget.work(4, PART)?;
            match self.reads.get(&scale) {
                Some(known) if *known != read => {
                    return Err("a channel changes its type".into());
                }
                Some(_) => {}
                None => {
                    budget.hold(2 * size_of::<(u32, Read)>() as u64, PART)?;
                    self.reads.insert(scale, read);
                    self.first = self.first.or(Some(scale));
                }
            }
        }
        self.agreed = member.scalers().cloned();
        Ok(())
    }
}

/// The names in a path such as `/'Rig'/'Axial force'`, in which an apostrophe is written twice.
fn names(path: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut name: Option<String> = None;
    let mut characters = path.chars().peekable();
    while let Some(c) = characters.next() {
        match (c, &mut name) {
            ('\'', Some(inner)) if characters.peek() == Some(&'\'') => {
                characters.next();
                inner.push('\'');
            }
            ('\'', Some(_)) => names.extend(name.take()),
            ('\'', None) => name = Some(String::new()),
            (c, Some(inner)) => inner.push(c),
            (_, None) => {}
        }
    }
    names
}
