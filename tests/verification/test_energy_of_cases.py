"""The energy balance of the verification cases closes (manual: verif-energy-of-cases)."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillpetsc import load_case, run

CASES = Path(__file__).parents[2] / "cases" / "verification"
#: case -> time [s] in which what it is about has begun: waves, impacts, slip, a pump that is turned down, a kick of the top
ENDS = {
    "study-pendulum": 0.5,
    "study-flying-beam": 2.0,
    "study-hanging-string": 1.0,
    "study-stick-slip": 4.0,
    "study-impact": 0.25,
    "study-water-hammer": 2.0,
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
