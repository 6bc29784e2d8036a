"""Traces of many recordings, and comparisons of models of one specimen over time."""

from __future__ import annotations

import csv
import io
import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Union

from . import _core, _frames
from ._errors import InputError
from ._recordings import Decimal, Zero
from ._trace import Trace, model_of

#: A path of a folder, a list or a table; several paths; or a data frame with a column `path`.
Recordings = Any
#: A path of a model or of a trace's folder, or a trace.
ModelLike = Union[str, "os.PathLike[str]", Trace]

#: Mass of the fixture, delay of the force, and zero of the displacement.
Rig = tuple[float | None, float | None, Zero | None]

_COLUMNS = ("path", "group", "specimen", "role", "held_out")


class Batch:
    """The outcomes of many traces, returned by `trace_many`."""

    def __init__(self, summary: str, outcomes: dict[str, Any], effects: dict[str, Any], folder: Path, library: Any) -> None:
        self._summary: dict[str, Any] = json.loads(summary)
        #: The folder with outcomes.parquet, effects.parquet, index.html and the folders of all traces.
        self.folder = folder
        #: A row for each trace, as a data frame. docs/batch.md describes its columns.
        self.outcomes: Any = _frames.make(outcomes, library)
        #: A row for each parameter of the law and of the effects of each trace, as a data frame.
        self.effects: Any = _frames.make(effects, library)

    @property
    def traced(self) -> int:
        """Number of traces that succeeded, in this run or earlier."""
        return int(self._summary["traced"])

    @property
    def failed(self) -> int:
        """Number of traces that failed; the column `error` gives the reason."""
        return int(self._summary["failed"])

    @property
    def computed(self) -> int:
        """Number of traces that succeeded or failed in this run; the others are from earlier runs."""
        return int(self._summary["computed"])

    @property
    def shared(self) -> list[str]:
        """Recordings that several traces use, as sentences."""
        return list(self._summary["shared"])

    def to_dict(self) -> dict[str, Any]:
        """The summary, as `hil batch --json` writes it."""
        return self._summary

    def __repr__(self) -> str:
        return f"<Batch of {self.traced + self.failed} traces in {str(self.folder)!r}: {self.failed} failed>"


def trace_many(
    recordings: Recordings,
    *,
    out: str | os.PathLike[str],
    jobs: int | None = None,
    reports: bool = False,
    channels: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    rate: float | None = None,
    table: str | None = None,
    decimal: Decimal | None = None,
    families: Sequence[str] = (),
    exclude: Sequence[str] = (),
    baseline: str = "mixed",
    law: Any = None,
    fixture_mass: float | None = None,
    force_delay: float | None = None,
    zero: Zero | None = None,
    max_read: int | None = None,
    progress: Callable[[str], object] | None = None,
) -> Batch:
    """Trace many recordings into the folder `out`, as `hil batch` does.

    `recordings` is one of these:

    - a folder;
    - a text file with a path on each line;
    - a table, as CSV, Parquet or a data frame, with a column `path` and the optional columns `group`, `specimen`, and `role` or
      `held_out`; the rows of one group are one trace;
    - a sequence of paths.

    `channels`, `units`, `rate`, `table` and `decimal` say how to read the files, as the options of `hil batch` do: `channels` names the
    column of a quantity, `table` the sheet, group or table of files with several, and `decimal` is the decimal sign of text files, `point`
    or `comma`. `fixture_mass`, `force_delay` and `zero` are what is known about the rig, as for `trace`.

    `jobs` traces run at the same time; the default is the number of cores. A trace with the same recordings and options that an earlier
    run wrote into `out` is not repeated. A recording that cannot be read or traced gets a row with its `error`. Files of a folder whose
    ending is not that of a recording are left out, with a warning.
    """
    given: Any = None
    rows: str | None = None
    if isinstance(recordings, (str, os.PathLike)):
        given = os.fspath(recordings)
    elif (names := _frames.column_names(recordings)) is not None:
        rows = _table(recordings, names)
    else:
        given = [os.fspath(path) for path in recordings]
        if not given:
            raise InputError("recordings: there is none; give at least one path")
    reading = _reading(channels, units, rate, table, decimal, max_read)
    settings = _settings(reading, families, exclude, baseline, law, (fixture_mass, force_delay, zero), reports)
    folder = Path(out)
    summary, outcomes, effects, left_out = _core.trace_many(given, rows, folder, settings, jobs, progress)
    if left_out is not None:
        warnings.warn(left_out, stacklevel=2)
    return Batch(summary, outcomes, effects, folder, _frames.library_of(recordings))


