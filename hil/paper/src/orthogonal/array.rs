//! The orthogonal array L9(3⁴).

/// Runs of the array.
pub const RUNS: usize = 9;
/// Levels of every factor.
pub const LEVELS: usize = 3;
/// Columns, each for one factor.
pub const COLUMNS: usize = 4;

/// L9(3⁴): the level, 0…2, of each of four factors in each of nine runs.
///
/// The first two columns count through a and b in the field of three elements, and the others are a + b and 2a + b. Any two of the
/// four are independent linear forms, so every pair of levels meets exactly once. Up to a factor there are no others, so the array
/// has no room for a fifth column. Rows and columns are in the order of Table 3.
pub fn l9() -> [[usize; COLUMNS]; RUNS] {
    std::array::from_fn(|run| {
        let (a, b) = (run / LEVELS, run % LEVELS);
        [a, b, (a + b) % LEVELS, (2 * a + b) % LEVELS]
    })
}

/// The first pair of levels of two columns that does not meet exactly once, with the number of meetings; `None` for orthogonal
/// columns.
pub fn unequal_pair(
    first: &[usize; RUNS],
    second: &[usize; RUNS],
) -> Option<(usize, usize, usize)> {
    let met = |a, b| {
        let pairs = first.iter().zip(second);
        pairs.filter(|&(&x, &y)| (x, y) == (a, b)).count()
    };
    (0..LEVELS)
        .flat_map(|a| (0..LEVELS).map(move |b| (a, b)))
        .map(|(a, b)| (a, b, met(a, b)))
        .find(|&(_, _, count)| count != 1)
}
