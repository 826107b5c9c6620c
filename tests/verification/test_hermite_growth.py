"""Still mud of `formulation: hermite` and an elastic string keep their energy: nothing grows (manual: sec-mud-hermite, verif-hermite-growth)."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import eigvals

from drillpetsc import Case
from drillpetsc.analysis.linear.modal import prepare_state
from drillpetsc.model.drilling_model import build_model
from drillpetsc.solvers.linear.linearization import linearise
from tests.helpers.tables import each_row
from tests.helpers.wells import newtonian

SCALE = 1e3  # [1/s]
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "element_length": 10.0}
COLLAR = {"kind": "pipe", "od": 0.1778, "id": 0.0714, "element_length": 10.0}
RIGID = {"kind": "body", "length": 9.0, "od": 0.16, "id": 0.0714, "mass": 900.0, "name": "tool"}
BIT = {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0, "nozzle_area": 380e-6}


def standing(kind: str) -> Case:
    """60 m of string without any damping in mud at rest; ``kind`` has the words below."""
    half = {"length": 30.0}
    string: list[dict[str, Any]] = [{**PIPE, **half}, {**(COLLAR if "tapered" in kind else PIPE), **half}]
    if "rigid" in kind:
        string.insert(1, RIGID)
    string.append(BIT)
    total, gap = sum(item["length"] for item in string), 0.0 if "bottom" in kind else 1.0
    more: dict[str, Any] = {} if "wall" in kind else {"contact": "none"}
    if "bottom" in kind:
        more |= {
            "bottom": {"kind": "bit", "stiffness": 4e6, "friction": 0.0},
            "initial": {"wob": 4e3},
        }
    first, last = (0.2, 0.3) if "curved" in kind else (0.5, 0.5) if "wall" in kind else (0.0, 0.0)
    ledges = {25.0: 0.3, 45.0: 0.24} if "ledge" in kind else {}
    sections = [
        {"to": to, "kind": "casing", "diameter": size, "friction": 0.0}
        for to, size in (ledges | {total + gap: 0.2159}).items()
    ]
    return Case(
        well={
            "survey": {"md": [0, total + gap], "inclination": [first, last], "azimuth": [0, 0]},
            "sections": sections,
        },
        string=string,
        top="clamped",
        **{"bottom": "free"} | more,
        fluid=newtonian(
            1200.0,
            0.0,
            bulk_modulus=2e9,
            flow_rate=0.0,
            outlet_pressure=2e7 if "deep" in kind else 0.0,
            elastic_walls="stiff" not in kind,
            lateral_damping=0.0,
            swirl="none",
            formulation="hermite",
        ),
    )


def fastest_growth(case: Case) -> float:
    """Largest growth rate of the linearised system [1/s], by all its eigenvalues."""
    model = build_model(case)
    prepare_state(model, "rest")
    q = linearise(model.system)
    K, C, M = (power * A.toarray() for power, A in ((1, q.K), (SCALE, q.C), (SCALE**2, q.M)))
    n = len(K)
    left, right = np.ones(n), np.ones(n)
    for _ in range(30):  # rows and columns of one size
        size = np.abs(K) + np.abs(C) + np.abs(M)
        left /= np.sqrt((left[:, None] * size * right).max(axis=1))
        right /= np.sqrt((left[:, None] * size * right).max(axis=0))
    K, C, M = (left[:, None] * A * right for A in (K, C, M))
    zero, one = np.zeros((n, n)), np.eye(n)
    s = eigvals(np.block([[zero, one], [-K, -C]]), np.block([[one, zero], [zero, M]]))
    return float(s.real[np.isfinite(s) & (np.abs(s) < 1e6)].max() * SCALE)


@each_row(
    "kind",
    [
        "free",
        "free stiff",
        "bottom",
        "bottom stiff",
        "tapered",
        "tapered stiff deep",
        "rigid",
        "rigid tapered bottom",
        "deep",
        "ledge deep",
        "ledge rigid bottom",
    ],
)
def test_still_mud_in_a_straight_hole_does_not_grow(kind):
    """Rounding at most; pressures that loaded the string otherwise than they answered made modes of 100 to 280 Hz grow
    with 5 to 21 1/s."""
    assert fastest_growth(standing(kind)) < 1e-8


@each_row(
    "kind",
    ["wall", "wall rigid bottom", "wall tapered", "curved tapered wall deep", "curved rigid wall ledge"],
)
def test_still_mud_beside_a_string_on_the_wall_does_not_grow(kind):
    """The buoyancy across the hole follows the density, which it does not feel: growth by that share of the weight is below 1e-4 1/s."""
    assert fastest_growth(standing(kind)) < 1e-4
