import assert from "node:assert/strict";
import test from "node:test";

import { number, percent } from "../js/format.js";
import { extent } from "../js/loop.js";
import { View } from "../js/view.js";

test("the display goes with the test, and shows no more than there is", () => {
  const view = new View();
  assert.deepEqual(view.range(0, 4), [0, 4]);
  assert.deepEqual(view.range(0, 40), [30, 40]);
  view.window = null;
  assert.deepEqual(view.range(5, 40), [5, 40]);
});

test("a pause freezes what is shown, and going on catches up", () => {
  const view = new View();
  view.togglePause(20);
  assert.deepEqual(view.range(0, 90), [10, 20]);
  view.togglePause(90);
  assert.deepEqual(view.range(0, 90), [80, 90]);
});

test("a zoom stays where it is until it is reset", () => {
  const view = new View();
  view.zoom = [1, 2];
  assert.deepEqual(view.range(0, 90), [1, 2]);
  assert.deepEqual(view.loopRange([1, 2], { end: 2, frequency: 5 }), [1, 2]);
  view.scale([1, 2], 0.5);
  assert.deepEqual(view.zoom, [1.25, 1.75]);
  view.move([1, 2], 0.25);
  assert.deepEqual(view.zoom, [1.25, 2.25]);
  view.resetZoom();
  assert.equal(view.isZoomed, false);
  assert.deepEqual(view.range(0, 90), [80, 90]);
});

test("a zoom never becomes nothing", () => {
  const view = new View();
  view.zoom = [1, 1.0001];
  for (let times = 0; times < 100; times++) {
    view.scale(view.zoom, 0.5);
  }
  assert.ok(view.zoom[1] > view.zoom[0]);
});

test("the loop shows the last two cycles", () => {
  assert.deepEqual(new View().loopRange([0, 10], { end: 10, frequency: 4 }), [9.5, 10]);
  assert.deepEqual(new View().loopRange([0, 10], { end: 10, frequency: 0 }), [8, 10]);
});

test("numbers have the digits that say something", () => {
  assert.equal(number(1.23456), "1.235");
  assert.equal(number(-0.012345), "−0.01235");
  assert.equal(number(123456), "123456");
  assert.equal(number(0), "0");
  assert.equal(number(NaN), "–");
  assert.equal(number(null), "–");
  assert.equal(percent(0.0123), "1.23 %");
  assert.equal(percent(undefined), "–");
});

test("an extent holds everything that is a number", () => {
  const [low, high] = extent([[1, NaN, 3], [2]]);
  assert.ok(low < 1 && high > 3 && high - low < 2.5);
  assert.deepEqual(extent([[]]), [-1, 1]);
  assert.ok(extent([[5, 5]])[0] < 5);
});
