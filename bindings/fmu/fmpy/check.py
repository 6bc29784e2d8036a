#!/usr/bin/env python3
"""Exports FMUs, and holds them against `hil predict` and `hil respond` in FMPy.

    python3 bindings/fmu/fmpy/check.py [--figure docs/fmu.svg]

It builds `hil`, and installs FMPy and matplotlib into target/fmpy. It exits with 1 where something does not hold.
"""

import argparse
import os
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
PACKAGES = ["FMPy==0.3.32", "matplotlib==3.11.2", "numpy==2.4.6"]


def in_own_environment():
    """Goes on in an environment that has the packages, and is made where there is none."""
    home = TARGET / "fmpy"
    python = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if Path(sys.prefix).resolve() == home.resolve():
        return
    stamp = home / "packages"
    if not stamp.is_file() or stamp.read_text().split() != PACKAGES:
        print(f"installing {', '.join(PACKAGES)} into {home}: they import the FMU and draw the figure", flush=True)
        venv.create(home, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
        stamp.write_text("\n".join(PACKAGES))
    sys.exit(subprocess.run([python, *sys.argv]).returncode)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--figure", type=Path, help="where the figure of the page goes, as SVG")
    arguments = parser.parse_args()
    in_own_environment()
    subprocess.run(
        ["cargo", "build", "--release", "--quiet", "--package", "mesh-damper-hil", "--features", "full", "--bin", "hil"], cwd=ROOT, check=True
    )

    # Nothing is left in the tree.
    sys.dont_write_bytecode = True
    import damper
    import rotor

    damper.HIL = TARGET / "release" / ("hil.exe" if os.name == "nt" else "hil")
    failures = damper.check(ROOT) + rotor.check(ROOT, arguments.figure)
    for failure in failures:
        print(f"FAILED: {failure}", file=sys.stderr)
    print("all holds" if not failures else f"{len(failures)} failed")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
