"""The rows of many traces, kept as they come: what the recipes share.

A row is a line of JSON, on the disk before the next. A run that is killed loses the traces that were under way, and no other; the next run
with the same file makes only what is missing.
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


def recordings(folder: str) -> list[str]:
    """The recordings of a folder."""
    paths = (str(path) for path in Path(folder).iterdir())
    return sorted(path for path in paths if path.endswith((".csv", ".csv.gz")))


class Rows:
    """The rows that are made, by the paths of their recordings."""

    def __init__(self, file: str) -> None:
        self.rows: dict[str, dict[str, Any]] = {}
        path = Path(file)
        text = path.read_bytes() if path.exists() else b""
        whole = text[: text.rfind(b"\n") + 1]
        for line in whole.splitlines():
            row = json.loads(line)
            self.rows[row["trace"]] = row
        # A line that was cut is taken off.
        self._file = path.open("r+b" if path.exists() else "w+b")
        self._file.truncate(len(whole))
        self._file.seek(0, os.SEEK_END)

    def missing(self, paths: Iterable[str]) -> list[str]:
        """The paths whose rows are still to be made."""
        return [path for path in paths if path not in self.rows]

    def keep(self, row: dict[str, Any]) -> None:
        """Keeps a row."""
        self._file.write(json.dumps(row).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())
        self.rows[row["trace"]] = row

    def to_parquet(self, file: str) -> None:
        """Writes the table of all rows, whole or not at all."""
        part = f"{file}.part"
        mesh_damper.outcomes([self.rows[path] for path in sorted(self.rows)]).to_parquet(part)
        os.replace(part, file)
