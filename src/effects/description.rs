//! What an effect is, as data: packs, model files, reports, benchmarks, fuzzing and docs go through all of them by it.

/// How an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectKind {
    /// It adds a force to that of the mixed damping law, and may scale that too.
    Force,
    /// It lies between the specimen and what is measured.
    Stage,
    /// It only scales the forces of the mixed damping law.
    Modulator,
}

/// When a law that is read while the rig runs looks whether the effect is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// A multiplication or two, nothing remembered: all of these are computed where one is there.
    Light,
    /// One test of its own each tick.
    Common,
    /// One test for all of these, and one of its own behind that.
    Rare,
}

/// What a force may depend on, by the name that it has in every file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dependence {
    /// Displacement.
    Displacement,
    /// Velocity.
    Velocity,
    /// What the motion was before.
    History,
    /// Time, whatever the motion.
    Time,
    /// Cycles since the test began.
    Cycle,
    /// Temperature.
    Temperature,
    /// Frequency of the motion.
    Frequency,
    /// Amplitude of the motion.
    Amplitude,
    /// A control input.
    Control,
}

impl Dependence {
    /// The name that it has in every file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::History => "history",
            Self::Time => "time",
            Self::Cycle => "cycle",
            Self::Temperature => "temperature",
            Self::Frequency => "frequency",
            Self::Amplitude => "amplitude",
            Self::Control => "control",
        }
    }
}

/// How a force grows with a motion that goes on beyond the operating range, with displacement, velocity and acceleration in
/// proportion.
///
/// Whatever it is, a force stays finite: motions are clamped to [`crate::limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Growth {
    /// Not at all: it does not depend on the motion.
    Constant,
    /// Up to a limit of its own, and no further.
    Saturates,
    /// As at the edge of its table, and no further.
    Held,
    /// As the motion, or less.
    AtMostLinear,
    /// As the motion.
    Linear,
    /// As the way beyond a gap.
    LinearBeyondGap,
    /// As the square.
    Quadratic,
    /// As the third power.
    Cubic,
    /// As the fifth power.
    FifthPower,
    /// As the displacement times |v|^α.
    LinearTimesDamping,
    /// As |v|^α.
    OfDamping,
    /// As the forces of the mixed damping law.
    OfLaw,
    /// As the force of all that lies between it and the specimen.
    OfForceBehind,
}

impl Growth {
    /// Its words in `docs/effects.md`.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Saturates => "saturates",
            Self::Held => "held at the edge",
            Self::AtMostLinear => "at most linear",
            Self::Linear => "linear",
            Self::LinearBeyondGap => "linear beyond the gap",
            Self::Quadratic => "quadratic",
            Self::Cubic => "cubic",
            Self::FifthPower => "exponent 5",
            Self::LinearTimesDamping => "exponent 1 + α",
            Self::OfDamping => "exponent α",
            Self::OfLaw => "as the law",
            Self::OfForceBehind => "as the force behind it",
        }
    }
}

/// A parameter that is left out in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Absent {
    /// It must not be.
    Refused,
    /// It has this value.
    Is(f64),
    /// It has the value of the parameter at this place.
    As(usize),
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name in every file.
    pub name: &'static str,
    /// Its unit, as files write it; `1` for a number without one.
    pub unit: &'static str,
    /// Least and largest value.
    pub range: [f64; 2],
    /// What holds where a file leaves it out.
    pub absent: Absent,
}

impl Parameter {
    /// One that every file gives.
    pub const fn new(name: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        Self {
            name,
            unit,
            range: [low, high],
            absent: Absent::Refused,
        }
    }

    /// The same, where a file may leave it out.
    #[must_use]
    pub const fn or(self, absent: Absent) -> Self {
        Self { absent, ..self }
    }
}

/// What an effect is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Its own name.
    pub name: &'static str,
    /// The family that it is of, by the name that it has in every file. Most families have one effect.
    pub family: &'static str,
    /// Its number in a pack. It never changes, and that of a removed effect is not given again.
    pub number: u8,
    /// How it acts.
    pub kind: EffectKind,
    /// When a running law looks for it.
    pub cost: Cost,
    /// Of one element.
    pub parameters: &'static [Parameter],
    /// Most elements: 1 for most effects.
    pub most: usize,
    /// Parameters that a damper of 0.1 mm and 1 kN could have, element by element: what counts, fuzzing and tests take.
    pub typical: &'static [f64],
    /// What its force depends on.
    pub depends_on: &'static [Dependence],
    /// How its force grows outside the operating range.
    pub outside: Growth,
    /// Whether it gives more energy than it takes in closed cycles by what it is, whatever its parameters: a tone drives by itself, and
    /// a force that is late returns more than was stored. [`Passivity`](crate::passivity::Passivity) leaves it out. What supplies energy
    /// at some of its parameters only, such as a dashpot below 0, does not say so here.
    pub supplies_energy: bool,
    /// Whether all of its force, or a part, is a part of the mixed damping law's: what slow changes of the law change too.
    pub scales_law: bool,
    /// What it is, in one sentence.
    pub sentence: &'static str,
}

impl Description {
    /// Whether the force changes with the temperature.
    pub fn depends_on_temperature(&self) -> bool {
        self.depends_on.contains(&Dependence::Temperature)
    }
}
