//! The variables of MATLAB v7.3, which stores them in HDF5 in its own way.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use hdf5_reader::Datatype;
use hdf5_reader::messages::HdfMessage;

use super::attributes::{Texts, text};
use super::cells::cell;
use super::data::{Data, Raw};
use super::file::File;
use super::links::Links;
use crate::files::DEEPEST;
use crate::files::groups::Group as Place;
use crate::files::mat::{self, Bytes, Numbers, Tree, Value};
use crate::files::refused::Refused;
use crate::room::Room;

const PART: &str = "its variables";
/// The attribute with a variable's class.
const CLASS: &str = "MATLAB_class";

/// Whether a file without MATLAB's first line still contains its variables.
pub(super) fn wrote(file: &File) -> Result<bool, Refused> {
    let mut reader = Reader::new(file);
    let mut has_class = false;
    for (_, address) in reader.links.members(file.root)? {
        if reader.linked.insert(address) {
            reader.hold(2 * size_of::<u64>() as u64)?;
            has_class = reader.marks(file.header(address)?)?.class.is_some();
        }
        if has_class {
            break;
        }
    }
    Ok(has_class)
}

/// The variables of a file.
pub(super) fn tree(file: &File) -> Result<Tree, Refused> {
    let mut reader = Reader::new(file);
    let mut tree = Tree::new(Rc::clone(&file.budget));
    let members = reader.links.members(file.root)?;
    // Objects to which cells and elements of structures refer.
    if let Some((_, refs)) = members.iter().find(|(name, _)| &**name == "#refs#") {
        let objects = reader.links.members(*refs)?;
        reader.referable = objects.into_iter().map(|(_, address)| address).collect();
    }
    let members = members.into_iter().filter(|(name, _)| !name.contains('#'));
    for (name, field) in reader.values(members.collect())? {
        let value = match field {
            Field::One(value) => value,
            Field::OfAll(values) => Value::Cell(values),
        };
        tree.take(Place::FILE, &name, value)?;
    }
    Ok(tree)
}

/// The names of a group's members, and their addresses.
type Members = Vec<(Rc<str>, u64)>;

/// What is held for a value, without its numbers and names.
const OF_VALUE: u64 = 2 * size_of::<(Rc<str>, Value)>() as u64;

struct Reader<'f> {
    file: &'f File,
    links: Links<'f>,
    texts: Texts<'f>,
    /// The addresses of objects to which references may point.
    referable: HashSet<u64>,
    /// The addresses of objects to which links led, which are not read again.
    linked: HashSet<u64>,
    /// Bytes of data sets that were read.
    read: HashMap<u64, Bytes>,
    /// Data sets to which references led; those to which a second one led are kept, because all empty cells are one of them.
    referred: HashMap<u64, Option<Rc<Variable>>>,
    /// What the values take until the tree has taken them.
    room: Room<'f>,
    /// Remaining depth of structures and references.
    depth: usize,
}

/// A variable that is a data set.
struct Variable {
    data: Data,
    of: Datatype,
    marks: Marks,
}

/// What MATLAB says about a variable.
#[derive(Default)]
struct Marks {
    class: Option<String>,
    is_empty: bool,
    is_sparse: bool,
}

impl<'f> Reader<'f> {
    fn new(file: &'f File) -> Self {
        Self {
            file,
            links: Links::new(file),
            texts: Texts::new(file),
            referable: HashSet::new(),
            linked: HashSet::from([file.root]),
            read: HashMap::new(),
            referred: HashMap::new(),
            room: Room::of(&file.budget),
            depth: DEEPEST,
        }
    }

