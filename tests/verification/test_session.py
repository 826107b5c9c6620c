"""A session advances a model as a run does, and its state replays to the last bit (manual: sec-session)."""

from __future__ import annotations

import gc
import resource
from pathlib import Path

import numpy as np
import pytest

import drillpetsc
from drillpetsc import Case, load_case, run
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import read_table
from tests.helpers import top_drive_models as m

LYING = Path(__file__).parents[2] / "cases" / "lying-string.yaml"
FIXED = {"ts_adapt_type": "none", "ts_dt": 2.5e-3}


@pytest.mark.parametrize("count", [20, pytest.param(200, marks=pytest.mark.slow)])
def test_a_session_equals_a_run(count, tmp_path):
    """C31: ``count`` steps of 0.05 s of the lying string, both with inner steps of 2.5 ms, which meet the grid.

    Positions within 1e-9 m, forces within 1e-6 of the largest.  With steps of their own the two differ by the tolerance
    of the time integration, since a session's steps end on its grid and a run's do not.
    """
    case = load_case(LYING).replace(
        {"time.end": 0.05 * count, "petsc.ts_adapt_type": "none", "petsc.ts_dt": 2.5e-3}
    )
    run(case, tmp_path / "run", progress="silent")
    table = read_table(tmp_path / "run" / "history.csv")
    names = ["bit_depth", "hook_load", "surface_torque", "bit_speed"]
    rows = []
    with drillpetsc.Session(case) as s:
        for _ in range(count):
            s.step(0.05)
            rows.append([s.time, *s.get_many(names)])
    got = np.array(rows).T
    assert got[0] == pytest.approx(table["time [s]"][1:], abs=1e-12)
    columns = {title.split(" ")[0]: values for title, values in table.items()}
    assert np.abs(got[1] - columns["bit_depth"][1:]).max() < 1e-9
    for k, name in enumerate(names[1:], 2):
        size = np.abs(columns[name]).max()
        assert np.abs(got[k] - columns[name][1:]).max() < 1e-6 * size, name


def drive(**more) -> Case:
    """Ten metres of pipe under a drive whose torque is limited, from rest."""
    pipe = {"kind": "pipe", "length": 10.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}
    keys = {
        "string": [pipe],
        "top": m.top("stiff", 5.0, max_torque=20e3),
        "gravity": 0.0,
        "initial": {"from": "rest"},
    }
    return Case(**{**keys, **more})


@pytest.mark.parametrize("speed", [None, 5.05, 12.0])
def test_a_state_replays_to_the_last_bit(speed):
    """From a state on, with an input left alone, changed a little, and changed by so much that the formula restarts."""
    with drillpetsc.Session(drive()) as s:
        s.step(0.3)
        state, replays = s.state(), []
        for _ in range(2):
            s.set_state(state)
            assert s.time == 0.3
            if speed is not None:
                s.set("top.rotation", speed)
            values = []
            for _ in range(10):
                s.step(0.02)
                values.append(s.get_many(["top_speed", "motor_torque", "bit_speed"]))
            replays.append(values)
        assert replays[0] == replays[1]


def test_a_controller_in_python_is_the_controller_of_the_case():
    """A PI law in Python that sets the torque every 2 ms, against the same law as states: speed within 1 % of the step.

    The torque is held for 2 ms, 1 ms late on average: p/I * 1 ms = 0.3 % of the speed's change.
    """
    p, i = 8e3, 12e3
    with (
        drillpetsc.Session(drive(top=m.top({"kind": "pi", "p": p, "i": i}, 0.0))) as inner,
        drillpetsc.Session(
            drive(top={"kind": "top_drive", "motor": {"inertia": m.INERTIA}, "torque": 0.0})
        ) as outer,
    ):
        inner.set("top.rotation", 10.0)
        integral, differences = 0.0, []
        for k in range(500):
            error = 10.0 - outer.get("top_speed")
            integral += 2e-3 * error
            outer.set("top.torque", p * error + i * integral)
            outer.step(2e-3)
            inner.step(2e-3)
            differences.append(outer.get("top_speed") - inner.get("top_speed"))
            assert k < 400 or inner.get("top_speed") > 9
        assert np.abs(differences).max() < 0.1


def test_inputs_on_straight_lines_have_no_jump():
    """A prescribed speed on a line from 5 to 6 rad/s over 0.1 s: the top turns by its area, and the formula does not restart."""
    held = {"kind": "top_drive", "rotation": 5.0}
    with drillpetsc.Session(drive(top=held), interpolate="linear") as s:
        s.step(0.1)
        s.set("top.rotation", 6.0)
        s.step(0.1)
        s.step(0.1)
        spin = s._model.system.field("string.spin")[0, 0]
        assert spin == pytest.approx(5 * 0.1 + 5.5 * 0.1 + 6 * 0.1, abs=1e-9)


