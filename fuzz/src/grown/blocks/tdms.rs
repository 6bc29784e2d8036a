//! TDMS: segments, layouts, scales and lists of channels.

use super::seen;

const METADATA: u32 = 1 << 1;
const NEW: u32 = 1 << 2;
const RAW: u32 = 1 << 3;
const DAQMX: u32 = 1 << 7;

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn segment(objects: &[Vec<u8>], raw: &[u8], bits: u32) -> Vec<u8> {
    let mut metadata = Vec::new();
    if bits & METADATA != 0 {
        metadata.extend(words(&[objects.len() as u32]));
        metadata.extend(objects.concat());
    }
    let mut all = b"TDSm".to_vec();
    all.extend(words(&[bits, 4713]));
    all.extend(((metadata.len() + raw.len()) as u64).to_le_bytes());
    all.extend((metadata.len() as u64).to_le_bytes());
    [all, metadata, raw.to_vec()].concat()
}

/// A channel of bytes, `count` in each chunk, with properties.
fn channel(path: &str, count: u64, properties: &[Vec<u8>]) -> Vec<u8> {
    let layout = [words(&[20, 5, 1]), count.to_le_bytes().to_vec()].concat();
    object(path, &layout, properties)
}

fn object(path: &str, layout: &[u8], properties: &[Vec<u8>]) -> Vec<u8> {
    let count = words(&[properties.len() as u32]);
    [text(path), layout.to_vec(), count, properties.concat()].concat()
}

fn number(name: &str, value: f64) -> Vec<u8> {
    [text(name), words(&[10]), value.to_le_bytes().to_vec()].concat()
}

fn said(name: &str, value: &str) -> Vec<u8> {
    [text(name), words(&[0x20]), text(value)].concat()
}

/// The layout of a channel of DAQmx: scalers of bytes, one for each scale.
fn daqmx(scalers: u32, count: u64, width: u32) -> Vec<u8> {
    let each = (0..scalers).flat_map(|scale| words(&[0, 0, 0, 0, scale]));
    let head = [words(&[0x1269, u32::MAX, 1]), count.to_le_bytes().to_vec()].concat();
    [head, words(&[scalers]), each.collect(), words(&[1, width])].concat()
}

#[test]
fn segments_that_repeat_a_layout_share_it() {
    let scalers = object("/'g'/'a'", &daqmx(2000, 1, 1), &[]);
    let first = segment(&[scalers], &[1], METADATA | NEW | RAW | DAQMX);
    let again = segment(&[], &[1], RAW | DAQMX).repeat(2000);
    let seen = seen(&[first, again].concat(), 0);
    // Without their scales, several raw values are no channel.
    assert!(seen.error().contains("several raw values without scales"));
    assert!(seen.used.1 < 400_000, "{:?}", seen.used);

    let mut objects = vec![object("a", &daqmx(2000, 1, 1), &[])];
    let same = object("a", &words(&[0]), &[]);
    objects.extend(std::iter::repeat_n(same, 5000));
    let seen = super::seen(&segment(&objects, &[], METADATA | NEW), 0);
    assert!(seen.error().contains("no columns of numbers"));
    assert!(seen.used.1 < 400_000, "{:?}", seen.used);
}

#[test]
fn repeated_segments_take_little_for_each_channel() {
    const CHANNELS: usize = 300;
    const SEGMENTS: usize = 500;
    let path = |index: usize| format!("/'g'/'c{index}'");
    let all: Vec<Vec<u8>> = (0..CHANNELS)
        .map(|index| channel(&path(index), 1, &[]))
        .collect();
    let raw: Vec<u8> = (0..CHANNELS).map(|index| index as u8).collect();
    let first = segment(&all, &raw, METADATA | NEW | RAW);
    let plain = [first.clone(), segment(&[], &raw, RAW).repeat(SEGMENTS - 1)].concat();
    let seen = seen(&plain, 0);
    assert_eq!(seen.tables()[0].rows, Some(SEGMENTS as u64));
    assert_eq!(seen.values[3], [3.0; SEGMENTS]);
    // A place for each channel in each segment would be 150 000.
    assert!(
        seen.used.0 < 600_000 && seen.used.1 < 1_000_000,
        "{:?}",
        seen.used
    );
    // Stated again, they are the same.
    let stated = super::seen(&first.repeat(20), 0);
    assert_eq!(stated.values[3], [3.0; 20]);
}

