// What is shown, as files.

/** Rows `from` to `to` of columns as CSV, with comment lines. */
export function csv(columns, [from, to], comments) {
  const lines = comments.map((comment) => `# ${comment.replace(/[\r\n]+/g, " ")}`);
  lines.push(columns.names.join(","));
  const arrays = columns.names.map((name) => columns.column(name));
  for (let row = from; row < to; row++) {
    lines.push(columns.names.map((name, place) => cell(name, arrays[place][row])).join(","));
  }
  return `${lines.join("\n")}\n`;
}

/** A float of 32 bits has 8 digits at most that say something, and a time counts ticks. */
function cell(name, value) {
  if (!Number.isFinite(value)) {
    return "";
  }
  return String(name === "time_s" ? Number(value.toFixed(7)) : Number(value.toPrecision(8)));
}

/** The charts of `figures`, each below its caption, as a picture with a key. */
export function picture(figures, { surface, text, measured, law }, title) {
  const scale = devicePixelRatio || 1;
  const outside = document.getElementById("charts").getBoundingClientRect();
  const head = 32;
  const margin = 12;
  const canvas = document.createElement("canvas");
  canvas.width = Math.round((outside.width + 2 * margin) * scale);
  canvas.height = Math.round((outside.height + head) * scale);
  const context = canvas.getContext("2d");
  context.scale(scale, scale);
  context.fillStyle = surface;
  context.fillRect(0, 0, outside.width + 2 * margin, outside.height + head);
  context.translate(margin, 0);
  context.fillStyle = text;
  context.font = "600 15px system-ui, sans-serif";
  context.fillText(title, 0, 20);
  context.font = "13px system-ui, sans-serif";
  let left = outside.width - 180;
  for (const [name, colour, dash] of [
    ["measured", measured, []],
    ["law", law, [6, 4]],
  ]) {
    context.strokeStyle = colour;
    context.lineWidth = 2;
    context.setLineDash(dash);
    context.beginPath();
    context.moveTo(left, 15);
    context.lineTo(left + 24, 15);
    context.stroke();
    context.fillText(name, left + 30, 20);
    left += 110;
  }
  for (const figure of figures) {
    const caption = figure.querySelector("figcaption");
    const place = caption.getBoundingClientRect();
    context.font = "600 13px system-ui, sans-serif";
    context.fillText(caption.dataset.title, place.left - outside.left, place.top - outside.top + head + 15);
    const chart = figure.querySelector("canvas");
    const at = chart.getBoundingClientRect();
    context.drawImage(chart, at.left - outside.left, at.top - outside.top + head, at.width, at.height);
  }
  return canvas;
}

/** Lets the browser save `content` under `name`. */
export function save(content, name, type) {
  const blob = content instanceof Blob ? content : new Blob([content], { type });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
