"""What a damper's law lacks, found in recordings of its force and displacement.

>>> import mesh_damper
>>> found = mesh_damper.trace("rig-test.csv.gz")        # a path, a data frame, arrays
>>> found.verdict, found.effects, found.plot()
"""

from ._core import __version__
from ._errors import InputError, MissingFileError, NotFittedError, UnitWarning
from ._trace import Baseline, Errors, Trace, trace

__all__ = [
    "Baseline",
    "Errors",
    "InputError",
    "MissingFileError",
    "NotFittedError",
    "Trace",
    "UnitWarning",
    "__version__",
    "trace",
]
