"""Runs the cells of the example one after another. `.ci/python full` runs them in Jupyter and renders the page."""

from __future__ import annotations

import json
from pathlib import Path

import mesh_damper
import pytest

NOTEBOOK = Path(__file__).parents[1] / "examples" / "damper.ipynb"


@pytest.mark.filterwarnings("ignore:the coefficients depend on the amplitude", "ignore:.*outside the operating range")
def test_the_cells_run() -> None:
    cells = [cell for cell in json.loads(NOTEBOOK.read_text())["cells"] if cell["cell_type"] == "code"]
    space: dict[str, object] = {}
    for number, cell in enumerate(cells):
        assert cell["outputs"] == [], "the notebook is kept without outputs"
        exec(compile("".join(cell["source"]), f"cell {number}", "exec"), space)
    found, again, law = space["found"], space["again"], space["law"]
    assert isinstance(found, mesh_damper.Trace) and isinstance(again, mesh_damper.Trace)
    assert isinstance(law, mesh_damper.DamperLaw)
    assert found.verdict == "found" and set(again.effects["family"]) == {"stick_slip"}
    assert law.score(space["y"], space["force"], t=space["t"]) > 0.995
