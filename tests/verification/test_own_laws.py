"""Laws of the user against the built-in laws that they repeat (manual: verif-own-laws)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, hydraulics, load_case, run, statics
from drillpetsc.output import read_table
from tests.helpers import laws
from tests.helpers.bit_models import DRAG, rock_bit
from tests.helpers.wells import simple_well

STUDY = Path(__file__).parents[2] / "cases" / "verification" / "study-stick-slip.yaml"
SLIDING = """
string:
  - {kind: pipe, length: 60, od: 0.127, id: 0.1086, element_length: 5}
  - {kind: stabilizer, length: 1, od: 0.2, id: 0.07}
  - {kind: pipe, length: 20, od: 0.165, id: 0.07, element_length: 5}
well:
  survey: {md: [0, 100], inclination: [1.2, 1.2], azimuth: [1, 1]}
  sections: [{to: 100, kind: open_hole, diameter: 0.216, friction: 0.25}]
contact: {stribeck: {static: 0.375, speed: 0.1}}
top: {kind: top_drive, rotation: {ramp: 0.2, value: 6}, lowering: 0.02}
initial: {from: statics}
time: {end: 0.4}
output: {history_every: 0.01}
"""
#: outputs that hang on the times of the steps: they are those at the end of a step, not at the time of the row
OF_STEPS = ("time", "step", "newton", "energy_error", "kinetic_energy", "strain_energy")


def histories(base, change: dict, folder: Path) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Histories of the case with the built-in law and with another."""
    out = []
    for name, case in (("built_in", base), ("own", base.replace(change))):
        run(case, out=folder / name, progress="silent")
        out.append(read_table(folder / name / "history.csv"))
    return out[0], out[1]


