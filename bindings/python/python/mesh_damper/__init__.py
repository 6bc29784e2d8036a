"""Find effects that a damper's law does not contain, in recordings of force and displacement.

>>> import mesh_damper
>>> found = mesh_damper.trace("rig-test.csv.gz")        # a path, a data frame, arrays
>>> found.verdict, found.effects, found.plot()
"""

from ._batch import Batch, Comparison, compare, identity, outcome, outcomes, recordings_in, trace_many
from ._characterize import Characterization, characterize
from ._core import __version__
from ._errors import GuessWarning, InputError, MissingFileError, NotFittedError, UnitWarning
from ._export import export
from ._law import DamperLaw
from ._respond import Response, respond, transmissibility
from ._simulate import Simulation, simulate
from ._trace import Baseline, Errors, Report, Trace, trace

__all__ = [
    "Baseline",
    "Batch",
    "Characterization",
    "Comparison",
    "DamperLaw",
    "Errors",
    "GuessWarning",
    "InputError",
    "MissingFileError",
    "NotFittedError",
    "Report",
    "Response",
    "Simulation",
    "Trace",
    "UnitWarning",
    "__version__",
    "characterize",
    "compare",
    "export",
    "identity",
    "outcome",
    "outcomes",
    "recordings_in",
    "respond",
    "simulate",
    "trace",
    "trace_many",
    "transmissibility",
]
