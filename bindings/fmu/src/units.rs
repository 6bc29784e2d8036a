//! The units of an FMU's variables, in SI base units.

/// A unit in SI base units: a value v in it is `factor`·v + `offset` in those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its name in the description.
    pub symbol: &'static str,
    /// Exponents of base units, by the attribute's name in a description.
    pub exponents: &'static [(&'static str, i32)],
    /// As above.
    pub factor: f64,
    /// As above.
    pub offset: f64,
}

const fn unit(
    symbol: &'static str,
    exponents: &'static [(&'static str, i32)],
    factor: f64,
) -> Unit {
    Unit {
        symbol,
        exponents,
        factor,
        offset: 0.0,
    }
}

const METRE: &[(&str, i32)] = &[("m", 1)];
const NEWTON: &[(&str, i32)] = &[("kg", 1), ("m", 1), ("s", -2)];
const PASCAL: &[(&str, i32)] = &[("kg", 1), ("m", -1), ("s", -2)];
const VOLT: &[(&str, i32)] = &[("kg", 1), ("m", 2), ("s", -3), ("A", -1)];
const AMPERE: &[(&str, i32)] = &[("A", 1)];
const TESLA: &[(&str, i32)] = &[("kg", 1), ("s", -2), ("A", -1)];
const KELVIN: &[(&str, i32)] = &[("K", 1)];

/// The units that the description of an FMU defines. A control input's unit that is not among them has only a symbol.
pub const UNITS: &[Unit] = &[
    unit("m", METRE, 1.0),
    unit("mm", METRE, 1e-3),
    unit("m/s", &[("m", 1), ("s", -1)], 1.0),
    unit("m/s2", &[("m", 1), ("s", -2)], 1.0),
    unit("N", NEWTON, 1.0),
    unit("kN", NEWTON, 1e3),
    unit("Hz", &[("s", -1)], 1.0),
    unit("1", &[], 1.0),
    unit("K", KELVIN, 1.0),
    Unit {
        symbol: "degC",
        exponents: KELVIN,
        factor: 1.0,
        offset: 273.15,
    },
    unit("A", AMPERE, 1.0),
    unit("mA", AMPERE, 1e-3),
    unit("V", VOLT, 1.0),
    unit("mV", VOLT, 1e-3),
    unit("Pa", PASCAL, 1.0),
    unit("kPa", PASCAL, 1e3),
    unit("MPa", PASCAL, 1e6),
    unit("bar", PASCAL, 1e5),
    unit("T", TESLA, 1.0),
    unit("mT", TESLA, 1e-3),
];

/// The unit with this symbol.
pub fn by_symbol(symbol: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.symbol == symbol)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_symbol_is_one_unit() {
        for (place, unit) in UNITS.iter().enumerate() {
            assert!(
                UNITS[..place]
                    .iter()
                    .all(|other| other.symbol != unit.symbol)
            );
            assert_eq!(by_symbol(unit.symbol), Some(unit));
        }
    }
}
