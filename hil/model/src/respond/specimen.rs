//! The part of a model that acts on a mass: the damper without effects of the measurement, and the moving mass.

use mesh_damper::effects::description::EffectKind;
use mesh_damper::limits;

use super::RespondError;
use crate::{AddedEffect, Model, ModelError};

/// kN·s²/mm in a kg.
pub(super) const PER_KILOGRAM: f64 = 1e-6;

/// A mass on a damper.
#[derive(Clone, Debug)]
pub(super) struct Specimen {
    /// The model without inertia and without effects of the measurement.
    pub model: Model,
    /// The mass that is fastened to the damper, kg.
    pub mass: f64,
    /// The mass of the model's effect `inertia`, kg.
    pub model_mass: f64,
    /// Effects of the model that do not act on the mass, each with the reason.
    pub left_out: Vec<LeftOut>,
}

/// An effect that the integration leaves out or treats differently from a prediction.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOut {
    /// The effect's family.
    pub family: &'static str,
    /// The reason.
    pub reason: &'static str,
}

impl Specimen {
    /// `mass` kg on the damper of `model`. `offset` keeps the model's constant force.
    ///
    /// # Errors
    /// The mass is negative, not finite or too large; there is no mass at all; or the steps of a compliance do not settle.
    pub fn new(model: &Model, mass: f64, offset: bool) -> Result<Self, RespondError> {
        if !(0.0..=limits::MASS).contains(&mass) {
            return Err(RespondError::Value {
                field: "mass",
                value: mass,
                problem: format!("is outside 0…{} kg", limits::MASS),
                remedy: "give the mass that moves on the damper, in kg",
            });
        }
        let mut new = Self {
            model: Model {
                effects: Vec::new(),
                ..model.clone()
            },
            mass,
            model_mass: 0.0,
            left_out: Vec::new(),
        };
        for effect in &model.effects {
            // The names are those of the crate's descriptions.
            let left_out = match effect.family.name() {
                "inertia" => {
                    new.model_mass += effect.parameters.get("mass").copied().unwrap_or_default();
                    None
                }
                "delay" => Some("a delay of the force channel does not delay the force itself"),
                "periodic" => Some("a tone of the test rig does not belong to the damper"),
                "offset" if !offset => Some(
                    "the mass rests at a displacement of 0, where a static load balances the preload",
                ),
                _ => {
                    new.model.effects.push(effect.clone());
                    None
                }
            };
            if let Some(reason) = left_out {
                let family = effect.family.name();
                new.left_out.push(LeftOut { family, reason });
            }
        }
        new.refuse_no_mass()?;
        new.refuse_stiff_effects()?;
        Ok(new)
    }

    /// The moving mass, kg.
    pub fn moving_mass(&self) -> f64 {
        self.mass + self.model_mass
    }

    fn refuse_no_mass(&self) -> Result<(), RespondError> {
        if self.moving_mass() > 0.0 {
            return Ok(());
        }
        let problem = if self.model_mass == 0.0 {
            "and the model has no effect `inertia`: nothing moves".to_owned()
        } else {
            format!(
                "and the model's effect `inertia` of {} kg: together no mass moves",
                self.model_mass
            )
        };
        Err(RespondError::Value {
            field: "mass",
            value: self.mass,
            problem,
            remedy: "give a mass above that, in kg",
        })
    }

    /// The step of a series spring uses the forces of the other effects from the previous step. This settles only if spring and law
    /// together are stiffer than those effects.
    fn refuse_stiff_effects(&self) -> Result<(), RespondError> {
        let Some(spring) = self.effect("compliance").map(|e| sum_of(e, "stiffness")) else {
            return Ok(());
        };
        let law = self.model.law.iter().map(|node| node.k1);
        let law = law.fold(f64::INFINITY, f64::min).max(0.0);
        let others = self.stiffness_of_effects();
        if others < spring + law {
            return Ok(());
        }
        Err(RespondError::Value {
            field: "effects (compliance).stiffness",
            value: spring,
            problem: format!(
                "the effects behind the series spring ({others} kN/mm) are stiffer than spring and law together, so the time steps do not converge"
            ),
            remedy: "trace without the compliance, or give a stiffer spring",
        })
    }

