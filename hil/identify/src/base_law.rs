//! The base law: the law to which effects are added.

/// The base law, to which effects are added. A damper that is no mesh may have a simpler one than eq 13.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BaseLaw {
    /// Mixed damping: k1·y + k3·y³ + c·|v|^α·sgn v (eq 13).
    #[default]
    Mixed,
    /// A spring and a dashpot: k1·y + c·v.
    Linear,
    /// None: the effects give the whole force.
    None,
}

impl BaseLaw {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Mixed, Self::Linear, Self::None];

    /// Its word on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Mixed => "mixed",
            Self::Linear => "linear",
            Self::None => "none",
        }
    }

    /// Its name in `trace.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mixed => "mixed_damping",
            Self::Linear => "linear",
            Self::None => "none",
        }
    }

    /// Whether it has terms in y, y³ and |v|^α·sgn v.
    pub(crate) fn has(self) -> [bool; 3] {
        match self {
            Self::Mixed => [true; 3],
            Self::Linear => [true, false, true],
            Self::None => [false; 3],
        }
    }

    /// The exponent of its damping, if it is fixed.
    pub(crate) fn exponent(self) -> Option<f64> {
        (self != Self::Mixed).then_some(1.0)
    }
}
