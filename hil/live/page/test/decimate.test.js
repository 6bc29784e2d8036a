import assert from "node:assert/strict";
import test from "node:test";

import { select } from "../js/decimate.js";

/** Draws that are the same each time. */
function* draws(seed) {
  let state = seed;
  for (;;) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    yield state / 2 ** 32;
  }
}

const extremes = (values) => [Math.min(...values), Math.max(...values)];

test("every part keeps the extremes of every column, rows rise, and their number is bounded", () => {
  const draw = draws(7);
  const next = () => draw.next().value;
  for (let round = 0; round < 200; round++) {
    const rows = 1 + Math.floor(3000 * next());
    const buckets = 1 + Math.floor(60 * next());
    const columns = [0, 1, 2].map(() => Float32Array.from({ length: rows }, () => next() - 0.5));
    const from = Math.floor((rows / 2) * next());
    const kept = select(columns, from, rows, buckets);
    assert.ok(kept.length <= Math.max(6 * buckets, 0));
    assert.ok(kept.every((row, place) => row >= from && row < rows && (place === 0 || row > kept[place - 1])));
    for (let bucket = 0; bucket < buckets; bucket++) {
      const first = from + Math.floor(((rows - from) * bucket) / buckets);
      const end = from + Math.floor(((rows - from) * (bucket + 1)) / buckets);
      const within = [...kept].filter((row) => row >= first && row < end);
      if (end > first) {
        for (const column of columns) {
          assert.deepEqual(extremes(within.map((row) => column[row])), extremes(column.subarray(first, end)));
        }
      }
    }
  }
});

test("what is no number hides nothing", () => {
  const column = Float32Array.from({ length: 1000 }, (_, row) => (row % 3 ? NaN : row));
  const values = [...select([column], 0, 1000, 1)].map((row) => column[row]);
  assert.deepEqual(values, [0, 999]);
});

test("few rows are kept as they are, and none of none", () => {
  assert.deepEqual([...select([Float32Array.of(1, 1, 1)], 0, 3, 10)], [0, 1, 2]);
  assert.deepEqual([...select([new Float32Array(0)], 0, 0, 10)], []);
});
