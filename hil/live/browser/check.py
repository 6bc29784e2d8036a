"""The live page in a browser, as `hil run --live` feeds it. With --small, only whether it and a report are drawn."""

import argparse
import csv
import math
import tempfile
from pathlib import Path

from harness import browser, hil, until
from selenium.webdriver import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

AMPLITUDE = 0.1  # mm
FREQUENCY = 5  # Hz
BLOCKS = f"{AMPLITUDE}:{FREQUENCY}:200"
# The rig holds the amplitude within a part in a hundred, beside noise of the channel: docs/rig.md.
TOLERANCE = 0.005  # mm


def count(driver):
    return driver.execute_script("return live.store.samples.length")


def time_of(driver):
    return driver.execute_script("return live.store.lastTime")


def amplitude(driver, start, end):
    """Half of the range of the displacement that the page has from `start` to `end`."""
    return driver.execute_script(
        """
        const { samples } = live.store;
        const [from, to] = samples.range([arguments[0], arguments[1]]);
        const values = samples.column("displacement_mm").subarray(from, to);
        return (Math.max(...values) - Math.min(...values)) / 2;
        """,
        start,
        end,
    )


def colours_drawn(driver, figure):
    """How many pixels of a chart have the colours of its two lines, about."""
    return driver.execute_script(
        """
        const canvas = document.querySelector(`#figure-${arguments[0]} canvas`);
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        const wanted = ["--measured", "--law"].map((name) => {
          const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
          return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
        });
        return wanted.map((colour) => {
          let pixels = 0;
          for (let at = 0; at < data.length; at += 4) {
            if (data[at + 3] > 200 && colour.every((part, place) => Math.abs(part - data[at + place]) < 40)) pixels++;
          }
          return pixels;
        });
        """,
        figure,
    )


def click(driver, name):
    driver.find_element(By.ID, name).click()


def drag(driver, figure, start, end):
    over = driver.find_element(By.CSS_SELECTOR, f"#figure-{figure} .u-over")
    width, height = over.size["width"], over.size["height"]
    at = lambda part: (round((part[0] - 0.5) * width), round((part[1] - 0.5) * height))
    chain = ActionChains(driver).move_to_element_with_offset(over, *at(start)).click_and_hold()
    chain.move_to_element_with_offset(over, *at(end)).release().perform()


def check_the_sine(driver):
    until(lambda: time_of(driver) > 6, "six seconds have come")
    found = amplitude(driver, 4, 6)
    assert abs(found - AMPLITUDE) < TOLERANCE, found
    cycles = driver.execute_script(
        """
        const { cycles } = live.store;
        return cycles.names.reduce((all, name) => ({ ...all, [name]: [...cycles.column(name)] }), {});
        """
    )
    steady = [row for row, ramp in enumerate(cycles["ramp"]) if not ramp]
    assert len(steady) > 5, cycles
    for row in steady:
        assert abs(cycles["frequency_Hz"][row] - FREQUENCY) < 1e-3
        assert abs(cycles["amplitude_mm"][row] - AMPLITUDE) < TOLERANCE
        assert 0.1 < cycles["stiffness_kN_per_mm"][row] < 10
        assert 0 < cycles["law_error"][row] < 1
    for figure in ["loop", "force", "stiffness", "loss-factor"]:
        measured, law = colours_drawn(driver, figure)
        assert measured > 50 and law > 20, (figure, measured, law)
    # What the y axis of the chart shows is the sine.
    low, high = driver.execute_script(
        "const { min, max } = live.charts.plots.displacement.scales.y; return [min, max];"
    )
    assert low <= -AMPLITUDE + TOLERANCE and high >= AMPLITUDE - TOLERANCE
    assert high - low < 4 * AMPLITUDE, (low, high)
    ranges = driver.execute_script("const { x, y } = live.charts.plots.loop.scales; return [x.min, x.max, y.min, y.max];")
    assert -2 * AMPLITUDE < ranges[0] < -0.9 * AMPLITUDE and 0.9 * AMPLITUDE < ranges[1] < 2 * AMPLITUDE, ranges
    print(f"the sine has {found:.4f} mm, {len(steady)} steady cycles were drawn")


def check_pause(driver):
    click(driver, "pause")
    shown = "return live.charts.plots.displacement.scales.x.max"
    until(lambda: driver.find_element(By.ID, "paused").is_displayed(), "the display is paused")
    before, had = driver.execute_script(shown), count(driver)
    until(lambda: count(driver) > had + 500, "data come though the display is paused")
    assert driver.execute_script(shown) == before
    assert driver.find_element(By.ID, "pause").get_attribute("aria-pressed") == "true"
    # By the keyboard it goes on.
    driver.find_element(By.TAG_NAME, "body").click()
    ActionChains(driver).send_keys(" ").perform()
    until(lambda: driver.execute_script(shown) > before + 0.3, "the display has caught up")
    print("pause keeps the data and freezes the display")


