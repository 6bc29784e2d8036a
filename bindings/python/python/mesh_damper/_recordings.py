"""Pass a user's recording to the core. The core decides the channel and the unit of each column."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from . import _core, _frames
from ._errors import GuessWarning, InputError, UnitWarning
from ._frames import Array, Library

#: A path, a data frame, a mapping of columns, a NumPy record array, or a list of these.
RecordingLike = Any
#: The name of a column, or the column itself.
ChannelLike = str | npt.ArrayLike
#: A unit for each channel, such as ``{"force": "N"}``; or ``"SI"`` for s, m and N, or ``"mm-kN-s"``.
Units = Mapping[str, str] | str | None
#: Names of control-input columns; or a mapping from such names to other columns or to values.
Inputs = Sequence[str] | Mapping[str, ChannelLike] | None
#: The name of the decimal sign of a text.
Decimal = Literal["point", "comma"]
#: Where the displacement of a specimen is 0.
Zero = Literal["mean", "start", "none"]
#: A column for the core: name; values, or the reason why they are not numbers; whether they are dates or durations; whether it is the index
#: of its frame.
Column = tuple[str, Array | str, bool, bool]

_Read = TypeVar("_Read", _core.Recording, _core.Drive)


@dataclass
class Given:
    """The names and units of the channels of a user's recordings."""

    channels: dict[str, ChannelLike | float | None] = field(default_factory=dict)
    inputs: Inputs = None
    units: Units = None
    table: str | None = None
    decimal: Decimal | None = None
    needs_force: bool = True
    max_read: int | None = None
    #: Assumed units, as sentences.
    assumed: list[str] = field(default_factory=list)
    #: Guesses about the meaning of columns, as sentences.
    guesses: list[str] = field(default_factory=list)
    #: The library of the first given frame.
    library: Library | None = None

    def recordings(self, data: RecordingLike, what: str) -> list[_core.Recording]:
        """Return each recording of `data`, named by its path or by `what` with a number."""
        if data is None and not any(channel is not None for channel in self.channels.values()):
            return []
        several = isinstance(data, (list, tuple))
        each = list(data) if several else [data]
        names = [f"{what} {number}" for number in range(1, len(each) + 1)] if len(each) > 1 else [what]
        return [self.recording(one, name) for one, name in zip(each, names)]

    def recording(self, data: RecordingLike, name: str) -> _core.Recording:
        """Return one recording."""
        if isinstance(data, _core.Recording):
            return data
        if isinstance(data, (str, os.PathLike)):
            return self._heard(_core.Recording.read(data, self._reading_of_file(os.fspath(data))))
        return self._heard(_core.Recording.of_columns(name, self._columns(data, name), self.reading()))

    def drive(self, data: RecordingLike, name: str, is_force: bool) -> _core.Drive:
        """Return the channel that excites the mass, with its times."""
        if isinstance(data, (str, os.PathLike)):
            return self._heard(_core.Drive.read(data, self._reading_of_file(os.fspath(data)), is_force))
        return self._heard(_core.Drive.of_columns(name, self._columns(data, name), self.reading(), is_force))

    def by_names(self) -> Given:
        """Return the same settings for other recordings, without the arrays of the first recording."""
        kept: dict[str, ChannelLike | float | None] = {
            name: channel for name, channel in self.channels.items() if isinstance(channel, str) or _is_step(name, channel)
        }
        # Notes about them are added to those of the first recording.
        return replace(self, channels=kept)

    def notes(self) -> list[str]:
        """Return the assumptions and guesses as sentences."""
        return [*self.assumed, *self.guesses]

    def warn(self, stacklevel: int) -> None:
        """Warn about the assumptions and guesses."""
        for sentences, category in ((self.assumed, UnitWarning), (self.guesses, GuessWarning)):
            for sentence in sentences:
                warnings.warn(sentence, category, stacklevel=stacklevel + 1)

    def check_for_files(self, *data: RecordingLike) -> None:
        """Refuse settings that only a file needs if none of `data` is one: they would have no effect."""
        if _has_file(data):
            return
        for argument, value, what in (("table", self.table, "several tables"), ("decimal", self.decimal, "numbers as text")):
            if value is not None:
                raise InputError(f"{argument}: no recording is a file, and only a file has {what}; leave {argument}= out")

    def reading(self, is_of_file: bool = False) -> _core.Reading:
        """Return the user's settings in the form of the command's options."""
        channels = [(channel, _name_of(channel, source)) for channel, source in self._sources()]
        units = list(self.units.items()) if isinstance(self.units, Mapping) else []
        inputs: list[str] | None = None
        if isinstance(self.inputs, Mapping):
            for name, source in self.inputs.items():
                quantity, _, unit = name.rpartition("_")
                channels.append((quantity or name, _name_of(name, source)))
                units += [(quantity, unit)] if quantity else []
        if self.inputs is not None:
            inputs = [self.inputs] if isinstance(self.inputs, str) else list(self.inputs)
        return _core.Reading(
            channels=channels,
            units=units,
            system=self.units if isinstance(self.units, str) else None,
            step=self._step(),
            # Columns in memory, such as held-out ones of a file's, are one table without a name.
            table=self.table if is_of_file else None,
            decimal=self.decimal,
            inputs=inputs,
            max_read=self.max_read,
            needs_force=self.needs_force,
        )

    def _reading_of_file(self, path: str) -> _core.Reading:
        inputs = self.inputs if isinstance(self.inputs, Mapping) else {}
        for channel, source in [*self._sources(), *inputs.items()]:
            if not isinstance(source, str):
                raise InputError(f"{path}: {channel}= is no name of a column; give one, or all channels as arrays and no path")
        return self.reading(is_of_file=True)

    def _sources(self) -> list[tuple[str, ChannelLike]]:
        """Return the given channels, each as a column's name or as values."""
        given = self.channels.items()
        return [(channel, source) for channel, source in given if source is not None and not _is_step(channel, source)]

    def _step(self) -> float | None:
        time = self.channels.get("time")
        return float(np.asarray(time)) if _is_step("time", time) else None

    def _columns(self, data: Any, name: str) -> list[Column]:
        """Return the columns given as values, and the columns of a frame."""
        self.library = self.library or _frames.library_of(data)
        names = [] if data is None else _frames.column_names(data)
        if names is None:
            raise InputError(
                f"{name}: {type(data).__name__} is no recording; give a path, a data frame, a mapping of columns, or "
                "time=, displacement= and force= as arrays"
            )
        inputs = self.inputs.items() if isinstance(self.inputs, Mapping) else ()
        sources = [*self._sources(), *inputs]
        arrays = [(_name_of(of, source), source) for of, source in sources if not isinstance(source, str)]
        columns = [_column(of, source) for of, source in arrays]
        columns += [_column(of, _frames.column(data, of)) for of in names]
        if (index := _frames.index(data)) is not None and index[0] not in names:
            columns.append(_column(*index, is_index=True))
        return columns

    def _heard(self, read: _Read) -> _Read:
        """Store the core's assumptions and guesses about the recording."""
        if (assumed := read.assumed()) is not None:
            self.assumed.append(f"{read.name}: {assumed}")
        if self._step() is not None and self.reading().scale("time") is None:
            self.assumed.append(f"{read.name}: no unit is given for time=, so s is assumed; give its unit")
        self.guesses += [f"{read.name}: {guess}" for guess in read.guesses()]
        return read


def _is_step(channel: str, source: object) -> bool:
    """Return whether `source` is the time between samples, not a column."""
    return channel == "time" and isinstance(source, (int, float, np.number)) and not isinstance(source, bool)


def _has_file(data: object) -> bool:
    """Return whether `data` is a path, or holds one."""
    return isinstance(data, (str, os.PathLike)) or (isinstance(data, (list, tuple)) and any(map(_has_file, data)))


def _name_of(argument: str, source: ChannelLike) -> str:
    """Return the name of a column. Values are named by their argument."""
    return source if isinstance(source, str) else f"{argument}="


def _column(name: str, values: Any, is_index: bool = False) -> Column:
    try:
        values = values if hasattr(values, "dtype") else np.asanyarray(values)
        if (seconds := _frames.seconds(values)) is not None:
            return (name, seconds, True, is_index)
        return (name, _frames.numbers(values), False, is_index)
    except ValueError as error:
        return (name, str(error), False, is_index)
