// The page: what comes over the connection, what the user asks for, and when it is drawn.

import { Charts } from "./charts.js";
import { colours, whenSchemeChanges } from "./colours.js";
import { Connection } from "./connection.js";
import { csv, picture, save } from "./export.js";
import { number, percent, seconds } from "./format.js";
import { decode } from "./frames.js";
import { Store } from "./store.js";
import { View } from "./view.js";

/** From one drawing to the next, ms: more than 20 a second nobody sees. */
const BETWEEN_DRAWINGS = 50;
/** From one description for screen readers to the next, ms. */
const BETWEEN_DESCRIPTIONS = 2000;
const ZOOM = 0.5;
const STEP = 0.25;

const element = (id) => document.getElementById(id);
const view = new View();
let store = new Store();
let connection = "connecting";
let drawings = 0;
let dirty = true;

const change = () => {
  dirty = true;
};

const charts = new Charts(
  (kind, range) => {
    view[{ time: "zoom", cycle: "cycleZoom", loop: "loopZoom" }[kind]] = range;
    change();
  },
  () => resetZoom(),
);

// What has come.

function takeText(message) {
  if (message.type === "about") {
    begin(message);
  } else if (message.type === "event") {
    store.addEvent(message.event);
    showEvent(message.event);
  } else if (message.type === "state") {
    store.state = message.state;
  }
  change();
}

/** The server says everything from the beginning, whoever connects. */
function begin(message) {
  store = new Store(message);
  view.pausedAt = null;
  view.resetZoom();
  element("events").replaceChildren();
  element("no-events").hidden = false;
  const { about } = message;
  document.title = `${about.title}: live`;
  element("title").textContent = about.title;
  element("about").textContent = [about.specimen, about.law && `law: ${about.law}`].filter(Boolean).join("; ");
  element("no-cycles").hidden = about.has_cycles;
  element("values").setAttribute("aria-label", about.has_cycles ? "Last steady cycle" : "Values over the time shown");
  for (const name of OF_CYCLES) {
    element(`figure-${name}`).hidden = !about.has_cycles;
  }
  const every = message.bucket_samples;
  const rate = `${number(about.sample_rate_Hz)} samples a second`;
  element("decimation").textContent =
    every > 1 ? `${rate}; shown: from every ${every} samples, the smallest and the largest of each channel` : `${rate}, all kept`;
}

function showEvent(event) {
  const item = document.createElement("li");
  item.className = event.fault ? "fault" : "notice";
  const kind = document.createElement("strong");
  kind.textContent = event.fault ? "Fault" : "Note";
  const time = document.createElement("span");
  time.className = "time";
  time.textContent = seconds(event.time_s);
  item.append(kind, time, event.text);
  const list = element("events");
  list.prepend(item);
  while (list.children.length > store.events.length) {
    list.lastElementChild.remove();
  }
  element("no-events").hidden = true;
}

new Connection(
  {
    binary: (buffer) => {
      try {
        const message = decode(buffer);
        if (message) {
          store.take(message);
        }
      } catch (error) {
        element("trouble").textContent = error.message;
      }
      change();
    },
    text: takeText,
    status: (status) => {
      connection = status;
      change();
    },
  },
  () => store.isOver,
);

// What the user asks for.

const range = () => charts.ranges.time;

function resetZoom() {
  view.resetZoom();
  change();
}

function togglePause() {
  view.togglePause(store.lastTime);
  change();
}

function zoomBy(factor) {
  view.scale(range(), factor);
  change();
}

function moveBy(part) {
  view.move(range(), part);
  change();
}

function comments() {
  const { about, bucket_samples: every } = store.about;
  return [
    `${about?.title ?? ""}; specimen: ${about?.specimen ?? ""}`,
    `from the live page; from every ${every ?? 1} samples, the smallest and the largest of each channel`,
  ];
}

function fileName(what) {
  const [from, to] = range();
  return `live-${what}-${from.toFixed(2)}-${to.toFixed(2)}s`;
}

function exportSignals() {
  const { samples } = store;
  save(csv(samples, samples.range(range()), comments()), `${fileName("signals")}.csv`, "text/csv");
}

function exportCycles() {
  const { cycles } = store;
  const end = cycles.after(view.end(store.lastTime));
  save(csv(cycles, [0, end], comments().slice(0, 1)), "live-cycles.csv", "text/csv");
}

function exportPicture() {
  const title = `${element("title").textContent}, ${element("state").textContent}`;
  const canvas = picture(charts.figures(), colours(), title);
  canvas.toBlob((blob) => save(blob, `${fileName("charts")}.png`));
}

