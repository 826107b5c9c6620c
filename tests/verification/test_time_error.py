"""Estimated time error of outputs, and what numerical damping removes (manual: verif-time-error)."""

from __future__ import annotations

import cmath
import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, load_case, run
from drillpetsc.analysis.motion.summary import closing_lines
from drillpetsc.errors import SolveError
from drillpetsc.output import read_table
from drillpetsc.output.balances.time_error import (
    LOSS,
    TimeError,
    damped_frequency,
    doubtful_outputs,
    time_error_lines,
)
from drillpetsc.solvers.time.alpha_formula import AlphaFormula, AlphaOutputErrors
from drillpetsc.solvers.time.local_error import local_error_weights, local_errors

CASES = Path(__file__).parents[2] / "cases"
#: torsion pendulum: k/J = 100 /s2, stopped from 1 rad/s at 0.1 s
OMEGA, INERTIA, SPEED, STOP, END = 10.0, 2.0, 1.0, 0.1, 9.1


def root(order: int, phase: float) -> complex:
    """The principal root of BDF for x' = i w x with w h = phase: x grows by it in a step."""
    backward = np.poly1d([0.0])
    for j in range(1, order + 1):  # sum of (1 - 1/z)^j / j = i w h, times z^order
        backward = backward + np.poly1d([1.0, -1.0]) ** j * np.poly1d([1.0] + [0.0] * (order - j)) * (1.0 / j)
    roots = (backward - np.poly1d([1j * phase] + [0.0] * order)).roots
    return complex(min(roots, key=lambda z: abs(z - cmath.exp(1j * phase))))


@pytest.mark.parametrize("order", [1, 2])
def test_damped_frequency_against_the_characteristic_root(order):
    """At that frequency the principal root loses 1 % of an amplitude in a period, but for higher terms in w h:
    0.92 % for order 2."""
    h = 0.01
    phase = 2 * np.pi * damped_frequency(order, h) * h
    loss = 1 - abs(root(order, phase)) ** (2 * np.pi / phase)
    assert loss == pytest.approx(LOSS, rel=0.1)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_estimate_of_an_undamped_vibration(order):
    """BDF's own solution of x' = i w x, started exactly: the estimate is the largest error of Re x, to 15 %."""
    h, periods = {1: 2e-4, 2: 0.02, 3: 0.05}[order], 10
    n = int(periods * 2 * np.pi / h)
    z, t = root(order, h), h * np.arange(n)
    computed, exact = (z ** np.arange(n)).real, np.cos(t)
    estimate = TimeError(order, ["x"], ["m"], [1])
    for k in range(n):
        estimate.step(t[k], h, np.array([computed[k]]), k == 0)
    column = estimate.summary()["columns"]["x [m]"]
    assert column["error"] == pytest.approx(np.abs(computed - exact).max(), rel=0.15)
    assert column["share"] == pytest.approx(column["error"] / 2, rel=0.02)
    if order == 2:  # the relative error of the frequency
        assert column["pace"] == pytest.approx(1 - cmath.phase(z) / h, rel=0.05)


def test_steps_without_an_estimate_are_not_called_accurate():
    """Four steps, each the first after a jump, have no divided difference: no error is given, and the report says why."""
    estimate = TimeError(2, ["x"], ["m"], [1])
    for k, value in enumerate((0.0, 1.0, 0.2, 0.7)):
        estimate.step(float(k), 1.0, np.array([value]), True)
    found = estimate.summary()
    assert found["columns"]["x [m]"]["share"] is None
    assert time_error_lines(found) == [
        "  time error: no estimate, 4 steps are too few for one (run --check-tolerance measures it)"
    ]


