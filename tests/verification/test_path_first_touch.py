"""A path whose string lies down into much friction (manual: sec-statics-path)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from tests.helpers.wells import simple_well


def hook_load(path: str | None) -> float:
    """Hook load [N] of a lowered string in a hole of 1500 m that builds 2 degrees, with friction 0.4."""
    case = Case(
        well=simple_well(
            [0.0, 500.0, 1000.0, 1500.0],
            0.2159,
            [0.0, 0.0, np.radians(2.0), np.radians(2.0)],
            0.3,
            friction=0.4,
        ),
        string=[
            {"kind": "pipe", "length": 1470.0, "od": 0.127, "id": 0.1086},
            {"kind": "pipe", "length": 30.0, "od": 0.1715, "id": 0.0714},
        ],
        top={"kind": "top_drive"},
        bottom={"kind": "bit", "stiffness": 1e9, "friction": 0.3},
        gravity=9.81,
        initial={"wob": 30e3},
    )
    model = build_model(case)
    state = find_equilibrium(model, (1.0, 0.0), path=path)
    if path is not None:
        assert not state.path.failed
        return state.path.ends[0].hook_load
    return -model.system.reaction("top.axial_reaction")


def test_a_string_that_lies_down_into_much_friction_slides():
    """The steps collapsed at the first touch, from a straight start and from an overload.  The hook load is that of statics
    without a path within 1 % of the weight: no buckle holds the string up."""
    assert hook_load("sliding") == pytest.approx(hook_load(None), abs=0.01 * 470e3)
