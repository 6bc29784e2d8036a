//! The page of a made-up batch.

use mesh_damper_identify::trace::result::Estimate;

use super::*;

/// Rows of three groups: every fifth failed, the others have each verdict in turn.
fn rows(count: usize) -> Vec<BatchRow> {
    let estimate = |value: f64, unit: &str| Estimate {
        value,
        low: 0.97 * value,
        high: 1.04 * value,
        unit: unit.into(),
    };
    let row = |i: usize| {
        let part = (i * 7919 % 1000) as f64 / 1000.0;
        let conclusion = Conclusion::ALL[i / 5 % 6];
        let parameters = [
            ("slip_limit".to_owned(), estimate(0.03 * (1.0 + part), "mm")),
            ("stiffness".to_owned(), estimate(1.2 + part, "kN/mm")),
        ];
        let effect = BatchEffect {
            family: if i.is_multiple_of(3) {
                "stick_slip"
            } else {
                "compliance"
            }
            .into(),
            parameters: parameters.into(),
        };
        let noise = 0.002 * (1.0 + 4.0 * part);
        let found = matches!(conclusion, Conclusion::Found | Conclusion::Ambiguous);
        let outcome = BatchOutcome {
            conclusion,
            effects: if found { vec![effect] } else { Vec::new() },
            adopted: !i.is_multiple_of(16),
            nrmse_before: noise * (1.0 + 10.0 * part),
            nrmse_after: noise * (1.0 + part * part),
            noise,
            warnings: vec![format!("test-{i:04}.csv: spikes in the force: {i} samples"); i % 2],
            report: Some(format!("reports/test-{i:04}/report.html")),
        };
        let message = format!(
            "day-{}/test-{i:04}.csv: column `force_kN`: every value is 0; check the load cell",
            i % 3
        );
        BatchRow {
            id: format!("day-{}/test-{i:04}.csv", i % 3),
            group: Some(format!("specimen {}", i % 3)),
            recordings: vec![format!("day-{}/test-{i:04}.csv", i % 3)],
            held_out: Vec::new(),
            seconds: 1.0 + part,
            outcome: if i % 5 == 4 {
                Err(message)
            } else {
                Ok(outcome)
            },
        }
    };
    (0..count).map(row).collect()
}

#[test]
fn every_row_is_there_once_and_counted() {
    let rows = rows(200);
    let page = batch_page(&rows);
    if let Ok(directory) = std::env::var("REPORT_PREVIEW") {
        std::fs::write(std::path::Path::new(&directory).join("batch.html"), &page).unwrap();
    }
    crate::structure::check(&page);
    for (conclusion, count) in Conclusion::ALL.into_iter().zip([28, 28, 28, 28, 24, 24]) {
        let counted = format!("{count} {}", conclusion.words());
        assert!(page.contains(&counted), "{counted}");
    }
    assert!(page.contains("80 of 160 traces have warnings"));
    assert!(page.contains("title=\"test-0001.csv: spikes in the force: 1 samples\">1</td>"));
    assert_eq!(page.matches("href=\"reports/test-").count(), 160);
    assert_eq!(page.matches("check the load cell").count(), 40);
    for said in [
        "specimen 2",
        "stick-slip (slip limit 0.03",
        "tr data-drawn",
        "not adopted",
        "1.5 times the noise",
        "stick-slip: slip limit",
    ] {
        assert!(page.contains(said), "{said}");
    }
    // One point before and one after for each trace.
    let rows = page.matches("data-rows=\"tr[data-drawn]\"").count();
    assert_eq!(rows, 2);
}

#[test]
fn thousands_of_rows_are_a_page_that_opens() {
    let few = batch_page(&rows(1000)).len();
    let many = batch_page(&rows(5000)).len();
    assert!(many < 2_000_000, "{many}");
    // The size per row does not depend on the number of rows.
    let each = (many - few) / 4000;
    assert!(each < 400, "{each}");
}

#[test]
fn nothing_and_only_failures_are_a_page() {
    assert!(batch_page(&[]).contains("Nothing was traced"));
    let mut rows = rows(5);
    rows.retain(|row| row.outcome.is_err());
    let page = batch_page(&rows);
    assert!(page.contains("1 failed") && page.contains("5. Failures"));
    assert!(!page.contains("4. Traces"));
}

#[test]
fn a_trace_without_noise_is_in_the_table_and_not_in_the_picture() {
    let mut rows = rows(2);
    for row in &mut rows {
        if let Ok(outcome) = &mut row.outcome {
            outcome.noise = 0.0;
            outcome.report = None;
        }
    }
    let page = batch_page(&rows);
    assert!(!page.contains("2. Errors and noise") && !page.contains("<tr data-drawn"));
    assert!(page.contains("4. Traces"));
}

#[test]
fn many_groups_are_a_table_of_the_largest() {
    let mut rows = rows(300);
    for (i, row) in rows.iter_mut().enumerate() {
        row.group = Some(format!("g{}", i.min(100)));
    }
    let groups = groups::groups(&rows);
    assert_eq!(groups.len(), 40);
    assert_eq!(groups[39].name, "62 other groups");
    assert!(groups.iter().any(|group| group.name == "g100"));
    let sum: usize = groups.iter().map(|group| group.rows.len()).sum();
    assert_eq!(sum, 300);
}

/// For an even number of traces the median lies between two; an ambiguous one does not count.
#[test]
fn the_median_is_that_of_what_was_found() {
    let mut all = rows(8);
    let mut values = [1.0, 4.0, 100.0].into_iter();
    all.retain(|row| row.outcome.is_ok());
    all.truncate(3);
    for (row, conclusion) in all.iter_mut().zip([
        Conclusion::Found,
        Conclusion::Unlisted,
        Conclusion::Ambiguous,
    ]) {
        row.group = None;
        let Ok(outcome) = &mut row.outcome else {
            panic!()
        };
        let value = values.next().unwrap();
        let stiffness = Estimate {
            value,
            low: 0.9 * value,
            high: 1.1 * value,
            unit: "kN/mm".into(),
        };
        outcome.conclusion = conclusion;
        outcome.effects = vec![BatchEffect {
            family: "stick_slip".into(),
            parameters: [("stiffness".to_owned(), stiffness)].into(),
        }];
    }
    let page = batch_page(&all);
    let cells = "<td>2</td><td>2.50</td><td>1.00</td><td>4.00</td><td>0.250</td>";
    assert!(page.contains(cells), "{page}");
    // Without groups, the page does not mention them.
    assert!(!page.contains("without a group"));
}
