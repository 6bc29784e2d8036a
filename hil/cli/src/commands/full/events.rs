//! Events of the rig's monitor, as rows of JSON and in words.

use mesh_damper::health::{Channel, Event, HealthCause, Statistic};
use schemars::JsonSchema;
use serde::Serialize;

/// One event with its evidence.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(super) struct EventRow {
    /// Time since the start, s.
    time: f64,
    /// Cycles completed since the start.
    cycle: u32,
    /// The cause, by the crate's name, as `hil faults` prints it.
    cause: String,
    /// Another possible cause, if the signals cannot distinguish the two; null otherwise.
    or: Option<String>,
    /// Whether the event is a fault; false for a run-in and for the temperature.
    fault: bool,
    /// The statistic that changed, by the crate's name.
    statistic: String,
    /// The value of the statistic: as a fraction, in mm or in kN, depending on the statistic. For a sample it is the sample itself;
    /// null if that is no number.
    value: Option<f32>,
    /// The limit of the value, in the same unit.
    limit: f32,
    #[serde(skip)]
    event: Event,
}

impl EventRow {
    pub(super) fn new(&(time, event): &(f64, Event)) -> Self {
        Self {
            time,
            cycle: event.cycle,
            cause: format!("{:?}", event.cause),
            or: event.or.map(|or| format!("{or:?}")),
            fault: event.cause.is_fault(),
            statistic: format!("{:?}", event.statistic),
            value: Some(event.value).filter(|value| value.is_finite()),
            limit: event.limit,
            event,
        }
    }

    /// The event in one line.
    pub(super) fn in_words(&self) -> String {
        let kind = if self.fault { "Fault" } else { "Note" };
        format!(
            "{kind} found {:.3} s after the start, in cycle {}: {}",
            self.time,
            self.cycle,
            self.what()
        )
    }

    /// The cause with its evidence.
    fn what(&self) -> String {
        let Event {
            cause, or, value, ..
        } = self.event;
        let limit = self.limit;
        let percent = |what: &str| {
            format!(
                "{what} moved by {:+.1} %, limit {:.1} %",
                100.0 * value,
                100.0 * limit
            )
        };
        let evidence = match self.event.statistic {
            Statistic::Stiffness => percent("the stiffness"),
            Statistic::Energy => percent("the energy"),
            Statistic::MeanForce => percent("the mean force"),
            Statistic::Residual => percent("the residual"),
            Statistic::ThirdHarmonic => percent("its third harmonic"),
            Statistic::MeanCommand => percent("the mean command"),
            Statistic::Response => percent("the response to the demanded motion"),
            Statistic::Noise => format!(
                "noise is {:.2} % of the amplitude, limit {:.2} %",
                100.0 * value,
                100.0 * limit
            ),
            Statistic::Explained => format!(
                "the motion explains {:.0} % of the force, limit {:.0} %",
                100.0 * value,
                100.0 * limit
            ),
            Statistic::Sample if cause == HealthCause::TemperatureImplausible => {
                format!("it measured {value:.1} °C")
            }
            Statistic::Sample => match cause.channel() {
                Some(Channel::Displacement) => format!("it measured {value:.4} mm"),
                Some(Channel::Force) => format!("it measured {value:.4} kN"),
                None => format!("a sample of {value:.4}"),
            },
        };
        format!(
            "{cause}{}; {evidence}",
            or.map_or_else(String::new, |or| format!(" or {or}"))
        )
    }

    /// The event as the live page and the broker get it.
    pub(super) fn live(&self) -> mesh_damper_live::Event {
        mesh_damper_live::Event {
            time: self.time,
            cycle: self.cycle,
            cause: self.cause.clone(),
            or: self.or.clone(),
            fault: self.fault,
            text: self.what(),
        }
    }
}

#[cfg(test)]
mod tests {
    use mesh_damper_output::finite::check_document;

    use super::*;

    #[test]
    fn a_sample_that_is_no_number_is_null() {
        let mut event = Event {
            cause: HealthCause::TemperatureImplausible,
            or: None,
            statistic: Statistic::Sample,
            value: f32::NAN,
            limit: 20.0,
            cycle: 3,
        };
        for (value, written) in [
            (f32::NAN, None),
            (f32::INFINITY, None),
            (999.0, Some(999.0)),
        ] {
            event.value = value;
            let row = EventRow::new(&(1.0, event));
            assert_eq!(row.value, written);
            check_document("run.json", &row).unwrap();
            assert!(row.in_words().contains("it measured"));
        }
    }
}
