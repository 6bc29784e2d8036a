//! Files as programs of test labs write them.

use super::corpus::{Column, Dialect, KN, MM, N, NEWTONS, OWN, Outcome, S, SAMPLES, rows};

fn halves(columns: &[Column], separator: &str, decimal: char, end: &str) -> [String; 2] {
    let all = rows(columns, separator, decimal, end);
    let lines: Vec<&str> = all.split_inclusive(end).collect();
    let (first, last) = lines.split_at(SAMPLES / 2);
    [first.concat(), last.concat()]
}

fn mts(first: &str, decimal: char, names: &str, units: &str) -> Vec<u8> {
    let block = |time: &str, rows: &str| {
        format!(
            "Data Acquisition\t\tTime:\t{time}\ts\t3/1/2024 1:54:32 PM\r\nStation Name\t\trig 2\r\n{names}\r\n{units}\r\n{rows}\r\n"
        )
    };
    let [one, two] = halves(&NEWTONS, "\t", decimal, "\r\n");
    format!("{first}\r\n\r\n{}{}", block("4", &one), block("8", &two)).into_bytes()
}

fn lvm(decimal: char, x_columns: &str, units: &str, names: &str, rows: &str) -> Vec<u8> {
    let number = |text: &str| text.replace('.', &decimal.to_string());
    format!(
        "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\nDecimal_Separator\t{decimal}\r\n\
         Multi_Headings\tYes\r\nX_Columns\t{x_columns}\r\nTime_Pref\tRelative\r\nOperator\tme\r\nDate\t2024/03/01\r\n\
         Time\t{}\r\n***End_of_Header***\t\r\n\t\r\nChannels\t2\t\t\r\nSamples\t{SAMPLES}\t{SAMPLES}\t\r\n\
         Date\t2024/03/01\t2024/03/01\t\r\nTime\t{}\t{}\t\r\n{units}X_Dimension\tTime\tTime\t\r\n\
         X0\t{}\t{}\t\r\nDelta_X\t{}\t{}\t\r\n***End_of_Header***\t\t\t\r\n{names}\tComment\r\n{rows}",
        number("17:18:18.93894"),
        number("17:18:18.93894"),
        number("17:18:18.93894"),
        number("2.5000000000000000E-1"),
        number("2.5000000000000000E-1"),
        number("0.012500"),
        number("0.012500"),
    )
    .into_bytes()
}

