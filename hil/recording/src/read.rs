//! Reading a recording from CSV or CSV.gz.

use std::path::Path;

use super::channel::Channel;
use super::control::{ControlChannel, is_control};
use super::faults::{ChannelFault, ChannelFaultKind};
use super::rows::{RowLines, TextRows};
use super::units::{Unit, Units};
use super::{Recording, Source};
use crate::csv_text::{CsvText, broken_csv, doubled, is_blank as is_blank_cell, is_cut, number};
use crate::error::{InputError, Place, quoted};
use crate::read_limit::ReadLimit;

impl Recording {
    /// Reads CSV, or gzipped CSV: the file's first bytes say which, not its name. A row whose displacement or force is an
    /// empty cell or `NaN` is a sample that is missing: it is left out. So is a row that is the one before once more, and a
    /// last row without a line end: its last number may have been cut, and nothing tells 1.2 from the beginning of 1.25. Of
    /// rows that repeat, and of one that may have been cut, [`Recording::faults`] tells.
    ///
    /// # Errors
    /// The file, the line or column, what is wrong and how to mend it: no such file, a directory, damaged gzip, not
    /// UTF-8, empty, beyond the default [`ReadLimit`], no header, a missing or doubled column, an unknown unit, a row too short
    /// or too long, a cell that is no finite number or, but for a missing sample's, empty, time that does
    /// not increase from one row to another, too few samples, a constant displacement.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, InputError> {
        Self::read_within(path, ReadLimit::default())
    }

    /// [`Recording::read`] of a file within another limit.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn read_within(path: impl AsRef<Path>, limit: ReadLimit) -> Result<Self, InputError> {
        Self::parse(CsvText::open(path.as_ref(), limit)?, Kept::Cells)
    }

    /// [`Recording::read_within`] for who does not write the recording again: other columns, and the cells as text, are not kept.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn read_channels_within(
        path: impl AsRef<Path>,
        limit: ReadLimit,
    ) -> Result<Self, InputError> {
        Self::parse(CsvText::open(path.as_ref(), limit)?, Kept::Channels)
    }

    /// [`Recording::read_channels_within`] of a file that needs no force, because only its motion counts: without a force column
    /// the force is 0.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn read_motion_within(
        path: impl AsRef<Path>,
        limit: ReadLimit,
    ) -> Result<Self, InputError> {
        let needed = |channel: Channel| channel.is_required() && channel != Channel::Force;
        let text = CsvText::open(path.as_ref(), limit)?;
        let mut recording = Self::parse_channels(text, Kept::Channels, needed)?;
        if recording.force.is_empty() {
            recording.force = vec![0.0; recording.time.len()];
        }
        recording.check()?;
        Ok(recording)
    }

    /// [`Recording::read`] of a file's bytes; `path` is what errors call it.
    ///
    /// # Errors
    /// As [`Recording::read`], but for what the file system says.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, InputError> {
        let text = CsvText::of(path, bytes.as_slice(), ReadLimit::default())?;
        Self::parse(text, Kept::Cells)
    }

    fn parse(text: CsvText, kept: Kept) -> Result<Self, InputError> {
        let recording = Self::parse_channels(text, kept, Channel::is_required)?;
        recording.check()?;
        Ok(recording)
    }

    /// The channels of `text`, of which those that are not `needed` may be missing, which leaves them empty. They are still to be
    /// checked.
    pub(super) fn parse_channels(
        text: CsvText,
        kept: Kept,
        needed: impl Fn(Channel) -> bool,
    ) -> Result<Self, InputError> {
        let name = text.name();
        let mut reader = text.rows();
        let mut header = csv::StringRecord::new();
        match reader.read_record(&mut header) {
            Ok(true) => {}
            Err(error) => return Err(broken_csv(&name, &error)),
            Ok(false) => {
                let problem = if reader.into_inner().comments().is_empty() {
                    "is empty"
                } else {
                    "holds comments only"
                };
                return Err(InputError::new(
                    name,
                    problem,
                    "write a header such as time_s,displacement_mm,force_kN and samples below it",
                ));
            }
        }
        let columns = Columns::find(&name, &header, &needed)?;

        let mut channels = vec![Vec::new(); columns.used.len()];
        let mut inputs: Vec<InputColumn> = columns
            .controls
            .iter()
            .map(|&index| InputColumn::at(index))
            .collect();
        let mut cells = (kept == Kept::Cells).then(TextRows::default);
        let mut lines = RowLines::default();
        let (mut blank, mut first_blank) = (0, None);
        let (mut repeated, mut cut) = (0, false);
        let mut row = csv::StringRecord::new();
        while (reader.read_record(&mut row)).map_err(|error| broken_csv(&name, &error))? {
            if is_cut(&reader) {
                // The reader makes an empty row of a comment there.
                cut = row.iter().any(|cell| !cell.is_empty());
                break;
            }
            let line = row.position().map_or(0, csv::Position::line);
            if row.len() != header.len() {
                return Err(InputError::new(
                    name,
                    format!("{} cells where the header has {}", row.len(), header.len()),
                    "write one cell per column, separated by commas",
                )
                .at(Place::Line(line)));
            }
            let cell = |column: &Column| row.get(column.index).unwrap_or_default();
            let value = |column: &Column| {
                number(cell(column)).map_err(|(problem, mend)| {
                    InputError::new(&name, problem, mend).at(Place::Cell {
                        line,
                        column: header.get(column.index).unwrap_or_default().into(),
                    })
                })
            };
            // A logger that has nothing new to say of an input: it is as it was, be the row itself left out or not.
            inputs.iter_mut().for_each(|input| input.see(&row));
            let is_blank = |column: &&Column| column.may_be_blank() && is_blank_cell(cell(column));
            if let Some(column) = columns.used.iter().find(is_blank) {
                blank += 1;
                first_blank = first_blank.or_else(|| value(column).err());
                continue;
            }
            let scaled = |column: &Column| Ok(value(column)? * column.unit.scale);
            let values: Vec<f64> = columns
                .used
                .iter()
                .map(scaled)
                .collect::<Result<_, InputError>>()?;
            // A logger that writes a sample twice; the same time with anything else is refused.
            let is_last = |(channel, value): (&Vec<f64>, &f64)| channel.last() == Some(value);
            if channels.iter().zip(&values).all(is_last) {
                repeated += 1;
                continue;
            }
            for (channel, value) in channels.iter_mut().zip(values) {
                grow(channel);
                channel.push(value);
            }
            inputs.iter_mut().for_each(InputColumn::keep);
            if let Some(cells) = &mut cells {
                cells.push(&row);
            }
            lines.push(line);
        }
        if blank > lines.len()
            && let Some(error) = first_blank
        {
            return Err(error);
        }

        let controls = inputs
            .into_iter()
            .filter_map(|input| input.channel(&header));
        let mut recording = Self {
            name,
            time: Vec::new(),
            displacement: Vec::new(),
            force: Vec::new(),
            velocity: None,
            temperature: None,
            controls: controls.collect(),
            comments: reader.into_inner().comments(),
            units: Units::default(),
            source: cells.map(|rows| Source { header, rows }),
            lines,
            faults: Vec::new(),
        };
        if repeated > 0 {
            recording.faults.push(ChannelFault {
                channel: Channel::Time,
                kind: ChannelFaultKind::Repeated { samples: repeated },
            });
        }
        if cut {
            recording.faults.push(ChannelFault {
                channel: Channel::Time,
                kind: ChannelFaultKind::Cut,
            });
        }
        recording.fill(columns.used, channels);
        Ok(recording)
    }

    /// Puts what was read of each column into its channel.
    pub(super) fn fill(&mut self, columns: Vec<Column>, channels: Vec<Vec<f64>>) {
        let units = &mut self.units;
        for (channel, Column { quantity, unit, .. }) in channels.into_iter().zip(columns) {
            match quantity {
                Channel::Time => (self.time, units.time) = (channel, unit),
                Channel::Displacement => {
                    (self.displacement, units.displacement) = (channel, unit);
                }
                Channel::Force => (self.force, units.force) = (channel, unit),
                Channel::Velocity => (self.velocity, units.velocity) = (Some(channel), unit),
                Channel::Temperature => {
                    (self.temperature, units.temperature) = (Some(channel), unit);
                }
            }
        }
    }
}