def _reading(
    channels: Mapping[str, str] | None,
    units: Mapping[str, str] | None,
    rate: float | None,
    table: str | None,
    decimal: Decimal | None,
    max_read: int | None,
) -> _core.Reading:
    by_channel, by_unit = (list((pairs or {}).items()) for pairs in (channels, units))
    return _core.Reading(channels=by_channel, units=by_unit, rate=rate, table=table, decimal=decimal, max_read=max_read)


def _settings(
    reading: _core.Reading,
    families: Sequence[str],
    exclude: Sequence[str],
    baseline: str,
    law: Any,
    rig: Rig,
    reports: bool = False,
) -> _core.BatchSettings:
    return _core.BatchSettings(
        reading,
        [families] if isinstance(families, str) else list(families),
        [exclude] if isinstance(exclude, str) else list(exclude),
        baseline,
        None if law is None else model_of(law),
        rig,
        reports,
    )


def _table(frame: Any, names: Sequence[str]) -> str:
    """Write a frame of paths as CSV."""
    if "path" not in names:
        found = ", ".join(map(repr, names)) or "none"
        raise InputError(f"recordings: there is no column 'path'; found {found}; name the column of paths 'path'")
    used = [name for name in _COLUMNS if name in names]
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(used)
    for row in zip(*(list(_frames.column(frame, name)) for name in used)):
        writer.writerow(["" if _is_missing(cell) else _word(cell) for cell in row])
    return text.getvalue()


def _is_missing(cell: Any) -> bool:
    return cell is None or cell != cell or str(cell) == "<NA>"


def _word(cell: Any) -> str:
    # pandas stores a column of whole numbers with a missing one as floats.
    if isinstance(cell, float) and cell.is_integer():
        return str(int(cell))
    return os.fspath(cell) if isinstance(cell, os.PathLike) else str(cell)


def recordings_in(folder: str | os.PathLike[str]) -> tuple[list[str], list[str]]:
    """Return the paths of the recordings in a folder, and those of its other files, as `hil batch` tells them apart.

    A recording is a file whose name ends in a format that is read. Hidden files and subfolders are in neither list, and the files that a
    trace writes, `model.json` and `trace.json`, are no recordings.
    """
    recordings, others = _core.recordings_in(folder)
    return [str(path) for path in recordings], [str(path) for path in others]


def identity(
    recordings: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    held_out: Sequence[str | os.PathLike[str]] = (),
    channels: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    rate: float | None = None,
    table: str | None = None,
    decimal: Decimal | None = None,
    families: Sequence[str] = (),
    exclude: Sequence[str] = (),
    baseline: str = "mixed",
    law: Any = None,
    fixture_mass: float | None = None,
    force_delay: float | None = None,
    zero: Zero | None = None,
    max_read: int | None = None,
) -> str:
    """Return the `id` that `outcome` would give the row of these recordings, without tracing them.

    It is a hash of the contents of the recordings, their roles, the settings and the program's version. It does not depend on the names of
    the files. Thus a scheduler knows which rows it has already.
    """
    reading = _reading(channels, units, rate, table, decimal, max_read)
    settings = _settings(reading, families, exclude, baseline, law, (fixture_mass, force_delay, zero))
    return _core.identity(_paths(recordings), _paths(held_out), settings)


def _paths(given: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]) -> list[str]:
    each = [given] if isinstance(given, (str, os.PathLike)) else given
    return [os.fspath(path) for path in each]


