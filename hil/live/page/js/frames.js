// The binary messages of the server, as `docs/live.md` describes them.

const VERSION = 1;
const HEADER = 24;

const KINDS = {
  1: { name: "samples", columns: ["time_s", "displacement_mm", "force_kN", "law_force_kN"] },
  2: {
    name: "cycles",
    columns: [
      "time_s",
      "block",
      "cycle",
      "ramp",
      "amplitude_mm",
      "frequency_Hz",
      "stiffness_kN_per_mm",
      "loss_factor",
      "energy_J",
      "law_stiffness_kN_per_mm",
      "law_loss_factor",
      "law_error",
      "temperature_degC",
    ],
  },
};

export const SAMPLE_COLUMNS = KINDS[1].columns;
export const CYCLE_COLUMNS = KINDS[2].columns;

/**
 * Reads one message.
 *
 * @param {ArrayBuffer} buffer
 * @returns {{kind: string, rows: number, missed: number, columns: Object<string, Float32Array|Float64Array>} | null}
 *   the columns by name, times in s since the start of the test; null for a kind that is not known
 * @throws {Error} where it is no message of this version
 */
export function decode(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEADER || view.getUint8(0) !== 0x4d || view.getUint8(1) !== 0x44) {
    throw new Error("This is no message of the live page.");
  }
  if (view.getUint8(2) !== VERSION) {
    throw new Error(`Messages have version ${view.getUint8(2)}, and this page reads ${VERSION}: load the page again.`);
  }
  const rows = view.getUint32(4, true);
  const count = view.getUint32(8, true);
  if (buffer.byteLength !== HEADER + 4 * rows * count) {
    throw new Error("A message is cut.");
  }
  const kind = KINDS[view.getUint8(3)];
  if (!kind) {
    return null;
  }
  if (count < kind.columns.length) {
    throw new Error("A message lacks columns.");
  }
  const start = view.getFloat64(16, true);
  const columns = {};
  kind.columns.forEach((name, place) => {
    columns[name] = floats(view, HEADER + 4 * rows * place, rows);
  });
  columns.time_s = Float64Array.from(columns.time_s, (offset) => start + offset);
  return { kind: kind.name, rows, missed: view.getUint32(12, true), columns };
}

function floats(view, at, rows) {
  const values = new Float32Array(rows);
  for (let row = 0; row < rows; row++) {
    values[row] = view.getFloat32(at + 4 * row, true);
  }
  return values;
}
