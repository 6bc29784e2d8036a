//! Description of an effect as data. Packs, model files, reports, benchmarks, fuzzing and docs iterate over all descriptions.

/// How an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectKind {
    /// It adds a force to that of the mixed damping law, and may scale that too.
    Force,
    /// It lies between the specimen and the measurement.
    Stage,
    /// It only scales the forces of the mixed damping law.
    Modulator,
}

/// When a law that is read while the rig runs checks whether the effect is present.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// One or two multiplications, no state: if one of these is present, all are computed.
    Light,
    /// One check of its own on each tick.
    Common,
    /// One check for all rare effects together, and then one of its own.
    Rare,
}

/// A quantity on which a force may depend, with its name in every file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dependence {
    /// Displacement.
    Displacement,
    /// Velocity.
    Velocity,
    /// The earlier motion.
    History,
    /// Time, independent of the motion.
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
    /// Its name in every file.
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

/// Whether an effect can give out more energy than it absorbs in a closed cycle, with the other inputs constant. On this rests the
/// argument of [`crate::passivity`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Energy {
    /// It cannot: it absorbs energy, or returns what it has stored, whatever its parameters.
    Passive,
    /// It can if one of these parameters is below 0, and cannot otherwise.
    Below0(&'static [&'static str]),
    /// It changes the part of the law's damping that acts. It can if less than nothing of that remains, together with the other
    /// effects of this kind.
    ScalesDamping,
    /// It does by its nature, whatever its parameters: a tone, which drives by itself, or a delayed force, which returns more than
    /// was stored.
    Active,
}

/// How a force grows when a motion exceeds the operating range, with displacement, velocity and acceleration in proportion.
///
/// A force always stays finite, because motions are clamped to [`crate::limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Growth {
    /// It does not grow, because it does not depend on the motion.
    Constant,
    /// It grows up to a limit of its own.
    Saturates,
    /// It keeps its value at the edge of its table.
    Held,
    /// In proportion to the motion, or less.
    AtMostLinear,
    /// In proportion to the motion.
    Linear,
    /// In proportion to the distance beyond a gap.
    LinearBeyondGap,
    /// With the square.
    Quadratic,
    /// With the third power.
    Cubic,
    /// With the fifth power.
    FifthPower,
    /// With the displacement times |v|^α.
    LinearTimesDamping,
    /// With |v|^α.
    OfDamping,
    /// With the forces of the mixed damping law.
    OfLaw,
    /// With the total force between it and the specimen.
    OfForceBehind,
}

impl Growth {
    /// Its wording in `docs/effects.md`.
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

/// Treatment of a parameter that a file leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Absent {
    /// The parameter is required.
    Refused,
    /// It has this value.
    Is(f64),
    /// It has the value of the parameter at this index.
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
    /// Treatment where a file leaves it out.
    pub absent: Absent,
}

impl Parameter {
    /// A required parameter.
    pub const fn new(name: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        Self {
            name,
            unit,
            range: [low, high],
            absent: Absent::Refused,
        }
    }

    /// The same, as an optional parameter.
    #[must_use]
    pub const fn or(self, absent: Absent) -> Self {
        Self { absent, ..self }
    }
}

/// Description of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Its own name.
    pub name: &'static str,
    /// Name of its family in every file. Most families have one effect.
    pub family: &'static str,
    /// Its number in a pack. It never changes, and the number of a removed effect is not reused.
    pub number: u8,
    /// How it acts.
    pub kind: EffectKind,
    /// When a running law checks for it.
    pub cost: Cost,
    /// Parameters of one element.
    pub parameters: &'static [Parameter],
    /// Largest number of elements: 1 for most effects.
    pub most: usize,
    /// Typical parameters for a damper of 0.1 mm and 1 kN, element by element. Instruction counts, fuzzing and tests use them.
    pub typical: &'static [f64],
    /// What its force depends on.
    pub depends_on: &'static [Dependence],
    /// How its force grows outside the operating range.
    pub outside: Growth,
    /// Whether it can give out more energy than it absorbs in a closed cycle.
    pub energy: Energy,
    /// Whether all of its force, or a part, is proportional to the mixed damping law's, so that slow changes of the law change it
    /// too.
    pub scales_law: bool,
    /// The effect in one sentence.
    pub sentence: &'static str,
}

impl Description {
    /// A rare force of one element, which does not scale the law. It has no name yet.
    pub(super) const PLAIN: Self = Self {
        name: "",
        family: "",
        number: u8::MAX,
        kind: EffectKind::Force,
        cost: Cost::Rare,
        parameters: &[],
        most: 1,
        typical: &[],
        depends_on: &[],
        outside: Growth::Constant,
        energy: Energy::Passive,
        scales_law: false,
        sentence: "",
    };

    /// Whether the force changes with the temperature.
    pub fn depends_on_temperature(&self) -> bool {
        self.depends_on.contains(&Dependence::Temperature)
    }
}
