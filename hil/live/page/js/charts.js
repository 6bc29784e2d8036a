// The charts, each in its figure of the page.

import { colours } from "./colours.js";
import { pick, select } from "./decimate.js";
import { withUnit } from "./format.js";
import { extent, loopData, loopPath } from "./loop.js";

/* global uPlot */

const MEASURED = "measured";
const LAW = "law";

/** What each figure draws; x of `time` and `cycle` charts is shared. */
const FIGURES = {
  loop: { x: "displacement, mm", y: "force, kN", unit: "kN" },
  displacement: { kind: "time", y: "mm", unit: "mm", columns: { [MEASURED]: "displacement_mm" } },
  force: { kind: "time", y: "kN", unit: "kN", columns: { [MEASURED]: "force_kN", [LAW]: "law_force_kN" } },
  stiffness: {
    kind: "cycle",
    y: "kN/mm",
    unit: "kN/mm",
    columns: { [MEASURED]: "stiffness_kN_per_mm", [LAW]: "law_stiffness_kN_per_mm" },
  },
  "loss-factor": {
    kind: "cycle",
    y: "",
    unit: "",
    columns: { [MEASURED]: "loss_factor", [LAW]: "law_loss_factor" },
  },
  error: { kind: "cycle", y: "%", unit: "%", columns: { [LAW]: "law_error" }, factor: 100, label: "error" },
};

export class Charts {
  /**
   * @param {function(string, number[]|Object)} zoomed is told "time", "cycle" or "loop" and the range
   * @param {function()} reset is told that all is to be shown
   */
  constructor(zoomed, reset) {
    this.zoomed = zoomed;
    this.reset = reset;
    this.plots = {};
    this.ranges = { time: [0, 1], cycle: [0, 1], loop: { x: [-1, 1], y: [-1, 1] } };
    this.build();
    const observer = new ResizeObserver(() => this.fit());
    this.figures().forEach((figure) => observer.observe(figure.querySelector(".plot")));
  }

  figures() {
    return Object.keys(FIGURES).map((name) => document.getElementById(`figure-${name}`));
  }

  /** Makes all charts, with the colours as they are now. */
  build() {
    const theme = colours();
    for (const [name, figure] of Object.entries(FIGURES)) {
      this.plots[name]?.destroy();
      const place = document.querySelector(`#figure-${name} .plot`);
      const options = figure.kind ? this.#overX(figure, theme, place) : this.#loop(figure, theme, place);
      const empty = figure.kind ? [[], ...Object.keys(figure.columns).map(() => [])] : [null, [[], []], [[], []]];
      this.plots[name] = new uPlot(options, empty, place);
    }
  }

  /** Gives every chart the size of its place. */
  fit() {
    for (const [name, plot] of Object.entries(this.plots)) {
      const size = sizeOf(document.querySelector(`#figure-${name} .plot`));
      if (size.width !== plot.width || size.height !== plot.height) {
        plot.setSize(size);
      }
    }
  }

  /** Draws what `view` shows of `store`. */
  draw(store, view) {
    const { samples, cycles } = store;
    const first = samples.length ? samples.column("time_s")[0] : 0;
    const range = view.range(first, store.lastTime);
    this.ranges.time = range;
    const steady = store.steadyCycles(view.end(store.lastTime));
    const numbers = pick(cycles.column("cycle"), steady);
    this.ranges.cycle = view.cycleZoom ?? [
      numbers.length ? numbers[0] - 0.5 : 0,
      Math.max(numbers.length ? numbers[numbers.length - 1] + 0.5 : 0, (numbers[0] ?? 0) + 5),
    ];
    for (const [name, figure] of Object.entries(FIGURES)) {
      const plot = this.plots[name];
      if (figure.kind === "time") {
        plot.setData(this.#timeData(samples, figure, range, 2 * plot.bbox.width));
      } else if (figure.kind === "cycle") {
        plot.setData(cycleData(cycles, figure, steady, this.ranges.cycle, 2 * plot.bbox.width));
      } else {
        const rows = samples.range(view.loopRange(range, store.loopEnd(range[1])));
        const data = loopData(samples, rows);
        const [, [displacement, force], [, law]] = data;
        this.ranges.loop = view.loopZoom ?? { x: extent([displacement]), y: extent([force, law]) };
        plot.batch(() => {
          plot.setData(data, false);
          for (const [scale, [min, max]] of Object.entries(this.ranges.loop)) {
            plot.setScale(scale, { min, max });
          }
        });
      }
    }
  }

  #timeData(samples, figure, range, pixels) {
    const [from, to] = samples.range(range);
    const columns = Object.values(figure.columns).map((name) => samples.column(name));
    // One row beyond each end, so that lines go on to the edge.
    const rows = select(columns, Math.max(0, from - 1), Math.min(samples.length, to + 1), Math.max(1, Math.round(pixels)));
    return [pick(samples.column("time_s"), rows), ...columns.map((column) => pick(column, rows))];
  }

