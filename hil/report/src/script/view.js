// Zooming, moving and reading of a picture.
const SVG = "http://www.w3.org/2000/svg";
const FINE = 20;
const make = (parent, name, attributes, text) => {
  const one = document.createElementNS(SVG, name);
  for (const key in attributes) one.setAttribute(key, attributes[key]);
  if (text !== undefined) one.textContent = text;
  parent.append(one);
  return one;
};

const panelOf = (svg, group) => {
  const [left, top, width, height] = group.dataset.at.split(" ").map(Number);
  const panel = { svg, group, left, top, width, height, x: axisOf(group.dataset.x), y: axisOf(group.dataset.y) };
  const inner = group.querySelector(".curves");
  const ticks = group.querySelector(".ticks");
  const [, , boxWidth, boxHeight] = inner.getAttribute("viewBox").split(" ").map(Number);
  const font = +svg.getAttribute("font-size");
  const whole = { x0: panel.x.from, x1: panel.x.to, y0: panel.y.from, y1: panel.y.to };
  const first = [...ticks.childNodes];
  panel.y.labels = first.filter(one => one.getAttribute("text-anchor") === "end").map(one => [
    whole.y1 - ((+one.getAttribute("y") - top) / height) * (whole.y1 - whole.y0), one.textContent]);
  panel.curves = [...inner.children].map(curveOf).filter(Boolean);
  panel.over = make(group, "g", { "pointer-events": "none" });
  for (const line of inner.querySelectorAll("path[stroke]:not([transform])")) {
    const scaled = list => list.split(" ").map(n => n / FINE).join(" ");
    line.setAttribute("vector-effect", "non-scaling-stroke");
    line.style.strokeWidth = line.getAttribute("stroke-width") / FINE;
    if (line.hasAttribute("stroke-dasharray")) line.style.strokeDasharray = scaled(line.getAttribute("stroke-dasharray"));
  }
  const marks = [...inner.querySelectorAll("[transform]")].map(mark => [mark, ...markPlace(mark)]);

  panel.isWhole = () => panel.view === whole;
  panel.show = view => {
    const least = 1e-5;
    if ((view.x1 - view.x0) < least * (whole.x1 - whole.x0) || (view.y1 - view.y0) < least * (whole.y1 - whole.y0)) return;
    panel.view = view;
    const [w, h] = [whole.x1 - whole.x0, whole.y1 - whole.y0];
    panel.box = [((view.x0 - whole.x0) / w) * boxWidth, ((whole.y1 - view.y1) / h) * boxHeight,
      ((view.x1 - view.x0) / w) * boxWidth, ((view.y1 - view.y0) / h) * boxHeight];
    inner.setAttribute("viewBox", panel.box.join(" "));
    for (const [mark, x, y] of marks) {
      mark.setAttribute("transform", `translate(${x} ${y}) scale(${panel.box[2] / boxWidth} ${panel.box[3] / boxHeight})`);
    }
    if (view === whole) ticks.replaceChildren(...first);
    else drawTicks();
    panel.over.replaceChildren();
  };
  panel.reset = () => panel.show(whole);

  const drawTicks = () => {
    const { x0, x1, y0, y1 } = panel.view;
    ticks.replaceChildren();
    let grid = "";
    for (const [place, label] of ticksOf(panel.x, x0, x1, width / (5 * font))) {
      const at = left + ((place - x0) / (x1 - x0)) * width;
      grid += `M${at} ${top}V${top + height}`;
      make(ticks, "text", { x: at, y: top + height + 0.9 * font, dy: ".35em", "text-anchor": "middle" }, label);
    }
    for (const [place, label] of ticksOf(panel.y, y0, y1, height / (2.6 * font))) {
      const at = top + ((y1 - place) / (y1 - y0)) * height;
      grid += `M${left} ${at}H${left + width}`;
      make(ticks, "text", { x: left - 0.4 * font, y: at, dy: ".35em", "text-anchor": "end" }, label);
    }
    make(ticks, "path", { d: grid, stroke: "#e4e4e4", fill: "none" });
  };

  // A point of the inner SVG in px of the picture.
  panel.toPicture = ([x, y]) => [
    left + ((x - panel.box[0]) / panel.box[2]) * width, top + ((y - panel.box[1]) / panel.box[3]) * height];
  panel.toValues = ([x, y]) => [
    valueAt[panel.x.scale](whole.x0 + (x / boxWidth) * (whole.x1 - whole.x0)),
    valueAt[panel.y.scale](whole.y1 - (y / boxHeight) * (whole.y1 - whole.y0))];
  // A place under a point of the picture.
  panel.placeAt = ([x, y]) => [
    panel.view.x0 + ((x - left) / width) * (panel.view.x1 - panel.view.x0),
    panel.view.y1 - ((y - top) / height) * (panel.view.y1 - panel.view.y0)];
  panel.has = ([x, y]) => x >= left && x <= left + width && y >= top && y <= top + height;
  panel.zoom = (factor, at) => {
    const [x, y] = panel.placeAt(at || [left + width / 2, top + height / 2]);
    const { x0, x1, y0, y1 } = panel.view;
    panel.show({ x0: x + (x0 - x) * factor, x1: x + (x1 - x) * factor, y0: y + (y0 - y) * factor, y1: y + (y1 - y) * factor });
  };
  panel.move = (dx, dy) => {
    const { x0, x1, y0, y1 } = panel.view;
    const [w, h] = [(x1 - x0) * dx, (y1 - y0) * dy];
    panel.show({ x0: x0 + w, x1: x1 + w, y0: y0 + h, y1: y1 + h });
  };
  panel.show(whole);
  return panel;
};

