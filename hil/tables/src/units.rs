//! The units in a recording's column names, and their size in the code's units (mm, kN, s, °C).

use serde::Serialize;

/// A unit in a recording's file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Unit {
    /// Symbol of the unit, as after the underscore in a column's name.
    pub symbol: &'static str,
    /// Size of one unit in the code's units: mm, kN, s, mm/s or °C.
    pub scale: f64,
    /// Value in the code's unit at zero of this unit: 0 except for temperatures.
    pub zero: f64,
}

impl Unit {
    /// Converts a value from this unit to the code's.
    pub fn to_code(self, value: f64) -> f64 {
        value * self.scale + self.zero
    }

    /// Whether both are the same unit, whatever the spelling: mm_s and mm/s are.
    pub(crate) fn is_same(self, other: Self) -> bool {
        (self.scale, self.zero) == (other.scale, other.zero)
    }

    /// Converts a value from the code's unit to this one.
    pub fn from_code(self, value: f64) -> f64 {
        (value - self.zero) / self.scale
    }
}

const fn unit(symbol: &'static str, scale: f64) -> Unit {
    Unit {
        symbol,
        scale,
        zero: 0.0,
    }
}

/// An inch is an exact number of millimetres by definition, and a pound-force and a kilogram-force are exact numbers of newtons.
const MM_PER_IN: f64 = 25.4;
const KN_PER_LBF: f64 = 4.448_221_615_260_5e-3;
const KN_PER_KGF: f64 = 9.806_65e-3;
/// 0 K and 0 °F in °C.
const KELVIN: f64 = -273.15;
const FAHRENHEIT: f64 = -160.0 / 9.0;

/// Units of time, in s.
pub const TIME: &[Unit] = &[
    unit("s", 1.0),
    unit("ms", 1e-3),
    unit("us", 1e-6),
    unit("min", 60.0),
    unit("ns", 1e-9),
    unit("h", 3600.0),
];
/// Units of displacement, in mm.
pub const DISPLACEMENT: &[Unit] = &[
    unit("mm", 1.0),
    unit("m", 1e3),
    unit("um", 1e-3),
    unit("in", MM_PER_IN),
    unit("cm", 10.0),
    unit("mil", 1e-3 * MM_PER_IN),
];
/// Units of force, in kN.
pub const FORCE: &[Unit] = &[
    unit("kN", 1.0),
    unit("N", 1e-3),
    unit("uN", 1e-9),
    unit("lbf", KN_PER_LBF),
    unit("kip", 1e3 * KN_PER_LBF),
    unit("MN", 1e3),
    unit("mN", 1e-6),
    unit("kgf", KN_PER_KGF),
    unit("daN", 1e-2),
    unit("tf", 1e3 * KN_PER_KGF),
];
/// Units of velocity, in mm/s: a length over a second, written `mm_s` or `mm/s`.
pub const VELOCITY: &[Unit] = &[
    unit("mm_s", 1.0),
    unit("mm/s", 1.0),
    unit("m_s", 1e3),
    unit("m/s", 1e3),
    unit("um_s", 1e-3),
    unit("um/s", 1e-3),
    unit("in_s", MM_PER_IN),
    unit("in/s", MM_PER_IN),
    unit("cm_s", 10.0),
    unit("cm/s", 10.0),
];
/// Units of temperature, in °C.
pub const TEMPERATURE: &[Unit] = &[
    unit("degC", 1.0),
    Unit {
        symbol: "K",
        scale: 1.0,
        zero: KELVIN,
    },
    Unit {
        symbol: "degF",
        scale: 5.0 / 9.0,
        zero: FAHRENHEIT,
    },
];

/// The units in a recording's file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Units {
    /// One of [`TIME`].
    pub time: Unit,
    /// One of [`DISPLACEMENT`].
    pub displacement: Unit,
    /// One of [`FORCE`].
    pub force: Unit,
    /// One of [`VELOCITY`]; mm/s if the file has no velocity.
    pub velocity: Unit,
    /// One of [`TEMPERATURE`].
    pub temperature: Unit,
}

impl Units {
    /// s, m, N, m/s, °C.
    pub const SI: Self = Self {
        time: TIME[0],
        displacement: DISPLACEMENT[1],
        force: FORCE[1],
        velocity: VELOCITY[2],
        temperature: TEMPERATURE[0],
    };
}

impl Default for Units {
    /// The code's units: s, mm, kN, mm/s, °C.
    fn default() -> Self {
        Self {
            time: TIME[0],
            displacement: DISPLACEMENT[0],
            force: FORCE[0],
            velocity: VELOCITY[0],
            temperature: TEMPERATURE[0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(units: &[Unit], symbol: &str) -> f64 {
        units.iter().find(|u| u.symbol == symbol).unwrap().scale
    }

    #[test]
    fn one_of_each_in_the_codes_units() {
        // NIST SP 811: 1 in = 25.4 mm, 1 lbf = 4.448 221 615 260 5 N, 1 kip = 1000 lbf, all exact.
        assert_eq!(scale(DISPLACEMENT, "in"), 25.4);
        assert_eq!(scale(DISPLACEMENT, "um"), 0.001);
        assert!((scale(DISPLACEMENT, "mil") - 0.0254).abs() < 1e-15);
        // A tonne-force is the metric one: 1000 kgf.
        assert!((scale(FORCE, "tf") - 9.806_65).abs() < 1e-12);
        assert_eq!(scale(FORCE, "uN") * 1e9, 1.0);
        assert!((scale(FORCE, "lbf") * 1e3 - 4.448_221_615_260_5).abs() < 1e-15);
        assert!((scale(FORCE, "kip") - 4.448_221_615_260_5).abs() < 1e-15);
        assert_eq!(scale(TIME, "ms"), 0.001);
        assert_eq!(scale(VELOCITY, "m/s"), scale(VELOCITY, "m_s"));
        let si = Units::SI;
        let symbols = [si.time, si.displacement, si.force, si.velocity].map(|unit| unit.symbol);
        assert_eq!(symbols, ["s", "m", "N", "m_s"]);
    }
}
