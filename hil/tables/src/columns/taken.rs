//! The channels that a column of a file may be.

use super::name::Name;
use super::spelling::control_unit;
use super::unit_found::{
    ControlUnit, UnitFound, control_unit_and_words, own_unit, row_units, unit_and_words,
};
use super::words::{Certainty, Words};
use crate::channel::Channel;
use crate::control::{self, UNITS};
use crate::files::Column;

/// How certain it is that a column is a channel; the greater, the more certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// Only by a unit of the channel.
    Unit,
    /// By a short word with a unit of it: `x [mm]`.
    Weak,
    /// By a word for the channel: `Kraft [kN]`.
    Word,
    /// By a name of our own files: `force_kN`.
    Own,
    /// By the user's setting.
    Stated,
}

/// A channel that a column may be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Candidate {
    pub channel: Channel,
    pub rank: Rank,
    /// Information about its unit.
    pub unit: UnitFound,
}

/// The channels that a column may be, by its own name and unit.
pub(super) fn candidates(column: &Column, is_numeric: bool) -> Vec<Candidate> {
    candidates_by(column, &units(column, &Name::of(&column.name)), is_numeric)
}

/// For each channel what is stated about the unit, and the words without it.
pub(super) type Units = [(UnitFound, Words); Channel::ALL.len()];

/// For each channel what a column with this name states.
pub(super) fn units(column: &Column, name: &Name) -> Units {
    Channel::ALL.map(|channel| unit_and_words(column, name, channel))
}

/// The channels that a column may be, if its values are taken for numbers or for words.
pub(super) fn candidates_by(column: &Column, units: &Units, is_numeric: bool) -> Vec<Candidate> {
    if let Some((channel, symbol)) = own_name(&column.name) {
        let unit = own_unit(column, channel, symbol);
        return vec![Candidate {
            channel,
            rank: Rank::Own,
            unit,
        }];
    }
    if !is_numeric {
        return Vec::new();
    }
    let of = |(channel, (unit, words)): (Channel, &(UnitFound, Words))| {
        Some(Candidate {
            channel,
            rank: rank(column, *words, channel, unit)?,
            unit: unit.clone(),
        })
    };
    let each = Channel::ALL.into_iter().zip(units);
    let mut found: Vec<Candidate> = each.filter_map(of).collect();
    // `Force displacement` is not decisive, `displacement of load cell [mm]` is by its unit.
    let known = |each: &Candidate| matches!(each.unit, UnitFound::Known(_));
    if found.len() > 1 && found.iter().any(known) {
        found.retain(known);
    }
    // A word is more certain than a unit alone.
    let best = found.iter().map(|each| each.rank).max();
    found.retain(|each| Some(each.rank) == best);
    found
}

/// How certain a column with these words next to its unit is a channel; `None` if it is not.
fn rank(column: &Column, words: Words, channel: Channel, unit: &UnitFound) -> Option<Rank> {
    // Dates that the table marks as its times are times whatever their name: `index`.
    if words.is_other() && !(column.is_time && column.is_stamp) {
        return None;
    }
    let certainty = words.of_channel(channel);
    if column.is_stamp {
        return match certainty {
            _ if channel != Channel::Time => None,
            Some(_) => Some(Rank::Weak),
            None => Some(Rank::Unit),
        };
    }
    if column.is_time {
        return (channel == Channel::Time).then_some(Rank::Word);
    }
    let is_known = matches!(unit, UnitFound::Known(_));
    match certainty {
        Some(Certainty::Strong) => Some(Rank::Word),
        Some(Certainty::Weak) => is_known.then_some(Rank::Weak),
        None => {
            let is_it = words.are_generic() || words.begin_with_symbol(channel);
            (is_known && is_it).then_some(Rank::Unit)
        }
    }
}

/// Whether a column that is no candidate for a channel could still be it, when another column is one by `words`.
///
/// Its unit fits the channel, and its name contains no other channel, no demand and no count. The column is as likely the channel
/// in two cases. Its name may contain the channel and a qualifying word, as in `Corrected position [mm]`. Or the candidate's own
/// name may contain unknown words, as `Nominal displacement [mm]` next to `Gauge 4 [mm]`.
pub(super) fn could_be(column: &Column, channel: Channel, is_sure: bool) -> bool {
    if !column.is_numeric || column.is_stamp || own_name(&column.name).is_some() {
        return false;
    }
    let name = Name::of(&column.name);
    let (unit, words) = unit_and_words(column, &name, channel);
    if !matches!(unit, UnitFound::Known(_)) || words.is_surely_other() {
        return false;
    }
    match words.of_channel(channel) {
        Some(Certainty::Strong) => words.is_other(),
        _ => !is_sure && !words.is_other() && words.count() > 0,
    }
}

