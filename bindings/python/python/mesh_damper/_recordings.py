"""What a caller gives as a recording, as the core takes it."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core, _frames
from ._errors import InputError, UnitWarning
from ._frames import Array, Library

#: A path, a data frame, a mapping of columns, a NumPy record array, or a list of these.
RecordingLike = Any
#: The name of a column, or the column itself.
ChannelLike = str | npt.ArrayLike
#: A unit for each channel, such as ``{"force": "N"}``; or ``"SI"`` for s, m and N, or ``"mm-kN-s"``.
Units = Mapping[str, str] | str | None
#: Names of columns that are control inputs; or by such names other columns or the values.
Inputs = Sequence[str] | Mapping[str, ChannelLike] | None

#: The units of each channel, as a column's name carries them.
UNITS: dict[str, list[str]] = dict(_core.units())
#: The unit that is assumed where nothing says which.
ASSUMED = {"time": "s", "displacement": "mm", "force": "kN", "velocity": "mm_s", "temperature": "degC"}
_SYSTEMS = {
    "SI": {"time": "s", "displacement": "m", "force": "N", "velocity": "m_s", "temperature": "degC"},
    "mm-kN-s": ASSUMED,
}
#: Other ways to write a unit's symbol.
_SPELLINGS = {"sec": "s", "seconds": "s", "µm": "um", "μm": "um", "inch": "in", "°C": "degC", "C": "degC"}
_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]$")


@dataclass
class Given:
    """How the channels of a caller's recordings are called, and in which units they are."""

    channels: dict[str, ChannelLike | float | None] = field(default_factory=dict)
    inputs: Inputs = None
    units: Units = None
    needs_force: bool = True
    max_read: int | None = None
    #: The unit that was assumed of each channel, and what says none.
    assumed: dict[str, tuple[str, str]] = field(default_factory=dict)
    #: The library of the first frame that was given.
    library: Library | None = None

    def recordings(self, data: RecordingLike, what: str) -> list[_core.Recording]:
        """Each of `data`, called by its path, or by `what` and a number."""
        if data is None and not any(channel is not None for channel in self.channels.values()):
            return []
        several = isinstance(data, (list, tuple))
        each = list(data) if several else [data]
        names = [f"{what} {number}" for number in range(1, len(each) + 1)] if len(each) > 1 else [what]
        return [self.recording(one, name) for one, name in zip(each, names)]

    def recording(self, data: RecordingLike, name: str) -> _core.Recording:
        """One of them."""
        if isinstance(data, _core.Recording):
            return data
        if isinstance(data, (str, os.PathLike)):
            return self._file(os.fspath(data))
        self.library = self.library or _frames.library_of(data)
        columns, inputs = _Columns(self, data, name).named()
        made = _core.Recording.of_columns(name, columns, self.needs_force)
        there = {column for column, _ in made.columns()}
        for missing in inputs:
            if missing not in there:
                raise InputError(
                    f"{name}: column {missing}: its name is not that of a control input, which ends in a unit; "
                    f'give it one, as inputs={{"current_A": {missing!r}}}'
                )
        return made

    def by_names(self) -> Given:
        """The same for other recordings: arrays are of the one that they were given for."""
        kept: dict[str, ChannelLike | float | None] = {
            name: channel for name, channel in self.channels.items() if isinstance(channel, (str, int, float))
        }
        return replace(self, channels=kept)

    def columns(self, data: Any, name: str) -> list[tuple[str, Array]]:
        """The columns of a frame or of arrays under the names that a file would have them under."""
        self.library = self.library or _frames.library_of(data)
        columns, _ = _Columns(self, data, name).named()
        return columns

    def assumptions(self) -> list[str]:
        """What was assumed, in sentences."""
        if not self.assumed:
            return []
        said = ", ".join(f"{unit.replace('_s', '/s')} for {what}" for what, unit in self.assumed.values())
        given = ", ".join(f'"{channel}": "{unit}"' for channel, (_, unit) in self.assumed.items())
        return [f"no unit is said, and assumed is {said}; say it with units={{{given}}}, or as it is"]

    def say_assumed(self, stacklevel: int) -> None:
        """Warns of what was assumed."""
        for sentence in self.assumptions():
            warnings.warn(sentence, UnitWarning, stacklevel=stacklevel + 1)

    def unit_of(self, channel: str) -> str | None:
        """What `units` says of a channel."""
        units = self.units
        if units is None:
            return None
        if isinstance(units, str):
            if units not in _SYSTEMS:
                raise InputError(f'units: no system is called {units!r}; give "SI", "mm-kN-s" or a unit for each channel')
            return _SYSTEMS[units][channel]
        for key in units:
            if key not in UNITS:
                raise InputError(f"units: no channel is called {key!r}; give {', '.join(UNITS)}")
        unit = units.get(channel)
        return None if unit is None else _known(unit, channel, "units")

    def _file(self, path: str) -> _core.Recording:
        """Of a file, as the options of the command say what is in it."""
        channels, units, rate = [], [], None
        for channel, source in self.channels.items():
            if channel == "time" and isinstance(source, (int, float)) and not isinstance(source, bool):
                rate = self._rate(path, float(source))
            elif isinstance(source, str):
                channels.append((channel, source))
            elif source is not None:
                raise InputError(f"{path}: {channel}= is no name of a column; give one, or all channels as arrays and no path")
            if (unit := self.unit_of(channel)) is not None and not (channel == "time" and rate):
                if isinstance(self.units, str) and channel not in ("time", "displacement", "force"):
                    continue
                units.append((channel, unit))
        if isinstance(self.inputs, Mapping):
            for name, source in self.inputs.items():
                quantity, _, unit = name.rpartition("_")
                if not isinstance(source, str) or not quantity:
                    raise InputError(f'{path}: input {name}: give the name of a column, as inputs={{"current_A": "I coil"}}')
                channels.append((quantity, source))
                units.append((quantity, unit))
        inputs = None if self.inputs is None else ([self.inputs] if isinstance(self.inputs, str) else list(self.inputs))
        return _core.Recording.read(path, self.max_read, channels, units, rate, inputs)

    def _rate(self, path: str, step: float) -> float:
        """Samples a second of a time between two."""
        unit = self.unit_of("time") or "s"
        if unit not in ("s", "ms") or not (np.isfinite(step) and step > 0):
            raise InputError(f"{path}: time={step:g}: is no time between samples in s or ms; give one above 0")
        if self.unit_of("time") is None:
            self.assumed["time"] = ("time=", "s")
        return (1.0 if unit == "s" else 1e3) / step


