"""The recordings and the stored rows of the recipes."""

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import mesh_damper
import pytest
from conftest import sine_block, write_csv

sys.path.insert(0, str(Path(__file__).parent.parent / "recipes"))
from rows import Rows, recordings, row_of


def test_a_row_is_made_again_where_its_recording_was_changed(tmp_path: Path) -> None:
    first, second = tmp_path / "a.csv", tmp_path / "b.csv"
    first.write_text("1")
    second.write_text("2")
    paths, kept = [str(first), str(second)], str(tmp_path / "rows.jsonl")
    rows = Rows(kept, paths)
    assert rows.missing() == paths
    for path in paths:
        rows.keep(row_of(path))
    assert Rows(kept, paths).missing() == []
    first.write_text("another")
    assert Rows(kept, paths).missing() == [str(first)]
    # A line that is incomplete because the run was killed.
    whole = Path(kept).read_bytes()
    Path(kept).write_bytes(whole[:-5])
    assert Rows(kept, paths).missing() == paths


def test_a_recording_that_changes_during_its_trace_is_traced_again(tmp_path: Path) -> None:
    path, kept = tmp_path / "a.csv", str(tmp_path / "rows.jsonl")
    path.write_text("1")
    row = row_of(str(path))
    path.write_text("another")
    Rows(kept, [str(path)]).keep(row)
    assert Rows(kept, [str(path)]).missing() == [str(path)]


def test_the_table_is_of_the_recordings_that_are_there(tmp_path: Path) -> None:
    gone, here, moved, copy = (str(tmp_path / f"{name}.csv") for name in ("gone", "here", "moved", "of-moved"))
    write_csv(Path(here), sine_block())
    Path(gone).write_text("1")
    kept = str(tmp_path / "rows.jsonl")
    rows = Rows(kept, [gone, here])
    for path in rows.missing():
        rows.keep(row_of(path))
    assert [row["trace"] for row in rows.table()] == [gone, here]
    # Under another name it is the same recording, and twice it is one.
    Path(gone).unlink()
    Path(here).rename(moved)
    shutil.copy(moved, copy)
    rows = Rows(kept, [moved, copy])
    assert rows.missing() == []
    (row,) = rows.table()
    assert (row["outcome"], row["trace"], row["recordings"], row["copies"]) == ("traced", moved, [moved], [copy])
    assert list(mesh_damper.outcomes(rows.table()).trace) == [moved]
    # An error contains the name of the file, and a recording that cannot be read has one.
    Path(gone).write_text("1")
    rows = Rows(kept, [gone])
    assert rows.missing() == []
    renamed = str(Path(gone).rename(tmp_path / "renamed.csv"))
    rows = Rows(kept, [renamed, gone])
    assert rows.missing() == [renamed, gone]
    for path in rows.missing():
        rows.keep(row_of(path))
    assert [row["trace"] in row["error"] for row in rows.table()] == [True, True]


def test_the_recordings_of_a_folder_are_those_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str], hil: Any) -> None:
    folder = tmp_path / "folder"
    (folder / "deeper").mkdir(parents=True)
    text = ["asc", "csv", "csv.gz", "CSV", "dat", "lvm", "tsv", "txt"]
    other = ["arrow", "feather", "h5", "hdf5", "json", "jsonl", "mat", "mf4", "nc", "parquet", "tdms", "xlsx"]
    found = [f"{place:02}.{ending}" for place, ending in enumerate([*text, *other])]
    skipped = ["index.tdms_index", "model.json", "notes.pdf", "trace.json"]
    for name in [*found, *skipped, ".hidden.csv", "deeper/a.csv"]:
        (folder / name).write_text(f"no recording: {name}")
    assert recordings(str(folder)) == [str(folder / name) for name in found]
    said = capsys.readouterr()
    assert said.err == f"skipped, because their names are not those of recordings: {', '.join(skipped)}\n" and said.out == ""
    done = hil("batch", folder, "--out", tmp_path / "out", "--json", "-")
    assert sorted(row["trace"] for row in json.loads(done.stdout)["traces"]) == [str(folder / name) for name in found]
    assert "4 files are left out" in done.stderr
    # What a recipe wrote into the folder is no recording.
    written = [str(folder / name) for name in ("rows.jsonl", "outcomes.parquet")]
    for path in written:
        Path(path).write_text("")
    assert recordings(str(folder), written) == [str(folder / name) for name in found]


def test_a_folder_without_recordings_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "notes.pdf").write_text("")
    with pytest.raises(mesh_damper.InputError, match="holds no file with an ending of recordings"):
        recordings(str(tmp_path))
    with pytest.raises(mesh_damper.MissingFileError, match="does not exist; check the path"):
        recordings(str(tmp_path / "missing"))
    assert capsys.readouterr().err == ""