#[test]
fn layouts_that_change_in_each_segment_are_read_or_refused() {
    let path = |index: usize| format!("/'g'/'c{index}'");
    let grown = |channels: usize, segments: usize| {
        let all: Vec<Vec<u8>> = (0..channels)
            .map(|index| channel(&path(index), u64::from(index == 0), &[]))
            .collect();
        let mut file = segment(&all, &[1], METADATA | NEW | RAW);
        for index in 0..segments {
            let count = 1 + index % 2;
            let changed = channel(&path(0), count as u64, &[]);
            file.extend(segment(&[changed], &vec![2; count], METADATA | RAW));
        }
        seen(&file, 0)
    };
    let read = grown(3, 40);
    assert_eq!(read.values[0].len(), 1 + 60);
    assert_eq!(read.values[0][..2], [1.0, 2.0]);
    grown(2000, 2000).refused_for("the places of its values");
}

#[test]
fn a_list_is_changed_without_a_search_for_each_object() {
    const OBJECTS: usize = 1500;
    let named = |name: usize| format!("/'g'/'c{name}'");
    let all: Vec<Vec<u8>> = (0..OBJECTS)
        .map(|name| channel(&named(name), 1, &[]))
        .collect();
    let without = |name: usize| object(&named(name), &words(&[u32::MAX]), &[]);
    let removed: Vec<Vec<u8>> = (0..OBJECTS).map(without).collect();
    let again = object(&named(7), &words(&[0]), &[]);
    let file = [
        segment(&all, &vec![1; OBJECTS], METADATA | NEW | RAW),
        segment(&removed, &[], METADATA),
        segment(&[again], &[9, 9], METADATA | RAW),
    ];
    let seen = seen(&file.concat(), 0);
    let rows: Vec<Option<u64>> = seen.tables().iter().map(|table| table.rows).collect();
    assert_eq!(rows, [Some(1), Some(3)]);
    assert_eq!(seen.names()[1], ["c7"]);
    assert!(seen.used.1 < 3_000_000, "{:?}", seen.used);
}

#[test]
fn scales_of_a_group_are_made_once_and_cost_what_they_compute() {
    const ROWS: usize = 2000;
    let table = |name: &str, value: fn(usize) -> f64| -> Vec<Vec<u8>> {
        let key = |row: usize| format!("NI_Scale[0]_Table_{name}[{row}]");
        (0..ROWS).map(|row| number(&key(row), value(row))).collect()
    };
    let mut group = vec![
        number("NI_Number_Of_Scales", 1.0),
        said("NI_Scale[0]_Scale_Type", "Table"),
        number("NI_Scale[0]_Table_Scaled_Values_Size", ROWS as f64),
    ];
    group.extend(table("Pre_Scaled_Values", |row| row as f64));
    group.extend(table("Scaled_Values", |row| 2.0 * row as f64));
    let mut objects = vec![object("/'g'", &words(&[u32::MAX]), &group)];
    let path = |index: usize| format!("/'g'/'c{index}'");
    objects.extend((0..1000).map(|index| channel(&path(index), 1, &[])));
    let seen = seen(&segment(&objects, &[5; 1000], METADATA | NEW | RAW), 0);
    assert_eq!(seen.values[2], [10.0]);
    assert!(seen.used.1 < 3_000_000, "{:?}", seen.used);

    // As many scales as a number may say, and a polynomial with a step for each number and value.
    let many = channel("/'g'/'a'", 5, &[number("NI_Number_Of_Scales", 4e9)]);
    let seen = super::seen(&segment(&[many], &[1; 5], METADATA | NEW | RAW), 0);
    assert!(
        seen.error().contains("4000000000 scales"),
        "{}",
        seen.error()
    );
    let coefficient =
        |row: usize| number(&format!("NI_Scale[0]_Polynomial_Coefficients[{row}]"), 1.0);
    let mut polynomial = vec![
        number("NI_Number_Of_Scales", 1.0),
        said("NI_Scale[0]_Scale_Type", "Polynomial"),
        number("NI_Scale[0]_Polynomial_Coefficients_Size", ROWS as f64),
    ];
    polynomial.extend((0..ROWS).map(coefficient));
    let costly = channel("/'g'/'Time'", 9000, &polynomial);
    let seen = super::seen(&segment(&[costly], &[1; 9000], METADATA | NEW | RAW), 0);
    seen.refused_for("the values of its columns");
}