class _Columns:
    """The columns of one recording that are used."""

    def __init__(self, given: Given, data: Any, name: str) -> None:
        self.given = given
        self.data = data
        self.name = name
        names = [] if data is None else _frames.column_names(data)
        if names is None:
            raise InputError(
                f"{name}: {type(data).__name__} is no recording; give a path, a data frame, a mapping of columns, or "
                "time=, displacement= and force= as arrays"
            )
        self.names: list[str] = names

    def named(self) -> tuple[list[tuple[str, Array]], list[str]]:
        """The columns under the names that a file would have them under, and those of them that must be control inputs."""
        columns: list[tuple[str, Array]] = []
        used: set[str] = set()
        time: ChannelLike | float | None = None
        for channel in UNITS:
            chosen = self.given.channels.get(channel)
            if channel == "time" and isinstance(chosen, (int, float)) and not isinstance(chosen, bool):
                time = chosen
                continue
            source = self._find(channel) if chosen is None else chosen
            if source is None:
                continue
            if isinstance(source, str):
                used.add(source)
            columns.append(self._channel(channel, source))
        if time is not None:
            columns.insert(0, self._even(float(np.asarray(time)), columns))
        taken = {name for name, _ in columns}
        if self.given.inputs is None:
            # As in a file: the core knows by its name what is a control input.
            others = [name for name in self.names if name not in used and _channel_of(name) is None]
            columns += [(name, values) for name in others if (values := self._numbers(name)) is not None]
            return columns, []
        inputs = self.given.inputs
        pairs = list(inputs.items()) if isinstance(inputs, Mapping) else [(name, name) for name in _listed(inputs)]
        for name, source in pairs:
            if name in taken:
                raise InputError(f"{self.name}: column {name}: is a channel and no control input; leave it out of inputs=")
            columns.append((name, self._values(name, source)))
        return columns, [name for name, _ in pairs]

    def _find(self, channel: str) -> str | None:
        """The column whose name is the channel's."""
        found = [name for name in self.names if _channel_of(name) == channel]
        if len(found) > 1:
            raise InputError(f"{self.name}: {' and '.join(found)} are both a {channel}; say which, as {channel}={found[0]!r}")
        if found:
            return found[0]
        index = getattr(self.data, "index", None)
        kind = getattr(getattr(index, "dtype", None), "kind", "")
        return _INDEX if channel == "time" and kind in ("M", "m") else None

    def _channel(self, channel: str, source: ChannelLike) -> tuple[str, Array]:
        said = self.given.unit_of(channel)
        in_name = _unit_in(source, channel, self.name) if isinstance(source, str) and source != _INDEX else None
        if isinstance(source, str) and said and in_name and said != in_name:
            raise InputError(f"{self.name}: column {source}: its name says {in_name}, and units= says {said}; give one of them")
        values = self._raw(channel, source)
        if channel == "time" and (seconds := _frames.seconds(values)) is not None:
            return "time_s", seconds
        unit = said or in_name
        if unit is None:
            unit = ASSUMED[channel]
            self.given.assumed[channel] = (f"column {source}" if isinstance(source, str) else f"{channel}=", unit)
        return f"{channel}_{unit}", _frames.to_array(values, f"{self.name}: {channel}")

    def _even(self, step: float, columns: list[tuple[str, Array]]) -> tuple[str, Array]:
        """Times that are `step` apart, which is in the unit of time."""
        if not (np.isfinite(step) and step > 0):
            raise InputError(f"{self.name}: time={step:g}: is no time between samples; give one above 0, or the samples' times")
        if not columns:
            raise InputError(f"{self.name}: there is a time and nothing else; give displacement= and force=")
        unit = self.given.unit_of("time")
        if unit is None:
            unit = "s"
            self.given.assumed["time"] = ("time=", unit)
        return f"time_{unit}", step * np.arange(len(columns[0][1]), dtype=np.float64)

    def _raw(self, what: str, source: ChannelLike) -> Any:
        if not isinstance(source, str):
            return source if hasattr(source, "dtype") else np.asarray(source)
        if source == _INDEX:
            return self.data.index
        if source in self.names:
            return _frames.column(self.data, source)
        if getattr(getattr(self.data, "index", None), "name", None) == source:
            return self.data.index
        shown = ", ".join(repr(name) for name in self.names[:12]) + (", …" if len(self.names) > 12 else "")
        raise InputError(f"{self.name}: there is no column {source!r} for {what}=; found {shown or 'none'}")

    def _values(self, what: str, source: ChannelLike) -> Array:
        return _frames.to_array(self._raw(what, source), f"{self.name}: {what}")

    def _numbers(self, name: str) -> Array | None:
        """A column that nobody named, where it holds numbers."""
        try:
            return self._values(name, name)
        except InputError:
            return None


