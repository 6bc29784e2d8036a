//! Regions of a grid.

/// The connected regions of the marked nodes of `rows` × `columns`, each as rows and columns. Neighbours are the eight around a
/// node.
pub(super) fn regions(
    rows: usize,
    columns: usize,
    belongs: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<(usize, usize)>> {
    let mut seen = vec![vec![false; columns]; rows];
    let mut found = Vec::new();
    for start in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let mut region = Vec::new();
        let mut ahead = vec![start];
        while let Some((row, column)) = ahead.pop() {
            if seen[row][column] || !belongs(row, column) {
                continue;
            }
            seen[row][column] = true;
            region.push((row, column));
            for near_row in row.saturating_sub(1)..(row + 2).min(rows) {
                ahead.extend(
                    (column.saturating_sub(1)..(column + 2).min(columns))
                        .map(|near_column| (near_row, near_column)),
                );
            }
        }
        if !region.is_empty() {
            found.push(region);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_join_and_gaps_part() {
        let map = ["#..#", ".#..", "...#"];
        let found = regions(3, 4, |row, column| map[row].as_bytes()[column] == b'#');
        let sizes: Vec<usize> = found.iter().map(Vec::len).collect();
        assert_eq!(sizes, [2, 1, 1]);
        assert_eq!(found[2], [(2, 3)]);
        assert!(regions(2, 2, |_, _| false).is_empty());
    }
}
