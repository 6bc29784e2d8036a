// What of the data is shown.

/** Shortest range that a zoom may have, s. */
const SHORTEST = 1e-3;
/** Cycles that the loop shows while it is live. */
const LOOP_CYCLES = 2;
/** And s, where no cycle has ended yet. */
const LOOP_SECONDS = 2;

export class View {
  constructor() {
    /** s that are shown while the test goes on; null for all. */
    this.window = 10;
    /** Range of time that was zoomed to, s; null to go with the test. */
    this.zoom = null;
    /** Range of cycles that was zoomed to; null for all. */
    this.cycleZoom = null;
    /** Ranges of displacement and force that were zoomed to; null for all. */
    this.loopZoom = null;
    /** When the display was frozen, s of the test; null where it is not. */
    this.pausedAt = null;
  }

  get isPaused() {
    return this.pausedAt !== null;
  }

  get isZoomed() {
    return this.zoom !== null || this.cycleZoom !== null || this.loopZoom !== null;
  }

  /** Freezes the display at `lastTime`, or lets it go on. */
  togglePause(lastTime) {
    this.pausedAt = this.isPaused ? null : lastTime;
  }

  resetZoom() {
    this.zoom = null;
    this.cycleZoom = null;
    this.loopZoom = null;
  }

  /** The end of what is shown, s, where the data end at `lastTime`. */
  end(lastTime) {
    return this.pausedAt ?? lastTime;
  }

  /** The range of time that is shown, s, of data from `firstTime` to `lastTime`. */
  range(firstTime, lastTime) {
    if (this.zoom) {
      return this.zoom;
    }
    const end = this.end(lastTime);
    const start = this.window === null ? firstTime : Math.max(firstTime, end - this.window);
    return [start, Math.max(end, start + SHORTEST)];
  }

  /** The part of `range` that the loop shows: the cycles before `end`, or all of what was zoomed to. */
  loopRange(range, { end, frequency }) {
    if (this.zoom) {
      return range;
    }
    const length = frequency > 0 ? LOOP_CYCLES / frequency : LOOP_SECONDS;
    return [Math.max(range[0], end - length), end];
  }

  /** Zooms into the middle of `range` by `factor`, or out where it is above 1. */
  scale(range, factor) {
    const middle = (range[0] + range[1]) / 2;
    const half = Math.max(((range[1] - range[0]) / 2) * factor, SHORTEST / 2);
    this.zoom = [middle - half, middle + half];
  }

  /** Moves `range` by `part` of its length. */
  move(range, part) {
    const by = (range[1] - range[0]) * part;
    this.zoom = [range[0] + by, range[1] + by];
  }
}
