"""The table of a file with several, and the decimal sign of a text, in every function that reads files."""

from __future__ import annotations

import csv
import json
import warnings
from pathlib import Path
from typing import Any

import mesh_damper
import numpy as np
import pytest
from conftest import Columns, sine_block
from mesh_damper import _core
from test_models import SPRING

#: Two runs `run0` and `run1`, whose times are 1 s apart.
MAT = Path(__file__).parents[3] / "hil/tables/tests/formats/two_runs_unasked.mat"
#: The amplitude of each run of `runs`.
AMPLITUDES = {"first": 0.1, "second": 0.14}


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs in one file, each long enough for a trace."""
    path = tmp_path_factory.mktemp("runs") / "runs.json"
    tables = {run: sine_block(amplitude=amplitude) for run, amplitude in AMPLITUDES.items()}
    path.write_text(json.dumps({run: {name: values.tolist() for name, values in table.items()} for run, table in tables.items()}))
    return path


@pytest.fixture(scope="module")
def either(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Columns]:
    """A text in which each sign may be the decimal one or separate thousands, and its numbers with a decimal comma."""
    block = sine_block()
    # From 1 to 999, with three digits after the sign: each number may be a thousand times itself.
    block = {
        "time_s": 1.0 + block["time_s"],
        "displacement_mm": 500.0 + 100.0 * block["displacement_mm"],
        "force_kN": 5.0 + block["force_kN"],
    }
    cells = {name: [f"{value:.3f}" for value in values] for name, values in block.items()}
    path = tmp_path_factory.mktemp("either") / "either.csv"
    with path.open("w", newline="") as file:
        writer = csv.writer(file, delimiter=";")
        writer.writerow(cells)
        writer.writerows([cell.replace(".", ",") for cell in row] for row in zip(*cells.values()))
    return path, {name: np.array([float(cell) for cell in column]) for name, column in cells.items()}


def refusal(function: Any, *arguments: Any, **options: Any) -> str:
    with pytest.raises(mesh_damper.InputError) as raised:
        function(*arguments, **options)
    return str(raised.value)


def test_the_runs_of_a_mat_are_told_apart_by_table(tmp_path: Path, hil: Any) -> None:
    asked = '2 tables hold a recording: "run0", "run1"; give the name of one with --table'
    for function in (mesh_damper.trace, mesh_damper.characterize):
        assert refusal(function, MAT) == f"{MAT}: {asked}"
    assert f"error: {MAT}: {asked}\n" == hil("trace", MAT, "--out", tmp_path / "out").stderr
    with pytest.raises(mesh_damper.InputError, match='there is no table "run2"; give --table one of "run0", "run1"'):
        mesh_damper.characterize(MAT, table="run2")
    starts = {}
    for run in ("run0", "run1"):
        moved = mesh_damper.respond(SPRING, mass=100.0, force=MAT, table=run)
        starts[run] = np.asarray(moved.motion["time_s"])[0]
    assert starts == {"run0": 0.0, "run1": 1.0}


def test_a_run_is_traced_as_the_command_traces_it(runs: Path, tmp_path: Path, hil: Any) -> None:
    assert "give the name of one with --table" in refusal(mesh_damper.trace, runs)
    for run, amplitude in AMPLITUDES.items():
        done = hil("trace", runs, "--table", run, "--out", tmp_path / run)
        assert done.returncode == 0, done.stderr
        found = mesh_damper.trace(runs, table=run)
        assert found.to_json() == (tmp_path / run / "trace.json").read_text()
        block = sine_block(amplitude=amplitude)
        assert found.to_dict()["law"] == mesh_damper.trace(block).to_dict()["law"]
        np.testing.assert_array_equal(mesh_damper.characterize(runs, table=run).blocks, mesh_damper.characterize(block).blocks)


def test_a_run_of_a_batch_is_that_of_the_command(runs: Path, tmp_path: Path, hil: Any) -> None:
    (failed,) = mesh_damper.trace_many([runs], out=tmp_path / "asked").outcomes.error
    assert "give the name of one with --table" in failed
    assert mesh_damper.outcome(runs)["error"] == failed
    identities = set()
    for run in AMPLITUDES:
        batch = mesh_damper.trace_many([runs], out=tmp_path / run, table=run)
        row = mesh_damper.outcome(runs, table=run)
        done = hil("batch", runs.parent, "--table", run, "--out", tmp_path / f"command-{run}", "--json", "-")
        assert done.returncode == 0, done.stderr
        (expected,) = json.loads(done.stdout)["traces"]
        assert row["id"] == expected["id"] == batch.outcomes.id[0]
        assert row["outcome"] == "traced"
        identities.add(row["id"])
    assert len(identities) == 2, "the table is part of a trace's identity"


def test_an_ambiguous_decimal_sign_is_asked_for_and_given(either: tuple[Path, Columns], tmp_path: Path, hil: Any) -> None:
    path, block = either
    asked = "say which sign is the decimal one: --decimal point or --decimal comma"
    for function in (mesh_damper.trace, mesh_damper.characterize):
        assert asked in refusal(function, path)
    assert asked in refusal(mesh_damper.respond, SPRING, mass=100.0, base=path)
    assert asked in mesh_damper.outcome(path)["error"]
    done = hil("trace", path, "--decimal", "comma", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    with warnings.catch_warnings():
        # The separator of the text is a guess.
        warnings.simplefilter("ignore", mesh_damper.GuessWarning)
        found = mesh_damper.trace(path, decimal="comma")
        stiffness = mesh_damper.characterize(path, decimal="comma").blocks
        moved = mesh_damper.respond(SPRING, mass=100.0, force=path, decimal="comma").motion
    assert found.to_json() == (tmp_path / "out" / "trace.json").read_text()
    assert found.to_dict()["law"] == mesh_damper.trace(block).to_dict()["law"]
    np.testing.assert_array_equal(stiffness, mesh_damper.characterize(block).blocks)
    assert np.asarray(moved["time_s"])[0] == 1.0
    # With the other sign, each number is a thousand times as large.
    read = _core.Recording.read(path, _core.Reading(decimal="point"))
    assert dict(read.columns())["time_s"][0] == 1000.0
    row = mesh_damper.outcome(path, decimal="comma")
    batch = mesh_damper.trace_many([path], out=tmp_path / "batch", decimal="comma")
    assert row["outcome"] == "traced" and row["id"] == batch.outcomes.id[0]


@pytest.mark.parametrize("sign", [",", "Comma", "", 1])
def test_a_decimal_sign_is_point_or_comma(either: tuple[Path, Columns], tmp_path: Path, sign: Any) -> None:
    path, _ = either
    expected = f'decimal: no decimal sign is called {sign!r}; give "point" or "comma"'
    assert refusal(mesh_damper.trace, path, decimal=sign) == expected
    assert refusal(mesh_damper.characterize, path, decimal=sign) == expected
    assert refusal(mesh_damper.respond, SPRING, mass=1.0, force=path, decimal=sign) == expected
    assert refusal(mesh_damper.outcome, path, decimal=sign) == expected
    assert refusal(mesh_damper.trace_many, [path], out=tmp_path / "out", decimal=sign) == expected
    assert not (tmp_path / "out").exists()


def test_what_only_a_file_has_is_refused_without_one(runs: Path) -> None:
    block, t = sine_block(), np.arange(0.0, 1.0, 1e-3)
    table = "table: no recording is a file, and only a file has several tables; leave table= out"
    decimal = "decimal: no recording is a file, and only a file has numbers as text; leave decimal= out"
    assert refusal(mesh_damper.trace, block, table="first") == table
    assert refusal(mesh_damper.trace, [block], held_out=block, decimal="point") == decimal
    assert refusal(mesh_damper.characterize, block, decimal="comma") == decimal
    assert refusal(mesh_damper.respond, SPRING, mass=1.0, force=np.sin(t), t=t, table="first") == table
    # Next to a file, a recording in memory is read without them.
    found = mesh_damper.trace(runs, table="first", held_out=sine_block(amplitude=0.12))
    assert found.to_dict()["held_out"] == ["held-out recording"]
    found = mesh_damper.trace(sine_block(amplitude=0.12), held_out=[runs], table="second")
    assert found.to_dict()["held_out"] == [str(runs)]