/// Whether all of a column's name is understood: its words are for quantities, for the measured object, or neutral.
pub(super) fn is_understood(column: &Column, channel: Channel) -> bool {
    let name = Name::of(&column.name);
    unit_and_words(column, &name, channel).1.are_understood()
}

/// What a column may be in respect of times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct OfTimes {
    /// Whether it contains them, according to its file or a word of its name, with or without a unit.
    pub is_time: bool,
    /// Whether it may contain them.
    pub may_be_time: bool,
}

/// What a column may be in respect of times.
pub(super) fn of_times(column: &Column) -> OfTimes {
    let name = Name::of(&column.name);
    let candidates = candidates_by(column, &units(column, &name), column.is_numeric);
    let of_time = candidates.iter().find(|each| each.channel == Channel::Time);
    let is_named = || name.words.of_channel(Channel::Time).is_some() && !name.words.is_other();
    let is_said = column.is_time || column.is_stamp;
    let is_candidate = of_time.is_some_and(|each| each.rank > Rank::Unit);
    OfTimes {
        is_time: column.is_numeric && (is_said || is_candidate || is_named()),
        may_be_time: of_time.is_some(),
    }
}

/// The channel that a quantity's name is another word for: displacement for `weg`.
pub(super) fn other_name_of(quantity: &str) -> Option<Channel> {
    let words = Name::of(quantity).words;
    let is_of = |channel: &Channel| {
        quantity != channel.name() && words.of_channel(*channel) == Some(Certainty::Strong)
    };
    // A second word makes it another quantity, such as the position of a valve.
    Channel::ALL
        .into_iter()
        .find(is_of)
        .filter(|_| words.count() == 1)
}

/// Whether a name contains a word for some quantity, and none for another column.
pub(super) fn is_named(text: &str) -> bool {
    if own_name(text).is_some() {
        return true;
    }
    let name = Name::of(text);
    name.words.known() > 0 || name.tails.iter().any(|tail| tail.before.known() > 0)
}

/// A control input that a column may be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Control {
    pub quantity: String,
    pub unit: ControlUnit,
    /// Whether the column has the form of our own files: `coil_current_mA`.
    pub is_own: bool,
}

/// The control input that a column may be, by its own name and unit, if it is not a candidate for a channel.
pub(super) fn control_by(column: &Column, name: &Name, is_candidate: bool) -> Option<Control> {
    let found = control_unit_and_words(column, name, name.words);
    if let Some((quantity, symbol)) = own_control(&column.name) {
        let is_same = |said| control_unit(said) == Some(symbol);
        let own = |unit| Control {
            quantity: quantity.to_owned(),
            unit,
            is_own: true,
        };
        if row_units(column).all(is_same) {
            return Some(own(ControlUnit::Known(symbol)));
        }
        // The letter of `probe_A` in mm is no unit, nor is that of `pressure_A` in bar.
        if let Some((unit @ ControlUnit::Unclear(_, either), _)) = &found
            && either.len() > 1
            && other_name_of(quantity).is_none()
        {
            return Some(own(unit.clone()));
        }
    }
    if !column.is_numeric || column.is_stamp || is_candidate {
        return None;
    }
    let (unit, words) = found?;
    // The direction of the scaling is not stated here.
    if words.is_other() || name.scale.is_some() {
        return None;
    }
    // A word is needed: a rig may write many quantities with the same unit.
    let stated = match &unit {
        ControlUnit::Known(unit) => unit,
        ControlUnit::Unclear(_, either) => either.first()?,
    };
    let quantity = words.of_control(stated)?.to_owned();
    Some(Control {
        quantity,
        unit,
        is_own: false,
    })
}

/// The quantity and the unit in the name of a control input in the form of our own files.
fn own_control(name: &str) -> Option<(&str, &'static str)> {
    let (quantity, symbol) = name.rsplit_once('_')?;
    let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let unit = UNITS.iter().find(|unit| **unit == symbol)?;
    (control::is_control(name) && quantity.chars().all(is_plain)).then_some((quantity, *unit))
}

/// Whether a name has the form of our own files, with a unit.
pub(super) fn is_own(name: &str) -> bool {
    let is_unit = |(channel, symbol): (Channel, &str)| {
        channel.units().iter().any(|unit| unit.symbol == symbol)
    };
    own_name(name).is_some_and(is_unit)
}

