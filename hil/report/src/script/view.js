// What a reader does with a picture: pointer, wheel and keys.
const HELP = "Drag a box to zoom, Shift and drag to move, Ctrl and wheel to zoom about the pointer; double-click or Escape resets; tap to read. "
  + "With keys: arrows go from sample to sample and from curve to curve, Shift and arrows move, + and − zoom, Escape resets.";

const view = figure => {
  const svg = figure.querySelector("svg.picture[role=img]");
  if (!svg) return;
  const panels = [...svg.querySelectorAll("g.panel")].map(group => panelOf(svg, group));
  const title = svg.querySelector("title");
  // The browser would show it over the values.
  svg.setAttribute("aria-label", title.textContent);
  title.remove();
  svg.tabIndex = 0;
  svg.setAttribute("aria-describedby", "picture-help");
  const readout = document.createElement("div");
  readout.className = "readout";
  readout.hidden = true;
  const reset = document.createElement("button");
  reset.type = "button";
  reset.className = "reset";
  reset.textContent = "whole picture";
  reset.hidden = true;
  figure.append(reset, readout);

  const at = event => {
    const box = svg.getBoundingClientRect();
    const whole = svg.viewBox.baseVal;
    return [((event.clientX - box.left) / box.width) * whole.width, ((event.clientY - box.top) / box.height) * whole.height];
  };
  let drag = null, current = null;
  const settle = () => { reset.hidden = panels.every(panel => panel.isWhole()); };
  const hide = () => { readout.hidden = true; current = null; panels.forEach(panel => panel.over.replaceChildren()); };
  const whole = () => { panels.forEach(panel => panel.reset()); hide(); settle(); };
  const show = (panel, found, spoken) => {
    panels.forEach(one => one.over.replaceChildren());
    if (!found) return hide();
    current = found.curve ? found : null;
    const [x, y] = found.at;
    const cross = `M${x} ${panel.top}V${panel.top + panel.height}M${panel.left} ${y}H${panel.left + panel.width}`;
    if (panel.has([x, y])) make(panel.over, "path", { d: cross, stroke: "#555555", "stroke-dasharray": "2 3", fill: "none" });
    for (const [[cx, cy], colour] of found.points || []) {
      if (panel.has([cx, cy])) make(panel.over, "circle", { cx, cy, r: 4.5, fill: "#ffffff", stroke: colour, "stroke-width": 2 });
    }
    const line = text => { const one = document.createElement("div"); one.textContent = text; return one; };
    const across = `${panel.x.name} ${panel.x.scale === "log" ? number(found.values[0])
      : reading(found.values[0], Math.abs(panel.view.x1 - panel.view.x0) / 2000)} ${panel.x.unit}`;
    const row = found.curve && found.curve.rows && found.curve.rows[found.index];
    const of = row ? [line(row.firstElementChild.textContent)] : [];
    const up = panel.curves.some(curve => curve.cells) ? [line(`${panel.y.name} ${number(found.values[1])} ${panel.y.unit}`)] : [];
    readout.replaceChildren(...of, line(across), ...up, ...found.lines.map(([name, value]) => line(`${name}: ${value}`)));
    readout.hidden = false;
    readout.setAttribute("role", spoken ? "status" : "none");
    const box = svg.getBoundingClientRect(), outer = figure.getBoundingClientRect();
    const scale = box.width / svg.viewBox.baseVal.width;
    const [px, py] = [box.left - outer.left + x * scale, box.top - outer.top + y * scale];
    const beside = px > outer.width / 2 ? px - readout.offsetWidth - 14 : px + 14;
    readout.style.left = `${Math.max(0, Math.min(beside, outer.width - readout.offsetWidth))}px`;
    readout.style.top = `${Math.max(0, Math.min(py - readout.offsetHeight - 10, outer.height - readout.offsetHeight))}px`;
  };

  svg.addEventListener("pointerdown", event => {
    const start = at(event);
    const panel = panels.find(one => one.has(start));
    if (!panel || event.button !== 0) return;
    if (event.pointerType === "touch") return show(panel, readAt(panel, start));
    drag = { panel, start, view: panel.view, moves: event.shiftKey };
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", event => {
    const here = at(event);
    if (!drag) {
      const panel = panels.find(one => one.has(here));
      return panel ? show(panel, readAt(panel, here)) : hide();
    }
    const { panel, start } = drag;
    const far = [here[0] - start[0], here[1] - start[1]];
    if (drag.moves) {
      panel.view = drag.view;
      panel.move(-far[0] / panel.width, far[1] / panel.height);
      settle();
    } else {
      hide();
      const corner = [Math.min(Math.max(here[0], panel.left), panel.left + panel.width),
        Math.min(Math.max(here[1], panel.top), panel.top + panel.height)];
      drag.corner = corner;
      make(panel.over, "rect", { x: Math.min(start[0], corner[0]), y: Math.min(start[1], corner[1]),
        width: Math.abs(corner[0] - start[0]), height: Math.abs(corner[1] - start[1]),
        fill: "#0072b2", "fill-opacity": ".15", stroke: "#0072b2" });
    }
  });
  svg.addEventListener("pointerup", () => {
    const ended = drag;
    drag = null;
    if (!ended || !ended.corner) return;
    const { panel, start, corner } = ended;
    panel.over.replaceChildren();
    // A hand is not that still.
    if (Math.abs(corner[0] - start[0]) < 6 || Math.abs(corner[1] - start[1]) < 6) return;
    const [a, b] = [panel.placeAt(start), panel.placeAt(corner)];
    panel.show({ x0: Math.min(a[0], b[0]), x1: Math.max(a[0], b[0]), y0: Math.min(a[1], b[1]), y1: Math.max(a[1], b[1]) });
    settle();
  });
  svg.addEventListener("pointerleave", () => { if (!drag && document.activeElement !== svg) hide(); });
  svg.addEventListener("pointercancel", () => { drag = null; hide(); });
  svg.addEventListener("wheel", event => {
    const here = at(event);
    const panel = panels.find(one => one.has(here));
    if (!event.ctrlKey || !panel) return;
    event.preventDefault();
    panel.zoom(event.deltaY < 0 ? 0.8 : 1.25, here);
    settle();
  }, { passive: false });
  svg.addEventListener("dblclick", whole);
  reset.addEventListener("click", () => { whole(); svg.focus(); });
  svg.addEventListener("blur", hide);
  svg.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const panel = (current && current.panel) || panels[0];
    const along = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.key === "Escape") whole();
    else if (event.key === "+" || event.key === "=") panel.zoom(0.8, current && current.at);
    else if (event.key === "-") panel.zoom(1.25, current && current.at);
    else if (along && event.shiftKey) panel.move(0.1 * along[0], 0.1 * along[1]);
    else if (along) step(along);
    else return;
    event.preventDefault();
    settle();
  });
  // To the next sample, or to the same place of the next curve, panel after panel.
  const step = ([dx, dy]) => {
    const all = panels.flatMap(panel => panel.curves.filter(curve => curve.points && curve.points.length
      && curve.group.style.display !== "none").map(curve => ({ panel, curve })));
    if (!all.length) return;
    let place = current ? all.findIndex(one => one.curve === current.curve) : 0;
    let index = current ? current.index : 0;
    if (current && dy) {
      const x = all[place].curve.points[index][0];
      place = (place - dy + all.length) % all.length;
      const points = all[place].curve.points;
      index = all[place].curve.rises ? points.reduce((best, point, i) =>
        (Math.abs(point[0] - x) < Math.abs(points[best][0] - x) ? i : best), 0) : Math.min(index, points.length - 1);
    }
    const { panel, curve } = all[place];
    if (current && dx) index = (index + dx + curve.points.length) % curve.points.length;
    const chosen = [[curve, index]];
    show(panel, { panel, curve, index, chosen, ...linesOf(panel, curve, index, chosen) }, true);
  };
};

const pictures = [...document.querySelectorAll("figure")];
if (pictures.length) {
  const help = document.createElement("p");
  help.className = "help";
  help.id = "picture-help";
  help.textContent = HELP;
  document.querySelector("main").prepend(help);
  pictures.forEach(view);
}
