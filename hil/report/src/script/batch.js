// Sorting and filtering of the traces. Of thousands the first few hundred that fit are laid out until all are asked for.
(() => {
  "use strict";
  const table = document.querySelector("table.traces");
  if (!table) return;
  const MOST = 300;
  const heads = [...table.tHead.rows[0].cells];
  // Where a column is: there is none of groups where there are no groups.
  const column = name => heads.findIndex(head => head.textContent === name);
  const [GROUP, VERDICT, NUMBERS] = ["group", "verdict", "before"].map(column);
  const body = table.tBodies[0];
  const number = text => {
    const found = parseFloat(text.replace(/−/g, "-"));
    return isNaN(found) ? Infinity : found;
  };
  const rows = [...body.rows].map((row, first) => {
    const texts = [...row.cells].map(cell => cell.textContent);
    const keys = texts.map((text, column) => (column < NUMBERS ? text : number(text)));
    return { row, first, texts, keys, searched: texts.slice(0, NUMBERS).join(" ").toLowerCase() };
  });
  const controls = document.querySelector(".filters");
  const shown = controls.querySelector(".shown");
  const all = controls.querySelector("button");
  let most = MOST;

  const chosen = name => { const one = controls.querySelector(`[data-filter=${name}]`); return one ? one.value : ""; };
  const show = () => {
    const [text, group, verdict] = [chosen("text").toLowerCase().trim(), chosen("group"), chosen("verdict")];
    const fits = rows.filter(({ texts, searched }) => searched.includes(text)
      && (!group || texts[GROUP] === group) && (!verdict || texts[VERDICT].startsWith(verdict)));
    const drawn = fits.slice(0, most);
    body.replaceChildren(...drawn.map(one => one.row));
    shown.textContent = drawn.length < fits.length ? `the first ${drawn.length} of ${fits.length} that fit, of ${rows.length}`
      : `${fits.length} of ${rows.length} shown`;
    all.hidden = drawn.length === fits.length;
  };

  const collator = new Intl.Collator(undefined, { numeric: true });
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const sign = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      heads.forEach(one => one.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", sign < 0 ? "descending" : "ascending");
      const order = (a, b) => (column < NUMBERS ? collator.compare(a, b) : a < b ? -1 : +(a > b));
      rows.sort((a, b) => sign * order(a.keys[column], b.keys[column]) || a.first - b.first);
      show();
    });
  });
  all.addEventListener("click", () => { most = Infinity; show(); });
  controls.hidden = false;
  controls.addEventListener("input", show);
  show();
})();
