"""Traces of many recordings, and models over time."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path
from typing import Any

import mesh_damper
import numpy as np
import pandas as pd
import polars as pl
import pytest
from conftest import sine_block, write_csv


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three recordings of different amplitudes, and a file that is no recording."""
    folder = tmp_path_factory.mktemp("many")
    for number in range(3):
        write_csv(folder / f"{number}.csv", sine_block(amplitude=0.1 + 0.02 * number))
    (folder / "broken.csv").write_text("time_s\n0\n")
    return folder


def test_a_folder_gives_a_row_a_recording_and_none_twice(folder: Path, tmp_path: Path) -> None:
    said: list[str] = []
    batch = mesh_damper.trace_many(folder, out=tmp_path / "out", jobs=2, progress=said.append)
    assert (batch.traced, batch.failed, batch.computed) == (3, 1, 4)
    assert said[-1] == "4 of 4, 1 failed"
    rows = batch.outcomes
    assert list(rows.outcome) == ["traced"] * 3 + ["failed"]
    assert "broken.csv" in rows.error[3]
    table = pd.read_csv(tmp_path / "out" / "outcomes.csv")
    assert list(table.columns) == list(rows.columns)
    np.testing.assert_array_equal(table.nrmse_baseline_fitted, rows.nrmse_baseline_fitted.astype(float))
    assert set(batch.effects.parameter) >= {"k1", "k3", "c", "alpha"}
    again = mesh_damper.trace_many(folder, out=tmp_path / "out")
    assert again.computed == 0
    pd.testing.assert_frame_equal(again.outcomes, rows)
    assert batch.to_dict()["format"] == "mesh-damper batch"


def test_files_that_are_no_recordings_are_left_out_with_a_warning(tmp_path: Path) -> None:
    write_csv(tmp_path / "0.csv", sine_block())
    (tmp_path / "notes.pdf").write_text("no recording")
    with pytest.warns(UserWarning, match=r"1 file is left out, .*: notes\.pdf$"):
        batch = mesh_damper.trace_many(tmp_path, out=tmp_path / "out")
    assert (batch.traced, batch.failed) == (1, 0)


@pytest.mark.parametrize("library", [pd, pl])
def test_a_frame_gives_a_trace_a_group(folder: Path, tmp_path: Path, library: object) -> None:
    frame = library.DataFrame(  # type: ignore[attr-defined]
        {
            "path": [str(folder / f"{number}.csv") for number in (0, 1, 2)],
            "group": [7, 7, None],
            "held_out": [False, True, None],
        }
    )
    batch = mesh_damper.trace_many(frame, out=tmp_path / "out")
    assert isinstance(batch.outcomes, library.DataFrame)  # type: ignore[attr-defined]
    assert next(iter(batch.outcomes["trace"])) == "7"
    assert [len(paths) for paths in batch.outcomes["held_out"]] == [1, 0]


def test_a_row_of_one_is_the_row_of_many(folder: Path, tmp_path: Path) -> None:
    path = folder / "0.csv"
    row = mesh_damper.outcome(path)
    many = mesh_damper.trace_many([path], out=tmp_path / "out")
    assert row["id"] == many.outcomes.id[0] == mesh_damper.identity(path) == mesh_damper.identity([path])
    assert row["id"] not in (mesh_damper.identity(path, rate=500.0), mesh_damper.identity(path, held_out=[folder / "1.csv"]))
    with pytest.raises(mesh_damper.MissingFileError, match=r"missing\.csv"):
        mesh_damper.identity([path, folder / "missing.csv"])
    table = mesh_damper.outcomes([row, mesh_damper.outcome(folder / "broken.csv")])
    alike = [name for name in table.columns if name not in ("trace_s", "folder")]
    # A missing text is NaN next to other texts, and None alone.
    one, other = (frame[alike].astype(object).where(frame[alike].notna(), None) for frame in (table.iloc[:1], many.outcomes))
    pd.testing.assert_frame_equal(one, other)
    assert list(table.outcome) == ["traced", "failed"]


