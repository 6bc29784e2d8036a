//! The model that a trace ends in and that the rig runs: eq 13 with coefficients over amplitude, and added effects.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;

use mesh_damper::effects::{
    AugmentedLaw, EffectParameters, MAX_BRANCHES, MAX_CONTACTS, MAX_STICK_SLIP_ELEMENTS, MAX_TONES,
};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::pack::{self, LARGEST, PackError};
use mesh_damper::real::Real;
use mesh_damper::tabulated::TabulatedLaw;
use serde::{Deserialize, Serialize};

use crate::correction::{CorrectionTable, Remembered};

/// Most effects that a model carries beside eq 13.
pub const MAX_EFFECTS: usize = 8;

/// A kind of effect, by the name it has in every file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// A constant force.
    Offset,
    /// Even stiffness.
    Asymmetry,
    /// Odd stiffness above the cubic.
    Hardening,
    /// Rate-independent hysteresis.
    StickSlip,
    /// A linear dashpot.
    Viscous,
    /// Maxwell branches.
    Relaxation,
    /// A moving mass.
    Inertia,
    /// A force that settles with the cycles.
    Drift,
    /// A force that scales with temperature.
    Temperature,
    /// One-sided contact.
    Stop,
    /// A dead zone.
    Gap,
    /// A force recorded late.
    Delay,
    /// A spring in series.
    Compliance,
    /// Tones.
    Periodic,
    /// Friction that grows with the displacement.
    LoadFriction,
}

impl Family {
    /// Every family that a trace tries, the simplest first.
    pub const ALL: [Self; 14] = [
        Self::Offset,
        Self::Asymmetry,
        Self::Hardening,
        Self::Viscous,
        Self::Inertia,
        Self::StickSlip,
        Self::Relaxation,
        Self::Drift,
        Self::Temperature,
        Self::Stop,
        Self::Gap,
        Self::Delay,
        Self::Compliance,
        Self::Periodic,
    ];

    /// The name it has in every file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Offset => "offset",
            Self::Asymmetry => "asymmetry",
            Self::Hardening => "hardening",
            Self::StickSlip => "stick_slip",
            Self::Viscous => "viscous",
            Self::Relaxation => "relaxation",
            Self::Inertia => "inertia",
            Self::Drift => "drift",
            Self::Temperature => "temperature",
            Self::Stop => "stop",
            Self::Gap => "gap",
            Self::Delay => "delay",
            Self::Compliance => "compliance",
            Self::Periodic => "periodic",
            Self::LoadFriction => "load_friction",
        }
    }

    /// What the force of this family depends on.
    pub fn depends_on(self) -> &'static [&'static str] {
        match self {
            Self::Offset => &[],
            Self::Asymmetry | Self::Hardening | Self::Stop | Self::Gap => &["displacement"],
            Self::StickSlip => &["displacement", "history"],
            Self::Viscous => &["velocity"],
            Self::Relaxation => &["displacement", "history", "frequency"],
            Self::Inertia => &["displacement", "frequency"],
            Self::Drift => &["displacement", "cycle"],
            Self::Temperature => &["temperature"],
            Self::Delay => &["velocity", "frequency"],
            Self::Compliance => &["displacement", "velocity", "amplitude"],
            Self::Periodic => &["time"],
            Self::LoadFriction => &["displacement", "velocity"],
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The unit of an effect's parameter by its name, or `None` for a name that no effect has.
///
/// The second and later elements of an effect that has several carry their number: `slip_limit_2`.
pub fn parameter_unit(name: &str) -> Option<&'static str> {
    match base_name(name) {
        "force" => Some("kN"),
        "k2" => Some("kN/mm^2"),
        "k5" => Some("kN/mm^5"),
        "c1" => Some("kN*s/mm"),
        "mass" => Some("kg"),
        "stiffness" => Some("kN/mm"),
        "slip_limit" => Some("mm"),
        "time" => Some("s"),
        "cycles" | "elastic_change" | "damping_change" => Some("1"),
        "load" => Some("1/mm"),
        "beta" | "beta_damping" => Some("1/degC"),
        "reference" => Some("degC"),
        "sharpness" | "damps_inside" => Some("1"),
        "gap" | "half_width" => Some("mm"),
        "frequency" => Some("Hz"),
        "phase" => Some("rad"),
        "amplitude" => Some("kN"),
        _ => None,
    }
}

/// `slip_limit` of `slip_limit_2`.
fn base_name(name: &str) -> &str {
    name.rsplit_once('_')
        .filter(|(_, number)| number.bytes().all(|byte| byte.is_ascii_digit()))
        .map_or(name, |(base, _)| base)
}

/// The coefficients of eq 13 at one amplitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawNode {
    /// mm. The only node of a law that does not depend on amplitude has 0.
    pub amplitude: f64,
    /// kN/mm
    pub k1: f64,
    /// kN/mm³
    pub k3: f64,
    /// kN·(s/mm)^α
    pub c: f64,
    /// α
    pub alpha: f64,
}

