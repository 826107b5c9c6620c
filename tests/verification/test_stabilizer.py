"""Rigid items on the wall: a stabilizer as the middle support of a beam (manual: verif-stabilizer)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.initial_state import find_equilibrium
from drillpetsc.model.drilling_model import DrillingModel, build_model

SPAN, STABILIZER, HOLE, WEIGHT, MASS, G = 30.0, 0.212, 0.2159, 242.0, 50.0, 9.81
AREA, BENDING = 3.4047325e-3, 1.2240289e6  # of a pipe of 127 x 108.6 mm [m2], [N m2]
STAND_OFF = 0.5 * (HOLE - STABILIZER)
STIFFNESS = 1e8  # of the wall [N/m2]


def support_load(settlement: float) -> float:
    """Load [N] on the middle support of a beam that is clamped at both ends.

    Without it the middle sinks by w L^4/384 EI, and a force there moves it by F L^3/192 EI (Gere and Goodno,
    Mechanics of Materials, table H-2).  settlement: of the support [m].
    """
    return WEIGHT * SPAN / 2 + MASS * G - 192 * BENDING / SPAN**3 * settlement


def supported(length: float, **keys) -> DrillingModel:
    """A horizontal pipe in a hole, clamped at both ends on its axis, with a stabilizer of ``length`` [m] in the
    middle; the pipe itself does not touch."""
    pipe = {"kind": "pipe", "length": 0.5 * (SPAN - length), "od": 0.127, "id": 0.1086, "element_length": 1.0}
    pipe["material"] = {"density": WEIGHT / G / AREA}
    survey = {"md": [0.0, SPAN], "inclination": [0.5 * np.pi] * 2, "azimuth": [0.0, 0.0]}
    case = Case(
        well={
            "survey": survey,
            "sections": [{"to": SPAN, "kind": "casing", "diameter": HOLE, "friction": 0.0}],
        },
        string=[pipe, {"kind": "stabilizer", "length": length, "od": STABILIZER, "mass": MASS}, pipe],
        top="clamped",
        bottom="clamped",
        contact={"stiffness": STIFFNESS},
        gravity=G,
        **keys,
    )
    model = build_model(case)
    find_equilibrium(model)
    return model


def test_a_stabilizer_without_length_touches_at_one_point():
    """It stands off the wall by its clearance and sinks into it as an item as long as its diameter would, F/(k
    od) (manual: sec-contact-quadrature).  Without contact the middle would hang 0.36 m deeper and lie on the wall."""
    model = supported(0.0)
    node = next(b.node for b in model.mesh.bodies)
    sinking = support_load(STAND_OFF) / (STIFFNESS * STABILIZER)
    assert model.system.field("string.position")[node, 2] == pytest.approx(
        STAND_OFF + sinking, abs=0.02 * sinking
    )
