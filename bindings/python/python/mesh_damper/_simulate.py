"""Tests of the simulated rig, for whoever has no recording at hand."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal

from . import _core, _frames
from ._errors import InputError


@dataclass(frozen=True)
class Simulation:
    """A recording of the simulated rig. `simulate` makes it."""

    #: Time, displacement, force, and what else was recorded, as a data frame whose names carry the units.
    recording: Any
    #: What the specimen hides: `density` in g/cm³, `effect`, and its `share` of the law's force.
    hidden: dict[str, Any]


def simulate(seed: int = 4, test: Literal["protocol", "check"] = "protocol") -> Simulation:
    """A test of a simulated specimen that hides an effect, which `seed` draws, as `cargo hil demo` runs it.

    `protocol` is a test over amplitude and frequency, of 26 s at 1 kHz. `check` is another test of the same specimen, with other noise.
    """
    if test not in ("protocol", "check"):
        raise InputError(f"test: no test is called {test!r}; give protocol or check")
    recording, hidden = _core.simulate(seed, test == "check")
    return Simulation(_frames.make(dict(recording.columns())), json.loads(hidden))
