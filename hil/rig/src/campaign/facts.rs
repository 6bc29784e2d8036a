//! What is known of an injected change beforehand: the element that fails, its sizes, and how soon it must be found.

use mesh_damper::health::{Channel, HealthCause};
use serde::Serialize;

use super::trial::RAMP;

/// The element of the rig that fails, in the order of the coverage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each is what its name says")]
pub enum Element {
    DisplacementChannel,
    ForceChannel,
    Temperature,
    ControlInput,
    ActuatorAndDac,
    EnableLine,
    Clock,
    Link,
    Specimen,
    Settings,
}

/// When a change begins in its own trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    /// Before the rig is started.
    AtStart,
    /// While the monitor learns.
    WhileLearning,
    /// After learning, at a given moment of a cycle.
    Later,
    /// After learning, at the end of a cycle.
    AtCycleEnd,
    /// In the third of four short blocks.
    InShortBlock,
}

/// When a change that has begun counts as present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Present {
    /// After this many cycles.
    After(f64),
    /// When it has grown to this amount; its size is its growth per cycle.
    Grown(f64),
    /// When it has grown to the monitor's size, or beyond the bound of the adaptation. It differs from the run-in only by being
    /// later.
    GrownLater,
}

/// Cycles within which a change must be found. The first is for channels with a limit and for the actuator. The second is for the
/// specimen, and for a channel that still follows its quantity, which shows only in the results of whole cycles.
const SOON: f64 = 1.0;
const IN_CYCLES: f64 = 5.0;

/// The monitor's size: the amount at which a slow change counts as a fault.
pub(super) const SIZE: f64 = 0.05;
/// The amount at which a slow change counts as a fault while the specimen settles, beyond any run-in.
pub(super) const RUN_IN: f64 = 0.25;
/// Cycle, from the end of the first ramp, in which a specimen breaks while the monitor learns, and the cycle at whose end it has
/// learned.
pub(super) const LEARNING: (f64, f64) = (10.0, 17.0);

/// What is known of a change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facts {
    /// The element that fails.
    pub(super) element: Element,
    /// Sizes to try.
    pub(super) sizes: &'static [f64],
    /// The name that the monitor has for it, and must give it first; `None` if it is defined without knowledge of the monitor.
    pub(super) known: Option<HealthCause>,
    /// Cycles within which it must be found, from the time when it counts as present.
    pub(super) within: f64,
    /// When it begins in its own trial.
    pub(super) begins: Begins,
    pub(super) present: Present,
    /// Why a single channel per quantity, without a read-back, cannot show it; `None` if it can.
    pub(super) hidden: Option<&'static str>,
    /// Whether it can lead to a hazardous state or disable the protection against one. A specimen that becomes weaker cannot, nor
    /// can an actuator that is cut off.
    pub(super) is_dangerous: bool,
    /// The channel that a limit depends on and that no longer shows its quantity.
    pub(super) loses: Option<Channel>,
    /// Whether it makes a trial alone.
    pub(super) is_single: bool,
    /// For a size that is a number of a bit, of samples or of ticks: the smallest and the largest one that the adversary draws.
    pub(super) counted: Option<(u32, u32)>,
}

/// Facts of a dangerous change of `element` that begins later, is present at once and can be observed.
pub(super) fn on(element: Element, sizes: &'static [f64]) -> Facts {
    Facts {
        element,
        sizes,
        known: None,
        within: match element {
            Element::Specimen => IN_CYCLES,
            _ => SOON,
        },
        begins: Begins::Later,
        present: Present::After(0.0),
        hidden: None,
        is_dangerous: true,
        loses: None,
        is_single: true,
        counted: None,
    }
}

/// The same, of a channel.
pub(super) fn on_channel(channel: Channel, sizes: &'static [f64]) -> Facts {
    let element = match channel {
        Channel::Displacement => Element::DisplacementChannel,
        Channel::Force => Element::ForceChannel,
    };
    on(element, sizes)
}

impl Facts {
    pub(super) fn known(self, cause: HealthCause) -> Self {
        let known = Some(cause);
        Self { known, ..self }
    }

    /// It shows only in the results of whole cycles.
    pub(super) fn in_cycles(self) -> Self {
        let within = IN_CYCLES;
        Self { within, ..self }
    }

    /// Before the end of the ramp little can be seen.
    pub(super) fn at_start(self) -> Self {
        self.begins(Begins::AtStart)
            .present(Present::After(f64::from(RAMP)))
    }

    pub(super) fn begins(self, begins: Begins) -> Self {
        Self { begins, ..self }
    }

    pub(super) fn present(self, present: Present) -> Self {
        Self { present, ..self }
    }

    pub(super) fn hidden(self, why: &'static str) -> Self {
        let hidden = Some(why);
        Self { hidden, ..self }
    }

    pub(super) fn hidden_if(self, is_hidden: bool, why: &'static str) -> Self {
        if is_hidden { self.hidden(why) } else { self }
    }

    pub(super) fn harmless(self) -> Self {
        let is_dangerous = false;
        Self {
            is_dangerous,
            ..self
        }
    }

    pub(super) fn loses(self, channel: Channel) -> Self {
        let loses = Some(channel);
        Self { loses, ..self }
    }

    /// It changes nothing alone, or no signal of the campaign shows it.
    pub(super) fn only_with_others(self) -> Self {
        let is_single = false;
        Self { is_single, ..self }
    }

    pub(super) fn counted(self, least: u32, most: u32) -> Self {
        let counted = Some((least, most));
        Self { counted, ..self }
    }
}
