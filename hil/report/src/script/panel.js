// A panel: where its values lie, and how it is zoomed and moved.
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
