//! Lines above and below the numbers.

use mesh_damper_tables::files::Reading;

use super::corpus::{Dialect, NEWTONS, OWN, Outcome, SAMPLES, read, rows};

fn dialect(name: &'static str, text: String, said: &[&'static str]) -> Dialect {
    Dialect {
        family: "header",
        name,
        bytes: text.into_bytes(),
        columns: OWN,
        outcome: Outcome::Read(said.to_vec()),
    }
}

/// A row that may not be a sample is read as one, and the reader reports it.
#[test]
fn a_row_of_numbers_that_may_be_no_sample_is_said() {
    let samples = || rows(&OWN, ";", ',', "\n");
    let guesses = |text: String| {
        let recording = read(text.as_bytes(), &Reading::default()).unwrap();
        assert_eq!(recording.len(), SAMPLES + 1);
        recording.guesses().join("; ")
    };
    let names = "Zeit;Weg;Kraft\ns;mm;kN\n";
    let offsets = guesses(format!("{names}0;0;0\n{}", samples()));
    assert!(
        offsets.contains("the first row of numbers, line 3, is read as a sample"),
        "{offsets}"
    );
    let sums = guesses(format!("{names}{}\n26,1;1,5;2,5\n", samples()));
    assert!(
        sums.contains("the last row of numbers, from line 52 on"),
        "{sums}"
    );
    // Where all rows look alike there is nothing to report.
    let plain = guesses(format!("{names}0,0000;0,00000;0,00000\n{}", samples()));
    assert!(!plain.contains("read as"), "{plain}");
}