/// One effect beside eq 13.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AddedEffect {
    /// What kind it is.
    pub family: Family,
    /// Its parameters by name, in the units of [`parameter_unit`].
    pub parameters: BTreeMap<String, f64>,
}

/// Why a model cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A coefficient was refused by the crate.
    #[error("{place}: {error}")]
    Refused {
        /// Which node or effect.
        place: String,
        /// What the crate said.
        error: ConfigError,
    },
    /// An effect lacks a parameter, or has one too many.
    #[error("{place}: {problem}")]
    Parameters {
        /// Which effect.
        place: String,
        /// Which parameter, and what is wrong with it.
        problem: String,
    },
    /// The law has no nodes, or its amplitudes do not increase.
    #[error("law: {0}")]
    Nodes(&'static str),
    /// No coefficient pack can be made of it.
    #[error("pack: {0}")]
    Pack(PackError),
}

/// Eq 13 over amplitude, and what is added to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Coefficients at increasing amplitudes; between them they are interpolated linearly, outside they are held.
    pub law: Vec<LawNode>,
    /// The added effects in the order in which their forces are added.
    pub effects: Vec<AddedEffect>,
    /// What is added beside them without a name.
    pub correction: Option<CorrectionTable>,
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
        for (index, parameters) in self.effect_parameters(tick)?.iter().enumerate() {
            law = parameters
                .effect()
                .and_then(|effect| law.with(effect))
                .map_err(|error| self.refused(index, error))?;
        }
        if let Some(table) = &self.correction {
            law = table
                .build(tick)
                .and_then(|correction| law.with_correction(correction))
                .map_err(|error| ModelError::Refused {
                    place: "correction".into(),
                    error,
                })?;
        }
        Ok(law)
    }

    /// The same as a coefficient pack, for a rig that runs.
    ///
    /// # Errors
    /// As [`Self::augmented`].
    pub fn pack(&self, amplitude: f64, tick: f64) -> Result<Vec<u8>, ModelError> {
        let law = TabulatedLaw::new(self.augmented(amplitude, tick)?);
        let mut buffer = [0; LARGEST];
        pack::encode(&law, &mut buffer)
            .map(<[u8]>::to_vec)
            .map_err(ModelError::Pack)
    }

    /// Whether its force changes with the temperature.
    pub fn depends_on_temperature(&self) -> bool {
        let table = self.correction.as_ref();
        let memory = table.and_then(|table| table.memory.as_ref());
        memory.is_some_and(|memory| memory.of == Remembered::Temperature)
            || self
                .effects
                .iter()
                .any(|effect| effect.family == Family::Temperature)
    }

    /// The added effects as the crate's constructors take them.
    fn effect_parameters<R: Real>(
        &self,
        tick: f64,
    ) -> Result<Vec<EffectParameters<R>>, ModelError> {
        let effects = self.effects.iter().enumerate();
        effects
            .map(|(index, added)| added.parameters(tick, || self.place(index)))
            .collect()
    }

    fn place(&self, index: usize) -> String {
        format!("effects[{index}] ({})", self.effects[index].family)
    }

    fn refused(&self, index: usize, error: ConfigError) -> ModelError {
        ModelError::Refused {
            place: self.place(index),
            error,
        }
    }
}

