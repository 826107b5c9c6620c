"""What a law of the user gets, what it may return, and what a user reads if it fails (manual: sec-own-physics)."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, load_case, run
from drillpetsc.analysis.commands.check import describe
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.kernels.parameters import columns
from drillpetsc.physics.own_law import BIT, FRICTION, ROCK, OwnLaw
from tests.helpers import laws
from tests.helpers.tables import each_row

CASE = """
string:
  - {kind: pipe, length: 30, od: 0.127, id: 0.1086, element_length: 10}
  - {kind: bit, length: 0.3, od: 0.216, mass: 60}
well:
  survey: {md: [0, 30.3], inclination: [0, 0], azimuth: [0, 0]}
  sections: [{to: 30.3, kind: open_hole, diameter: 0.216, friction: 0.25}]
bottom: bit
contact: none
formation: {bit_law: {kind: python, function: LAW}}
top: {kind: top_drive, rotation: 6}
initial: {from: statics, wob: 5.0e+3, imperfection: 0}
time: {end: 0.05}
"""
STATE = {"weight": 5e4, "speed": 3.0, "angle": 0.0, "advance": 1e-3, "depth": 100.0}


def law(call, kind=BIT, **parameters) -> OwnLaw:
    return OwnLaw(kind, "law", call, parameters)


def written(folder: Path, text: str, function: str = "law.py:torque") -> Path:
    """A case in a file, beside a file with its law."""
    (folder / "law.py").write_text(text)
    (folder / "case.yaml").write_text(CASE.replace("LAW", function))
    return folder / "case.yaml"


# ---------------------------------------------------------------------- states and results
@each_row(("kind", "symbol"), [(BIT, "own_bit"), (FRICTION, "own_friction")])
def test_the_state_has_the_fields_of_the_kernel(kind, symbol):
    assert tuple(kind.given) == columns(f"{symbol}_state").names
    assert tuple(kind.results) == columns(f"{symbol}_result").names


def test_a_number_is_the_first_result():
    assert law(lambda state: 0.01 * state.weight).value(**STATE) == {
        "torque": 500.0,
        "grip": 500.0,
        "rate": 0.0,
    }


def test_parameters_reach_the_function():
    assert law(lambda state, arm: arm * state.weight, arm=0.02).value(**STATE)["torque"] == 1000.0


def test_derivatives_are_differences_unless_given():
    """T = W^2 exp(-v): both derivatives to the accuracy of a central difference."""
    state = np.array([[5e4, 0.7, 0.0, 1e-3, 100.0], [2e4, -0.2, 1.0, 1e-3, 100.0]])
    found = law(lambda s: 1e-6 * s.weight**2 * np.exp(-s.speed)).evaluate(state, True)[:, 0]
    W, v = state[:, 0], state[:, 1]
    assert found[:, 1] == pytest.approx(2e-6 * W * np.exp(-v), rel=1e-8)
    assert found[:, 2] == pytest.approx(-1e-6 * W**2 * np.exp(-v), rel=1e-8)
    given = law(lambda s: {"torque": s.weight, "torque_by_weight": 1.0}).evaluate(state, True)[:, 0]
    assert (given[:, 1] == 1.0).all()


def test_no_difference_leaves_the_values_that_occur():
    """A slip speed is not negative: its root is not taken of a negative number beside zero."""
    state = np.array([[100.0, 0.0, 0.0, 0.0, 0.25, 10.0]])
    assert np.isfinite(law(lambda s: 0.2 + 0.1 * s.slip_speed**1.5, FRICTION).evaluate(state, True)).all()


def test_a_function_of_numbers_is_called_for_each_state():
    own = law(lambda s: 2.0 * math.tanh(s.speed) if s.weight > 0 else 0.0)
    state = np.array([list(STATE.values())] * 2) * [[1], [-1]]
    assert own.one_by_one
    found = own.evaluate(state, True)[:, 0]
    assert found[:, 0] == pytest.approx([2 * math.tanh(3), 0.0])
    assert found[0, 2] == pytest.approx(2 / math.cosh(3) ** 2, rel=1e-8)


def test_the_size_of_a_torque_is_its_grip():
    found = law(lambda s: 100.0 * s.speed).evaluate(np.array([[1e4, -2.0, 0, 0, 0]]), True)[0]
    assert found[:2, 0].tolist() == [-200.0, 200.0]
    assert found[:2, 2] == pytest.approx([100.0, -100.0])


def test_depth_of_cut():
    """1 mm per turn: 1e-3 m in 2 pi/3 s at 3 rad/s."""
    assert law(lambda s: 1e6 * s.depth_of_cut).value(**STATE | {"advance": 1e-3 * 3 / (2 * np.pi)})[
        "torque"
    ] == pytest.approx(1e3)


def test_a_state_that_is_not_a_number_gives_none():
    """The solver rejects such a trial; the function is not called."""
    found = law(laws.weakening).evaluate(np.array([[np.nan, 0, 0, 0, 0]]), False)
    assert np.isnan(found).all()


def test_a_memory_is_that_of_the_last_accepted_state():
    own = law(laws.warming)
    own.time = 1.0
    own.value(**STATE)
    own.set_memory(own.next_memory)
    assert own.memory_names == ("heat", "time") and own.memory["time"] == 1.0
    own.time = 1.005
    own.value(**STATE)
    heat = own.next_memory[0]
    own.value(**STATE)
    assert own.next_memory[0] == heat == pytest.approx(0.5 * 600 * math.tanh(3) * 3)


# ---------------------------------------------------------------------- what is refused
WRONG = [
    (lambda s: {"weight": 1.0}, "unknown names weight; it returns torque, grip, rate"),
    (lambda s: {"rate": 1.0}, "returned no torque"),
    (lambda s: "much", "returned 'much' as torque"),
    (lambda s: np.zeros(7), "torque of shape (7,)"),
    (lambda s: np.nan * s.weight, "returned torque = nan, at weight 20000 N, speed 0.5 rad/s"),
    (lambda s: 1 / 0, "stopped with ZeroDivisionError: division by zero"),
    (lambda s: s.wob, "'BitState' object has no attribute 'wob'"),
    (lambda s, memory: 1.0, "takes a memory and returned none"),
]


@each_row(("call", "message"), WRONG)
def test_a_function_that_fails_at_usual_states_is_refused(call, message):
    with pytest.raises(CaseError) as error:
        law(call)
    assert message in str(error.value) and "formation.bit_law.function" in str(error.value)


@each_row(
    ("kind", "call", "message"),
    [
        (FRICTION, lambda s: -0.2 + 0 * s.normal, "returned coefficient = -0.2, which is below 0"),
        (ROCK, lambda s: 0 * s.depth, "returned strength = 0, which is below 1e-06"),
    ],
)
def test_friction_that_drives_and_rock_without_strength_are_refused(kind, call, message):
    with pytest.raises(CaseError) as error:
        law(call, kind)
    assert message in str(error.value) and f"{kind.key}.function" in str(error.value)


def test_friction_that_turns_negative_later_ends_the_run():
    own = law(lambda s: np.where(s.slip_speed > 50, -0.1, 0.3), FRICTION)
    assert own.value(slip_speed=1.0)["coefficient"] == 0.3
    with pytest.raises(
        SolveError, match=r"coefficient = -0.1, which is below 0, at normal 0 N, slip_speed 60 m/s"
    ):
        own.value(slip_speed=60.0)


def test_friction_has_no_memory():
    with pytest.raises(CaseError, match="without the parameter memory"):
        law(lambda s, memory: {"coefficient": 0.2, "memory": {}}, FRICTION)


FILES = [
    ("def torque(state):\n  return (\n", "law.py:torque", "SyntaxError"),
    ("import no_such_module\n", "law.py:torque", "No module named 'no_such_module' ("),
    ("x = 1\n", "law.py:torque", "has no attribute 'torque'"),
    ("torque = 1\n", "law.py:torque", "a function"),
    ("def torque(): return 1\n", "law.py:torque", "a function of the state"),
    ("def torque(state, arm): return 1\n", "law.py:torque", "give parameters: {arm: ...}"),
    ("", "other.py:torque", "there is no file other.py"),
    ("", "torque", "file.py:function beside the case file"),
]


@each_row(("text", "function", "message"), FILES)
def test_a_file_that_has_no_such_function_is_refused(text, function, message, tmp_path):
    with pytest.raises(CaseError) as error:
        load_case(written(tmp_path, text, function))
    assert message in str(error.value)
    assert "formation.bit_law.function" in str(error.value) and error.value.line == 10


def test_a_parameter_that_the_function_has_not(tmp_path):
    path = written(tmp_path, "def torque(state, arm=1.0): return arm\n")
    path.write_text(path.read_text().replace("torque}", "torque, parameters: {lever: 1.0}}"))
    with pytest.raises(CaseError, match=r"parameters.lever(.|\n)*a parameter of the function: arm"):
        load_case(path)


def test_one_friction_law():
    with pytest.raises(CaseError, match="stribeck or a friction_law, not both"):
        Case(
            string=[{"kind": "pipe", "length": 9.0, "od": 0.127, "id": 0.1}],
            top="clamped",
            well={"survey": {"md": [0, 9], "inclination": [0, 0], "azimuth": [0, 0]}, "sections": [{"to": 9, "kind": "casing", "diameter": 0.2, "friction": 0.2}]},
            contact={"stribeck": {"static": 0.3, "speed": 0.1}, "friction_law": {"kind": "python", "function": laws.stribeck}},
        )  # fmt: skip


# ---------------------------------------------------------------------- during a run
def test_an_error_ends_the_run_with_its_line_and_the_state(tmp_path):
    path = written(
        tmp_path,
        "def torque(state):\n    if state.time > 0.01:\n        return {}['table']\n    return 100.0 * state.speed\n",
    )
    with pytest.raises(SolveError) as error:
        run(path, out=tmp_path / "run", progress="silent")
    message = str(error.value)
    assert f"{tmp_path / 'law.py'}, line 3" in message and "KeyError: 'table'" in message
    assert "weight 5" in message and "speed 6" in message and error.value.time > 0.01


def test_nan_ends_the_run_with_the_state(tmp_path):
    path = written(
        tmp_path,
        "def torque(state):\n    return float('nan') if state.time > 0.01 else 100.0 * state.speed\n",
    )
    with pytest.raises(SolveError, match=r"returned torque = nan, at weight 5\d\d\d"):
        run(path, out=tmp_path / "run", progress="silent")


def test_a_wrong_derivative_is_doubted(tmp_path):
    text = "def torque(state):\n    return {'torque': 100 * state.speed, 'torque_by_speed': 90.0}\n"
    result = describe(load_case(written(tmp_path, text)))
    said = [line for line in result.splitlines() if "torque_by_speed" in line]
    assert len(said) == 1 and "returns torque_by_speed = 90 at" in said[0] and "give 100" in said[0]
    right = describe(load_case(written(tmp_path, text.replace("90", "100"))))
    assert not [line for line in right.splitlines() if "torque_by_speed" in line]


# ---------------------------------------------------------------------- provenance
SOURCE = (
    "def torque(state, arm=0.01):\n    return arm * state.weight * state.speed / (abs(state.speed) + 0.1)\n"
)


def test_a_restart_with_a_changed_file_is_refused(tmp_path):
    path = written(tmp_path, SOURCE)
    path.write_text(path.read_text() + "output: {checkpoint_every: 0.01}\n")
    run(path, out=tmp_path / "run", progress="silent")
    longer = tmp_path / "longer.yaml"
    longer.write_text(path.read_text().replace("end: 0.05", "end: 0.06"))
    written(tmp_path, SOURCE.replace("0.1)", "0.2)"))
    with pytest.raises(CaseError, match="formation.bit_law.source"):
        run(longer, out=tmp_path / "run", restart=True, progress="silent")
    written(tmp_path, SOURCE)
    run(longer, out=tmp_path / "run", restart=True, progress="silent")
    assert json.loads((tmp_path / "run" / "summary.json").read_text())["status"] == "done"


def test_the_case_of_a_run_is_read_again_and_refuses_another_file(tmp_path):
    case = load_case(written(tmp_path, SOURCE))
    again = tmp_path / "elsewhere" / "again.yaml"
    again.parent.mkdir()
    case.dump(again)
    assert load_case(again) == case
    (tmp_path / "law.py").write_text(SOURCE + "# changed\n")
    with pytest.raises(CaseError, match=r"the file of this case(.|\n)*remove source"):
        load_case(again)


def test_a_function_object_stands_in_a_case():
    case = load_case_with(laws.weakening)
    assert case.formation.bit_law.function == "tests.helpers.laws:weakening"
    assert case.formation.bit_law.source
    first, second = (load_case_with(lambda s, k=k: k * s.speed) for k in (1.0, 2.0))
    assert [c.formation.bit_law.call(type("S", (), {"speed": 1.0})) for c in (first, second)] == [1.0, 2.0]
    assert second.replace({"top.rotation": 3}).formation.bit_law.call is second.formation.bit_law.call


def load_case_with(function) -> Case:
    import yaml

    keys = yaml.safe_load(CASE)
    keys["formation"]["bit_law"]["function"] = function
    return Case(**keys)
