//! |v|^α: ours beside libm's and micromath's.

use mesh_damper::power::{PowerSeed, PowerTable, abs_pow};

use super::suite::{Meter, Tally};

/// Exponents, those of the paper.
pub const ALPHAS: [f32; 5] = [0.15, 0.25, 0.35, 0.45, 0.56];
/// Velocities for each exponent.
pub const VELOCITIES: u32 = 2000;
/// 1e-6 and 20 mm/s.
const RANGE: [f32; 2] = [1e-6, 20.0];

/// Evenly spaced over the bits of a float, which is evenly spaced over the logarithm but for the course within an octave.
pub fn velocity(index: u32) -> f32 {
    let [low, high] = RANGE.map(f32::to_bits);
    f32::from_bits(
        low + ((u64::from(high - low) * u64::from(index)) / u64::from(VELOCITIES - 1)) as u32,
    )
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

extern "C" fn table(table: &mut PowerTable, v: f32, _: f32) -> f32 {
    table.damping_force(v)
}

/// Every variant over every velocity and exponent.
pub fn run(meter: &mut impl Meter) {
    for (name, region) in [
        ("power/general", general as super::suite::Region<()>),
        ("power/libm", libm),
        ("power/micromath", micromath),
    ] {
        let mut tally = Tally::new();
        for alpha in ALPHAS {
            for index in 0..VELOCITIES {
                tally.add(meter.call(region, &mut (), velocity(index), alpha));
            }
        }
        meter.report(name, "call", &tally);
    }
    let mut tally = Tally::new();
    for alpha in ALPHAS {
        let Ok(seed) = PowerSeed::new(1.0, f64::from(alpha)) else {
            continue;
        };
        let mut cubics = PowerTable::new(&seed);
        for index in 0..VELOCITIES {
            tally.add(meter.call(table, &mut cubics, velocity(index), 0.0));
        }
    }
    meter.report("power/table", "call", &tally);
}
