//! Separators of cells and lines.

use super::corpus::{Dialect, NEWTONS, OWN, Outcome, rows};

const NAMES: [&str; 3] = ["Time [s]", "Disp [mm]", "Load [kN]"];

fn dialect(name: &'static str, text: String, said: &[&'static str]) -> Dialect {
    Dialect {
        family: "separator",
        name,
        bytes: text.into_bytes(),
        columns: OWN,
        outcome: Outcome::Read(said.to_vec()),
    }
}

fn table(separator: &str, decimal: char, end: &str) -> String {
    NAMES.join(separator) + end + &rows(&OWN, separator, decimal, end)
}

pub fn dialects() -> Vec<Dialect> {
    let own = "time_s,displacement_mm,force_kN\n".to_owned() + &rows(&OWN, ",", '.', "\n");
    let mut fixed = format!(
        "{:>14}{:>14}{:>14}\n",
        "Time (s)", "Disp (mm)", "Axial Force (kN)"
    )
    .replace("  Axial", "   Axial");
    for line in rows(&OWN, " ", '.', "\n").lines() {
        let cells: Vec<&str> = line.split(' ').collect();
        fixed += &format!("{:>14}{:>14}{:>19}\n", cells[0], cells[1], cells[2]);
    }
    let quoted = |decimal: char| {
        let rows = rows(&OWN, "\",\"", decimal, "\"\n");
        let lines = rows.lines().map(|line| format!("\"{line}\n"));
        NAMES.map(|name| format!("\"{name}\"")).join(",") + "\n" + &lines.collect::<String>()
    };
    let newtons = || rows(&NEWTONS, ";", ',', "\n");
    let mut all = vec![
        Dialect {
            outcome: Outcome::Read(vec![]),
            ..dialect("our own: comma, point", own.clone(), &[])
        },
        Dialect {
            outcome: Outcome::Read(vec![]),
            ..dialect(
                "our own, CRLF and a byte order mark",
                format!("\u{feff}{}", own.replace('\n', "\r\n")),
                &[],
            )
        },
        dialect(
            "comma, point, names of another program",
            table(",", '.', "\n"),
            &["force is read from column \"Load [kN]\" in kN"],
        ),
        dialect(
            "comma and blank",
            table(", ", '.', "\n"),
            &["displacement is read"],
        ),
        dialect(
            "semicolon, point",
            table(";", '.', "\n"),
            &["a semicolon", "a point"],
        ),
        dialect(
            "semicolon, comma",
            table(";", ',', "\n"),
            &["a semicolon", "the decimal sign is a comma"],
        ),
        dialect(
            "semicolon, comma, CRLF",
            table(";", ',', "\r\n"),
            &["the decimal sign is a comma"],
        ),
        dialect("tab, point", table("\t", '.', "\n"), &["a tab"]),
        dialect("tab, comma", table("\t", ',', "\n"), &["a tab", "a comma"]),
        dialect("tab, CR alone", table("\t", '.', "\r"), &["a tab"]),
        dialect("bar, point", table("|", '.', "\n"), &["a bar"]),
        dialect("blanks, point", table(" ", '.', "\n"), &["blanks"]),
        dialect(
            "several blanks, comma",
            table("   ", ',', "\n"),
            &["blanks", "a comma"],
        ),
        dialect("fixed width", fixed, &["blanks"]),
        dialect(
            "quoted cells, comma and point",
            quoted('.'),
            &["force is read"],
        ),
        dialect(
            "quoted cells, comma as both",
            quoted(','),
            &["the decimal sign is a comma"],
        ),
        dialect(
            "sep= of Excel",
            format!("sep=;\r\n{}", table(";", ',', "\r\n")),
            &["a semicolon"],
        ),
        dialect(
            "a separator at the end of rows",
            NAMES.join(";") + "\n" + &rows(&OWN, ";", ',', ";\n"),
            &["a semicolon"],
        ),
        dialect(
            "separators at the end of names and rows",
            NAMES.join(",") + ",,\n" + &rows(&OWN, ",", '.', ",,\n"),
            &["force is read"],
        ),
        dialect(
            "rows of separators alone at the end",
            table(";", ',', "\n") + ";;\n;;\n",
            &["a semicolon"],
        ),
        dialect(
            "a blank line behind each",
            table("\t", '.', "\r\r\n"),
            &["a tab"],
        ),
    ];
    all.push(Dialect {
        columns: NEWTONS,
        ..dialect(
            "own names, semicolon, comma",
            format!("time_s;displacement_mm;force_N\n{}", newtons()),
            &["a semicolon"],
        )
    });
    all
}
