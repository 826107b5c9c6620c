"""Notebooks of the manual: their cells run, and print what the manual shows."""

from __future__ import annotations

import importlib.util
import math
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
spec = importlib.util.spec_from_file_location("notebook_runner", ROOT / "docs" / "notebook_runner.py")
assert spec is not None and spec.loader is not None
notebook = importlib.util.module_from_spec(spec)
spec.loader.exec_module(notebook)
FILES = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def same(one: str, other: str) -> bool:
    """Equal words, and numbers equal to 1 % or one digit in the last place: machines round differently."""
    if NUMBER.sub("#", one) != NUMBER.sub("#", other):
        return False
    for a, b in zip(NUMBER.findall(one), NUMBER.findall(other), strict=True):
        place = 10.0 ** -len(a.partition(".")[2])
        if not math.isclose(float(a), float(b), rel_tol=0.01, abs_tol=1.01 * place):
            return False
    return True


def test_the_comparison_sees_other_numbers_and_words() -> None:
    assert same("hook load 286.4 klbf", "hook load 286.5 klbf")
    assert not same("hook load 286.4 klbf", "hook load 296.4 klbf")
    assert not same("hook load 286.4 klbf", "hook load 286.4 kN") and not same("1.0, 2.0", "1.0")


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_notebook_prints_what_it_shows(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("xarray")
    pytest.importorskip("pandas")
    (tmp_path / "cases").symlink_to(ROOT / "cases")
    monkeypatch.chdir(tmp_path)
    kept = notebook.read(file)
    cells = [cell for cell in kept["cells"] if cell["cell_type"] == "code"]
    for cell, outputs in zip(cells, notebook.run(kept), strict=True):
        shown, now = notebook.printed(cell["outputs"]), notebook.printed(outputs)
        assert same(shown, now), f"{notebook.source(cell)}\nshown:\n{shown}\nnow:\n{now}"
        kinds = [sorted(each.get("data", {})) for each in outputs]
        assert kinds == [sorted(each.get("data", {})) for each in cell["outputs"]]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_notebook_has_outputs_and_makes_a_page(file: Path) -> None:
    """Format 4.5 of nbformat: cells with an id; every cell that was run has its number."""
    kept = notebook.read(file)
    assert kept["nbformat"] == 4 and len({cell["id"] for cell in kept["cells"]}) == len(kept["cells"])
    code = [cell for cell in kept["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
    text, pictures = notebook.page(file.stem, kept)
    assert text.startswith(f"(notebook-{file.stem})=") and pictures
    assert all(data.startswith(b"\x89PNG") and name in text for name, data in pictures.items())
    for block in re.findall(r"```\{raw\} html\n(.*?)\n```", text, re.DOTALL):
        assert "<script" not in block and "\n\n" not in block
    assert file.stat().st_size < 400_000
