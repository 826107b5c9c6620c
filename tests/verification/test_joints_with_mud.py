"""Telescoping joints that mud passes: pump-open force, volume of the stroke, energy (manual: sec-verif-joints-mud)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, load_case, run
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.physics.joints import RESULT_NAMES
from tests.helpers.joint_models import joint_component
from tests.helpers.wells import newtonian, simple_well

WELL = simple_well(500, 0.2159, kind="casing", friction=0.0)
MUD: dict[str, Any] = newtonian(1200, 0.02, bulk_modulus=2.2e9)


def case(seal: float, arm: float = 0.0, lengths=(120, 60, 40), **keys) -> Case:
    """Collars on drill pipe in a vertical hole, with a slider between them, below a rigid item of length ``arm``."""
    body = [{"kind": "body", "length": arm, "od": 0.16, "id": 0.0714, "name": "sub"}] if arm else []
    pipe = {"kind": "pipe", "element_length": 20}
    data: dict[str, Any] = {
        "well": WELL,
        "string": [
            {**pipe, "length": lengths[0], "od": 0.127, "id": 0.1086},
            {**pipe, "length": lengths[1] - arm, "od": 0.1778, "id": 0.0714},
            *body,
            {**pipe, "length": lengths[2], "od": 0.1778, "id": 0.0714},
        ],
        "joints": [
            {
                "kind": "slider",
                "at": lengths[0] + lengths[1],
                "spring": 5.25e6,
                "damping": 2e4,
                "seal_area": f"{seal} m^2",
            }
        ],
        "contact": "none",
        "top": "clamped",
        "bottom": "free",
        "fluid": {**MUD, "flow_rate": 0.0},
    }
    return Case(**(data | keys))


def travel(c: Case) -> float:
    """Travel of the joint in the static state [m]."""
    model = build_model(c)
    find_equilibrium(model)
    system = model.system
    return float(joint_component(system).element_results(system.assembly)[0, RESULT_NAMES.index("travel")])


@pytest.mark.parametrize(
    ("seal", "pressure", "push", "arm"),
    [(0.0, 1e7, 1e5, 0.0), (0.08, 1e7, 1e5, 0.0), (0.09, 1.4e7, 6e4, 1.5)],
)
def test_pressure_inside_opens_a_shock_sub(seal, pressure, push, arm):
    """Travel = (-push + (p_i - p_o) A_s)/k of a plugged string under pump pressure that is pushed up, without gravity.
    100 kN close 5.25 MN/m by 19.05 mm; with 100 bar on a seal of 80 mm (50.265 kN) by 9.473 mm."""
    area = np.pi / 4 * seal**2
    c = case(
        area,
        arm,
        lengths=(0.5, 3, 2),  # below its buckling load: a search for a bent state took all of the time
        gravity=0.0,
        bottom={"kind": "force", "force": [0, 0, -push], "plugged": True},
        fluid={**MUD, "pump_pressure": pressure},
    )
    expected = (-push + pressure * area) / 5.25e6
    assert travel(c) == pytest.approx(expected, rel=1e-5)
    if (seal, pressure) == (0.08, 1e7):
        assert expected == pytest.approx(-9.473e-3, abs=1e-6)


@pytest.mark.parametrize("arm", [0.0, 2.0])
@pytest.mark.parametrize("seal", [0.0, 0.006])
def test_a_sub_in_still_mud_carries_the_buoyed_weight_below_it(arm, seal):
    """Open string in still, incompressible mud between rigid walls: travel = (buoyed weight below)/k, whatever the seal."""
    steel = np.pi / 4 * (0.1778**2 - 0.0714**2)
    weight = 40 * steel * (7850 - 1200) * 9.80665
    fluid = {**MUD, "flow_rate": 0.0, "bulk_modulus": 1e14, "elastic_walls": False}
    assert travel(case(seal, arm, fluid=fluid)) == pytest.approx(weight / 5.25e6, rel=2e-5)


MOVES = {
    "pump pressure of a plugged string": {
        "bottom": {"kind": "free", "plugged": True},
        "fluid": {**MUD, "pump_pressure": {"time": [0, 0.6, 1.2], "value": [2e6, 1.2e7, 4e6]}},
    },
    "lowered with the pump on": {
        "top": {"kind": "top_drive", "lowering": {"time": [0, 0.5, 1.0], "value": [0.0, 0.3, 0.0]}},
        "fluid": {**MUD, "flow_rate": {"time": [0, 0.6, 1.2], "value": [0.02, 0.02, 0.0]}},
    },
    "no annulus": {
        "bottom": {"kind": "free", "plugged": True},
        "fluid": {
            **MUD,
            "annulus": False,
            "pump_pressure": {"time": [0, 0.6, 1.2], "value": [1e6, 1e7, 3e6]},
        },
    },
}


@pytest.mark.parametrize("arm", [0.0, 1.5])
@pytest.mark.parametrize("name", MOVES)
def test_mass_and_energy_of_a_moving_joint_close(name, arm, tmp_path):
    """Error of the volumes below 1e-9 m3 per second, of the energy below 1e-3 of the exchanged one. The seal's work
    is far larger than that, so a stroke that one book lacks would show."""
    c = case(0.02, arm, time={"end": 1.2}, output={"history_every": 0.01}, **MOVES[name])
    c = c.model_copy(update={"petsc": {"ts_rtol": 1e-5, "q_snes_stol": 1e-11}})
    summary = run(c, tmp_path / "run", progress="silent").summary
    table = read_table(tmp_path / "run" / "history.csv")
    stroke = table["joint_180_travel [m]"]
    assert np.ptp(stroke) > 2e-3
    assert abs(summary["mass"]["error"]) < 1e-9 * 1.2
    assert np.abs(table["energy_error [J]"]).max() < 1e-3 * abs(
        summary["energy"]["error"] / summary["energy"]["error_share"]
    )


def test_joints_with_mud_refuse_the_hermite_flow():
    with pytest.raises(CaseError, match="formulation mixed in a case with joints"):
        case(0.01, fluid={**MUD, "flow_rate": 0.0, "formulation": "hermite"})


def test_only_a_slider_has_a_seal():
    with pytest.raises(CaseError, match="no seal_area for a joint of kind universal"):
        case(0.01, joints=[{"kind": "universal", "at": 180, "seal_area": 0.01}])


def test_units_of_the_seal_area(tmp_path):
    """A case file may give it in square inches."""
    file = tmp_path / "case.yaml"
    file.write_text(
        "string: [{kind: pipe, length: 20, od: 0.127, id: 0.1}]\n"
        "joints: [{kind: slider, at: 10, seal_area: 7.79 in2}]\n"
        "top: clamped\n"
    )
    assert load_case(file).joints[0].seal_area == pytest.approx(7.79 * 0.0254**2, rel=1e-12)