/// A column of a control input while it is read.
struct InputColumn {
    index: usize,
    /// What it was last; NaN before it was first written.
    now: f64,
    values: Vec<f64>,
    /// Every cell was a number or blank: else it is a column of another kind, which is not looked at.
    is_number: bool,
}

impl InputColumn {
    fn at(index: usize) -> Self {
        Self {
            index,
            now: f64::NAN,
            values: Vec::new(),
            is_number: true,
        }
    }

    fn see(&mut self, row: &csv::StringRecord) {
        let cell = row.get(self.index).unwrap_or_default();
        if is_blank_cell(cell) {
            return;
        }
        match number(cell) {
            Ok(value) => self.now = value,
            Err(_) => self.is_number = false,
        }
    }

    fn keep(&mut self) {
        grow(&mut self.values);
        self.values.push(self.now);
    }

    /// Before it was first written it was as it was then; of one that never was, nothing is known.
    fn channel(mut self, header: &csv::StringRecord) -> Option<ControlChannel> {
        let first = self.values.iter().position(|value| !value.is_nan())?;
        let (before, since) = self.values.split_at_mut(first);
        before.fill(since[0]);
        let name = header.get(self.index).unwrap_or_default().to_owned();
        self.is_number.then_some(ControlChannel {
            name,
            values: self.values,
        })
    }
}

