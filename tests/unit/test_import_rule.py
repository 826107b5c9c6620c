"""Imports point downward only: the contracts of pyproject.toml hold, and a wrong import breaks them."""

from __future__ import annotations

import graphlib
import shutil
import subprocess
import sys
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[2]


def lint(folder: Path) -> subprocess.CompletedProcess:
    """Check the import contracts of the package in ``folder``."""
    code = f"import sys; sys.path.insert(0, {str(folder)!r}); from importlinter.cli import lint_imports_command; lint_imports_command()"
    return subprocess.run(
        [sys.executable, "-P", "-c", code, "--no-cache"], cwd=folder, capture_output=True, text=True
    )


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    ignore = shutil.ignore_patterns("__pycache__", "*.so", "_build")
    shutil.copytree(ROOT / "drillpetsc", tmp_path / "drillpetsc", ignore=ignore)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_the_package_keeps_the_import_rule(copy: Path) -> None:
    done = lint(copy)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("file", "wrong"),
    [
        ("physics/beam.py", "from drillpetsc.analysis import check"),  # upward
        (
            "physics/beam.py",
            "from drillpetsc.solvers import newton",
        ),  # sideways: physics and solvers are blind to each other
        ("physics/joints.py", "from drillpetsc.case.case import Case"),  # physics does not know the case file
        ("case/block.py", "from drillpetsc.geometry import well"),  # sideways
        ("kernels/__init__.py", "from drillpetsc.fem import chain"),  # upward
    ],
)
def test_a_wrong_import_is_found(copy: Path, file: str, wrong: str) -> None:
    target = copy / "drillpetsc" / file
    target.write_text(target.read_text() + f"\n{wrong}\n")
    done = lint(copy)
    assert done.returncode != 0 and "BROKEN" in done.stdout, done.stdout + done.stderr


def test_no_modules_import_each_other() -> None:
    """Neither at run time, nor inside functions, nor for typing."""
    graph = grimp.build_graph("drillpetsc", exclude_type_checking_imports=False, cache_dir=None)
    imports = {module: set(graph.find_modules_directly_imported_by(module)) for module in graph.modules}
    graphlib.TopologicalSorter(imports).prepare()  # raises CycleError, which names the modules
