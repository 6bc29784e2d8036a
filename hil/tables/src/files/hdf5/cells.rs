//! The numbers in a data set's elements.

use hdf5_reader::Datatype;
use hdf5_reader::error::ByteOrder;

use super::data::{Data, Raw};
use super::file::File;
use crate::budget::of_list;
use crate::files::arrays::Located;
use crate::files::number::Kind;
use crate::files::refused::Refused;

/// A number in each element of a data set.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Its position in the element, bytes.
    pub at: usize,
    pub kind: Kind,
    pub is_little: bool,
}

/// Values of a column: a number in every `step`th element of a data set.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub dataset: usize,
    pub cell: Cell,
    pub first: usize,
    pub step: usize,
    pub count: usize,
    /// Factor and offset stated in the file.
    pub scale: Option<(f64, f64)>,
    /// The number for a missing value.
    pub fill: Option<f64>,
}

impl Located for Place {
    fn key(&self) -> [usize; 4] {
        [self.dataset, self.first, self.step, self.cell.at]
    }
}

/// Data sets, the last of which is kept for its next column.
pub(super) struct Datasets {
    file: File,
    all: Vec<Data>,
    last: Option<(usize, Raw)>,
}

impl Datasets {
    pub fn new(file: File, all: Vec<Data>) -> Self {
        Self {
            file,
            all,
            last: None,
        }
    }

    /// The values of a column. They are charged as held.
    pub fn values(&mut self, place: &Place) -> Result<Vec<f64>, Refused> {
        const PART: &str = "the values of its columns";
        let (file, data) = (&self.file, &self.all[place.dataset]);
        if self
            .last
            .as_ref()
            .is_none_or(|(index, _)| *index != place.dataset)
        {
            let before = self.last.take();
            file.budget.release(before.map_or(0, |(_, raw)| raw.held()));
            self.last = Some((place.dataset, data.raw(file)?));
        }
        let bytes = match &self.last {
            Some((_, raw)) => raw.bytes(file)?,
            None => &[],
        };
        file.budget.hold(of_list::<f64>(place.count), PART)?;
        file.budget.work(place.count as u64, PART)?;
        let cell = &place.cell;
        let places =
            (0..place.count).map(|index| (place.first + index * place.step) * data.size + cell.at);
        let mut values = Vec::with_capacity(place.count);
        (cell.kind).read_each(bytes, places, cell.is_little, |value| {
            values.push(match (place.fill, place.scale) {
                (Some(fill), _) if value == fill => f64::NAN,
                (_, Some((factor, offset))) => value * factor + offset,
                (_, None) => value,
            });
        });
        Ok(values)
    }
}

/// The numeric type; `None` for a text or a reference.
pub(super) fn cell(of: &Datatype) -> Option<Cell> {
    let (kind, order) = match of {
        Datatype::FixedPoint {
            size,
            signed,
            byte_order,
        } => (Kind::integer(usize::from(*size), *signed)?, byte_order),
        Datatype::Bitfield { size, byte_order } => {
            (Kind::integer(usize::from(*size), false)?, byte_order)
        }
        Datatype::FloatingPoint { size, byte_order } => {
            (Kind::float(usize::from(*size))?, byte_order)
        }
        // h5py's representation of booleans.
        Datatype::Enum { base, .. } => return cell(base),
        _ => return None,
    };
    Some(Cell {
        at: 0,
        kind,
        is_little: matches!(order, ByteOrder::LittleEndian),
    })
}
