//! MDF: links between blocks, texts and conversions that many share, lists of data.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::seen;

/// A file of blocks, each of which is known by the link to it.
struct File(Vec<u8>);

fn words(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// A channel's description, without links.
#[derive(Clone, Copy, Default)]
struct Field {
    kind: u8,
    is_time: bool,
    data_type: u8,
    at: u32,
    bits: u32,
}

/// A byte of a record.
const BYTE: Field = Field {
    kind: 0,
    is_time: false,
    data_type: 0,
    at: 0,
    bits: 8,
};
/// The times of a group, as floats.
const TIME: Field = Field {
    kind: 2,
    is_time: true,
    data_type: 4,
    at: 0,
    bits: 64,
};

impl File {
    fn new() -> Self {
        let mut bytes = b"MDF     4.10    test    \0\0\0\0".to_vec();
        bytes.extend(410_u16.to_le_bytes());
        // The header comes last.
        bytes.resize(64 + 104, 0);
        Self(bytes)
    }

    fn add(&mut self, name: &[u8; 2], links: &[u64], data: &[u8]) -> u64 {
        self.0.resize(self.0.len().next_multiple_of(8), 0);
        let at = self.0.len() as u64;
        self.0.extend([&b"##"[..], name].concat());
        self.0.extend([0; 4]);
        let length = 24 + 8 * links.len() + data.len();
        self.0.extend(words(&[length as u64, links.len() as u64]));
        self.0.extend(words(links));
        self.0.extend(data);
        at
    }

    fn link(&mut self, block: u64, index: usize, to: u64) {
        let at = block as usize + 24 + 8 * index;
        self.0[at..at + 8].copy_from_slice(&to.to_le_bytes());
    }

    fn text(&mut self, text: &str) -> u64 {
        self.add(b"TX", &[], &[text.as_bytes(), &[0]].concat())
    }

    /// A channel with its name, its conversion, its parts, and the channel after it.
    fn channel(&mut self, field: Field, name: u64, conversion: u64, parts: u64, next: u64) -> u64 {
        let mut data = vec![field.kind, u8::from(field.is_time), field.data_type, 0];
        data.extend([field.at, field.bits].map(u32::to_le_bytes).concat());
        data.resize(72, 0);
        self.add(b"CN", &[next, parts, name, 0, conversion, 0, 0, 0], &data)
    }

    /// A group of channels with the number of its records, their length, and the group after it.
    fn group(&mut self, channel: u64, number: u64, samples: u64, bytes: u32, next: u64) -> u64 {
        let mut data = words(&[number, samples, 0]);
        data.extend([bytes, 0].map(u32::to_le_bytes).concat());
        self.add(b"CG", &[next, channel, 0, 0, 0, 0], &data)
    }

    /// A group of data with the bytes of a record's number, and the group after it.
    fn data(&mut self, group: u64, records: u64, width: u8, next: u64) -> u64 {
        let data = [width, 0, 0, 0, 0, 0, 0, 0];
        self.add(b"DG", &[next, group, records, 0], &data)
    }

    fn records(&mut self, bytes: &[u8]) -> u64 {
        self.add(b"DT", &[], bytes)
    }

    /// Packed records that claim to be `size` bytes.
    fn packed(&mut self, bytes: &[u8], size: u64) -> u64 {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(bytes).unwrap();
        let packed = encoder.finish().unwrap();
        let head = [
            b"DT\0\0\0\0\0\0".to_vec(),
            words(&[size, packed.len() as u64]),
        ]
        .concat();
        self.add(b"DZ", &[], &[head, packed].concat())
    }

    fn conversion(&mut self, kind: u8, links: &[u64], values: &[f64]) -> u64 {
        let mut data = vec![kind, 0, 0, 0];
        data.extend(
            [links.len() as u16, values.len() as u16]
                .map(u16::to_le_bytes)
                .concat(),
        );
        data.extend([0; 16]);
        values
            .iter()
            .for_each(|value| data.extend(value.to_le_bytes()));
        self.add(b"CC", &[&[0; 4], links].concat(), &data)
    }

    /// The file from its first group of data on, with a comment and a hierarchy.
    fn whole(mut self, data: u64, comment: u64, hierarchy: u64) -> Vec<u8> {
        let mut header = b"##HD\0\0\0\0".to_vec();
        header.extend(words(&[104, 6, data, 0, hierarchy, 0, 0, comment]));
        self.0[64..64 + header.len()].copy_from_slice(&header);
        self.0
    }

    /// The file with one group of these channels, and ten records of some bytes.
    fn of(mut self, channel: u64, bytes: u32) -> Vec<u8> {
        let group = self.group(channel, 0, 10, bytes, 0);
        let records: Vec<u8> = (0..10 * bytes).map(|at| at as u8).collect();
        let records = self.records(&records);
        let data = self.data(group, records, 0, 0);
        self.whole(data, 0, 0)
    }
}

#[test]
fn a_text_is_read_once_and_to_its_own_end() {
    // Heads of texts, none of which belongs to a channel.
    let mut file = File::new();
    let name = file.text("force");
    let one = file.channel(BYTE, name, 0, 0, 0);
    let mut bytes = file.of(one, 1);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes.extend(b"##TX\0\0\0\0".repeat(100_000));
    let read = seen(&bytes, 0);
    assert_eq!(read.names(), [["force"]]);
    assert_eq!(
        read.values[0],
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
    );
    assert!(read.used.1 < 1000, "{:?}", read.used);
    // One long name of many channels, whose columns each have it.
    let shared = |length: usize, channels: usize| {
        let mut file = File::new();
        let name = file.text(&"c".repeat(length));
        let next = (0..channels).fold(0, |next, _| file.channel(BYTE, name, 0, 0, next));
        seen(&file.of(next, 1), 0)
    };
    assert_eq!(shared(100, 50).names()[0].len(), 50);
    shared(100_000, 500).refused_for("its arrays");
}

#[test]
fn lists_that_several_groups_share_are_refused() {
    let shared = |channels: usize, groups: usize, datas: usize| {
        let mut file = File::new();
        let name = file.text("c");
        let channel = (0..channels).fold(0, |next, _| file.channel(BYTE, name, 0, 0, next));
        let group = (0..groups).fold(0, |next, _| file.group(channel, 0, 10, 1, next));
        let records = file.records(&[1; 10]);
        let data = (0..datas).fold(0, |next, _| file.data(group, records, 0, next));
        seen(&file.whole(data, 0, 0), 0)
    };
    assert_eq!(shared(2, 1, 1).names(), [["c", "c"]]);
    for (groups, datas, link) in [(1, 3, "cg_next"), (2, 1, "cn_next"), (60, 60, "cn_next")] {
        let seen = shared(60, groups, datas);
        assert!(seen.error().contains(link), "{}", seen.error());
        assert!(seen.used.1 < 10_000, "{:?}", seen.used);
    }
}

#[test]
fn links_that_form_a_circle_are_refused() {
    for (circle, index) in [
        ("dg_next", 0),
        ("cg_next", 0),
        ("cn_next", 0),
        ("cn_composition", 1),
    ] {
        let mut file = File::new();
        let name = file.text("c");
        let channel = file.channel(BYTE, name, 0, 0, 0);
        let group = file.group(channel, 0, 10, 1, 0);
        let records = file.records(&[1; 10]);
        let data = file.data(group, records, 0, 0);
        let block = match circle {
            "dg_next" => data,
            "cg_next" => group,
            _ => channel,
        };
        file.link(block, index, block);
        let seen = seen(&file.whole(data, 0, 0), 0);
        assert!(seen.error().contains(circle), "{}", seen.error());
    }
    // Parts of parts, each of which has two.
    let mut file = File::new();
    let name = file.text("c");
    let mut inner = 0;
    for _ in 0..25 {
        let second = file.channel(BYTE, name, 0, inner, 0);
        inner = file.channel(BYTE, name, 0, inner, second);
    }
    let seen = seen(&file.of(inner, 1), 0);
    assert!(seen.error().contains("cn_composition"), "{}", seen.error());
    assert!(seen.used.1 < 10_000, "{:?}", seen.used);
}

#[test]
fn conversions_are_built_once_and_cost_what_they_compute() {
    let mut file = File::new();
    let name = file.text("c");
    let mut conversion = file.conversion(1, &[], &[1.0, 2.0]);
    // Each of the entries of four tables is the table below it: 300 to the fourth.
    let keys: Vec<f64> = (0..300).map(f64::from).collect();
    for _ in 0..4 {
        conversion = file.conversion(7, &vec![conversion; 301], &keys);
    }
    let channel = (0..200).fold(0, |next, _| file.channel(BYTE, name, conversion, 0, next));
    let read = seen(&file.of(channel, 1), 0);
    assert_eq!(read.values[0][..3], [1.0, 3.0, 5.0]);
    assert!(
        read.used.0 < 400_000 && read.used.1 < 150_000,
        "{:?}",
        read.used
    );
    // A way back to itself leads to nothing.
    let mut file = File::new();
    let name = file.text("c");
    let conversion = file.conversion(7, &[0, 0], &[1.0]);
    file.link(conversion, 4, conversion);
    let channel = file.channel(BYTE, name, conversion, 0, 0);
    let seen = seen(&file.of(channel, 1), 0);
    assert!(seen.values[0].iter().all(|value| value.is_nan()));
}

#[test]
fn a_formula_costs_as_much_as_it_has_operations() {
    const ROWS: usize = 1_000_000;
    let mut file = File::new();
    let name = file.text("c");
    let text = file.text("X*0.0002-5");
    let conversion = file.conversion(3, &[text], &[]);
    let word = Field { bits: 16, ..BYTE };
    let channel = file.channel(word, name, conversion, 0, 0);
    let group = file.group(channel, 0, ROWS as u64, 2, 0);
    let records = file.records(&[16, 39].repeat(ROWS));
    let data = file.data(group, records, 0, 0);
    let seen = seen(&file.whole(data, 0, 0), 0);
    assert_eq!(seen.values[0], [-3.0; ROWS]);
}

#[test]
fn a_formula_beyond_the_stack_is_not_read() {
    let mut file = File::new();
    let name = file.text("c");
    let text = format!("{}X{}", "(".repeat(100_000), ")".repeat(100_000));
    let text = file.text(&text);
    let conversion = file.conversion(3, &[text], &[]);
    let plain = file.channel(BYTE, name, 0, 0, 0);
    let channel = file.channel(BYTE, name, conversion, 0, plain);
    let seen = seen(&file.of(channel, 1), 0);
    assert_eq!(seen.names(), [["c"]]);
    let skipped = &seen.tables()[0].skipped;
    assert_eq!(skipped, &["channel c (a formula of too many operations)"]);
}

#[test]
fn a_hierarchy_of_any_depth_is_none_of_the_readers_business() {
    let mut file = File::new();
    let name = file.text("c");
    let below = (0..20_000).fold(0, |below, _| file.add(b"CH", &[0, below, name, 0], &[0; 8]));
    let channel = file.channel(BYTE, name, 0, 0, 0);
    let group = file.group(channel, 0, 10, 1, 0);
    let records = file.records(&[1; 10]);
    let data = file.data(group, records, 0, 0);
    assert_eq!(seen(&file.whole(data, 0, below), 0).names(), [["c"]]);
}

#[test]
fn comments_take_what_they_have() {
    let with = |comment: &str| {
        let mut file = File::new();
        let name = file.text("c");
        let channel = file.channel(BYTE, name, 0, 0, 0);
        let group = file.group(channel, 0, 10, 1, 0);
        let records = file.records(&[1; 10]);
        let data = file.data(group, records, 0, 0);
        let xml = format!("<HDcomment>{comment}</HDcomment>\0");
        let comment = file.add(b"MD", &[], xml.as_bytes());
        seen(&file.whole(data, comment, 0), 0)
    };
    assert!(with("<TX>a test</TX>").tables.is_ok());
    let attributes: Vec<String> = (0..20_000).map(|at| format!("a{at}=\"\"")).collect();
    with(&format!("<TX {}>a</TX>", attributes.join(" "))).refused_for("its texts");
    let entries: Vec<String> = (0..5000).map(|at| format!("<e name=\"{at}\"/>")).collect();
    let tree = format!(
        "<tree name=\"{}\">{}</tree>",
        "a".repeat(20_000),
        entries.concat()
    );
    with(&tree).refused_for("its texts");
}

/// More groups than are kept, each of which is unpacked for its times and for its values.
#[test]
fn what_many_groups_unpack_to_counts_once() {
    const ROWS: usize = 1 << 17;
    let mut file = File::new();
    let mut next = 0;
    for first in 0..10 {
        let [name, y] = ["time", "y"].map(|name| file.text(name));
        let at = Field { at: 8, ..BYTE };
        let value = file.channel(at, y, 0, 0, 0);
        let time = file.channel(TIME, name, 0, 0, value);
        let group = file.group(time, 0, ROWS as u64, 9, 0);
        let record = |row: usize| [&((first + row) as f64).to_le_bytes()[..], &[7]].concat();
        let records: Vec<u8> = (0..ROWS).flat_map(record).collect();
        let records = file.packed(&records, records.len() as u64);
        next = file.data(group, records, 0, next);
    }
    let seen = seen(&file.whole(next, 0, 0), 10 * 9 * ROWS as u64);
    assert_eq!(seen.tables().len(), 10);
    assert_eq!(seen.values[1], [7.0; ROWS]);
}

#[test]
fn a_list_may_name_a_block_often_and_pays_for_each_time() {
    let list = |times: usize| {
        let mut file = File::new();
        let name = file.text("time");
        let channel = file.channel(TIME, name, 0, 0, 0);
        let block = file.packed(&[0; 1 << 16], 1 << 16);
        let mut data = vec![1, 0, 0, 0];
        data.extend((times as u32).to_le_bytes());
        data.extend(words(&[1 << 16]));
        let links = [&[0][..], &vec![block; times]].concat();
        let list = file.add(b"DL", &links, &data);
        let group = file.group(channel, 0, 1 << 40, 8, 0);
        let data = file.data(group, list, 0, 0);
        (file.whole(data, 0, 0), (times as u64) << 16)
    };
    let (bytes, unpacked) = list(3);
    assert_eq!(seen(&bytes, 2 * unpacked).values[0].len(), 3 << 13);
    // More than the limit of a file.
    let (bytes, _) = list(50_000);
    let seen = seen(&bytes, super::LIMIT);
    assert!(seen.error().contains("--max-read"), "{}", seen.error());
}

#[test]
fn what_a_block_says_of_its_size_is_not_believed() {
    let mut file = File::new();
    let name = file.text("time");
    let channel = file.channel(TIME, name, 0, 0, 0);
    let records = file.packed(&[0; 80], 15 << 20);
    let group = file.group(channel, 0, 10, 8, 0);
    let data = file.data(group, records, 0, 0);
    let claims = seen(&file.whole(data, 0, 0), 0);
    assert!(
        claims.error().contains("80 bytes instead of"),
        "{}",
        claims.error()
    );
    assert!(claims.taken < 1 << 20, "{}", claims.taken);
    // Times that are computed, of a group without records.
    let mut file = File::new();
    let name = file.text("time");
    let of_rows = Field {
        kind: 3,
        bits: 0,
        ..TIME
    };
    let channel = file.channel(of_rows, name, 0, 0, 0);
    let group = file.group(channel, 0, 1 << 60, 0, 0);
    let data = file.data(group, 0, 0, 0);
    seen(&file.whole(data, 0, 0), 0).refused_for("the values of its columns");
}

#[test]
fn records_of_a_byte_are_read_or_refused() {
    let unsorted = |records: &[u8]| {
        let mut file = File::new();
        let name = file.text("c");
        let [first, second] = [(); 2].map(|()| file.channel(BYTE, name, 0, 0, 0));
        let second = file.group(second, 2, 0, 1, 0);
        let first = file.group(first, 1, 0, 1, second);
        let block = file.packed(records, records.len() as u64);
        let data = file.data(first, block, 1, 0);
        seen(&file.whole(data, 0, 0), records.len() as u64)
    };
    let read = unsorted(&[1, 10, 2, 20, 1, 11, 2, 21]);
    assert_eq!(read.tables()[0].rows, Some(2));
    assert_eq!(read.values, [[10.0, 11.0], [20.0, 21.0]]);
    // Where each record begins takes eight times as much as it does.
    let mut file = File::new();
    let name = file.text("c");
    let [first, second] = [(); 2].map(|()| file.channel(BYTE, name, 0, 0, 0));
    let second = file.group(second, 2, 0, 0, 0);
    let first = file.group(first, 0, 0, 0, second);
    let block = file.packed(&[0; 4 << 20], 4 << 20);
    let data = file.data(first, block, 1, 0);
    seen(&file.whole(data, 0, 0), 4 << 20).refused_for("its records");
}

#[test]
fn arrays_are_split_into_columns_within_the_budget() {
    let arrays = |channels: usize, elements: u64| {
        let mut file = File::new();
        let name = file.text("c");
        let mut data = vec![0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0];
        data.extend(words(&[elements]));
        let array = file.add(b"CA", &[0], &data);
        let channel = (0..channels).fold(0, |next, _| file.channel(BYTE, name, 0, array, next));
        seen(&file.of(channel, 100), 0)
    };
    let read = arrays(1, 3);
    assert_eq!(read.names(), [["c #1", "c #2", "c #3"]]);
    assert_eq!(read.values[2][..2], [2.0, 102.0]);
    arrays(1000, 100).refused_for("its arrays");
    let beyond = arrays(1, 101);
    assert!(
        beyond.error().contains("arrays beyond their record"),
        "{}",
        beyond.error()
    );
}