def test_wrong_calls_are_answered():
    with drillpetsc.Session(drive()) as s:
        assert {q.name for q in s.inputs} == {"top.rotation", "top.lowering"}
        assert {"top_speed", "bit_speed", "hook_load"} <= {q.name for q in s.outputs}
        for call, text in (
            (lambda: s.set("top.rotationx", 1.0), "set: no input 'top.rotationx'; nearest: top.rotation"),
            (lambda: s.get("bit_sped"), "get: no output 'bit_sped'; nearest: bit_speed"),
        ):
            with pytest.raises(LookupError) as error:
                call()
            assert str(error.value) == text
        with pytest.raises(ValueError, match="finite"):
            s.set("top.rotation", float("nan"))
        with pytest.raises(ValueError, match=r"set: top.rotation cannot be '60 furlong'; allowed: .*rad/s"):
            s.set("top.rotation", "60 furlong")
        with pytest.raises(TypeError, match="bytes is not a state"):
            s.set_state(b"state")
        with (
            drillpetsc.Session(LYING) as other,
            pytest.raises(CaseError, match="checkpoint of the same string"),
        ):
            s.set_state(other.state())
        for dt in (0.0, -1.0, float("inf")):
            with pytest.raises(ValueError, match="above 0"):
                s.step(dt)
        report = s.step_until(1.0, wall_budget=1e-4)
        assert report.late and 0 < report.time == s.time < 1.0
        assert not s.step_until(1.0).late and s.time == 1.0
        assert s.factor > 0
    with pytest.raises(RuntimeError, match="closed"):
        s.step(0.1)


def test_an_input_with_a_unit():
    with drillpetsc.Session(drive()) as s:
        state, speeds = s.state(), []
        for value in (2.0 * np.pi, "60 rpm"):
            s.set_state(state)
            s.set("top.rotation", value)
            s.step(0.1)
            speeds.append(s.get("top_speed"))
        assert speeds[0] == speeds[1] > 0


def test_closed_sessions_leave_no_memory():
    """Ten sessions, one after the other: less than 5 MB more than after two."""
    held = []
    gc.freeze()  # what other tests have left, which a collection would walk through twelve times
    for _ in range(12):
        with drillpetsc.Session(drive()) as s:
            s.step(0.02)
        gc.collect()
        held.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    gc.unfreeze()
    assert held[-1] - held[1] < 5 * 1024


@pytest.mark.parametrize("integrator", ["bdf", "alpha2", "arkimex"])
def test_a_run_leaves_nothing(integrator, tmp_path):
    """PETSc's solvers hold a run by their callbacks, in circles that Python's collector does not see."""

    def models() -> int:
        gc.collect()
        return sum(isinstance(held, DrillingModel) for held in gc.get_objects())

    gc.freeze()
    run(drive(time={"end": 0.02}, petsc={"ts_type": integrator}), tmp_path / "run", progress="silent")
    left = models()
    gc.unfreeze()
    assert left == 0


def test_a_run_folder_goes_on(tmp_path):
    """From the checkpoint of a run at 0.2 s to 0.3 s, against the run to 0.3 s at the same fixed steps."""
    case = drive(time={"end": 0.3}, petsc=FIXED, output={"history_every": 0.1, "checkpoint_every": 0.1})
    run(case.replace({"time.end": 0.2}), tmp_path / "first", progress="silent")
    run(case, tmp_path / "whole", progress="silent")
    with drillpetsc.Session(tmp_path / "first") as s:
        assert s.time == pytest.approx(0.2, abs=1e-12)
        s.step(0.1)
        speed = s.get("top_speed")
    table = read_table(tmp_path / "whole" / "history.csv")
    assert speed == pytest.approx(table["top_speed [rad/s]"][-1], rel=1e-9)


def test_a_step_that_was_cut_leaves_no_step_of_rounding(monkeypatch):
    """A fixed step of 10 ms that fails is taken in parts, whose sum is off by some 1e-15 s: that is no step of its own."""
    with drillpetsc.Session(drive(petsc={"ts_adapt_type": "none", "ts_dt": 0.01})) as s:
        steps: list[float] = []
        s._integrator.after_step.append(lambda t, dt: steps.append(dt))
        newton, fails = s._integrator.newton, [False]
        solve = newton.solve

        def sometimes(*arguments: float) -> int:
            if fails.pop():
                fails.append(False)
                return -3
            fails.append(False)
            return solve(*arguments)

        monkeypatch.setattr(newton, "solve", sometimes)
        for k in range(200):
            s.step(0.01)
            fails[0] = k % 10 == 9
    assert min(steps) > 1e-3


def test_error_estimate_of_a_session(tmp_path):
    """The same steps as a run have the same estimate; a session without it says so."""
    keys = {"time.end": 0.4, "petsc.ts_adapt_type": "none", "petsc.ts_dt": 2.5e-3}
    case = load_case(LYING).replace(keys)
    expected = run(case, tmp_path / "run", progress="silent").summary["error_estimate"]
    with drillpetsc.Session(case, estimate_error=True) as s:
        for k in range(8):
            s.step(0.05)
            if k == 4:
                middle = s.state()
        got = s.error_estimate
        s.set_state(middle)
        for _ in range(3):
            s.step(0.05)
        assert s.error_estimate == got
    assert got["since"] == 0.0
    assert got["damped_above"] == pytest.approx(expected["damped_above"])
    assert got["columns"].keys() == expected["outputs"]["columns"].keys()
    for name, column in got["columns"].items():
        reference = expected["outputs"]["columns"][name]
        assert column["range"] == pytest.approx(reference["range"], rel=1e-6), name
        assert column["error"] == (
            None if reference["error"] is None else pytest.approx(reference["error"], rel=1e-3)
        ), name
    with drillpetsc.Session(case) as s, pytest.raises(ValueError, match="estimate_error=True"):
        _ = s.error_estimate
