"""A trace: finds effects that a law does not contain, and fits the augmented model."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core, _frames
from ._errors import InputError
from ._frames import Library
from ._recordings import ChannelLike, Decimal, Given, Inputs, RecordingLike, Units, Zero
from ._words import interval, percent, unit_in_words

if TYPE_CHECKING:
    from ._law import DamperLaw


@dataclass(frozen=True)
class Errors:
    """Errors of a model's force: RMS error over RMS of the measured force."""

    #: NRMSE on the fitted samples; `None` if it was not computed.
    nrmse_fitted: float | None
    #: NRMSE on the held-out samples, which were never fitted.
    nrmse_held_out: float


@dataclass(frozen=True)
class Baseline(Errors):
    """The law alone, before any effect is added."""

    #: Name of the law: `mixed_damping`, `linear` or `none`.
    law: str
    #: Families of the known effects.
    known: tuple[str, ...]


class Trace:
    """The result of a trace, returned by `trace`."""

    def __init__(self, core: _core.Trace, assumed: Sequence[str] = (), library: Library | None = None) -> None:
        self._core = core
        self._json = core.to_json()
        self._found: dict[str, Any] = json.loads(self._json)
        self._library = library
        #: The assumed units and the guesses about the meaning of columns, as sentences.
        self.assumed: list[str] = list(assumed)

    @property
    def verdict(self) -> str:
        """The verdict: `none`, `found`, `ambiguous` or `unlisted`."""
        return str(self._found["verdict"])

    @property
    def effects(self) -> Any:
        """The effects found, with a row for each parameter and its 90 % interval.

        It is a pandas data frame, or a polars frame if the recording was one. An end of an interval without a bound is infinite.
        """
        return self._effects(self._found["effects"])

    @property
    def unconfirmed(self) -> Any:
        """The unconfirmed effects of the model, in the form of `effects`."""
        return self._effects(self._found["unconfirmed"])

    @property
    def candidates(self) -> Any:
        """All families that were tried, as a data frame, the best first."""
        names = (
            "family",
            "step",
            "added",
            "distinguishable",
            "admissible",
            "rejected_by",
            "nrmse_held_out",
            "nrmse_judged",
        )
        rows = self._found["candidates"]
        return _frames.make({name: [row[name] for row in rows] for name in names}, self._library)

    @property
    def baseline(self) -> Baseline:
        """The errors of the law alone."""
        found = self._found["baseline"]
        return Baseline(
            nrmse_fitted=found["nrmse_fitted"],
            nrmse_held_out=found["nrmse_held_out"],
            law=found["law"],
            known=tuple(found["known"]),
        )

    @property
    def augmented(self) -> Errors:
        """The errors of `model`, the augmented model in f64."""
        found = self._found["augmented"]
        return Errors(found["nrmse_fitted"], found["nrmse_held_out"])

    @property
    def on_target(self) -> Errors:
        """The errors of the augmented model in f32, as in firmware."""
        return Errors(None, self._found["on_target"]["nrmse_held_out"])

    @property
    def noise_floor(self) -> float:
        """The noise of the measured force over the RMS of the force."""
        return float(self._found["noise_floor_nrmse"])

    @property
    def adopted(self) -> bool:
        """Whether `model` contains the effects found; otherwise it is the law alone."""
        return bool(self._found["adopted"])

    @property
    def depends_on(self) -> list[str]:
        """The quantities on which the residual of the law depends."""
        return list(self._found["depends_on"])

    @property
    def remainder(self) -> dict[str, Any] | None:
        """The residual of the augmented model beyond the noise; `None` if there is none."""
        remainder: dict[str, Any] | None = self._found["remainder"]
        return remainder

    @property
    def separating_test(self) -> str | None:
        """The test that would distinguish the candidates, if the verdict is `ambiguous`."""
        test: str | None = self._found["separating_test"]
        return test

    @property
    def warnings(self) -> list[str]:
        """Problems of the recordings, as sentences."""
        return list(self._found["warnings"])

    @property
    def model(self) -> dict[str, Any]:
        """The contents of model.json."""
        model: dict[str, Any] = json.loads(self._core.model.to_json())
        return model

    def series(self, recording: int = 0) -> Any:
        """Return motion and forces of a recording as a data frame.

        Its columns are `time_s`, `displacement_mm`, `velocity_mm_s` and `force_kN`, `before_kN` (force of the law alone),
        `after_kN` (force of the augmented model), and `measured`, which is false for a sample with a channel fault.
        """
        series = self._series(recording)
        names = {
            "time_s": "time",
            "displacement_mm": "displacement",
            "velocity_mm_s": "velocity",
            "force_kN": "force",
            "before_kN": "before",
            "after_kN": "after",
            "measured": "measured",
        }
        return _frames.make({column: series[name] for column, name in names.items()}, self._library)

    def to_json(self) -> str:
        """Return the contents of trace.json, as `hil trace` writes it."""
        return self._json

    def to_dict(self) -> dict[str, Any]:
        """Return the contents of trace.json as a dictionary."""
        found: dict[str, Any] = json.loads(self._json)
        return found

    @property
    def law(self) -> DamperLaw:
        """The model as a fitted `DamperLaw`, to predict, score and save."""
        from ._law import DamperLaw

        return DamperLaw.of(self)

    def plot(
        self,
        kind: Literal["all", "loop", "residual"] = "all",
        *,
        recording: int = 0,
        block: int | None = None,
        ax: Any = None,
    ) -> Any:
        """Plot the loop of a block (measured, law alone, augmented model), and both residuals over time, as a matplotlib figure.

        By default, `block` is the block with the largest error of the law alone. `ax` is the axes for the kinds `loop` and `residual`.
        """
        from ._plot import traced

        series = self._series(recording)
        noise = self.noise_floor * float(np.sqrt(np.mean(np.square(series["force"]))))
        return traced(series, kind, block, ax, noise)

    def report(self, path: str | os.PathLike[str] | None = None) -> Report:
        """Return the report of `hil trace`; a notebook shows it. With `path`, also write it to that file."""
        report = Report(self._core.report())
        if path is not None:
            report.save(path)
        return report

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Write trace.json, model.json and report.html into `folder`, as `hil trace --out` does: all of them or none."""
        files = {"trace.json": self._json, "model.json": self._core.model.to_json(), "report.html": self._core.report()}
        _core.write_files([(Path(folder) / name, text) for name, text in files.items()])

    def __repr__(self) -> str:
        heading, _ = self._core.verdict_in_words()
        lines = [f"Trace: {heading}"]
        for effect in self._found["effects"]:
            for name, estimate in effect["parameters"].items():
                low, value, high = interval(estimate["low"], estimate["value"], estimate["high"])
                lines.append(f"  {effect['family']} {name} = {value} ({low} … {high}) {unit_in_words(estimate['unit'])}".rstrip())
        lines.append(
            f"  error of the force, held out: law alone {percent(self.baseline.nrmse_held_out)}, "
            f"augmented model {percent(self.augmented.nrmse_held_out)}, noise {percent(self.noise_floor)}"
        )
        return "\n".join(lines + [f"  note: {text}" for text in [*self.assumed, *self.warnings]])

    def _repr_html_(self) -> str:
        from ._html import trace as page

        return page(self)

    def _series(self, recording: int) -> dict[str, Any]:
        every = self._core.series()
        if not isinstance(recording, (int, np.integer)) or not -len(every) <= recording < len(every):
            raise InputError(f"recording: there is no recording {recording!r}; give 0 to {len(every) - 1}")
        return every[recording]

    def _effects(self, effects: list[dict[str, Any]]) -> Any:
        rows = [
            (
                effect["family"],
                name,
                estimate["value"],
                -math.inf if estimate["low"] is None else estimate["low"],
                math.inf if estimate["high"] is None else estimate["high"],
                estimate["unit"],
                effect["nrmse_without"],
                effect["nrmse_with"],
            )
            for effect in effects
            for name, estimate in effect["parameters"].items()
        ]
        names = ("family", "parameter", "value", "low", "high", "unit", "nrmse_without", "nrmse_with")
        return _frames.make({name: [row[place] for row in rows] for place, name in enumerate(names)}, self._library)


class Report:
    """A report: a self-contained HTML page. A notebook shows it."""

    def __init__(self, html: str) -> None:
        #: The HTML of the page.
        self.html = html

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page to a file, completely or not at all."""
        _core.write_files([(path, self.html)])

    def __str__(self) -> str:
        return self.html

    def __repr__(self) -> str:
        return f"Report of {len(self.html) // 1024} KiB; save(path) writes it"

    def _repr_html_(self) -> str:
        from ._html import framed

        return framed(self.html, 640)


