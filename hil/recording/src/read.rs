//! Reading a recording from a file of any format.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use mesh_damper_output::error::InputError;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::columns::{Chosen, Used, choose, is_own};
use mesh_damper_tables::control::ControlChannel;
use mesh_damper_tables::files::{self, Kept, Needs, Reading, Tables, Values, Wanted};
use mesh_damper_tables::units::Units;

use super::stated_rate::{Certain, Times, contradiction};
use super::{FEWEST_SAMPLES, Recording, Source, times};
use crate::faults::bridge::lines;
use crate::faults::kind::{Between, ChannelFault, ChannelFaultKind};
use crate::resample::interpolate;

impl Recording {
    /// Reads a file of any format of [`files::FORMATS`], gzipped text included; its content determines the format, not its name. A
    /// row whose displacement or force is empty or `NaN` is a missing sample and left out. So is a row that repeats the one before,
    /// and the last row of a text without a line end: its last number may have been cut, and 1.2 may be the beginning of 1.25.
    /// [`Recording::faults`] reports repeated rows and one that may have been cut.
    ///
    /// # Errors
    /// The file, the line or column, the problem and its correction: a missing file, a directory, a damaged or empty file, one
    /// beyond the default [`ReadLimit`](mesh_damper_tables::read_limit::ReadLimit), no header, a channel that is missing or that two columns
    /// match, an unknown unit, a row too short or too long, a cell that is not a finite number or, except in a missing sample,
    /// empty, time that does not increase from row to row, too few samples, a constant displacement.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, InputError> {
        Self::read_as(path, &Reading::default())
    }

    /// [`Recording::read`] with the user's settings for the file.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn read_as(path: impl AsRef<Path>, reading: &Reading) -> Result<Self, InputError> {
        Self::whole(path.as_ref(), reading, Kept::Cells, &Needs::default())
    }

    /// [`Recording::read_as`] for uses to which a motion alone is enough: without a force column the force is 0, and the error that
    /// names what was found in its place comes with it.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn read_even_without_force(
        path: impl AsRef<Path>,
        reading: &Reading,
    ) -> Result<(Self, Option<InputError>), InputError> {
        let path = path.as_ref();
        match Self::read_as(path, reading) {
            Err(error) if error.missing() == Some(Channel::Force.name()) => {
                let motion = Self::whole(path, reading, Kept::Cells, &Needs::motion())?;
                Ok((motion, Some(error)))
            }
            read => Ok((read?, None)),
        }
    }

    /// [`Recording::read_as`] for callers that do not write the recording again: other columns, and the cells as text, are not
    /// kept.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn read_channels(path: impl AsRef<Path>, reading: &Reading) -> Result<Self, InputError> {
        Self::whole(path.as_ref(), reading, Kept::Channels, &Needs::default())
    }

    /// [`Recording::read_channels`] for a file whose motion alone is needed: without a force column the force is 0.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn read_motion(path: impl AsRef<Path>, reading: &Reading) -> Result<Self, InputError> {
        Self::read_for(path, reading, &Needs::motion())
    }

    /// [`Recording::read_channels`] for callers with their own requirements on the recording. Without a force, if none is needed,
    /// it is 0.
    ///
    /// # Errors
    /// As [`Recording::read`], and a control input that is needed and not there.
    pub fn read_for(
        path: impl AsRef<Path>,
        reading: &Reading,
        needs: &Needs,
    ) -> Result<Self, InputError> {
        Self::whole(path.as_ref(), reading, Kept::Channels, needs)
    }

    /// A recording that was read, with a force.
    pub(crate) fn checked(mut self) -> Result<Self, InputError> {
        if self.force.is_empty() {
            self.force = vec![0.0; self.time.len()];
        }
        self.check()
            .map_err(|error| error.in_table(self.table.as_deref()))?;
        Ok(self)
    }

    /// [`Recording::read`] from a file's bytes; `path` is its name in errors.
    ///
    /// # Errors
    /// As [`Recording::read`], without errors of the file system.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, InputError> {
        let reading = Reading::default();
        let source = files::Source::of(path, bytes.as_slice(), reading.limit)?;
        let (_, file) = files::opened(source, &reading)?;
        Self::of(path, file, &reading, Kept::Cells, &Needs::default())?.checked()
    }

    /// Uncertain choices of columns, and other findings about the file, in words: `force is read from column "Load" in N`. Empty
    /// for a file of our own format.
    pub fn guesses(&self) -> &[String] {
        &self.guesses
    }

    /// The same, each after the file's name.
    pub fn named_guesses(&self) -> impl Iterator<Item = String> {
        let guesses = self.guesses.iter();
        guesses.map(|guess| format!("{}: {guess}", self.name))
    }

    /// Assumed units, in words, if [`Unmarked::Assumed`](files::Unmarked) permits assumptions.
    pub fn assumed(&self) -> Option<&str> {
        self.assumed.as_deref()
    }

    fn whole(
        path: &Path,
        reading: &Reading,
        kept: Kept,
        needs: &Needs,
    ) -> Result<Self, InputError> {
        let (_, file) = files::open(path, reading)?;
        Self::of(path, file, reading, kept, needs)?.checked()
    }

    /// The channels of an opened file. Channels that are not needed may be missing, and are empty then. They are not checked yet.
    pub(super) fn of(
        path: &Path,
        file: Box<dyn Tables + '_>,
        reading: &Reading,
        kept: Kept,
        needs: &Needs,
    ) -> Result<Self, InputError> {
        let name = path.display().to_string();
        let mut chosen = choose(&name, file.tables(), reading, needs)?;
        let used = chosen.used.iter().map(|used| Wanted {
            column: used.column,
            must_be_numeric: true,
        });
        let controls = chosen.controls.iter().map(|control| Wanted {
            column: control.column,
            must_be_numeric: needs.inputs.is_some(),
        });
        let wanted: Vec<Wanted> = used.chain(controls).collect();
        let table = &file.tables()[chosen.table];
        let column_names = wanted
            .iter()
            .map(|wanted| &table.columns[wanted.column].name);
        let column_names: Vec<String> = column_names.cloned().collect();
        let is_time = |used: &&Used| used.channel == Channel::Time;
        let time_column = chosen.used.iter().find(is_time).map(|used| {
            let column = &table.columns[used.column];
            let certain = if column.is_stamp {
                Certain::Dates
            } else if is_own(&column.name) {
                Certain::Name
            } else {
                Certain::No
            };
            (column.name.clone(), certain)
        });
        let stated_steps = table.stated_steps.clone();
        let table = (file.tables().len() > 1).then(|| table.name.clone());
        let placed = |error: InputError| error.in_table(table.as_deref());
        let mut values = file.read(chosen.table, &wanted, kept).map_err(placed)?;
        chosen.guesses.append(&mut values.notes);
        let samples = Samples::of(name, chosen, column_names, values)?;
        let mut recording = samples.recording().map_err(placed)?;
        recording.table.clone_from(&table);
        let are_dates = matches!(time_column, Some((_, Certain::Dates)));
        if time_column.is_some() && !recording.time.is_empty() {
            let unit = recording.units.time.scale;
            let found = times::put_right(&mut recording.time, are_dates, unit);
            // The cells hold the times as they were.
            recording.source = recording.source.filter(|_| found.is_empty());
            recording.faults.extend(found);
        }
        let source = match &time_column {
            Some((name, certain)) => Times::Column(name, recording.units.time, *certain),
            None if reading.rate.is_some() => Times::Given,
            None => Times::File,
        };
        let contradiction = contradiction(&stated_steps, &recording.time, source);
        recording.guesses.extend(contradiction);
        for input in needs.inputs.iter().flatten() {
            if !recording.controls.iter().any(|each| each.name == *input) {
                let problem = format!("the control input {input} holds no number");
                let remedy = "give its values, or leave it out";
                return Err(InputError::new(recording.name, problem, remedy));
            }
        }
        Ok(recording)
    }
}

