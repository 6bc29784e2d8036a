//! Formats that are recognized and not read: a description of the file, and how to convert it.

use mesh_damper_output::error::InputError;

use super::{Format, Reading, Source, Tables};

/// Files that are not mistaken for text.
pub(super) struct Unread;

impl Format for Unread {
    fn name(&self) -> &'static str {
        "unread"
    }

    fn endings(&self) -> &'static [&'static str] {
        &[]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        known(head).is_some()
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        _: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (problem, remedy) =
            known(source.head()).unwrap_or(("is not read", "name another file"));
        Err(InputError::new(source.name(), problem, remedy))
    }
}

/// Message of a build without a format.
macro_rules! left_out {
    ($format:literal) => {
        (
            concat!("is ", $format, ", which this build of hil does not read"),
            "build it with all formats, as `cargo hil` does, or write the columns as CSV",
        )
    };
}

/// Description of a file, and advice.
fn known(head: &[u8]) -> Option<(&'static str, &'static str)> {
    let begins = |mark: &[u8]| head.starts_with(mark);
    let is_mdf = begins(b"MDF     ") || begins(b"UnFinMF ");
    if is_mdf && head.get(8) == Some(&b'4') {
        return Some(left_out!("MDF4"));
    }
    if is_mdf {
        return Some((
            "is MDF of version 3 or older, which is not read",
            "convert it with asammdf: MDF(NAME).convert('4.10').save('NAME.mf4')",
        ));
    }
    if is_mat_5(head) {
        return Some(left_out!("MATLAB"));
    }
    if begins(b"TDSm") {
        return Some(left_out!("TDMS"));
    }
    if is_json(head) {
        return Some(left_out!("JSON"));
    }
    if begins(b"PAR1") {
        return Some(left_out!("Parquet"));
    }
    if begins(b"ARROW1") || begins(&[0xff, 0xff, 0xff, 0xff]) {
        return Some(left_out!("Arrow"));
    }
    if begins(b"PARE") {
        return Some((
            "is encrypted Parquet, which is not read",
            "write it again without encryption",
        ));
    }
    if begins(b"FEA1") {
        return Some((
            "is Feather of version 1, which is not read",
            "write it as version 2: pyarrow.feather.write_feather(table, NAME)",
        ));
    }
    let is_hdf = [0, 512, 1024, 2048].iter().any(|&at| {
        let mark = head.get(at..at + 8);
        mark == Some(b"\x89HDF\r\n\x1a\n")
    });
    if is_hdf {
        return Some(left_out!("HDF5, as MATLAB's v7.3 is"));
    }
    if begins(b"TDSh") {
        return Some((
            "is the index of a TDMS file, which holds no values",
            "name the .tdms file next to it",
        ));
    }
    if is_npz(head) {
        return Some((
            "is a NumPy archive (.npz), whose arrays are not read",
            "write them as a table (CSV, Parquet): pandas.DataFrame(dict(numpy.load('NAME.npz'))).to_parquet('NAME.parquet')",
        ));
    }
    if begins(b"PK\x03\x04") {
        return Some(left_out!("a ZIP archive or an Excel workbook"));
    }
    if begins(&[0xd0, 0xcf, 0x11, 0xe0, 0xa1, 0xb1, 0x1a, 0xe1]) {
        return Some((
            "is an Excel workbook of the old kind (.xls), which is not read",
            "save it as .xlsx or CSV",
        ));
    }
    if begins(b"\x89MCAP0\r\n") {
        return Some((
            "is MCAP, which hil writes but does not read",
            "read the recording that it was made from",
        ));
    }
    if begins(b"\x93NUMPY") {
        return Some((
            "is a NumPy array, which does not name its columns",
            "write a table with names (CSV, Parquet): pandas.DataFrame(numpy.load('NAME.npy'), columns=[...]).to_parquet('NAME.parquet')",
        ));
    }
    is_mat_4(head).then_some((
        "is MATLAB of version 4, which is not read",
        "load it and save it again: save('NAME.mat', '-v7')",
    ))
}

/// Whether it is a ZIP archive whose first file is an array of NumPy.
pub(super) fn is_npz(head: &[u8]) -> bool {
    let name = || {
        let length = head.get(26..28)?;
        let length = u16::from_le_bytes([length[0], length[1]]);
        head.get(30..30 + usize::from(length))
    };
    head.starts_with(b"PK\x03\x04") && name().is_some_and(|name| name.ends_with(b".npy"))
}

