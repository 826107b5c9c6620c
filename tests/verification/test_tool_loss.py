"""`pressure_loss` of a string item: a measured loss that goes with the density and the flow rate squared.

Closed form: value (rho/rho_at) (Q/Q_at)^2, for any friction beside it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.errors import CaseError
from drillpetsc.units import to_si

LOSS = {"value": "350 psi", "at": "600 gpm", "density": "10 ppg"}
MOTOR = {"kind": "pipe", "name": "motor", "length": 9.0, "od": 0.1715, "id": 0.07}


def case(tool: dict | None = None, rigid: bool = False, **fluid) -> dp.Case:
    """A held string, whose flow alone is computed; the motor crosses the end of the casing where it is not rigid."""
    motor = MOTOR | ({"kind": "body"} if rigid else {}) | ({} if tool is None else {"pressure_loss": tool})
    keys = {
        "well": {
            "survey": {"md": [0, 1000], "inclination": [0, 0.5], "azimuth": [0, 0]},
            "sections": [
                {"to": 990, "kind": "casing", "diameter": 0.2205},
                {"to": "end", "kind": "open_hole", "diameter": 0.2159},
            ],
        },
        "string": [
            {"kind": "pipe", "length": 985.0, "od": 0.127, "id": 0.1086},
            motor,
            {"kind": "bit", "length": 0.3, "od": 0.2159, "nozzle_area": 3e-4},
        ],
        "top": "clamped",
        "fluid": {
            "density": "12 ppg",
            "flow_rate": "500 gpm",
            "rheology": {"pv": "20 cP", "yp": "10 lbf/100ft2"},
            "bulk_modulus": 1e14,
            "elastic_walls": False,
        }
        | fluid,
    }
    return dp.Case(**keys)


WANTED = to_si("350 psi", "Pa") * 1.2 * (500 / 600) ** 2


@pytest.mark.parametrize("rigid", [False, True])
def test_the_loss_is_that_of_the_data_sheet_at_another_flow_and_density(rigid: bool, tmp_path: Path) -> None:
    bare = dp.hydraulics(case(rigid=rigid), tmp_path / "bare").summary["flows"][0]
    result = dp.hydraulics(case(LOSS, rigid), tmp_path / "tool")
    flow = result.summary["flows"][0]
    assert flow["tool_loss"] == pytest.approx(WANTED, rel=1e-6)
    assert flow["pump_pressure"] - bare["pump_pressure"] == pytest.approx(WANTED, rel=1e-6)
    for name in ("string_loss", "bit_loss", "annulus_loss"):
        assert flow[name] == pytest.approx(bare[name], rel=1e-6), name
    assert "tool_loss" not in bare or bare["tool_loss"] is None
    table = result.tables["hydraulics"]
    (row,) = np.flatnonzero(np.asarray(table["channel"]) == "tool")
    assert np.asarray(table["item"])[row] == "motor"
    assert float(table["pressure_loss"][row]) == pytest.approx(WANTED, rel=1e-6)
    assert float(table["to"][row]) - float(table["from"][row]) == pytest.approx(9.0)
    assert "Tools" in "\n".join(result.lines)


def test_losses_of_several_tools_add_up(tmp_path: Path) -> None:
    """Two tools of a third and two thirds of the loss, one of them rigid and the last item before the bit."""
    whole = case(LOSS)
    third = {"value": "116.6666666667 psi", "at": "600 gpm", "density": "10 ppg"}
    rest = {"value": "233.3333333333 psi", "at": "600 gpm", "density": "10 ppg"}
    two = whole.replace({"string[1].pressure_loss": third, "string[2].pressure_loss": rest})
    flow = dp.hydraulics(two, tmp_path / "out")
    assert flow.summary["flows"][0]["tool_loss"] == pytest.approx(WANTED, rel=1e-6)
    table = flow.tables["hydraulics"]
    rows = np.flatnonzero(np.asarray(table["channel"]) == "tool")
    assert np.asarray(table["pressure_loss"])[rows] == pytest.approx([WANTED / 3, 2 * WANTED / 3], rel=1e-6)


def test_the_loss_is_the_same_in_the_statics_of_a_moving_string(tmp_path: Path) -> None:
    """The solver's momentum row of a string that can move has the loss, too; the pipe, which the pressure lengthens, rubs a little more."""
    keys = {"bottom": "free"}
    bare, tool = (dp.Case(**({**dict(c._given.keys or {}), **keys})) for c in (case(), case(LOSS)))
    first, second = (dp.statics(c, tmp_path / name) for name, c in (("bare", bare), ("tool", tool)))
    assert second.summary["pump_pressure"] - first.summary["pump_pressure"] == pytest.approx(WANTED, rel=2e-4)


@pytest.mark.parametrize("rigid", [False, True])
def test_a_loss_coefficient_is_of_the_velocity_in_the_bore(rigid: bool, tmp_path: Path) -> None:
    """K rho v^2/2 with v = Q/(pi id^2/4): 7.3 in 70 mm, and in a piece on each side of the casing's end by its length."""
    flow = dp.hydraulics(case({"coefficient": 7.3}, rigid), tmp_path / "tool").summary["flows"][0]
    velocity = to_si("500 gpm", "m^3/s") / (np.pi / 4 * 0.07**2)
    assert flow["tool_loss"] == pytest.approx(7.3 * to_si("12 ppg", "kg/m^3") * velocity**2 / 2, rel=1e-6)


@pytest.mark.parametrize(
    ("tool", "fluid", "at"),
    [
        ({"coefficient": 3, "value": "350 psi"}, {}, "string[1].pressure_loss.value"),
        ({"coefficient": -1}, {}, "string[1].pressure_loss.coefficient"),
        ({}, {}, "string[1].pressure_loss.value"),
        ({"value": "350 psi", "at": "600 gpm"}, {}, "string[1].pressure_loss.density"),
        ({"value": "350 psi", "at": 0, "density": 1200}, {}, "string[1].pressure_loss.at"),
        ({"value": "-3 psi", "at": 0.03, "density": 1200}, {}, "string[1].pressure_loss.value"),
        ({"value": "350 m", "at": 0.03, "density": 1200}, {}, "string[1].pressure_loss.value"),
        ("350 psi", {}, "string[1].pressure_loss"),
        (LOSS, {"formulation": "hermite"}, "fluid.formulation"),
    ],
)
def test_wrong_losses_are_refused(tool, fluid: dict, at: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(tool, **fluid)
    assert caught.value.at == at
