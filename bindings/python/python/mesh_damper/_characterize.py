"""Stiffness and loss factor of a recording."""

from __future__ import annotations

import json
from typing import Any, Literal

import numpy as np

from . import _core, _frames
from ._errors import InputError
from ._frames import Library
from ._recordings import ChannelLike, Decimal, Given, RecordingLike, Units


class Characterization:
    """Stiffness and loss factor of each cycle, returned by `characterize`."""

    def __init__(self, text: str, loops: list[Any], library: Library | None) -> None:
        self._json = text
        self._found: dict[str, Any] = json.loads(text)
        self._loops = loops
        self._library = library

    @property
    def kind(self) -> str:
        """The kind of test: `static` or `dynamic`."""
        return str(self._found["kind"])

    @property
    def cycles(self) -> Any:
        """A row for each cycle, as a data frame. In a dynamic test, `block` is the number of its block, counted from 0."""
        if self.kind == "static":
            return self._frame(self._found["cycles"])
        blocks = enumerate(self._found["blocks"])
        return self._frame([{"block": number, **cycle} for number, block in blocks for cycle in block["cycles"]])

    @property
    def blocks(self) -> Any:
        """Dynamic test: the averaged cycle of each block, with mean and deviation of its steady cycles. Static test: the means."""
        if self.kind == "static":
            return self._frame([_spreads(self._found, ("equivalent_stiffness", "loss_factor"))])
        return self._frame(
            [
                {
                    "frequency": block["frequency"],
                    **block["averaged"],
                    **_spreads(block, ("stiffness", "loss_factor")),
                    "low_stiffness": block["stiffness_interval"][0],
                    "high_stiffness": block["stiffness_interval"][1],
                }
                for block in self._found["blocks"]
            ]
        )

    @property
    def notes(self) -> list[str]:
        """Corrections of the recording and its peculiarities, as sentences."""
        return list(self._found["notes"])

    def to_json(self) -> str:
        """The JSON that `hil characterize --json` writes."""
        return self._json

    def plot(self, number: int = 0, ax: Any = None) -> Any:
        """Plot the loop of a cycle (static) or of a block (dynamic) as a matplotlib figure."""
        from ._plot import characterized

        if not -len(self._loops) <= number < len(self._loops):
            raise InputError(f"number: there is no loop {number}; give 0 to {len(self._loops) - 1}")
        measured, line = (np.asarray(points).reshape(-1, 2) for points in self._loops[number])
        return characterized(measured, line, "middle line" if self.kind == "static" else "averaged cycle", ax)

    def __repr__(self) -> str:
        number = len(self._loops)
        what = "load–unload cycle" if self.kind == "static" else "block"
        return f"Characterization: {self.kind}, {number} {what}{'' if number == 1 else 's'}"

    def _repr_html_(self) -> str:
        from ._html import characterization

        return characterization(self)

    def _frame(self, rows: list[dict[str, Any]]) -> Any:
        flat = [{name: value for key, entry in row.items() for name, value in _flat(key, entry)} for row in rows]
        return _frames.make({name: [row[name] for row in flat] for name in (flat[0] if flat else {})}, self._library)


def _spreads(found: dict[str, Any], names: tuple[str, ...]) -> dict[str, float]:
    spreads = {}
    for name in names:
        spreads[f"mean_{name}"] = found[name]["mean"]
        deviation = found[name]["deviation"]
        spreads[f"deviation_{name}"] = np.nan if deviation is None else deviation
    return spreads


def _flat(name: str, entry: Any) -> list[tuple[str, Any]]:
    """Give each entry of a list its own column."""
    if isinstance(entry, list):
        return [(f"{name}_{place}", value) for place, value in enumerate(entry)]
    return [(name, np.nan if entry is None else entry)]


def characterize(
    data: RecordingLike = None,
    *,
    kind: Literal["static", "dynamic"] = "dynamic",
    time: ChannelLike | float | None = None,
    displacement: ChannelLike | None = None,
    force: ChannelLike | None = None,
    fixture_mass: float | None = None,
    force_delay: float | None = None,
    units: Units = None,
    table: str | None = None,
    decimal: Decimal | None = None,
    max_read: int | None = None,
) -> Characterization:
    """Compute stiffness and loss factor of a recording, as `hil characterize` does.

    `kind` is `static` for load–unload curves, or `dynamic` for cycles. The recording, its units, `table`, `decimal` and
    `max_read` are given as for `trace`. `fixture_mass` is the mass in kg that moves between the specimen and the load cell, and
    `force_delay` the time in s by which the recorded force is late; both are taken out of the force.
    """
    if kind not in ("static", "dynamic"):
        raise InputError(f"kind: no kind is called {kind!r}; give static or dynamic")
    channels: dict[str, ChannelLike | float | None] = {"time": time, "displacement": displacement, "force": force}
    given = Given(channels=channels, units=units, table=table, decimal=decimal, max_read=max_read)
    given.check_for_files(data)
    recordings = given.recordings(data, "recording")
    if len(recordings) != 1:
        raise InputError(f"characterize: {len(recordings)} recordings are given; give one")
    given.warn(stacklevel=2)
    text, loops = _core.characterize(recordings[0], kind == "static", (fixture_mass, force_delay, None))
    return Characterization(text, loops, given.library)
