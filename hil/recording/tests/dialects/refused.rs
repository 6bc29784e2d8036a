//! Files that cannot be read, with the expected message.

use super::corpus::{Dialect, KN, MM, OWN, Outcome, S, SAMPLES, rows};

pub fn dialects() -> Vec<Dialect> {
    let dialect = |name, text: String, said: &[&'static str]| Dialect {
        family: "refused",
        name,
        bytes: text.into_bytes(),
        columns: OWN,
        outcome: Outcome::Refused(said.to_vec()),
    };
    let all = rows(&OWN, ";", ',', "\n");
    let lines: Vec<&str> = all.split_inclusive('\n').collect();
    let (first, second) = lines.split_at(SAMPLES / 2);
    let names = "Time [s];Disp [mm];Load [kN]\n";
    let table = |middle: &str| format!("{names}{}{middle}{}", first.concat(), second.concat());
    let wide = rows(&[S, MM, KN, S], ";", ',', "\n");
    let wide_names = "Time [s];Disp [mm];Load [kN];Run [s]\n";
    let remedy = "export it again with a semicolon";
    vec![
        dialect(
            "comma as separator and decimal sign",
            format!(
                "Time [s],Disp [mm],Load [kN]\n{}",
                rows(&OWN, ",", ',', "\n")
            ),
            &[remedy],
        ),
        dialect(
            "the same, with a name for each part",
            format!("Time,s,Disp,mm,Load,kN\n{}", rows(&OWN, ",", ',', "\n")),
            &[remedy],
        ),
        dialect(
            "time that begins again in a second block",
            format!("{names}{all}\n{names}{all}"),
            &["runs backwards", "several files"],
        ),
        dialect(
            "words in the middle",
            table("the pump was off\n"),
            &["line 26", "words stand between"],
        ),
        dialect(
            "the header again with other units",
            table("\nTime [s];Disp [mm];Load [N]\n"),
            &["line 27", "words stand between"],
        ),
        dialect(
            "names in a comment, and other ones later",
            format!(
                "# Time_s Disp_mm Load_kN\n{}# Time_s Disp_mm Load_N\n{}",
                first.concat(),
                second.concat()
            )
            .replace(';', " "),
            &["line 26", "names other columns or units"],
        ),
        dialect(
            "a row too short",
            table("0,9;1,5\n"),
            &["line 26", "2 cells", "a semicolon"],
        ),
        dialect(
            "a row too long",
            table("0,9;1,5;2,5;3,5\n"),
            &["line 26", "4 cells", "a semicolon"],
        ),
        dialect(
            "a number that is damaged",
            table("0,9;1,5x;2,5\n"),
            &["line 26, column Disp [mm]", "\"1,5x\" is not a number"],
        ),
        dialect(
            "a decimal point among commas",
            table("0,9;1.5;2,5\n"),
            &["line 26: \"1.5\"", "use different signs"],
        ),
        dialect(
            "more names than cells",
            format!("Time [s];Disp [mm];Load [kN];Temp [°C];Current [A]\n{all}"),
            &["line 1", "5 cells", "have 3", "a semicolon"],
        ),
        dialect(
            "a second table with a column more",
            format!("{names}{all}\nTest 2\n{wide_names}{wide}"),
            &[
                "line 51",
                "another table begins",
                "from line 53 on",
                "file of its own",
            ],
        ),
        dialect(
            "a table of peaks above that of the samples",
            format!("{wide_names}{wide}\nRaw data\n{names}{all}"),
            &["line 51", "another table begins", "from line 53 on"],
        ),
        dialect(
            "a column more behind a blank line",
            format!("{names}{all}\n{wide}"),
            &["line 51", "4 cells where the rows above have 3"],
        ),
        dialect(
            "a column less behind a blank line",
            format!("{names}{all}\n{}", rows(&[S, MM], ";", ',', "\n")),
            &["line 51", "2 cells where the rows above have 3"],
        ),
        dialect(
            "overload behind a blank line",
            table("\n0,9;1,5;OVLD\n"),
            &["line 27, column Load [kN]", "\"OVLD\" is not a number"],
        ),
        dialect(
            "overload behind words",
            format!(
                "{names}{all}the pump was on\n{}",
                "0,9;1,5;OVLD\n".repeat(3)
            ),
            &["line 50", "words stand between", "go on in line 51"],
        ),
        dialect(
            "overload behind a blank line, to the end",
            format!("{names}{all}\n{}", "0,9;1,5;OVLD\n".repeat(3)),
            &["line 51, column Load [kN]", "\"OVLD\" is not a number"],
        ),
        dialect(
            "no numbers",
            "Dear reader,\nthis is a letter.\n".into(),
            &["holds no rows", "commas, semicolons, tabs"],
        ),
    ]
}