    fn deeper<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<T, Refused>,
    ) -> Result<T, Refused> {
        let deeper = self.depth.checked_sub(1);
        self.depth = deeper.ok_or("structures are nested too deeply")?;
        let done = read(self);
        self.depth += 1;
        done
    }

    /// Charges what is held until the tree has taken the values.
    fn hold(&mut self, bytes: u64) -> Result<(), Refused> {
        Ok(self.room.more(bytes, PART)?)
    }

    fn marks(&self, header: Vec<HdfMessage>) -> Result<Marks, Refused> {
        let mut marks = Marks::default();
        self.texts.attributes(header, |attribute| {
            match attribute.name.as_str() {
                CLASS => marks.class = text(&attribute),
                "MATLAB_empty" => marks.is_empty = true,
                "MATLAB_sparse" => marks.is_sparse = true,
                _ => {}
            }
            Ok(())
        })?;
        Ok(marks)
    }

    /// The members of a group: data sets, then groups. One to which another link led is not read again.
    fn values(&mut self, members: Members) -> Result<Vec<(Rc<str>, Field)>, Refused> {
        let mut values = Vec::new();
        let mut groups = Vec::new();
        for (name, address) in members {
            self.hold(OF_VALUE)?;
            if !self.linked.insert(address) {
                let value = Value::Other("a further name of another variable".into());
                values.push((name, Field::One(value)));
                continue;
            }
            let header = self.file.header(address)?;
            match self.variable(header)? {
                Ok(variable) => {
                    // A field of each element of an array of structures.
                    let is_of_all = matches!(variable.of, Datatype::Reference { .. })
                        && variable.marks.class.is_none();
                    let field = match is_of_all {
                        true => Field::OfAll(self.referred(&variable.data)?),
                        false => Field::One(self.dataset(address, &variable)?),
                    };
                    values.push((name, field));
                }
                Err(_) => groups.push((name, address)),
            }
        }
        for (name, address) in groups {
            let header = self.file.header(address)?;
            values.push((name, Field::One(self.group(address, header)?)));
        }
        Ok(values)
    }

    /// The variable with these messages; the messages if it is no data set.
    fn variable(
        &self,
        header: Vec<HdfMessage>,
    ) -> Result<Result<Variable, Vec<HdfMessage>>, Refused> {
        let Some((data, of)) = Data::of(self.file, &header)? else {
            return Ok(Err(header));
        };
        let marks = self.marks(header)?;
        Ok(Ok(Variable { data, of, marks }))
    }

    /// The object at an address to which a reference points.
    fn object(&mut self, address: u64) -> Result<Value, Refused> {
        if let Some(Some(known)) = self.referred.get(&address) {
            let known = known.clone();
            return self.dataset(address, &known);
        }
        let header = self.file.header(address)?;
        match self.variable(header)? {
            Ok(variable) => {
                let variable = Rc::new(variable);
                let is_known = self.referred.contains_key(&address);
                let size = match is_known {
                    true => variable.data.held() + size_of::<Variable>(),
                    false => 2 * size_of::<(u64, Option<Rc<Variable>>)>(),
                };
                self.file.budget.hold(size as u64, PART)?;
                let kept = is_known.then(|| variable.clone());
                self.referred.insert(address, kept);
                self.dataset(address, &variable)
            }
            Err(header) => self.group(address, header),
        }
    }

    /// A structure, or a value stored like one.
    fn group(&mut self, address: u64, header: Vec<HdfMessage>) -> Result<Value, Refused> {
        let marks = self.marks(header)?;
        if marks.is_sparse {
            return Ok(Value::Other("a sparse matrix".into()));
        }
        if let Some(class) = marks.class.filter(|class| class != "struct") {
            return Ok(Value::Other(format!("an object of class {class}").into()));
        }
        let members = self.links.members(address)?;
        self.deeper(|reader| {
            let mut elements: Vec<Vec<(Rc<str>, Value)>> = vec![Vec::new()];
            let mut fields = Vec::new();
            for (name, field) in reader.values(members)? {
                match field {
                    Field::One(value) => fields.push((name, value)),
                    Field::OfAll(values) => {
                        reader.hold(OF_VALUE * values.len() as u64)?;
                        let count = elements.len().max(values.len());
                        elements.resize_with(count, Vec::new);
                        for (element, value) in elements.iter_mut().zip(values) {
                            element.push((name.clone(), value));
                        }
                    }
                }
            }
            elements[0].extend(fields);
            Ok(Value::Structure(elements))
        })
    }

    fn dataset(&mut self, address: u64, variable: &Variable) -> Result<Value, Refused> {
        let Variable { data, of, marks } = variable;
        let class = marks.class.as_deref().unwrap_or_default();
        if marks.is_empty {
            return Ok(Value::Other("empty".into()));
        }
        match (class, of) {
            ("cell", Datatype::Reference { .. }) => {
                self.deeper(|reader| Ok(Value::Cell(reader.referred(data)?)))
            }
            (_, Datatype::Compound { .. }) => Ok(Value::Other("complex numbers".into())),
            ("" | "char" | "logical" | "single" | "double", of) => {
                self.numbers(address, data, of, class == "char")
            }
            (class, of) if class.contains("int") => self.numbers(address, data, of, false),
            (class, _) => {
                self.hold(class.len() as u64)?;
                Ok(Value::Other(format!("an object of class {class}").into()))
            }
        }
    }

    fn numbers(
        &mut self,
        address: u64,
        data: &Data,
        of: &Datatype,
        is_text: bool,
    ) -> Result<Value, Refused> {
        let Some(cell) = cell(of) else {
            return Ok(Value::Other("no numbers".into()));
        };
        let bytes = match self.read.get(&address) {
            Some(bytes) => bytes.clone(),
            None => {
                let (bytes, _) = self.bytes(data)?;
                self.read.insert(address, bytes.clone());
                bytes
            }
        };
        let length = bytes.slice().len();
        let numbers = Numbers {
            kind: cell.kind,
            bytes: bytes.part(length, cell.is_little)?,
        };
        let length = length as u64;
        // MATLAB stores columns one after the other, HDF5 rows.
        let dimensions: Vec<usize> = data.shape.iter().rev().map(|&size| size as usize).collect();
        self.hold(8 * dimensions.len() as u64)?;
        if !is_text {
            return Ok(Value::Numbers(dimensions, numbers));
        }
        // As text, and in rows.
        self.hold(6 * length)?;
        self.file.budget.work(4 * length, PART)?;
        let text = mat::rows_of_text(numbers.text(), &dimensions);
        Ok(Value::Text(text))
    }

    /// The values to which a data set of references points.
    fn referred(&mut self, data: &Data) -> Result<Vec<Value>, Refused> {
        let (bytes, made) = self.bytes(data)?;
        let mut values = Vec::new();
        for reference in bytes.slice().chunks_exact(data.size.max(1)) {
            self.hold(OF_VALUE)?;
            let address = reference.first_chunk::<8>();
            let address = address.map(|word| u64::from_le_bytes(*word));
            let address = address.filter(|address| self.referable.contains(address));
            values.push(match address {
                Some(address) => self.deeper(|reader| reader.object(address))?,
                None => Value::Other("a reference to nothing".into()),
            });
        }
        self.file.budget.release(made);
        Ok(values)
    }

    /// The bytes of a data set, and how many of them were made and are charged as held.
    fn bytes(&self, data: &Data) -> Result<(Bytes, u64), Refused> {
        let raw = data.raw(self.file)?;
        let made = raw.held();
        let bytes = match raw {
            Raw::Made(bytes) => Bytes::new(bytes, 0, true),
            Raw::InFile(address, length) => {
                let length = usize::try_from(length).unwrap_or(usize::MAX);
                let part = self.file.from(address).part(length, true);
                part?
            }
        };
        Ok((bytes, made))
    }
}

/// A field of a structure.
enum Field {
    One(Value),
    /// Of each element of an array of structures.
    OfAll(Vec<Value>),
}