#[test]
fn long_channels_of_each_sensor_are_read() {
    const ROWS: usize = 300_000;
    let bridge: &[(&str, f64)] = &[
        ("Configuration", 10271.0),
        ("Poisson_Ratio", 0.3),
        ("Gage_Resistance", 350.0),
        ("Lead_Wire_Resistance", 0.0),
        ("Initial_Bridge_Voltage", 0.0),
        ("Gage_Factor", 2.0),
        ("Bridge_Shunt_Calibration_Gain_Adjustment", 1.0),
        ("Voltage_Excitation", 1000.0),
    ];
    // Of 64 Ω, which is below 0 °C.
    let resistance: &[(&str, f64)] = &[
        ("Current_Excitation", 1.0),
        ("R0_Nominal_Resistance", 100.0),
        ("A", 3.9083e-3),
        ("B", -5.775e-7),
        ("C", -4.183e-12),
        ("Lead_Wire_Resistance", 0.0),
        ("Resistance_Configuration", 4.0),
    ];
    let thermistor: &[(&str, f64)] = &[
        ("Excitation_Type", 10134.0),
        ("Excitation_Value", 1.0),
        ("R1_Reference_Resistance", 5000.0),
        ("Lead_Wire_Resistance", 0.0),
        ("Resistance_Configuration", 4.0),
        ("A", 1.3e-3),
        ("B", 2.3e-4),
        ("C", 1e-7),
        ("Temperature_Offset", 273.15),
    ];
    for (kind, numbers) in [
        ("Strain", bridge),
        ("RTD", resistance),
        ("Thermistor", thermistor),
    ] {
        let mut properties = vec![
            number("NI_Number_Of_Scales", 1.0),
            said("NI_Scale[0]_Scale_Type", kind),
        ];
        let key = |name: &str| format!("NI_Scale[0]_{kind}_{name}");
        properties.extend(
            numbers
                .iter()
                .map(|(name, value)| number(&key(name), *value)),
        );
        let layout = [words(&[20, 2, 1]), (ROWS as u64).to_le_bytes().to_vec()].concat();
        let channel = object("/'g'/'a'", &layout, &properties);
        let raw = [64, 0].repeat(ROWS);
        let seen = seen(&segment(&[channel], &raw, METADATA | NEW | RAW), 0);
        let values = &seen.values[0];
        assert_eq!(values.len(), ROWS);
        assert!(values[0].is_finite() && values[0] < 200.0, "{kind}");
    }
}

#[test]
fn counts_that_take_no_bytes_are_not_believed() {
    // Rows of no bytes on one card, and a byte on another.
    let time = object("/'g'/'Time'", &daqmx(1, 1 << 50, 0), &[]);
    let other = [
        words(&[0x1269, u32::MAX, 1]),
        1_u64.to_le_bytes().to_vec(),
        words(&[1, 0, 1, 0, 0, 0, 2, 0, 1]),
    ];
    let other = object("/'g'/'b'", &other.concat(), &[]);
    let bits = METADATA | NEW | RAW | DAQMX;
    seen(&segment(&[time, other], &[1; 10], bits), 0).refused_for("the values of its columns");
}

#[test]
fn a_note_about_many_channels_is_four() {
    const CHANNELS: usize = 500;
    let date = |seconds: u64| {
        let date = [0, seconds].map(u64::to_le_bytes).concat();
        [text("wf_start_time"), words(&[0x44]), date].concat()
    };
    let path = |index: usize| format!("/'g'/'c{index}'");
    let stated: Vec<Vec<u8>> = (0..CHANNELS)
        .map(|index| channel(&path(index), 1, &[number("wf_increment", 1.0), date(0)]))
        .collect();
    let later: Vec<Vec<u8>> = (0..CHANNELS)
        .map(|index| object(&path(index), &words(&[0]), &[date(100)]))
        .collect();
    let file = [
        segment(&stated, &[1; CHANNELS], METADATA | NEW | RAW),
        segment(&later, &[1; CHANNELS], METADATA | RAW),
    ];
    let seen = seen(&file.concat(), 0);
    let restarted = |note: &&String| note.contains("restarted");
    let notes: Vec<&String> = seen.tables()[0].guesses.iter().filter(restarted).collect();
    assert_eq!(notes.len(), 4);
    let said = "the clock of 497 more channels restarted";
    assert!(notes[3].starts_with(said), "{}", notes[3]);
}

#[test]
fn texts_and_paths_take_what_they_have() {
    let texts: Vec<Vec<u8>> = (0..2000)
        .map(|index| {
            let layout = [words(&[28, 0x20, 1]), 1_u64.to_le_bytes().to_vec()].concat();
            let layout = [layout, 5_u64.to_le_bytes().to_vec()].concat();
            object(&format!("/'g'/'c{index}'"), &layout, &[said("unit", "mm")])
        })
        .collect();
    let first = segment(&texts, &[b'a'; 10_000], METADATA | NEW | RAW);
    let again = segment(&[], &[b'a'; 10_000], RAW).repeat(20);
    let seen = seen(&[first, again].concat(), 0);
    assert!(seen.error().contains("texts or other things than numbers"));
    // A path of as many names as it may have.
    let path = object(&"'a'".repeat(100_000), &words(&[u32::MAX]), &[]);
    let one = channel("/'g'/'a'", 1, &[]);
    super::seen(&segment(&[path, one], &[1], METADATA | NEW | RAW), 0).refused_for("its segments");
}
