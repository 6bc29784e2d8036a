"""Types: of the package, of the compiled part compared with its stub, and as a user sees them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mesh_damper
import pytest

pytest.importorskip("mypy", reason="left out: mypy is not installed")


def run(module: str, *arguments: str, cwd: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-m", module, *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
        env=dict(os.environ),
    )
    return "" if done.returncode == 0 else done.stdout + done.stderr


def test_the_package_is_typed(tmp_path: Path) -> None:
    assert run("mypy", "--strict", "--package", "mesh_damper", cwd=tmp_path) == ""


def test_the_stub_is_that_of_the_compiled_part(tmp_path: Path) -> None:
    assert run("mypy.stubtest", "mesh_damper._core", "--ignore-disjoint-bases", cwd=tmp_path) == ""


def test_a_user_sees_types(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text(
        "import mesh_damper\n"
        'found = mesh_damper.trace("a.csv", held_out=["b.csv"], families=["viscous"])\n'
        "error: float = found.augmented.nrmse_held_out\n"
        "law: mesh_damper.DamperLaw = found.law\n"
        "reveal_type(found.verdict)\n"
        "found.plot('all', block='no')\n"
    )
    said = run("mypy", "--strict", "user.py", cwd=tmp_path)
    assert 'Revealed type is "str"' in said
    assert said.count("error:") == 1 and 'Argument "block"' in said, said
    assert (Path(mesh_damper.__file__).parent / "py.typed").exists()
