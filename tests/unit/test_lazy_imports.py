"""Only what a command needs is imported: a start takes no longer than that."""

from __future__ import annotations

import json
from pathlib import Path

from tests.helpers.command import ROOT, python

DRAWN = ("matplotlib", "pyvista", "vtk", "vtkmodules", "meshio", "PIL")
PETSC = ("petsc4py", "mpi4py")
HEAVY = (
    "pint",
    "scipy.optimize",
    "scipy.special",
    "rich",
    "h5py",
    "drillpetsc.plotting",
    "drillpetsc.studies",
)
DRILLED = "pictures(Plan('', 'sweep.csv', Path('.'), Path('.'), (), ()), [{'wob [N]': 1.0}]) == []"
#: statements in turn in one process, and what none of them may have imported
STEPS = (
    ("import drillpetsc", (*DRAWN, *PETSC, "numpy")),
    ("from drillpetsc.cli import main; main(['--help'])", (*HEAVY, *DRAWN, "numpy", "pydantic")),
    ("main(['catalogue', '5in'])", (*PETSC, "numpy", "pint", "scipy", "ruamel.yaml")),
    ("import drillpetsc.output.catalogue as c; c.all_quantities()", (*PETSC, "drillpetsc.kernels")),
    (f"main(['check', '{ROOT}/cases/lying-string.yaml'])", (*HEAVY, *DRAWN)),
    ("import drillpetsc.output, drillpetsc.output.progress", (*DRAWN, "rich")),
    ("import drillpetsc.plotting.run.view, drillpetsc.plotting.run.plot", (*DRAWN, "rich")),
    ("from pathlib import Path; from drillpetsc.studies.sweep.table import Plan", ()),
    (f"from drillpetsc.studies.sweep.sweep import _pictures as pictures; assert {DRILLED}", ("matplotlib",)),
)


def test_nothing_is_imported_before_it_is_needed(tmp_path: Path) -> None:
    (tmp_path / "steps.json").write_text(json.dumps(STEPS))
    code = """
import json, sys
for code, heavy in json.load(open("steps.json")):
    try:
        exec(code)
    except SystemExit:
        pass
    found = [name for name in heavy if name in sys.modules]
    assert not found, (code, found)
"""
    done = python("-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