// What is nearest to a point of the picture: a place in the picture, and lines of name and value.
const readAt = (panel, at) => {
  const visible = panel.curves.filter(curve => curve.group.style.display !== "none");
  const far = point => { const [x, y] = panel.toPicture(point); return Math.hypot(x - at[0], y - at[1]); };
  const inner = [panel.box[0] + ((at[0] - panel.left) / panel.width) * panel.box[2],
    panel.box[1] + ((at[1] - panel.top) / panel.height) * panel.box[3]];
  const map = visible.find(curve => curve.cells);
  if (map) {
    const rows = map.cells.length / map.columns;
    const [whole, high] = [panel.width * FINE, panel.height * FINE];
    const column = Math.floor((inner[0] / whole) * map.columns), row = rows - 1 - Math.floor((inner[1] / high) * rows);
    const value = map.cells[row * map.columns + column];
    const scale = +map.group.dataset.scale || 1;
    const name = map.name || "value";
    return { at, values: panel.toValues(inner), lines: [[name, isNaN(value) ? "none here" : `${number(value * scale)} ${map.group.dataset.unit || ""}`]] };
  }
  const nearest = curve => {
    let best = -1, least = Infinity;
    curve.points.forEach((point, i) => {
      const distance = curve.rises ? Math.abs(point[0] - inner[0]) : far(point);
      if (distance < least) [best, least] = [i, distance];
    });
    return [best, best < 0 ? Infinity : far(curve.points[best])];
  };
  const found = visible.map(curve => [curve, ...nearest(curve)]).filter(([, index]) => index >= 0);
  if (!found.length) return null;
  const [first, index] = found.reduce((a, b) => (b[2] < a[2] ? b : a));
  // Curves of one loop have their samples at the same instants.
  const shown = found.filter(([curve]) => curve.raised === first.raised);
  const chosen = shown.map(([curve, own]) => [curve, !first.rises && curve.points.length === first.points.length ? index : own]);
  return { panel, curve: first, index, chosen, ...linesOf(panel, first, index, chosen) };
};

const linesOf = (panel, first, index, chosen) => {
  const resolution = Math.abs(panel.view.y1 - panel.view.y0) / 2000;
  const written = value => (panel.y.scale === "log" ? number(value) : reading(value, resolution));
  const points = chosen.map(([curve, i]) => curve.points[i]);
  const values = points.map(panel.toValues);
  return {
    at: panel.toPicture(first.points[index]),
    values: panel.toValues(first.points[index]),
    points: points.map((point, i) => [panel.toPicture(point), chosen[i][0].colour]),
    lines: chosen.map(([curve], i) => [curve.name || panel.y.name,
      panel.y.scale === "names" && !curve.raised && !panel.y.unit ? panel.y.labels.reduce((a, b) =>
        Math.abs(b[0] - values[i][1]) < Math.abs(a[0] - values[i][1]) ? b : a)[1]
        : `${written(values[i][1] - curve.raised)} ${panel.y.unit}`]),
  };
};

const HELP = "Drag a box to zoom, Shift and drag to move, Ctrl and wheel to zoom about the pointer; double-click or Escape resets. "
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
    const up = panel.curves.some(curve => curve.cells) ? [line(`${panel.y.name} ${number(found.values[1])} ${panel.y.unit}`)] : [];
    readout.replaceChildren(line(across), ...up, ...found.lines.map(([name, value]) => line(`${name}: ${value}`)));
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
