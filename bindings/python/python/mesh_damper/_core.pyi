"""The compiled part: the functions of the Rust crates, with arrays and strings."""

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "BatchSettings",
    "Drive",
    "Model",
    "Reading",
    "Recording",
    "Trace",
    "__version__",
    "characterize",
    "compare_models",
    "export",
    "identity",
    "outcome",
    "outcomes_of",
    "recordings_in",
    "refuse_repeats",
    "respond",
    "simulate",
    "sweep",
    "trace",
    "trace_many",
    "write_files",
]

__version__: str

#: A column: name; values, or the reason why they are not numbers; whether they are dates or durations; whether it is the frame's index.
_Column: TypeAlias = tuple[str, npt.NDArray[np.float64] | str, bool, bool]

_Decimal: TypeAlias = Literal["point", "comma"]

@final
class Reading:
    def __new__(
        cls,
        channels: Sequence[tuple[str, str]] = ...,
        units: Sequence[tuple[str, str]] = ...,
        system: str | None = None,
        step: float | None = None,
        rate: float | None = None,
        table: str | None = None,
        decimal: _Decimal | None = None,
        inputs: Sequence[str] | None = None,
        max_read: int | None = None,
        needs_force: bool = True,
    ) -> Reading: ...
    def scale(self, channel: str) -> float | None: ...

@final
class Recording:
    @staticmethod
    def read(path: str | PathLike[str], reading: Reading) -> Recording: ...
    @staticmethod
    def of_columns(name: str, columns: Sequence[_Column], reading: Reading) -> Recording: ...
    @property
    def name(self) -> str: ...
    def guesses(self) -> list[str]: ...
    def assumed(self) -> str | None: ...
    def __len__(self) -> int: ...
    def rows(self) -> npt.NDArray[np.int64]: ...
    def columns(self) -> list[tuple[str, npt.NDArray[np.float64]]]: ...

@final
class Trace:
    @property
    def model(self) -> Model: ...
    def to_json(self) -> str: ...
    def report(self) -> str: ...
    def verdict_in_words(self) -> tuple[str, str]: ...
    def series(self) -> list[dict[str, Any]]: ...

@final
class Model:
    @staticmethod
    def read(path: str | PathLike[str]) -> Model: ...
    @staticmethod
    def of_json(text: str) -> Model: ...
    @property
    def identity(self) -> str: ...
    def to_json(self) -> str: ...
    def predict(
        self, recording: Recording, has_force: bool, is_embedded: bool, controls: Sequence[tuple[str, float]]
    ) -> tuple[npt.NDArray[np.float64], list[str]]: ...
    def write(self, path: str | PathLike[str]) -> None: ...

@final
class Drive:
    @staticmethod
    def read(path: str | PathLike[str], reading: Reading, is_force: bool) -> Drive: ...
    @staticmethod
    def of_columns(name: str, columns: Sequence[_Column], reading: Reading, is_force: bool) -> Drive: ...
    @property
    def name(self) -> str: ...
    def guesses(self) -> list[str]: ...
    def assumed(self) -> str | None: ...

@final
class BatchSettings:
    def __new__(
        cls,
        reading: Reading,
        families: Sequence[str],
        exclude: Sequence[str],
        baseline: str,
        law: Model | None = None,
        rig: tuple[float | None, float | None, str | None] | None = None,
        reports: bool = False,
    ) -> BatchSettings: ...

def refuse_repeats(paths: Sequence[str]) -> None: ...
def trace(
    title: str,
    recordings: Sequence[Recording],
    held_out: Sequence[Recording],
    families: Sequence[str],
    exclude: Sequence[str],
    baseline: str,
    law: Model | None = None,
    rig: tuple[float | None, float | None, str | None] | None = None,
    progress: Callable[[str], object] | None = None,
    adopt: bool = False,
) -> Trace: ...
def write_files(files: Sequence[tuple[str | PathLike[str], str]]) -> None: ...
def characterize(
    recording: Recording, is_static: bool, rig: tuple[float | None, float | None, str | None] | None = None
) -> tuple[str, list[tuple[list[tuple[float, float]], list[tuple[float, float]]]]]: ...
def respond(
    model: Model,
    drive: Drive,
    mass: float,
    with_offset: bool,
    tolerance: float | None,
    controls: Sequence[tuple[str, float]],
    progress: Callable[[str], object] | None,
) -> tuple[dict[str, npt.NDArray[np.float64]], str]: ...
def sweep(
    model: Model,
    mass: float,
    amplitudes: Sequence[float],
    range: tuple[float, float, int],
    with_offset: bool,
    controls: Sequence[tuple[str, float]],
    progress: Callable[[str], object] | None,
) -> str: ...
def export(
    model: Model,
    path: str | PathLike[str],
    format: str,
    tick_rate: float,
    name: str | None,
    revision: int,
    amplitude: float | None,
    density: float | None,
    allow_active: bool,
    libraries: Sequence[str | PathLike[str]],
    folders: Sequence[str | PathLike[str]],
) -> tuple[str, list[str]]: ...
def simulate(seed: int, is_check: bool) -> tuple[Recording, str]: ...
def trace_many(
    given: str | Sequence[str] | None,
    table: str | None,
    out: str | PathLike[str],
    settings: BatchSettings,
    jobs: int | None = None,
    progress: Callable[[str], object] | None = None,
) -> tuple[str, dict[str, Any], dict[str, Any], str | None]: ...
def recordings_in(folder: str | PathLike[str]) -> tuple[list[Path], list[Path]]: ...
def identity(recordings: Sequence[str | PathLike[str]], held_out: Sequence[str | PathLike[str]], settings: BatchSettings) -> str: ...
def outcome(recordings: Sequence[str | PathLike[str]], held_out: Sequence[str | PathLike[str]], settings: BatchSettings) -> str: ...
def outcomes_of(rows: Sequence[str]) -> dict[str, Any]: ...
def compare_models(models: Sequence[str | tuple[str, str, str]], times: Sequence[float]) -> tuple[str, str]: ...