/// The names of a file's columns, with our own names, including the unit of their cells, for channels, so that a file written from
/// them needs no interpretation.
fn own_names(header: &csv::StringRecord, chosen: &Chosen) -> csv::StringRecord {
    let channels = chosen.used.iter().map(|used| {
        let name = format!("{}_{}", used.channel.name(), used.unit.symbol);
        (used.column, name)
    });
    let controls = chosen.controls.iter();
    let controls = controls.map(|control| (control.column, control.name.clone()));
    // The first use of a column counts.
    let ours: Vec<(usize, String)> = channels.chain(controls).collect();
    let by_column: HashMap<usize, &str> = (ours.iter().rev())
        .map(|(column, name)| (*column, name.as_str()))
        .collect();
    let names: HashSet<&str> = ours.iter().map(|(_, name)| name.as_str()).collect();
    let named = header.iter().enumerate().map(|(column, name)| {
        match by_column.get(&column) {
            Some(own) => (*own).to_owned(),
            // A column that would have been the channel without the user's setting.
            None if names.contains(name) => format!("other_{name}"),
            None => name.to_owned(),
        }
    });
    named.collect()
}

/// The values of a recording under construction.
struct Samples {
    name: String,
    chosen: Chosen,
    /// Names of the columns, channels first.
    column_names: Vec<String>,
    channels: Vec<Vec<f64>>,
    inputs: Vec<Option<Vec<f64>>>,
    values: Values,
    faults: Vec<ChannelFault>,
}

