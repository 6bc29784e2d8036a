"""Fixtures of the tests: recordings of the simulated rig, their trace, and the command to compare with."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

import matplotlib
import mesh_damper
import numpy as np
import pytest

matplotlib.use("Agg")

Columns = dict[str, np.ndarray]


def columns_of(recording: Any) -> Columns:
    """The columns of a frame as arrays."""
    return {name: np.asarray(recording[name], dtype=float) for name in recording.columns}


@pytest.fixture(scope="session")
def columns() -> Columns:
    """A test of the specimen of seed 4, which hides stick-slip."""
    return columns_of(mesh_damper.simulate(4).recording)


@pytest.fixture(scope="session")
def check() -> Columns:
    """Another test of the same specimen."""
    return columns_of(mesh_damper.simulate(4, "check").recording)


@pytest.fixture(scope="session")
def found(columns: Columns) -> mesh_damper.Trace:
    """The trace of the first test."""
    return mesh_damper.trace(columns)


@pytest.fixture(scope="session")
def file(columns: Columns, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first test as a file, exact to the last bit."""
    path = tmp_path_factory.mktemp("recordings") / "rig-test.csv"
    write_csv(path, columns)
    return path


def write_csv(path: Path, columns: Columns) -> None:
    rows = zip(*(values.tolist() for values in columns.values()))
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n")


def sine_block(amplitude: float = 0.1, frequency: float = 2.0, seconds: float = 4.0, rate: float = 500.0) -> Columns:
    """A spring of 8 kN/mm with friction and a little noise: quick to trace."""
    time = np.arange(0.0, seconds, 1.0 / rate)
    displacement = amplitude * np.sin(2 * np.pi * frequency * time)
    velocity = amplitude * 2 * np.pi * frequency * np.cos(2 * np.pi * frequency * time)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(time.size)
    force = 8.0 * displacement + 0.05 * np.sign(velocity) * np.abs(velocity) ** 0.4 + noise
    return {"time_s": time, "displacement_mm": displacement, "force_kN": force}


@pytest.fixture(scope="session")
def hil() -> Any:
    """Runs the command `hil`, with the path from MESH_DAMPER_HIL."""
    program = os.environ.get("MESH_DAMPER_HIL")
    if program is None:
        if os.environ.get("CI"):
            pytest.fail("MESH_DAMPER_HIL names no command to hold the package against")
        pytest.skip("left out: MESH_DAMPER_HIL does not name the command hil; .ci/python sets it")

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
        if "unrecognized subcommand" in done.stderr:
            if os.environ.get("CI"):
                pytest.fail(f"{program} is built without {arguments[0]}")
            pytest.skip(f"left out: {program} is built without {arguments[0]}")
        return done

    return run
