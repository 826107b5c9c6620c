"""Quaternion element with wall contact: lying, sliding and rotating under friction as the ANCF element."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from tests.helpers.wells import simple_well

LENGTH, FRICTION = 60.0, 0.25
PIPE = {"kind": "pipe", "length": LENGTH, "od": 0.1715, "id": 0.0714, "element_length": 6.0}
WEIGHT = 7850 * np.pi / 4 * (0.1715**2 - 0.0714**2) * 9.81  # per length, of steel [N/m]
WELL = simple_well(100, 0.2159, np.pi / 2, azimuth=0.35, friction=FRICTION)


def lying(formulation: str, **more) -> Case:
    return Case(
        **(
            {
                "string": [PIPE],
                "well": WELL,
                "gravity": 9.81,
                "bottom": "free",
                "beam": {"formulation": formulation},
                "top": {"kind": "top_drive", "lowering": 0.3},
            }
            | more
        )
    )


def test_a_string_that_lies_in_a_level_hole_is_pushed_in_against_friction():
    """Static start, friction against the lowering: the wall carries the weight w L, and the top, which holds
    the string in place, pushes with mu w L."""
    model = build_model(lying("quaternion"))
    find_equilibrium(model)
    reports, _ = model.contact.element_results(model.system.assembly)
    carried = reports[:, 0].sum()
    held = model.system.reaction("top.side_reaction_1")  # towards the high side of the hole: up
    assert carried + held == pytest.approx(WEIGHT * LENGTH, rel=1e-4)
    assert abs(held) < 1e-3 * carried
    assert model.system.reaction("top.axial_reaction") == pytest.approx(FRICTION * WEIGHT * LENGTH, rel=2e-3)