def test_an_output_that_jumps_is_not_called_accurate():
    """A force of dry friction beside a slow parabola: the report gives the error of the position and names the force."""
    estimate = TimeError(2, ["x", "force"], ["m", "N"], [1, 1])
    for k in range(40):
        estimate.step(0.1 * k, 0.1, np.array([0.01 * k**2, float((-1) ** (k // 3))]), k == 0)
    columns = estimate.summary()["columns"]
    assert columns["force [N]"]["share"] is None and columns["x [m]"]["share"] < 0.01
    (line,) = time_error_lines(estimate.summary())
    assert "each other main output; no estimate of force, which jumps between steps" in line


@pytest.mark.parametrize("radius", [1.0, 0.9, 0.8, 0.5, 0.0])
def test_estimate_of_an_undamped_vibration_with_generalised_alpha(radius):
    """The formula's own solution of x'' = -w^2 x, started exactly, at even steps: the largest error of x, to 15 %."""
    formula, h, periods = AlphaFormula(radius), 0.02, 10
    n = int(periods * 2 * np.pi / h)
    z, t = formula.amplification(h), h * np.arange(n)
    computed, exact = (z ** np.arange(n)).real, np.cos(t)
    estimate = TimeError(AlphaOutputErrors(formula), ["x"], ["m"], [1])
    for k in range(n):
        estimate.step(t[k], h, np.array([computed[k]]), k == 0)
    column = estimate.summary()["columns"]["x [m]"]
    assert column["error"] == pytest.approx(np.abs(computed - exact).max(), rel=0.15)
    assert column["pace"] == pytest.approx(
        1 - cmath.phase(z) / h, rel=0.05
    )  # the relative error of the frequency
    assert estimate.damped_above() is None  # the integrator knows it


def test_third_differences_at_uneven_steps():
    """Of a cubic: phase error h^3 times its third derivative, with the last step."""
    t, formula = np.cumsum([0.0, 0.1, 0.3, 0.2, 0.05]), AlphaFormula(0.8)
    e = AlphaOutputErrors(formula).local_errors(t, (t**3)[:, None])
    assert e[:, 0] == pytest.approx(formula.phase_error * 6 * np.array([0.2, 0.05]) ** 3, rel=1e-9)


def test_local_errors_together_and_one_by_one():
    """All local errors of a series at uneven steps at once, against those of each step."""
    rng = np.random.default_rng(2)
    t, x = np.cumsum(rng.uniform(0.5, 1.5, 20)), rng.standard_normal((20, 3))
    for order in (1, 2, 3):
        together = local_errors(t, x, order)
        for k, e in enumerate(together):
            part = slice(k, k + order + 2)
            assert e == pytest.approx(
                local_error_weights(list(t[part]), order) @ x[part], rel=1e-10, abs=1e-12
            )


def test_an_output_that_switches_has_no_estimate():
    """A square wave has no Taylor series: no number is better than a false one.  A ramp has no error, and a
    constant is left out."""
    estimate = TimeError(2, ["square", "ramp", "constant"], ["N", "m", "-"], [1, 1, 1])
    for k in range(400):
        estimate.step(0.01 * k, 0.01, np.array([float(k // 20 % 2), 0.01 * k, 3.0]), k == 0)
    columns = estimate.summary()["columns"]
    assert columns["square [N]"]["share"] is None
    assert columns["ramp [m]"]["share"] < 1e-9
    assert "constant [-]" not in columns


def test_a_continued_estimate_is_that_of_one_run():
    """State of a checkpoint: the same numbers, up to the order of summation."""
    rng = np.random.default_rng(1)
    steps, values = rng.uniform(0.01, 0.02, 60), np.sin(0.1 * np.arange(60))[:, None] * [1, 2, 3]
    whole, first, second = (TimeError(2, ["a", "b"], ["m", "N"], [1, 2]) for _ in range(3))
    for k, t in enumerate(np.cumsum(steps)):
        whole.step(t, steps[k], values[k], k == 0)
        (first if k < 30 else second).step(t, steps[k], values[k], k == 0)
        if k == 29:
            second.set_state(first.get_state())
    columns, expected = second.summary()["columns"], whole.summary()["columns"]
    assert columns.keys() == expected.keys()
    for title, column in columns.items():
        assert column["range"] == expected[title]["range"]
        assert column["share"] == pytest.approx(expected[title]["share"], rel=1e-12)
    assert second.damped_above() == whole.damped_above()


def pendulum(folder: Path, **petsc) -> dict:
    """Summary of a run of the torsion pendulum: a disc on a shaft that turns rigidly until its top stops."""
    case = Case(
        string=[
            {
                "kind": "beam",
                "length": 1,
                "axial_stiffness": 1e6,
                "bending_stiffness": 1e4,
                "torsional_stiffness": INERTIA * OMEGA**2,
                "mass": 1,
                "polar_inertia": 1e-9,
                "element_length": 1,
            },
            {"kind": "body", "length": 0.1, "mass": 10, "inertia": {"axial": INERTIA, "transverse": 1}},
        ],
        top={
            "kind": "top_drive",
            "rotation": {"time": [0, STOP, STOP, END + 1], "value": [SPEED, SPEED, 0, 0]},
        },
        bottom="free",
        gravity=0,
        time={"end": END},
        output={"history_every": 0.02},
        petsc=petsc,
    )
    return run(case, folder, progress="silent").summary


def test_torsion_pendulum_states_its_error_and_damping(tmp_path):
    """Fixed steps with w h = 0.1 over 14 periods.  After the top's stop the disc swings with w = sqrt(k/J):
    estimated error of its speed within 25 % of the largest error; damped energy that of BDF2's root to 5 %."""
    h = 0.01
    summary = pendulum(tmp_path / "out", ts_adapt_type="none", ts_dt=h, ts_rtol=1e-8)
    history = read_table(tmp_path / "out" / "history.csv")
    t, speed = history["time [s]"], history["bit_speed [rad/s]"]
    swings = t > STOP
    error = np.abs(speed - SPEED * np.cos(OMEGA * (t - STOP)))[swings].max()
    estimate = summary["error_estimate"]["outputs"]["columns"]["bit_speed [rad/s]"]
    assert estimate["error"] == pytest.approx(error, rel=0.25)
    assert estimate["range"] == pytest.approx(2 * SPEED, rel=0.01)
    steps, start = (END - STOP) / h, 0.5 * INERTIA * SPEED**2
    assert summary["energy"]["damped"] == pytest.approx(
        start * (1 - abs(root(2, OMEGA * h)) ** (2 * steps)), rel=0.05
    )
    assert summary["error_estimate"]["damped_above"] == pytest.approx(damped_frequency(2, h), rel=1e-6)
    lines = "\n".join(closing_lines(summary, tmp_path))
    assert "bit_speed" in lines
    assert "--check-tolerance" in lines
    removed = f"removed {summary['energy']['damped']:.3g} J" in lines
    assert removed == (summary["energy"]["damped_share"] > 0.01)


@pytest.mark.parametrize("radius", [0.8, 0.5])
def test_torsion_pendulum_with_generalised_alpha(tmp_path, radius):
    """The same motion: estimated error of the speed within 25 % of the largest error, and ten times below BDF's at most."""
    h = 0.01
    petsc = {
        "ts_type": "alpha2",
        "ts_alpha_radius": radius,
        "ts_adapt_type": "none",
        "ts_dt": h,
        "ts_rtol": 1e-8,
    }
    summary = pendulum(tmp_path / "out", **petsc)
    history = read_table(tmp_path / "out" / "history.csv")
    t, speed = history["time [s]"], history["bit_speed [rad/s]"]
    swings = t > STOP
    error = np.abs(speed - SPEED * np.cos(OMEGA * (t - STOP)))[swings].max()
    estimate = summary["error_estimate"]["outputs"]["columns"]["bit_speed [rad/s]"]
    assert estimate["error"] == pytest.approx(error, rel=0.25)
    assert summary["error_estimate"]["damped_above"] > damped_frequency(2, h)
    assert "bit_speed" in "\n".join(closing_lines(summary, tmp_path))


def test_an_accurate_run_says_so(tmp_path):
    """The same motion at a tolerance of 1e-6: an estimate below 1 % in summary and report."""
    summary = pendulum(tmp_path / "out", ts_rtol=1e-6)
    outputs = json.loads((tmp_path / "out" / "summary.json").read_text())["error_estimate"]["outputs"]
    assert not doubtful_outputs(outputs)
    assert time_error_lines(outputs) == [
        "  time error, estimated: at most 1 % of the range of each main output"
    ]
    assert summary["energy"]["damped_share"] < 1e-3


#: (case, end [s], tolerance, integrator): outputs are compared with a run at a hundredth of the tolerance
MEASURED = [
    (name, end, 1e-4, kind)
    for kind in ("bdf", "alpha2")
    for name, end in (
        ("verification/study-pendulum.yaml", 0.5),
        ("benchmark/hanging-string.yaml", 2.0),
        ("lying-string.yaml", 1.0),
    )
]


@pytest.mark.parametrize(("name", "end", "tolerance", "kind"), MEASURED)
def test_estimates_are_within_a_factor_of_five(tmp_path, name, end, tolerance, kind):
    """Motions of the lower end, and the surface torque: largest error against a run at a hundredth of the
    tolerance, by the estimate, is between 1/5 and 5."""
    case = load_case(CASES / name)
    histories = []
    for rtol in (tolerance, tolerance / 100):
        changed = {
            "time": case.time.model_copy(update={"end": end}),
            "petsc": {k: v for k, v in case.petsc.items() if not k.startswith("ts_bdf_")}
            | {"ts_rtol": rtol, "ts_type": kind},
        }
        result = run(case.model_copy(update=changed), tmp_path / f"{rtol:g}", progress="silent")
        histories.append((read_table(result.folder / "history.csv"), result.summary))
    (coarse, summary), (fine, _) = histories
    compared = 0
    for title, column in summary["error_estimate"]["outputs"]["columns"].items():
        if title.startswith(("bit_speed", "bit_depth", "surface_torque")):
            error = np.abs(coarse[title] - fine[title]).max() / np.ptp(fine[title])
            assert 0.2 * error < column["share"] < 5 * error, title
            compared += 1
    assert compared


def test_no_estimate_without_inertia_or_bdf(tmp_path):
    """Other integrators state none: no number instead of a wrong one."""
    summary = pendulum(tmp_path / "theta", ts_type="theta", ts_adapt_type="none", ts_dt=0.02)
    assert "outputs" not in (summary["error_estimate"] or {})
    assert "newton" not in summary["energy"]


@pytest.mark.parametrize("last", [1, 2, 20])
def test_the_estimate_of_a_restarted_run_is_that_of_one_run(tmp_path, last):
    """Axial waves, continued after 1, 2 and 20 steps: local errors by unknown and their steps are bit for bit those of an
    uninterrupted run, with one gap of three steps at the start of the formula."""
    case = Case(
        string=[{"kind": "pipe", "length": 100, "od": 0.127, "id": 0.1086}],
        top="clamped",
        bottom={"kind": "force", "force": [0, 0, 1e5]},
        initial={"from": "rest"},
        time={"end": 0.1},
        output={"history_every": 0.05},
    )
    whole = run(case, tmp_path / "whole", progress="silent").summary["error_estimate"]
    part = case.model_copy(update={"petsc": {"ts_max_steps": last}})
    with pytest.raises(SolveError, match="ts_max_steps"):
        run(part, tmp_path / "part", progress="silent")
    continued = run(case, tmp_path / "part", progress="silent", restart=True).summary["error_estimate"]
    assert continued["time"] == whole["time"]
    assert whole["time"]["steps_without"] == 3
    assert continued["outputs"]["steps_without"] == whole["outputs"]["steps_without"] == 3
    for title, column in whole["outputs"]["columns"].items():
        assert continued["outputs"]["columns"][title]["error"] == pytest.approx(column["error"], rel=1e-12)


def test_rounding_of_a_speed_is_no_error():
    """A string that does not turn has a bit speed of some 1e-10 rad/s, which was "over 100 % of the range"."""
    error, rng = TimeError(2, ["bit_speed", "torque"], ["rad/s", "N m"], [1, 1]), np.random.default_rng(5)
    for k in range(100):
        error.step(0.1 * k, 0.1, rng.normal(0.0, [1e-10, 1e-8], 2), k < 3)
    assert error.summary()["columns"] == {}