impl AddedEffect {
    /// What the crate's constructor takes, for a tick of `tick` s. `place` names the effect in an error.
    fn parameters<R: Real>(
        &self,
        tick: f64,
        place: impl Fn() -> String,
    ) -> Result<EffectParameters<R>, ModelError> {
        let unused: RefCell<Vec<&str>> =
            RefCell::new(self.parameters.keys().map(String::as_str).collect());
        let exact = |name: &str| -> Result<f64, ModelError> {
            unused.borrow_mut().retain(|&other| other != name);
            self.parameters
                .get(name)
                .copied()
                .ok_or_else(|| ModelError::Parameters {
                    place: place(),
                    problem: format!("parameter {name} is missing"),
                })
        };
        let get = |name: &str| exact(name).map(R::from_f64);
        let parameters = match self.family {
            Family::Offset => EffectParameters::Offset {
                force: get("force")?,
            },
            Family::Asymmetry => EffectParameters::Asymmetry { k2: get("k2")? },
            Family::Hardening => EffectParameters::Hardening { k5: get("k5")? },
            Family::Viscous => EffectParameters::Viscous { c1: get("c1")? },
            Family::Inertia => EffectParameters::Inertia { mass: get("mass")? },
            Family::LoadFriction => EffectParameters::LoadFriction { load: get("load")? },
            Family::StickSlip if self.parameters.contains_key("sharpness") => {
                EffectParameters::BoucWen {
                    stiffness: get("stiffness")?,
                    slip_limit: get("slip_limit")?,
                    sharpness: get("sharpness")?,
                }
            }
            Family::StickSlip => EffectParameters::StickSlip(
                self.elements(["stiffness", "slip_limit"], MAX_STICK_SLIP_ELEMENTS, get)?
                    .into_iter()
                    .map(<(R, R)>::from)
                    .collect(),
            ),
            Family::Stop => EffectParameters::Stop(
                self.elements(["stiffness", "gap"], MAX_CONTACTS, get)?
                    .into_iter()
                    .map(<(R, R)>::from)
                    .collect(),
            ),
            Family::Gap => EffectParameters::Gap {
                half_width: get("half_width")?,
                damps_inside: get("damps_inside")? != R::ZERO,
            },
            Family::Delay => EffectParameters::Delay {
                time: get("time")?,
                tick: R::from_f64(tick),
            },
            Family::Compliance => EffectParameters::Compliance {
                stiffness: get("stiffness")?,
                tick: R::from_f64(tick),
            },
            Family::Periodic => EffectParameters::Periodic {
                tones: self
                    .elements(["amplitude", "frequency", "phase"], MAX_TONES, exact)?
                    .into_iter()
                    .map(|[amplitude, frequency, phase]| (R::from_f64(amplitude), frequency, phase))
                    .collect(),
                tick,
            },
            Family::Relaxation => EffectParameters::Relaxation {
                branches: self
                    .elements(["stiffness", "time"], MAX_BRANCHES, get)?
                    .into_iter()
                    .map(<(R, R)>::from)
                    .collect(),
                tick: R::from_f64(tick),
            },
            Family::Drift if self.parameters.contains_key("elastic_change") => {
                EffectParameters::Drift {
                    stiffness: R::ZERO,
                    cycles: get("cycles")?,
                    elastic_change: get("elastic_change")?,
                    damping_change: get("damping_change")?,
                }
            }
            Family::Drift => EffectParameters::Drift {
                stiffness: get("stiffness")?,
                cycles: get("cycles")?,
                elastic_change: R::ZERO,
                damping_change: R::ZERO,
            },
            Family::Temperature => EffectParameters::Temperature {
                beta: get("beta")?,
                beta_damping: if self.parameters.contains_key("beta_damping") {
                    get("beta_damping")?
                } else {
                    get("beta")?
                },
                reference: get("reference")?,
            },
        };
        match unused.borrow().first() {
            Some(name) => Err(ModelError::Parameters {
                place: place(),
                problem: format!("parameter {name} is not one of its own"),
            }),
            None => Ok(parameters),
        }
    }

    /// The elements of an effect that has up to `most`, each of parameters with these names; from the second on the names
    /// carry the element's number.
    fn elements<T: Copy + Default, const N: usize>(
        &self,
        names: [&str; N],
        most: usize,
        get: impl Fn(&str) -> Result<T, ModelError>,
    ) -> Result<Vec<[T; N]>, ModelError> {
        let mut elements = Vec::new();
        for number in 1..=most {
            let names = names.map(|name| match number {
                1 => name.to_owned(),
                _ => format!("{name}_{number}"),
            });
            let is_there = |name: &String| self.parameters.contains_key(name);
            if number > 1 && !names.iter().any(is_there) {
                break;
            }
            let mut element = [T::default(); N];
            for (value, name) in element.iter_mut().zip(&names) {
                *value = get(name)?;
            }
            elements.push(element);
        }
        Ok(elements)
    }
}
