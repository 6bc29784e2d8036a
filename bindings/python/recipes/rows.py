"""The rows of many traces, kept as they come: what the recipes share.

A row is a line of JSON, on the disk before the next. A run that is killed loses the traces that were under way, and no other; the next run
with the same file makes only what is missing: what has no row, and what was changed since it got one. In the table a recording that lies
there twice has one row.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mesh_damper


def row_of(path: str) -> dict[str, Any]:
    """What a worker does: one trace. It raises nothing: a recording that cannot be traced is a row with its error."""
    return mesh_damper.outcome(path)


#: What recordings' names end in.
ENDINGS = (".csv", ".csv.gz", ".txt", ".parquet", ".mf4", ".mat", ".h5", ".tdms")


def recordings(folder: str) -> list[str]:
    """The recordings of a folder."""
    paths = (str(path) for path in Path(folder).iterdir())
    return sorted(path for path in paths if path.lower().endswith(ENDINGS))


def _state(path: str) -> list[int] | None:
    """By what a file is seen to have been changed: its size and the time of its last change."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return [found.st_size, found.st_mtime_ns]


class Rows:
    """The rows that are made, by the paths of their recordings."""

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
        # A line that was cut is taken off.
        if len(whole) < len(text):
            os.truncate(path, len(whole))
        self._path = path

    def missing(self, paths: Iterable[str]) -> list[str]:
        """The paths whose rows are still to be made."""
        return [path for path in paths if path not in self.rows or self._states[path] != _state(path)]

    def keep(self, row: dict[str, Any]) -> None:
        """Keeps a row."""
        state = _state(row["trace"])
        with self._path.open("ab") as file:
            file.write(json.dumps({"state": state, "row": row}).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
        self.rows[row["trace"]], self._states[row["trace"]] = row, state

    def to_parquet(self, file: str) -> None:
        """Writes the table of all rows, whole or not at all."""
        part = f"{file}.part"
        # A recording that could not be read has no identity, and is like no other.
        by_identity = {self.rows[path].get("id") or path: self.rows[path] for path in sorted(self.rows, reverse=True)}
        mesh_damper.outcomes(sorted(by_identity.values(), key=lambda row: row["trace"])).to_parquet(part)
        os.replace(part, file)
