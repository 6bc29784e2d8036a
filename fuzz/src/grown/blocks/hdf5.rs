//! HDF5: links to one object, headers, types and chunks; and the same as MATLAB writes it.

use super::seen;

/// A file of objects, each of which is known by its address.
struct File(Vec<u8>);

type Message = (u16, Vec<u8>);

fn words(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn link(name: &str, address: u64) -> Message {
    let head = [&[1, 1][..], &(name.len() as u16).to_le_bytes()].concat();
    (
        6,
        [&head[..], name.as_bytes(), &address.to_le_bytes()].concat(),
    )
}

/// A link to a path.
fn soft(name: &str, path: &str) -> Message {
    let head = [1, 8, 1, name.len() as u8];
    let path = [&(path.len() as u16).to_le_bytes(), path.as_bytes()].concat();
    (6, [&head[..], name.as_bytes(), &path].concat())
}

fn shape(sizes: &[u64]) -> Message {
    let head = [1, sizes.len() as u8, 0, 0, 0, 0, 0, 0];
    (1, [&head[..], &words(sizes)].concat())
}

/// Unsigned bytes.
const BYTE: [u8; 12] = [0x10, 0, 0, 0, 1, 0, 0, 0, 0, 0, 8, 0];
/// A type of one of these names, each with a value of two bytes.
fn names(count: usize) -> Message {
    let mut of = vec![0x18, count as u8, (count >> 8) as u8, 0, 2, 0, 0, 0];
    of.extend([0x10, 0, 0, 0, 2, 0, 0, 0, 0, 0, 16, 0]);
    (0..count).for_each(|_| of.extend(b"n\0\0\0\0\0\0\0"));
    of.resize(of.len() + 2 * count, 0);
    (3, of)
}

/// Values that lie in one piece.
fn contiguous(address: u64, length: u64) -> Message {
    (8, [&[3, 1][..], &words(&[address, length])].concat())
}

/// An attribute of one text.
fn said(name: &str, text: &str) -> Message {
    let of = [&[0x13, 0, 0, 0][..], &(text.len() as u32).to_le_bytes()].concat();
    let space = [2, 0, 0, 0];
    let sizes = [name.len() as u16 + 1, of.len() as u16, space.len() as u16];
    let head = [&[2, 0][..], &sizes.map(u16::to_le_bytes).concat()].concat();
    let name = [name.as_bytes(), &[0]].concat();
    (
        0xc,
        [&head[..], &name, &of, &space, text.as_bytes()].concat(),
    )
}

impl File {
    fn new() -> Self {
        Self(vec![0; 96])
    }

    /// Adds bytes, and returns their address.
    fn add(&mut self, bytes: &[u8]) -> u64 {
        self.0.resize(self.0.len().next_multiple_of(8), 0);
        let at = self.0.len() as u64;
        self.0.extend(bytes);
        at
    }

    fn object(&mut self, messages: &[Message]) -> u64 {
        let mut all = Vec::new();
        for (kind, message) in messages {
            let size = message.len().next_multiple_of(8);
            // A type that another object has is shared.
            let flags = u8::from(*kind == 3 && message.len() == 16) << 1;
            all.extend(kind.to_le_bytes());
            all.extend((size as u16).to_le_bytes());
            all.extend([flags, 0, 0, 0]);
            all.extend(message);
            all.resize(all.len() + size - message.len(), 0);
        }
        let mut header = vec![1, 0];
        header.extend((messages.len() as u16).to_le_bytes());
        header.extend(1_u32.to_le_bytes());
        header.extend((all.len() as u32).to_le_bytes());
        header.extend([0; 4]);
        self.add(&[header, all].concat())
    }

    /// A data set of bytes.
    fn bytes(&mut self, bytes: &[u8]) -> u64 {
        let at = self.add(bytes);
        let length = bytes.len() as u64;
        let of = (3, BYTE.to_vec());
        self.object(&[shape(&[length]), of, contiguous(at, length)])
    }

    /// The file with its root group.
    fn whole(mut self, root: u64) -> Vec<u8> {
        let mut head = b"\x89HDF\r\n\x1a\n\0\0\0\0\0\x08\x08\0".to_vec();
        head.extend([4, 0, 16, 0, 0, 0, 0, 0]);
        let end = self.0.len() as u64;
        head.extend(words(&[0, u64::MAX, end, u64::MAX, 0, root]));
        self.0[..head.len()].copy_from_slice(&head);
        self.0
    }
}

#[test]
fn a_data_set_of_many_links_is_one_array() {
    let mut file = File::new();
    let one = file.bytes(&[1, 2, 3]);
    let links: Vec<Message> = (0..500)
        .map(|index| link(&format!("y{index}"), one))
        .collect();
    let root = file.object(&links);
    let seen = seen(&file.whole(root), 0);
    assert_eq!(seen.names(), [["y0"]]);
    assert_eq!(seen.values[0], [1.0, 2.0, 3.0]);
    let said = "y1, y2, y3 and 496 more names (the same as y0)";
    assert_eq!(seen.tables()[0].skipped, [said]);
}

#[test]
fn the_times_of_several_groups_count_in_each() {
    let mut file = File::new();
    let times = file.bytes(&[1, 2, 4]);
    let later = file.bytes(&[5, 6, 8]);
    let group = |file: &mut File, times: u64, value: u8| {
        let values = file.bytes(&[value; 3]);
        file.object(&[link("time", times), link(&format!("y{value}"), values)])
    };
    let groups = [(times, 1), (later, 2), (times, 3), (later, 4)]
        .map(|(times, value)| group(&mut file, times, value));
    let names = ["a", "b", "c", "d"];
    let links: Vec<Message> = names
        .iter()
        .zip(groups)
        .map(|(name, at)| link(name, at))
        .collect();
    let root = file.object(&links);
    let seen = seen(&file.whole(root), 0);
    assert_eq!(seen.names(), [["time", "y1", "y3"], ["time", "y2", "y4"]]);
}

/// Groups that share times that were never written, each with its own values.
#[test]
fn the_first_times_of_many_tables_are_all_that_is_kept_of_them() {
    let mut file = File::new();
    let of = || (3, BYTE.to_vec());
    let mut links = Vec::new();
    for index in 0..40 {
        let unwritten = [shape(&[10_000]), of(), contiguous(u64::MAX, 0)];
        let [times, y] = [(); 2].map(|()| file.object(&unwritten));
        let own = file.bytes(&[index; 3]);
        let group = file.object(&[link("time", times), link("y", y), link("z", own)]);
        links.push(link(&format!("g{index}"), group));
    }
    let root = file.object(&links);
    let seen = seen(&file.whole(root), 0);
    assert_eq!(seen.tables()[0].columns[0].first, [0.0; 64]);
    // One column of times has 80 kB.
    assert!(seen.taken < 2_000_000, "{}", seen.taken);
}

#[test]
fn groups_that_lead_to_each_other_are_visited_once() {
    let mut file = File::new();
    let one = file.bytes(&[1, 2, 3]);
    // Three ways to each group from the one above it: 3 to the 40th.
    let mut inner = file.object(&[link("y", one)]);
    for _ in 0..40 {
        inner = file.object(&["a", "b", "c"].map(|name| link(name, inner)));
    }
    // Paths that lead on through the next, and in a circle.
    let mut next = file.object(&[link("z", one)]);
    for _ in 0..8 {
        let onward = ["a", "b", "c"].map(|name| soft(name, "n/a/b/c"));
        let links = [&onward[..], &[link("n", next)]].concat();
        next = file.object(&links);
    }
    let circle = [
        soft("p", "/q"),
        soft("q", "/p"),
        soft("r", "/"),
        soft("s", "/deep"),
    ];
    let links = [&circle[..], &[link("deep", inner), link("paths", next)]].concat();
    let root = file.object(&links);
    let seen = seen(&file.whole(root), 0);
    assert_eq!(seen.values[0], [1.0, 2.0, 3.0]);
    assert_eq!(seen.names().concat().len(), 1);
    assert!(seen.used.1 < 100_000, "{:?}", seen.used);

    let mut file = File::new();
    let one = file.bytes(&[1, 2, 3]);
    let deep = (0..500).fold(one, |inner, _| file.object(&[link("g", inner)]));
    let root = file.object(&[link("y", one), link("g", deep)]);
    let seen = super::seen(&file.whole(root), 0);
    assert!(
        seen.error().contains("nested more than 64 deep"),
        "{}",
        seen.error()
    );
}

#[test]
fn variables_of_matlab_are_visited_once_too() {
    let mut file = File::new();
    let values = file.add(&[1, 2, 3]);
    let class = |class: &str| said("MATLAB_class", class);
    let of = (3, BYTE.to_vec());
    let numbers = [shape(&[1, 3]), of, contiguous(values, 3), class("uint8")];
    let one = file.object(&numbers);
    let mut inner = file.object(&[link("y", one), class("struct")]);
    for _ in 0..25 {
        let links = ["a", "b", "c"].map(|name| link(name, inner));
        inner = file.object(&[&links[..], &[class("struct")]].concat());
    }
    let at = file.add(&[]);
    let itself = file.object(&[class("struct"), link("s", at)]);
    let root = file.object(&[link("t", one), link("top", inner), link("self", itself)]);
    let seen = seen(&file.whole(root), 0);
    assert_eq!(seen.names(), [["t"]]);
    assert_eq!(seen.values[0], [1.0, 2.0, 3.0]);
    assert!(seen.used.1 < 100_000, "{:?}", seen.used);

    // Cells, each of which refers to the next ten times.
    let mut file = File::new();
    let values = file.add(&[1, 2, 3]);
    let of = || (3, BYTE.to_vec());
    let mut cell = file.object(&[shape(&[1, 3]), of(), contiguous(values, 3), class("uint8")]);
    let mut objects = vec![link("last", cell)];
    let y = cell;
    for level in 0..12 {
        let at = file.add(&words(&[cell; 10]));
        let reference = (3, vec![0x17, 0, 0, 0, 8, 0, 0, 0]);
        cell = file.object(&[
            shape(&[1, 10]),
            reference,
            contiguous(at, 80),
            class("cell"),
        ]);
        objects.push(link(&format!("c{level}"), cell));
    }
    let refs = file.object(&objects);
    let root = file.object(&[link("y", y), link("#refs#", refs), link("top", cell)]);
    super::seen(&file.whole(root), 0).refused_for("its variables");
}

#[test]
fn a_type_is_not_copied_for_each_link_or_data_set() {
    let mut file = File::new();
    let at = file.add(&[0; 20]);
    let one = file.object(&[shape(&[10]), names(1000), contiguous(at, 20)]);
    let links: Vec<Message> = (0..500)
        .map(|index| link(&format!("e{index}"), one))
        .collect();
    let root = file.object(&links);
    let read = seen(&file.whole(root), 0);
    assert_eq!(read.names(), [["e0"]]);
    assert!(read.used.1 < 400_000, "{:?}", read.used);

    // Data sets with a type that another object has.
    let mut file = File::new();
    let of = file.object(&[names(1000)]);
    let at = file.add(&[0; 20]);
    let shared = (
        3,
        [&[1, 0, 0, 0, 0, 0, 0, 0][..], &of.to_le_bytes()].concat(),
    );
    let links: Vec<Message> = (0..1000)
        .map(|index| {
            let each = file.object(&[shape(&[10]), shared.clone(), contiguous(at, 20)]);
            link(&format!("e{index}"), each)
        })
        .collect();
    let few = file.object(&links[..2]);
    let all = file.object(&links);
    let (few, all) = (File(file.0.clone()).whole(few), file.whole(all));
    assert_eq!(seen(&few, 0).names(), [["e0", "e1"]]);
    seen(&all, 0).refused_for("the headers of its objects");
}

#[test]
fn headers_of_nothing_take_no_more_than_the_budget() {
    let mut file = File::new();
    let one = file.bytes(&[1, 2, 3]);
    let nothing = vec![(0, Vec::new()); 60_000];
    let links: Vec<Message> = (0..20)
        .map(|index| link(&format!("n{index}"), file.object(&nothing)))
        .chain([link("y", one)])
        .collect();
    let root = file.object(&links);
    assert_eq!(seen(&file.whole(root), 0).names(), [["y"]]);
}

#[test]
fn sizes_that_the_file_does_not_have_are_not_believed() {
    let undefined = u64::MAX;
    let of = || (3, BYTE.to_vec());
    let with = |name: &str, sizes: &[u64]| {
        let mut file = File::new();
        let y = file.bytes(&[1, 2, 3]);
        let huge = [shape(sizes), of(), contiguous(undefined, 0)];
        let (huge, other) = (file.object(&huge), file.object(&huge));
        let root = file.object(&[link(name, huge), link("y", y), link("x", other)]);
        seen(&file.whole(root), 0)
    };
    assert_eq!(with("z", &[100]).values[0], [0.0; 100]);
    with("z", &[1 << 40]).refused_for("the values of its data sets");
    with("z", &[1 << 30, 1000]).refused_for("the values of its data sets");
}

#[test]
fn attributes_take_what_they_have() {
    // A long name before each line of a text.
    let mut file = File::new();
    let y = file.bytes(&[1, 2, 3]);
    let notes = said(&"n".repeat(2000), &"a\n".repeat(2000));
    let root = file.object(&[link("y", y), notes]);
    seen(&file.whole(root), 0).refused_for("the names of its columns");
    // A statement of each attribute about each column.
    let mut file = File::new();
    let at = file.add(&[0; 1 << 20]);
    let factor = |index: usize| {
        let name = format!("scale{index}");
        let sizes = [name.len() as u16 + 1, BYTE.len() as u16, 4].map(u16::to_le_bytes);
        let head = [&[2, 0][..], &sizes.concat()].concat();
        let body = [name.as_bytes(), &[0], &BYTE, &[2, 0, 0, 0, 7]].concat();
        (0xc, [head, body].concat())
    };
    let mut messages = vec![
        shape(&[1024, 1024]),
        (3, BYTE.to_vec()),
        contiguous(at, 1 << 20),
    ];
    messages.extend((0..500).map(factor));
    let wide = file.object(&messages);
    let root = file.object(&[link("m", wide)]);
    let seen = seen(&file.whole(root), 0);
    assert!(seen.error().contains("--max-read"), "{}", seen.error());
}
