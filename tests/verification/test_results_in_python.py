"""Results of commands in Python: tables, pictures, copies; and what importing the package loads."""

from __future__ import annotations

import copy
import os
import pickle
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.errors import CaseError

LENGTH, OD, ID, DENSITY, GRAVITY = 1000.0, 0.127, 0.1086, 7850.0, 9.80665
WEIGHT = np.pi / 4 * (OD**2 - ID**2) * DENSITY * GRAVITY  # per length [N/m]


def hanging(**more) -> dp.Case:
    """A pipe that hangs in air."""
    keys = {
        "title": "Hanging pipe",
        "string": [{"kind": "pipe", "length": LENGTH, "od": OD, "id": ID, "element_length": 50.0}],
        "material": {"density": DENSITY},
        "top": "clamped",
        "bottom": "free",
        "output": {"units": "field"},
    }
    return dp.Case(**(keys | more))


def test_statics_of_a_hanging_pipe(tmp_path: Path) -> None:
    """The tension at a depth is the weight below it."""
    result = dp.statics(hanging(), tmp_path / "out")
    table = result.statics
    tension = np.asarray(table["axial_force"])
    assert tension == pytest.approx(WEIGHT * (LENGTH - np.asarray(table["md"])), abs=1e-6 * WEIGHT * LENGTH)
    assert result.kind == "statics" and result.summary["hook_load"] == pytest.approx(WEIGHT * LENGTH)
    weight = dp.units.to(WEIGHT * LENGTH, "klbf")
    assert re.search(rf"Hook load +{weight:.6g} +klbf", str(result))
    assert f"<td>{weight:.6g}</td><td>klbf</td>" in result._repr_html_()
    assert result.string["position"].shape == (1, 21, 3)
    drawn = result.plot()
    assert any("klbf" in axes.get_xlabel() for axes in drawn.axes)
    assert result.plot("along_depth", units="metric") is not drawn
    assert list(tmp_path.glob("out/plots/*")) == []


def test_results_are_plain_data(tmp_path: Path) -> None:
    """Pickles and deep copies; nothing of PETSc is inside."""
    result = dp.statics(hanging(), tmp_path / "out")
    for again in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
        assert again == result and again.lines == result.lines
        assert np.array_equal(again.statics["axial_force"], result.statics["axial_force"])
    assert b"petsc4py" not in pickle.dumps(result)


def test_a_variation_in_the_same_folder_does_not_pass_for_the_first(tmp_path: Path) -> None:
    case = hanging()
    first = dp.statics(case, tmp_path / "out")
    second = dp.statics(case.replace({"string[0].length": 500.0}), tmp_path / "out", overwrite=True)
    assert second.summary["hook_load"] == pytest.approx(0.5 * WEIGHT * LENGTH)
    with pytest.raises(CaseError, match="another computation"):
        _ = first.statics
    assert dp.open_run(tmp_path / "out") == second or dp.open_run(tmp_path / "out").summary == second.summary


def test_a_run_and_its_continuation(tmp_path: Path) -> None:
    time = {"end": 0.02}
    case = hanging(time=time, initial={"from": "statics"}, output={"history_every": 0.01, "probes": [500.0]})
    first = dp.run(case, tmp_path / "run", progress="silent")
    assert np.asarray(first.history["time"]) == pytest.approx([0.0, 0.01, 0.02])
    assert float(first.history["hook_load"][-1]) == pytest.approx(WEIGHT * LENGTH, rel=1e-5)
    assert "spin_500" in first.probes and first.string["md"].size == 21
    kept, longer = dp.open_run(tmp_path / "run"), case.replace({"time.end": 0.04})
    again = dp.run(longer, tmp_path / "run", restart=True, progress="silent")
    assert again.history["time"].size == 5
    with pytest.raises(CaseError, match="another computation"):
        _ = kept.history
    done = dp.run(longer, tmp_path / "run", restart=True, progress="silent")  # nothing is left to do
    assert done.history["time"].size == 5


