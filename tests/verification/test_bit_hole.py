"""The new hole: path against closed forms, radius, and direction (manual: verif-hole-path)."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, load_case, run
from drillpetsc.analysis.motion.quasi_static import QuasiStatic
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well, direction
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output import read_table
from drillpetsc.physics.quantities import BIT_SIDE
from drillpetsc.solvers.petsc_options import applied
from tests.helpers.bit_models import RADIUS, TURNING, bit_of, unknowns
from tests.helpers.motion import beam
from tests.helpers.wells import simple_well

CASES = Path(__file__).parents[2] / "cases"
DRILLABILITY, WEIGHT, LENGTH = 1e-5, 1e4, 100.0  # m/(s N), N, m: 0.1 m/s
FACE = (
    2 * RADIUS
)  # length of the bit: as high as wide, its cutting part is a ball, and forces on it pass through its middle


def drilled(
    formation: dict[str, Any],
    across: Any,
    end: float,
    inclination: float = 0.0,
    azimuth: float = 0.0,
    bending: float = 1e6,
) -> DrillingModel:
    """Model after ``end`` [s] of quasi-static drilling under given forces at the bit's upper end: 10 kN along
    the hole and ``across`` times 1 N to the north (opposite to the high side).

    The string is so long and slender that it adds less than 0.3 % of the side force. bending: EI [N m2]; a
    side force F tilts the bit by F * 0.108 m * LENGTH/EI, and the string returns 3 EI/LENGTH^3 times the
    offset.
    """
    item = beam(
        LENGTH, 4, 1e3 * LENGTH, bending, 1e6, 10.0, 1e-3, od=0.2 * FACE
    )  # too thin to touch the wall
    bit = {"kind": "bit", "length": FACE, "od": 2 * RADIUS, "mass": 1.0}
    depth = LENGTH + FACE
    well = simple_well(depth, 2 * RADIUS, inclination, azimuth=azimuth, friction=0.0)
    along, side = direction(inclination, azimuth), direction(inclination + np.pi / 2, azimuth)
    loads = [
        {"at": LENGTH, "force": (WEIGHT * along).tolist()},
        {"at": LENGTH, "force": side.tolist(), "value_over": across},
    ]
    case = Case(
        string=[item, bit],
        well=well,
        contact={"stiffness": 1e8 / FACE},  # the side of the bit: 1e8 N/m
        loads=loads,
        gravity=0.0,
        time={"end": end, "mode": "quasi_static"},
        top={"kind": "top_drive", "rotation": TURNING, "lowering": DRILLABILITY * WEIGHT},
        initial={"from": "statics"},
        bottom={"kind": "bit", "stiffness": 1e8, "friction": 0.0},
        formation={"drillability": DRILLABILITY, "rotary_exponent": 0.0, "node_spacing": 0.1, **formation},
    )
    model = build_model(case)
    find_equilibrium(model)
    # the line search: where the overgauge hole begins, the side of the bit is free until it meets the wall again; in a hole of its
    # gauge the equations are nearly linear, and after one iteration rounding is all that a search could reduce
    search = {"q_snes_linesearch_type": "bt"} if "overgauge" in formation else {}
    with applied({"ts_rtol": 1e-5, **search}):
        quasi = QuasiStatic(model)
        integrator = quasi.integrator()
        quasi.start()
        integrator.run(0.0, end)
    return model


def frozen(model: DrillingModel) -> np.ndarray:
    """(n, 7) nodes of the new hole: measured depth, position, direction."""
    nodes = bit_of(model).hole.get_state()["nodes"]
    return nodes[nodes[:, 0] > LENGTH + FACE + 1e-9]


def test_constant_build_under_a_growing_side_force():
    """Isotropic bit and rock under (q t, 0, W): north' = D q t, down' = D W, so north = q z^2/(2 D W^2), 0.1
    rad/m here.

    The nodes lie on that parabola with its direction, and the drilled length is its arc length; within 0.3 %,
    because the string adds to the side force.
    """
    q, end = 100.0, 10.0
    model = drilled({"bit_anisotropy": 1.0}, {"time": [0, 100], "value": [0, 100 * q]}, end)
    nodes, bend = frozen(model), q / (DRILLABILITY * WEIGHT**2)
    z = nodes[:, 3] - (LENGTH + FACE - RADIUS)  # from the centre of the bit at the start
    assert len(nodes) >= 7
    assert nodes[:, 1] == pytest.approx(0.5 * bend * z**2, rel=3e-3, abs=1e-6)
    assert nodes[:, 4] / nodes[:, 6] == pytest.approx(bend * z, rel=3e-3)
    assert nodes[:, 2] == pytest.approx(np.zeros(len(nodes)), abs=1e-9)
    depth = DRILLABILITY * WEIGHT * end
    arc = 0.5 * (depth * np.hypot(1, bend * depth) + np.arcsinh(bend * depth) / bend)
    assert unknowns(model, "hole.end") == pytest.approx([0.5 * bend * depth**2, 0, depth], rel=3e-3, abs=1e-9)
    assert unknowns(model, "hole.drilled")[0] == pytest.approx(arc, rel=1e-4)


@pytest.mark.parametrize(("way", "sideways"), [("rop_vector", 0.2), ("bit_axis", 0.0)])
def test_direction_of_the_hole(way, sideways):
    """Side force of 1 kN at 10 kN, inclined hole: the end moves at atan(0.2 * 0.1) from the bit's axis with
    direction `rate`, or along the axis."""
    model = drilled(
        {"bit_anisotropy": 0.2, "direction": way}, 1e3, 3.0, inclination=0.5, azimuth=2.0, bending=1e8
    )
    along, side = direction(0.5, 2.0), direction(0.5 + np.pi / 2, 2.0)
    end = unknowns(model, "hole.end")
    assert end @ along == pytest.approx(DRILLABILITY * WEIGHT * 3.0, rel=2e-3)
    assert (end @ side) / (end @ along) == pytest.approx(sideways * 0.1, rel=5e-3, abs=2e-4)
    assert end @ np.cross(along, side) == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("interval", [0.5, 0.1, 0.05])
@pytest.mark.parametrize("overgauge", [2e-3, -1e-3])
def test_radius_of_the_new_hole(overgauge, interval):
    """Radius of the bit plus overgauge, beyond the smooth change of section.

    A bit in a hole of its own size has no clearance. In an overgauge hole it touches the wall only after the
    clearance: offset = clearance + force/stiffness.
    """
    model = drilled({"overgauge": overgauge, "node_spacing": interval}, 1e3, 10.0, bending=1e8)
    bit = bit_of(model)
    well = bit.hole.well
    assert float(well.radius(LENGTH + FACE + 0.7)) == pytest.approx(RADIUS + overgauge, rel=1e-12)
    assert float(well.radius(LENGTH - 0.1)) == pytest.approx(RADIUS, rel=1e-12)
    assert bit.hole.radial_clearance(RADIUS) == pytest.approx(max(overgauge, 0.0), abs=1e-12)
    figures = bit.element_results(model.system.assembly)
    assert figures[7] == pytest.approx(max(overgauge, 0.0) + figures[3] / 1e8, abs=1e-6)
    sample = SimpleNamespace(once=lambda function: function(model.system.assembly))
    columns = {quantity.name: quantity.value(bit, sample) for quantity in BIT_SIDE}
    assert columns["bit_orbit"] == pytest.approx(max(overgauge, 0.0) + figures[3] / 1e8, abs=1e-6)
    assert columns["bit_overgauge"] == pytest.approx(max(overgauge, 0.0), abs=1e-12)
    assert figures[3] == pytest.approx(
        1e3 - WEIGHT * 0.02, rel=0.02
    )  # the bottom, tilted by 0.2 * 0.1, carries a part of it


@pytest.mark.parametrize(("interval", "longest"), [(0.5, 0.2), (0.1, 0.2)], ids=["short_steps", "long_steps"])
def test_nodes_of_a_curved_path_lie_on_its_arc(interval, longest):
    """GrowingHole alone, moved along a circle of 30 deg/30 m in irregular steps: nodes on the circle, with
    its direction, at equidistant depths.

    Positions are interpolated by cubics between steps, directions are chords of half an interval: errors (0.5
    h)^2/(24 R^2) = 8e-7 rad.
    """
    radius, rng = 57.3, np.random.default_rng(5)
    well = Well.from_survey([0, 30.0], [0, 0], [0, 0], [30.0], [0.108], [0.3])
    hole = GrowingHole(well, 0.1, 0.108, 0.3, interval)
    s = np.cumsum(rng.uniform(0.002, longest, 200))

    def circle(q):
        """Straight for the first metre."""
        u = np.maximum(q - 1.0, 0.0) / radius
        return np.stack([radius * (1 - np.cos(u)), 0 * u, np.minimum(q, 1.0) + radius * np.sin(u)], axis=-1)

    for q in s:
        assert hole.follow(q, hole.start_point + circle(q))
    nodes = hole.get_state()["nodes"][2:]
    q = nodes[:, 0] - 29.9
    late = q > 2.5
    # the first node is a twentieth of the interval below the place of the end at the start
    assert nodes[:, 0] == pytest.approx(29.9 + interval * (0.05 + np.arange(len(nodes))), abs=1e-12)
    assert late.sum() > 20
    assert nodes[late, 1:4] == pytest.approx((hole.start_point + circle(q))[late], abs=2e-6)
    angle = (q[late] - 1.0) / radius
    assert nodes[late, 4:] == pytest.approx(
        np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1), abs=2e-5
    )


def test_contact_none_leaves_the_side_of_the_bit_free():
    """A side force of 1 kN on a bit without contact: no side force on the rock, and the hole goes on along its
    axis although the bit would cut sideways (manual: sec-bit-shape)."""
    survey = {"md": [0, 10.0], "inclination": [0, 0], "azimuth": [0, 0]}
    case = Case(
        string=[
            beam(9.8, 4, 1e6, 1e7, 1e6, 10.0, 1e-3, od=0.1),
            {"kind": "bit", "length": 0.2, "od": 2 * RADIUS, "mass": 1.0},
        ],
        well={"survey": survey, "sections": [{"to": 10.0, "kind": "open_hole", "diameter": 2 * RADIUS}]},
        contact="none",
        loads=[{"at": 9.8, "force": [1e3, 0, 0]}],
        gravity=0.0,
        top={"kind": "top_drive", "rotation": TURNING, "lowering": 1e-2},
        bottom={"kind": "bit", "friction": 0.0},
        formation={"bit_anisotropy": 1.0},
        initial={"from": "statics", "wob": WEIGHT},
    )
    model = build_model(case)
    find_equilibrium(model)
    weight, *_, side = bit_of(model).element_results(model.system.assembly)[:4]
    assert weight == pytest.approx(WEIGHT, rel=1e-2) and side == 0.0
    # a cantilever under a force at its end: F L^3/3 EI (the weight on bit adds 3 % to it)
    moved = model.system.field("string.position")[-1, 0]
    assert moved == pytest.approx(1e3 * 9.8**3 / 3e7, rel=0.05)


def angle_errors(kink: float, curvature: float) -> tuple[float, float, float]:
    """Errors of a hole that leaves the vertical by a ``kink`` [rad] and goes on in an arc of ``curvature`` [1/m].

    GrowingHole alone, moved in steps of 5 cm over 6 m.  Returns how far the inclination goes beyond that of the
    path at the end and along the final hole, and how far it stays below it 0.6 m from the kink on [rad].
    """
    well, half, steps = (
        Well.from_survey([0, 100], [0, 0], [0, 0], [100], [0.1], [0.3]),
        0.2,
        np.arange(0.05, 6, 0.05),
    )
    hole, end = GrowingHole(well, half, 0.1, 0.3, 0.5), 0.0

    def place(s):
        """From the start of the path: the integral of (sin, 0, cos) of kink + curvature s."""
        if curvature == 0:
            return s * np.array([np.sin(kink), 0, np.cos(kink)])
        a = kink + curvature * s
        return np.array([np.cos(kink) - np.cos(a), 0, np.sin(a) - np.sin(kink)]) / curvature

    for s in steps:
        hole.follow(s, hole.start_point + place(s))
        end = max(end, np.arctan2(hole.direction[0], hole.direction[2]) - (kink + curvature * s))
    final, s = hole.whole_path(steps[-1], hole.start_point + place(steps[-1])), np.linspace(0, steps[-1], 500)
    error = final.inclination(well.depth - half + s) - (kink + curvature * s)
    return end, float(error.max()), float(-error[s > 0.6].min())


@pytest.mark.parametrize("kink", np.radians([0.3, 5.0]))
@pytest.mark.parametrize("curvature", np.radians([0.0, 3.0, 10.0]) / 30)
def test_the_hole_does_not_swing_at_a_kink(kink, curvature):
    """A kink of 0.3 or 5 degrees at the beginning of the new hole, then an arc of 0, 3 or 10 deg/30 m: the
    inclination of the hole is that of the path, kink + curvature s, and goes beyond it by at most 1 % of the
    kink; its direction at the end by at most a quarter while it grows, the most that half of the smaller of two
    turns, which make up the kink together, can be (manual: verif-hole-kink)."""
    end, beyond, below = angle_errors(kink, curvature)
    assert end < 0.25 * kink + 1e-6
    assert beyond < 0.01 * kink + 2e-5 and below < 0.002 * kink + 2e-5


@pytest.mark.parametrize("rate", [3.0, 10.0])
def test_the_hole_follows_an_arc_from_its_beginning(rate):
    """An arc of 3 or 10 deg/30 m that begins where the vertical hole ends: inclination rate times length within
    0.005 degrees everywhere; the direction at its end does not go beyond it (manual: verif-hole-kink)."""
    end, beyond, below = angle_errors(0.0, np.radians(rate) / 30)
    assert end < 1e-6 and beyond < np.radians(0.005) and below < np.radians(0.001)


def test_drilled_path_does_not_depend_on_the_node_spacing(tmp_path):
    """cases/directional.yaml, 2 m: inclination of the hole with nodes every 0.5 m and every 0.1 m, from 0.3 m on
    within 0.08 degrees: half of the turn of 0.13 degrees within 0.1 m where the stabilizer enters the new
    hole, which nodes every 0.5 m spread."""
    md = 1200 + np.arange(0.3, 1.7, 0.1)
    path = []
    for spacing in ("0.5 m", "0.1 m"):
        case = load_case(CASES / "directional.yaml", [f"formation.node_spacing={spacing}", "time.end=720 s"])
        run(case, tmp_path / spacing, progress="silent")
        table = read_table(tmp_path / spacing / "trajectory.csv")
        path.append(np.interp(md, table["md [m]"], table["inclination [deg]"]))
    assert path[0] == pytest.approx(path[1], abs=0.08)
