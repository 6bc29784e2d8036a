// The names beside the curves show and hide them, in all pictures of their section.
for (const entry of document.querySelectorAll("ul.key li[data-curve]")) {
  const button = document.createElement("button");
  button.type = "button";
  button.setAttribute("aria-pressed", "true");
  button.title = "show or hide";
  button.append(...entry.childNodes);
  entry.append(button);
  button.addEventListener("click", () => {
    const hidden = button.getAttribute("aria-pressed") === "true";
    const of = entry.closest("section");
    const named = selector => [...of.querySelectorAll(selector)].filter(one => one.dataset.curve === entry.dataset.curve);
    for (const one of named("li[data-curve]")) one.firstElementChild.setAttribute("aria-pressed", String(!hidden));
    for (const one of named("g[data-curve]")) one.style.display = hidden ? "none" : "";
  });
}
