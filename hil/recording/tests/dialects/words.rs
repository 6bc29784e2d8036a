//! Names with more in them than a quantity and its unit.

use super::corpus::{Column, Dialect, KN, MM, N, OWN, Outcome, S, SAMPLES, rows};

/// The content of a column that is not the channel: a number that no channel of the recording has.
const WRONG: &str = "9.5";

/// Rows in which `%` stands for a column that is not a channel, and `t`, `y` and `f` stand for the channels.
fn table(names: &str, columns: [Column; 3], pattern: &str) -> String {
    let row = |index: usize| {
        let [time, y, force] = columns.map(|column| column.cell(index, '.'));
        let cells = pattern.chars().map(|sign| match sign {
            't' => time.as_str(),
            'y' => y.as_str(),
            'f' => force.as_str(),
            _ => WRONG,
        });
        cells.collect::<Vec<_>>().join(";") + "\n"
    };
    names.to_owned() + "\n" + &(0..SAMPLES).map(row).collect::<String>()
}

pub fn dialects() -> Vec<Dialect> {
    let dialect = |name, text: String, columns: [Column; 3], outcome: Outcome| Dialect {
        family: "words",
        name,
        bytes: text.into_bytes(),
        columns,
        outcome,
    };
    let asked = |name, names: &str, pattern: &str, options: &[&'static str]| {
        let outcome = Outcome::Asked(options.to_vec());
        dialect(name, table(names, OWN, pattern), OWN, outcome)
    };
    let unit = |name, names: &str, columns: [Column; 3], options: &[&'static str]| {
        let outcome = Outcome::Asked(options.to_vec());
        dialect(name, table(names, columns, "tyf"), columns, outcome)
    };
    let read = |name, text: String, columns: [Column; 3], said: &[&'static str]| {
        dialect(name, text, columns, Outcome::Read(said.to_vec()))
    };
    let mils = [S, MM.of(0.0254, 3), KN.of(9.806_65, 6)];
    vec![
        unit(
            "a factor behind the unit",
            "Time [s];Disp [mm];Force [N] (x1000)",
            OWN,
            &["--unit force=kN"],
        ),
        unit(
            "a factor before the unit",
            "Time [s];Disp [mm];Force x10 [N]",
            [S, MM, KN.of(1e-2, 4)],
            &["--unit force=daN"],
        ),
        unit(
            "a power of ten behind the unit",
            "Time (s);Disp (mm) x10^3;Force (kN)",
            [S, MM.of(1e3, 8), KN],
            &["--unit displacement=m"],
        ),
        unit(
            "a second unit behind the first",
            "Time (s) / ms;Disp [mm];Force [kN] -> N",
            [S.of(1e-3, 1), MM, N],
            &["--unit time=ms", "--unit force=N"],
        ),
        asked(
            "a command behind the unit",
            "Time (s);Displacement (mm) Command;Gap 3 [mm];Force (kN)",
            "t%yf",
            &["--channel displacement='Gap 3 [mm]'"],
        ),
        asked(
            "a command behind the unit, in German",
            "Zeit [s];Weg [mm] Soll;Taster 3 [mm];Kraft [kN]",
            "t%yf",
            &["--channel displacement='Taster 3 [mm]'"],
        ),
        asked(
            "a mean behind the unit",
            "Time [s];Disp [mm];Force [kN] avg;DMS [kN]",
            "ty%f",
            &["--channel force='DMS [kN]'"],
        ),
        asked(
            "the machine's displacement and the sample's",
            "Time [s];Machine displacement [mm];Sample displacement [mm];Force [kN]",
            "t%yf",
            &["--channel displacement='Sample displacement [mm]'"],
        ),
        asked(
            "a position and a corrected one",
            "Time [s];Position [mm];Corrected position [mm];Force [kN]",
            "t%yf",
            &["--channel displacement='Corrected position [mm]'"],
        ),
        asked(
            "a force by strain gauges beside another",
            "Time [s];Disp [mm];Actuator force [kN];Strain gauge force [kN]",
            "ty%f",
            &["--channel force='Strain gauge force [kN]'"],
        ),
        asked(
            "a nominal displacement beside a bare sensor",
            "Time [s];Nominal displacement [mm];Taster [mm];Force [kN]",
            "t%yf",
            &["--channel displacement='Taster [mm]'"],
        ),
        asked(
            "words put together that are not all understood",
            "Zeit [s];Weg [mm];Nennkraft [kN];DMS 1 [kN]",
            "ty%f",
            &["--channel force='DMS 1 [kN]'"],
        ),
        asked(
            "a command in Chinese beside a bare sensor",
            "时间(s);设定位移(mm);实测(mm);力(kN)",
            "t%yf",
            &["--channel displacement='实测(mm)'"],
        ),
        read(
            "understood words beside a bare sensor",
            table(
                "Zeit [s];Kolbenweg [mm];Taster [mm];Prüfkraft [kN];DMS 1 [kN]",
                OWN,
                "ty%f%",
            ),
            OWN,
            &["\"Kolbenweg [mm]\"", "\"Prüfkraft [kN]\""],
        ),
        read(
            "two control inputs of one kind",
            table(
                "Time [s];Disp [mm];Force [kN];Pressure A [bar];Pressure B [bar]",
                OWN,
                "tyf%%",
            ),
            OWN,
            &[
                "2 columns could be the control input pressure_bar",
                "none of them is read",
            ],
        ),
        unit(
            "a unit in brackets that is unknown",
            "Zaman (sn);Disp [mm];Force [kN]",
            OWN,
            &["--unit time=s"],
        ),
        read(
            "mils and metric tonnes",
            table("Time (sec);Displacement (mils);Load [tf]", mils, "tyf"),
            mils,
            &["in mil", "in tf"],
        ),
        dialect(
            "two rows of units that differ",
            format!(
                "Time;Disp;Force\n[s];[mm];[kN]\n[ms];[um];[N]\n{}",
                rows(&OWN, ";", '.', "\n")
            ),
            OWN,
            Outcome::Asked(vec![
                "--unit time=s",
                "--unit displacement=mm",
                "--unit force=kN",
            ]),
        ),
        dialect(
            "names above a row of rates and one of units",
            format!(
                "HBM Catman\t\nExport: ASCII\tChannels=3\nTime 1\tWA20\tU9B\n80\t80\t80\ns\tmm\tkN\n{}",
                rows(&OWN, "\t", ',', "\n")
            ),
            OWN,
            Outcome::Asked(vec!["--channel displacement=WA20"]),
        ),
        dialect(
            "a column of words by its signs",
            "Time [s];Disp [mm];Force [kN]\n".to_owned()
                + &(0..SAMPLES)
                    .map(|index| {
                        let [time, y, force] = OWN.map(|column| column.cell(index, '.'));
                        format!("{time};({y});{force}\n")
                    })
                    .collect::<String>(),
            OWN,
            Outcome::Refused(vec![
                "there is no displacement column",
                "column \"Disp [mm]\" holds words, such as \"(",
            ]),
        ),
    ]
}
