// The colours of the charts are those of the style sheet, which knows whether it is dark.

const NAMES = ["measured", "law", "grid", "text", "surface"];

export function colours() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Calls `changed` when the system's scheme does. */
export function whenSchemeChanges(changed) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
}
