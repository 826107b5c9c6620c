"""Tools of the string where they are easily forgotten: the flow of `hydraulics` and `surge`, limits of a forced top, both elements."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, hydraulics, limits, linearise, roadmap, run, statics, surge
from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.hydraulics.flow_model import FlowModel, string_at, whole_string
from drillpetsc.analysis.hydraulics.hydraulics import Hydraulics
from drillpetsc.analysis.hydraulics.losses import balance, motor_rows, tool_rows
from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from tests.helpers.wells import newtonian

NO_LOAD = 1.2e6
BORE = {"od": "171.5 mm", "id": "71.4 mm"}
MOTOR = {"kind": "pdm", "name": "motor", "length": 8, "od": 0.1715, "id": 0.0714}
MOTOR |= {"pdm": {"rev_per_volume": "265 rev/m3", "stall_torque": "12 kN m", "no_load_pressure": NO_LOAD}}
AGITATOR = {"kind": "agitator", "name": "shaker", "length": 4, **BORE}
AGITATOR |= {
    "agitator": {
        "rev_per_volume": "0.6 rev/l",
        "pressure_amplitude": "1 MPa",
        "piston_area": "150 cm2",
        "spring": "10 MN/m",
    }
}
PADS = {"kind": "rss", "length": 4, **BORE}
PADS |= {"rss": {"kind": "push", "force": "8 kN", "pad_offset": 1, "pads": "rotating"}}
DEPTH = 200.0


def case(tool: dict | None = None, shoe: float = 100.0, **keys) -> Case:
    """A string of ``DEPTH`` in an inclined hole, its ``tool`` from 150 m down."""
    tool = tool or {"kind": "pipe", "length": 8, **BORE}
    below = DEPTH - 150 - tool["length"] - 0.5
    string = [
        {"kind": "pipe", "name": "dp", "length": 150, "od": "127 mm", "id": "108.6 mm", "element_length": 10},
        tool,
        {"kind": "pipe", "name": "dc", "length": below, "element_length": 5, **BORE},
        {"kind": "bit", "name": "bit", "length": 0.5, "od": "215.9 mm", "nozzle_area": "400 mm2"},
    ]
    sections = [
        {"to": shoe, "kind": "casing", "diameter": "224.4 mm"},
        {"to": "end", "kind": "open_hole", "diameter": "215.9 mm"},
    ]
    angles = {"inclination": ["20 deg"] * 2, "azimuth": [0, 0]}
    given = {
        "well": {"survey": {"md": [0, DEPTH], **angles}, "sections": sections},
        "string": string,
        "top": {"kind": "top_drive", "rotation": "60 rpm"},
        "bottom": "bit",
        "contact": {},
        "fluid": newtonian(1200, 0.01, flow_rate="25 l/s"),
        "initial": {"wob": "20 kN"},
    }
    return Case(**(given | keys))


def flow(of: Case) -> FlowModel:
    found = FlowModel(of, whole_string(of), "pumping")
    found.solve(0.025)
    return found


@pytest.mark.parametrize("shoe", [100.0, 152.0, 154.0, 157.0])
def test_a_casing_shoe_inside_a_motor_leaves_its_pressure_and_name(shoe: float):
    """The string is cut at the shoe; the motor's joint is at 154 m."""
    (row,) = motor_rows(flow(case(MOTOR, shoe)))
    assert row.item == "motor"
    assert row.upper == pytest.approx(154.0, abs=1e-3)
    assert row.pressure_loss == pytest.approx(NO_LOAD, rel=1e-3)


def test_losses_of_tools_are_of_their_length_and_add_up():
    """Pump pressure less outlet is the sum of losses, heads and columns with a motor and a filter below it that loses 5 bar."""
    loss = {"value": "5 bar", "at": "25 l/s", "density": 1200}
    stiff = {"fluid.bulk_modulus": 1e14, "fluid.elastic_walls": False}
    found = flow(case(MOTOR).replace({"string[2].pressure_loss": loss, **stiff}))
    rows = tool_rows(found)
    assert sorted(row.pressure_loss for row in rows) == pytest.approx([5e5, NO_LOAD], rel=1e-5)
    (tool,) = (row for row in rows if row.pressure_loss < 0.5 * NO_LOAD)
    assert (tool.upper, tool.lower) == pytest.approx((158.0, 199.5), abs=1e-9)
    b = balance(found)
    assert b["tool_loss"] == pytest.approx(sum(row.pressure_loss for row in rows), rel=1e-9)
    total = sum(value for key, value in b.items() if key not in ("pump_pressure", "outlet"))
    assert total == pytest.approx(b["pump_pressure"] - b["outlet"], abs=1.0)


def test_a_motor_that_is_partly_in_the_hole_keeps_its_joint():
    """With the bit at 46.5 m the upper 3.5 m of the motor are above the rotary table; its joint is 4 m below its upper end."""
    found = FlowModel(case(MOTOR), string_at(case(MOTOR), 46.5), "pumping")
    found.solve(0.025)
    (row,) = motor_rows(found)
    assert row.upper == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize("tool", [MOTOR, AGITATOR], ids=["motor", "agitator"])
