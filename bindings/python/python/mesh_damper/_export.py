"""Export of a model as files for firmware or a simulation."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from . import _core
from ._errors import InputError
from ._trace import model_of

Format = Literal["pack", "rust", "c", "fmu"]
_ENDINGS: dict[str, Format] = {".mdcp": "pack", ".rs": "rust", ".c": "c", ".h": "c", ".fmu": "fmu"}


def export(
    model: Any,
    path: str | os.PathLike[str],
    *,
    tick_rate: float,
    format: Format | None = None,
    name: str | None = None,
    revision: int = 0,
    amplitude: float | None = None,
    density: float | None = None,
    allow_active: bool = False,
    library: Sequence[str | os.PathLike[str]] | str | os.PathLike[str] = (),
) -> dict[str, Any]:
    """Write a model for firmware or a simulation, as `hil export` does, and return the JSON of the command.

    `model` is a trace, a fitted `DamperLaw`, or a model.json given by its contents or its path. `format` is `pack`, `rust`, `c` or `fmu`;
    by default, the ending of `path` decides: .mdcp, .rs, .c or .h, .fmu. `tick_rate` is in Hz, `amplitude` in mm, `density` in g/cm³. An
    FMU needs its `library`, which `cargo build --release -p mesh-damper-fmu` builds.
    """
    ending = Path(path).suffix
    chosen = format or _ENDINGS.get(ending)
    if chosen is None:
        raise InputError(
            f"{os.fspath(path)}: its ending does not give the format; give format= as pack, rust, c or fmu, or one of {', '.join(_ENDINGS)}"
        )
    text, said = _core.export(
        model_of(model),
        os.fspath(path),
        chosen,
        float(tick_rate),
        name,
        revision,
        amplitude,
        density,
        allow_active,
        [os.fspath(each) for each in ([library] if isinstance(library, (str, os.PathLike)) else library)],
        [os.path.dirname(__file__)],
    )
    for sentence in said:
        warnings.warn(sentence, stacklevel=2)
    written: dict[str, Any] = json.loads(text)
    return written
