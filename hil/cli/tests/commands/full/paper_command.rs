//! `hil paper`: every claim's row with its numbers, the report, and the JSON.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use serde_json::Value;

mod recomputed;

use crate::command::{hil, words};
use recomputed::{Row, rows};

const DOCS: &str = include_str!("../../../../../docs/paper.md");

/// The result as JSON and the report, of one run for all tests.
fn run() -> &'static (Value, String) {
    static RUN: OnceLock<(Value, String)> = OnceLock::new();
    RUN.get_or_init(|| {
        let root = tempfile::tempdir().unwrap();
        let output = hil(root.path(), &words("paper --out new/out --json -"));
        let page = std::fs::read_to_string(root.path().join("new/out/report.html")).unwrap();
        let paper = serde_json::from_str(&output).unwrap();
        crate::full::schema_command::is_as_its_schema_says("paper", &paper);
        (paper, page)
    })
}

fn claims() -> &'static Vec<Value> {
    run().0["claims"].as_array().unwrap()
}

#[test]
#[ignore = "a minute: in the full tier"]
fn every_claim_has_its_verdict_and_its_numbers() {
    let names: Vec<&str> = claims()
        .iter()
        .map(|claim| claim["name"].as_str().unwrap())
        .collect();
    let rows: Vec<&Row> = rows().collect();
    let expected: Vec<&str> = rows.iter().map(|row| row.0).collect();
    assert_eq!(names, expected);
    for (claim, (name, verdict, figures)) in claims().iter().zip(rows) {
        assert_eq!(claim["verdict"], *verdict, "{claim}");
        for field in ["place", "says", "reason"] {
            assert!(claim[field].as_str().unwrap().len() > 3, "{claim}");
        }
        let found = claim["figures"].as_object().unwrap();
        let names: BTreeSet<&str> = found.keys().map(String::as_str).collect();
        let expected: BTreeSet<&str> = figures.iter().map(|figure| figure.0).collect();
        assert_eq!(names, expected, "{name}");
        for (figure, expected) in *figures {
            let found = found[*figure].as_f64().unwrap();
            // The absolute term allows for values that are 0 except for rounding.
            assert!(
                (found - expected).abs() <= 6e-4 * expected.abs() + 1e-6,
                "{name}, {figure}: {found}, expected {expected}"
            );
        }
    }
}

