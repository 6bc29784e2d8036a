"""The functions other than `trace`: respond, export, characterize, simulate."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mesh_damper
import numpy as np
import pandas
import polars
import pytest
from conftest import Columns, sine_block

SPRING = {
    "format": "mesh-damper-model",
    "version": 1,
    "units": {"displacement": "mm", "force": "kN", "time": "s", "temperature": "degC"},
    "law": [{"amplitude": 0.0, "k1": 4.0, "k3": 0.0, "c": 0.02, "alpha": 1.0}],
    "effects": [],
    "fitted_range": {"displacement": [-1.0, 1.0], "velocity": [-100.0, 100.0]},
}


def test_one_thing_drives_the_mass() -> None:
    t = np.arange(0.0, 1.0, 1e-3)
    given: dict[str, Any] = {"mass": 1.0, "t": t, "units": "mm-kN-s"}
    with pytest.raises(mesh_damper.InputError, match="nothing drives the mass; give a force on it or a motion of its base"):
        mesh_damper.respond(SPRING, **given)
    with pytest.raises(mesh_damper.InputError, match="force= and base= are both given; give one, and leave the other out"):
        mesh_damper.respond(SPRING, **given, force=np.sin(t), base=np.sin(t))
    with pytest.raises(mesh_damper.InputError, match="a LazyFrame has no values yet"):
        mesh_damper.respond(SPRING, **given, force=polars.LazyFrame({"force_kN": np.sin(t)}))


def test_a_mass_on_a_spring_and_a_dashpot_moves_as_in_closed_form() -> None:
    # m·x'' + c·x' + k·x = f·sin ωt with m = 100 kg, k = 4e6 N/m, c = 2e4 N·s/m, long after the start.
    mass, k, c, omega = 100.0, 4e6, 2e4, 2 * np.pi * 20.0
    t = np.arange(0.0, 2.0, 1e-3)
    moved = mesh_damper.respond(SPRING, mass=mass, force=np.sin(omega * t), t=t, units="mm-kN-s")
    late = t > 1.5
    x = np.asarray(moved.motion["displacement_mm"])[late]
    expected = 1e3 * 1e3 / abs(k - mass * omega**2 + 1j * c * omega)
    assert np.max(np.abs(x)) == pytest.approx(expected, rel=0.005)
    assert moved.settled and moved.left_out == {} and moved.warnings == []
    energy = moved.energy
    assert energy["input"] == pytest.approx(sum(energy[part] for part in ("kinetic", "elastic", "dissipated", "residual")))
    swept = mesh_damper.transmissibility(SPRING, mass=mass, amplitudes=0.1, start=10, stop=40, points=4)
    for _, row in swept.iterrows():
        s = 2j * np.pi * row["frequency"]
        assert row["transmissibility"] == pytest.approx(abs((c * s + k) / (mass * s**2 + c * s + k)), rel=0.01)


def test_a_response_is_that_of_the_command(found: mesh_damper.Trace, check: Columns, tmp_path: Path, hil: Any) -> None:
    base = pandas.DataFrame({name: check[name][:1500] for name in ("time_s", "displacement_mm")})
    base.to_csv(tmp_path / "base.csv", index=False)
    found.save(tmp_path)
    done = hil(
        "respond",
        "--model",
        tmp_path / "model.json",
        "--mass",
        120,
        "--base",
        tmp_path / "base.csv",
        "--out",
        tmp_path / "response.csv",
    )
    assert done.returncode == 0, done.stderr
    expected = pandas.read_csv(tmp_path / "response.csv", comment="#")
    moved = mesh_damper.respond(found, mass=120, base=base).motion
    assert list(moved.columns) == list(expected.columns)
    assert np.allclose(moved, expected, rtol=1e-8, atol=1e-12)


def test_an_export_is_that_of_the_command(found: mesh_damper.Trace, tmp_path: Path, hil: Any) -> None:
    found.save(tmp_path)
    for ending in ("mdcp", "rs", "c"):
        path = tmp_path / f"mount.{ending}"
        written = mesh_damper.export(found, path, tick_rate=10_000, revision=3, amplitude=_amplitude(found))
        assert written["revision"] == 3 and written["files"][-1]["bytes"] == path.stat().st_size
        bytes_here = path.read_bytes()
        given = ["--amplitude", _amplitude(found)] if _amplitude(found) else []
        word = {"mdcp": "pack", "rs": "rust", "c": "c"}[ending]
        done = hil(
            "export",
            "--model",
            tmp_path / "model.json",
            "--format",
            word,
            "--tick-rate",
            10_000,
            "--revision",
            3,
            *given,
            "--out",
            path,
        )
        assert done.returncode == 0, done.stderr
        assert path.read_bytes() == bytes_here
    assert (tmp_path / "mount.h").exists()


def _amplitude(found: mesh_damper.Trace) -> float | None:
    law = found.model["law"]
    return law[-1]["amplitude"] if len(law) > 1 else None


def test_a_refused_export_leaves_no_file(tmp_path: Path) -> None:
    for options, text in (
        ({"tick_rate": 0.0}, "--tick-rate"),
        ({"tick_rate": 1e4, "name": "x" * 40}, "has 40 bytes, and a pack holds 32"),
        ({"tick_rate": 1e4, "amplitude": 0.1}, "the same coefficients at every amplitude"),
        ({"tick_rate": 1e4, "format": "elf"}, 'no format is called "elf"'),
        ({"tick_rate": 1e4, "format": "fmu"}, "mesh_damper_fmu"),
    ):
        with pytest.raises(mesh_damper.InputError, match=text):
            mesh_damper.export(SPRING, tmp_path / "mount.mdcp", **options)  # type: ignore[arg-type]
    with pytest.raises(mesh_damper.InputError, match="its ending does not give the format"):
        mesh_damper.export(SPRING, tmp_path / "mount.bin", tick_rate=1e4)
    assert list(tmp_path.iterdir()) == []


def test_stiffness_and_loss_factor_are_those_of_the_loop() -> None:
    block = sine_block(seconds=8.0)
    found = mesh_damper.characterize(block)
    assert found.kind == "dynamic" and len(found.blocks) == 1
    row = found.blocks.iloc[0]
    assert row["frequency"] == pytest.approx(2.0, rel=1e-3)
    # Eq 3 uses the extremes of the force, which include the dashpot's.
    velocity = 0.4 * np.pi * np.cos(4 * np.pi * block["time_s"])
    force = 8.0 * block["displacement_mm"] + 0.05 * np.sign(velocity) * np.abs(velocity) ** 0.4
    assert row["stiffness"] == pytest.approx(np.ptp(force) / 0.2, rel=0.005)
    assert len(found.cycles) == len(found.cycles["block"]) and len(found.cycles) >= 14
    assert "Characterization: dynamic, 1 block" in found._repr_html_()
    assert len(found.plot().axes) == 1
    turns = np.abs(np.mod(np.arange(0, 4, 0.005), 2.0) - 1.0)
    travel = 0.5 * (1.0 - turns)
    press = {
        "time_s": np.arange(0, 4, 0.005),
        "displacement_mm": travel,
        "force_kN": 2.0 * travel + 0.05 * np.where(np.mod(np.arange(0, 4, 0.005), 2.0) <= 1.0, 1.0, -1.0),
    }
    slow = mesh_damper.characterize(press, kind="static")
    assert slow.blocks["mean_equivalent_stiffness"].iloc[0] == pytest.approx(2.0, rel=0.02)
    assert slow.cycles["loss_factor"].iloc[0] == pytest.approx(2 * 0.05 * 0.5 / (np.pi * 0.25), rel=0.05)


def test_a_characterization_is_that_of_the_command(file: Path, hil: Any) -> None:
    done = hil("characterize", file, "--dynamic", "--json", "-")
    assert mesh_damper.characterize(file).to_json() == done.stdout


def test_the_size_of_a_file_is_limited_in_every_function(file: Path) -> None:
    for function in (
        mesh_damper.trace,
        mesh_damper.characterize,
        lambda path, max_read: mesh_damper.respond(SPRING, mass=100.0, force=path, max_read=max_read),
    ):
        with pytest.raises(mesh_damper.InputError, match="raise the limit with --max-read"):
            function(file, max_read=4096)


def test_a_simulation_is_drawn_by_its_seed() -> None:
    one, same, other = mesh_damper.simulate(3), mesh_damper.simulate(3), mesh_damper.simulate(3, "check")
    assert one.hidden == same.hidden == other.hidden
    assert one.recording.equals(same.recording) and not one.recording.equals(other.recording)
    assert json.dumps(one.hidden)
    with pytest.raises(ValueError, match="no test is called 'other'"):
        mesh_damper.simulate(3, "other")  # type: ignore[arg-type]