def largest_difference(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> float:
    """Largest difference of an output, over its largest value."""
    found = [
        np.abs(other[name] - values).max() / np.abs(values).max()
        for name, values in one.items()
        if not name.startswith(OF_STEPS) and np.abs(values).max() > 0
    ]
    return max(found)


@pytest.mark.parametrize(
    ("function", "tolerance", "end", "most"),
    [(laws.weakening, 1e-4, 8.5, 1e-6), (laws.weakening_alone, 1e-6, 5.5, 1e-4)],
)
def test_a_bit_law_of_the_user_repeats_stick_slip(function, tolerance, end, most, tmp_path):
    """The bit sticks, slips and sticks.  The same steps are taken with exact derivatives; with differences Newton's method ends elsewhere
    within its tolerance, which moves the time at which the bit breaks loose (some milliseconds with the default tolerance)."""
    base = load_case(STUDY).replace({"time.end": end, "petsc.ts_rtol": tolerance})
    change = {"formation.bit_law": {"kind": "python", "function": function}}
    one, own = histories(base, change, tmp_path)
    assert np.abs(one["bit_speed [rad/s]"][:60]).max() < 0.02  # it sticks
    assert one["bit_speed [rad/s]"].max() > 15
    assert end < 8 or abs(one["bit_speed [rad/s]"][-1]) < 0.02
    assert largest_difference(one, own) < most


def test_a_friction_law_of_the_user_repeats_stribeck(tmp_path):
    base = _case(SLIDING, tmp_path)
    change = {"contact": {"friction_law": {"kind": "python", "function": laws.stribeck}}}
    one, own = histories(base, change, tmp_path)
    assert one["surface_torque [N m]"].max() > 500
    assert largest_difference(one, own) < 1e-6


def test_statics_with_a_friction_law_of_the_user(tmp_path):
    """The hook load of a sliding string is that of the coefficient at 1 m/s, which is the kinetic one."""
    base = _case(SLIDING, tmp_path)
    own = base.replace({"contact": {"friction_law": {"kind": "python", "function": laws.stribeck}}})
    from drillpetsc import statics

    first, second = (statics(case).summary for case in (base, own))
    assert second["hook_load"] == pytest.approx(first["hook_load"], rel=1e-9)
    twice = base.replace({"contact": {"friction_law": {"kind": "python", "function": _half}}})
    assert abs(statics(twice).summary["hook_load"] - first["hook_load"]) > 100


MUD = """
string:
  - {kind: pipe, length: 990, od: 0.127, id: 0.1086, element_length: 90}
  - {kind: bit, length: 0.5, od: 0.2159, mass: 60, nozzle_area: 400 mm2}
well:
  survey: {md: [0, 991], inclination: [0.3, 0.3], azimuth: [1, 1]}
  sections: [{to: 991, kind: open_hole, diameter: 0.216, friction: 0.25}]
fluid: {density: 1200, flow_rate: {ramp: 0.2, value: 0.03}, rheology: {model: power_law, consistency: 0.5, index: 0.6, law: exact}}
top: {kind: top_drive, rotation: 6}
initial: {from: statics}
time: {end: 0.3}
output: {history_every: 0.05}
"""


@pytest.mark.parametrize("loaded", [False, True])
def test_friction_by_the_force_of_a_contact_point_is_said_to_depend_on_the_mesh(loaded, tmp_path):
    """A law that uses `normal`, and one that does not."""

    def friction(state):
        return 0.3 / (1 + state.normal / 2e3) if loaded else 0.3 + 0 * state.normal

    case = Case(
        string=[{"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}],
        well=simple_well(100.0, 0.2159, inclination=1.0),
        top={"kind": "top_drive", "rotation": 0, "lowering": -0.1},
        contact={"friction_law": {"kind": "python", "function": friction}},
    )
    said = statics(case, tmp_path / "out").summary["warnings"]
    assert any("results depend on the mesh" in q for q in said) == loaded


def test_a_rheology_of_the_user_repeats_a_power_law(tmp_path):
    """The pump starts in a run; losses of steady flow, laminar around the pipe and turbulent in it."""
    base = _case(MUD, tmp_path)
    own = {"fluid.rheology": {"model": "python", "function": laws.shear_stress}}
    one, other = histories(base, own, tmp_path)
    assert one["pump_pressure [Pa]"].max() > 1e6
    assert largest_difference(one, other) < 1e-6
    cases = base, base.replace(own)
    steady = [
        hydraulics(case, tmp_path / f"h{k}", flow=0.03).summary["flows"][0] for k, case in enumerate(cases)
    ]
    for loss in ("string_loss", "annulus_loss", "pump_pressure"):
        assert steady[0][loss] > 1e5
        assert steady[1][loss] == pytest.approx(steady[0][loss], rel=1e-9)


TOP, WIDTH = 100.53, 0.1  # of the lower layer, and of its beginning [m]


def lower_layer(state):
    """Half the drillability below TOP, reached as the built-in layers do."""
    share = np.clip((state.depth - TOP) / WIDTH, 0, 1)
    return 1 / (1 - 0.5 * share**2 * (3 - 2 * share))


def test_a_rock_of_the_user_repeats_a_layer(tmp_path):
    """Drillability that halves over 0.1 m (manual: sec-bit-layers)."""
    bit = {
        "formation.bit_law": "rop",
        "formation.drillability": 2e-6,
        "formation.rotary_exponent": 0,
        "time.end": 13,
        "top.lowering": 0.02,
        "petsc": {"ts_rtol": 1e-5},
    }
    base = load_case(STUDY).replace(bit | {"formation.layers": [{"from": TOP, "drillability": 1e-6}]})
    own = {"formation.layers": [], "formation.rock_law": {"kind": "python", "function": lower_layer}}
    one, other = histories(base, own, tmp_path)
    assert one["hole_depth [m]"][-1] > TOP + 2 * WIDTH
    weight = one["wob [N]"]
    assert weight[-1] == pytest.approx(
        2 * weight[20], rel=1e-3
    )  # 1 s and 13 s: the same rate in half the drillability
    assert largest_difference(one, other) < 1e-6


def test_a_rock_twice_as_strong_is_a_drag_bit_of_twice_the_energy():
    """Torque and rate under a weight are those of twice the specific energy and contact stress."""
    energy = {key: 2 * DRAG[key] for key in ("specific_energy", "contact_stress")}
    hard = rock_bit(bit_law=DRAG | energy | {"exposure": 2e-3})
    twice = {"kind": "python", "function": lambda state: 2.0}
    own = rock_bit(bit_law=DRAG | {"exposure": 2e-3}, rock_law=twice)
    axis = np.array([0.0, 0.0, 1.0])
    for weight in (1e3, 2e4, 5e4, 2e5):  # below the contact of the flats, cutting, and on the body
        assert own.torque_for(weight, 10.0) == pytest.approx(hard.torque_for(weight, 10.0), rel=1e-12)
        rates = [b.rate_under(weight * axis, axis, 10.0)[2] for b in (own, hard)]
        assert rates[0] == pytest.approx(rates[1], rel=1e-12)
    assert rates[0] > 1e-3


def _half(state):
    return 0.5 * state.given


def _case(text: str, folder: Path):
    (folder / "case.yaml").write_text(text)
    return load_case(folder / "case.yaml")
