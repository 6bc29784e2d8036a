"""Traces of all kinds of input, compared with the command and with one another."""

from __future__ import annotations

import decimal
import json
import os
import re
import subprocess
import sys
import textwrap
import threading
import warnings
from pathlib import Path
from typing import Any

import mesh_damper
import numpy as np
import pandas
import polars
import pytest
from conftest import Columns, sine_block, write_csv


def test_the_files_are_those_of_the_command(file: Path, tmp_path: Path, hil: Any) -> None:
    out = tmp_path / "command"
    done = hil("trace", file, "--out", out)
    assert done.returncode == 0, done.stderr
    found = mesh_damper.trace(file)
    assert found.to_json() == (out / "trace.json").read_text()
    found.save(tmp_path / "package")
    for name in ("trace.json", "model.json", "report.html"):
        assert (tmp_path / "package" / name).read_bytes() == (out / name).read_bytes(), name


def test_the_stick_slip_of_the_specimen_is_found(found: mesh_damper.Trace) -> None:
    hidden = mesh_damper.simulate(4).hidden["effect"]
    assert found.verdict == "found" and found.adopted
    assert hidden["family"] == "stick_slip"
    effects = found.effects
    assert list(effects.columns) == [
        "family",
        "parameter",
        "value",
        "low",
        "high",
        "unit",
        "nrmse_without",
        "nrmse_with",
    ]
    assert set(effects["family"]) == {"stick_slip"}
    assert ((effects["low"] <= effects["value"]) & (effects["value"] <= effects["high"])).all()
    assert found.augmented.nrmse_held_out < 0.2 * found.baseline.nrmse_held_out
    assert found.noise_floor < found.augmented.nrmse_held_out < 2 * found.noise_floor
    assert found.candidates["family"].iloc[0] == "stick_slip"


def test_a_frame_a_mapping_and_arrays_are_the_same_recording() -> None:
    block = {**sine_block(), "temperature_degC": np.linspace(20.0, 21.0, 2000)}
    time, displacement, force, temperature = block.values()
    found = mesh_damper.trace(block)
    arrays: Any = {"time": time, "displacement": displacement, "force": force}
    forms: dict[str, Any] = {
        "pandas": mesh_damper.trace(pandas.DataFrame(block)),
        "polars": mesh_damper.trace(polars.DataFrame(block)),
        "records": mesh_damper.trace(np.rec.fromarrays(list(block.values()), names=list(block))),
        "arrays": mesh_damper.trace(**arrays, temperature=temperature, units="mm-kN-s"),
        "mixed": mesh_damper.trace({"temperature_degC": temperature}, **arrays, units="mm-kN-s"),
    }
    for name, form in forms.items():
        assert form.to_json() == found.to_json(), name
    assert isinstance(forms["pandas"].effects, pandas.DataFrame)
    assert isinstance(forms["polars"].effects, polars.DataFrame)


def test_columns_of_other_names_and_units_are_the_same_recording() -> None:
    block = sine_block()
    one = mesh_damper.trace(block).to_dict()
    named = {
        "Zeit [ms]": 1e3 * block["time_s"],
        "Weg": block["displacement_mm"] / 25.4,
        "Axial Force (N)": 1e3 * block["force_kN"],
    }
    given: Any = {
        "time": "Zeit [ms]",
        "displacement": "Weg",
        "force": "Axial Force (N)",
        "units": {"displacement": "in"},
    }
    other = mesh_damper.trace(named, **given).to_dict()
    assert other["verdict"] == one["verdict"]
    assert other["law"][0]["k1"]["value"] == pytest.approx(one["law"][0]["k1"]["value"], rel=1e-6)