impl Samples {
    fn of(
        name: String,
        chosen: Chosen,
        column_names: Vec<String>,
        mut values: Values,
    ) -> Result<Self, InputError> {
        let inputs = values.columns.split_off(chosen.used.len());
        // Columns of channels are numbers, or were rejected.
        let channels = std::mem::take(&mut values.columns)
            .into_iter()
            .map(Option::unwrap_or_default);
        let mut samples = Self {
            name,
            channels: channels.collect(),
            chosen,
            column_names,
            inputs,
            values,
            faults: Vec::new(),
        };
        samples.hold_inputs();
        Ok(samples)
    }

    /// A logger without a new value of an input: the input keeps its value, even if the row itself is left out. Before the first
    /// value it is that value; an input without any value is unknown.
    fn hold_inputs(&mut self) {
        for input in &mut self.inputs {
            let Some(values) = input else { continue };
            let Some(first) = values.iter().find(|value| !value.is_nan()) else {
                *input = None;
                continue;
            };
            let mut now = *first;
            for value in values {
                if value.is_nan() {
                    *value = now;
                }
                now = *value;
            }
        }
    }

    fn recording(mut self) -> Result<Recording, InputError> {
        let rows = self.channels.first().map_or(0, Vec::len);
        self.fill_others();
        self.fill_faster();
        let may_be_blank: Vec<bool> = (self.chosen.used.iter())
            .map(|used| matches!(used.channel, Channel::Displacement | Channel::Force))
            .collect();
        let mut is_kept = vec![true; rows];
        self.leave_out_zeros(&mut is_kept);
        let (mut blank, mut first_blank, mut repeated) = (vec![0; self.channels.len()], None, 0);
        let mut last = None;
        for row in 0..rows {
            if !is_kept[row] {
                continue;
            }
            let is_nan = |index: &usize| self.channels[*index][row].is_nan();
            if let Some(index) = (0..self.channels.len()).find(is_nan) {
                if !may_be_blank[index] {
                    return Err(self.blank(row, index));
                }
                blank[index] += 1;
                first_blank = first_blank.or(Some((row, index)));
                is_kept[row] = false;
                continue;
            }
            // A logger that writes a sample twice; the same time with other values is rejected.
            let is_same =
                |before: usize| self.channels.iter().all(|each| each[before] == each[row]);
            if self.chosen.clock.is_none() && last.is_some_and(is_same) {
                repeated += 1;
                is_kept[row] = false;
                continue;
            }
            last = Some(row);
        }
        let kept = is_kept.iter().filter(|kept| **kept).count();
        if let Some((row, index)) = first_blank {
            if kept < FEWEST_SAMPLES {
                return Err(self.blank(row, index));
            }
            // Some are samples that are missing; many mean that the channel is slower.
            let often = (0..blank.len()).max_by_key(|&index| blank[index]);
            let slower = often.filter(|_| 3 * blank.iter().sum::<usize>() >= rows);
            if let Some(slower) = slower {
                self.faults.push(ChannelFault {
                    channel: self.chosen.used[slower].channel,
                    kind: ChannelFaultKind::Slower {
                        rows: rows as f64 / kept as f64,
                        between: Between::Nothing,
                    },
                });
            }
        }
        let time = self.chosen.clock.map(|clock| {
            let times = (0..rows).map(|row| clock.start + clock.step * row as f64);
            times.collect::<Vec<f64>>()
        });
        let keep = |values: &mut Vec<f64>| {
            let mut is_kept = is_kept.iter();
            values.retain(|_| *is_kept.next().unwrap_or(&false));
        };
        if is_kept.contains(&false) {
            self.channels.iter_mut().for_each(keep);
            self.inputs.iter_mut().flatten().for_each(keep);
            self.values.lines.keep(&is_kept);
            if let Some((header, cells)) = &mut self.values.cells {
                cells.keep(header.len(), &is_kept);
            }
        }
        Ok(self.into_recording(
            time.map(|mut time| {
                keep(&mut time);
                time
            }),
            repeated,
        ))
    }

