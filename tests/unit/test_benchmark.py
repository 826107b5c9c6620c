"""Reference solutions of the benchmark, compared with closed forms."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipk

from drillpetsc import Case

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "tools"))
import benchmark  # noqa: E402
import benchmark_reference as reference  # noqa: E402


def test_first_passage_of_the_torsional_wave():
    """The wave reaches the bit after L/c. It passes from pipe to collar with 2 Z1/(Z1 + Z2), where Z is
    proportional to the polar moment, and doubles at the free end. The next reflection arrives after 400 m."""
    c = np.sqrt(206e9 / 2.6 / 7850.0)
    pipe, collar = 0.127**4 - 0.1086**4, 0.1778**4 - 0.0714**4
    after = np.linspace(0.01, 0.12, 12)
    top = 80 * 2 * np.pi / 60 * 0.5 * (1 - np.cos(np.pi * after / 2))
    found = reference.exact_bit_speed(2000.0 / c + after, 1.0)
    assert found == pytest.approx(2 * 2 * pipe / (pipe + collar) * top, rel=0.01, abs=1e-5)
    assert np.all(reference.exact_bit_speed(np.linspace(0.0, 0.62, 20), 1.0) == 0.0)


def test_the_independent_integration_of_a_nearly_rigid_pendulum():
    """A hinged rod released at 60 degrees from the vertical hangs down after K(sin 30 deg) sqrt(2 L/(3 g))
    (elliptic integral)."""
    rod = {
        "kind": "beam",
        "length": 0.5,
        "axial_stiffness": 2e4,
        "bending_stiffness": 1.0,
        "torsional_stiffness": 1.0,
        "mass": 0.02,
        "polar_inertia": 1e-7,
        "element_length": 0.5,
    }
    case = Case(
        string=[rod],
        top="pinned",
        bottom="free",
        gravity=9.81,
        initial={"from": "straight", "inclination": np.pi / 3},
    )
    down = ellipk(0.25) * np.sqrt(2 * 0.5 / (3 * 9.81))
    north, depth = reference.free_motion(case, 1, np.array([0.0, down]), 1e-6).T
    assert north == pytest.approx([0.5 * np.sin(np.pi / 3), 0.0], abs=2e-3)
    assert depth == pytest.approx([0.25, 0.5], abs=1e-3)


def test_a_reference_is_computed_once_for_a_case(tmp_path, monkeypatch):
    """A second call reads the file; another text of the case, or ``fresh``, computes again."""
    monkeypatch.setenv("DRILLPETSC_CACHE", str(tmp_path / "cache"))
    case, calls = tmp_path / "some.yaml", []

    def compute() -> dict:
        calls.append(case.read_text())
        return {"value": float(len(calls))}

    case.write_text("gravity: 9.81 m/s2\n")
    assert [reference.cached(case, "kind", compute)["value"] for _ in range(2)] == [1.0, 1.0]
    assert reference.cached(case, "other", compute)["value"] == 2.0
    case.write_text("gravity: 1.62 m/s2\n")
    assert reference.cached(case, "kind", compute)["value"] == 3.0
    assert reference.cached(case, "kind", compute, fresh=True)["value"] == 4.0
    assert (
        len(list((tmp_path / "cache" / "references").iterdir())) == 3
    )  # two texts, two kinds; no scratch file is left


def test_means_are_taken_over_the_settled_part():
    history = {"time [s]": np.array([0.0, 1.0, 2.0, 3.0]), "hook_load [N]": np.array([100.0, 50.0, 7.0, 9.0])}
    assert reference.mean_of(history, "hook_load [N]", 2.0) == 8.0


def test_times_are_compared_by_scene_and_phase(tmp_path, capsys):
    """A phase that takes 1.5 times as long is marked; scenes and phases that only one run has are left out."""
    before = [{"case": "a", "seconds": {"motion": 2.0, "gone": 1.0}, "calls": {"residual": 1e-4}}]
    now = [
        {"case": "a", "seconds": {"motion": 1.0, "new": 1.0}, "calls": {"residual": 1.5e-4}},
        {"case": "b", "seconds": {"motion": 1.0}, "calls": {}},
    ]
    file = tmp_path / "before.json"
    file.write_text(json.dumps({"machine": "this one", "cases": before}))
    rows = benchmark.comparison(benchmark.read_stored(file, "this one"), now)
    assert [(row[:2], round(row[4], 12)) for row in rows] == [
        (("a", "motion"), 0.5),
        (("a", "one residual"), 1.5),
    ]
    benchmark.print_comparison(rows)
    lines = capsys.readouterr().out.splitlines()
    assert [line.endswith("slower") for line in lines[-2:]] == [False, True]


def test_times_of_another_machine_are_refused(tmp_path):
    file = tmp_path / "before.json"
    file.write_text(json.dumps({"machine": "another", "cases": []}))
    with pytest.raises(SystemExit, match="measured on another"):
        benchmark.read_stored(file, "this one")
    file.write_text("[1, 2]")
    with pytest.raises(SystemExit, match="no results"):
        benchmark.read_stored(file, "this one")
    with pytest.raises(SystemExit, match="no results"):
        benchmark.read_stored(tmp_path / "missing.json", "this one")
