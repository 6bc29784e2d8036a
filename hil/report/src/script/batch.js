// Sorting and filtering of the traces.
(() => {
  "use strict";
  const table = document.querySelector("table.traces");
  if (!table) return;
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const cells = rows.map(row => [...row.cells].map(cell => cell.textContent));
  const searched = cells.map(texts => texts.slice(0, 4).join(" ").toLowerCase());
  const first = new Map(rows.map((row, i) => [row, i]));

  const number = text => {
    const found = parseFloat(text.replace(/−/g, "-"));
    return isNaN(found) ? Infinity : found;
  };
  const NUMBERS = 4;
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const falls = head.getAttribute("aria-sort") === "ascending";
      heads.forEach(one => one.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", falls ? "descending" : "ascending");
      const of = row => cells[first.get(row)][column];
      const order = column >= NUMBERS ? (a, b) => number(of(a)) - number(of(b)) || 0
        : (a, b) => of(a).localeCompare(of(b), undefined, { numeric: true });
      const sorted = [...rows].sort((a, b) => (falls ? -order(a, b) : order(a, b)) || first.get(a) - first.get(b));
      body.replaceChildren(...sorted);
    });
  });

  const controls = document.querySelector(".filters");
  const of = name => { const one = controls.querySelector(`[data-filter=${name}]`); return one ? one.value : ""; };
  const filter = () => {
    const text = of("text").toLowerCase().trim();
    let shown = 0;
    rows.forEach((row, i) => {
      const [, group, verdict] = cells[i];
      const fits = searched[i].includes(text) && (!of("group") || group === of("group"))
        && (!of("verdict") || verdict.startsWith(of("verdict")));
      row.hidden = !fits;
      shown += fits;
    });
    controls.querySelector(".shown").textContent = `${shown} of ${rows.length} shown`;
  };
  controls.hidden = false;
  controls.addEventListener("input", filter);
  filter();
})();