def test_a_closed_pipe_with_a_tool_that_mud_turns_trips(tool: dict, tmp_path):
    """The pipe displaces what its outside does: the surge is that of a plain pipe of the same size."""
    found = [
        surge(case(t), tmp_path / f"{i}", speeds="20 m/min", pipe="closed")
        for i, t in enumerate((tool, {"kind": "pipe", "length": tool["length"], **BORE}))
    ]
    pressure = [[row["surge_pressure"] for row in q.summary["surge"]] for q in found]
    assert pressure[0] == pytest.approx(pressure[1], rel=1e-3)
    assert min(map(abs, pressure[1])) > 1e4


def test_hydraulics_says_that_a_motor_has_no_load(tmp_path):
    notes = hydraulics(case(MOTOR), tmp_path / "h").summary["notes"]
    assert any("motor: the motor's pressure is its no-load pressure" in note for note in notes)


def test_check_names_every_tool_and_its_unknowns():
    """A field with few unknowns that `check` does not list looks as if it were not there."""
    found = case(MOTOR)
    string = [*found.string]
    stabilizer = {"kind": "stabilizer", "length": 1, "od": 0.2, "id": 0.0714, "mass": 100, "nozzles": "10 mm"}
    rss = PADS | {"length": 4}
    text = describe(
        case(
            string=[
                string[0], AGITATOR, stabilizer, rss, MOTOR, {"kind": "pipe", "length": 30, **BORE},
                string[-1],
            ]
        )
    )  # fmt: skip
    contains = next(line for line in text.splitlines() if line.startswith("  contains:"))
    for word in ("downhole motor", "agitator", "rotary steerable tool", "nozzles above the bit"):
        assert word in contains
    for field in ("side.flow: 1 at 1 nodes", "agitator.angle: 1 at 1 nodes"):
        assert field in text


@pytest.mark.parametrize(
    "tool",
    [
        {"kind": "shock_sub", "stiffness": "8 MN/m", "damping": "50 kN s/m", "stroke": [-0.1, 0.1]},
        {"kind": "jar", "jar": {"threshold": "300 kN", "stroke": "0.2 m"}},
    ],
    ids=["shock sub", "jar"],
)
def test_a_slider_in_mud_has_a_linear_model(tool: dict, tmp_path):
    """Slow changes of the flow rate: the gain of the pump pressure is the slope of the steady flow's (`hydraulics`); 1e-4.

    The pressures on both sides of the joint are one: a rounding error in that row must not become a resistance.
    """
    found = case({"length": 4, **BORE} | tool)
    linearise(found, ["fluid.flow_rate"], ["pump_pressure"], out=tmp_path / "linear")
    with np.load(tmp_path / "linear" / "linear.npz") as z:
        A, B, C, D = (z[name] for name in "ABCD")
        assert z["frequency"][-1] < 1e6
    slow = 2j * np.pi * 1e-4 * np.eye(len(A)) - A
    rows = np.abs(slow).max(axis=1, keepdims=True)
    gain = (C @ np.linalg.solve(slow / rows, B / rows) + D).item()
    steady = Hydraulics(found)
    above, below = (steady.at(q).summary["pump_pressure"] for q in (0.02501, 0.02499))
    assert abs(gain) == pytest.approx((above - below) / 2e-5, rel=1e-4)


# ---------------------------------------------------------------------- top under a force, with a weight on bit
def forced(**keys) -> Case:
    return case(top={"kind": "top_drive", "rotation": "60 rpm", "force": "90 kN"}, **keys)


def test_limits_under_a_top_force_and_a_weight_has_the_loads_of_the_held_top(tmp_path):
    held, found = (limits(q, tmp_path / name).summary for name, q in (("held", case()), ("forced", forced())))
    names = ("hook_load", "surface_torque", "wob", "bit_torque")
    assert [found[q] for q in names] == pytest.approx([held[q] for q in names], rel=1e-9)
    assert held["surface_torque"] > 500.0


def test_a_short_string_under_a_top_force_and_a_weight_stands_on_the_bottom(tmp_path):
    """`hydraulics` and the depths of a run place it as statics does."""
    survey = {"md": [0, DEPTH + 15], "inclination": ["20 deg"] * 2, "azimuth": [0, 0]}
    sections = [{"to": "end", "kind": "open_hole", "diameter": "215.9 mm"}]
    found = forced(well={"survey": survey, "sections": sections})
    assert whole_string(found).top == pytest.approx(15.0)
    assert top_depth(build_model(found)) == pytest.approx(15.0)
    pressure = hydraulics(found, tmp_path / "h").summary["flows"][0]["pump_pressure"]
    assert pressure == pytest.approx(
        statics(found, tmp_path / "s").summary["pump_pressure"], rel=2e-3
    )  # of a string that stretches


