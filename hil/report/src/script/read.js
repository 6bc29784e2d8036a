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
