"""The energy balance of the verification cases closes (manual: verif-energy-of-cases)."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillpetsc import Case, load_case, run
from tests.helpers.wells import simple_well

CASES = Path(__file__).parents[2] / "cases" / "verification"
#: case -> time [s] in which what it is about has begun: waves, impacts, slip, a pump that is turned down, a kick of the top
ENDS = {
    "study-pendulum": 0.5,
    "study-flying-beam": 2.0,
    "study-hanging-string": 1.0,
    "study-stick-slip": 4.0,
    "study-impact": 0.25,
    "study-water-hammer": 2.0,
    "study-flutter": 10.0,
    "study-coupled": 0.5,
    "kill-test": 0.15,
}


@pytest.mark.parametrize("name", ENDS)
def test_energy_is_balanced_to_one_percent(name, tmp_path):
    """At the tolerance of a usual run, 1e-4: error below 1 % of the energy exchanged and no alarm.  Newton leaves
    less than a thousandth of that energy."""
    case = load_case(CASES / f"{name}.yaml")
    changed = {
        "time": case.time.model_copy(update={"end": ENDS[name]}),
        "petsc": {**case.petsc, "ts_rtol": 1e-4},
    }
    energy = run(case.model_copy(update=changed), tmp_path / "out", progress="silent").summary["energy"]
    exchanged = energy["error"] / energy["error_share"]
    assert abs(energy["error_share"]) < 0.01
    assert not energy["flag"]
    assert abs(energy["newton"]) < 1e-3 * exchanged
    assert energy["damped"] + energy["error"] == pytest.approx(energy["newton"], abs=1e-9 * exchanged)


def test_balance_of_a_pipe_in_flutter_is_left_by_the_steps_alone(tmp_path):
    """The jet leaves the moving end with the sum of both velocities: |V + w t|^2/2 per mass (Paidoussis, Fluid-Structure
    Interactions vol. 1, section 3.2.2).  The energy error vanishes with the steps, from 1e-4 to 1e-6 of tolerance by more
    than ten times; with the speed relative to the pipe, 6.5 J were gained at any tolerance."""
    case = load_case(CASES / "study-flutter.yaml")
    time, error = case.time.model_copy(update={"end": 5.0}), {}
    for tolerance in (1e-4, 1e-6):
        changed = case.model_copy(update={"time": time, "petsc": {"ts_rtol": tolerance}})
        energy = run(changed, tmp_path / str(tolerance), progress="silent").summary["energy"]
        error[tolerance] = abs(energy["error"])
    assert error[1e-6] < 0.1 * error[1e-4]
    assert error[1e-6] < 2e-3 * energy["strain"]


def test_balance_of_a_pump_that_is_turned_down(tmp_path):
    """Mud that expands speeds up on its way: the momentum rows leave its convection out, and the power of that term stands in
    the balance.  Without it 0.07 % of the energy exchanged was gained (manual: eq-mud-left-out-flow)."""
    case = load_case(CASES / "study-coupled.yaml")
    still = {"hold_string": True, "top": None, "bottom": None, "initial": None, "contact": "none"}
    data = case.model_dump(exclude_unset=True) | {"petsc": {"ts_rtol": 1e-5}}
    data = {key: value for key, value in (data | still).items() if value is not None}
    energy = run(type(case)(**data), tmp_path / "held", progress="silent").summary["energy"]
    assert abs(energy["error_share"]) < 1e-5 and energy["gained_share"] < 1e-5
    moving = case.model_copy(update={"petsc": {**case.petsc, "ts_rtol": 1e-5}})
    energy = run(moving, tmp_path / "moving", progress="silent").summary["energy"]
    assert abs(energy["error_share"]) < 2e-4 and energy["gained_share"] < 2e-4


@pytest.mark.parametrize("inclination", [0.6, 1.5707963])
def test_a_string_at_rest_gains_nothing(tmp_path, inclination):
    """It moves by the tolerance of its static state, 1e-8 m, and exchanges a millionth of its strain energy.

    The alarm told of 6e-7 J "without input, 1.7 % of the energy exchanged" in a level hole.
    """
    case = Case(
        well=simple_well(60, 0.2159, inclination, azimuth=0.7, friction=0.3),
        string=[
            {"kind": "pipe", "length": 15, "od": 0.127, "id": 0.1086},
            {"kind": "stabilizer", "length": 0, "od": 0.205, "mass": 90},
            {"kind": "pipe", "length": 25, "od": 0.127, "id": 0.1086},
        ],
        top="clamped",
        bottom="free",
        time={"end": 1.0},
    )
    energy = run(case, tmp_path / "run", progress="silent").summary["energy"]
    assert not energy["flag"]
    assert abs(energy["error_share"]) < 0.005


@pytest.mark.parametrize("every", [0.3, 10.0])
def test_energies_are_those_of_the_end_where_no_row_of_the_history_is(tmp_path, every):
    """Of a run of 0.5 s with rows every 0.3 s, or none but the first, the balance is that with a row at the end.

    It was that of the last row, whose error is zero where the first row is the only one.
    """
    case = load_case(CASES / "study-hanging-string.yaml")
    found = []
    for interval in (0.5, every):
        changed = {
            "time": case.time.model_copy(update={"end": 0.5}),
            "output": case.output.model_copy(
                update={"history_every": interval, "field_every": 20.0, "probes": ()}
            ),
            "petsc": {**case.petsc, "ts_rtol": 1e-3, "ts_adapt_type": "none", "ts_dt": 5e-3},
        }
        out = tmp_path / f"{interval:g}"
        found.append(run(case.model_copy(update=changed), out, progress="silent").summary["energy"])
    at_end, other = found
    assert abs(at_end["error"]) > 1e-9 * abs(at_end["strain"])
    for key in ("kinetic", "strain", "potential"):
        assert other[key] == pytest.approx(at_end[key], rel=1e-9)
    assert other["error"] == pytest.approx(at_end["error"], rel=1e-3)
