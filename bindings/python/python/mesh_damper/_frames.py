"""Data frames as input and output, with pandas or polars, whichever is installed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ._errors import InputError

#: A column of numbers.
Array = npt.NDArray[np.float64]
#: The library of a frame.
Library = Literal["pandas", "polars"]


def library_of(data: object) -> Library | None:
    """Return the library of the frame `data`, or `None`."""
    module = type(data).__module__.split(".")[0]
    if module == "pandas":
        return "pandas"
    return "polars" if module == "polars" else None


def column_names(data: Any) -> list[str] | None:
    """Return the column names of a frame, a mapping or a record array; `None` for anything else."""
    if library_of(data) == "polars" and type(data).__name__ == "LazyFrame":
        raise InputError("recording: a LazyFrame has no values yet; give its .collect()")
    if isinstance(data, Mapping):
        return [str(name) for name in data]
    if isinstance(data, np.ndarray):
        return list(data.dtype.names) if data.dtype.names else None
    # pyarrow has `column_names`; pandas, polars and others have `columns`.
    names = getattr(data, "column_names", None)
    if names is None:
        names = getattr(data, "columns", None)
    return None if names is None or isinstance(names, str) or callable(names) else [str(name) for name in names]


def column(data: Any, name: str) -> Any:
    """Return the column `name`. A name that is not a string is compared by its text."""
    if isinstance(data, np.ndarray) or name in data:
        return data[name]
    keys = data.keys() if isinstance(data, Mapping) else data.columns
    for key in keys:
        if str(key) == name:
            return data[key]
    return data[name]


def index(data: Any) -> tuple[str, Any] | None:
    """Return the name and the index of a pandas frame, if the index has a name or holds dates or durations."""
    if library_of(data) != "pandas":
        return None
    is_times = getattr(data.index.dtype, "kind", "") in ("M", "m")
    name = data.index.name
    return None if name is None and not is_times else ("index" if name is None else str(name), data.index)


class NotNumbers(ValueError):
    """The reason why values are not a column of numbers."""


def to_array(values: Any, what: str) -> Array:
    """Return `values` as numbers, with NaN for a missing value."""
    try:
        return numbers(values)
    except NotNumbers as error:
        raise InputError(f"{what}: {error}; give a column of numbers") from error


def numbers(values: Any) -> Array:
    """Do the same, but raise `NotNumbers`. Strings are rejected even if they contain digits: their decimal sign is not known."""
    library = library_of(values)
    try:
        if library == "polars":
            array = _of_polars(values)
        elif library == "pandas":
            kind = getattr(values.dtype, "kind", "O")
            array = values.to_numpy(dtype=float if kind in "fiub" else object, na_value=np.nan)
        else:
            array = _in_numpy(values)
        if array.dtype.kind not in "fiub" and array.dtype != object:
            raise TypeError(f"{array.dtype}")
        if array.dtype == object and (text := next((each for each in array.flat if isinstance(each, (str, bytes))), None)) is not None:
            raise TypeError(f"the text {text!r}")
        array = np.asarray(array, dtype=np.float64, order="C")
    except Exception as error:
        if library != "polars" and not isinstance(error, (TypeError, ValueError, OverflowError)):
            raise
        raise NotNumbers(f"holds something else than numbers ({error})") from error
    if array.ndim == 2 and array.shape[1] == 1:
        array = np.ascontiguousarray(array[:, 0])
    if array.ndim != 1:
        raise NotNumbers(f"has {array.ndim} dimensions")
    return array


def _of_polars(values: Any) -> npt.NDArray[Any]:
    polars = import_module("polars")
    kind = values.dtype
    if not (kind.is_numeric() or kind in (polars.Boolean, polars.Null, polars.Object)):
        raise TypeError(f"{kind}")
    array: npt.NDArray[Any] = (values if kind == polars.Object else values.cast(polars.Float64)).to_numpy()
    return array


def _in_numpy(values: Any) -> npt.NDArray[Any]:
    """Return `values` as a NumPy array. A masked value is missing: under the mask is only the fill value."""
    array: npt.NDArray[Any] = values.to_numpy() if hasattr(values, "to_numpy") else np.asanyarray(values)
    if not isinstance(array, np.ma.MaskedArray):
        return array
    missing: Any = np.nan
    if array.dtype.kind in "Mm":
        missing = np.array("NaT", dtype=array.dtype)[()]
    else:
        array = array.astype(float if array.dtype.kind in "fiub" else object)
    filled: npt.NDArray[Any] = np.ma.filled(array, missing)
    return filled


def seconds(times: Any) -> Array | None:
    """Return the seconds since the first of `times`, if these are dates, times of day or durations; NaN for a missing time."""
    dtype: Any = getattr(times, "dtype", None)
    if library_of(times) == "polars":
        polars = import_module("polars")
        if not dtype.is_temporal():
            return None
        array = (times.cast(polars.Duration("ns")) if dtype == polars.Time else times).to_numpy()
    elif getattr(dtype, "kind", "") not in ("M", "m"):
        return None
    elif library_of(times) == "pandas":
        # A time zone does not affect differences.
        array = times.to_numpy(f"{'datetime' if dtype.kind == 'M' else 'timedelta'}64[ns]")
    else:
        array = _in_numpy(times)
    there = array[~np.isnat(array)]
    since = (array - there[:1] if there.size else array - array).astype("timedelta64[ns]")
    return np.where(np.isnat(since), np.nan, since.astype(np.int64) / 1e9)


def make(columns: Mapping[str, Sequence[Any] | npt.NDArray[Any]], like: Library | None = None) -> Any:
    """Make a frame of `columns` in the library `like`, or in pandas or polars if installed, otherwise a NumPy record array."""
    order: list[Library] = ["pandas", "polars"]
    if like == "polars":
        order.reverse()
    for library in order:
        if like == library or _is_there(library):
            return import_module(library).DataFrame(dict(columns))
    arrays = {name: _array(values) for name, values in columns.items()}
    kinds = np.dtype([(name, array.dtype) for name, array in arrays.items()])
    return np.rec.fromarrays(list(arrays.values()), dtype=kinds)


def _array(values: Sequence[Any] | npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return a column as an array with an element a row; a row with a list stays one object."""
    if isinstance(values, np.ndarray) or not any(isinstance(value, (list, dict)) for value in values):
        return np.asarray(values)
    array = np.empty(len(values), dtype=object)
    for row, value in enumerate(values):
        array[row] = value
    return array


def _is_there(library: str) -> bool:
    try:
        import_module(library)
    except ImportError:
        return False
    return True