def test_importing_and_reading_load_no_other_package(tmp_path: Path) -> None:
    """Neither the package nor a result in a folder imports what it does not need."""
    dp.statics(hanging(), tmp_path / "out")
    code = f"""
import sys
import drillpetsc as dp
heavy = {{"numpy", "xarray", "pandas", "matplotlib", "petsc4py", "mpi4py", "pint"}}
assert not heavy & set(sys.modules), heavy & set(sys.modules)
result = dp.open_run({str(tmp_path / "out")!r})
print(result.summary["hook_load"])
print(result)
heavy -= {{"numpy"}}
assert not heavy & set(sys.modules), heavy & set(sys.modules)
"""
    root = str(Path(__file__).parents[2])
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {root!r})\n" + code],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_a_report_of_a_result(tmp_path: Path) -> None:
    """The figures of the page are those of the result, in the units asked for."""
    result = dp.statics(hanging(), tmp_path / "out")
    page = result.report(tmp_path / "page.html").read_text(encoding="utf-8")
    weight = dp.units.to(WEIGHT * LENGTH, "klbf")
    assert "Hanging pipe" in page and f"{weight:.3f}" in page and "klbf" in page
    assert result.report() == tmp_path / "out" / "report.html"
    metric = result.report(tmp_path / "metric.html", units="metric", sections=("string",)).read_text()
    assert "klbf" not in metric and ">kN<" in metric.replace("[kN]", ">kN<")
    for keywords, at in (
        ({"path": "a.pdf"}, "--out"),
        ({"units": "feet"}, "units"),
        ({"sections": ["a"]}, "--sections"),
    ):
        with pytest.raises(CaseError) as caught:
            result.report(**keywords)
        assert caught.value.at == at
    with pytest.raises(CaseError, match="that can be written"):
        result.report(tmp_path / "page.html" / "page.html")


SHORT_STEPS = {"ts_adapt_dt_max": 1e-4}  # a million of them: the run takes minutes


def test_an_interrupt_leaves_a_result_that_says_so(tmp_path: Path) -> None:
    """The first call of the progress function interrupts a run that would take minutes."""
    shares: list[float] = []

    def interrupt(share: float, text: str) -> None:
        shares.append(share)
        if len(shares) == 1:
            os.kill(os.getpid(), signal.SIGINT)

    case = hanging(
        time={"end": 1000.0}, initial={"from": "statics"}, output={"history_every": 0.05}, petsc=SHORT_STEPS
    )
    before = signal.getsignal(signal.SIGINT)
    result = dp.run(case, tmp_path / "run", progress=interrupt)
    assert signal.getsignal(signal.SIGINT) is before
    assert result.summary["interrupted"] and result.status != "done" and "interrupt" in str(result)
    rows = np.asarray(result.history["time"])
    assert rows[-1] <= result.summary["time"] < 1000 and 0 < shares[0] < 1


def test_a_progress_function_that_fails_ends_the_run_with_its_error(tmp_path: Path) -> None:
    def fail(share: float, text: str) -> None:
        raise ValueError("a slip in the notebook")

    case = hanging(
        time={"end": 1000.0}, initial={"from": "statics"}, output={"history_every": 0.05}, petsc=SHORT_STEPS
    )
    with pytest.raises(ValueError, match="a slip"):
        dp.run(case, tmp_path / "run", progress=fail)
    with pytest.raises(CaseError, match="a function"):
        dp.run(case, tmp_path / "other", progress="loud")
    assert not (tmp_path / "other").exists()


def test_a_progress_function_that_interrupts_leaves_a_folder_that_says_so(tmp_path: Path) -> None:
    """A KeyboardInterrupt from within ends the run at once; the folder holds what was written."""

    def stop(share: float, text: str) -> None:
        raise KeyboardInterrupt

    case = hanging(
        time={"end": 1000.0}, initial={"from": "statics"}, output={"history_every": 0.05}, petsc=SHORT_STEPS
    )
    with pytest.raises(KeyboardInterrupt):
        dp.run(case, tmp_path / "run", progress=stop)
    assert dp.open_run(tmp_path / "run").status == "interrupted"