    fn effect(&self, family: &str) -> Option<&AddedEffect> {
        let mut effects = self.model.effects.iter();
        effects.find(|effect| effect.family.name() == family)
    }

    /// Stiffness of the effects added to the law before anything slides and while every stop touches, kN/mm.
    fn stiffness_of_effects(&self) -> f64 {
        // A stage is not beside the law, and the stiffness that an input sets follows below.
        let is_beside = |effect: &&AddedEffect| {
            let family = effect.family;
            !family.depends_on_control()
                && family.effects().all(|each| each.kind == EffectKind::Force)
        };
        let effects = self.model.effects.iter().filter(is_beside);
        let passive: f64 = effects
            .map(|effect| sum_of(effect, "stiffness").max(0.0))
            .sum();
        passive + self.stiffness_of_controlled()
    }

    /// The largest stiffness that a control input gives its branch within the fitted range, kN/mm.
    fn stiffness_of_controlled(&self) -> f64 {
        let Some(effect) = self.effect("control_input") else {
            return 0.0;
        };
        let ends = self.model.controls.iter().flat_map(|each| each.range);
        let largest = ends.fold(0.0, |most: f64, end| most.max(end.abs()));
        let saturation = effect.parameters.get("saturation").copied();
        let strength = largest / (1.0 + largest / saturation.unwrap_or(f64::INFINITY));
        strength * sum_of(effect, "stiffness").max(0.0)
    }

    /// Approximate largest angular frequency of the mass on the damper at a displacement of 0, rad/s.
    pub fn fastest(&self) -> f64 {
        let law = self.model.law.iter().map(|node| node.k1);
        let stiffness = law.fold(0.0, f64::max) + self.stiffness_of_effects();
        (stiffness / (PER_KILOGRAM * self.moving_mass())).sqrt()
    }

    /// Energy in J of the springs of the law at a displacement of `y` mm, with the coefficients for `amplitude` mm. It does not
    /// include the springs of effects with a memory.
    ///
    /// # Errors
    /// As [`Model::law_at`].
    pub fn elastic_energy(&self, y: f64, force: f64, amplitude: f64) -> Result<f64, ModelError> {
        let parameter = |family: &str, name: &str| {
            self.effect(family)
                .map_or(0.0, |effect| sum_of(effect, name))
        };
        let play = parameter("gap", "half_width");
        let spring = self.effect("compliance").map(|e| sum_of(e, "stiffness"));
        let behind_gap = y.signum() * (y.abs() - play).max(0.0);
        let x = behind_gap - spring.map_or(0.0, |spring| force / spring);
        let law = self.model.law_at::<f64>(amplitude)?;
        let stops: f64 = self.effect("stop").map_or(0.0, |effect| {
            let touching = |number: &str| {
                let value = |name: &str| effect.parameters.get(&format!("{name}{number}"));
                let (Some(stiffness), Some(gap)) = (value("stiffness"), value("gap")) else {
                    return 0.0;
                };
                let beyond = gap.signum() * (x - gap);
                0.5 * stiffness * beyond.max(0.0).powi(2)
            };
            touching("") + touching("_2")
        });
        Ok(0.5 * law.k1() * x * x
            + 0.25 * law.k3() * x.powi(4)
            + parameter("asymmetry", "k2") * x.powi(3) / 3.0
            + parameter("hardening", "k5") * x.powi(6) / 6.0
            + parameter("offset", "force") * x
            + stops
            + spring.map_or(0.0, |spring| 0.5 * force * force / spring))
    }
}

/// The sum over an effect's elements of the parameter with this name.
fn sum_of(effect: &AddedEffect, name: &str) -> f64 {
    let parameters = effect.parameters.iter();
    let own = parameters.filter(|(each, _)| crate::family::base_name(each) == name);
    own.map(|(_, value)| value).sum()
}