def outcome(
    recordings: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    held_out: Sequence[str | os.PathLike[str]] = (),
    channels: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    rate: float | None = None,
    table: str | None = None,
    decimal: Decimal | None = None,
    families: Sequence[str] = (),
    exclude: Sequence[str] = (),
    baseline: str = "mixed",
    law: Any = None,
    fixture_mass: float | None = None,
    force_delay: float | None = None,
    zero: Zero | None = None,
    max_read: int | None = None,
) -> dict[str, Any]:
    """Return the row of one trace, for a user's scheduler that maps over paths.

    It writes no file and uses one core. A failed trace gives a row instead of an exception. `outcomes` makes a table of many rows. The
    settings are those of `trace_many`.
    """
    reading = _reading(channels, units, rate, table, decimal, max_read)
    settings = _settings(reading, families, exclude, baseline, law, (fixture_mass, force_delay, zero))
    row: dict[str, Any] = json.loads(_core.outcome(_paths(recordings), _paths(held_out), settings))
    return row


def outcomes(rows: Sequence[dict[str, Any]]) -> Any:
    """Return rows of `outcome` as a data frame with the columns of `outcomes.parquet`."""
    return _frames.make(_core.outcomes_of([json.dumps(row) for row in rows]))


class Comparison:
    """The changes from model to model, returned by `compare`."""

    def __init__(self, text: str, sentence: str) -> None:
        self._found: dict[str, Any] = json.loads(text)
        self._sentence = sentence

    @property
    def conclusion(self) -> str:
        """The conclusion: `changed`, `no_change`, or, if nothing can be decided, `undecided_effect` or `undecided_force`."""
        return str(self._found["conclusion"])

    @property
    def changed(self) -> bool:
        """Whether a change is claimed. For an unchanged specimen, this happens in at most one comparison in twenty."""
        return bool(self._found["changed"])

    @property
    def forces(self) -> Any:
        """The force of each later model, compared with the force of the first on the same motion, as a data frame."""
        names = ("model", "difference", "expected", "p", "changed")
        rows = self._found["forces"]
        columns: dict[str, list[Any]] = {name: [row[name] for row in rows] for name in names}
        for name in ("displacement_mm", "velocity_mm_s", "difference_kN"):
            columns[f"largest_{name}"] = [row["largest"][name] for row in rows]
        return _frames.make(columns)

    @property
    def parameters(self) -> Any:
        """A row for each parameter and model: the value, its 90 % interval, and whether a change of the parameter is claimed."""
        columns: dict[str, list[Any]] = {
            name: [] for name in ("of", "amplitude_mm", "parameter", "unit", "time", "value", "low", "high", "p", "changed")
        }
        times = [model["time"] for model in self._found["models"]]
        for row in self._found["parameters"]:
            for time, value in zip(times, row["values"]):
                if value is not None:
                    for name in ("of", "amplitude_mm", "parameter", "unit", "p", "changed"):
                        columns[name].append(row[name])
                    columns["time"].append(time)
                    for name in ("value", "low", "high"):
                        columns[name].append(value[name])
        return _frames.make(columns)

    @property
    def effects(self) -> list[dict[str, Any]]:
        """The effects that appeared or vanished."""
        return list(self._found["effects"])

    @property
    def undecided(self) -> list[dict[str, Any]]:
        """Effects that the common motion does not excite, each with the recording that would show it."""
        return list(self._found["undecided"])

    @property
    def notes(self) -> list[str]:
        """Comparisons that were not possible, with the reason, as sentences."""
        return list(self._found["notes"])

    def to_dict(self) -> dict[str, Any]:
        """The comparison, as `hil compare --json` writes it."""
        return self._found

    def __repr__(self) -> str:
        return f"<Comparison of {len(self._found['models'])} models: {self._sentence}>"


def compare(models: Sequence[ModelLike], times: Sequence[float] | None = None) -> Comparison:
    """Compare models of one specimen, as `hil compare` does, and report changes beyond the intervals.

    Each of `models` is a trace, the folder of a trace, or a `model.json`. `times` is the time of each model, in any unit.
    """
    if times is None:
        times = range(len(models))
    if len(times) != len(models):
        raise InputError(f"times: has {len(times)} for {len(models)} models; give one time for each model")
    given = [_given(place, model) for place, model in enumerate(models)]
    return Comparison(*_core.compare_models(given, [float(time) for time in times]))


def _given(place: int, model: ModelLike) -> Any:
    if isinstance(model, Trace):
        return (f"model {place}", json.dumps(model.model), model.to_json())
    return os.fspath(model)
