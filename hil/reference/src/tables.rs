//! Tables 6–9: the coefficients of eq 13 identified at five amplitudes and five densities.
//!
//! Rows are amplitudes, columns densities, as printed.

use super::law::Coefficients;

/// Densities of the columns, g/cm³.
pub const DENSITIES: [f64; 5] = [2.0, 2.5, 3.0, 3.5, 4.0];

/// Amplitudes of the rows, mm.
pub const AMPLITUDES: [f64; 5] = [0.05, 0.10, 0.15, 0.20, 0.25];

/// Table 6, k1 in kN/mm.
pub const K1: [[f64; 5]; 5] = [
    [0.3365, 0.2235, 1.5273, 4.3051, 7.5503],
    [0.2823, 0.3538, 1.0539, 2.5246, 8.3948],
    [0.2957, 0.2490, 0.7007, 2.1466, 8.8699],
    [0.4368, 0.5272, 0.5333, 1.7452, 8.9133],
    [0.6376, 0.9585, 0.4655, 1.2470, 9.3548],
];

/// Table 7, k3 in kN/mm³ (the paper prints kN).
///
/// The last row is scattered over the page in the text from which this was typed. Read from left to right, every column but the
/// last continues to fall with amplitude. Eq 17 hardly distinguishes the readings (R² = 0.779 with this one, 0.782 with the best of
/// all 120).
pub const K3: [[f64; 5]; 5] = [
    [86.7, 151.1, 131.9, 185.9, 160.9],
    [24.2, 105.4, 10.5, 125.6, 180.5],
    [11.9, 54.0, 10.1, 46.5, 5.2],
    [11.2, 39.6, 7.4, 21.5, 15.7],
    [9.4, 34.9, 4.7, 8.1, 18.5],
];

/// Table 8, c in kN·(s/mm)^α (the paper prints kN·s/mm, right only for α = 1).
pub const C: [[f64; 5]; 5] = [
    [0.0235, 0.0694, 0.1397, 0.1436, 0.1107],
    [0.0409, 0.0899, 0.1114, 0.1359, 0.2937],
    [0.0446, 0.1339, 0.1252, 0.1452, 0.4147],
    [0.0657, 0.1657, 0.1219, 0.1320, 0.5329],
    [0.0899, 0.2247, 0.1263, 0.1280, 0.6592],
];

/// Table 9, α.
pub const ALPHA: [[f64; 5]; 5] = [
    [0.4014, 0.5571, 0.4429, 0.4187, 0.2569],
    [0.4441, 0.4797, 0.3969, 0.3370, 0.3279],
    [0.3930, 0.4461, 0.3820, 0.3516, 0.2053],
    [0.3736, 0.4304, 0.3869, 0.3143, 0.1806],
    [0.3724, 0.2722, 0.3941, 0.2484, 0.1581],
];

/// The coefficients in row `amplitude` and column `density`, both 0…4.
///
/// # Panics
/// An index beyond the tables.
pub fn cell(amplitude: usize, density: usize) -> Coefficients {
    Coefficients {
        k1: K1[amplitude][density],
        k3: K3[amplitude][density],
        c: C[amplitude][density],
        alpha: ALPHA[amplitude][density],
    }
}

/// Every cell as (density g/cm³, amplitude mm, coefficients).
pub fn cells() -> impl Iterator<Item = (f64, f64, Coefficients)> {
    AMPLITUDES.iter().enumerate().flat_map(|(row, &amplitude)| {
        DENSITIES
            .iter()
            .enumerate()
            .map(move |(column, &density)| (density, amplitude, cell(row, column)))
    })
}

/// Coefficients at `density` g/cm³ and `amplitude` mm, bilinear between cells; outside the grid those of its edge.
pub fn interpolate(density: f64, amplitude: f64) -> Coefficients {
    let (column, across) = place(&DENSITIES, density);
    let (row, down) = place(&AMPLITUDES, amplitude);
    let between = |table: &[[f64; 5]; 5]| {
        let along = |line: &[f64; 5]| line[column] * (1.0 - across) + line[column + 1] * across;
        along(&table[row]) * (1.0 - down) + along(&table[row + 1]) * down
    };
    Coefficients::new(between(&K1), between(&K3), between(&C), between(&ALPHA))
}

/// The interval of `nodes` that contains `value`, and the position in it, 0…1.
fn place(nodes: &[f64; 5], value: f64) -> (usize, f64) {
    let value = value.clamp(nodes[0], nodes[4]);
    let interval = (0..4).rfind(|&i| value >= nodes[i]).unwrap_or(0);
    let fraction = (value - nodes[interval]) / (nodes[interval + 1] - nodes[interval]);
    (interval, fraction)
}
