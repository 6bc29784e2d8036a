//! |v|^α: ours compared to libm's and micromath's.

use mesh_damper::power::{PowerSeed, PowerTable, abs_pow};

use super::Refused;
use super::tally::{Meter, Region, Tally};

/// Exponents, from the paper.
pub const ALPHAS: [f32; 5] = [0.15, 0.25, 0.35, 0.45, 0.56];
/// Velocities for each exponent.
pub const VELOCITIES: u32 = 2000;
/// mm/s
pub const LOWEST: f32 = 1e-6;
/// mm/s
pub const HIGHEST: f32 = 20.0;

/// Evenly spaced over the bits of a float, and so over the logarithm, apart from the spacing within an octave.
pub fn velocity(index: u32) -> f32 {
    let [low, high] = [LOWEST, HIGHEST].map(f32::to_bits);
    let steps = u64::from(high - low) * u64::from(index) / u64::from(VELOCITIES - 1);
    f32::from_bits(low + steps as u32)
}

extern "C" fn general(_: &mut (), v: f32, alpha: f32) -> f32 {
    abs_pow(v, alpha)
}

extern "C" fn libm(_: &mut (), v: f32, alpha: f32) -> f32 {
    libm::powf(v.abs(), alpha)
}

extern "C" fn micromath(_: &mut (), v: f32, alpha: f32) -> f32 {
    micromath::F32Ext::powf(v.abs(), alpha)
}

extern "C" fn tabulated(table: &mut PowerTable, v: f32, _: f32) -> f32 {
    table.damping_force(v)
}

/// Name and region of those that take any exponent.
pub const FORMS: [(&str, Region<()>); 3] = [
    ("power/general", general),
    ("power/libm", libm),
    ("power/micromath", micromath),
];
/// The form that takes its exponent from a table, with c = 1.
pub const TABULATED: (&str, Region<PowerTable>) = ("power/table", tabulated);

/// Each over every velocity and exponent.
///
/// # Errors
/// None: every value is in its range.
pub fn run(meter: &mut impl Meter) -> Result<(), Refused> {
    for (name, region) in FORMS {
        let mut tally = Tally::default();
        for alpha in ALPHAS {
            for index in 0..VELOCITIES {
                tally.add(meter.call(region, &mut (), velocity(index), alpha));
            }
        }
        meter.report(name, "call", &tally);
    }
    let (name, region) = TABULATED;
    let mut tally = Tally::default();
    for alpha in ALPHAS {
        let mut table = PowerTable::new(&PowerSeed::new(1.0, f64::from(alpha))?);
        for index in 0..VELOCITIES {
            tally.add(meter.call(region, &mut table, velocity(index), 0.0));
        }
    }
    meter.report(name, "call", &tally);
    Ok(())
}
