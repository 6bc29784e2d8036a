//! The variables of MATLAB v7.3, which stores them in HDF5 in its own way.

use std::collections::HashMap;
use std::sync::Arc;

use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Attribute, Dataset, Datatype};

use super::cells::cell;
use super::walk::short;
use crate::files::mat::{Broken, Bytes, Numbers, Tree, Value};

/// The attribute with a variable's class.
const CLASS: &str = "MATLAB_class";
/// The deepest nesting of structures, as in the versions before.
const DEEPEST: usize = 32;

/// Why a file cannot be read.
pub(super) enum Refused {
    File(Error),
    TooLarge,
    Broken(Broken),
}

impl From<Error> for Refused {
    fn from(error: Error) -> Self {
        Self::File(error)
    }
}

/// Whether a file without MATLAB's first line still contains its variables.
pub(super) fn wrote(root: &Group) -> bool {
    let Ok((groups, datasets)) = root.members() else {
        return false;
    };
    let mut groups = groups.iter();
    let mut datasets = datasets.iter();
    datasets.any(|each| each.attribute(CLASS).is_ok())
        || groups.any(|each| each.attribute(CLASS).is_ok())
}

/// The variables of a file, of which at most `most` bytes are read.
pub(super) fn tree(root: &Group, most: u64) -> Result<Tree, Refused> {
    let (groups, datasets) = root.members()?;
    let mut reader = Reader {
        references: HashMap::new(),
        left: most,
        depth: DEEPEST,
    };
    // Objects to which cells and elements of structures refer.
    if let Some(group) = groups.iter().find(|group| short(group.name()) == "#refs#") {
        let (groups, datasets) = group.members()?;
        let groups = groups
            .into_iter()
            .map(|each| (each.address(), Member::Group(each)));
        let datasets = datasets.into_iter();
        let datasets = datasets.map(|each| (each.address(), Member::Dataset(Box::new(each))));
        reader.references = groups
            .chain(datasets)
            .map(|(at, each)| (at, Arc::new(each)))
            .collect();
    }
    let mut tree = Tree::new();
    for dataset in &datasets {
        let value = reader.dataset(dataset)?;
        tree.take(&[], short(dataset.name()), value)
            .map_err(Refused::Broken)?;
    }
    for group in groups.iter().filter(|group| !group.name().contains('#')) {
        let value = reader.group(group)?;
        tree.take(&[], short(group.name()), value)
            .map_err(Refused::Broken)?;
    }
    Ok(tree)
}

enum Member {
    Group(Group),
    Dataset(Box<Dataset>),
}

struct Reader {
    references: HashMap<u64, Arc<Member>>,
    /// Bytes that may still be read.
    left: u64,
    /// Remaining depth of structures and references.
    depth: usize,
}

