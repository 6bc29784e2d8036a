"""The flow for Node-RED, in Node-RED, as `hil run --mqtt` feeds it."""

import argparse
import json
import os
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path

from harness import broker, browser, found, free_port, hil, until
from selenium.webdriver.common.by import By

FLOW = Path(__file__).parent.parent / "dashboard" / "node-red.json"
# The last ones that run on Node 18 and 20.
PACKAGES = ["node-red@4", "@flowfuse/node-red-dashboard@1"]


@contextmanager
def node_red(installed, broker_port):
    """Node-RED with the flow, whose broker is at another port, and where the dashboard is."""
    if not (installed / "node_modules" / "node-red").is_dir():
        print("installing Node-RED and its dashboard")
        installed.mkdir(parents=True, exist_ok=True)
        subprocess.run([found(["npm"]), "install", "--no-audit", "--no-fund", "--silent", *PACKAGES], cwd=installed, check=True)
    flow = json.loads(FLOW.read_text())
    for node in flow:
        if node["type"] == "mqtt-broker":
            node.update(broker="127.0.0.1", port=str(broker_port))
    port = free_port()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "flows.json").write_text(json.dumps(flow))
        (folder / "node_modules").symlink_to(installed.resolve() / "node_modules")
        (folder / "package.json").write_text(json.dumps({"dependencies": {"@flowfuse/node-red-dashboard": "1"}}))
        (folder / "settings.js").write_text(
            f'module.exports = {{ uiHost: "127.0.0.1", uiPort: {port}, flowFile: "flows.json", telemetry: {{ enabled: false }} }};'
        )
        log = open(folder / "log", "w+")
        process = subprocess.Popen(
            [found(["node"]), installed.resolve() / "node_modules/node-red/red.js", "--userDir", folder],
            stdout=log,
            stderr=log,
            env={**os.environ, "HOME": str(folder)},
        )
        try:
            said = lambda: (folder / "log").read_text()
            until(lambda: "Connected to broker" in said() or process.poll() is not None, "Node-RED is connected to the broker")
            assert process.poll() is None, said()
            assert "missing" not in said().lower() and "[error]" not in said(), said()
            yield f"http://127.0.0.1:{port}/dashboard/rig"
        finally:
            process.kill()
            process.wait()
            log.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hil", required=True)
    parser.add_argument("--out", required=True, type=Path)
    arguments = parser.parse_args()
    test = ["--effect", "drift:stiffness=-0.5,cycles=500", "--blocks", "0.1:10:400", "--speed", "20"]
    with broker() as port, node_red(arguments.out / "node-red", port) as dashboard, browser(1400, 1000) as driver:
        driver.get(dashboard)
        until(lambda: driver.find_elements(By.TAG_NAME, "canvas"), "the dashboard has its charts")
        with hil(arguments.hil, "--mqtt", f"mqtt://127.0.0.1:{port}/rig-1", *test) as (process, _, _):
            assert process.wait(timeout=60) == 0, process.stderr.read()
        shown = lambda: driver.find_element(By.TAG_NAME, "body").text
        for text in ["finished", "hil run on host"]:
            until(lambda: text in shown(), f"the dashboard shows {text}")
        rows = until(lambda: driver.find_elements(By.CSS_SELECTOR, "table tbody tr"), "the table has events")
        canvases = driver.find_elements(By.TAG_NAME, "canvas")
        print(f"the dashboard shows the end of the test, {len(rows)} events and {len(canvases)} charts")
        driver.save_screenshot(str(arguments.out.resolve() / "dashboard.png"))


if __name__ == "__main__":
    main()