def test_a_quasi_static_run_takes_no_weight_beside_a_top_force():
    with pytest.raises(CaseError) as error:
        forced(time={"end": 10, "mode": "quasi_static"}, formation={"drillability": 1e-8})
    assert error.value.at == "initial.wob" and "quasi-static" in error.value.want


# ---------------------------------------------------------------------- torque and drag
@pytest.mark.parametrize("model", ["soft", "stiff"])
def test_torque_and_drag_name_the_tools_that_they_leave_out(model: str, tmp_path):
    """Both models know no cutters above the bit; the soft string knows no pads either, and the stiff one does."""
    hole = [
        {"to": to, "kind": "open_hole", "diameter": q} for to, q in ((152, "250 mm"), (DEPTH, "215.9 mm"))
    ]
    well = {"survey": {"md": [0, DEPTH], "inclination": ["20 deg"] * 2, "azimuth": [0, 0]}, "sections": hole}
    plan = {"operations": ["rotate_off_bottom"], "bit_depth": [DEPTH]}
    reamer = {"kind": "reamer", "name": "opener", "length": 2, "id": "71.4 mm", "od": "250 mm", "mass": 400}
    notes = " ".join(roadmap(case(PADS, roadmap=plan), tmp_path / "pads", model=model).summary["notes"])
    assert ("steering and bends: rss" in notes) is (model == "soft") and "cutters" not in notes
    found = case(
        reamer, well=well, roadmap=plan, formation={"drillability": 1e-8, "bit_law": "drag_bit"}, fluid=None
    )
    notes = " ".join(roadmap(found, tmp_path / "reamer", model=model).summary["notes"])
    assert "cutters above the bit: opener" in notes and "steering" not in notes


def test_limits_name_the_tools_that_their_soft_string_leaves_out(tmp_path):
    assert any("steering and bends: rss" in q for q in limits(case(PADS), tmp_path / "pads").summary["notes"])
    assert not any(
        "leave" in q and "steering" in q for q in limits(case(), tmp_path / "plain").summary["notes"]
    )


# ---------------------------------------------------------------------- quaternion element
def test_pads_push_a_string_of_either_element_alike(tmp_path):
    """With rotating pads both elements run, and the work of the pads stands in the energy balance."""
    figures = []
    for formulation in ("ancf", "quaternion"):
        found = case(PADS, beam={"formulation": formulation}, time={"end": 0.1}, fluid=None)
        summary = run(found, tmp_path / formulation).summary
        assert abs(summary["energy"]["error_share"]) < 1e-3
        figures.append([summary["final"][q] for q in ("hook_load [N]", "wob [N]", "kinetic_energy [J]")])
    np.testing.assert_allclose(figures[1], figures[0], rtol=0.03)


def test_a_reamer_starts_alike_with_either_element(tmp_path):
    """Statics shares the weight between cutters and bit; the quaternion string takes that state over."""
    blades = {"kind": "reamer", "name": "reamer", "length": 2, "id": "71.4 mm", "od": "250 mm", "mass": 400}
    survey = {"md": [0, DEPTH], "inclination": [0, 0], "azimuth": [0, 0]}
    sections = [
        {"to": 152, "kind": "open_hole", "diameter": "250 mm"},
        {"to": DEPTH, "kind": "open_hole", "diameter": "215.9 mm"},
    ]
    shares = []
    for formulation in ("ancf", "quaternion"):
        found = case(
            blades,
            well={"survey": survey, "sections": sections},
            formation={"drillability": "1e-8 m/(s N)", "bit_law": "drag_bit"},
            beam={"formulation": formulation},
            time={"end": 1e-3},
            output={"history_every": 1e-3},
            fluid=None,
        )
        first = read_table(run(found, tmp_path / formulation).folder / "history.csv")
        shares.append([first[q][0] for q in ("wob_reamer [N]", "wob [N]", "torque_reamer [N m]")])
    assert min(shares[0]) > 10.0
    np.testing.assert_allclose(shares[1], shares[0], rtol=0.01)


# ---------------------------------------------------------------------- no annulus
def test_pressure_under_the_bit_without_an_annulus_is_that_of_the_outlet(tmp_path):
    """The loss of the nozzles lies between both sides of the bit: statics, runs and `hydraulics` give the side outside."""
    rheology = {"model": "newtonian", "viscosity": 0.01}
    mud = {
        "density": 1200,
        "rheology": rheology,
        "flow_rate": 0.025,
        "annulus": False,
        "outlet_pressure": 3e5,
    }
    found = case(fluid=mud, time={"end": 1e-3}, output={"history_every": 1e-3})
    assert statics(found, tmp_path / "s").summary["bit_pressure"] == pytest.approx(3e5)
    history = read_table(run(found, tmp_path / "r").folder / "history.csv")
    np.testing.assert_allclose(history["bit_pressure [Pa]"], 3e5)
    assert Hydraulics(found).at(0.025).summary["bit_pressure"] == pytest.approx(3e5)