#[test]
#[ignore = "a minute: in the full tier"]
fn the_json_holds_every_number() {
    let (json, _) = run();
    let cells = json["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 5);
    for cell in cells.iter().flat_map(|row| row.as_array().unwrap()) {
        for field in ["density", "amplitude", "inflections"] {
            assert!(cell[field].is_number(), "{cell}");
        }
        for field in ["stiffness", "loss_factor", "dissipated"] {
            assert!(cell["dynamics"][field].as_f64().unwrap() > 0.0, "{cell}");
        }
        assert!(cell["coefficients"]["alpha"].is_number());
    }
    let fits = json["fits"].as_array().unwrap();
    assert_eq!(fits.len(), 3);
    assert!(
        fits.iter()
            .all(|fit| fit["free"].as_array().unwrap().len() == 25)
    );
    assert_eq!(json["left_out"].as_array().unwrap().len(), 100);
    assert_eq!(json["orthogonal_test"].as_array().unwrap().len(), 2);
    let errors = json["surface_errors"].as_array().unwrap();
    assert_eq!(errors.len(), 4);
    for one in errors {
        let cells = one["loop_error"].as_array().unwrap().iter();
        let cells: Vec<f64> = cells
            .flat_map(|row| row.as_array().unwrap())
            .map(|error| error.as_f64().unwrap())
            .collect();
        let mean = cells.iter().sum::<f64>() / 25.0;
        assert!((mean - one["mean"].as_f64().unwrap()).abs() < 1e-9, "{one}");
    }
    assert_eq!(json["surfaces"]["degree"], 2);
    for (over, field) in [("by_density", "density"), ("by_amplitude", "amplitude")] {
        let conditions = json["comparison"][over].as_array().unwrap();
        assert_eq!(conditions.len(), 5);
        let at: Vec<f64> = conditions
            .iter()
            .map(|one| one[field].as_f64().unwrap())
            .collect();
        assert!(at.is_sorted());
        for one in conditions {
            for law in ["printed", "corrected", "surfaces"] {
                assert_eq!(one[law]["sigma"].as_array().unwrap().len(), 4, "{one}");
                assert!(one[law]["nrmse"].is_number());
            }
            assert!(one["finite_elements"]["Ok"]["nrmse"].is_number(), "{one}");
        }
    }
    let elements = &json["elements"];
    let readings = elements["readings"].as_array().unwrap();
    assert_eq!(readings.len(), 6);
    for one in readings {
        let loops = one["by_density"].as_array().unwrap();
        assert_eq!(loops.len(), 5);
        for found in loops {
            let told = found["Ok"]["nrmse"].is_number() || found["Err"].is_string();
            assert!(told, "{one}");
        }
    }
    assert_eq!(elements["bores"].as_array().unwrap().len(), 4);
    // The interpretation and the bore with which the law is compared.
    let compared = &json["comparison"]["by_density"][0]["finite_elements"]["Ok"];
    assert_eq!(readings[1]["by_density"][0]["Ok"], *compared);
    assert_eq!(elements["bores"][2]["found"]["Ok"], *compared);
    let forces: Vec<f64> = elements["meshes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|mesh| mesh["force"]["Ok"].as_f64().unwrap())
        .collect();
    let changes: Vec<f64> = forces.windows(2).map(|pair| pair[0] - pair[1]).collect();
    assert!(
        changes.len() == 3 && changes.windows(2).all(|pair| pair[1].abs() < pair[0].abs()),
        "{forces:?}"
    );
    for one in elements["compressions"].as_array().unwrap() {
        let force = one["curve"]["Ok"]["force"].as_array().unwrap();
        let force: Vec<f64> = force.iter().map(|force| force.as_f64().unwrap()).collect();
        assert!(force.len() == 11 && force.is_sorted(), "{one}");
    }
}

#[test]
#[ignore = "a minute: in the full tier"]
fn the_report_holds_every_claim_and_figure_and_needs_no_other_file() {
    let (_, page) = run();
    assert!(page.len() < 3_000_000, "{}", page.len());
    for claim in claims() {
        let says = claim["says"].as_str().unwrap().replace('>', "&gt;");
        assert!(page.contains(&says), "{says}");
    }
    for figure in [
        "The model of Figure 4",
        "Figures 5–7",
        "Figure 8",
        "Figure 9",
        "Figures 10 and 11",
        "Figures 12 and 13",
        "Figure 14",
        "Figure 15",
        "Figure 16",
        "Figure 17",
        "Figure 18",
    ] {
        assert!(page.contains(&format!("<h3>{figure}")), "{figure}");
    }
    // Neither the page nor its script fetches anything.
    let own = page.replace("http://www.w3.org/2000/svg", "");
    for foreign in [
        "http://",
        "https://",
        " src=",
        "<link",
        "@import",
        "url(",
        "fetch(",
        "import(",
        "XMLHttpRequest",
        "WebSocket",
    ] {
        assert!(!own.contains(foreign), "{foreign}");
    }
    // Every number is valid.
    let (content, script) = own.split_once("<script>").unwrap();
    assert!(!content.contains("NaN"));
    assert!(script.ends_with("</script></body></html>"));
}

#[test]
#[ignore = "a minute: in the full tier"]
fn the_docs_tell_how_many_claims_hold_and_what_the_surfaces_are_worth() {
    let count = |verdict: &str| {
        claims()
            .iter()
            .filter(|claim| claim["verdict"] == verdict)
            .count()
    };
    let said = format!(
        "Of {} claims {} hold, {} fail and {} cannot be decided",
        claims().len(),
        count("holds"),
        count("fails"),
        count("cannot_tell")
    );
    let docs = DOCS.replace('\n', " ");
    assert!(docs.contains(&said), "{said}");
    let figure = |claim: &str, figure: &str| {
        let mut all = claims().iter();
        let claim = all.find(|one| one["name"] == claim).unwrap();
        claim["figures"][figure].as_f64().unwrap()
    };
    let over_densities = |claim: &str, name: &str| {
        let at = [2.0, 2.5, 3.0, 3.5, 4.0];
        let values = at.map(|density| figure(claim, &format!("{name} at {density}")));
        let low = values.into_iter().fold(f64::INFINITY, f64::min);
        (low, values.into_iter().fold(0.0, f64::max))
    };
    let mean = |of: &str| {
        let mean = figure(
            "law_agrees_better_than_finite_elements",
            &format!("mean NRMSE, {of}"),
        );
        100.0 * mean
    };
    let bound =
        |law: &str| over_densities("law_error_below_0_375_by_density", &format!("σ, {law},")).1;
    let (least, most) = over_densities(
        "finite_elements_err_2_to_30_times_more",
        "ratio to crate's surfaces",
    );
    for said in [
        format!(
            "finite elements miss by {:.0} % on average",
            mean("finite elements")
        ),
        format!(
            "eq 20 with eq 18 corrected by {:.0} %, the crate's surfaces by {:.0} %",
            mean("eq 20 corrected"),
            mean("crate's surfaces")
        ),
        format!(
            "holds for the crate's surfaces (at most {:.2}) and not for eq 20 ({:.2})",
            bound("crate's surfaces"),
            bound("eq 20 corrected")
        ),
        format!("is {least:.1} to {most:.1} times that of the surfaces"),
    ] {
        assert!(docs.contains(&said), "{said}");
    }
    for one in run().0["surface_errors"].as_array().unwrap() {
        let start = format!("| {} |", one["name"].as_str().unwrap());
        let row = DOCS.lines().find(|line| line.starts_with(&start));
        let row = row.unwrap_or_else(|| panic!("no row {start}"));
        let said = row[start.len()..].trim_matches(['|', ' ']).split('|');
        for (said, field) in said.zip(["mean", "largest"]) {
            let said: f64 = said.trim().parse().unwrap();
            let found = 100.0 * one[field].as_f64().unwrap();
            assert!(
                (said - found).abs() <= 0.06_f64.max(1e-3 * found),
                "{row}: {found}"
            );
        }
    }
}
