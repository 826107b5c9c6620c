"""Mass matrix of a pipe whose mass centre lies far beside its axis (manual: verif-eccentric-mass-matrix).

The kinetic energy is that of the eccentric mass, and never negative. With the eccentric mass lumped at the
nodes, beside the consistent mass of the beam, it was negative for short waves from an offset of 20 mm on
(collars of 171.5 mm), and a run with 50 mm diverged within 0.04 s.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.model.drilling_model import DrillingModel, build_model

OUTER, INNER, LENGTH, DENSITY = 0.1715, 0.0714, 12.0, 7850.0
MASS = DENSITY * np.pi / 4 * (OUTER**2 - INNER**2)  # [kg/m]
POLAR = DENSITY * np.pi / 32 * (OUTER**4 - INNER**4)  # [kg m]


def collar(offset: float, elements: int, joined: bool = False) -> DrillingModel:
    """A free collar along the north axis; joined: with a massless stabilizer between its halves."""
    half = {
        "kind": "pipe",
        "od": OUTER,
        "id": INNER,
        "eccentricity": offset,
        "element_length": LENGTH / elements,
    }
    body = {
        "kind": "stabilizer",
        "length": 0.5,
        "od": 0.2,
        "mass": 1e-9,
        "inertia": {"axial": 1e-9, "transverse": 1e-9},
    }
    string = (
        [{**half, "length": LENGTH / 2}, body, {**half, "length": LENGTH / 2}]
        if joined
        else [{**half, "length": LENGTH}]
    )
    model = build_model(Case(string=string, top="free", initial={"inclination": np.pi / 2}, gravity=0.0))
    place_along_hole(model)
    return model


def mass_matrix(model: DrillingModel) -> np.ndarray:
    """Derivative of the residual with respect to the accelerations, scaled to a unit diagonal."""
    asm, n = model.system.assembly, model.system.layout.size
    asm.jacobian(0.0, (0.0, 0.0, 1.0), condensed=False)
    M = np.zeros((n, n))
    for item in asm.bound_blocks:
        for index, K in zip(
            item.index, asm.values[item.span].reshape(item.count, item.width, item.width), strict=True
        ):
            M[np.ix_(index, index)] += K
    d = np.sqrt(np.diag(M))
    return M / np.outer(d, d)


@pytest.mark.parametrize("joined", [False, True])
@pytest.mark.parametrize("elements", [4, 24])
@pytest.mark.parametrize("offset", [0.002, 0.05])
def test_mass_matrix_is_positive_definite(offset, elements, joined):
    M = mass_matrix(collar(offset, elements, joined))
    assert np.abs(M - M.T).max() < 1e-12
    assert np.linalg.eigvalsh(M)[0] > 1e-3


@pytest.mark.parametrize("elements", [1, 3])
def test_kinetic_energy_of_a_rigid_motion(elements):
    """Translation u and rotation Omega: m |u + Omega t x e|^2/2 + Omega^2 polar inertia/2 per length, exact for
    any mesh."""
    offset, spin = 0.05, 7.0
    speed = np.array([0.3, -1.1, 0.7])
    model = collar(offset, elements)
    m = model.system
    t, second = np.array([1.0, 0.0, 0.0]), m.frames.second_director[0]
    m.set_field("string.position", np.tile(speed, (elements + 1, 1)), "y")
    m.set_field("string.spin", np.full((elements + 1, 1), spin), "y")
    centre = speed + spin * np.cross(t, offset * second)
    expected = LENGTH * (MASS * centre @ centre + POLAR * spin**2) / 2
    assert m.energies(0.0).kinetic == pytest.approx(expected, rel=1e-12)