def test_rows_without_a_library_of_frames_are_a_record_array(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    row = mesh_damper.outcome(folder / "0.csv")
    frame = mesh_damper.outcomes([row, row])
    monkeypatch.setattr("mesh_damper._frames._is_there", lambda _: False)
    table = mesh_damper.outcomes([row, row])
    assert isinstance(table, np.recarray)
    assert list(table.dtype.names) == list(frame.columns)
    assert list(table.verdict) == list(frame.verdict)
    # A list in a cell stays one.
    assert [list(cell) for cell in table.warnings] == [list(cell) for cell in frame.warnings]


def test_what_cannot_be_a_list_is_refused(tmp_path: Path) -> None:
    with pytest.raises(mesh_damper.InputError, match="no column 'path'"):
        mesh_damper.trace_many(pd.DataFrame({"file": ["a.csv"]}), out=tmp_path / "out")
    with pytest.raises(mesh_damper.InputError, match="there is none"):
        mesh_damper.trace_many([], out=tmp_path / "out")
    with pytest.raises(mesh_damper.InputError, match="jobs"):
        mesh_damper.trace_many(["a.csv"], out=tmp_path / "out", jobs=0)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("rate", [0, -500.0, float("nan"), float("inf")])
def test_a_rate_is_checked_before_any_recording(folder: Path, tmp_path: Path, rate: float) -> None:
    for function in (
        mesh_damper.outcome,
        mesh_damper.identity,
        lambda path, rate: mesh_damper.trace_many([path], out=tmp_path / "out", rate=rate),
    ):
        with pytest.raises(mesh_damper.InputError) as raised:
            function(folder / "0.csv", rate=rate)
        value = {0.0: "0", -500.0: "-500"}.get(rate, "NaN" if rate != rate else "inf")
        assert str(raised.value) == f"rate: {value} is not a valid sampling rate; give samples per second, a finite number above 0"
    assert not (tmp_path / "out").exists()


def test_a_conclusion_is_that_of_the_command(tmp_path: Path, hil: Any) -> None:
    stiffer = {**sine_block(), "force_kN": 1.1 * sine_block()["force_kN"]}
    for name, columns in (("first", sine_block()), ("stiffer", stiffer)):
        mesh_damper.trace(columns).save(tmp_path / name)
    shutil.copytree(tmp_path / "first", tmp_path / "bare")
    (tmp_path / "bare" / "trace.json").unlink()
    for other, conclusion, heading in (
        ("first", "no_change", "No change"),
        ("stiffer", "changed", "The specimen changed"),
        ("bare", "undecided_force", "Undecided"),
    ):
        models = [tmp_path / "first", tmp_path / other]
        found = mesh_damper.compare(models)
        assert found.conclusion == conclusion
        done = hil("compare", *models)
        assert done.returncode == 0, done.stderr
        said = done.stdout.splitlines()[0]
        assert said.startswith(heading)
        assert repr(found) == f"<Comparison of 2 models: {said}>"
        assert found.to_dict() == json.loads(hil("compare", *models, "--json", "-").stdout)


@pytest.mark.skipif(os.name == "nt", reason="left out: Windows has no such pipes")
def test_python_runs_while_the_core_reads_and_compares() -> None:
    # The core waits for what another thread of Python writes into a pipe. With the lock held, that thread could never write.
    program = textwrap.dedent(
        """
        import json, os, sys, threading
        from pathlib import Path
        import mesh_damper
        from test_models import SPRING
        folder = Path(sys.argv[1])
        def through_a_pipe(name, text, function):
            pipe = folder / name
            os.mkfifo(pipe)
            other = threading.Thread(target=pipe.write_text, args=(text,))
            other.start()
            done = function(pipe)
            other.join()
            return done
        model = json.dumps(SPRING)
        (folder / "first.json").write_text(model)
        compared = through_a_pipe("compared.json", model, lambda pipe: mesh_damper.compare([folder / "first.json", pipe]))
        assert compared.conclusion == "undecided_force"
        assert through_a_pipe("model.json", model, mesh_damper.DamperLaw.load).model_["law"] == SPRING["law"]
        (folder / "a.csv").write_text("time_s")
        batch = through_a_pipe("list.txt", str(folder / "a.csv"), lambda pipe: mesh_damper.trace_many(pipe, out=folder / "out"))
        assert batch.failed == 1
        print("done")
        """
    )
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-c", program, folder],
            capture_output=True,
            text=True,
            cwd=Path(__file__).parent,
            check=False,
            # Only a thread that can never write takes that long.
            timeout=120,
        )
    assert (done.returncode, done.stdout) == (0, "done\n"), done.stderr


def test_a_stiffer_specimen_is_another_than_before(tmp_path: Path) -> None:
    first = sine_block()
    stiffer = {**sine_block(), "force_kN": 1.1 * sine_block()["force_kN"]}
    traces = [mesh_damper.trace(columns) for columns in (first, stiffer)]
    found = mesh_damper.compare(traces, times=[0, 12.5])
    assert found.changed and found.conclusion == "changed"
    assert found.forces.difference[0] == pytest.approx(0.1, rel=0.2)
    assert set(found.parameters.time) == {0.0, 12.5}
    same = mesh_damper.compare([traces[0], traces[0]])
    assert same.undecided == [] and same.conclusion == "no_change"
    assert not same.changed and same.forces.difference[0] == 0.0
    assert json.loads(json.dumps(same.to_dict()))["format"] == "mesh-damper comparison"
    with pytest.raises(mesh_damper.InputError, match="times: has 1 for 2 models"):
        mesh_damper.compare(traces, times=[1.0])