  #overX(figure, theme, place) {
    const isTime = figure.kind === "time";
    const series = Object.keys(figure.columns).map((source, number) => ({
      ...line(theme, source),
      label: figure.label ?? source,
      value: withUnit(figure.unit),
      // The second line is dashed and without points, so that the first one is seen where they agree.
      points: { show: !isTime && number === 0, size: 5, stroke: theme[source], fill: theme[source] },
    }));
    return {
      ...sizeOf(place),
      scales: { x: { time: false, range: () => this.ranges[figure.kind] } },
      axes: [axis(theme, isTime ? "s" : "cycle"), axis(theme, figure.y, true)],
      series: [{ label: isTime ? "time" : "cycle", value: withUnit(isTime ? "s" : "") }, ...series],
      cursor: cursor(figure.kind, { x: true, y: false }, this.reset),
      hooks: this.#hooks(figure.kind, selectedX),
    };
  }

  #loop(figure, theme, place) {
    const series = [MEASURED, LAW].map((source) => ({
      ...line(theme, source),
      label: source,
      facets: [
        { scale: "x", auto: false },
        { scale: "y", auto: false },
      ],
      paths: loopPath,
    }));
    const readout = document.getElementById("loop-readout");
    const zoom = (u) => ({
      x: selectedX(u),
      y: [u.posToVal(u.select.top + u.select.height, "y"), u.posToVal(u.select.top, "y")],
    });
    const shown = (u) => {
      const { left, top } = u.cursor;
      const value = withUnit("mm");
      const force = withUnit("kN");
      readout.textContent =
        left >= 0 && top >= 0 ? `${value(u, u.posToVal(left, "x"))}, ${force(u, u.posToVal(top, "y"))}` : "";
    };
    return {
      ...sizeOf(place),
      mode: 2,
      legend: { show: false },
      scales: {
        x: { time: false, auto: false, range: (_, min, max) => [min, max] },
        y: { auto: false, range: (_, min, max) => [min, max] },
      },
      axes: [axis(theme, figure.x), axis(theme, figure.y, true)],
      series: [null, ...series],
      cursor: { ...cursor("loop", { x: true, y: true }, this.reset), dataIdx: () => null, points: { show: false } },
      hooks: { ...this.#hooks("loop", zoom), setCursor: [shown] },
    };
  }

  #hooks(kind, rangeOf) {
    return {
      setSelect: [
        (u) => {
          if (u.select.width > 0) {
            const range = rangeOf(u);
            u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
            this.zoomed(kind, range);
          }
        },
      ],
    };
  }
}

function cursor(kind, { x, y }, reset) {
  return {
    drag: { x, y, setScale: false },
    bind: { dblclick: () => () => reset() },
    ...(kind !== "loop" && {
      sync: { key: kind, filters: { pub: (type) => type === "mousemove" || type === "mouseleave" } },
    }),
  };
}

function selectedX(u) {
  return [u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")];
}

/** Of the steady cycles: in a ramp stiffness and loss factor are not those of an amplitude. */
function cycleData(cycles, figure, steady, [low, high], points) {
  const number = cycles.column("cycle");
  // One beyond each end, so that lines go on to the edge.
  const isShown = (at) => at >= 0 && at < steady.length && number[steady[at]] >= low && number[steady[at]] <= high;
  const shown = steady.filter((_, at) => isShown(at - 1) || isShown(at) || isShown(at + 1));
  const columns = Object.values(figure.columns).map((name) => pick(cycles.column(name), shown));
  const rows = select(columns, 0, shown.length, Math.max(1, Math.round(points)));
  const factor = figure.factor ?? 1;
  const numbers = pick(pick(number, shown), rows);
  return [numbers, ...columns.map((column) => pick(column, rows).map((value) => factor * value))];
}

function sizeOf(place) {
  // The legend stands below the chart, in the same place.
  const legend = place.querySelector(".u-legend")?.offsetHeight ?? (place.dataset.legend === "none" ? 0 : 32);
  return { width: Math.max(200, place.clientWidth), height: Math.max(120, place.clientHeight - legend) };
}

function line(theme, source) {
  const dash = source === LAW ? [6, 4] : [];
  return { stroke: theme[source], width: 1.5, dash };
}

function axis(theme, label, isY = false) {
  const font = "12px system-ui, sans-serif";
  return {
    label,
    labelFont: font,
    labelSize: 18,
    font,
    stroke: theme.text,
    grid: { stroke: theme.grid, width: 1 },
    ticks: { stroke: theme.grid, width: 1 },
    size: isY ? 52 : 30,
  };
}
