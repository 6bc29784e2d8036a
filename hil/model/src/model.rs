//! The model that a trace produces and the rig runs: eq 13 with coefficients over amplitude, and added effects.

use std::collections::BTreeMap;

use mesh_damper::effects::description::{Absent, Description};
use mesh_damper::effects::{AugmentedLaw, Effect};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::pack::{self, LARGEST, PackError, PackInfo};
use mesh_damper::real::Real;
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_tables::control::ControlChannel;
use serde::{Deserialize, Serialize};

use crate::correction::{CorrectionTable, Remembered};
use crate::family::{Family, base_name};

/// Most effects that a model has in addition to eq 13.
pub const MAX_EFFECTS: usize = 8;

/// The coefficients of eq 13 at one amplitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LawNode {
    /// Amplitude, mm. It is 0 for a law with a single node, which does not depend on amplitude.
    pub amplitude: f64,
    /// Linear stiffness, kN/mm.
    pub k1: f64,
    /// Cubic stiffness, kN/mm³.
    pub k3: f64,
    /// Damping coefficient, kN·(s/mm)^α.
    pub c: f64,
    /// Damping exponent α of the velocity, dimensionless.
    pub alpha: f64,
}

/// One effect in addition to eq 13.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct AddedEffect {
    /// The family of the effect.
    pub family: Family,
    /// Its parameters by name, in the units of [`crate::parameter_unit`].
    pub parameters: BTreeMap<String, f64>,
}

/// The reason why a model cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The crate refused a coefficient.
    #[error("{place}: {error}")]
    Refused {
        /// The node or effect.
        place: String,
        /// The crate's error.
        error: ConfigError,
    },
    /// An effect lacks a parameter, or has one too many.
    #[error("{place}: {problem}")]
    Parameters {
        /// The effect.
        place: String,
        /// The parameter and its error.
        problem: String,
    },
    /// The law has no nodes, or its amplitudes do not increase.
    #[error("law: {0}")]
    Nodes(&'static str),
    /// The model does not fit into a coefficient pack.
    #[error("pack: {0}")]
    Pack(PackError),
}

/// Eq 13 over amplitude, with additions.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Coefficients at increasing amplitudes: interpolated linearly in between, held constant outside.
    pub law: Vec<LawNode>,
    /// The added effects, in the order in which their forces are added.
    pub effects: Vec<AddedEffect>,
    /// The residual table, in addition to the effects.
    pub correction: Option<CorrectionTable>,
    /// The control inputs that its effects see, by index.
    pub controls: Vec<Control>,
}

/// A control input on which effects of a model depend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Control {
    /// Name of the input's column in a recording, with the unit, for example `current_A`.
    pub name: String,
    /// Smallest and largest value that the model was fitted on, in the unit of the name.
    pub range: [f64; 2],
}

impl Control {
    /// A sentence about an input whose `values` go beyond the fitted range; `None` if they do not.
    pub fn beyond(&self, values: &[f64]) -> Option<String> {
        let ([low, high], (least, largest)) = (self.range, least_and_largest(values));
        (least < low || largest > high).then(|| {
            format!(
                "{} ranges from {least} to {largest}, but the model was fitted from {low} to {high}: the force is extrapolated",
                self.name
            )
        })
    }
}

