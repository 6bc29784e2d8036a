"""The law with the interface of scikit-learn and PySINDy."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import mesh_damper
import numpy as np
import polars
import pytest
from conftest import Columns, sine_block
from mesh_damper import DamperLaw
from test_models import SPRING

UNITS = "mm-kN-s"


def channels(columns: Columns) -> tuple[Any, Any, Any]:
    return columns["displacement_mm"], columns["force_kN"], columns["time_s"]


@pytest.fixture(scope="module")
def law(columns: Columns) -> DamperLaw:
    y, force, t = channels(columns)
    return DamperLaw(units=UNITS).fit(y, force, t=t)


def test_a_fit_is_a_trace(law: DamperLaw) -> None:
    block = sine_block()
    y, force, t = channels(block)
    fitted = DamperLaw(units=UNITS).fit(y, force, t=t)
    found = mesh_damper.trace(block)
    assert fitted.model_ == found.model == fitted.trace_.model
    assert law.verdict_ == "found" and set(law.effects_) == {"stick_slip"}
    assert law.n_features_in_ == 1


def test_it_predicts_another_test(law: DamperLaw, check: Columns) -> None:
    y, force, t = channels(check)
    predicted = law.predict(y, t=t)
    assert predicted.shape == y.shape
    score = law.score(y, force, t=t)
    residual, about = force - predicted, force - force.mean()
    assert score == pytest.approx(1 - np.sum(residual**2) / np.sum(about**2), abs=1e-3)
    assert score > 0.995
    # A residual table stands in for the effect that the law lacks: without the table the law is worse.
    fitted = DamperLaw(units=UNITS, families=["offset"]).fit(*channels(check)[:2], t=t)
    assert fitted.verdict_ == "unlisted" and fitted.model_["correction"]
    alone = DamperLaw.of({name: part for name, part in fitted.model_.items() if name != "correction"}, units=UNITS)
    assert alone.score(y, force, t=t) < score
    embedded = DamperLaw.of(law.model_, units=UNITS, embedded=True).predict(y, t=t)
    assert np.max(np.abs(embedded - predicted)) < 1e-3 * np.max(np.abs(force))
    assert not np.array_equal(embedded, predicted)


def test_a_prediction_is_that_of_the_command(law: DamperLaw, file: Path, columns: Columns, tmp_path: Path, hil: Any) -> None:
    law.save(tmp_path / "model.json")
    done = hil("predict", "--model", tmp_path / "model.json", file, "--on", "f64", "--out", tmp_path / "p.csv")
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "p.csv") as written:
        header = written.readline().strip().split(",")
        rows = np.loadtxt(written, delimiter=",")
    expected = rows[:, header.index("predicted_force_kN")]
    y, force, t = channels(columns)
    left = np.sum((force - expected) ** 2) / np.sum((force - force.mean()) ** 2)
    assert law.score(y, force, t=t) == pytest.approx(1 - left, abs=1e-8)


def test_units_are_those_of_what_is_given(law: DamperLaw, check: Columns) -> None:
    y, force, t = channels(check)
    si = DamperLaw.of(law.model_, units="SI")
    assert np.allclose(si.predict(y / 1e3, t=t), 1e3 * law.predict(y, t=t), rtol=1e-9)
    assert si.score(y / 1e3, 1e3 * force, t=t) == pytest.approx(law.score(y, force, t=t), abs=1e-9)
    with pytest.warns(mesh_damper.UnitWarning):
        DamperLaw.of(law.model_).predict(y, t=t)


def test_it_is_saved_loaded_and_pickled(law: DamperLaw, check: Columns, tmp_path: Path) -> None:
    y, _, t = channels(check)
    law.save(tmp_path / "model.json")
    loaded = DamperLaw.load(tmp_path / "model.json", units=UNITS)
    pickled = pickle.loads(pickle.dumps(law))
    for other in (loaded, pickled):
        assert other.model_ == law.model_
        assert np.array_equal(other.predict(y, t=t), law.predict(y, t=t))
    with pytest.raises(FileNotFoundError):
        DamperLaw.load(tmp_path / "missing.json")


def test_it_says_its_equations(law: DamperLaw, capsys: pytest.CaptureFixture[str]) -> None:
    coefficients = law.coefficients()
    assert coefficients.shape == (len(law.model_["law"]), 4)
    assert coefficients[0, 0] == law.model_["law"][0]["k1"]
    law.print()
    said = capsys.readouterr().out.splitlines()
    assert said == law.equations()
    assert "·y³" in said[0] and said[-1].startswith("+ stick_slip(")


def test_several_recordings_are_lists() -> None:
    one, other = channels(sine_block(0.1)), channels(sine_block(0.2, 3.0))
    both = DamperLaw(units=UNITS).fit([one[0], other[0]], [one[1], other[1]], t=[one[2], other[2]])
    step = DamperLaw(units=UNITS).fit([one[0], other[0]], [one[1], other[1]], t=1 / 500.0)
    assert both.trace_.to_dict()["recordings"] == ["recording 1", "recording 2"]
    assert both.coefficients() == pytest.approx(step.coefficients(), rel=1e-6)
    assert both.coefficients()[:, 0] == pytest.approx(8.0, rel=0.02)


def test_rows_of_numbers_in_lists_are_one_recording() -> None:
    y, force, t = channels(sine_block())
    fitted = DamperLaw(units=UNITS).fit(y, force, t=t)
    expected = fitted.predict(y, t=t)
    rows: list[Any] = [y.tolist(), [[value] for value in y.tolist()], tuple((value,) for value in y.tolist())]
    for X in rows:
        assert np.array_equal(fitted.predict(X, t=t), expected)
        for forces in (force, force.tolist(), force[:, None].tolist()):
            assert fitted.score(X, forces, t=t) == fitted.score(y, force, t=t)
    for forces in (force, force.tolist(), force[:, None].tolist()):
        assert DamperLaw(units=UNITS).fit(rows[1], forces, t=t).model_ == fitted.model_


def test_control_inputs_are_columns_of_x() -> None:
    y, force, t = channels(sine_block())
    current = np.where(t < 2.0, 0.5, 1.0)
    law = DamperLaw(units=UNITS, inputs=["current_A"]).fit(np.column_stack([y, current]), force, t=t)
    assert law.n_features_in_ == 2
    with pytest.raises(ValueError, match="X: has 1 columns; give the displacement and current_A"):
        law.predict(y, t=t)


def test_a_missing_sample_has_a_missing_force(law: DamperLaw, check: Columns) -> None:
    y, _, t = channels(check)
    y = y.copy()
    y[[50, 51]] = np.nan
    with pytest.warns(UserWarning, match="missing samples: 2 in 1 gap"):
        predicted = law.predict(y, t=t)
    missing = np.flatnonzero(np.isnan(predicted))
    assert missing.tolist() == [50, 51]


def test_what_is_wrong_is_said() -> None:
    y, force, t = channels(sine_block())
    with pytest.raises(ValueError, match="the samples' times are missing"):
        DamperLaw().fit(y, force)
    with pytest.raises(ValueError, match="is not fitted"):
        DamperLaw().predict(y, t=t)
    with pytest.raises(ValueError, match="y: has 3 samples, and X has 2000"):
        DamperLaw().fit(y, force[:3], t=t)
    with pytest.raises(ValueError, match="0 is not a valid time between samples"):
        DamperLaw().fit(y, force, t=0.0)
    text = "t: 'time' is not a valid time between samples; give a number above 0, or the times of the samples"
    with pytest.raises(mesh_damper.InputError, match=text):
        DamperLaw().fit(y, force, t="time")
    with pytest.raises(mesh_damper.InputError, match=r"y: 3\.0 is not a column of forces; give a force for each sample of X"):
        DamperLaw().fit(y, 3.0, t=t)
    with pytest.raises(mesh_damper.InputError, match=r"y: 3\.0 is not a column of forces"):
        DamperLaw().fit([[0.1], [0.2]], 3.0, t=0.01)
    with pytest.raises(mesh_damper.InputError, match="X: has 2000 columns; give the displacement"):
        DamperLaw().fit([y, y], force, t=t)
    with pytest.raises(
        mesh_damper.InputError, match="X: its rows are not of the same length; give one column, or rows of the displacement"
    ):
        DamperLaw().fit([y, y[:9]], force, t=t)
    with pytest.raises(mesh_damper.InputError, match="y: X is a list of 2 recordings; give a list of 2 forces"):
        DamperLaw().fit([y, y], [force], t=t)
    fitted = DamperLaw.of(SPRING, units=UNITS)
    several = "X: is a list of 2 elements with 2000 values; give one recording, or rows of the displacement"
    with pytest.raises(mesh_damper.InputError, match=several):
        fitted.predict([y, y], t=t)
    with pytest.raises(mesh_damper.InputError, match=several):
        fitted.score([y, y], [force, force], t=t)
    with pytest.raises(mesh_damper.InputError, match=r"y: 3\.0 is not a column of forces"):
        fitted.score(y, 3.0, t=t)
    with pytest.raises(mesh_damper.InputError, match="a LazyFrame has no values yet"):
        DamperLaw().fit(polars.LazyFrame({"y": y}), force, t=t)
    with pytest.raises(ValueError, match="no parameter is called 'depth'"):
        DamperLaw().set_params(depth=3)


def test_it_is_an_estimator() -> None:
    pytest.importorskip("sklearn", reason="left out: scikit-learn is not installed")
    from sklearn.base import clone, is_regressor
    from sklearn.exceptions import NotFittedError
    from sklearn.model_selection import GridSearchCV, KFold
    from sklearn.utils import estimator_checks as checks
    from sklearn.utils.validation import check_is_fitted

    law = DamperLaw(families=["viscous"], units=UNITS)
    copied = clone(law)
    assert copied.get_params() == law.get_params() and copied is not law
    assert is_regressor(law) and repr(law) == "DamperLaw(families=['viscous'], units='mm-kN-s')"
    with pytest.raises(NotFittedError):
        check_is_fitted(law)
    for check in (
        checks.check_estimator_cloneable,
        checks.check_estimator_repr,
        checks.check_no_attributes_set_in_init,
        checks.check_parameters_default_constructible,
        checks.check_get_params_invariance,
        checks.check_set_params,
        checks.check_estimators_unfitted,
    ):
        check("DamperLaw", DamperLaw() if check is not checks.check_estimators_unfitted else law)
    y, force, t = channels(sine_block())
    search = GridSearchCV(DamperLaw(units=UNITS, dt=1 / 500.0), {"baseline": ["mixed", "none"]}, cv=KFold(2))
    search.fit(y, force)
    assert search.best_params_ == {"baseline": "mixed"}
    assert search.best_score_ > 0.99
    assert search.predict(y) == pytest.approx(search.best_estimator_.predict(y, t=t), abs=1e-6)
