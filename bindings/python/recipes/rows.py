"""Rows of many traces, stored as they arrive, for all recipes.

A row is a line of JSON that is on the disk before the next one starts. A killed run loses only the traces that were running. The next run
with the same file makes only the missing rows: those of recordings without a row, and of recordings that have changed since. The table has
one row for a recording that is in the folder twice.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mesh_damper


def row_of(path: str) -> dict[str, Any]:
    """The work of a worker: one trace. It does not raise: a recording that cannot be traced gives a row with its error."""
    return mesh_damper.outcome(path)


def recordings(folder: str, written: Iterable[str] = ()) -> list[str]:
    """The recordings of a folder, as `hil batch` finds them. The names of its other files are printed.

    The files that the recipe has `written` may be in the folder too. They have endings of recordings and are none.
    """
    found, skipped = mesh_damper.recordings_in(folder)
    if skipped:
        names = ", ".join(os.path.basename(path) for path in skipped)
        print(f"skipped, because their names are not those of recordings: {names}", file=sys.stderr)
    own = {os.path.realpath(path) for path in written}
    return [path for path in found if os.path.realpath(path) not in own]


def _state(path: str) -> list[int] | None:
    """The state of a file by which a change is detected: its size and the time of its last change."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return [found.st_size, found.st_mtime_ns]


class Rows:
    """The finished rows, by the paths of their recordings."""

    def __init__(self, file: str) -> None:
        self.rows: dict[str, dict[str, Any]] = {}
        self._states: dict[str, list[int] | None] = {}
        path = Path(file)
        text = path.read_bytes() if path.exists() else b""
        whole = text[: text.rfind(b"\n") + 1]
        for line in whole.splitlines():
            kept = json.loads(line)
            path_of_it = kept["row"]["trace"]
            self.rows[path_of_it], self._states[path_of_it] = kept["row"], kept["state"]
        # An incomplete last line is removed.
        if len(whole) < len(text):
            os.truncate(path, len(whole))
        self._path = path

    def missing(self, paths: Iterable[str]) -> list[str]:
        """The paths whose rows are still missing."""
        return [path for path in paths if path not in self.rows or self._states[path] != _state(path)]

    def keep(self, row: dict[str, Any]) -> None:
        """Stores a row."""
        state = _state(row["trace"])
        with self._path.open("ab") as file:
            file.write(json.dumps({"state": state, "row": row}).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
        self.rows[row["trace"]], self._states[row["trace"]] = row, state

    def to_parquet(self, file: str) -> None:
        """Writes the table of all rows, completely or not at all."""
        part = f"{file}.part"
        # A recording that could not be read has no identity, so its path identifies it.
        by_identity = {self.rows[path].get("id") or path: self.rows[path] for path in sorted(self.rows, reverse=True)}
        mesh_damper.outcomes(sorted(by_identity.values(), key=lambda row: row["trace"])).to_parquet(part)
        os.replace(part, file)
