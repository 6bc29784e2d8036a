// What has come so far: columns of numbers, of bounded length.

import { CYCLE_COLUMNS, SAMPLE_COLUMNS } from "./frames.js";

const FIRST_ROOM = 1 << 12;
/** Events that are kept. */
const MOST_EVENTS = 1024;
/** Samples that are kept where the server does not say how many it keeps. */
const SAMPLES = 1 << 19;
const CYCLES = 1 << 16;

/** Columns of one length. The last `most` rows at least stay, and twice as many at most. */
export class Columns {
  constructor(names, most) {
    this.names = names;
    this.most = most;
    this.length = 0;
    this.room = Math.min(FIRST_ROOM, 2 * most);
    this.arrays = {};
    for (const name of names) {
      this.arrays[name] = this.#array(name, this.room);
    }
  }

  // Time alone needs more digits than a measured value has.
  #array(name, room) {
    return name === "time_s" ? new Float64Array(room) : new Float32Array(room);
  }

  /** Adds rows; `columns` has an array for each name. */
  append(columns, rows) {
    const from = Math.max(0, rows - this.most);
    if (from > 0) {
      // What was there is older than what is left out of these.
      this.length = 0;
    }
    this.#makeRoom(rows - from);
    for (const name of this.names) {
      this.arrays[name].set(columns[name].subarray(from, rows), this.length);
    }
    this.length += rows - from;
  }

  #makeRoom(rows) {
    if (this.length + rows <= this.room) {
      return;
    }
    const kept = Math.min(this.length, this.most);
    const dropped = this.length - kept;
    const room = Math.min(2 * this.most, Math.max(2 * this.room, kept + rows));
    for (const name of this.names) {
      const old = this.arrays[name];
      const target = room > this.room ? this.#array(name, room) : old;
      if (target === old) {
        target.copyWithin(0, dropped, this.length);
      } else {
        target.set(old.subarray(dropped, this.length));
      }
      this.arrays[name] = target;
    }
    this.room = room;
    this.length = kept;
  }

  /** All rows of a column. */
  column(name) {
    return this.arrays[name].subarray(0, this.length);
  }

  /** The value of a column in the last row; undefined where there is none. */
  last(name) {
    return this.length ? this.arrays[name][this.length - 1] : undefined;
  }

  /** Number of the first row that is later than `time`, or as late where `orAt` is true. */
  after(time, orAt = false) {
    const times = this.arrays.time_s;
    let low = 0;
    let high = this.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] > time || (orAt && times[middle] === time)) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return low;
  }

  /** First row and row after the last one with times from `start` to `end`. */
  range([start, end]) {
    return [this.after(start, true), this.after(end)];
  }
}

/** Of one test. */
export class Store {
  constructor(about = {}) {
    this.about = about;
    this.samples = new Columns(SAMPLE_COLUMNS, about.history_samples ?? SAMPLES);
    this.cycles = new Columns(CYCLE_COLUMNS, CYCLES);
    this.events = [];
    this.state = { state: "waiting", time_s: null, cause: null };
    this.missed = 0;
    this.messages = 0;
  }

  /** Takes a binary message that has been read. */
  take(message) {
    this.messages += 1;
    this.missed = message.missed;
    this[message.kind].append(message.columns, message.rows);
  }

  addEvent(event) {
    this.events.push(event);
    if (this.events.length > MOST_EVENTS) {
      this.events.shift();
    }
  }

  /** Rows of the cycles that ended until `time` and are in no ramp. */
  steadyCycles(time) {
    const ramp = this.cycles.column("ramp");
    const rows = Uint32Array.from({ length: this.cycles.after(time) }, (_, row) => row);
    return rows.filter((row) => !ramp[row]);
  }

  /**
   * Where the loop ends that is shown at `time`, s, and the frequency there, Hz, which is 0 before the first cycle: in a test that is over
   * that is the last steady cycle, as the ramp at the end shows nothing.
   */
  loopEnd(time) {
    const last = this.cycles.after(time) - 1;
    if (last < 0) {
      return { end: time, frequency: 0 };
    }
    const steady = this.isOver ? this.steadyCycles(time).at(-1) : undefined;
    return {
      end: steady === undefined ? time : this.cycles.column("time_s")[steady],
      frequency: this.cycles.column("frequency_Hz")[steady ?? last],
    };
  }

  /** RMS of the law's error over the RMS of the measured force, of the samples of a range of times. */
  errorWithin(times) {
    const [from, to] = this.samples.range(times);
    const [measured, law] = ["force_kN", "law_force_kN"].map((name) => this.samples.column(name));
    let [error, force] = [0, 0];
    for (let row = from; row < to; row += 1) {
      error += (measured[row] - law[row]) ** 2;
      force += measured[row] ** 2;
    }
    return Math.sqrt(error / force);
  }

  /** Of the last sample, s. */
  get lastTime() {
    return this.samples.last("time_s") ?? 0;
  }

  get isOver() {
    return !["waiting", "running"].includes(this.state.state);
  }
}