def check_zoom(driver):
    start, end = driver.execute_script("return live.charts.ranges.time")
    drag(driver, "force", (0.25, 0.5), (0.5, 0.5))
    zoom = until(lambda: driver.execute_script("return live.view.zoom"), "a drag zooms")
    assert start - 5 < zoom[0] < zoom[1] < end + 5
    assert abs((zoom[1] - zoom[0]) / (end - start) - 0.25) < 0.05, (zoom, start, end)
    until(
        lambda: driver.execute_script("return live.charts.plots.displacement.scales.x.min") == zoom[0],
        "the other chart of time has the same range",
    )
    over = driver.find_element(By.CSS_SELECTOR, "#figure-force .u-over")
    ActionChains(driver).double_click(over).perform()
    until(lambda: driver.execute_script("return live.view.zoom === null"), "a double click resets")
    drag(driver, "loop", (0.3, 0.3), (0.7, 0.7))
    loop = until(lambda: driver.execute_script("return live.view.loopZoom"), "a drag zooms into the loop")
    assert loop["x"][0] < loop["x"][1] and loop["y"][0] < loop["y"][1], loop
    click(driver, "reset")
    drag(driver, "stiffness", (0.3, 0.5), (0.6, 0.5))
    until(lambda: driver.execute_script("return live.view.cycleZoom"), "a drag zooms into the cycles")
    ActionChains(driver).send_keys("0").perform()
    click(driver, "zoom-in")
    until(lambda: driver.execute_script("return live.view.zoom"), "a button zooms")
    print("zoom by drag, button and key, and its reset")


def check_export(driver, downloads, zoom):
    for button in ["export-signals", "export-cycles", "export-picture"]:
        click(driver, button)
    def files():
        names = [path for path in downloads.iterdir() if path.suffix in (".csv", ".png")]
        return names if len(names) == 3 else None
    names = {path.name: path for path in until(files, "three files are saved")}
    signals = next(path for name, path in names.items() if name.startswith("live-signals"))
    rows = list(csv.DictReader(line for line in signals.read_text().splitlines() if not line.startswith("#")))
    times = [float(row["time_s"]) for row in rows]
    # What is shown, from end to end.
    assert zoom[0] <= times[0] and times[-1] <= zoom[1], (zoom, times[0], times[-1])
    assert times[0] - zoom[0] < 0.01 and zoom[1] - times[-1] < 0.01, (zoom, times[0], times[-1])
    assert all(a < b for a, b in zip(times, times[1:]))
    largest = max(abs(float(row["displacement_mm"])) for row in rows)
    assert abs(largest - AMPLITUDE) < TOLERANCE, largest
    cycles = list(csv.DictReader(line for line in names["live-cycles.csv"].read_text().splitlines() if not line.startswith("#")))
    assert len(cycles) > 5 and float(cycles[-1]["stiffness_kN_per_mm"]) > 0
    picture = next(path for name, path in names.items() if name.endswith(".png"))
    assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 20_000
    print(f"exported: {len(rows)} rows of signals, {len(cycles)} cycles, a picture of {picture.stat().st_size} bytes")
    return picture


def check_keeping_up(driver, process, folder):
    """At 10 kHz in real time everything comes, and memory stays what it is."""
    heap = lambda: driver.execute_script("return performance.memory.usedJSHeapSize")
    began, first, drawn = time_of(driver), heap(), driver.execute_script("return live.drawings")
    until(lambda: time_of(driver) > began + 5, "five more seconds have come")
    passed = time_of(driver) - began
    drawings = driver.execute_script("return live.drawings") - drawn
    code = process.wait(timeout=60)
    assert code == 0, (code, process.stderr.read())
    until(lambda: driver.find_element(By.ID, "state").text == "Finished", "the page says that the test has finished")
    had, missed = driver.execute_script("return [live.store.samples.length, live.store.missed]")
    end = time_of(driver)
    assert missed == 0
    # The last tick of the test is there, of 20 ticks two at least, and nothing in between is missing.
    gap = driver.execute_script(
        """
        const times = live.store.samples.column("time_s");
        let gap = 0;
        for (let row = 1; row < times.length; row++) gap = Math.max(gap, times[row] - times[row - 1]);
        return gap;
        """
    )
    assert gap <= 40e-4 + 1e-9, gap
    assert had >= 2 * math.floor(end * 500) - 2, (had, end)
    assert heap() < first + 60e6, (first, heap())
    # What is there stays, without the server.
    found = amplitude(driver, end - 10, end - 8)
    assert abs(found - AMPLITUDE) < TOLERANCE, found
    assert (folder / "run-out" / "recording.csv.gz").stat().st_size > 0
    print(
        f"{had} of {round(end * 10_000)} samples kept to {end:.1f} s, none dropped, longest gap {1e3 * gap:.1f} ms, "
        f"{drawings / passed:.0f} drawings a second, {heap() / 1e6:.0f} MB of heap"
    )