def trace(
    data: RecordingLike = None,
    *,
    time: ChannelLike | float | None = None,
    displacement: ChannelLike | None = None,
    force: ChannelLike | None = None,
    velocity: ChannelLike | None = None,
    temperature: ChannelLike | None = None,
    inputs: Inputs = None,
    held_out: RecordingLike = None,
    units: Units = None,
    table: str | None = None,
    decimal: Decimal | None = None,
    families: Sequence[str] = (),
    exclude: Sequence[str] = (),
    baseline: str = "mixed",
    law: Any = None,
    fixture_mass: float | None = None,
    force_delay: float | None = None,
    zero: Zero | None = None,
    adopt: bool = False,
    title: str | None = None,
    max_read: int | None = None,
    progress: Callable[[str], object] | None = None,
) -> Trace:
    """Find effects in recordings of one specimen that the law does not contain.

    `data` is a path, a pandas or polars data frame, a mapping of columns, a NumPy record array, or a list of these. Without `data`, give
    `time`, `displacement` and `force` as arrays.

    The columns of a file or a frame are found by their names, such as `force_kN`, `Force (lbf)` or `Prüfkraft [N]`, as in `hil trace`. If
    the meaning of a column is not certain, a `GuessWarning` states how it was read. `time=`, `displacement=`, `force=`, `velocity=` and
    `temperature=` name the columns, or are arrays. `time` may also be the time between samples. A unit comes from the column's name or from
    `units`. If a column of a frame or an array has no unit, s, mm and kN are assumed, with a `UnitWarning`.

    `inputs` names the control inputs, such as `["current_A"]`. By default, all columns with the name of a control input are used.

    `table` names the sheet, group or table to read, if a file has several. `decimal` is the decimal sign of the numbers in a text file,
    `point` or `comma`, if both are possible.

    `held_out` are recordings that are never fitted. By default, the last cycles of each block and one whole block are held out.

    `families` and `exclude` restrict the families that are tried. `baseline` is the law without effects: `mixed`, `linear` or `none`.
    `law` is a model with known effects.

    `fixture_mass` is the mass in kg that moves between the specimen and the load cell, and `force_delay` the time in s by which the
    recorded force is late, negative if it is early. `zero` says where the displacement of the specimen is 0: at the `mean` of the recorded
    displacement, at its value at the `start`, or at the recorded zero (`none`). What is given is known, and is not fitted.

    `adopt` puts effects or a residual table into the model even if conditions left out do not show that they are better than the law alone.

    `progress` is called with a sentence at each step. Ctrl-C ends a trace.

    Raises `InputError`, a `ValueError`, for invalid input.
    """
    channels: dict[str, ChannelLike | float | None] = {
        "time": time,
        "displacement": displacement,
        "force": force,
        "velocity": velocity,
        "temperature": temperature,
    }
    given = Given(channels=channels, inputs=inputs, units=units, table=table, decimal=decimal, max_read=max_read)
    given.check_for_files(data, held_out)
    recordings = given.recordings(data, "recording")
    if not recordings:
        raise InputError("trace: there is no recording; give a path, a data frame, or time=, displacement= and force=")
    held = [] if held_out is None else given.by_names().recordings(held_out, "held-out recording")
    _core.refuse_repeats(_paths(data) + _paths(held_out))
    given.warn(stacklevel=2)
    names = [os.path.basename(each.name) for each in recordings]
    core = _core.trace(
        title or f"Trace of {', '.join(names)}",
        recordings,
        held,
        [families] if isinstance(families, str) else list(families),
        [exclude] if isinstance(exclude, str) else list(exclude),
        baseline,
        None if law is None else model_of(law),
        (fixture_mass, force_delay, zero),
        progress,
        adopt,
    )
    return Trace(core, given.notes(), given.library)


def model_of(law: Any) -> _core.Model:
    """Return the model of a path, a trace, a fitted law, or the contents of a model.json."""
    if isinstance(law, _core.Model):
        return law
    if isinstance(law, Trace):
        return law._core.model
    if isinstance(law, (str, os.PathLike)):
        return _core.Model.read(law)
    if isinstance(law, dict):
        return _core.Model.of_json(json.dumps(law))
    model = getattr(law, "_model", None)
    if callable(model):
        found = model()
        if isinstance(found, _core.Model):
            return found
    raise InputError(f"{type(law).__name__} is no model; give the path of a model.json, a trace or a fitted DamperLaw")


def _paths(data: RecordingLike) -> list[str]:
    each = data if isinstance(data, (list, tuple)) else [data]
    return [os.fspath(one) for one in each if isinstance(one, (str, os.PathLike))]
