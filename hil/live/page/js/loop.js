// Force over displacement.

import { pick, select } from "./decimate.js";

/** Parts of which the extremes are drawn at most. */
const BUCKETS = 1500;
/** Room about the loop, as a part of it. */
const MARGIN = 0.06;

/** What is drawn of `samples` in the range of rows, as uPlot takes points whose x does not rise. */
export function loopData(samples, [from, to]) {
  const columns = ["displacement_mm", "force_kN", "law_force_kN"].map((name) => samples.column(name));
  const rows = select(columns, from, to, BUCKETS);
  const [displacement, force, law] = columns.map((column) => pick(column, rows));
  return [null, [displacement, force], [displacement, law]];
}

/** The smallest range that holds all of `arrays`, with room about it. */
export function extent(arrays) {
  let least = Infinity;
  let most = -Infinity;
  for (const array of arrays) {
    for (const value of array) {
      least = Math.min(least, Number.isNaN(value) ? least : value);
      most = Math.max(most, Number.isNaN(value) ? most : value);
    }
  }
  if (!(most >= least)) {
    return [-1, 1];
  }
  const room = MARGIN * (most - least || Math.abs(most) || 1);
  return [least - room, most + room];
}

/** Draws points one after the other, as they are. */
export function loopPath(u, series) {
  const [xs, ys] = u.data[series];
  const path = new Path2D();
  for (let row = 0; row < xs.length; row++) {
    const x = u.valToPos(xs[row], "x", true);
    const y = u.valToPos(ys[row], "y", true);
    if (Number.isFinite(x) && Number.isFinite(y)) {
      path.lineTo(x, y);
    }
  }
  const clip = new Path2D();
  clip.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  return { stroke: path, fill: null, clip, flags: 0 };
}
