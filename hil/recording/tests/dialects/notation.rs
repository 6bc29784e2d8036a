//! How numbers are written.

use mesh_damper_tables::files::Reading;

use super::corpus::{Column, Dialect, N, NEWTONS, OWN, Outcome, S, rows};

/// Micrometres: large enough for thousands separators.
const UM: Column = super::corpus::MM.of(1e-3, 1);

fn grouped(cell: &str, sign: &str) -> String {
    let (digits, rest) = cell.split_at(cell.find(['.', ',']).unwrap_or(cell.len()));
    let (minus, digits) = digits
        .strip_prefix('-')
        .map_or(("", digits), |digits| ("-", digits));
    let cut = digits.len().saturating_sub(3);
    if cut == 0 {
        return cell.to_owned();
    }
    format!("{minus}{}{sign}{}{rest}", &digits[..cut], &digits[cut..])
}

fn with_groups(separator: &str, decimal: char, sign: &str, quote: &str) -> String {
    let text = rows(&[S, UM, N], "\u{1}", decimal, "\n");
    let line = |line: &str| {
        let cells = line
            .split('\u{1}')
            .map(|cell| format!("{quote}{}{quote}", grouped(cell, sign)));
        cells.collect::<Vec<_>>().join(separator) + "\n"
    };
    ["Time [s]", "Disp [um]", "Load [N]"].join(separator)
        + "\n"
        + &text.lines().map(line).collect::<String>()
}

/// Rows behind those that identify the dialect change no decision.
#[test]
fn thousands_that_come_late_are_asked_for() {
    let late = |cell: &str| {
        let whole: String = (0..40_000)
            .map(|index| format!("{index};{};{}\n", index % 90, index / 50))
            .collect();
        format!("Zeit [ms];Weg [um];Kraft [N]\n{whole}40000;1;{cell}\n").into_bytes()
    };
    let read = |cell: &str, decimal| {
        let said = Reading {
            decimal,
            ..Reading::default()
        };
        let read = super::corpus::read(&late(cell), &said)?;
        Ok(read.force[40_000])
    };
    for (cell, decimal, other) in [("2.400", ',', '.'), ("2,400", '.', ',')] {
        let error: String = read(cell, None).unwrap_err();
        assert!(error.contains("line 40002, column Kraft [N]"), "{error}");
        assert!(
            error.contains("could be the decimal sign or a thousands separator"),
            "{error}"
        );
        assert!(
            error.contains("--decimal point or --decimal comma"),
            "{error}"
        );
        assert_eq!(read(cell, Some(decimal)), Ok(2.4));
        assert!((read(cell, Some(other)).unwrap() - 2.4e-3).abs() < 1e-12);
    }
    assert_eq!(read("0.5", None), Ok(5e-4));
}

pub fn dialects() -> Vec<Dialect> {
    let columns = [S, UM, N];
    let dialect = |name, text: String, said: &[&'static str]| Dialect {
        family: "numbers",
        name,
        bytes: text.into_bytes(),
        columns,
        outcome: Outcome::Read(said.to_vec()),
    };
    let scientific = |decimal: &str| {
        let cells = |index: usize| {
            let values = OWN.map(|column| {
                format!("{:.6E}", (column.values)(index) / column.scale).replace('.', decimal)
            });
            values.join("\t") + "\n"
        };
        "Time (s)\tDisp (mm)\tLoad (kN)\n".to_owned()
            + &(0..super::corpus::SAMPLES).map(cells).collect::<String>()
    };
    let minus = ["Time [s]", "Disp [mm]", "Load [N]"].join(";")
        + "\n"
        + &rows(&NEWTONS, ";", ',', "\n").replace('-', "\u{2212}");
    vec![
        dialect(
            "exponents of Fortran",
            {
                let row = |index: usize| {
                    let cells = columns.map(|column| {
                        let value: f64 = column.cell(index, '.').parse().expect("a number");
                        format!("{value:.9e}")
                            .replace('e', "D+0")
                            .replace("D+0-", "D-0")
                    });
                    cells.join(" ") + "\n"
                };
                let rows: String = (0..super::corpus::SAMPLES).map(row).collect();
                format!("Time(s) Disp(um) Load(N)\n{rows}")
            },
            &["separated by blanks"],
        ),
        dialect(
            "thousands by a point, decimal comma",
            with_groups(";", ',', ".", ""),
            &["a comma, and a point separates thousands"],
        ),
        dialect(
            "thousands by a comma, quoted",
            with_groups(",", '.', ",", "\""),
            &["a comma separates thousands"],
        ),
        dialect(
            "thousands by a blank",
            with_groups(";", ',', " ", ""),
            &["a comma"],
        ),
        dialect(
            "thousands by a narrow blank",
            with_groups("\t", ',', "\u{202f}", ""),
            &["a comma"],
        ),
        dialect(
            "thousands by an apostrophe",
            with_groups(";", '.', "'", ""),
            &["a point"],
        ),
        Dialect {
            columns: OWN,
            ..dialect("exponents, decimal comma", scientific(","), &["a comma"])
        },
        Dialect {
            columns: OWN,
            ..dialect("exponents, decimal point", scientific("."), &["a tab"])
        },
        Dialect {
            columns: NEWTONS,
            ..dialect("a typographer's minus", minus, &["a comma"])
        },
    ]
}
