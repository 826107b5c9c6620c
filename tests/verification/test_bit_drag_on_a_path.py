"""The drag of a bit that cuts, at the side of its hole, while a buckled string slides (manual: sec-statics-path)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.equilibrium import MOTIONS
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from tests.helpers.wells import simple_well

FRICTION = 0.15


def test_a_coiled_string_slides_with_the_drag_of_its_bit():
    """Friction is a dead load at the end of a slide: at the bit that is the coefficient times its side force, up the hole.

    A build of 10 deg/30 m presses the bit with 13 kN against its hole; 2 kN of friction, 2.4 % of the hook load, were left out.
    """
    case = Case(
        well=simple_well([0.0, 700.0, 790.0, 820.0], 0.2159, list(np.radians([0.0, 0.0, 20.0, 30.0])), friction=FRICTION),
        string=[
            {"kind": "pipe", "length": 780.0, "od": 0.127, "id": 0.1086, "element_length": 5.0},
            {"kind": "pipe", "length": 39.7, "od": 0.1714, "id": 0.0714, "element_length": 3.0},
            {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive"},
        bottom="bit",
        formation={"drillability": 4e-8},
        gravity=9.81,
        initial={"from": "statics", "wob": 150e3},
    )  # fmt: skip
    model = build_model(case)
    state = find_equilibrium(model, MOTIONS["lower"], path="sliding")
    assert state.path is not None
    side = static_summary(model, state)["rigid_items"][-1]["contact_force_sum [N]"]
    assert FRICTION * side > 1500.0
    at = model.system.layout.dofs["string.position"][-1]
    well = model.well
    assert well is not None and model.system.assembly.dead_load is not None
    up = -np.asarray(well.at(np.array([820.0]))[1])[0]
    friction = float(model.system.assembly.dead_load[at] @ up)
    assert abs(friction) == pytest.approx(FRICTION * side, rel=0.05)
