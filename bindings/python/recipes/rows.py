"""Rows of many traces, stored as they arrive, for all recipes.

A row is a line of JSON that is on the disk before the next one starts. A killed run loses only the traces that were running. The next run
with the same file makes only the missing rows. As in `hil batch`, a row belongs to the contents of its recording, whatever the name of the
file, and to the version of the package. The table has one row for each recording that is in the folder now.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mesh_damper

#: Settings of every trace, as `mesh_damper.outcome` takes them: `{"units": {"force": "kN"}}`. Change them in this file: workers import it.
SETTINGS: dict[str, Any] = {}


def row_of(path: str) -> dict[str, Any]:
    """The work of a worker: one trace. It does not raise: a recording that cannot be traced gives a row with its error."""
    return mesh_damper.outcome(path, **SETTINGS)


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


def _identity(path: str) -> str:
    """The identity of a recording's row. One that cannot be read has none: its path identifies its row, which has the error."""
    try:
        return mesh_damper.identity(path, **SETTINGS)
    except mesh_damper.InputError:
        return path


class Rows:
    """The finished rows of the recordings `paths`, by their identities."""

    def __init__(self, file: str, paths: Iterable[str]) -> None:
        # The contents of every recording are read for that.
        self._identities = {path: _identity(path) for path in paths}
        self._rows: dict[str, dict[str, Any]] = {}
        path = Path(file)
        text = path.read_bytes() if path.exists() else b""
        whole = text[: text.rfind(b"\n") + 1]
        for line in whole.splitlines():
            row = json.loads(line)
            self._rows[row["id"] or row["trace"]] = row
        # An incomplete last line is removed.
        if len(whole) < len(text):
            os.truncate(path, len(whole))
        self._path = path

    def missing(self) -> list[str]:
        """The recordings whose rows are still missing. Of several files with the same contents, it is the first."""
        first: dict[str, str] = {}
        for path, identity in self._identities.items():
            first.setdefault(identity, path)
        return [path for identity, path in first.items() if not self._has(identity, path)]

    def _has(self, identity: str, path: str) -> bool:
        row = self._rows.get(identity)
        # An error contains the name that the file had.
        return row is not None and (row["outcome"] == "traced" or row["trace"] == path)

    def keep(self, row: dict[str, Any]) -> None:
        """Stores a row. Its identity is that of the contents before its trace: the next run traces a file again that changed meanwhile."""
        with self._path.open("ab") as file:
            file.write(json.dumps(row).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
        identity = row["id"] or row["trace"]
        self._rows[identity], self._identities[row["trace"]] = row, identity

    def table(self) -> list[dict[str, Any]]:
        """The rows of the recordings, with their names of today. Other files with the same contents are in `copies`."""
        named: dict[str, dict[str, Any]] = {}
        for path, identity in self._identities.items():
            if identity in named:
                named[identity]["copies"].append(path)
            elif identity in self._rows:
                named[identity] = {**self._rows[identity], "trace": path, "recordings": [path], "copies": []}
        return list(named.values())

    def to_parquet(self, file: str) -> int:
        """Writes the table, completely or not at all, and returns the number of its rows."""
        part, rows = f"{file}.part", self.table()
        mesh_damper.outcomes(rows).to_parquet(part)
        os.replace(part, file)
        return len(rows)
