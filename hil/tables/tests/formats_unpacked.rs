//! The memory that a file takes that unpacks to far more than its size. The process runs this test only.
#![cfg(feature = "formats")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Cursor, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use mesh_damper_tables::files::{self, Kept, Reading, Source, Values, Wanted};
use mesh_damper_tables::read_limit::ReadLimit;
use mesh_damper_tables::write::table;
use zip::write::SimpleFileOptions;

static TAKEN: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: all is passed on to the system's.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let taken = TAKEN.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(taken, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        TAKEN.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const NAMES: [&str; 3] = ["time_s", "displacement_mm", "force_kN"];
const LIMIT: u64 = 2 << 20;
/// Rows that a file within the limit has, and one beyond it: three columns of 8 MiB.
const FEW: usize = 1 << 12;
const MANY: usize = 1 << 20;
/// Peak memory as a multiple of the limit: less than the twelve that a text of short rows takes, and than what a file unpacks to.
const MULTIPLE: usize = 6;

/// Reads all columns.
fn read(bytes: &[u8]) -> Result<Values, String> {
    let reading = Reading::from(ReadLimit::new(LIMIT));
    let source = Source::of(Path::new("packed"), bytes, reading.limit);
    let (_, file) = source
        .and_then(|source| files::opened(source, &reading))
        .map_err(|error| error.to_string())?;
    let columns = 0..file.tables()[0].columns.len();
    let wanted: Vec<Wanted> = columns
        .map(|column| Wanted {
            column,
            must_be_numeric: true,
        })
        .collect();
    let values = file.read(0, &wanted, Kept::Channels);
    values.map_err(|error| error.to_string())
}

fn csv(rows: usize) -> Vec<u8> {
    let member = |text: &[u8]| {
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        packed.write_all(text).unwrap();
        packed.finish().unwrap()
    };
    let header = NAMES.join(",") + "\n";
    // A file of gzip may have many members.
    let some = member("0.000000,0.000000,0.000000\n".repeat(FEW).as_bytes());
    [member(header.as_bytes()), some.repeat(rows / FEW)].concat()
}

/// Of the formats that this crate writes itself, packed.
fn own(name: &str, rows: usize) -> Vec<u8> {
    table(
        Path::new(name),
        &[],
        &NAMES.map(|name| (name, vec![0.0; rows])),
    )
    .unwrap()
}

fn xlsx(rows: usize) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let mut file = |name: &str, texts: &mut dyn Iterator<Item = String>| {
        archive
            .start_file(name, SimpleFileOptions::default())
            .unwrap();
        texts.for_each(|text| archive.write_all(text.as_bytes()).unwrap());
    };
    let schemas = "http://schemas.openxmlformats.org";
    let mut one = |name: &str, text: String| file(name, &mut std::iter::once(text));
    let workbook = format!(
        r#"<workbook xmlns="{schemas}/spreadsheetml/2006/main" xmlns:r="{schemas}/officeDocument/2006/relationships"><sheets><sheet name="a" sheetId="1" r:id="rId1"/></sheets></workbook>"#
    );
    let relation = |kind: &str, target: &str| {
        format!(
            r#"<Relationships xmlns="{schemas}/package/2006/relationships"><Relationship Id="rId1" Type="{schemas}/officeDocument/2006/relationships/{kind}" Target="{target}"/></Relationships>"#
        )
    };
    one("_rels/.rels", relation("officeDocument", "xl/workbook.xml"));
    one("xl/workbook.xml", workbook);
    one(
        "xl/_rels/workbook.xml.rels",
        relation("worksheet", "worksheets/sheet1.xml"),
    );
    let cells = |row: usize, cell: &dyn Fn(usize) -> String| {
        let cells: String = (0..3)
            .map(|column| {
                let letter = ["A", "B", "C"][column];
                let (kind, value) = match cell(column) {
                    text if row == 1 => (" t=\"str\"", text),
                    number => ("", number),
                };
                format!("<c r=\"{letter}{row}\"{kind}><v>{value}</v></c>")
            })
            .collect();
        format!("<row r=\"{row}\">{cells}</row>")
    };
    let begin = format!(r#"<worksheet xmlns="{schemas}/spreadsheetml/2006/main"><sheetData>"#);
    let header = cells(1, &|column| NAMES[column].to_owned());
    let mut texts = [begin, header]
        .into_iter()
        .chain((0..rows).map(|row| cells(row + 2, &|_| "0".to_owned())))
        .chain(["</sheetData></worksheet>".to_owned()]);
    file("xl/worksheets/sheet1.xml", &mut texts);
    archive.finish().unwrap().into_inner()
}

