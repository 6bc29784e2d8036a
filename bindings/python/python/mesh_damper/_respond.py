"""The motion of a mass on a damper."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from . import _core, _frames
from ._errors import InputError
from ._recordings import ChannelLike, Decimal, Given, RecordingLike, Units
from ._trace import model_of


@dataclass(frozen=True)
class Response:
    """The motion of a mass on a damper, returned by `respond`."""

    #: Time; displacement, velocity and force of the damper; displacement, velocity and acceleration of the mass; and the excitation, as a
    #: data frame with units in the names. `trace` accepts it as a recording.
    motion: Any
    #: Energies, J: `input` = `kinetic` + `elastic` + `dissipated` + `residual`.
    energy: dict[str, float]
    #: Time step of the integration, s.
    step: float
    #: Relative change of the displacements at the last halving of the time step.
    change_on_halving: float
    #: Whether this change is within the tolerance.
    settled: bool
    #: Mass of the model's effect `inertia`, kg.
    model_mass: float
    #: Effects that are left out or treated differently from a prediction, with the reason.
    left_out: dict[str, str]
    #: Warnings about the result, as sentences.
    warnings: list[str]


def respond(
    model: Any,
    *,
    mass: float,
    force: RecordingLike = None,
    base: RecordingLike = None,
    t: ChannelLike | float | None = None,
    units: Units = None,
    table: str | None = None,
    decimal: Decimal | None = None,
    max_read: int | None = None,
    controls: Mapping[str, float] | None = None,
    with_offset: bool = False,
    tolerance: float | None = None,
    progress: Callable[[str], object] | None = None,
) -> Response:
    """Compute the motion of `mass` kg on the damper of `model`, as `hil respond` does.

    The mass moves under a `force` or on a moving `base`. Each is a path, a data frame with time and the channel, or an array. An array
    needs `t`: the times of the samples, or the time between two samples.
    `controls` gives constant values of control inputs. `units`, `table`, `decimal` and `max_read` are as for
    `trace`.
    """
    if force is None and base is None:
        raise InputError("respond: nothing drives the mass; give a force on it or a motion of its base, as force= or base=")
    if force is not None and base is not None:
        raise InputError("respond: force= and base= are both given; give one, and leave the other out")
    settings = Given(units=units, table=table, decimal=decimal, max_read=max_read)
    drive, given = _drive(force if base is None else base, base is None, t, settings)
    given.warn(stacklevel=2)
    columns, text = _core.respond(model_of(model), drive, float(mass), with_offset, tolerance, _pairs(controls), progress)
    said = json.loads(text)
    return Response(
        motion=_frames.make(columns, given.library),
        energy=said["energy"],
        step=said["step"],
        change_on_halving=said["change_on_halving"],
        settled=said["settled"],
        model_mass=said["model_mass"],
        left_out={each["family"]: each["reason"] for each in said["left_out"]},
        warnings=said["warnings"],
    )


def transmissibility(
    model: Any,
    *,
    mass: float,
    amplitudes: Sequence[float] | float,
    start: float,
    stop: float,
    points: int = 60,
    controls: Mapping[str, float] | None = None,
    with_offset: bool = False,
    progress: Callable[[str], object] | None = None,
) -> Any:
    """Compute the transmissibility of `mass` kg on a base that moves in sines, as `hil respond --sweep` does.

    The sines have `amplitudes` in mm, and `points` frequencies from `start` to `stop` Hz.

    Returns a data frame with a row for each motion: `base_amplitude` in mm, `frequency` in Hz, `transmissibility`, `phase` in degrees,
    `peak`, `damper_amplitude` in mm, `damper_speed` in mm/s, `cycles`, `steady`, `change`.
    """
    all_amplitudes = [amplitudes] if isinstance(amplitudes, (int, float)) else list(amplitudes)
    text = _core.sweep(
        model_of(model),
        float(mass),
        [float(amplitude) for amplitude in all_amplitudes],
        (float(start), float(stop), points),
        with_offset,
        _pairs(controls),
        progress,
    )
    found = json.loads(text)["points"]
    return _frames.make({name: [point[name] for point in found] for name in (found[0] if found else {})})


def _drive(data: Any, is_force: bool, t: ChannelLike | float | None, settings: Given) -> tuple[_core.Drive, Given]:
    channel = "force" if is_force else "displacement"
    has_columns = isinstance(data, (str, os.PathLike)) or _frames.column_names(data) is not None
    if not has_columns and t is None:
        raise InputError("t: the samples' times are missing; give t= as their times or as the time between two of them")
    given = replace(settings, channels={"time": t, channel: None if has_columns else data})
    given.check_for_files(data)
    return given.drive(data if has_columns else None, "force" if is_force else "base", is_force), given


def _pairs(controls: Mapping[str, float] | None) -> list[tuple[str, float]]:
    return [(name, float(value)) for name, value in (controls or {}).items()]