/// Whether it is a MAT file of version 5: its header ends in the version, and `MI` in the order of the bytes that follow.
pub(super) fn is_mat_5(head: &[u8]) -> bool {
    matches!(
        head.get(124..128),
        Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I'])
    )
}

/// Whether it begins as JSON does that holds columns.
pub(super) fn is_json(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let mut bytes = head
        .iter()
        .copied()
        .filter(|byte| !byte.is_ascii_whitespace());
    match (bytes.next(), bytes.next()) {
        (Some(b'{'), Some(b'"' | b'}')) => true,
        // A line such as [Header] stands above tables of text.
        (Some(b'['), Some(b'{' | b'[' | b'"' | b'0'..=b'9' | b'-')) => true,
        _ => false,
    }
}

/// Whether it begins with a matrix of MATLAB 4: five words, of which the first has only four digits, and a name that ends in a
/// zero.
fn is_mat_4(head: &[u8]) -> bool {
    let words = |order: fn([u8; 4]) -> u32| -> Option<[u32; 5]> {
        let word = |index: usize| -> Option<u32> {
            let bytes = head.get(4 * index..4 * index + 4)?;
            Some(order(bytes.try_into().ok()?))
        };
        Some([word(0)?, word(1)?, word(2)?, word(3)?, word(4)?])
    };
    let is_it = |words: [u32; 5]| {
        let [kind, rows, columns, imaginary, length] = words;
        let digits = [kind / 1000, kind / 100 % 10, kind / 10 % 10, kind % 10];
        let name = head.get(20..20 + length as usize).unwrap_or_default();
        digits[0] <= 4
            && digits[1] == 0
            && digits[2] <= 5
            && digits[3] <= 2
            && rows > 0
            && columns > 0
            && imaginary <= 1
            && (2..=64).contains(&length)
            && name.split_last().is_some_and(|(last, name)| {
                *last == 0 && name.iter().all(|byte| byte.is_ascii_graphic())
            })
    };
    words(u32::from_le_bytes).is_some_and(is_it) || words(u32::from_be_bytes).is_some_and(is_it)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(not(feature = "formats"))]
    #[test]
    fn a_build_without_a_format_says_so() {
        let mat = [&[b' '; 124][..], &[0, 1, b'I', b'M']].concat();
        let others: [&[u8]; 6] = [
            b"MDF     4.10    ",
            b"PAR1",
            b"ARROW1",
            b"\x89HDF\r\n\x1a\n",
            b"TDSm",
            b"{\"time_s\": [0]}",
        ];
        for head in others.into_iter().chain([&mat[..]]) {
            let (problem, remedy) = known(head).unwrap();
            assert!(problem.contains("this build of hil does not read"));
            assert!(remedy.contains("cargo hil"));
        }
    }

    #[test]
    fn a_message_is_a_sentence() {
        let heads: [&[u8]; 9] = [
            b"MDF     4.10",
            b"MDF     3.30",
            b"PAR1",
            b"ARROW1",
            b"PARE",
            b"FEA1",
            b"\x89HDF\r\n\x1a\n",
            b"PK\x03\x04",
            b"\x93NUMPY",
        ];
        for head in heads {
            let (problem, remedy) = known(head).unwrap();
            let text = format!("{problem}; {remedy}");
            assert!(!text.contains(",,") && !text.contains("  "), "{text}");
        }
        assert_eq!(
            known(heads[6]).unwrap().0,
            "is HDF5, as MATLAB's v7.3 is, which this build of hil does not read"
        );
    }

    #[test]
    fn an_archive_of_numpy_is_known_by_its_first_file() {
        let archive = |name: &str| {
            let mut head = b"PK\x03\x04".to_vec();
            head.resize(26, 0);
            head.extend((name.len() as u16).to_le_bytes());
            head.extend([0, 0]);
            head.extend(name.bytes());
            head
        };
        assert!(known(&archive("force.npy")).unwrap().0.contains(".npz"));
        assert!(!is_npz(&archive("xl/workbook.xml")));
        let cut = archive("force.npy");
        assert!(!is_npz(&cut[..32]) && !is_npz(&cut[..27]));
    }
}