/// HDF5 with columns of this many zeros, each one chunk that unpacks to `unpacked` of them.
fn hdf5(rows: usize, unpacked: usize) -> Vec<u8> {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    (0..unpacked / FEW).for_each(|_| packed.write_all(&[0; 8 * FEW]).unwrap());
    let packed = packed.finish().unwrap();
    let rows = rows as u64;
    let header = |messages: &[(u16, Vec<u8>)]| {
        let mut all = Vec::new();
        for (kind, message) in messages {
            let size = message.len().next_multiple_of(8);
            all.extend(kind.to_le_bytes());
            all.extend((size as u16).to_le_bytes());
            all.extend([0; 4]);
            all.extend(message);
            all.resize(all.len() + size - message.len(), 0);
        }
        let mut header = vec![1, 0];
        header.extend((messages.len() as u16).to_le_bytes());
        header.extend(1_u32.to_le_bytes());
        header.extend((all.len() as u32).to_le_bytes());
        header.extend([0; 4]);
        [header, all].concat()
    };
    let dataset = |place: u64| {
        let dataspace = [&[1, 1, 0, 0, 0, 0, 0, 0][..], &rows.to_le_bytes()].concat();
        // A float of eight bytes, the least first.
        let mut datatype = vec![0x11, 0x20, 0x3f, 0, 8, 0, 0, 0, 0, 0, 64, 0, 52, 11, 0, 52];
        datatype.extend(1023_u32.to_le_bytes());
        // Deflate, with its level.
        let filters = vec![2, 1, 1, 0, 0, 0, 1, 0, 6, 0, 0, 0];
        // One chunk that is filtered.
        let mut layout = vec![4, 2, 2, 2, 4];
        layout.extend((rows as u32).to_le_bytes());
        layout.extend(8_u32.to_le_bytes());
        layout.push(1);
        layout.extend((packed.len() as u64).to_le_bytes());
        layout.extend([0; 4]);
        layout.extend(place.to_le_bytes());
        header(&[(1, dataspace), (3, datatype), (0xb, filters), (8, layout)])
    };
    let group = |places: [u64; 3]| {
        let link = |(name, place): (&str, u64)| {
            let head = [1, 0, name.len() as u8];
            let link = [&head[..], name.as_bytes(), &place.to_le_bytes()].concat();
            (6, link)
        };
        let links: Vec<(u16, Vec<u8>)> = NAMES.into_iter().zip(places).map(link).collect();
        header(&links)
    };
    const BEGIN: u64 = 96;
    let (of_group, of_dataset) = (group([0; 3]).len() as u64, dataset(0).len() as u64);
    let places = [0, 1, 2].map(|index| BEGIN + of_group + index * of_dataset);
    let data = places[2] + of_dataset;
    let mut file = b"\x89HDF\r\n\x1a\n\0\0\0\0\0\x08\x08\0".to_vec();
    file.extend([4, 0, 16, 0, 0, 0, 0, 0]);
    let end = data + packed.len() as u64;
    for place in [0, u64::MAX, end, u64::MAX, 0, BEGIN] {
        file.extend(place.to_le_bytes());
    }
    file.resize(BEGIN as usize, 0);
    file.extend(group(places));
    places.iter().for_each(|_| file.extend(dataset(data)));
    file.extend(packed);
    file
}

#[test]
fn a_file_that_unpacks_beyond_the_limit_is_refused_before_it_takes_memory() {
    type Make = fn(usize) -> Vec<u8>;
    let formats: [(&str, Make); 5] = [
        ("csv.gz", csv),
        ("MATLAB v5", |rows| own("a.mat", rows)),
        ("Parquet", |rows| own("a.parquet", rows)),
        ("HDF5", |rows| hdf5(rows, rows)),
        // A cell takes more bytes in a sheet than in the others.
        ("Excel", |rows| xlsx(rows.min(1 << 17))),
    ];
    for (format, make) in formats {
        // The same file with fewer rows is read, so only the limit refuses the other.
        let values = read(&make(FEW)).unwrap_or_else(|error| panic!("{format}: {error}"));
        let lengths = values.columns.iter().flatten().map(Vec::len);
        assert_eq!(lengths.collect::<Vec<_>>(), [FEW; 3], "{format}");
        let taken = refused(format, &make(MANY), "--max-read");
        println!(
            "{format}: {:.2} times the limit",
            taken as f64 / LIMIT as f64
        );
    }
    // A chunk that unpacks to more than the file declares.
    let taken = refused("HDF5, false", &hdf5(FEW, MANY), "packed");
    println!(
        "HDF5, false: {:.2} times the limit",
        taken as f64 / LIMIT as f64
    );
}

/// The peak memory of reading a file that is refused with these words, without the file itself.
fn refused(format: &str, bytes: &[u8], words: &str) -> usize {
    assert!((bytes.len() as u64) < LIMIT, "{format}: {}", bytes.len());
    let at_first = TAKEN.load(Ordering::Relaxed);
    MOST.store(at_first, Ordering::Relaxed);
    let error = read(bytes).map(|_| ()).unwrap_err();
    let taken = MOST.load(Ordering::Relaxed) - at_first;
    assert!(error.contains(words), "{format}: {error}");
    assert!(
        taken < MULTIPLE * LIMIT as usize,
        "{format}: {taken} bytes with a limit of {LIMIT}"
    );
    taken
}
