"""The walk-through "a new tool": its blocks are put into a copy of the package, whose runs have the tool (manual: sec-add-tool)."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import drillpetsc

PAGE = Path(__file__).parents[3] / "docs" / "development" / "add-tool.md"
FORCE, FREQUENCY, MASS, LENGTH, GRAVITY = 10e3, 2.0, 500.0, 10.0, 9.81
SCRIPT = """
import json, sys
import numpy as np
from drillpetsc import Case, modes, run, statics
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table

tool = {"kind": "exciter", "length": 1.0, "mass": MASS, "force": FORCE, "frequency": FREQUENCY}
keys = {
    "top": "clamped", "gravity": GRAVITY, "time": {"end": 1.0}, "output": {"history_every": 0.005},
    "petsc": {"ts_rtol": 1e-7},  # steps that keep the 3 % which ring
    "string": [{"kind": "pipe", "length": LENGTH, "od": 0.127, "id": 0.1086, "element_length": 5.0}, tool],
}
found = {"at rest": statics(Case(**keys), "rest").summary["hook_load"]}
result = run(Case(**keys), "run", progress="silent")
load = np.asarray(read_table("run/history.csv")["hook_load [N]"])
found |= {"least": load.min(), "largest": load.max(), "energy": abs(result.summary["energy"]["error_share"])}
found["modes"] = modes(Case(**keys), "modes", count=2).summary["warnings"]
try:
    Case(**(keys | {"string": [keys["string"][0], tool | {"force": "-3 kN"}]}))
except CaseError as error:
    found["refused"] = str(error)
print(json.dumps(found))
"""


def code(name: str) -> str:
    """The code block of the page with this name."""
    found = re.search(rf"```{{code-block}} python\n:name: {name}\n\n(.*?)^```", PAGE.read_text(), re.S | re.M)
    assert found is not None, name
    return found[1]


def put(file: Path, line: str, *, before: str) -> None:
    """Put a line before the first place of a file with a text, which begins a line."""
    text = file.read_text()
    assert "\n" + before in text, (file.name, before)
    file.write_text(text.replace("\n" + before, f"\n{line}\n{before}", 1))


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What a copy of the package with the tool computes."""
    folder = tmp_path_factory.mktemp("tool")
    package, copy = Path(drillpetsc.__file__).parent, folder / "drillpetsc"
    shutil.copytree(package, copy, ignore=shutil.ignore_patterns("_build"))  # compiled Python goes along
    (copy / "kernels" / "_build").symlink_to(package / "kernels" / "_build")  # there is no new kernel
    for name, file in (
        ("item", "case/blocks/items/exciter.py"),
        ("component", "physics/tools/exciter.py"),
        ("model", "model/tools/exciter.py"),
    ):
        (copy / file).write_text(code(f"add-tool-{name}"))
    items = copy / "case" / "blocks" / "items" / "tubulars.py"
    put(
        items,
        "from drillpetsc.case.blocks.items.exciter import ExciterTool",
        before="from drillpetsc.case.blocks.items.",
    )
    put(items, "    | ExciterTool", before="    | Stabilizer")
    model = copy / "model" / "drilling_model.py"
    put(
        model,
        "from drillpetsc.model.tools.exciter import build_exciters",
        before="from drillpetsc.model.",
    )
    put(model, code_line(), before="        *_optional_components(mesh, frames, gravity")
    (folder / "run.py").write_text(
        f"FORCE, FREQUENCY, MASS, LENGTH, GRAVITY = {FORCE}, {FREQUENCY}, {MASS}, {LENGTH}, {GRAVITY}\n"
        + SCRIPT
    )
    done = subprocess.run(
        [sys.executable, "run.py"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return dict(json.loads(done.stdout.splitlines()[-1]))


def code_line() -> str:
    """The line of the page for the model."""
    found = re.search(r"^ +\*build_exciters\(.*\),$", PAGE.read_text(), re.M)
    assert found is not None
    return found[0]


def weight() -> float:
    """Weight of pipe and exciter [N]."""
    area = 0.25 * 3.141592653589793 * (0.127**2 - 0.1086**2)
    return GRAVITY * (7850 * area * LENGTH + MASS)


def test_statics_has_the_weight_alone(answer: dict[str, Any]) -> None:
    assert answer["at rest"] == pytest.approx(weight(), rel=1e-6)


def test_the_top_feels_the_force(answer: dict[str, Any]) -> None:
    """2 Hz are far below the resonance of 500 kg on a pipe of 7e7 N/m, 59 Hz: the force arrives at the top, and 3 % of it rings from
    the start."""
    for extreme in (answer["largest"] - weight(), weight() - answer["least"]):
        assert extreme == pytest.approx(FORCE, rel=0.05)
    assert answer["energy"] < 0.01


def test_a_linear_model_leaves_it_out(answer: dict[str, Any]) -> None:
    assert [text for text in answer["modes"] if "the exciter is left out" in text]


def test_a_wrong_value_is_refused(answer: dict[str, Any]) -> None:
    assert "string[1].force" in answer["refused"] and "-3 kN" in answer["refused"]