pub fn dialects() -> Vec<Dialect> {
    let dialect = |name, bytes: Vec<u8>, columns, outcome| Dialect {
        family: "program",
        name,
        bytes,
        columns,
        outcome,
    };
    let read = |said: &[&'static str]| Outcome::Read(said.to_vec());
    let names = "Running Time\tAxial Displacement\tAxial Force";
    let y = [MM, N];
    let empty_first = |decimal| {
        rows(&y, "\t", decimal, "\r\n")
            .lines()
            .map(|line| format!("\t{line}\r\n"))
            .collect::<String>()
    };
    let remarked = {
        let all = rows(&NEWTONS, "\t", '.', "\r\n");
        all.replacen("\r\n", "\tstarted by hand\r\n", 1)
    };
    let multi: String = (0..SAMPLES)
        .map(|index| {
            let [time, y, force] = NEWTONS.map(|column| column.cell(index, '.'));
            format!("{time}\t{y}\t{time}\t{force}\r\n")
        })
        .collect();
    let y_units = "Y_Unit_Label\tmm\tN\t\r\n";
    let [first, second] = halves(&OWN, "\t", '.', "\n");
    vec![
        dialect("MTS, English, two blocks", mts("MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A", '.', names, "s\tmm\tN"), NEWTONS, read(&["2 blocks", "a point"])),
        dialect("MTS, German", mts("MTS793|MPT|DEU|1|2|,|.|:|49|1|1|A", ',', "Zeit\tKolbenweg\tKraft", "s\tmm\tN"), NEWTONS, read(&["2 blocks", "a comma"])),
        dialect("MTS with a command beside", {
            let text = String::from_utf8(mts("MTS793|BTW|ENU|1|2|.|/|:|1|0|0|A", '.', &format!("{names}\tAxial Displacement Command\tAxial Count"), "s\tmm\tN\tmm\tcycles")).expect("text");
            let numbered = |line: &str| line.split('\t').count() == 3 && line.starts_with('0');
            text.split("\r\n").map(|line| if numbered(line) { format!("{line}\t0.5\t3\r\n") } else { format!("{line}\r\n") }).collect::<String>().into_bytes()
        }, NEWTONS, read(&["\"Axial Displacement\" in mm"])),
        dialect("Instron Bluehill", format!("\"Specimen label\",\"ring 3\"\r\n\"Rate 1\",\"2.5\",\"mm/min\"\r\n\r\n\"Time\",\"Extension\",\"Load\"\r\n\"(s)\",\"(mm)\",\"(N)\"\r\n{}",
            rows(&NEWTONS, "\",\"", '.', "\"\r\n").lines().map(|line| format!("\"{line}\r\n")).collect::<String>()).into_bytes(), NEWTONS, read(&["\"Load\" in N", "line 4"])),
        dialect("LabVIEW LVM, one column of times", lvm('.', "One", y_units, "X_Value\tDisp\tLoad", &rows(&NEWTONS, "\t", '.', "\r\n")), NEWTONS, read(&["\"X_Value\" in s"])),
        dialect("LabVIEW LVM, decimal comma", lvm(',', "One", y_units, "X_Value\tWeg\tKraft", &rows(&NEWTONS, "\t", ',', "\r\n")), NEWTONS, read(&["a comma"])),
        dialect("LabVIEW LVM, no column of times", lvm('.', "No", y_units, "X_Value\tDisp\tLoad", &empty_first('.')), [S, MM, N], read(&["Delta_X = 0.0125 s"])),
        dialect("LabVIEW LVM, a column of times for each", lvm('.', "Multi", y_units, "X_Value\tDisp\tX_Value\tLoad", &multi), NEWTONS, read(&["\"X_Value\" in s"])),
        dialect("LabVIEW LVM with a remark", lvm('.', "One", y_units, "X_Value\tDisp\tLoad", &remarked), NEWTONS, read(&["\"X_Value\" in s"])),
        dialect("LabVIEW LVM, untitled", lvm('.', "One", "", "X_Value\tUntitled\tUntitled 1", &rows(&NEWTONS, "\t", '.', "\r\n")), NEWTONS,
            Outcome::Asked(vec!["--channel displacement=Untitled", "--unit displacement=mm", "--channel force='Untitled 1'", "--unit force=N"])),
        dialect("LabVIEW, plain text", format!("t [s]\tDisp [mm]\tForce [kN]\r\n{}", rows(&OWN, "\t", '.', "\r\n")).into_bytes(), OWN, read(&["a tab"])),
        dialect("Zwick testXpert", format!("Prüfer;Müller\r\nVorkraft;0,5;N\r\n\r\nPrüfzeit;Standardweg;Standardkraft\r\ns;mm;N\r\n{}", rows(&NEWTONS, ";", ',', "\r\n")).into_bytes(), NEWTONS, read(&["the units in line 5"])),
        dialect("DIAdem", format!("Zeit\tWeg_ist\tKraft_ist\ns\tmm\tkN\n{}", rows(&OWN, "\t", ',', "\n")).into_bytes(), OWN, read(&["a comma"])),
        dialect("imc FAMOS, ASCII", format!("Zeit [s] Weg [mm] Kraft [kN]\n{}", rows(&OWN, " ", '.', "\n")).into_bytes(), OWN, read(&["blanks"])),
        dialect("Moog, a header with bars", format!("File|test 1\nRig|2\n\nTime (s)|Actuator Position (mm)|Actuator Force (kN)\n{}", rows(&OWN, "|", '.', "\n")).into_bytes(), OWN, read(&["a bar"])),
        dialect("Dewesoft, tabs", format!("Data info\nFile name:\ttest.dxd\nSample rate:\t80 Hz\n\nTime (s)\tDisp (mm); raw\tForce (kN)\n{first}{second}").replace("; raw", "").into_bytes(), OWN, read(&["a tab"])),
        dialect("pandas with an index", rows(&OWN, ",", '.', "\n").lines().enumerate().fold(",time_s,displacement_mm,force_kN\n".to_owned(), |text, (index, line)| format!("{text}{index},{line}\n")).into_bytes(), OWN, read(&[])),
        dialect("MATLAB writetable", format!("Time_s,Disp_mm,Force_kN\r\n{}", rows(&OWN, ",", '.', "\r\n")).into_bytes(), OWN, read(&["\"Force_kN\" in kN"])),
        dialect("Excel of Germany, UTF-16 with tabs", super::encodings::utf16(&format!("Zeit [s]\tWeg [mm]\tKraft [kN]\r\n{}", rows(&OWN, "\t", ',', "\r\n")), false, true), [S, MM, KN], read(&["UTF-16LE", "a comma"])),
    ]
}
