"""`pressure_loss` of a string item: a measured loss that goes with the density and the flow rate squared.

Closed form: value (rho/rho_at) (Q/Q_at)^2, for any friction beside it.  With a curve the loss is that of the curve times rho/rho_at.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.case.plausible.plausibility import plausibility as said
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.units import to_si
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

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
CURVE = {"flow_rate": [0.012, 0.024, 0.036], "loss": [2e5, 9e5, 11e5]}  # a valve opens: no square law


def changed(**columns: list[float]) -> dict:
    return CURVE | columns


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


@each_row(
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
        ({"curve": CURVE}, {}, "string[1].pressure_loss.density"),
        ({"curve": CURVE, "density": 1200, "value": "350 psi"}, {}, "string[1].pressure_loss.value"),
        ({"curve": CURVE, "density": 1200, "at": 0.03}, {}, "string[1].pressure_loss.at"),
        ({"curve": CURVE, "coefficient": 2}, {}, "string[1].pressure_loss.curve"),
        ({"curve": changed(loss=[1e5, 2e5]), "density": 1200}, {}, "string[1].pressure_loss.curve.loss"),
        (
            {"curve": changed(flow_rate=[0.01, 0.03, 0.02]), "density": 1200},
            {},
            "string[1].pressure_loss.curve.flow_rate[2]",
        ),
        (
            {"curve": changed(flow_rate=[0.0, 0.02, 0.03]), "density": 1200},
            {},
            "string[1].pressure_loss.curve.flow_rate[0]",
        ),
        (
            {"curve": changed(loss=[1e5, 4e5, 3e5]), "density": 1200},
            {},
            "string[1].pressure_loss.curve.loss[2]",
        ),
        (
            {"curve": {"flow_rate": [0.02], "loss": [1e5]}, "density": 1200},
            {},
            "string[1].pressure_loss.curve.flow_rate",
        ),
        ({"curve": {"flow_rate": [0.01, 0.02]}, "density": 1200}, {}, "string[1].pressure_loss.curve.loss"),
        ({"curve": "none.csv", "density": 1200}, {}, "string[1].pressure_loss.curve"),
        ({"curve": CURVE, "density": 1200}, {"formulation": "hermite"}, "fluid.formulation"),
    ],
)
def test_wrong_losses_are_refused(tool, fluid: dict, at: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(tool, **fluid)
    assert caught.value.at == at


def curve(tool: dict, flow: float, rigid: bool = False, density: float = 1300.0) -> dp.Case:
    """A case with a curve, whose mud is (almost) incompressible."""
    return case({"curve": tool, "density": 1000.0}, rigid, density=density, flow_rate=flow)


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("point", [0, 1, 2])
def test_a_curve_has_its_points(rigid: bool, point: int, tmp_path: Path) -> None:
    """The loss at a measured flow rate times 1.3, the ratio of the densities, in the loop and in its row."""
    bare = case(None, rigid, density=1300.0, flow_rate=CURVE["flow_rate"][point])
    without = dp.hydraulics(bare, tmp_path / "bare").summary["flows"][0]
    result = dp.hydraulics(curve(CURVE, CURVE["flow_rate"][point], rigid), tmp_path / "tool")
    flow, wanted = result.summary["flows"][0], 1.3 * CURVE["loss"][point]
    assert flow["tool_loss"] == pytest.approx(wanted, rel=1e-6)
    assert flow["pump_pressure"] - without["pump_pressure"] == pytest.approx(wanted, rel=1e-6)
    assert flow["string_loss"] == pytest.approx(without["string_loss"], rel=1e-6)
    table = result.tables["hydraulics"]
    (row,) = np.flatnonzero(np.asarray(table["channel"]) == "tool")
    assert float(table["pressure_loss"][row]) == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("flow", [0.004, 0.02, 0.031, 0.05])
def test_points_of_a_square_law_have_all_of_it(flow: float, tmp_path: Path) -> None:
    """Three points of dp = k Q^2: below, between and beyond them the same loss as `value` with its flow rate."""
    square = {"flow_rate": [0.01, 0.02, 0.04], "loss": [1e5, 4e5, 16e5]}
    found = dp.hydraulics(curve(square, flow), tmp_path / "curve").summary["flows"][0]["tool_loss"]
    assert found == pytest.approx(1.3 * 1e9 * flow**2, rel=1e-6)


def test_between_and_beyond_the_points_of_a_curve(tmp_path: Path) -> None:
    """Between the points no more and no less than they have; beyond them the last chord over the squared flow rate goes on."""
    rates = (0.03, 0.04, 0.06)
    losses = [
        dp.hydraulics(curve(CURVE, q), tmp_path / f"{q}").summary["flows"][0]["tool_loss"] for q in rates
    ]
    assert 1.3 * 9e5 < losses[0] < 1.3 * 11e5
    chord = 2e5 / (0.036**2 - 0.024**2)
    for q, loss in zip(rates[1:], losses[1:], strict=True):
        assert loss == pytest.approx(1.3 * (11e5 + chord * (q**2 - 0.036**2)), rel=1e-6)


def test_a_flow_rate_beyond_a_curve_is_told() -> None:
    assert not [w for w in said(curve(CURVE, 0.036)) if "pressure_loss" in w]
    (words,) = [w for w in said(curve(CURVE, 0.04)) if "pressure_loss" in w]
    assert "string[1].pressure_loss.curve" in words and "2160 l/min" in words and "2400 l/min" in words


def test_two_curves_of_rigid_tools_at_one_place_add_up(tmp_path: Path) -> None:
    """Two rigid tools and the bit below each other: their losses are in one element."""
    keys = dict(curve(CURVE, 0.024, True)._given.keys or {})
    first = keys["string"][1]
    keys["string"] = [
        keys["string"][0],
        first | {"length": 4.0},
        first | {"length": 5.0, "name": "second"},
        keys["string"][2],
    ]
    result = dp.hydraulics(dp.Case(**keys), tmp_path / "out")
    assert result.summary["flows"][0]["tool_loss"] == pytest.approx(2 * 1.3 * 9e5, rel=1e-6)
    table = result.tables["hydraulics"]
    rows = np.flatnonzero(np.asarray(table["channel"]) == "tool")
    assert np.asarray(table["pressure_loss"])[rows] == pytest.approx([1.3 * 9e5] * 2, rel=1e-6)


def test_a_curve_from_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loss.csv").write_text("flow [l/min], dp [bar]\n720, 2\n1440, 9\n2160, 11\n")
    read = case({"curve": "loss.csv", "density": 1000.0}).string[1].pressure_loss.curve
    assert read.flow_rate == pytest.approx(CURVE["flow_rate"]) and read.loss == pytest.approx(CURVE["loss"])


def test_the_loss_by_a_curve_in_statics_of_a_moving_string(tmp_path: Path) -> None:
    keys = [
        dict(c._given.keys or {}) | {"bottom": "free"}
        for c in (case(None, density=1300.0, flow_rate=0.024), curve(CURVE, 0.024))
    ]
    first, second = (
        dp.statics(dp.Case(**k), tmp_path / str(i)).summary["pump_pressure"] for i, k in enumerate(keys)
    )
    assert second - first == pytest.approx(1.3 * 9e5, rel=2e-4)


def moving(tool: dict | None, formulation: str = "ancf") -> dict:
    """A turning string, whose pump goes to another flow rate."""
    return {
        "well": simple_well(110, 0.2159, (0, 0.1)),
        "string": [
            {"kind": "pipe", "length": 60.0, "od": 0.127, "id": 0.1086, "element_length": 15.0},
            MOTOR | ({} if tool is None else {"pressure_loss": tool}),
            {"kind": "pipe", "length": 30.0, "od": 0.127, "id": 0.1086, "element_length": 15.0},
            {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60.0, "nozzle_area": 4e-4},
        ],
        "beam": {"formulation": formulation},
        "top": {"kind": "top_drive", "rotation": 1.0},
        "fluid": {
            "density": 1300.0,
            "flow_rate": {"time": [0.1, 0.4], "value": [0.012, 0.036]},
            "rheology": {"pv": "20 cP", "yp": "5 Pa"},
        },
        "time": {"end": 1.5},
        "output": {"history_every": 0.05},
        "petsc": {"ts_rtol": 1e-5},
    }


@pytest.mark.parametrize("formulation", ["ancf", "quaternion"])
def test_energy_and_mass_of_a_run_with_a_curve(formulation: str, tmp_path: Path) -> None:
    """The pump's work goes into the tool as well: without its share the energy would miss some 25 kJ."""
    tool = {"curve": CURVE, "density": 1000.0}
    summary = dp.run(dp.Case(**moving(tool, formulation)), tmp_path / "run", progress="silent").summary
    assert abs(summary["energy"]["error_share"]) < 1e-3
    assert abs(summary["mass"]["error"]) < 1e-6
    keys = moving(None, formulation)
    keys["string"][1] |= {"pressure_loss": {"value": 1e9 * 0.03**2, "at": 0.03, "density": 1000.0}}
    square = {"curve": {"flow_rate": [0.01, 0.02], "loss": [1e5, 4e5]}, "density": 1000.0}
    exact = {"petsc": {"ts_adapt_type": "none", "ts_dt": 5e-3, "snes_stol": 1e-12}, "time": {"end": 0.5}}
    pressures = []
    for case_keys, name in ((keys, "value"), (moving(square, formulation), "curve")):
        dp.run(dp.Case(**case_keys | exact), tmp_path / name, progress="silent")
        history = read_table(tmp_path / name / "history.csv")
        pressures.append((history["time [s]"], history["pump_pressure [Pa]"]))
    assert np.array_equal(pressures[0][0], pressures[1][0])
    assert pressures[1][1] == pytest.approx(pressures[0][1], rel=1e-6)