/// Makes room for one more value: a quarter more than there is. Twice as much, as a vector takes by itself, is all that a file of
/// short rows may take.
fn grow(channel: &mut Vec<f64>) {
    if channel.len() == channel.capacity() {
        channel.reserve_exact((channel.len() / 4).max(1024));
    }
}

/// What is kept of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kept {
    /// Its channels.
    Channels,
    /// These, and all cells as they are written, so that they can be written again.
    Cells,
}

/// A column that is used.
pub(super) struct Column {
    pub index: usize,
    pub quantity: Channel,
    pub unit: Unit,
}

impl Column {
    /// Whether a logger may have had nothing to write in some rows.
    pub fn may_be_blank(&self) -> bool {
        matches!(self.quantity, Channel::Displacement | Channel::Force)
    }
}

/// The columns that are used.
pub(super) struct Columns {
    /// At most one of each quantity.
    pub used: Vec<Column>,
    /// Where control inputs stand.
    pub controls: Vec<usize>,
}

impl Columns {
    pub fn find(
        file: &str,
        header: &csv::StringRecord,
        needed: &impl Fn(Channel) -> bool,
    ) -> Result<Self, InputError> {
        let fail = |column: &str, problem: String, mend: String| {
            InputError::new(file, problem, mend).at(Place::Column(column.into()))
        };
        if header.iter().any(|cell| number(cell).is_ok()) {
            return Err(InputError::new(
                file,
                "there is no header, the first row holds numbers",
                "write a header such as time_s,displacement_mm,force_kN above it",
            )
            .at(Place::Line(
                header.position().map_or(1, csv::Position::line),
            )));
        }
        if let Some((name, first, second)) = doubled(header) {
            return Err(fail(
                name,
                format!(
                    "the name stands in columns {} and {}",
                    first + 1,
                    second + 1
                ),
                "give every column its own name".into(),
            ));
        }
        let mut used: Vec<Column> = Vec::new();
        for (index, name) in header.iter().enumerate() {
            let Some((quantity, symbol)) = quantity_of(name) else {
                continue;
            };
            let unit = quantity
                .units()
                .iter()
                .find(|unit| unit.symbol == symbol)
                .ok_or_else(|| {
                    let problem = if symbol.is_empty() {
                        "the name carries no unit".into()
                    } else {
                        format!("unknown unit {}", quoted(symbol))
                    };
                    fail(
                        name,
                        problem,
                        format!("use one of {}", quantity.column_names()),
                    )
                })?;
            if let Some(other) = used.iter().find(|other| other.quantity == quantity) {
                let other = header.get(other.index).unwrap_or_default();
                return Err(fail(
                    name,
                    format!("{other} is a {} too", quantity.name()),
                    "keep one of them, or rename the other".into(),
                ));
            }
            used.push(Column {
                index,
                quantity,
                unit: *unit,
            });
        }
        for quantity in Channel::ALL.into_iter().filter(|&q| needed(q)) {
            if !used.iter().any(|column| column.quantity == quantity) {
                let found: Vec<&str> = header.iter().collect();
                return Err(InputError::new(
                    file,
                    format!(
                        "there is no {} column; found {}",
                        quantity.name(),
                        quoted_list(&found)
                    ),
                    format!("name one of them {}", quantity.column_names()),
                )
                .at(Place::Line(
                    header.position().map_or(1, csv::Position::line),
                )));
            }
        }
        let controls = header.iter().enumerate();
        let controls = controls.filter(|(_, name)| is_control(name));
        Ok(Self {
            used,
            controls: controls.map(|(index, _)| index).collect(),
        })
    }
}

fn quoted_list(names: &[&str]) -> String {
    const MOST: usize = 12;
    let mut shown: Vec<String> = names.iter().take(MOST).map(|name| quoted(name)).collect();
    if names.len() > MOST {
        shown.push(format!("and {} more", names.len() - MOST));
    }
    shown.join(", ")
}

/// The quantity and the unit's symbol that a column's name says; `None` for a column that is ignored.
///
/// A further word between the two, as in `force_command_kN`, makes it another column.
fn quantity_of(name: &str) -> Option<(Channel, &str)> {
    let quantity = Channel::ALL
        .into_iter()
        .find(|quantity| name.starts_with(quantity.name()))?;
    let rest = &name[quantity.name().len()..];
    if rest.is_empty() {
        return Some((quantity, ""));
    }
    let symbol = rest.strip_prefix('_')?;
    let known = quantity.units().iter().any(|unit| unit.symbol == symbol);
    (known || !symbol.contains('_')).then_some((quantity, symbol))
}