impl Model {
    /// Eq 13 for a cycle of `amplitude` mm.
    ///
    /// # Errors
    /// No nodes, amplitudes that do not increase, or a coefficient out of range.
    pub fn law_at<R: Real>(&self, amplitude: f64) -> Result<Law<R>, ModelError> {
        if self.law.is_empty() {
            return Err(ModelError::Nodes("there is no node"));
        }
        if !self
            .law
            .windows(2)
            .all(|pair| pair[0].amplitude < pair[1].amplitude)
        {
            return Err(ModelError::Nodes(
                "amplitudes must increase from node to node",
            ));
        }
        let above = self.law.partition_point(|node| node.amplitude < amplitude);
        let high = &self.law[above.min(self.law.len() - 1)];
        let low = &self.law[above.saturating_sub(1)];
        let span = high.amplitude - low.amplitude;
        let weight = if span > 0.0 {
            ((amplitude - low.amplitude) / span).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let between = |a: f64, b: f64| R::from_f64(a + weight * (b - a));
        Law::new(
            between(low.k1, high.k1),
            between(low.k3, high.k3),
            between(low.c, high.c),
            between(low.alpha, high.alpha),
        )
        .map_err(|error| ModelError::Refused {
            place: format!("law at {amplitude} mm"),
            error,
        })
    }

    /// The law as the firmware runs it at `tick` s, with the coefficients for cycles of `amplitude` mm.
    ///
    /// # Errors
    /// As [`Self::law_at`], or an effect that cannot be built.
    pub fn augmented<R: Real>(
        &self,
        amplitude: f64,
        tick: f64,
    ) -> Result<AugmentedLaw<R, MAX_EFFECTS>, ModelError> {
        let mut law = AugmentedLaw::new(self.law_at(amplitude)?);
        for (index, added) in self.effects.iter().enumerate() {
            let effect = added.effect(tick, || self.place(index))?;
            law = law.with(effect).map_err(|error| ModelError::Refused {
                place: self.place(index),
                error,
            })?;
        }
        if let Some(table) = &self.correction {
            law = table
                .build(tick)
                .and_then(|correction| law.with_residual_table(correction))
                .map_err(|error| ModelError::Refused {
                    place: "correction".into(),
                    error,
                })?;
        }
        Ok(law)
    }

    /// As [`Self::augmented`], as a coefficient pack for a running rig. The pack gives its tick rate and no other information; see
    /// [`crate::export`] for a pack that leaves the host.
    ///
    /// # Errors
    /// As [`Self::augmented`].
    pub fn pack(&self, amplitude: f64, tick: f64) -> Result<Vec<u8>, ModelError> {
        let law = FastLaw::new(self.augmented(amplitude, tick)?);
        let info = PackInfo::at((1.0 / tick) as f32);
        let mut buffer = [0; LARGEST];
        pack::encode(&law, &info, &mut buffer)
            .map(<[u8]>::to_vec)
            .map_err(ModelError::Pack)
    }

    /// Moves the control inputs of a recording to the indices at which the effects see them.
    ///
    /// # Errors
    /// The recording lacks one of them.
    pub fn arrange_controls(&self, recording: &mut Recording) -> Result<(), InputError> {
        let names = self.controls.iter().map(|control| control.name.as_str());
        recording.arrange_controls(names)
    }

    /// Its control inputs in order, `count` samples each. The `given` values are constant; the others come from the columns `known`
    /// of `file`.
    ///
    /// # Errors
    /// An input that the model does not have, or an input of the model without a value.
    pub fn held_controls(
        &self,
        (file, known): (&str, &[ControlChannel]),
        given: &[(String, f64)],
        count: usize,
    ) -> Result<Vec<ControlChannel>, InputError> {
        let names: Vec<&str> = self.controls.iter().map(|c| c.name.as_str()).collect();
        if let Some((name, _)) = given.iter().find(|(name, _)| !names.contains(&&**name)) {
            let has = match names.as_slice() {
                [] => "none".to_owned(),
                names => names.join(", "),
            };
            return Err(InputError::new(
                format!("--control {name}"),
                format!("is no control input of the model, which has {has}"),
                "correct the name, or leave it out",
            ));
        }
        let channel = |name: &&str| {
            let mut all = given.iter();
            if let Some((_, value)) = all.find(|(given, _)| given == name) {
                return Ok(ControlChannel {
                    name: (*name).to_owned(),
                    values: vec![*value; count],
                });
            }
            let known = known.iter().find(|control| control.name == *name);
            known.cloned().ok_or_else(|| {
                InputError::new(
                    file,
                    format!("there is no column {name}, on which the force depends"),
                    format!("add that column, or give --control {name}=VALUE"),
                )
            })
        };
        names.iter().map(channel).collect()
    }

    /// Whether its force depends on a control input.
    pub fn depends_on_control(&self) -> bool {
        let mut effects = self.effects.iter();
        effects.any(|effect| effect.family.depends_on_control())
    }

    /// Whether its force changes with the number of cycles, or with their frequency through a residual table that counts them.
    pub fn depends_on_cycles(&self) -> bool {
        let table = self.correction.as_ref();
        let memory = table.and_then(|table| table.memory.as_ref());
        memory.is_some_and(|memory| matches!(memory.of, Remembered::Frequency { .. }))
            || self
                .effects
                .iter()
                .any(|effect| effect.family.depends_on_cycles())
    }

    /// Whether its force changes with the temperature.
    pub fn depends_on_temperature(&self) -> bool {
        let table = self.correction.as_ref();
        let memory = table.and_then(|table| table.memory.as_ref());
        memory.is_some_and(|memory| memory.of == Remembered::Temperature)
            || self
                .effects
                .iter()
                .any(|effect| effect.family.depends_on_temperature())
    }

    fn place(&self, index: usize) -> String {
        format!("effects[{index}] ({})", self.effects[index].family)
    }
}

impl AddedEffect {
    /// An effect of the crate with the typical parameters of its description.
    pub fn typical(description: &Description) -> Self {
        let count = description.parameters.len();
        let parameters = (0..).zip(description.typical).map(|(place, &value)| {
            let name = description.parameters[place % count].name;
            let name = match place / count {
                0 => name.to_owned(),
                element => format!("{name}_{}", element + 1),
            };
            (name, value)
        });
        Self {
            family: Family::of(description),
            parameters: parameters.collect(),
        }
    }

