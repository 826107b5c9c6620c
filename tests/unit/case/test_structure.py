"""Structure of the case layer: what it imports, and what the blocks of a family have in common."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

from drillpetsc.case import Case
from drillpetsc.case.blocks.ends import DrivenTop, HeldTop, TopDrive
from drillpetsc.case.blocks.items.string import Beam, Pipe

ROOT = Path(__file__).parents[3]
ALLOWED = {
    "arrays",
    "case",
    "errors",
    "own_code",
    "time_function",
    "unit_systems",
    "unit_tables",
    "units",
    "version",
}


def imports_of(file: Path) -> set[str]:
    """Modules of the package that a file imports, at its top or inside functions."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("drillpetsc."):
            found.add(node.module)
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names if name.name.startswith("drillpetsc.")}
    return found


def test_no_module_of_the_case_layer_imports_one_that_imports_it() -> None:
    graph = {
        ".".join(file.relative_to(ROOT).with_suffix("").parts): imports_of(file)
        for file in (ROOT / "drillpetsc" / "case").rglob("*.py")
        if file.name != "__init__.py"
    }
    assert len(list(TopologicalSorter(graph).static_order())) > 20  # raises CycleError for a circle
    assert {module.split(".")[1] for modules in graph.values() for module in modules} <= ALLOWED


def test_reading_a_case_imports_no_solver() -> None:
    code = """
import sys, drillpetsc.case
print(*sorted({m.split(".")[1] for m in sys.modules if m.startswith("drillpetsc.")}))
print(*[m for m in ("petsc4py", "mpi4py", "numpy", "pint", "ruamel.yaml") if m in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    own, others = done.stdout.split("\n")[:2]
    assert set(own.split()) <= ALLOWED and others == ""


def test_every_top_has_the_attributes_of_all_tops() -> None:
    held, driven = HeldTop(kind="pinned"), DrivenTop(kind="driven", stiffness=1.0)
    assert (held.rotation, held.lowering, held.force) == (None, None, None)
    assert driven.force is None and driven.rotation is not None
    assert TopDrive(kind="top_drive").force is None
    assert HeldTop.keys() == ["kind"] and "force" not in DrivenTop.keys()


def test_every_item_has_the_attributes_of_all_items() -> None:
    case = Case(
        string=[
            {"kind": "pipe", "length": 9, "od": 0.127, "bend": {"angle": 0.01}},
            {"kind": "body", "length": 1, "mass": 10},
            {"kind": "bit", "length": 0.5, "od": 0.2159},
        ],
        top="clamped",
    )
    assert [item.bend is not None for item in case.string] == [True, False, False]
    assert [item.initial for item in case.string] == [None] * 3
    assert [item.nozzle_area for item in case.string] == [None] * 3
    assert "nozzle_area" not in Pipe.keys() and "material" not in Beam.keys()
    assert "bend" not in case.to_yaml().split("kind: bit")[1]
