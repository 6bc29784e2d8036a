// As many points as there are pixels, that show the same.

/**
 * The rows of `from` to `to` that are kept: of each of as many as `buckets` parts those at which a column is smallest or largest. They are
 * rows as they are, in their order, so that no peak is lost and nothing moves.
 *
 * @param {ArrayLike<number>[]} columns
 * @param {number} from first row
 * @param {number} to row after the last one
 * @param {number} buckets
 * @returns {Uint32Array} rows, rising; at most 2·columns·buckets of them
 */
export function select(columns, from, to, buckets) {
  const rows = Math.max(0, to - from);
  const mostKept = 2 * columns.length;
  if (rows <= mostKept * buckets) {
    return Uint32Array.from({ length: rows }, (_, row) => from + row);
  }
  const kept = new Uint32Array(mostKept * buckets);
  const ofBucket = new Uint32Array(mostKept);
  let count = 0;
  for (let bucket = 0; bucket < buckets; bucket++) {
    const first = from + Math.floor((rows * bucket) / buckets);
    const end = from + Math.floor((rows * (bucket + 1)) / buckets);
    columns.forEach((column, place) => extremes(column, first, end, ofBucket, 2 * place));
    ofBucket.sort();
    let last = -1;
    for (const row of ofBucket) {
      if (row !== last) {
        kept[count++] = row;
        last = row;
      }
    }
  }
  return kept.subarray(0, count);
}

/** Writes the rows of the smallest and of the largest value; what is not a number is neither. */
function extremes(column, first, end, rows, at) {
  let least = first;
  let most = first;
  for (let row = first + 1; row < end; row++) {
    if (column[row] < column[least] || Number.isNaN(column[least])) {
      least = row;
    }
    if (column[row] > column[most] || Number.isNaN(column[most])) {
      most = row;
    }
  }
  const isNumber = !Number.isNaN(column[least]);
  rows[at] = isNumber ? least : first;
  rows[at + 1] = isNumber ? most : first;
}

/** The values of `column` in `rows`. */
export function pick(column, rows) {
  return Float64Array.from(rows, (row) => column[row]);
}
