"""A damper's law with the interface of scikit-learn and PySINDy: fit, predict, score, print."""

from __future__ import annotations

import inspect
import json
import os
import sys
import warnings
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core, _frames
from ._errors import InputError, NotFittedError
from ._frames import Array
from ._recordings import ChannelLike, Given, RecordingLike, Units
from ._trace import Trace, model_of, trace

#: The times of the samples, or the time between two samples.
Time = ChannelLike | float | Sequence[Any] | None


class DamperLaw:
    """The mixed damping law F = k1·y + k3·y³ + c·|v|^α·sgn v with additional effects.

    The law is fitted to displacement and force over time. It has the methods of a scikit-learn regressor, and can be cloned, searched and
    pickled like one. In addition, fitting and predicting need the time: `t` is the times of the samples, or the time between two samples.
    `dt` is the time between two samples for calls without `t`, for example in a search of scikit-learn.

    Parameters
    ----------
    families, exclude
        The families of effects to look for, and those to exclude. By default, all families are tried.
    baseline
        The law without effects: `mixed`, `linear` or `none`.
    known
        A model with known effects, which stay in the law.
    inputs
        Names of control inputs, such as `["current_A"]`: the columns of X after the displacement.
    units
        A unit for each channel, such as `{"force": "N"}`, or `"SI"`. Without units, s, mm and kN are assumed, with a warning.
    dt
        The time between two samples, used if `t` is not given.
    embedded
        Whether to predict forces in f32, as in firmware, instead of f64.

    Attributes
    ----------
    trace_ : the `Trace`, with verdict, effects, errors and report
    model_ : the model, as in model.json
    coefficients_ : k1, k3, c and alpha by name; arrays for a law that depends on the amplitude
    effects_ : the effects by family, each with its parameters
    verdict_ : `none`, `found`, `ambiguous` or `unlisted`
    n_features_in_ : number of columns of X
    """

    def __init__(
        self,
        *,
        families: Sequence[str] = (),
        exclude: Sequence[str] = (),
        baseline: str = "mixed",
        known: Any = None,
        inputs: Sequence[str] = (),
        units: Units = None,
        dt: float | None = None,
        embedded: bool = False,
    ) -> None:
        self.families = families
        self.exclude = exclude
        self.baseline = baseline
        self.known = known
        self.inputs = inputs
        self.units = units
        self.dt = dt
        self.embedded = embedded

    def fit(self, X: Any, y: Any, *, t: Time = None, held_out: RecordingLike = None, progress: Any = None) -> DamperLaw:
        """Fit the law to the displacement `X` and the force `y` at the times `t`, and find additional effects.

        `X` is one column, or the displacement and the control inputs. Lists of `X`, `y` and `t` are several recordings if each element of
        `y` is the force of one. `held_out` are recordings that are never fitted, in any form that `trace` accepts.
        """
        recordings = self._recordings(X, y, t)
        found = trace(
            recordings if len(recordings) > 1 else recordings[0],
            inputs=list(self.inputs),
            held_out=held_out,
            units=self.units,
            families=self.families,
            exclude=self.exclude,
            baseline=self.baseline,
            law=self.known,
            title="Trace of a DamperLaw",
            progress=progress,
        )
        self.trace_ = found
        self.verdict_ = found.verdict
        return self._take(found._core.model)

    def predict(self, X: Any, *, t: Time = None) -> Array:
        """Predict the force, in the unit of `y`, for the displacement `X` at the times `t`. The specimen begins at rest.

        The displacement is relative to the rest position of the specimen. A missing displacement gives a missing force.
        """
        return self._force(X, None, t)

    def score(self, X: Any, y: Any, *, t: Time = None) -> float:
        """Return R² of the predicted force: 1 minus the sum of squared errors over the sum of squares about the mean.

        As in `hil predict`, the zero and the delay of the channels are determined from the force.
        """
        predicted = self._force(X, y, t)
        measured = _frames.to_array(y, "y")
        is_known = np.isfinite(measured) & np.isfinite(predicted)
        about = measured[is_known] - measured[is_known].mean()
        return float(1.0 - np.sum((measured[is_known] - predicted[is_known]) ** 2) / np.sum(about**2))

    def coefficients(self) -> Array:
        """Return k1, k3, c and alpha, with a row for each fitted amplitude."""
        law = self._found()["law"]
        return np.array([[node[name] for name in _COEFFICIENTS] for node in law])

    def equations(self, precision: int = 3) -> list[str]:
        """Return the law as text, one line for each amplitude and each effect."""
        model = self._found()
        lines = []
        for node in model["law"]:
            at = f"at {node['amplitude']:.{precision}g} mm: " if len(model["law"]) > 1 else ""
            k1, k3, c, alpha = (f"{node[name]:.{precision}g}" for name in _COEFFICIENTS)
            lines.append(f"{at}F = {k1}·y + {k3}·y³ + {c}·|v|^{alpha}·sgn v")
        for effect in model["effects"]:
            values = ", ".join(f"{name} = {value:.{precision}g}" for name, value in effect["parameters"].items())
            lines.append(f"+ {effect['family']}({values})")
        if model.get("correction"):
            lines.append("+ a residual table")
        return [line.replace("+ -", "− ") for line in lines]

    def print(self, precision: int = 3) -> None:
        """Print the equations, in mm, s and kN."""
        print("\n".join(self.equations(precision)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model as a model.json for the commands."""
        self._model().write(path)

    @classmethod
    def load(cls, path: str | os.PathLike[str], **parameters: Any) -> DamperLaw:
        """Load the law of a model.json that `save` or `hil trace` wrote."""
        return cls.of(path, **parameters)

    @classmethod
    def of(cls, model: Any, **parameters: Any) -> DamperLaw:
        """Return the law of a trace, or of a model.json, given by its contents or its path."""
        law = cls(**parameters)
        found = model_of(model)
        if isinstance(model, Trace):
            law.trace_ = model
            law.verdict_ = model.verdict
        named = [control["name"] for control in json.loads(found.to_json()).get("controls", [])]
        if named and not law.inputs:
            law.inputs = named
        return law._take(found)

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Return the parameters by name."""
        return {name: getattr(self, name) for name in self._names()}

    def set_params(self, **parameters: Any) -> DamperLaw:
        """Set parameters by name."""
        for name, value in parameters.items():
            if name not in self._names():
                raise InputError(f"DamperLaw: no parameter is called {name!r}; give {', '.join(self._names())}")
            setattr(self, name, value)
        return self

    def __repr__(self) -> str:
        defaults = inspect.signature(type(self).__init__).parameters
        given = [f"{name}={value!r}" for name, value in self.get_params().items() if value is not defaults[name].default]
        return f"DamperLaw({', '.join(given)})"

    def __getstate__(self) -> dict[str, Any]:
        state = dict(self.__dict__)
        core = state.pop("_core_model", None)
        state.pop("trace_", None)
        if core is not None:
            state["_core_model"] = core.to_json()
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        state = dict(state)
        model = state.pop("_core_model", None)
        self.__dict__.update(state)
        if model is not None:
            self._core_model = _core.Model.of_json(model)

    def __sklearn_is_fitted__(self) -> bool:
        return hasattr(self, "_core_model")

    def __sklearn_tags__(self) -> Any:
        tags = import_module("sklearn.utils")
        return tags.Tags(
            estimator_type="regressor",
            target_tags=tags.TargetTags(required=True),
            regressor_tags=tags.RegressorTags(),
            input_tags=tags.InputTags(one_d_array=True, allow_nan=True),
        )

    @classmethod
    def _names(cls) -> list[str]:
        return sorted(name for name in inspect.signature(cls.__init__).parameters if name != "self")

    def _take(self, model: _core.Model) -> DamperLaw:
        self._core_model = model
        self.model_: dict[str, Any] = json.loads(model.to_json())
        law = self.model_["law"]
        several = len(law) > 1
        self.coefficients_: dict[str, Any] = {
            name: np.array([node[name] for node in law]) if several else law[0][name] for name in _COEFFICIENTS
        }
        self.effects_: dict[str, dict[str, float]] = {effect["family"]: dict(effect["parameters"]) for effect in self.model_["effects"]}
        self.n_features_in_ = 1 + len(self.inputs)
        return self

    def _model(self) -> _core.Model:
        if not hasattr(self, "_core_model"):
            raise _not_fitted("this DamperLaw is not fitted; call fit, or load a model.json")
        return self._core_model

    def _found(self) -> dict[str, Any]:
        self._model()
        return self.model_

    def _force(self, X: Any, y: Any, t: Time) -> Array:
        model = self._model()
        (columns,) = self._recordings(X, y, t, one=True)
        given = Given(inputs=list(self.inputs), units=self.units, needs_force=y is not None)
        rows = len(columns["displacement"])
        recording = given.recording(columns, "X")
        given.warn(stacklevel=3)
        force, said = model.predict(recording, y is not None, self.embedded, [])
        for sentence in said:
            warnings.warn(sentence, stacklevel=3)
        predicted = np.full(rows, np.nan)
        predicted[recording.rows()] = force / (given.reading().scale("force") or 1.0)
        return predicted

    def _recordings(self, X: Any, y: Any, t: Time, one: bool = False) -> list[Mapping[str, Any]]:
        """Return the columns of each recording."""
        t = self.dt if t is None else t
        if t is None:
            raise InputError("t: the samples' times are missing; give t= as their times or as the time between two of them")
        if not self._is_several(X, y):
            return [self._columns(X, y, t)]
        if one:
            raise InputError(
                f"X: is a list of {len(X)} elements with {_length(X[0])} values; give one recording, or rows of {self._wanted()}"
            )
        if not isinstance(y, (list, tuple)) or len(y) != len(X):
            raise InputError(f"y: X is a list of {len(X)} recordings; give a list of {len(X)} forces")
        times = t if isinstance(t, (list, tuple)) else [t] * len(X)
        if len(times) != len(X):
            raise InputError(f"t: X is a list of {len(X)} recordings; give {len(X)} times, or one for all")
        return [self._columns(*each) for each in zip(X, y, times)]

    def _is_several(self, X: Any, y: Any) -> bool:
        """Return whether `X` is a list of recordings, and not one recording as a list of numbers or of rows.

        The force decides, because a row of `X` has elements like a recording. Without a force, their number decides.
        """
        if not isinstance(X, (list, tuple)) or not X:
            return False
        if y is None:
            return _length(X[0]) not in (None, 1 + len(self.inputs))
        # One force in a list of its own is a row: a recording has more samples.
        return isinstance(y, (list, tuple)) and len(y) > 0 and _length(y[0]) not in (None, 1)

    def _wanted(self) -> str:
        """Return the columns of X in words."""
        return " and ".join(["the displacement", *([", ".join(self.inputs)] if self.inputs else [])])

    def _columns(self, X: Any, y: Any, t: Any) -> Mapping[str, Any]:
        if y is not None and _length(y) is None:
            raise InputError(f"y: {y!r} is not a column of forces; give a force for each sample of X")
        features = self._features(X)
        names = ["displacement", *self.inputs]
        if len(features) != len(names):
            raise InputError(
                f"X: has {len(features)} columns; give the displacement"
                + (f" and {', '.join(self.inputs)}" if self.inputs else ", and name control inputs in inputs=")
            )
        columns: dict[str, Any] = dict(zip(names, features))
        rows = len(features[0])
        if _length(t) is None:
            try:
                step = float(t)
            except (TypeError, ValueError):
                step = np.nan
            if not (np.isfinite(step) and step > 0):
                raise InputError(
                    f"t: {repr(t) if isinstance(t, str) else t} is not a valid time between samples; "
                    "give a number above 0, or the times of the samples"
                )
            t = step * np.arange(rows)
        columns["time"] = t
        if y is not None:
            columns["force"] = y
        for name in ("time", "force"):
            if name in columns and len(columns[name]) != rows:
                short = "t" if name == "time" else "y"
                raise InputError(f"{short}: has {len(columns[name])} samples, and X has {rows}; give as many")
        return columns

    def _features(self, X: Any) -> list[Array]:
        names = _frames.column_names(X)
        if names is not None:
            return [_frames.to_array(_frames.column(X, name), f"X: {name}") for name in names]
        try:
            array: npt.NDArray[Any] = np.asanyarray(X)
        except ValueError as error:
            raise InputError(f"X: its rows are not of the same length; give one column, or rows of {self._wanted()}") from error
        if array.ndim == 1:
            return [_frames.to_array(X, "X")]
        if array.ndim != 2:
            raise InputError(f"X: has {array.ndim} dimensions; give one column, or rows of samples")
        return [_frames.to_array(array[:, place], "X") for place in range(array.shape[1])]


def _length(values: Any) -> int | None:
    """Return the number of elements; `None` for a single value."""
    try:
        return None if isinstance(values, (str, bytes)) else len(values)
    except TypeError:
        return None


def _not_fitted(text: str) -> NotFittedError:
    """Make an error that scikit-learn also recognizes, if it is in use."""
    theirs = sys.modules.get("sklearn.exceptions")
    if theirs is None:
        return NotFittedError(text)
    error: NotFittedError = type("NotFittedError", (NotFittedError, theirs.NotFittedError), {})(text)
    return error


_COEFFICIENTS = ("k1", "k3", "c", "alpha")
