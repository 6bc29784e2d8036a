// Actions of a reader on the pages, in a browser: `node check.mjs FOLDER`. The script writes a picture of each page to the folder.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { chromium } from "playwright-core";

const folder = resolve(process.argv[2]);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox"] });
const pages = readdirSync(folder, { recursive: true }).filter(name => name.endsWith(".html")).map(name => join(folder, name)).sort();
assert.ok(pages.length >= 3, `pages: ${pages}`);

const open = async (file, options = {}) => {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, ...options });
  const page = await context.newPage();
  const wrong = [];
  page.on("pageerror", error => wrong.push(error.message));
  page.on("console", message => message.type() === "error" && wrong.push(message.text()));
  page.on("request", request => request.url().startsWith("file:") || request.url().startsWith("data:") || wrong.push(request.url()));
  await page.goto(`file://${file}`);
  return { page, close: async () => { assert.deepEqual(wrong, [], file); await context.close(); } };
};

// Both themes, narrow and wide: nothing is cut off, and axe reports no problem.
const looks = async file => {
  for (const colorScheme of ["light", "dark"]) for (const width of [1400, 390]) {
    const { page, close } = await open(file, { viewport: { width, height: 900 }, colorScheme });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${file} is ${wide} px wide in ${width}`);
    await page.evaluate(axe);
    const found = await page.evaluate(() => window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21aa", "wcag22aa", "best-practice"] }));
    const said = found.violations.map(one => `${one.id}: ${one.help}: ${one.nodes.slice(0, 3).map(node => node.html.slice(0, 160)).join(" | ")}`);
    assert.deepEqual(said, [], `${file}, ${colorScheme}, ${width} px`);
    assert.ok(found.passes.length > 15, "axe looked at little");
    await page.screenshot({ path: file.replace(".html", `-${colorScheme}-${width}.png`), fullPage: true });
    await close();
  }
};

// Complete without a script, and light on paper with either theme.
const bare = async file => {
  const without = await open(file, { javaScriptEnabled: false });
  assert.equal(await without.page.locator("main button:visible, .filters:visible").count(), 0);
  assert.ok(await without.page.locator("figure svg.picture title").count() > 0);
  await without.close();
  const { page, close } = await open(file, { colorScheme: "dark" });
  const ground = () => page.evaluate(() => [getComputedStyle(document.body).backgroundColor,
    getComputedStyle(document.querySelector("figure svg.picture > rect")).fill]);
  assert.deepEqual(await ground(), ["rgb(21, 24, 28)", "rgb(21, 24, 28)"]);
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  assert.deepEqual(await ground(), ["rgb(255, 255, 255)", "rgb(255, 255, 255)"]);
  await close();
};

// Labels of ticks, in order.
const ticks = svg => svg.locator(".ticks text").allTextContents();

// A loop: the value under the pointer is that of the sample, a box zooms to its contents, and Escape restores the whole view.
const zooms = async file => {
  const { page, close } = await open(file);
  const figure = page.locator("section:has(> h2:text-is('Force–displacement loops')) figure").first();
  const svg = figure.locator("svg.picture");
  await svg.scrollIntoViewIfNeeded();
  // A sample of the measured curve: its position on the screen, and its values from the attributes alone.
  const sample = await svg.evaluate(svg => {
    const panel = svg.querySelector("g.panel"), inner = panel.querySelector("svg.curves");
    const path = inner.querySelector("[data-curve=measured] path");
    const at = path.getPointAtLength(0.13 * path.getTotalLength());
    const box = inner.viewBox.baseVal, [, , width, height] = panel.dataset.at.split(" ").map(Number);
    const ends = name => panel.dataset[name].split("|").slice(3).map(Number);
    const [x0, x1] = ends("x"), [y0, y1] = ends("y");
    const matrix = path.getScreenCTM(), screen = new DOMPoint(at.x, at.y).matrixTransform(matrix);
    return { screen: [screen.x, screen.y], x: x0 + (at.x / box.width) * (x1 - x0), y: y1 - (at.y / box.height) * (y1 - y0),
      step: [(x1 - x0) / width, (y1 - y0) / height], width: svg.getBoundingClientRect().width };
  });
  await page.mouse.move(...sample.screen);
  const readout = figure.locator(".readout");
  assert.ok(await readout.isVisible());
  const said = await readout.locator("div").allTextContents();
  const number = text => Number(text.replace("−", "-").match(/-?[\d.]+/)[0]);
  const near = (text, value, step) => assert.ok(Math.abs(number(text) - value) < 3 * step, `${text} beside ${value}`);
  assert.match(said[0], /^displacement .* mm$/);
  near(said[0], sample.x, sample.step[0]);
  assert.match(said[1], /^measured: .* kN$/);
  near(said[1], sample.y, sample.step[1]);
  assert.equal(said.length, 4, said.join("; "));
  await page.screenshot({ path: file.replace(".html", "-values.png") });

  const whole = await ticks(svg);
  const box = await svg.boundingBox();
  const at = (x, y) => [box.x + x * box.width, box.y + y * box.height];
  const drag = async (from, to) => {
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 4 });
    await page.mouse.up();
  };
  const seen = () => svg.locator("svg.curves").evaluate(inner => [inner.viewBox.baseVal.width, inner.viewBox.baseVal.height]);
  const all = await seen();
  await drag(at(0.4, 0.3), at(0.65, 0.55));
  const zoomed = await seen();
  assert.ok(zoomed[0] < 0.5 * all[0] && zoomed[1] < 0.5 * all[1], `${zoomed} of ${all}`);
  const fine = await ticks(svg);
  assert.ok(fine.length >= 4 && fine.join() !== whole.join(), fine.join());
  await page.mouse.move(...at(0.5, 0.45));
  await page.screenshot({ path: file.replace(".html", "-zoomed.png") });
  // Panning keeps the size.
  const place = () => svg.locator("svg.curves").evaluate(inner => inner.viewBox.baseVal.x);
  const before = await place();
  await page.keyboard.down("Shift");
  await drag(at(0.6, 0.5), at(0.5, 0.5));
  await page.keyboard.up("Shift");
  assert.ok(await place() > before);
  assert.ok(Math.abs((await seen())[0] - zoomed[0]) < 1);
  assert.ok(await figure.locator(".reset").isVisible());
  await svg.focus();
  await page.keyboard.press("Escape");
  assert.deepEqual(await ticks(svg), whole);
  assert.deepEqual(await seen(), all);
  assert.ok(!(await figure.locator(".reset").isVisible()));
  await page.mouse.move(...at(0.5, 0.5));
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -100);
  await page.keyboard.up("Control");
  await page.waitForFunction(([svg, width]) => svg.querySelector("svg.curves").viewBox.baseVal.width < width, [await svg.elementHandle(), all[0]]);
  await page.mouse.dblclick(...at(0.5, 0.5));
  assert.deepEqual(await seen(), all);

  // With keys alone.
  await page.mouse.move(0, 0);
  await svg.focus();
  await page.keyboard.press("ArrowRight");
  const first = await readout.allTextContents();
  assert.equal(await readout.getAttribute("role"), "status");
  await page.keyboard.press("ArrowRight");
  assert.notDeepEqual(await readout.allTextContents(), first);
  await page.keyboard.press("ArrowDown");
  assert.match((await readout.allTextContents())[0], /before/);
  await page.keyboard.press("+");
  assert.ok((await seen())[0] < all[0]);
  await page.keyboard.press("Escape");

  // The key hides a curve in all pictures of its section and in no other.
  const section = page.locator("section:has(> h2:text-is('Force–displacement loops'))");
  const hidden = within => within.locator("g[data-curve=before]").evaluateAll(all => all.filter(one => one.style.display === "none").length);
  await section.locator("li[data-curve=before] button").click();
  assert.equal(await hidden(section), await section.locator("figure").count());
  assert.equal(await hidden(page.locator("body")), await section.locator("figure").count());
  assert.equal(await section.locator("li[data-curve=before] button").getAttribute("aria-pressed"), "false");
  await section.locator("li[data-curve=before] button").click();
  assert.equal(await hidden(section), 0);

  // A map shows the value of its cell, and every picture shows a value at its curves.
  for (const one of await page.locator("figure").all()) {
    const picture = one.locator("svg.picture");
    await picture.scrollIntoViewIfNeeded();
    const place = await picture.evaluate(svg => {
      const shape = svg.querySelector("svg.curves g[data-curve] > *").getBoundingClientRect();
      const frame = svg.querySelector("svg.curves").getBoundingClientRect();
      return [Math.min(Math.max(shape.x + shape.width / 2, frame.x + 1), frame.right - 1), Math.min(Math.max(shape.y + shape.height / 2, frame.y + 1), frame.bottom - 1)];
    });
    await page.mouse.move(...place);
    const text = await one.locator(".readout").innerText();
    assert.match(text, /\d/, await picture.getAttribute("aria-label"));
    assert.doesNotMatch(text, /NaN|undefined/, text);
  }
  await close();
};

// A batch: sorted by a column, filtered, and a point of the picture shows its recording.
const sorts = async file => {
  const { page, close } = await open(file);
  const column = async index => (await page.locator(`table.traces tbody tr:visible td:nth-child(${index + 1})`).allTextContents())
    .map(text => parseFloat(text.replace("−", "-")));
  const rises = values => values.every((value, i) => i === 0 || value >= values[i - 1]);
  const head = page.locator("table.traces thead th").nth(5);
  await head.locator("button").click();
  assert.equal(await head.getAttribute("aria-sort"), "ascending");
  assert.ok(rises(await column(5)));
  await head.locator("button").click();
  assert.ok(rises((await column(5)).reverse()));
  await page.locator("[data-filter=verdict]").selectOption("unlisted");
  const shown = await page.locator("table.traces tbody tr:visible").count();
  assert.equal(await page.locator(".shown").textContent(), `${shown} of 160 shown`);
  assert.equal(shown, 24);
  await page.locator("[data-filter=text]").fill("test-0025");
  assert.equal(await page.locator("table.traces tbody tr:visible").count(), 1);
  assert.ok(await page.locator(".filters button").isHidden());
  const figure = page.locator("figure").first();
  const svg = figure.locator("svg.picture");
  await svg.focus();
  await page.keyboard.press("ArrowRight");
  assert.match(await figure.locator(".readout").innerText(), /^day-0\/test-0000.csv/);
  await close();
};

for (const file of pages) {
  await looks(file);
  await bare(file);
  const text = readFileSync(file, "utf8");
  if (text.includes("class=\"traces\"")) await sorts(file);
  if (text.includes(">Force–displacement loops</h2>")) await zooms(file);
  console.log(`${file}: as it should be`);
}
await browser.close();