#: Stands for a frame's index of dates.
_INDEX = "\0index"


def _listed(names: Sequence[str]) -> list[str]:
    return [names] if isinstance(names, str) else list(names)


def _channel_of(name: str) -> str | None:
    """The channel that a column's name says: `force_kN`, `force`, `Force (kN)`."""
    bracketed = _BRACKETS.match(name)
    if bracketed and bracketed["name"].strip().casefold() in UNITS:
        return bracketed["name"].strip().casefold()
    for channel, units in UNITS.items():
        if name.casefold() == channel:
            return channel
        rest = name.removeprefix(f"{channel}_")
        # A further word between the two makes it another column, as in a file.
        if rest != name and (rest in units or "_" not in rest):
            return channel
    return None


def _unit_in(name: str, channel: str, where: str) -> str | None:
    """The unit that a column's name says."""
    bracketed = _BRACKETS.match(name)
    if bracketed:
        return _known(bracketed["unit"].strip(), channel, f"{where}: column {name}")
    if name.casefold() == channel:
        return None
    rest = name.removeprefix(f"{channel}_")
    if rest != name:
        return _known(rest, channel, f"{where}: column {name}")
    # A column that the caller named may end in a unit.
    for unit in UNITS[channel]:
        if name.endswith(f"_{unit}"):
            return unit
    return None


def _known(unit: str, channel: str, where: str) -> str:
    unit = _SPELLINGS.get(unit, unit)
    if unit not in UNITS[channel]:
        raise InputError(f"{where}: unknown unit {unit!r} of {channel}; use one of {', '.join(UNITS[channel])}")
    # One unit has two spellings, with _ and with /.
    return unit.replace("/", "_")