pub fn dialects() -> Vec<Dialect> {
    let tab = || rows(&OWN, "\t", '.', "\n");
    let semicolon = || rows(&OWN, ";", ',', "\n");
    let comma = || rows(&OWN, ",", '.', "\n");
    let half = |separator: &str, decimal: char, second: bool| {
        let all = rows(&OWN, separator, decimal, "\n");
        let lines: Vec<&str> = all.split_inclusive('\n').collect();
        let (first, last) = lines.split_at(SAMPLES / 2);
        if second {
            last.concat()
        } else {
            first.concat()
        }
    };
    let long: String = (0..300)
        .map(|line| format!("Setting {line};{}\n", line % 7))
        .collect();
    vec![
        dialect(
            "a row of units below",
            format!("Time\tDisplacement\tForce\ns\tmm\tkN\n{}", tab()),
            &["the units in line 2"],
        ),
        dialect(
            "units in brackets below",
            format!("Time,Displacement,Force\n(s),(mm),(kN)\n{}", comma()),
            &["the units in line 2"],
        ),
        dialect(
            "a row of units above",
            format!("s\tmm\tkN\nTime\tDisplacement\tForce\n{}", tab()),
            &["the units in line 1"],
        ),
        dialect(
            "own words with a row of units",
            format!("time,displacement,force\ns,mm,kN\n{}", comma()),
            &["the units in line 2"],
        ),
        dialect(
            "a preamble of keys and values",
            format!(
                "Operator;Smith\nSpecimen;ring 3\nSample;1,5\n\nZeit [s];Weg [mm];Kraft [kN]\n{}",
                semicolon()
            ),
            &["line 5"],
        ),
        dialect(
            "a preamble of 300 lines",
            format!("{long}\nZeit [s];Weg [mm];Kraft [kN]\n{}", semicolon()),
            &["line 302"],
        ),
        dialect(
            "a preamble of free text with commas",
            format!(
                "Report of a test, made on Monday, by me\n\nTime [s],Disp [mm],Load [kN]\n{}",
                comma()
            ),
            &["line 3"],
        ),
        dialect(
            "names in a comment, as NumPy writes them",
            format!(
                "# Time [s] Disp [mm] Load [kN]\n{}",
                rows(&OWN, " ", '.', "\n")
            )
            .replace("Time [s] Disp [mm] Load [kN]", "Time_s Disp_mm Load_kN"),
            &["which is a comment"],
        ),
        dialect(
            "comments of MATLAB",
            format!(
                "% made by a script\n%% second line\nTime (s),Disp (mm),Load (kN)\n{}",
                comma()
            ),
            &["force is read"],
        ),
        dialect(
            "comments with two strokes",
            format!("// rig 2\nTime (s)\tDisp (mm)\tLoad (kN)\n{}", tab()),
            &["force is read"],
        ),
        dialect(
            "names over two lines in quotes",
            format!(
                "\"Time\n[s]\";\"Weg\n[mm]\";\"Kraft\n[kN]\"\n{}",
                semicolon()
            ),
            &["\"Kraft [kN]\""],
        ),
        dialect(
            "capitals",
            format!("TIME_S,DISPLACEMENT (MM),FORCE [KN]\n{}", comma()),
            &["\"FORCE [KN]\" in kN"],
        ),
        dialect(
            "words without a blank between",
            format!(
                "testTime(s)\taxialDisplacement(mm)\taxialForce(kN)\n{}",
                tab()
            ),
            &["\"axialForce(kN)\""],
        ),
        dialect(
            "units behind a stroke",
            format!("t/s;x/mm;Force/kN\n{}", semicolon()),
            &["\"Force/kN\" in kN"],
        ),
        dialect(
            "units behind `in`",
            format!("t in s;Weg in mm;F in kN\n{}", semicolon()),
            &["\"F in kN\" in kN"],
        ),
        dialect(
            "units behind a comma, in quotes",
            format!("\"Time, s\",\"Stroke, mm\",\"Load, kN\"\n{}", comma()),
            &["\"Load, kN\""],
        ),
        Dialect {
            columns: NEWTONS,
            ..dialect(
                "units behind a line",
                format!("Time_s,Disp_mm,Load_N\n{}", rows(&NEWTONS, ",", '.', "\n")),
                &["\"Load_N\" in N"],
            )
        },
        dialect(
            "names of channels with units below",
            format!("Ch 1\tCh 2\tCh 3\ns\tmm\tkN\n{}", tab()),
            &["by its unit alone"],
        ),
        dialect(
            "units alone",
            format!("s\tmm\tkN\n{}", tab()),
            &["by its unit alone"],
        ),
        dialect(
            "a footer behind a blank line",
            format!(
                "Time [s];Weg [mm];Kraft [kN]\n{}\nEnd of test\nOperator: Smith\n",
                semicolon()
            ),
            &["2 rows of words at the end"],
        ),
        dialect(
            "statistics behind a blank line",
            format!(
                "Time [s];Weg [mm];Kraft [kN]\n{}\nMean;1,2;3,4\nMax;1,2;3,4\n",
                semicolon()
            ),
            &["2 rows of words at the end"],
        ),
        dialect(
            "the header again in the middle",
            format!(
                "Time\tDisp\tForce\ns\tmm\tkN\n{}\nTime\tDisp\tForce\ns\tmm\tkN\n{}",
                half("\t", '.', false),
                half("\t", '.', true)
            ),
            &["2 blocks are read as one"],
        ),
        dialect(
            "labelled statistics in German columns",
            format!(
                "Zeit [s];Weg [mm];Kraft [kN]\n{}\nMax;2,875;0,875\nMin;-2,625;-2,375\n",
                semicolon()
            ),
            &["2 rows of words at the end, from line 51 on"],
        ),
        dialect(
            "a few rows of peaks at the end",
            format!(
                "Zeit [s];Weg [mm];Kraft [kN]\n{}\nZyklus;Spitze [kN]\n1;0,875\n2;0,874\n",
                semicolon()
            ),
            &["3 rows of words at the end", "2 of numbers in another form"],
        ),
        dialect(
            "our own, with a word at the end",
            format!("time_s,displacement_mm,force_kN\n{}EOF\n", comma()),
            &["1 row of words at the end, from line 50 on"],
        ),
        dialect(
            "our own, with statistics behind a blank line",
            format!(
                "time_s,displacement_mm,force_kN\n{}\nMax,2.875,0.875\n",
                comma()
            ),
            &["1 row of words at the end"],
        ),
        dialect(
            "our own, the header again in the middle",
            {
                let all = comma();
                let lines: Vec<&str> = all.split_inclusive('\n').collect();
                let (first, second) = lines.split_at(SAMPLES / 2);
                let names = "time_s,displacement_mm,force_kN\n";
                format!("{names}{}{names}{}", first.concat(), second.concat())
            },
            &["the header is written again from line 26: its 2 blocks are read as one recording"],
        ),
        dialect(
            "our own, empty columns without names at the end",
            format!(
                "time_s,displacement_mm,force_kN,,\n{}",
                comma().replace('\n', ",,\n")
            ),
            &["a comma"],
        ),
        dialect(
            "our own, with a row of units",
            format!("time_s,displacement_mm,force_kN\ns,mm,kN\n{}", comma()),
            &["the units in line 2"],
        ),
        dialect(
            "our own, with a comma at the end of each row",
            format!(
                "time_s,displacement_mm,force_kN\n{}",
                comma().replace('\n', ",\n")
            ),
            &["a comma"],
        ),
        dialect(
            "our own, with times of day",
            "time_s,displacement_mm,force_kN\n".to_owned()
                + &(0..SAMPLES)
                    .map(|index| {
                        let [_, y, force] = OWN.map(|column| column.cell(index, '.'));
                        format!("12:00:{:07.4},{y},{force}\n", super::corpus::time(index))
                    })
                    .collect::<String>(),
            &["dates or times of day"],
        ),
        dialect(
            "a column of words",
            "Time [s];Note;Weg [mm];Kraft [kN]\n".to_owned() + &words_between(),
            &["a semicolon"],
        ),
        dialect(
            "a column without a name",
            rows(&OWN, ";", ',', "\n").lines().enumerate().fold(
                "Time [s];;Weg [mm];Kraft [kN]\n".to_owned(),
                |text, (index, line)| text + &line.replacen(';', &format!(";{index};"), 1) + "\n",
            ),
            &["a semicolon"],
        ),
    ]
}

fn words_between() -> String {
    let lines = rows(&OWN, ";", ',', "\n");
    lines
        .lines()
        .map(|line| line.replacen(';', ";run up;", 1) + "\n")
        .collect()
}
