import assert from "node:assert/strict";
import test from "node:test";

import { csv } from "../js/export.js";
import { Columns, Store } from "../js/store.js";

function filled(most, rows, part) {
  const columns = new Columns(["time_s", "force_kN"], most);
  for (let at = 0; at < rows; at += part) {
    const count = Math.min(part, rows - at);
    const time = Float64Array.from({ length: count }, (_, row) => at + row);
    columns.append({ time_s: time, force_kN: Float32Array.from(time, (value) => 2 * value) }, count);
  }
  return columns;
}

test("the last rows stay, and memory is bounded", () => {
  for (const part of [1, 7, 100, 5000]) {
    const columns = filled(1000, 20_000, part);
    assert.ok(columns.length >= 1000 && columns.length <= 2000, `${part}: ${columns.length}`);
    assert.ok(columns.arrays.time_s.length <= 2000);
    const times = columns.column("time_s");
    const first = 20_000 - columns.length;
    assert.ok(times.every((time, row) => time === first + row));
    assert.ok(columns.column("force_kN").every((force, row) => force === 2 * times[row]));
    assert.equal(columns.last("force_kN"), 39_998);
  }
});

test("nothing is dropped before there is too much", () => {
  assert.equal(filled(10_000, 9999, 17).length, 9999);
  assert.equal(filled(10, 0, 1).last("time_s"), undefined);
});

test("a range has the rows within it, its ends included", () => {
  const columns = filled(1000, 100, 10);
  assert.deepEqual(columns.range([10, 20]), [10, 21]);
  assert.deepEqual(columns.range([9.5, 20.5]), [10, 21]);
  assert.deepEqual(columns.range([-5, 1000]), [0, 100]);
  assert.deepEqual(columns.range([200, 300]), [100, 100]);
});

test("ramps are left out, and a test that is over ends with its last steady loop", () => {
  const store = new Store();
  const { cycles } = store;
  const rows = 4;
  const columns = Object.fromEntries(cycles.names.map((name) => [name, new Float32Array(rows)]));
  columns.time_s = Float64Array.of(1, 2, 3, 4);
  columns.ramp.set([1, 0, 0, 1]);
  columns.frequency_Hz.fill(5);
  assert.deepEqual(store.loopEnd(9), { end: 9, frequency: 0 });
  cycles.append(columns, rows);
  assert.deepEqual([...store.steadyCycles(9)], [1, 2]);
  assert.deepEqual([...store.steadyCycles(2.5)], [1]);
  assert.deepEqual(store.loopEnd(4.5), { end: 4.5, frequency: 5 });
  store.state = { state: "finished" };
  assert.deepEqual(store.loopEnd(4.5), { end: 3, frequency: 5 });
});

test("without cycles the error is that of the samples shown", () => {
  const store = new Store();
  const rows = 100;
  const time = Float64Array.from({ length: rows }, (_, row) => row);
  const force = Float32Array.from(time, (at) => (at % 2 ? 4 : -4));
  // The law is right until 50 s, and a quarter too low from then on.
  const law = force.map((value, row) => (row < 50 ? value : 0.75 * value));
  store.samples.append({ time_s: time, displacement_mm: force, force_kN: force, law_force_kN: law }, rows);
  assert.equal(store.errorWithin([0, 49]), 0);
  assert.ok(Math.abs(store.errorWithin([50, 99]) - 0.25) < 1e-6);
  assert.ok(Number.isNaN(store.errorWithin([200, 300])));
});

test("events are bounded too", () => {
  const store = new Store();
  for (let event = 0; event < 3000; event++) {
    store.addEvent({ cycle: event });
  }
  assert.equal(store.events.length, 1024);
  assert.equal(store.events.at(-1).cycle, 2999);
});

test("a CSV has the rows that were asked for, and empty cells for what is no number", () => {
  const columns = new Columns(["time_s", "force_kN"], 10);
  columns.append({ time_s: Float64Array.of(0, 0.1, 0.2), force_kN: Float32Array.of(0.1, NaN, -3) }, 3);
  const text = csv(columns, [0, 3], ["two\nlines"]);
  assert.equal(text, "# two lines\ntime_s,force_kN\n0,0.1\n0.1,\n0.2,-3\n");
  assert.equal(csv(columns, [1, 1], []), "time_s,force_kN\n");
});
