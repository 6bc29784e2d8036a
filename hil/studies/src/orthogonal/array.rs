//! The orthogonal array L9(3⁴).

/// Runs of the array.
pub const RUNS: usize = 9;
/// Levels of every factor.
pub const LEVELS: usize = 3;
/// Columns, each for one factor.
pub const COLUMNS: usize = 4;

/// L9(3⁴): the level, 0…2, of each of four factors in each of nine runs.
///
/// The first two columns count through a and b in the field of three elements, the others are the lines a + b and 2a + b:
/// any two of the four are independent linear forms, so that every pair of levels meets exactly once. These four are all
/// that there are up to a factor, so that the array has no room for a fifth. Rows and columns stand as in Table 3.
pub fn l9() -> [[usize; COLUMNS]; RUNS] {
    std::array::from_fn(|run| {
        let (a, b) = (run / LEVELS, run % LEVELS);
        [a, b, (a + b) % LEVELS, (2 * a + b) % LEVELS]
    })
}

/// The first pair of levels of two columns that does not meet exactly once, with how often it meets; `None` for
/// orthogonal columns.
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
