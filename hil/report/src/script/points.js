// The points of a panel's curves, in the units of its inner SVG, from the paths and marks that draw them.
const pathPoints = path => {
  const points = [];
  let x = 0, y = 0;
  for (const [, letter, numbers] of path.matchAll(/([MmlhHVz])([^MmlhHVz]*)/g)) {
    if (letter === "h") continue;
    const all = (numbers.match(/-?\d+/g) || []).map(Number);
    for (let i = 0; i + 1 < all.length; i += 2) {
      const from = letter === "M" ? [0, 0] : [x, y];
      x = from[0] + all[i];
      y = from[1] + all[i + 1];
      points.push([x, y]);
    }
  }
  return points;
};

const markPlace = mark => mark.getAttribute("transform").match(/-?[\d.]+/g).slice(0, 2).map(Number);

// A curve of a panel: `null` for what has no values of its own.
const curveOf = group => {
  if (group.matches(".band")) return null;
  const curve = { group, name: group.dataset.curve, raised: +(group.dataset.raised || 0) };
  if (group.dataset.cells !== undefined) {
    const cells = group.dataset.cells.split(",").map(cell => (cell === "" ? NaN : +cell / 1000));
    return { ...curve, cells, columns: +group.dataset.columns };
  }
  // As they are before anyone sorts them.
  if (group.dataset.rows) curve.rows = [...document.querySelectorAll(group.dataset.rows)];
  const path = group.querySelector("path:not([transform])");
  let points = path ? pathPoints(path.getAttribute("d")) : [...group.children].map(markPlace);
  if (path && path.matches(".stems")) points = points.filter((_, i) => i % 2);
  const drawn = path || group.firstElementChild;
  const colour = drawn && (drawn.getAttribute("fill") === "none" || path ? drawn.getAttribute("stroke") : drawn.getAttribute("fill"));
  const rises = points.every((point, i) => i === 0 || point[0] >= points[i - 1][0]);
  return { ...curve, points, colour, rises };
};
