import assert from "node:assert/strict";
import test from "node:test";

import { SAMPLE_COLUMNS, decode } from "../js/frames.js";

/** A message as `hil/live/src/frame.rs` writes it. */
function message({ kind = 1, version = 1, columns, start = 0, missed = 0 }) {
  const rows = columns[0].length;
  const buffer = new ArrayBuffer(24 + 4 * rows * columns.length);
  const view = new DataView(buffer);
  [0x4d, 0x44, version, kind].forEach((byte, at) => view.setUint8(at, byte));
  view.setUint32(4, rows, true);
  view.setUint32(8, columns.length, true);
  view.setUint32(12, missed, true);
  view.setFloat64(16, start, true);
  columns.flat().forEach((value, at) => view.setFloat32(24 + 4 * at, value, true));
  return buffer;
}

const COLUMNS = [
  [0, 0.5],
  [1, 2],
  [3, 4],
  [5, 6],
];

test("samples are read with their times", () => {
  const read = decode(message({ columns: COLUMNS, start: 1e6, missed: 9 }));
  assert.equal(read.kind, "samples");
  assert.equal(read.rows, 2);
  assert.equal(read.missed, 9);
  assert.deepEqual([...read.columns.time_s], [1e6, 1e6 + 0.5]);
  assert.deepEqual([...read.columns.law_force_kN], [5, 6]);
});

test("columns that came later are passed over, and so are other kinds", () => {
  const more = decode(message({ columns: [...COLUMNS, [7, 8]] }));
  assert.deepEqual(Object.keys(more.columns), SAMPLE_COLUMNS);
  assert.equal(decode(message({ columns: COLUMNS, kind: 77 })), null);
});

test("what is no message is refused", () => {
  const good = message({ columns: COLUMNS });
  assert.throws(() => decode(new ArrayBuffer(3)), /no message/);
  assert.throws(() => decode(new ArrayBuffer(40)), /no message/);
  assert.throws(() => decode(good.slice(0, 40)), /cut/);
  assert.throws(() => decode(message({ columns: COLUMNS, version: 2 })), /version 2.*load the page again/);
  assert.throws(() => decode(message({ columns: COLUMNS.slice(1) })), /lacks columns/);
});