    /// The effect for a tick of `tick` s. `place` names it in an error.
    ///
    /// # Errors
    /// A parameter is missing, unknown to the effect, or refused by the crate.
    pub fn effect<R: Real>(
        &self,
        tick: f64,
        place: impl Fn() -> String,
    ) -> Result<Effect<R>, ModelError> {
        let (description, values) = self.values(&place)?;
        Effect::from_parameters(description.number, &values, tick).map_err(|error| {
            ModelError::Refused {
                place: place(),
                error,
            }
        })
    }

    /// The effect's description, and its parameters in the order of the description, element by element.
    ///
    /// # Errors
    /// A parameter is missing or unknown to the effect.
    pub(crate) fn values(
        &self,
        place: impl Fn() -> String,
    ) -> Result<(&'static Description, Vec<f64>), ModelError> {
        let description = self.description();
        let refused = |problem| ModelError::Parameters {
            place: place(),
            problem,
        };
        let mut unused: Vec<&str> = self.parameters.keys().map(String::as_str).collect();
        let mut values: Vec<f64> = Vec::new();
        for number in 1..=description.most {
            let name_of = |name: &str| match number {
                1 => name.to_owned(),
                _ => format!("{name}_{number}"),
            };
            let names: Vec<String> = description
                .parameters
                .iter()
                .map(|parameter| name_of(parameter.name))
                .collect();
            let is_there = |name: &String| self.parameters.contains_key(name);
            if number > 1 && !names.iter().any(is_there) {
                break;
            }
            let first = values.len();
            for (parameter, name) in description.parameters.iter().zip(&names) {
                unused.retain(|other| other != name);
                let value = match (self.parameters.get(name), parameter.absent) {
                    (Some(value), _) => *value,
                    (None, Absent::Is(value)) => value,
                    (None, Absent::As(place)) => values[first + place],
                    (None, Absent::Refused) => {
                        return Err(refused(format!("parameter {name} is missing")));
                    }
                };
                values.push(value);
            }
        }
        if let Some(name) = unused.first() {
            return Err(refused(format!("the effect has no parameter {name}")));
        }
        Ok((description, values))
    }

    /// The effect within its family that the parameters belong to: the first effect that has all of their names, or else the first
    /// of the family.
    fn description(&self) -> &'static Description {
        let has_all = |description: &&Description| {
            self.parameters.keys().all(|name| {
                description
                    .parameters
                    .iter()
                    .any(|p| p.name == base_name(name))
            })
        };
        self.family
            .effects()
            .find(has_all)
            .unwrap_or_else(|| self.family.first())
    }
}
