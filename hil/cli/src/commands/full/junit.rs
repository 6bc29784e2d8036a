//! The checks of a command as a JUnit file, which build servers show test by test.

use std::path::Path;
use std::time::{Duration, Instant};

use mesh_damper_output::Outputs;
use mesh_damper_output::documents;
use mesh_damper_output::error::InputError;
use mesh_damper_rig::check::Check;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use crate::commands::{Failure, warn};

/// The result of one check.
pub enum Case {
    /// The check passed.
    Passed,
    /// The check failed, with the value that was reached.
    Failed(String),
    /// The check was not made or does not count, with the reason.
    Skipped(String),
}

/// Does the `work` of the command `name`, which starts now; it adds its checks to `outputs`, and writes them. If it breaks off, one
/// failed check replaces them in the planned file at `path`: a build server would take an older file for the result of this run.
///
/// # Errors
/// Those of `work`.
pub fn judged(
    name: &str,
    path: Option<&Path>,
    outputs: &mut Outputs,
    work: impl FnOnce(Junit, &mut Outputs) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut broken_off = Junit::of(name);
    let done = work(Junit::of(name), outputs);
    // Where a check failed, the file has been written.
    if let (Some(path), Err(failure @ (Failure::Input(_) | Failure::Trace(_)))) = (path, &done) {
        let reason = Case::Failed(failure.to_string());
        broken_off.case("command", "the command runs to its end", reason, None);
        let written = broken_off.text(path);
        if let Err(error) = written.and_then(|text| outputs.write_alone(path, text.as_bytes())) {
            warn(&error.to_string());
        }
    }
    done
}

/// One suite: the checks of one command.
pub struct Junit {
    suite: TestSuite,
    started: Instant,
}

impl Junit {
    /// The suite of the command `name`, which starts now.
    fn of(name: &str) -> Self {
        Self {
            suite: TestSuite::new(format!("hil {name}")),
            started: Instant::now(),
        }
    }

    /// A property on which the results depend.
    pub fn property(&mut self, name: &str, value: impl ToString) {
        self.suite.add_property((name, value.to_string().as_str()));
    }

    /// A check of the class `class`; `time` is its duration, if known.
    pub fn case(&mut self, class: &str, name: &str, case: Case, time: Option<Duration>) {
        let status = match case {
            Case::Passed => TestCaseStatus::success(),
            Case::Failed(reason) => {
                let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
                status.set_message(reason.as_str());
                status.set_type("check");
                status.set_description(reason);
                status
            }
            Case::Skipped(reason) => {
                let mut status = TestCaseStatus::skipped();
                status.set_message(reason);
                status
            }
        };
        let mut case = TestCase::new(name, status);
        case.set_classname(format!(
            "{}.{class}",
            self.suite.name.as_str().replace(' ', ".")
        ));
        if let Some(time) = time {
            case.set_time(time);
        }
        self.suite.add_test_case(case);
    }

    /// Adds checks of the class `class`.
    pub fn checks(&mut self, class: &str, checks: impl IntoIterator<Item = Check>) {
        for Check {
            name,
            failure,
            is_judged,
        } in checks
        {
            let case = match failure {
                Some(failure) => Case::Failed(failure),
                None if is_judged => Case::Passed,
                None => Case::Skipped("no data for this check".into()),
            };
            self.case(class, &name, case, None);
        }
    }

    /// Adds the file to `outputs` under the planned `path`, if there is one.
    ///
    /// # Errors
    /// Text that XML cannot contain.
    pub fn add(self, outputs: &mut Outputs, path: Option<&Path>) -> Result<(), InputError> {
        let Some(path) = path else { return Ok(()) };
        let text = self.text(path)?;
        outputs.add(path, text);
        Ok(())
    }

    /// The file at `path`.
    fn text(mut self, path: &Path) -> Result<String, InputError> {
        let took = self.started.elapsed();
        self.suite.set_time(took);
        let mut report = Report::new("hil");
        report.set_time(took);
        report.add_test_suite(self.suite);
        let text = report.to_string().map_err(|error| {
            let name = path.display().to_string();
            InputError::new(
                name,
                format!("not to be written as XML: {error}"),
                "report this",
            )
        })?;
        Ok(documents::xml(&text))
    }
}
