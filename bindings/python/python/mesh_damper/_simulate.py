"""Tests on the simulated rig, for users without a recording."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal

from . import _core, _frames
from ._errors import InputError


@dataclass(frozen=True)
class Simulation:
    """A recording of the simulated rig, returned by `simulate`."""

    #: Time, displacement, force and the other recorded channels, as a data frame with units in the names.
    recording: Any
    #: Hidden properties of the specimen: `density` in g/cm³, `effect`, and the `share` of the effect's force relative to the law's.
    hidden: dict[str, Any]


def simulate(seed: int = 4, test: Literal["protocol", "check"] = "protocol") -> Simulation:
    """Run a test of a simulated specimen with a hidden effect, as `cargo hil demo` does. `seed` draws the effect.

    `protocol` is a test over amplitude and frequency, 26 s long at 1 kHz. `check` is another test of the same specimen, with other noise.
    """
    if test not in ("protocol", "check"):
        raise InputError(f"test: no test is called {test!r}; give protocol or check")
    recording, hidden = _core.simulate(seed, test == "check")
    return Simulation(_frames.make(dict(recording.columns())), json.loads(hidden))
