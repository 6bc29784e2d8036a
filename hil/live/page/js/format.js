// Numbers as they are shown.

/** With as many digits as say something: 4 of them. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) {
    return "–";
  }
  if (value === 0) {
    return "0";
  }
  const size = Math.floor(Math.log10(Math.abs(value)));
  return value.toFixed(Math.min(6, Math.max(0, digits - 1 - size))).replace("-", "−");
}

/** Of a part of one. */
export function percent(value) {
  const is = Number.isFinite(value);
  return is ? `${number(100 * value, 3)} %` : "–";
}

/** A value with its unit, for a legend. */
export function withUnit(unit) {
  return (_, value) => {
    const text = number(value);
    return text === "–" || !unit ? text : `${text} ${unit}`;
  };
}

export function seconds(value) {
  return Number.isFinite(value) ? `${value.toFixed(2)} s` : "–";
}
