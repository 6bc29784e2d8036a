// Axes: the places of values, ticks and numbers. picture/axis.rs draws them first; a zoom draws them again.
const placeOf = { lin: v => v, log: v => Math.log10(v), cbrt: v => Math.cbrt(v), names: v => v };
const valueAt = { lin: p => p, log: p => 10 ** p, cbrt: p => p ** 3, names: p => p };

// `name|unit|scale|from|to`, the last two as places.
const axisOf = text => {
  const [name, unit, scale, from, to] = text.split("|");
  return { name, unit, scale, from: +from, to: +to };
};

const minus = text => text.replace("-", "−");

// Three digits, as the page has them.
const number = value => {
  if (!isFinite(value)) return "—";
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size >= 6) return minus(value.toExponential(2).replace("+", "").replace("e-", "e−"));
  return minus(value.toFixed(Math.max(0, 2 - size)));
};

// Without trailing zeros, and with two digits if that changes it by less than half a per cent, as text.rs has it.
const nominal = value => {
  const two = +value.toExponential(1);
  const text = number(Math.abs(two - value) < 5e-3 * Math.abs(value) ? two : value);
  return /e/.test(text) || !text.includes(".") ? text : text.replace(/\.?0+$/, "");
};

// With the decimals that a reading at this resolution has.
const reading = (value, resolution) => {
  const decimals = Math.ceil(-Math.log10(resolution));
  return isFinite(decimals) && decimals <= 6 && decimals >= 0 ? minus(value.toFixed(decimals)) : number(value);
};

// Multiples of 1, 2 or 5 times a power of ten: at most so many, with the decimals that tell them apart.
const even = (from, to, most) => {
  const least = (to - from) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map(factor => factor * power).find(one => one >= least * (1 - 1e-9));
  const decimals = Math.max(0, -Math.floor(Math.log10(step * 1.000001)));
  const all = [];
  for (let i = Math.ceil(from / step - 1e-9); i <= to / step + 1e-9; i += 1) {
    const value = i * step;
    const label = Math.abs(value) < step / 2 ? "0" : minus(value.toFixed(Math.min(decimals, 20)));
    all.push([value, decimals > 6 ? number(value) : label]);
  }
  return all;
};

const ticksOf = (axis, from, to, most) => {
  if (axis.scale === "names") return axis.labels.filter(([place]) => place >= from && place <= to);
  if (axis.scale === "cbrt") return even(from, to, Math.min(5, most)).map(([place]) => [place, nominal(place ** 3)]);
  if (axis.scale === "lin") return even(from, to, most);
  if (to - from < 1) {
    const apart = [];
    for (const [value, label] of even(10 ** from, 10 ** to, most)) {
      const place = Math.log10(value), last = apart[apart.length - 1];
      if (isFinite(place) && !(last && place - last[0] <= (0.6 * (to - from)) / Math.max(1, most))) apart.push([place, label]);
    }
    return apart;
  }
  const factors = 3 * (to - from) <= most ? [1, 2, 5] : [1];
  const stride = Math.max(1, Math.ceil((to - from) / Math.max(2, most)));
  const all = [];
  for (let decade = Math.floor(from); decade <= to; decade += 1) {
    if (((decade % stride) + stride) % stride) continue;
    for (const factor of factors) {
      const place = Math.log10(factor) + decade;
      if (place >= from && place <= to) all.push([place, nominal(factor * 10 ** decade)]);
    }
  }
  return all;
};