const ACTIONS = {
  pause: togglePause,
  "zoom-in": () => zoomBy(ZOOM),
  "zoom-out": () => zoomBy(1 / ZOOM),
  earlier: () => moveBy(-STEP),
  later: () => moveBy(STEP),
  reset: resetZoom,
  "export-signals": exportSignals,
  "export-cycles": exportCycles,
  "export-picture": exportPicture,
};

for (const [id, action] of Object.entries(ACTIONS)) {
  element(id).addEventListener("click", action);
}
element("window").addEventListener("change", ({ target }) => {
  view.window = target.value === "all" ? null : Number(target.value);
  view.zoom = null;
  change();
});

const KEYS = {
  " ": "pause",
  "+": "zoom-in",
  "=": "zoom-in",
  "-": "zoom-out",
  ArrowLeft: "earlier",
  ArrowRight: "later",
  0: "reset",
  Escape: "reset",
};

document.addEventListener("keydown", (event) => {
  const isTaken = event.ctrlKey || event.metaKey || event.altKey || event.target.closest("button, select, a, summary");
  const action = KEYS[event.key];
  if (action && !(isTaken && event.key !== "Escape")) {
    event.preventDefault();
    ACTIONS[action]();
  }
});

whenSchemeChanges(() => {
  charts.build();
  change();
});

// What is drawn.

const STATES = {
  waiting: "Waiting to begin",
  running: "Running",
  finished: "Finished",
  stopped: "Tripped",
  broken_off: "Interrupted",
};

function showState() {
  const { state, cause } = store.state;
  const isLost = connection !== "open" && !store.isOver;
  const text = isLost ? "No connection, trying again" : (STATES[state] ?? state);
  set("state", cause && !isLost ? `${text}: ${cause}` : text);
  element("state").dataset.state = isLost ? "lost" : state;
  element("pause").setAttribute("aria-pressed", view.isPaused);
  set("pause-label", view.isPaused ? "Resume" : "Pause");
  element("paused").hidden = !view.isPaused;
  element("reset").disabled = !view.isZoomed;
  set("missed", store.missed ? `${store.missed} samples dropped: this page is too slow for all of them` : "");
}

/** Only what changes is written, so that a screen reader is not told the same again. */
function set(id, text) {
  const place = element(id);
  if (place.textContent !== text) {
    place.textContent = text;
  }
}

function showValues() {
  const { cycles } = store;
  const last = store.steadyCycles(view.end(store.lastTime)).at(-1);
  const of = (name) => (last === undefined ? NaN : cycles.column(name)[last]);
  const withLaw = (measured, law) => {
    set(`value-${measured}`, number(of(VALUES[measured])));
    set(`law-${measured}`, number(of(law)));
  };
  withLaw("stiffness", "law_stiffness_kN_per_mm");
  withLaw("loss-factor", "law_loss_factor");
  const hasCycles = store.about.about?.has_cycles ?? true;
  set("value-error", percent(hasCycles ? of("law_error") : store.errorWithin(range())));
  set("value-time", seconds(view.end(store.lastTime)));
  set("value-cycle", last === undefined ? "–" : String(of("cycle")));
  set("value-temperature", number(of("temperature_degC"), 3));
}

/** Charts over cycles. */
const OF_CYCLES = ["stiffness", "loss-factor", "error"];
const VALUES = { stiffness: "stiffness_kN_per_mm", "loss-factor": "loss_factor" };

/** For who does not see the charts. */
function describe() {
  const [from, to] = range();
  const { x, y } = charts.ranges.loop;
  const texts = {
    loop: `Force over displacement, ${number(x[0])} to ${number(x[1])} mm and ${number(y[0])} to ${number(y[1])} kN`,
    displacement: `Displacement over time, ${seconds(from)} to ${seconds(to)}`,
    force: `Force over time, measured and by the law, ${seconds(from)} to ${seconds(to)}`,
    stiffness: `Stiffness over cycles; in the last one ${element("value-stiffness").textContent} kN/mm`,
    "loss-factor": `Loss factor over cycles; in the last one ${element("value-loss-factor").textContent}`,
    error: `Error of the law over cycles; in the last one ${element("value-error").textContent}`,
  };
  for (const [name, text] of Object.entries(texts)) {
    document.querySelector(`#figure-${name} .plot`).setAttribute("aria-label", text);
  }
}

let drawn = -Infinity;
let described = -Infinity;

function frame(now) {
  if (dirty && now - drawn >= BETWEEN_DRAWINGS) {
    dirty = false;
    drawn = now;
    drawings += 1;
    charts.draw(store, view);
    showState();
    showValues();
  }
  if (now - described >= BETWEEN_DESCRIPTIONS) {
    described = now;
    describe();
  }
  requestAnimationFrame(frame);
}

requestAnimationFrame(frame);

/** For the console, and for tests of this page. */
window.live = {
  get store() {
    return store;
  },
  get drawings() {
    return drawings;
  },
  view,
  charts,
};
