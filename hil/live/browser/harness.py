"""A browser, a run of `hil` and a broker for the checks in this folder."""

import os
import re
import socket
import subprocess
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

PATIENCE = 60.0


def found(names):
    for name in names:
        for folder in os.environ.get("PATH", "").split(":") + ["/usr/sbin"]:
            if os.access(Path(folder) / name, os.X_OK):
                return str(Path(folder) / name)
    raise SystemExit(f"there is no {names[0]}")


@contextmanager
def browser(width, height, dark=False, downloads=None):
    options = webdriver.ChromeOptions()
    options.binary_location = found(["chromium", "chromium-browser", "google-chrome"])
    options.add_argument("--headless=new")
    options.add_argument("--no-sandbox")
    options.add_argument("--disable-gpu")
    options.add_argument(f"--window-size={width},{height}")
    if dark:
        options.add_argument("--blink-settings=preferredColorScheme=0")
    if downloads:
        options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(found(["chromedriver"])))
    try:
        # Narrower than a window can be: a phone's width is that of the page.
        driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
        )
        yield driver
        complaints = [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]
        assert not complaints, complaints
    finally:
        driver.quit()


def until(holds, what):
    """Waits until `holds()` is true, and gives what it gave."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        value = holds()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"it never came about that {what}")


def free_port():
    with socket.socket() as sock:
        sock.bind(("127.0.0.1", 0))
        return sock.getsockname()[1]


@contextmanager
def hil(path, *arguments):
    """`hil run --live` under way, and where its page is."""
    with tempfile.TemporaryDirectory() as folder:
        process = subprocess.Popen(
            [os.path.abspath(path), "run", "--live", *arguments], cwd=folder, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        try:
            address = None
            while address is None:
                line = process.stderr.readline()
                assert line, f"hil ended: {process.wait()}"
                said = re.search(r"The live page is (\S+)", line)
                address = said and said.group(1)
            yield process, address, Path(folder)
        finally:
            if process.poll() is None:
                process.kill()
            process.wait()


@contextmanager
def broker():
    port = free_port()
    with tempfile.TemporaryDirectory() as folder:
        configuration = Path(folder) / "mosquitto.conf"
        configuration.write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\nuser root\n")
        process = subprocess.Popen([found(["mosquitto"]), "-c", configuration], stderr=subprocess.DEVNULL)
        try:
            yield port
        finally:
            process.kill()
            process.wait()
