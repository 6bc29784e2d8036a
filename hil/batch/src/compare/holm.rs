//! Many comparisons at one level of significance.

/// Marks the chances that are too small: the smallest of n if it is below `level`/n, the next if it is below `level`/(n − 1), and
/// so on until one is not (Holm 1979). If nothing changed, the chance of any mark is at most `level`.
pub(super) fn mark(chances: &mut [(Option<f64>, &mut bool)], level: f64) {
    let mut order: Vec<(f64, usize)> = chances
        .iter()
        .enumerate()
        .filter_map(|(place, (chance, _))| Some(((*chance)?, place)))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = order.len();
    let small = order
        .iter()
        .enumerate()
        .take_while(|(rank, (chance, _))| *chance <= level / (count - rank) as f64);
    let small: Vec<usize> = small.map(|(_, (_, place))| *place).collect();
    for place in small {
        *chances[place].1 = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(chances: &[Option<f64>]) -> Vec<bool> {
        let mut marks = vec![false; chances.len()];
        let mut pairs: Vec<_> = chances.iter().copied().zip(&mut marks).collect();
        mark(&mut pairs, 0.05);
        marks
    }

    #[test]
    fn each_is_held_to_what_those_before_it_left() {
        // Holm's example: 0.01 < 0.05/4, 0.015 < 0.05/3, 0.02 < 0.05/2, and 0.06 is not below 0.05.
        let all = [Some(0.02), Some(0.06), Some(0.01), Some(0.015)];
        assert_eq!(marked(&all), [true, false, true, true]);
        // A failure ends the sequence, although 0.026 is below 0.05.
        assert_eq!(marked(&[Some(0.026), Some(0.0251)]), [false, false]);
        assert_eq!(marked(&[None, Some(0.04), None]), [false, true, false]);
        assert_eq!(marked(&[]), [] as [bool; 0]);
    }
}