    /// Velocity and temperature, which are not needed, where they are empty: the line between the values around. A channel without any
    /// value is not there.
    fn fill_others(&mut self) {
        for index in (0..self.channels.len()).rev() {
            let channel = self.chosen.used[index].channel;
            let empty: Vec<bool> = self.channels[index]
                .iter()
                .map(|value| value.is_nan())
                .collect();
            let samples = empty.iter().filter(|empty| **empty).count();
            if !matches!(channel, Channel::Velocity | Channel::Temperature) || samples == 0 {
                continue;
            }
            if samples == empty.len() {
                self.channels.remove(index);
                self.chosen.used.remove(index);
                self.column_names.remove(index);
                continue;
            }
            lines(&mut self.channels[index], &empty);
            let kind = ChannelFaultKind::Blank { samples };
            self.faults.push(ChannelFault { channel, kind });
        }
    }

    /// Two channels that were sampled at times of their own share no rows. The one with more values is interpolated in the rows of the
    /// other.
    fn fill_faster(&mut self) {
        let place = |channel| {
            self.chosen
                .used
                .iter()
                .position(|used| used.channel == channel)
        };
        let (Some(displacement), Some(force)) =
            (place(Channel::Displacement), place(Channel::Force))
        else {
            return;
        };
        let is_known = |index: usize, row: usize| !self.channels[index][row].is_nan();
        let rows = || 0..self.channels[force].len();
        let count = |index| rows().filter(|&row| is_known(index, row)).count();
        let (of_displacement, of_force) = (count(displacement), count(force));
        let both = rows().filter(|&row| is_known(displacement, row) && is_known(force, row));
        let fewer = of_displacement.min(of_force);
        if 2 * both.count() >= fewer || fewer < FEWEST_SAMPLES {
            return;
        }
        let (faster, slower) = match of_displacement >= of_force {
            true => (displacement, force),
            false => (force, displacement),
        };
        let rows_of = |index| rows().filter(move |&row| is_known(index, row));
        let known: Vec<usize> = rows_of(faster).collect();
        let time = place(Channel::Time).map(|time| &self.channels[time]);
        let at = |row: usize| time.map_or(row as f64, |time| time[row]);
        let nodes: Vec<f64> = known.iter().map(|&row| at(row)).collect();
        if !nodes.is_sorted_by(|a, b| a < b) {
            return;
        }
        let inside = |row: &usize| (nodes[0]..=nodes[nodes.len() - 1]).contains(&at(*row));
        let slower: Vec<usize> = rows_of(slower).filter(inside).collect();
        let values: Vec<f64> = known
            .iter()
            .map(|&row| self.channels[faster][row])
            .collect();
        let times = slower.iter().map(|&row| at(row)).collect::<Vec<f64>>();
        let filled = interpolate(&nodes, &values, times.into_iter(), f64::INFINITY);
        for (row, value) in slower.into_iter().zip(filled) {
            self.channels[faster][row] = value;
        }
    }