def check_access(driver):
    """Every control has a name and is reached by the keyboard; nothing is wider than the page."""
    driver.execute_script("document.activeElement.blur(); window.scrollTo(0, 0)")
    names = driver.execute_script(
        """
        return [...document.querySelectorAll("button, select, [role=img]")].map((element) =>
          element.getAttribute("aria-label") || element.textContent.trim());
        """
    )
    assert len(names) > 15 and all(names), names
    assert driver.execute_script("return document.documentElement.scrollWidth <= innerWidth")


def pictures(arguments, out):
    """Light and dark, narrow and wide, of a test with faults."""
    sizes = {"wide": (1400, 1000), "narrow": (390, 2100)}
    # A specimen that softens: the monitor names that.
    test = ["--speed", "20", "--live-wait", "60", "--effect", "drift:stiffness=-0.5,cycles=500", "--blocks", "0.1:10:400"]
    for size, (width, height) in sizes.items():
        for dark in (False, True):
            with hil(arguments.hil, *test) as (process, address, _), browser(width, height, dark) as driver:
                driver.get(address)
                until(lambda: driver.find_element(By.ID, "state").text == "Finished", "the test has finished")
                assert process.wait(timeout=60) == 0
                check_access(driver)
                assert driver.find_elements(By.CSS_SELECTOR, "#events li.fault"), "a fault is shown"
                until(lambda: driver.execute_script("return performance.now()") > 2500, "the labels are up to date")
                driver.save_screenshot(str(out / f"live-{size}-{'dark' if dark else 'light'}.png"))
    print(f"pictures are in {out}")


def check_a_report(driver, report):
    """Every picture of a report has its curves, and the script shows the values of one. What the script complains of, `browser` says."""
    driver.get(report.resolve().as_uri())
    sizes = driver.execute_script(
        """
        return [...document.querySelectorAll("figure svg.picture")].map((svg) =>
          Math.max(0, ...[...svg.querySelectorAll("svg.curves g[data-curve]")].map((curve) => {
            const { width, height } = curve.getBoundingClientRect();
            return Math.max(width, height);
          })));
        """
    )
    assert sizes and min(sizes) > 20, sizes
    picture = driver.execute_script(
        """
        const isOfLoops = (section) => section.querySelector(":scope > h2")?.textContent.trim() === "Force–displacement loops";
        return [...document.querySelectorAll("section")].find(isOfLoops).querySelector("figure svg.picture");
        """
    )
    driver.execute_script("arguments[0].focus()", picture)
    ActionChains(driver).send_keys(Keys.ARROW_RIGHT).perform()
    values = "return arguments[0].closest('figure').querySelector('.readout')?.textContent || ''"
    said = until(lambda: driver.execute_script(values, picture), "the values of a sample are shown")
    assert any(letter.isdigit() for letter in said) and "NaN" not in said and "undefined" not in said, said
    print(f"the report has {len(sizes)} pictures")


def small(arguments):
    """A report, and the live page of a short test: no script fails, and something is drawn."""
    test = ["--live-wait", "60", "--speed", "4", "--blocks", f"{AMPLITUDE}:{FREQUENCY}:40"]
    with browser(1400, 1000) as driver:
        check_a_report(driver, arguments.small)
    with hil(arguments.hil, *test) as (process, address, _), browser(1400, 1000) as driver:
        driver.get(address)
        until(lambda: driver.find_element(By.ID, "state").text == "Finished", "the test has finished")
        assert process.wait(timeout=60) == 0
        for figure in ["loop", "force", "stiffness", "loss-factor"]:
            until(lambda: min(colours_drawn(driver, figure)) > 20, f"{figure} is drawn")
        print(f"the live page has drawn {time_of(driver):.1f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hil", required=True)
    parser.add_argument("--out", type=Path, default=Path("target/live"))
    parser.add_argument("--small", metavar="REPORT", type=Path)
    arguments = parser.parse_args()
    if arguments.small:
        return small(arguments)
    out = arguments.out.resolve()
    with tempfile.TemporaryDirectory() as folder:
        downloads = Path(folder)
        with hil(arguments.hil, "--live-wait", "60", "--blocks", BLOCKS) as (process, address, run):
            with browser(1400, 1000, downloads=downloads) as driver:
                driver.get(address)
                check_the_sine(driver)
                check_access(driver)
                check_pause(driver)
                check_zoom(driver)
                zoom = driver.execute_script("return live.view.zoom")
                picture = check_export(driver, downloads, zoom)
                picture.replace(out / "live-export.png")
                click(driver, "reset")
                check_keeping_up(driver, process, run)
    pictures(arguments, out)


if __name__ == "__main__":
    main()
