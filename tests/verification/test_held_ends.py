"""Statics of a string in its hole that is held at both ends, such as one that is stuck (manual: sec-verif-statics-torque-drag).

A string that its own weight stretches by decimetres must not carry that stretch into its lowest element.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from drillpetsc import Case
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.checks.folded_elements import backwards, refuse_folded
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case.writer import case_data
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.static_table import static_table
from tests.helpers.wells import simple_well

AREA, BENDING, YOUNG = 3.4047325e-3, 1.2240289e6, 206e9  # [m2], [N m2], [Pa]
WEIGHT, CLEARANCE = 242.0, 0.04445  # [N/m], [m]


def held_string(length: float, inclination: float, bottom: str) -> Case:
    """Drill pipe of 127 x 108.6 mm over the whole straight hole of 215.9 mm, without friction; inclination [deg]."""
    angle = float(np.radians(inclination))
    pipe = {"kind": "pipe", "od": 0.127, "id": 0.1086, "length": length}
    return Case(
        well=simple_well(length, 0.2159, angle, friction=0.0),
        string=[{**pipe, "material": {"density": WEIGHT / 9.81 / AREA}}],
        top={"kind": "clamped"},
        bottom=bottom,
        gravity=9.81,
    )


def test_a_long_string_coils_between_its_ends():
    """Hook load of a vertical string between held ends, by the stretch of its weight and the shortening of its helix.

    Its length is unchanged: the integral of F/EA over the string is that of the shortening r^2 |F|/4EI over the helix
    (Lubinski, Althouse and Logan 1962).  The upper end of the helix where it snakes shortens a little less: 1 %.
    """
    length = 1800.0  # the lowest element is as long as the string stretches by its weight
    model = build_model(held_string(length, 0.0, "clamped"))
    state = find_equilibrium(model)
    weight = WEIGHT * length

    def left(top: float) -> float:
        stretch = (top - 0.5 * weight) * length / (YOUNG * AREA)
        push = weight - top
        return stretch - CLEARANCE**2 / (4 * BENDING) * push**2 / (2 * WEIGHT)

    exact = brentq(left, 0.0, weight)
    assert static_summary(model, state)["hook_load"] == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("bottom", ["clamped", "pinned"])
def test_a_lying_string_pushes_on_its_lower_end_with_half_its_weight(bottom):
    """A string at 60 degrees that does not buckle hangs with half of its weight on each end.

    Its ends are held on the axis: the way to the wall, about r^2/2 of 15 m twice, pulls with 0.2 kN more.
    """
    length = 600.0
    model = build_model(held_string(length, 60.0, bottom))
    state = find_equilibrium(model)
    assert state.stable
    half = 0.5 * WEIGHT * length * np.cos(np.radians(60.0))
    assert static_summary(model, state)["hook_load"] == pytest.approx(half, rel=1e-2)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_stuck_string_is_pulled_by_a_given_force_through_a_bend(friction):
    """Overpull of 900 kN on pipe that is held at 1600 m below a bend of 30 degrees over 600 m: the force at the lower end and the
    stretch, by own integration of dF/ds = -(w cos I + mu |w sin I - F kappa|) in steps of 0.1 m."""
    straight, bent, length, angle, pull = 300.0, 900.0, 1600.0, float(np.radians(30.0)), 900e3
    data = case_data(held_string(length, 0.0, "clamped")) | {"top": {"kind": "top_drive", "force": pull}}
    data["well"] = simple_well([0, straight, bent, length], 0.2159, [0, 0, angle, angle], friction=friction)
    step, force, stretch = 0.1, pull, 0.0
    for s in np.arange(0.5 * step, length, step):
        tilt = angle * float(np.clip((s - straight) / (bent - straight), 0, 1))
        bend = angle / (bent - straight) if straight < s < bent else 0.0
        stretch += force / (YOUNG * AREA) * step
        force -= (WEIGHT * np.cos(tilt) + friction * abs(WEIGHT * np.sin(tilt) - force * bend)) * step
    model = build_model(Case(**data))
    state = find_equilibrium(model, motion=(-0.1, 0.0))
    columns, rows = static_table(model)
    assert state.stable and rows is not None
    axial = [name for name, *_ in columns].index("axial_force")
    assert rows[-1, axial] == pytest.approx(force, abs=5e-3 * pull)
    assert static_summary(model, state)["stretch"] == pytest.approx(stretch, rel=2e-3)


def test_an_element_that_runs_backwards_is_found():
    """Elements of 2 m: straight, bent by 120 degrees, compressed by a half, and with the lower node above the upper one."""
    down, across = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    slope = np.array([0.0, np.sin(np.radians(120.0)), np.cos(np.radians(120.0))])
    chord = np.array([2 * down, 1.6 * (down + slope), 1.0 * down, -0.6 * down, 0.1 * across])
    above = np.tile(down, (5, 1))
    below = np.array([down, slope, down, down, down])
    assert backwards(chord, above, below, np.full(5, 2.0)).tolist() == [False, False, False, True, True]


def test_a_state_with_an_element_that_runs_backwards_is_refused():
    """The lower end of a string is moved to above its neighbour: the state is refused, with the place."""
    model = build_model(held_string(100.0, 0.0, "clamped"))
    find_equilibrium(model)
    refuse_folded(model)
    position = model.system.field("string.position").copy()
    position[-1, 2] = 2 * position[-2, 2] - position[-1, 2]
    model.system.set_field("string.position", position)
    with pytest.raises(SolveError, match="runs backwards") as caught:
        refuse_folded(model)
    assert caught.value.element == model.mesh.nodes - 2
