//! The orthogonal test of quasistatic compression: Tables 2 and 3 as printed, and the conclusions of the text.

/// The factors A, B, C and D of Table 2.
pub const FACTORS: [&str; 4] = [
    "mesh density",
    "crisscross angle",
    "wire diameter",
    "test load",
];

/// The units of the factors' levels.
pub const UNITS: [&str; 4] = ["g/cm³", "°", "mm", "kN"];

/// Table 2: the three levels of every factor.
pub const LEVELS: [[f64; 3]; 4] = [
    [2.0, 3.0, 4.0],
    [15.0, 45.0, 75.0],
    [0.1, 0.15, 0.3],
    [1.0, 1.5, 2.0],
];

/// One of the two results of Table 3, with the range analysis printed below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    /// The measured quantity.
    pub name: &'static str,
    /// Its value in runs 1…9.
    pub runs: [f64; 9],
    /// ΣK of every factor at its three levels.
    pub sums: [[f64; 3]; 4],
    /// R of every factor.
    pub ranges: [f64; 4],
    /// The order of significance that the text states, as indices of [`FACTORS`].
    pub order: [usize; 4],
}

/// Static loss factor η0.
pub const LOSS_FACTOR: Printed = Printed {
    name: "loss factor",
    runs: [
        0.0281, 0.09, 0.206, 0.0681, 0.0462, 0.0113, 0.0279, 0.0582, 0.043,
    ],
    sums: [
        [0.3241, 0.1256, 0.1291],
        [0.1241, 0.1944, 0.259],
        [0.09, 0.2011, 0.28],
        [0.1173, 0.1292, 0.3323],
    ],
    ranges: [0.1985, 0.1349, 0.19, 0.215],
    order: [3, 0, 1, 2],
};

/// Equivalent stiffness K_eq, kN/mm.
pub const STIFFNESS: Printed = Printed {
    name: "equivalent stiffness",
    runs: [
        0.022, 0.0566, 0.07, 0.129, 0.215, 0.1433, 0.3462, 0.1779, 0.48,
    ],
    sums: [
        [0.1486, 0.4873, 1.0041],
        [0.4972, 0.4495, 0.6933],
        [0.3432, 0.6656, 0.6312],
        [0.717, 0.5461, 0.3769],
    ],
    ranges: [0.8555, 0.2438, 0.3224, 0.3401],
    order: [0, 3, 1, 2],
};