    /// Rows of zeros behind the last sample, with which some programs close a file.
    fn leave_out_zeros(&mut self, is_kept: &mut [bool]) {
        let mut used = self.chosen.used.iter();
        let Some(time) = used.position(|used| used.channel == Channel::Time) else {
            return;
        };
        let is_zero = |row: usize| self.channels.iter().all(|each| each[row] == 0.0);
        let zeros = (0..is_kept.len())
            .rev()
            .take_while(|&row| is_zero(row))
            .count();
        let last = is_kept.len() - zeros;
        // A recording may also end at time 0.
        if zeros == 0 || last == 0 || self.channels[time][last - 1] <= 0.0 {
            return;
        }
        is_kept[last..].fill(false);
        self.faults.push(ChannelFault {
            channel: Channel::Time,
            kind: ChannelFaultKind::Zeros { samples: zeros },
        });
    }

    /// A required cell without a number.
    fn blank(&self, row: usize, index: usize) -> InputError {
        let place = self
            .values
            .lines
            .place(row, Some(&self.column_names[index]));
        let problem = "the cell is empty or \"NaN\"";
        InputError::new(&self.name, problem, "remove the row or correct the value").at(place)
    }

    fn into_recording(self, time: Option<Vec<f64>>, repeated: usize) -> Recording {
        let mut faults = self.faults;
        if repeated > 0 {
            faults.push(ChannelFault {
                channel: Channel::Time,
                kind: ChannelFaultKind::Repeated { samples: repeated },
            });
        }
        if self.values.is_cut {
            faults.push(ChannelFault {
                channel: Channel::Time,
                kind: ChannelFaultKind::Cut,
            });
        }
        let mut all = self.channels.iter().zip(&self.chosen.used);
        let motion = all.find(|(_, used)| used.channel == Channel::Displacement);
        let (displacement, scale) = motion.map_or((&[][..], 0.0), |(values, used)| {
            (values.as_slice(), used.unit.scale)
        });
        let named = self.chosen.controls.iter().zip(self.inputs);
        let controls = named.filter_map(|(control, values)| {
            let name = control.name.clone();
            let channel = values.map(|values| ControlChannel { name, values })?;
            match control.length {
                Some(unit) => channel.set_beside(displacement, scale / unit.scale),
                None => Some(channel),
            }
        });
        let controls = controls.collect();
        let mut units = Units::default();
        let mut recording = Recording {
            name: self.name,
            time: time.unwrap_or_default(),
            displacement: Vec::new(),
            force: Vec::new(),
            velocity: None,
            temperature: None,
            controls,
            comments: self.values.comments,
            units,
            source: (self.values.cells).map(|(header, rows)| Source {
                header: own_names(&header, &self.chosen),
                rows,
            }),
            lines: self.values.lines,
            table: None,
            guesses: self.chosen.guesses,
            assumed: self.chosen.assumed,
            faults,
        };
        for (mut values, used) in self.channels.into_iter().zip(self.chosen.used) {
            let unit = used.unit;
            values
                .iter_mut()
                .for_each(|value| *value = unit.to_code(*value));
            match used.channel {
                Channel::Time => (recording.time, units.time) = (values, unit),
                Channel::Displacement => {
                    (recording.displacement, units.displacement) = (values, unit);
                }
                Channel::Force => (recording.force, units.force) = (values, unit),
                Channel::Velocity => (recording.velocity, units.velocity) = (Some(values), unit),
                Channel::Temperature => {
                    (recording.temperature, units.temperature) = (Some(values), unit);
                }
            }
        }
        recording.units = units;
        recording
    }
}
