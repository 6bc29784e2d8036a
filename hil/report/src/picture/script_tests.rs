//! The script draws the same axes after a zoom as the page had before it. Node.js runs it here.

use std::io::Write as _;
use std::process::{Command, Stdio};

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::axis::{Axis, Scale};

/// Writes each tick of each line `scale from to most` as `place<TAB>label`, and a line `end` after them.
const MAIN: &str = r#"
for (const line of require("fs").readFileSync(0, "utf8").trim().split("\n")) {
  const [scale, ...numbers] = line.split(" ");
  const [from, to, most] = numbers.map(Number);
  const ticks = ticksOf({ scale }, from, to, most);
  console.log(ticks.map(([place, label]) => place + "\t" + label + "\n").join("") + "end");
}
"#;

#[test]
fn the_script_has_the_ticks_of_the_page() {
    if Command::new("node").arg("--version").output().is_err() {
        assert!(
            std::env::var_os("CI").is_none(),
            "node is missing: install nodejs"
        );
        eprintln!("left out: node is missing; install nodejs");
        return;
    }
    let mut draws = ChaCha8Rng::seed_from_u64(37);
    let mut cases = Vec::new();
    for scale in [Scale::Linear, Scale::Logarithmic, Scale::CubeRoot] {
        for _ in 0..300 {
            // Places: of values from thousandths to thousands.
            let (middle, size) = match scale {
                Scale::Linear => (
                    draws.random_range(-10.0..10.0),
                    draws.random_range(-2.0..3.0),
                ),
                Scale::Logarithmic => {
                    (draws.random_range(-2.0..2.0), draws.random_range(-0.5..0.5))
                }
                Scale::CubeRoot => (draws.random_range(-1.0..1.0), draws.random_range(-0.5..0.5)),
            };
            let half = 0.5 * 10_f64.powf(size);
            cases.push((
                scale,
                middle - half..middle + half,
                draws.random_range(2..9),
            ));
        }
    }
    let lines = cases.iter().map(|(scale, ends, most)| {
        format!("{} {} {} {most}\n", scale.name(), ends.start, ends.end)
    });
    let script = format!("{}{MAIN}", include_str!("../script/axis.js"));
    let mut node = Command::new("node")
        .args(["-e", &script])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = node.stdin.take().unwrap();
    input
        .write_all(lines.collect::<String>().as_bytes())
        .unwrap();
    drop(input);
    let output = node.wait_with_output().unwrap();
    assert!(output.status.success());
    let said = String::from_utf8(output.stdout).unwrap();
    let drawn: Vec<&str> = said.split("end\n").collect();
    let mut ticks = 0;
    for ((scale, ends, most), drawn) in cases.iter().zip(&drawn) {
        let axis = Axis {
            scale: *scale,
            ..Axis::new("force", "kN")
        };
        let of_page = axis.ticks(ends, *most);
        let of_script: Vec<(f64, String)> = drawn
            .lines()
            .filter_map(|line| line.split_once('\t'))
            .map(|(place, label)| (place.parse().unwrap(), label.to_owned()))
            .collect();
        let labels = |ticks: &[(f64, String)]| -> Vec<String> {
            ticks.iter().map(|(_, label)| label.clone()).collect()
        };
        assert_eq!(
            labels(&of_page),
            labels(&of_script),
            "{scale:?} {ends:?} {most}"
        );
        for ((place, _), (other, _)) in of_page.iter().zip(&of_script) {
            assert!(
                (place - other).abs() <= 1e-9 * (ends.end - ends.start),
                "{scale:?} {ends:?}"
            );
        }
        ticks += of_page.len();
    }
    // Axes without a tick would agree as well.
    assert!(ticks > 3 * cases.len(), "{ticks}");
}