def test_the_columns_of_a_file_are_named_as_the_command_has_them_named(tmp_path: Path, hil: Any) -> None:
    block = sine_block()
    current = np.where(block["time_s"] < 2.0, 0.5, 1.0)
    path = tmp_path / "lab.csv"
    write_csv(path, {"Uhr": block["time_s"], "Weg X": block["displacement_mm"], "Ch 4": 1e3 * block["force_kN"], "I": current})
    given = {"time": "Uhr", "displacement": "Weg X", "force": "Ch 4"}
    units = {"time": "s", "displacement": "mm", "force": "N"}
    found = mesh_damper.trace(path, **given, units=units, inputs={"current_A": "I"})
    options = [f"--channel={channel}={name}" for channel, name in {**given, "current": "I"}.items()]
    options += [f"--unit={channel}={unit}" for channel, unit in {**units, "current": "A"}.items()]
    done = hil("trace", path, *options, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert found.to_json() == (tmp_path / "out" / "trace.json").read_text()


def test_a_unit_that_nothing_says_is_assumed_aloud() -> None:
    block = sine_block()
    bare = {"time": block["time_s"], "displacement": block["displacement_mm"], "force": block["force_kN"]}
    with pytest.warns(mesh_damper.UnitWarning, match='s for column "time", mm for column "displacement", kN for column "force"'):
        found = mesh_damper.trace(bare)
    assert len(found.assumed) == 1 and found.assumed[0] in repr(found)
    # There is no warning: it would be an error here.
    assert mesh_damper.trace(bare, units="mm-kN-s").to_json() == found.to_json()
    si = {"time": bare["time"], "displacement": bare["displacement"] / 1e3, "force": bare["force"] * 1e3}
    assert mesh_damper.trace(si, units="SI").verdict == found.verdict


def test_a_time_may_be_a_step_an_index_or_dates() -> None:
    block = sine_block()
    frame = pandas.DataFrame({name: block[name] for name in ("displacement_mm", "force_kN")})
    one = mesh_damper.trace(block).to_dict()["law"]
    dates = frame.set_index(pandas.Timestamp("2026-01-01") + pandas.to_timedelta(block["time_s"], unit="s"))
    for given in (
        mesh_damper.trace(frame, time=1 / 500.0, units={"time": "s"}),
        mesh_damper.trace(dates),
        mesh_damper.trace(frame.set_index(pandas.Index(block["time_s"], name="t")), time="t", units={"time": "s"}),
        mesh_damper.trace(polars.DataFrame({**block, "time_s": block["time_s"]})),
    ):
        assert given.to_dict()["law"][0]["k1"]["value"] == pytest.approx(one[0]["k1"]["value"], rel=1e-6)
    with pytest.warns(mesh_damper.UnitWarning, match="for time=, so s is assumed"):
        mesh_damper.trace(frame, time=1 / 500.0)
    # A column of seconds is more certain than an index of dates, and dates in a column are a guess.
    both = dates.assign(time_s=block["time_s"])
    assert mesh_damper.trace(both).to_json() == mesh_damper.trace(frame.assign(time_s=block["time_s"])).to_json()
    clock = frame.assign(Datum=dates.index)
    for data in (clock, polars.DataFrame({name: clock[name].to_numpy() for name in clock})):
        with pytest.warns(mesh_damper.GuessWarning, match='time is read from column "Datum" in s, by its unit alone'):
            stamped = mesh_damper.trace(data)
        assert stamped.to_dict()["law"][0]["k1"]["value"] == pytest.approx(one[0]["k1"]["value"], rel=1e-6)


def test_what_is_no_column_of_numbers_is_no_channel() -> None:
    block = sine_block()
    times = polars.Series([None] * 2000, dtype=polars.Time)
    other = {"Force [kN]": ["a"] * 2000, "notes": [[1], [2, 3]], "rate": 500.0, "at": times, "operator": "me"}
    assert mesh_damper.trace({**block, **other}).to_json() == mesh_damper.trace(block).to_json()


def test_a_missing_sample_is_left_out_as_a_blank_cell_is(tmp_path: Path) -> None:
    block = sine_block()
    block["force_kN"][[100, 101, 700]] = np.nan
    path = tmp_path / "blank.csv"
    write_csv(path, block)
    assert mesh_damper.trace(block).to_dict()["law"] == mesh_damper.trace(path).to_dict()["law"]


def test_what_is_masked_is_missing() -> None:
    # netCDF gives such arrays: under the mask is the fill value.
    block = sine_block()
    gaps = np.isin(np.arange(2000), [100, 101, 700])
    missing = {**block, "force_kN": np.where(gaps, np.nan, block["force_kN"])}
    masked = np.ma.masked_array(np.where(gaps, 9999.0, block["force_kN"]), mask=gaps)
    expected = mesh_damper.trace(missing).to_json()
    assert mesh_damper.trace({**block, "force_kN": masked}).to_json() == expected
    arrays: Any = {"time": block["time_s"], "displacement": block["displacement_mm"], "force": masked, "units": "mm-kN-s"}
    assert mesh_damper.trace(**arrays).to_json() == expected
    kinds = np.dtype([(name, float) for name in block])
    records = np.ma.masked_array(np.empty(2000, kinds), mask=False)
    for name in block:
        records[name] = masked if name == "force_kN" else block[name]
    assert mesh_damper.trace(records).to_json() == expected
    fit = mesh_damper.DamperLaw(units="mm-kN-s").fit(np.ma.masked_array(block["displacement_mm"])[:, None], masked, t=block["time_s"])
    assert fit.trace_.to_dict()["law"] == json.loads(expected)["law"]
    # The same for a matrix, for whole numbers, and for times, which must not be missing.
    with pytest.warns(UserWarning, match="missing samples: 3 in 2 gaps"):
        predicted = fit.predict(np.ma.masked_array(block["displacement_mm"], gaps)[:, None], t=block["time_s"])
    assert np.array_equal(np.isnan(predicted), gaps)
    counts = np.ma.masked_array(np.where(gaps, 30000, 1000 * block["force_kN"]).astype(np.int16), mask=gaps)
    whole = {**missing, "force_kN": np.trunc(1000 * missing["force_kN"])}
    assert mesh_damper.trace({**block, "force_kN": counts}).to_json() == mesh_damper.trace(whole).to_json()
    dates = np.datetime64("2026-01-01") + (1e9 * block["time_s"]).astype("timedelta64[ns]")
    for times in (block["time_s"], dates):
        with pytest.raises(mesh_damper.InputError, match="is empty"):
            mesh_damper.trace({**block, "time_s": np.ma.masked_array(times, mask=gaps)})


def test_dates_and_durations_are_seconds_whatever_unit_is_said() -> None:
    block = sine_block()
    durations = (1e9 * block["time_s"]).astype("timedelta64[ns]")
    rest = {name: block[name] for name in ("displacement_mm", "force_kN")}
    expected = mesh_damper.trace(block).to_dict()["law"][0]["k1"]["value"]
    for times in (durations, np.datetime64("2026-01-01") + durations):
        for name in ("time_ms", "Time (ms)", "Zeit"):
            with pytest.raises(mesh_damper.InputError, match=f"column {re.escape(name)}: its dates or times of day are read as seconds"):
                mesh_damper.trace({name: times, **rest}, units={"time": "ms"})
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", mesh_damper.GuessWarning)
                found = mesh_damper.trace({name: times, **rest}, units={"time": "s"})
            assert found.to_dict()["law"][0]["k1"]["value"] == pytest.approx(expected, rel=1e-6)
        # The name alone does not change their meaning.
        found = mesh_damper.trace({"time_ms": times, **rest})
        assert found.to_dict()["law"][0]["k1"]["value"] == pytest.approx(expected, rel=1e-6)
    # A unit for the numbers does not affect the dates in another column.
    both = {"Uhrzeit": durations, "time": 1e3 * block["time_s"], **rest}
    assert mesh_damper.trace(both, units={"time": "ms"}).to_dict()["law"][0]["k1"]["value"] == pytest.approx(expected, rel=1e-6)


def test_texts_are_no_numbers_in_any_library() -> None:
    block = sine_block()
    texts = [f"{value:.6f}" for value in block["force_kN"]]
    rest = {name: block[name] for name in ("time_s", "displacement_mm")}
    forms: list[Any] = [
        texts,
        np.array(texts),
        np.array([None, *texts[1:]], dtype=object),
        pandas.Series(texts),
        pandas.Series(texts, dtype=object),
        pandas.Series(texts, dtype="category"),
        polars.Series(texts),
        polars.Series(texts, dtype=polars.Categorical),
    ]
    for form in forms:
        with pytest.raises(mesh_damper.InputError, match="column force_kN: holds something else than numbers"):
            mesh_damper.trace({**rest, "force_kN": form})
    # A number is a number in every library.
    exact = [decimal.Decimal(text) for text in texts]
    numbers: list[Any] = [[float(text) for text in texts], exact, pandas.Series(exact), polars.Series(exact)]
    said = [mesh_damper.trace({**rest, "force_kN": form}).to_json() for form in numbers]
    assert said[1:] == said[:1] * 3


def test_control_inputs_are_columns_with_a_unit() -> None:
    block = sine_block()
    current = np.where(block["time_s"] < 2.0, 0.5, 1.0)
    named = mesh_damper.trace({**block, "current_A": current})
    other = mesh_damper.trace({**block, "I": current}, inputs={"current_A": "I"})
    assert named.to_json() == other.to_json()
    assert mesh_damper.trace({**block, "current_A": current}, inputs=[]).to_dict()["law"] != []
    with pytest.raises(mesh_damper.InputError, match='"I" is not the name of a control input, which must end in a unit; found "time_s"'):
        mesh_damper.trace({**block, "I": current}, inputs=["I"])


def test_a_control_input_that_is_named_must_be_there(tmp_path: Path) -> None:
    block = {**sine_block(), "Spannung [V]": np.ones(2000), "current_A": np.linspace(0.5, 1.0, 2000)}
    write_csv(tmp_path / "lab.csv", block)
    for data in (block, tmp_path / "lab.csv"):
        with pytest.raises(mesh_damper.InputError, match=r"there is no control input pressure_bar; found .* --channel pressure=NAME"):
            mesh_damper.trace(data, inputs=["current_A", "pressure_bar"])
        # A column that is not named is not read, so there is no guess.
        mesh_damper.trace(data, inputs="current_A", families="viscous")
    with pytest.raises(mesh_damper.InputError, match="the control input current_A holds no number"):
        mesh_damper.trace({**block, "current_A": np.full(2000, np.nan)}, inputs=["current_A"])
    with pytest.raises(mesh_damper.InputError, match="column current_A: holds something else than numbers"):
        mesh_damper.trace({**block, "current_A": ["on"] * 2000}, inputs=["current_A"])


LABS: list[tuple[dict[str, float], list[str]]] = [
    (
        {"Zeit [s]": 1.0, "Kolbenweg (mm)": 1.0, "Prüfkraft [N]": 1e3, "Sollweg [mm]": 2.0},
        [
            'time is read from column "Zeit [s]" in s',
            'displacement is read from column "Kolbenweg (mm)" in mm',
            'force is read from column "Prüfkraft [N]" in N',
        ],
    ),
    (
        {"time_s": 1.0, "displacement_in": 1 / 25.4, "Force [kip]": 1 / 4.4482216152605},
        ['force is read from column "Force [kip]" in kip'],
    ),
    (
        {"time_s": 1.0, "Ch 1 [mm]": 1.0, "Kraft / kgf": 1e3 / 9.80665},
        [
            'displacement is read from column "Ch 1 [mm]" in mm, by its unit alone',
            'force is read from column "Kraft / kgf" in kgf',
        ],
    ),
]


def of_a_lab(scales: dict[str, float]) -> Columns:
    """A block with the names and units of a laboratory; one more column is a multiple of the displacement."""
    time, displacement, force = sine_block().values()
    values = [time, displacement, force, displacement]
    return {name: scale * values[place] for place, (name, scale) in enumerate(scales.items())}


@pytest.mark.parametrize(("scales", "guesses"), LABS, ids=[list(scales)[-1] for scales, _ in LABS])
def test_a_frame_is_taken_as_a_file_of_the_same_columns(scales: dict[str, float], guesses: list[str], tmp_path: Path, hil: Any) -> None:
    lab = of_a_lab(scales)
    path = tmp_path / "lab.csv"
    write_csv(path, lab)
    done = hil("trace", path, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    laws = []
    for data, name in ((path, str(path)), (lab, "recording"), (pandas.DataFrame(lab), "recording"), (polars.DataFrame(lab), "recording")):
        with pytest.warns(mesh_damper.GuessWarning) as warned:
            found = mesh_damper.trace(data)
        said = [str(one.message) for one in warned]
        assert said == found.assumed and not any(issubclass(one.category, mesh_damper.UnitWarning) for one in warned)
        assert [text for text in said if " is read from column " in text] == [f"{name}: {guess}" for guess in guesses]
        if data is path:
            # The separator of a file is also a guess. The command prints all guesses.
            assert [f"note: {text}" for text in said] == [line for line in done.stderr.splitlines() if line.startswith("note: ")]
        else:
            assert len(said) == len(guesses)
        laws.append(found.to_dict()["law"])
    assert laws[1:] == [laws[0]] * 3
    expected = mesh_damper.trace(sine_block()).to_dict()["law"]
    assert laws[0][0]["k1"]["value"] == pytest.approx(expected[0]["k1"]["value"], rel=1e-6)


REFUSED: list[tuple[dict[str, float], dict[str, Any], str]] = [
    (
        {"time_s": 1.0, "displacement_mm": 1.0, "Force 1 [kN]": 1.0, "Force 2 [kN]": 1.0},
        {},
        '2 columns could be the force: "Force 1 [kN]", "Force 2 [kN]"; '
        "say which: --channel force='Force 1 [kN]' or --channel force='Force 2 [kN]'",
    ),
    ({"Zeit [s]": 1.0, "Stroke [mm]": 1.0, "Load [kN]": 1.0, "Disp [mm]": 1.0}, {}, "2 columns could be the displacement"),
    ({"time_s": 1.0, "displacement_mm": 1.0, "force_stone": 1.0}, {}, 'column force_stone: unknown unit "stone"; use one of force_kN'),
    ({"time_s": 1.0, "displacement_mm": 1.0, "Strain": 1.0}, {}, "there is no force column; found"),
    ({"time_s": 1.0, "displacement_mm": 1.0, "force_kN": 1.0}, {"force": "Kraft"}, 'there is no column "Kraft"; found "time_s"'),
    ({"time_s": 1.0, "displacement_mm": 1.0, "force_kN": 1.0}, {"units": {"kraft": "N"}}, '--unit kraft=N: "kraft" is not a channel'),
    (
        {"time_s": 1.0, "displacement_mm": 1.0, "force_kN": 1.0},
        {"units": {"force": "N"}},
        "column force_kN: its name says kN, and --unit force=N says N; leave out --unit, or rename the column",
    ),
    ({"time_s": 1.0, "displacement_mm": 1.0, "Ch 4": 1.0}, {"force": "Ch 4", "units": {"force": "stone"}}, 'unknown unit "stone"'),
]


@pytest.mark.parametrize(("scales", "options", "text"), REFUSED, ids=[text for *_, text in REFUSED])
def test_a_frame_is_refused_as_a_file_of_the_same_columns(
    scales: dict[str, float], options: dict[str, Any], text: str, tmp_path: Path, hil: Any
) -> None:
    lab = of_a_lab(scales)
    path = tmp_path / "lab.csv"
    write_csv(path, lab)
    said = []
    for data in (path, lab, pandas.DataFrame(lab)):
        with pytest.raises(mesh_damper.InputError) as raised:
            mesh_damper.trace(data, **options)
        said.append(str(raised.value))
    assert text in said[1]
    # A file has an additional line of names.
    in_file = said[0].removeprefix(f"{path}: ").removeprefix("line 1: ")
    assert [each.removeprefix("recording: ") for each in said[1:]] == [in_file] * 2
    given = [f"--channel={channel}={name}" for channel, name in options.items() if channel != "units"]
    given += [f"--unit={channel}={unit}" for channel, unit in options.get("units", {}).items()]
    assert hil("trace", path, *given, "--out", tmp_path / "out").stderr == f"error: {said[0]}\n"


def test_an_answer_ends_the_question() -> None:
    lab = of_a_lab({"time_s": 1.0, "displacement_mm": 1.0, "Force 1 [kN]": 1.0, "Force 2 [kN]": 2.0})
    found = mesh_damper.trace(lab, force="Force 1 [kN]")
    assert found.assumed == []
    assert found.to_dict()["law"] == mesh_damper.trace(sine_block()).to_dict()["law"]


def test_a_unit_that_contradicts_a_labs_name_counts_and_is_said() -> None:
    lab = of_a_lab({"time_s": 1.0, "displacement_mm": 1.0, "Kraft [N]": 1.0})
    with pytest.warns(mesh_damper.GuessWarning) as warned:
        found = mesh_damper.trace(lab, units={"force": "kN"})
    assert [str(one.message) for one in warned] == [
        'recording: column "Kraft [N]" is read in kN, as --unit says, not in N, as the column says',
        'recording: force is read from column "Kraft [N]" in kN',
    ]
    assert found.to_dict()["law"] == mesh_damper.trace(sine_block()).to_dict()["law"]


def test_a_system_of_units_is_of_what_has_no_other() -> None:
    block = sine_block()
    mixed = {"time": block["time_s"], "displacement_mm": block["displacement_mm"], "force": 1e3 * block["force_kN"]}
    found = mesh_damper.trace(mixed, units="SI")
    assert found.assumed == []
    k1 = mesh_damper.trace(block).to_dict()["law"][0]["k1"]["value"]
    assert found.to_dict()["law"][0]["k1"]["value"] == pytest.approx(k1, rel=1e-6)


def test_what_is_held_out_is_never_fitted(columns: Columns, check: Columns) -> None:
    found = mesh_damper.trace(columns, held_out=check)
    assert found.to_dict()["held_out"] == ["held-out recording"]
    assert len(found.series(1)) == pytest.approx(len(check["time_s"]), rel=0.01)


BAD: list[tuple[Any, dict[str, Any], str]] = [
    ({"time_s": [0.0, 1.0]}, {}, "there is no displacement column"),
    (None, {}, "there is no recording"),
    (3.5, {}, "float is no recording"),
    (sine_block(), {"units": "cgs"}, "no system is called 'cgs'"),
    ({**sine_block(), "force_N": [1.0] * 2000}, {}, "column force_N: force_kN is also a force"),
    ({**sine_block(), "load [stone]": [1.0] * 2000}, {"force": "load [stone]"}, 'column load [stone]: unknown unit "stone"'),
    ({**sine_block(), "force_kN": ["a"] * 2000}, {}, "column force_kN: holds something else than numbers"),
    ({**sine_block(), "force_kN": [1.0] * 3}, {}, "3 rows, and time_s has 2000"),
    ({**sine_block(), "time_s": [0.0] * 2000}, {}, "time stands still"),
    (sine_block(), {"families": ["rust"]}, 'no effect is called "rust"'),
    (sine_block(), {"baseline": "cubic"}, 'no law is called "cubic"'),
    (sine_block(), {"law": 3}, "int is no model"),
    (sine_block(), {"time": -1.0}, "is not a valid time between samples"),
    ("recording.csv", {"force": [1.0, 2.0]}, "force= is no name of a column"),
    ("recording.csv", {"time": 0.0}, "is not a valid time between samples"),
    (polars.LazyFrame(sine_block()), {}, "recording: a LazyFrame has no values yet; give its .collect()"),
]


@pytest.mark.parametrize(("data", "options", "text"), BAD, ids=[text for *_, text in BAD])
def test_bad_input_is_a_value_error_of_one_line(data: Any, options: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError) as raised:
        mesh_damper.trace(data, **options)
    assert isinstance(raised.value, mesh_damper.InputError)
    assert text in str(raised.value) and "\n" not in str(raised.value)


def test_bad_files_are_refused_with_the_text_of_the_command(file: Path, tmp_path: Path, hil: Any) -> None:
    (tmp_path / "words.csv").write_text("time_s,displacement_mm,force_kN\n0,1,two\n")
    (tmp_path / "unit.csv").write_text("time_s,displacement_mm,force_stone\n0,1,2\n")
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "model.json").write_text("{}")
    for name in ("words.csv", "unit.csv", "empty.csv", "missing.csv", "."):
        path = tmp_path / name
        with pytest.raises(mesh_damper.InputError) as raised:
            mesh_damper.trace(path)
        assert f"error: {raised.value}\n" == hil("trace", path, "--out", tmp_path / "out").stderr
        assert isinstance(raised.value, FileNotFoundError) == (name == "missing.csv")
    with pytest.raises(mesh_damper.InputError) as raised:
        mesh_damper.trace(file, held_out=file)
    assert f"error: {raised.value}\n" == hil("trace", file, "--held-out", file, "--out", tmp_path / "out").stderr
    with pytest.raises(mesh_damper.InputError) as raised:
        mesh_damper.trace(file, law=tmp_path / "model.json")
    expected = hil("trace", file, "--law", tmp_path / "model.json", "--out", tmp_path / "out").stderr
    assert f"error: {raised.value}\n" == expected


def test_two_threads_trace_at_the_same_time() -> None:
    # Each trace waits at its first step for the other's first step. This would never happen if one blocked the other.
    both = threading.Barrier(2, timeout=60)
    steps: dict[str, list[str]] = {"a": [], "b": []}
    results: dict[str, str] = {}

    def work(name: str) -> None:
        def step(what: str) -> None:
            if not steps[name]:
                both.wait()
            steps[name].append(what)

        results[name] = mesh_damper.trace(sine_block(), progress=step).to_json()

    threads = [threading.Thread(target=work, args=(name,)) for name in steps]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results["a"] == results["b"]
    assert steps["a"][0] == "estimating the motion" and len(steps["a"]) > 2


def test_python_runs_while_the_core_works() -> None:
    # The core's thread does not return before the other thread has counted on. With the lock held, that thread could not count.
    counted, goes_on = [0], threading.Event()

    def count() -> None:
        while not goes_on.is_set():
            counted[0] += 1

    other = threading.Thread(target=count)
    other.start()
    before = counted[0]
    mesh_damper.trace(sine_block())
    after = counted[0]
    goes_on.set()
    other.join()
    assert after > before


def test_what_progress_raises_ends_the_trace() -> None:
    class Enough(Exception):
        pass

    def step(_: str) -> None:
        raise Enough

    with pytest.raises(Enough):
        mesh_damper.trace(sine_block(), progress=step)
    assert mesh_damper.trace(sine_block()).verdict


@pytest.mark.skipif(os.name == "nt", reason="left out: Windows sends Ctrl-C in another way")
def test_ctrl_c_ends_a_trace() -> None:
    program = textwrap.dedent(
        """
        import os, signal, mesh_damper
        from conftest import sine_block
        def step(what):
            os.kill(os.getpid(), signal.SIGINT)
        # A background job of a shell ignores the signal.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            mesh_damper.trace(sine_block(), progress=step)
        except KeyboardInterrupt:
            print("interrupted")
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        """
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=Path(__file__).parent, check=False)
    assert (done.returncode, done.stdout) == (0, "interrupted\n"), done.stderr


def test_pictures_page_and_report(found: mesh_damper.Trace, tmp_path: Path) -> None:
    figure = found.plot()
    assert len(figure.axes) == 2
    _, after, *_ = (line.get_ydata() for line in figure.axes[1].get_lines())
    series = found.series()
    left = (series["force_kN"] - series["after_kN"])[series["measured"]]
    assert np.allclose(after[np.isfinite(after)], left)
    assert found.plot("loop", block=0).axes[0].get_title() == "Loop: 0.0999 mm, 1 Hz, held out"
    with pytest.raises(mesh_damper.InputError, match="there is no block 99"):
        found.plot("loop", block=99)
    for ask in (found.plot, found.series):
        with pytest.raises(mesh_damper.InputError, match="recording: there is no recording 7; give 0 to 0"):
            ask(recording=7)
    page = found._repr_html_()
    assert len(page) < 20_000 and "stick-slip" in page and "<script" not in page
    found.report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text() == str(found.report())
    assert found.report()._repr_html_().startswith("<iframe")
    assert "stick_slip slip_limit" in repr(found)


def test_files_of_a_trace_are_written_all_or_none(found: mesh_damper.Trace, tmp_path: Path) -> None:
    resource: Any = pytest.importorskip("resource", reason="left out: this system does not limit the size of a file")
    names = ("model.json", "report.html", "trace.json")
    for name in names:
        (tmp_path / name).write_text("old")
    report = found.report()

    def unchanged() -> bool:
        return [(path.name, path.read_text()) for path in sorted(tmp_path.iterdir())] == [(name, "old") for name in names]

    # As on a full disk, a write ends after some bytes.
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    for save, place in ((found.save, tmp_path), (report.save, tmp_path / "report.html")):
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024, limits[1]))
        try:
            with pytest.raises(mesh_damper.InputError, match=r"\.(json|html): "):
                save(place)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        assert unchanged()
    # Only the last file cannot be written.
    (tmp_path / "report.html").unlink()
    (tmp_path / "report.html").mkdir()
    with pytest.raises(mesh_damper.InputError, match=r"report\.html"):
        found.save(tmp_path)
    assert (tmp_path / "trace.json").read_text() == (tmp_path / "model.json").read_text() == "old"
    found.save(tmp_path / "new" / "folder")
    assert sorted(path.name for path in (tmp_path / "new" / "folder").iterdir()) == list(names)


def test_known_effects_stay_in_the_law(columns: Columns, found: mesh_damper.Trace) -> None:
    again = mesh_damper.trace(columns, law=found)
    assert again.baseline.known == ("stick_slip",)
    assert again.verdict == "none"
    only = mesh_damper.trace(columns, families="viscous")
    assert only.verdict == "unlisted" or set(only.effects["family"]) <= {"viscous"}


def test_json_is_a_trace(found: mesh_damper.Trace) -> None:
    assert json.loads(found.to_json()) == found.to_dict()
    assert found.model["format"] == "mesh-damper-model"