impl Reader {
    fn deeper<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<T, Refused>,
    ) -> Result<T, Refused> {
        let too_deep = Refused::Broken(Broken("structures are nested too deeply"));
        self.depth = self.depth.checked_sub(1).ok_or(too_deep)?;
        let done = read(self);
        self.depth += 1;
        done
    }

    /// A structure, or a value stored like one.
    fn group(&mut self, group: &Group) -> Result<Value, Refused> {
        let class = group.attribute(CLASS).ok().and_then(|class| text(&class));
        if group.attribute("MATLAB_sparse").is_ok() {
            return Ok(Value::Other("a sparse matrix".into()));
        }
        if let Some(class) = class.filter(|class| class != "struct") {
            return Ok(Value::Other(format!("an object of class {class}")));
        }
        let (groups, datasets) = group.members()?;
        self.deeper(|reader| {
            let mut several: Vec<(String, Vec<Value>)> = Vec::new();
            let mut fields = Vec::new();
            for dataset in &datasets {
                let name = short(dataset.name()).to_owned();
                // A field of each element of an array of structures.
                let is_of_all = matches!(dataset.dtype(), Datatype::Reference { .. })
                    && dataset.attribute(CLASS).is_err();
                if is_of_all {
                    several.push((name, reader.referred(dataset)?));
                } else {
                    fields.push((name, reader.dataset(dataset)?));
                }
            }
            for group in &groups {
                fields.push((short(group.name()).to_owned(), reader.group(group)?));
            }
            let count = several.iter().map(|(_, values)| values.len()).max();
            let mut elements: Vec<Vec<(String, Value)>> = Vec::new();
            elements.resize_with(count.unwrap_or(1), Vec::new);
            for (name, values) in several {
                for (element, value) in elements.iter_mut().zip(values) {
                    element.push((name.clone(), value));
                }
            }
            if let Some(first) = elements.first_mut() {
                first.extend(fields);
            }
            Ok(Value::Structure(elements))
        })
    }

    fn dataset(&mut self, dataset: &Dataset) -> Result<Value, Refused> {
        let class = dataset.attribute(CLASS).ok().and_then(|class| text(&class));
        let class = class.unwrap_or_default();
        if dataset.attribute("MATLAB_empty").is_ok() {
            return Ok(Value::Other("empty".into()));
        }
        match (class.as_str(), dataset.dtype()) {
            ("cell", Datatype::Reference { .. }) => {
                self.deeper(|reader| Ok(Value::Cell(reader.referred(dataset)?)))
            }
            (_, Datatype::Compound { .. }) => Ok(Value::Other("complex numbers".into())),
            ("" | "char" | "logical" | "single" | "double", of) => {
                self.numbers(dataset, of, class == "char")
            }
            (class, of) if class.contains("int") => self.numbers(dataset, of, false),
            (class, _) => Ok(Value::Other(format!("an object of class {class}"))),
        }
    }

    fn numbers(
        &mut self,
        dataset: &Dataset,
        of: &Datatype,
        is_text: bool,
    ) -> Result<Value, Refused> {
        let Some(cell) = cell(of) else {
            return Ok(Value::Other("no numbers".into()));
        };
        let bytes = self.bytes(dataset)?;
        let bytes = Bytes::new(Arc::new(bytes), 0, cell.is_little);
        let numbers = Numbers {
            kind: cell.kind,
            bytes,
        };
        // MATLAB stores columns one after the other, HDF5 rows.
        let mut dimensions = Vec::new();
        for &size in dataset.shape().iter().rev() {
            let size = usize::try_from(size).map_err(|_| Refused::TooLarge)?;
            dimensions.push(size);
        }
        Ok(if is_text {
            Value::Text(crate::files::mat::rows_of_text(
                &numbers.text(),
                &dimensions,
            ))
        } else {
            Value::Numbers(dimensions, numbers)
        })
    }

    /// The values to which a data set of references points.
    fn referred(&mut self, dataset: &Dataset) -> Result<Vec<Value>, Refused> {
        let size = dataset.raw_element_size()?;
        let bytes = self.bytes(dataset)?;
        let mut values = Vec::new();
        for reference in bytes.chunks_exact(size.max(1)) {
            let address = reference
                .first_chunk::<8>()
                .map(|word| u64::from_le_bytes(*word));
            let member = address.and_then(|address| self.references.get(&address).cloned());
            values.push(match member.as_deref() {
                Some(Member::Dataset(dataset)) => self.deeper(|reader| reader.dataset(dataset))?,
                Some(Member::Group(group)) => self.deeper(|reader| reader.group(group))?,
                None => Value::Other("a reference to nothing".into()),
            });
        }
        Ok(values)
    }

    fn bytes(&mut self, dataset: &Dataset) -> Result<Vec<u8>, Refused> {
        let length = dataset.raw_byte_len()? as u64;
        // A value costs memory, however few bytes it has.
        const COST: u64 = 256;
        let left = self.left.checked_sub(length.saturating_add(COST));
        self.left = left.ok_or(Refused::TooLarge)?;
        Ok(dataset.read_raw_bytes()?)
    }
}

fn text(attribute: &Attribute) -> Option<String> {
    attribute.read_string().ok()
}