/// The channel and the unit's symbol in a name of the form of our own files: `force_kN`.
///
/// A further word between the two, as in `force_command_kN`, makes it another column.
pub(super) fn own_name(name: &str) -> Option<(Channel, &str)> {
    let channel = Channel::ALL
        .into_iter()
        .find(|channel| name.starts_with(channel.name()))?;
    let rest = &name[channel.name().len()..];
    if rest.is_empty() {
        return Some((channel, ""));
    }
    let symbol = rest.strip_prefix('_')?;
    let known = channel.units().iter().any(|unit| unit.symbol == symbol);
    (known || !symbol.contains('_')).then_some((channel, symbol))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, unit: Option<&str>) -> Column {
        Column {
            name: name.into(),
            unit: unit.map(str::to_owned),
            is_numeric: true,
            ..Column::default()
        }
    }

    /// The channel of a column, and the certainty.
    fn taken(name: &str, unit: Option<&str>) -> String {
        let each = candidates(&column(name, unit), true)
            .into_iter()
            .map(|each| {
                let unit = match each.unit {
                    UnitFound::Known(unit) => unit.symbol.to_owned(),
                    UnitFound::Unknown(unit) | UnitFound::Unclear(unit, _) => format!("?{unit}"),
                    UnitFound::None => "?".into(),
                };
                format!("{:?} {} {unit}", each.rank, each.channel.name())
            });
        each.collect::<Vec<_>>().join(", ")
    }

    #[test]
    fn names_are_taken_for_what_they_say() {
        for (name, unit, is) in [
            ("force_kN", None, "Own force kN"),
            ("Time [s]", None, "Word time s"),
            ("Time_min", None, "Word time min"),
            ("Force_min", None, ""),
            ("Disp (mm)", None, "Word displacement mm"),
            ("Load_N", None, "Word force N"),
            ("Load", Some("(lbf)"), "Word force lbf"),
            ("F in kN", None, "Weak force kN"),
            ("Force/kN", None, "Word force kN"),
            ("DISPLACEMENT (MM)", None, "Word displacement mm"),
            ("TIME_S", None, "Word time s"),
            ("AxialForce", Some("N"), "Word force N"),
            ("x", Some("mm"), "Weak displacement mm"),
            ("x", None, ""),
            ("F_AX_LC1 [N]", None, "Unit force N"),
            ("T_SPEC [degC]", None, "Unit temperature degC"),
            ("T_surface", Some("°C"), "Unit temperature degC"),
            ("T_SPEC [s]", None, "Unit time s"),
            ("F_AX_LC1", None, ""),
            ("FX_set [N]", None, ""),
            ("V", None, ""),
            ("v [m/s]", None, "Weak velocity m/s"),
            ("Ch 1", Some("mm"), "Unit displacement mm"),
            ("Crack length", Some("mm"), ""),
            ("Axial Strain", Some("mm/mm"), ""),
            ("Stress", Some("MPa"), ""),
            ("Load", Some("MPa"), "Word force ?MPa"),
            ("Axial Displacement Command", Some("mm"), ""),
            ("Position feedback [mm]", None, "Word displacement mm"),
            ("Sollkraft [kN]", None, ""),
            ("Cycle time [s]", None, ""),
            ("Tension", Some("N"), ""),
            ("Extension", Some("mm"), "Word displacement mm"),
            ("Force", None, "Word force ?"),
            ("Force [kN]", Some("N"), "Word force ?kN beside N"),
            ("force_kN", Some("N"), "Own force ?kN beside N"),
            ("Force [kN]", Some("KN"), "Word force kN"),
            ("FORCE [MN]", None, "Word force ?MN in a name of capitals"),
            ("Force [MN]", None, "Word force MN"),
            ("Temps [s]", None, "Word time s"),
            ("Temp [°C]", None, "Word temperature degC"),
            ("Charge [kN]", None, "Weak force kN"),
            ("Charge [C]", None, ""),
            ("Load cell displacement [mm]", None, "Word displacement mm"),
            ("Weg [mm] Soll", None, ""),
            ("Force [kN] avg", None, ""),
            ("Displacement (mm) Command", None, ""),
            (
                "Force [N] (x1000)",
                None,
                "Word force ?N with the factor \"x1000\"",
            ),
            (
                "Force x10",
                Some("N"),
                "Word force ?N with the factor \"x10\"",
            ),
            ("Time (s) / ms", None, "Word time ?s beside ms"),
            ("Force [kN] -> N", None, "Word force ?kN beside N"),
            ("Force (kN) [filtered]", None, ""),
            ("Disp (mils)", None, "Word displacement mil"),
            ("Load [tf]", None, "Word force tf"),
        ] {
            assert_eq!(taken(name, unit), is, "{name} {unit:?}");
        }
    }

    #[test]
    fn control_inputs_need_a_word_and_a_unit() {
        let is = |name: &str, unit: Option<&str>| {
            let column = column(name, unit);
            let is_candidate = !candidates(&column, true).is_empty();
            let Some(control) = control_by(&column, &Name::of(name), is_candidate) else {
                return String::new();
            };
            match control.unit {
                ControlUnit::Known(unit) => format!("{}_{unit}", control.quantity),
                ControlUnit::Unclear(units, _) => format!("{} ?{units}", control.quantity),
            }
        };
        for (of, unit, said) in [
            ("current_A", None, "current_A"),
            ("current_A", Some("A"), "current_A"),
            ("coil_current_mA", None, "coil_current_mA"),
            ("coil_current_mA", Some("A"), "coil_current ?mA beside A"),
            ("knob_V", Some("mV"), "knob ?V beside mV"),
            ("Coil current [A]", None, "current_A"),
            ("Current (mA)", Some("A"), "current ?mA beside A"),
            ("Current (mA)", Some("Milliampere"), ""),
            ("Current_mA", Some("A"), "current ?mA beside A"),
            ("Current_ma", Some("A"), "current ?ma beside A"),
            ("Current_mA", Some("mA"), "current_mA"),
            ("Pressure A", Some("bar"), "pressure_bar"),
            ("Pressure (A)", Some("bar"), "pressure_bar"),
            ("Pressure (C)", Some("bar"), "pressure_bar"),
            ("Pressure [1]", Some("bar"), "pressure_bar"),
            ("Pressure (MV)", Some("bar"), "pressure_bar"),
            ("Druck pA [bar]", None, "pressure_bar"),
            ("Druck pA", Some("bar"), "pressure_bar"),
            ("Pressure (psig)", Some("bar"), "pressure ?psig beside bar"),
            ("Pressure (psig)", Some("psi"), "pressure_psi"),
            ("Pressure psig", Some("psi"), "pressure_psi"),
            ("Pressure atm", Some("kPa"), "pressure_kPa"),
            ("PRESSURE [BAR] (PSI)", None, "pressure ?PSI beside BAR"),
            ("Pressure [bar] hPa", None, "pressure ?hPa beside bar"),
            ("Current [A] ma", None, "current ?ma beside A"),
            ("Druck_hPa", Some("bar"), "pressure ?hPa beside bar"),
            ("Druck_Bar", Some("kPa"), "pressure ?Bar beside kPa"),
            ("pressure_A", Some("bar"), "pressure_bar"),
            ("pressure_A", Some("furlong"), ""),
            ("pressure_V", None, "pressure_V"),
            ("Pressure (bar) [V]", None, ""),
            ("Pressure 400 bar [V]", None, ""),
            ("Pressure gradient [bar/s]", None, ""),
            ("Bridge voltage (mV/V)", None, ""),
            ("Current density [mA/cm²]", None, ""),
            ("Preload [kN/mm]", None, ""),
            ("Current A", Some("mA"), "current ?A beside mA"),
            ("I_A", Some("A"), ""),
            ("I_mA", None, "current_mA"),
            ("current_V", Some("A"), "current_A"),
            ("current_V", None, "current_V"),
            ("load_N", Some("kN"), ""),
            ("probe_A", Some("mm"), ""),
            ("Knob_V", Some("mV"), ""),
            ("Current (kA)", Some("A"), "current ?kA beside A"),
            ("CURRENT (KA)", Some("A"), "current ?KA beside A"),
            ("Current (mA coil)", Some("A"), "current ?mA beside A"),
            ("Current_mA_1", Some("A"), "current ?mA beside A"),
            ("Strom_µA", Some("A"), "current ?µA beside A"),
            ("Power (MW)", Some("W"), "power ?MW beside W"),
            ("Field (G)", Some("T"), "field ?G beside T"),
            ("Field [G]", Some("T"), "field ?G beside T"),
            ("Volt", Some("mV"), "voltage_mV"),
            ("Coil volt", Some("mV"), "voltage_mV"),
            ("Current [top]", Some("A"), "current_A"),
            ("Voltage UV", Some("V"), "voltage_V"),
            ("Current [A]", Some("furlong"), ""),
            ("Spannung", Some("V"), "voltage_V"),
            ("Spannung", Some("MPa"), ""),
            ("Extension [V]", None, ""),
            ("Axial Force_N", None, ""),
            ("Tension [N]", None, "tension_N"),
            ("V", None, ""),
            ("Pressure command [bar]", None, ""),
            ("Current (A) Setpoint", None, ""),
            ("Current [A] B", None, "current_A"),
            ("Current [A] mA", None, "current ?mA beside A"),
            ("Current [A] x10", None, ""),
        ] {
            assert_eq!(is(of, unit), said, "{of} {unit:?}");
        }
    }
}
