"""The stored rows of the recipes."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "recipes"))
from rows import Rows


def test_a_row_is_made_again_where_its_recording_was_changed(tmp_path):
    first, second = tmp_path / "a.csv", tmp_path / "b.csv"
    first.write_text("1")
    second.write_text("2")
    paths, kept = [str(first), str(second)], str(tmp_path / "rows.jsonl")
    rows = Rows(kept)
    assert rows.missing(paths) == paths
    for path in paths:
        rows.keep({"trace": path, "id": None})
    assert Rows(kept).missing(paths) == []
    first.write_text("another")
    assert Rows(kept).missing(paths) == [str(first)]
    # A line that is incomplete because the run was killed.
    whole = Path(kept).read_bytes()
    Path(kept).write_bytes(whole[:-5])
    assert Rows(kept).missing(paths) == paths
