"""What statics says of buckling, lock-up and stability (manual: sec-statics-report, sec-statics-march)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, load_case, statics
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.start.march import march
from drillpetsc.errors import SolveError
from drillpetsc.geometry.hole_steps import HoleSteps
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.output.watches.axial_strain import largest_strain

BENDING, WEIGHT, CLEARANCE = 1.2240289e6, 242.0, 0.04445
AREA = 3.4047325e-3
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "material": {"density": WEIGHT / 9.81 / AREA}}


def straight(inclination: float, length: float, friction: float = 0.0) -> dict:
    survey = {"md": [0.0, length], "inclination": [np.radians(inclination)] * 2, "azimuth": [0.3, 0.3]}
    return {
        "survey": survey,
        "sections": [{"to": length, "kind": "open_hole", "diameter": 0.2159, "friction": friction}],
    }


def pushed(force: float, length: float = 300.0, element: float = 3.0, **keys) -> Case:
    """A pipe in a level hole, pushed at the top against a bit that stands."""
    return Case(
        **{
            "well": straight(90.0, length),
            "string": [{**PIPE, "length": length, "element_length": element}],
            "top": {"kind": "top_drive", "force": -force},
            "bottom": {"kind": "bit", "friction": 0},
            "gravity": 9.81,
            **keys,
        }
    )


def test_steps_follow_the_wall_to_second_order() -> None:
    """A node that moves by d along the wall of a hole leaves it by less than d^3; x + p leaves it by d^2/2r."""
    md = np.arange(0.0, 301.0, 30.0)
    well = Well.from_survey(
        md, np.radians(0.1 * md), np.radians(20 + 0.1 * md), [300.0], [0.1], [0.2], ["open_hole"]
    )
    rng = np.random.default_rng(1)
    centre, t, _ = well.at(np.array([77.0, 141.0]))
    side = np.cross(t, [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    x = np.zeros(14)
    for k in range(2):
        x[7 * k : 7 * k + 3], x[7 * k + 3 : 7 * k + 6] = centre[k] + 0.04 * side[k], t[k]
    steps = HoleSteps(well, np.array([[0, 3], [7, 10]]), np.full(2, 0.05))
    p = rng.standard_normal(14)
    for k in range(2):  # along the wall: no radial part
        p[7 * k : 7 * k + 3] -= side[k] * (side[k] @ p[7 * k : 7 * k + 3])
    small = steps(x, p, 1e-7) - x
    assert small == pytest.approx(1e-7 * p, abs=2e-11)
    for size in (4e-3, 1e-3):
        moved = steps(x, size * p / np.linalg.norm(p[:3]), 1.0).reshape(2, 7)[:, :3]
        plain = (x + size * p / np.linalg.norm(p[:3])).reshape(2, 7)[:, :3]
        on, off = (np.linalg.norm(well.project(q).offset, axis=1) - 0.04 for q in (moved, plain))
        assert np.abs(on).max() < 2 * size**3 / 0.04**2 and np.abs(off).max() > 0.1 * size**2 / 0.08


def test_a_moment_does_not_switch_stability_off() -> None:
    """A vertical string under ten times its critical load with an end moment is not returned straight and stable.

    Critical load of Lubinski: 1.94 (EI w^2)^(1/3) = 8.1 kN.  The energy's Hessian of the straight string has
    negative eigenvalues whatever the moment, so a state that is called stable must lie on the wall.
    """
    made = Case(
        well=straight(0.0, 200.0),
        string=[
            {**PIPE, "length": 199.5, "element_length": 2.5},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive"},
        bottom={"kind": "bit"},
        loads=[{"at": 150.0, "moment": [0.0, 0.0, 500.0]}],
        gravity=9.81,
        initial={"from": "statics", "wob": 85e3},
    )
    model = build_model(made)
    try:
        state = find_equilibrium(model)
    except SolveError:
        return  # refused: nothing is said that is not so
    offset = np.linalg.norm(model.well.project(model.system.field("string.position")).offset, axis=1)
    assert not state.stable or offset.max() > 0.9 * CLEARANCE


def test_coiled_tubing_that_is_pushed_locks_up(tmp_path) -> None:
    """The push T of a helix obeys dT/ds = mu C T^2/4EI: it is infinite 4EI/(mu C T) above a force T."""
    bending, clearance = 2.06e11 * np.pi / 64 * (0.0603**4 - 0.0507**4), (0.1143 - 0.0603) / 2
    end = 40e3  # push that reaches the bit [N], above the helical load at any weight here
    length = 4 * bending / (0.3 * clearance * end)
    made = Case(
        well={**straight(90.0, 1.5 * length, 0.3), "sections": [
            {"to": 1.5 * length, "kind": "casing", "diameter": 0.1143, "friction": 0.3}
        ]},
        string=[{"kind": "pipe", "length": 1.5 * length, "od": 0.0603, "id": 0.0507, "element_length": 1.5 * length / 400,
                 "material": {"young": 2.06e11, "density": 1000.0}}],
        top={"kind": "top_drive", "lowering": 0.2},
        bottom={"kind": "bit"},
        gravity=9.81,
        initial={"from": "statics", "wob": end},
    )  # fmt: skip
    with pytest.raises(SolveError, match="locked up: no weight passes MD") as caught:
        statics(made, tmp_path / "run")
    depth = float(str(caught.value).split("passes MD ")[1].split(" m")[0])
    # a push of 1 % of EA instead of an infinite one: the distance is shorter by 4EI/(mu C 0.01 EA)
    crushing = 0.01 * 2.06e11 * np.pi / 4 * (0.0603**2 - 0.0507**2)
    expected = 1.5 * length - 4 * bending / (0.3 * clearance) * (1 / end - 1 / crushing)
    assert depth == pytest.approx(expected, rel=0.02)


def test_the_march_is_torque_and_drag_where_nothing_coils() -> None:
    """Level hole: T at the top is that at the bottom less mu w L when lowered (exact), the torque zero."""
    made = Case(
        well=straight(90.0, 400.0, 0.25),
        string=[{**PIPE, "length": 400.0, "element_length": 8.0}],
        top={"kind": "top_drive", "lowering": 0.2},
        bottom="free",
        gravity=9.81,
    )
    model = build_model(made)
    place_along_hole(model)
    found = march(model, (1.0, 0.0))
    assert found is not None and not found.helical.any() and found.locked is None
    assert found.axial_force[0] == pytest.approx(-0.25 * WEIGHT * 400.0, rel=1e-6)
    assert found.torque == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("ratio", "kind"), [(0.6, None), (1.15, "sinusoidal"), (2.9, "helical")])
def test_buckling_is_named(tmp_path, ratio, kind) -> None:
    """Sinusoidal above F_DP = 2 sqrt(EI w/C) (Dawson and Paslay, SPE 11167), helical from 1.83 F_DP at the latest
    (Chen, Lin and Cheatham 1990)."""
    critical = 2 * np.sqrt(BENDING * WEIGHT / CLEARANCE)
    result = statics(pushed(ratio * critical), tmp_path / "run")
    buckling = result.summary["buckling"]
    if kind is None:
        assert buckling == {"sinusoidal": [], "helical": []}
        return
    longest = max(b - a for a, b in buckling[kind])
    assert longest > 120.0 and any("may have other stable states" in w for w in result.summary["warnings"])


def test_elements_too_long_for_a_helix_are_reported(tmp_path) -> None:
    """A quarter of the pitch 2 pi sqrt(2EI/F) is what would do."""
    force = 400e3
    result = statics(pushed(force, element=10.0), tmp_path / "run")
    enough = 0.5 * np.pi * np.sqrt(2 * BENDING / force)
    lines = [w for w in result.summary["warnings"] if "too long for the buckled shape" in w]
    assert lines and float(lines[0].split("element_length of ")[1].split(" m")[0]) == pytest.approx(
        enough, rel=0.05
    )


def test_the_soft_string_lies_where_the_string_lies(tmp_path) -> None:
    """A string of 300 m on the bottom of a hole of 400 m: the soft string beside it begins at 100 m, too.

    Hole of 3 deg/30 m, no friction: T = w (z(400) - z(100)) - WOB (virtual work of a rope in a tube).
    """
    radius = 30 / np.radians(3)
    made = Case(
        well={
            "survey": {"md": [0.0, 400.0], "inclination": [0.0, 400.0 / radius], "azimuth": [0.0, 0.0]},
            "sections": [{"to": 400.0, "kind": "open_hole", "diameter": 0.2159, "friction": 0.0}],
        },
        string=[
            {**PIPE, "length": 299.9, "element_length": 10.0},
            {"kind": "bit", "length": 0.1, "od": 0.2159, "mass": 1.0},
        ],
        top={"kind": "top_drive"},
        bottom={"kind": "bit"},
        gravity=9.81,
        initial={"from": "statics", "wob": 10e3},
    )
    result = statics(made, tmp_path / "run")
    expected = WEIGHT * radius * (np.sin(400 / radius) - np.sin(100 / radius)) - 10e3
    assert result.summary["soft_string"]["hook_load"] == pytest.approx(expected, rel=1e-3)
    assert result.summary["hook_load"] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_the_push_that_reaches_a_standing_bit(friction) -> None:
    """Level hole, pushed below the helical load: F - mu w L at the bit, the whole push without friction (exact)."""
    force, length = 60e3, 300.0
    model = build_model(pushed(force, length, well=straight(90.0, length, friction)))
    place_along_hole(model)
    found = march(model, (1.0, 0.0))
    assert found is not None and not found.helical.any()
    assert found.axial_force[-1] == pytest.approx(-(force - friction * WEIGHT * length), rel=1e-6)
    assert found.axial_force[0] == pytest.approx(0.0, abs=1.0)


def test_a_pushed_string_without_friction_stands_on_the_bit_with_the_whole_push() -> None:
    """A helix carries the push on: 2.2 F_DP at the top are 2.2 F_DP on the bit."""
    force = 2.2 * 2 * np.sqrt(BENDING * WEIGHT / CLEARANCE)
    model = build_model(pushed(force))
    state = find_equilibrium(model)
    assert state.stable
    weight, _ = model.bit.weight_and_torque(model.system.assembly)
    assert weight == pytest.approx(force, rel=1e-4)


@pytest.mark.parametrize("azimuth", [0.0, 1.2])
@pytest.mark.parametrize("wet", [False, True])
def test_a_short_string_is_judged_where_it_lies(tmp_path, azimuth, wet) -> None:
    """600 m in a J-well of 1600 m, on bottom: all of it in the level part, from MD 1000 m on.

    Load of Dawson and Paslay 2 sqrt(EI w/C) with the buoyed weight, not that of the vertical part above; 20 kN do
    not buckle it.  The level part may point to the second director of the vertical top (azimuth 0).
    """
    md = np.append(np.arange(0.0, 1600.0, 30.0), 1600.0)
    survey = {
        "md": md.tolist(),
        "inclination": np.radians(np.clip((md - 300) * 0.2, 0, 90)).tolist(),
        "azimuth": [azimuth] * len(md),
    }
    fluid = {
        "density": 1300.0,
        "rheology": {"model": "newtonian", "viscosity": 0.02},
        "bulk_modulus": 2e9,
        "flow_rate": 0.02,
    }
    made = Case(
        well={
            "survey": survey,
            "sections": [{"to": 1600.0, "kind": "open_hole", "diameter": 0.2159, "friction": 0.2}],
        },
        string=[
            {**PIPE, "length": 599.5, "element_length": 10.0},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive"},
        bottom={"kind": "bit"},
        gravity=9.81,
        initial={"from": "statics", "wob": 20e3},
        **({"fluid": fluid} if wet else {}),
    )
    result = statics(made, tmp_path / "run", motion="lower")
    assert result.summary["stable"] and result.summary["buckling"] == {"sinusoidal": [], "helical": []}
    table = read_table(tmp_path / "run" / "statics.csv")
    # mud in and around the pipe: metal less the fluid it displaces
    weight = WEIGHT - (1300.0 * 9.81 * AREA if wet else 0.0)
    expected = 2 * np.sqrt(BENDING * weight / CLEARANCE)
    assert table["buckling_load [N]"][5:-5] == pytest.approx(expected, rel=2e-3)


def test_lock_up_is_reported_at_the_depth_of_the_hole(tmp_path) -> None:
    """The same string and hole, 100 m deeper in a longer hole: the depth of lock-up is 100 m deeper."""
    depths = []
    for below in (0.0, 100.0):
        made = Case(
            well={
                **straight(90.0, 1000.0 + below),
                "sections": [{"to": 1000.0 + below, "kind": "casing", "diameter": 0.1143, "friction": 0.4}],
            },
            string=[{"kind": "pipe", "length": 1000.0, "od": 0.0603, "id": 0.0507, "element_length": 2.5}],
            top={"kind": "top_drive", "lowering": 0.2},
            bottom={"kind": "bit"},
            gravity=9.81,
            initial={"from": "statics", "wob": 60e3},
        )
        with pytest.raises(SolveError, match="locked up") as caught:
            statics(made, tmp_path / f"run{below:g}")
        depths.append(float(str(caught.value).split("passes MD ")[1].split(" m")[0]))
    assert depths[1] - depths[0] == pytest.approx(100.0, abs=1.0)


def test_a_helix_without_weight_is_neutral_and_not_unstable(tmp_path) -> None:
    """It rolls about the axis of the hole without work: an eigenvalue of rounding size, not a buckle.

    Wall force r F^2/4EI (Lubinski, Althouse and Logan, JPT 14(6), 1962); a straight string under the same push is unstable.
    """
    force, od = 250e3, 0.1397
    inertia = np.pi / 64 * (od**4 - 0.1214**4)
    case = Case(
        well={
            "survey": {"md": [0.0, 200.0], "inclination": [0.0, 0.0], "azimuth": [0.0, 0.0]},
            "sections": [{"to": 200.0, "kind": "open_hole", "diameter": 0.2159, "friction": 0.0}],
        },
        string=[{"kind": "pipe", "length": 200.0, "od": od, "id": 0.1214}],
        top={"kind": "top_drive", "force": -force},
        bottom={"kind": "bit", "friction": 0.0},
        gravity=0.0,
        initial={"from": "statics"},
    )
    summary = statics(case, tmp_path / "out").summary
    assert summary["stable"] and summary["negative_pivots"] == 0
    table = read_table(tmp_path / "out" / "statics.csv")
    there = (table["md [m]"] > 40) & (table["md [m]"] < 160)
    wall = 0.5 * (0.2159 - od) * force**2 / (4 * 206e9 * inertia)
    assert table["contact_force [N/m]"][there].mean() == pytest.approx(wall, rel=0.03)


def test_lock_up_in_feet_of_a_field_case(tmp_path) -> None:
    """The depth that no weight passes, in the units of the case: the same place as in metres."""
    depth = {}
    for units in ("field", "metric"):
        made = Case(
            well=straight(90.0, 3000.0, 0.4),
            string=[{"kind": "pipe", "length": 3000.0, "od": 0.0603, "id": 0.0507, "element_length": 10.0}],
            top={"kind": "top_drive", "lowering": 0.2},
            bottom={"kind": "bit"},
            initial={"from": "statics", "wob": 40e3},
            output={"units": units},
        )
        with pytest.raises(SolveError, match="locked up") as caught:
            statics(made, tmp_path / units)
        number, unit = str(caught.value).split("passes MD ")[1].split()[:2]
        depth[unit] = float(number)
    assert depth["ft"] * 0.3048 == pytest.approx(depth["m"], abs=0.6)


def test_a_string_that_nothing_holds_is_said_to_fall(tmp_path) -> None:
    """The answer was that a stiffness matrix could not be made positive definite."""
    made = Case(
        well=straight(15.0, 300.0, 0.2),
        string=[{"kind": "pipe", "length": 200.0, "od": 0.127, "id": 0.1086}],
        top="free",
        bottom="free",
    )
    with pytest.raises(SolveError, match="the string is not held along the hole") as caught:
        statics(made, tmp_path / "run")
    assert "initial: {from: rest}" in str(caught.value)


@pytest.mark.parametrize(("units", "unit", "size"), [("field", "ft", 0.3048), ("metric", "m", 1.0)])
def test_an_end_below_the_hole_in_the_units_of_the_case(tmp_path, units, unit, size) -> None:
    """3000 m of steel in a vertical hole stretch by rho g L^2/2E, 1.68 m; 1 m above the bottom the end lies 0.68 m below it."""
    made = Case(
        well=straight(0.0, 3000.0, 0.0),
        string=[{"kind": "pipe", "length": 2999.0, "od": 0.127, "id": 0.1086, "material": {"young": 2.06e11, "density": 7850.0}}],
        top="clamped",
        bottom="free",
        gravity=9.81,
        output={"units": units},
    )  # fmt: skip
    (line,) = (
        w for w in statics(made, tmp_path / "run").summary["warnings"] if "below the end of the hole" in w
    )
    number, found = line.split("lies ")[1].split()[:2]
    assert found == unit
    assert float(number) * size == pytest.approx(7850 * 9.81 * 2999.0**2 / 2 / 2.06e11 - 1.0, rel=0.01)


@pytest.mark.parametrize(("motion", "told"), [(None, True), ("rotate", True), ("hoist", False)])
def test_swirl_is_named_for_a_string_that_turns(motion, told, tmp_path):
    """A string that is hoisted without rotation was told of a torque that the swirl would add to 0.3 N m (1e5 %)."""
    found = statics(load_case("cases/field/metric.yaml"), tmp_path / "out", motion=motion)
    assert any("mud that swirls" in text for text in found.summary["warnings"]) is told


def test_elements_below_rigid_items_are_not_strained() -> None:
    """A string as it was made has no strain, also where an element begins at the lower end of a body or stabilizer."""
    body = {"kind": "body", "length": 1.0, "mass": 100.0, "od": 0.1}
    pipe = {"kind": "pipe", "length": 40.0, "od": 0.127, "id": 0.1086, "element_length": 4.0}
    case = Case(string=[pipe, body, pipe, body, pipe], top="clamped", gravity=9.81)
    model = build_model(case)
    place_along_hole(model)
    assert abs(largest_strain(model)[0]) < 1e-9


@pytest.mark.parametrize("thin", [True, False])
def test_pipe_that_its_load_must_break_is_named(tmp_path, thin) -> None:
    """300 m of pipe of 12.7 mm, meant as 127 mm, with 600 m of collars below: the strain of its top is (w1 L1 + w2 L2)/EA, below 0.1 % at ten
    times the diameters."""
    size = 1.0 if thin else 10.0
    pipe = {"kind": "pipe", "length": 300.0, "od": 12.7e-3 * size, "id": 10e-3 * size, "element_length": 2.0}
    collar = {"kind": "pipe", "length": 600.0, "od": 0.1, "id": 0.05}
    area, heavy = (np.pi / 4 * (q["od"] ** 2 - q["id"] ** 2) for q in (pipe, collar))
    strain = 7850 * 9.81 * (300 * area + 600 * heavy) / (206e9 * area)
    case = Case(
        string=[pipe, collar],
        material={"young": 206e9, "poisson": 0.3, "density": 7850.0},
        top="clamped",
        gravity=9.81,
    )
    summary = statics(case, tmp_path / "out").summary
    said = [text for text in summary["warnings"] if "any pipe yields" in text]
    assert strain > 0.01 if thin else strain < 1e-3
    assert said == (
        [
            f"pipe at MD 0 m is stretched by {100 * strain:.2g} % along its axis: any pipe yields at about 0.5 %, which this state leaves out"
        ]
        if thin
        else []
    )
