//! The numbers in a data set's elements.

use std::sync::Arc;

use hdf5_reader::error::{ByteOrder, Error};
use hdf5_reader::{Dataset, Datatype};

use crate::files::number::Kind;

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

/// Data sets, the last of which is kept for its next column.
pub(super) struct Datasets {
    all: Vec<Dataset>,
    last: Option<(usize, Arc<Vec<u8>>)>,
}

impl Datasets {
    pub fn new(all: Vec<Dataset>) -> Self {
        Self { all, last: None }
    }

    pub fn values(&mut self, place: &Place) -> Result<Vec<f64>, Error> {
        let dataset = &self.all[place.dataset];
        let bytes = match &self.last {
            Some((index, bytes)) if *index == place.dataset => bytes.clone(),
            _ => {
                self.last = None;
                let bytes = Arc::new(dataset.read_raw_bytes()?);
                self.last = Some((place.dataset, bytes.clone()));
                bytes
            }
        };
        let size = dataset.raw_element_size()?;
        let cell = &place.cell;
        let value = |index: usize| {
            let at = (place.first + index * place.step) * size + cell.at;
            let value = cell.kind.read(&bytes, at, cell.is_little);
            match (place.fill, place.scale) {
                (Some(fill), _) if value == fill => f64::NAN,
                (_, Some((factor, offset))) => value * factor + offset,
                (_, None) => value,
            }
        };
        Ok((0..place.count).map(value).collect())
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
