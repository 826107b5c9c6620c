"""Start of statics on a fine mesh: the equilibrium on a coarse mesh of the same case.

Manual: sec-statics-coarse-start.  Newton's method moves a boundary of a contact region by a few elements in a step,
so that a fine mesh takes many steps where a coarse one takes few.  Wells of 12 km on 9600 and 20,000 elements need it.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.mesh import coarsened

FINE = 6000  # elements from which on a coarse mesh comes first
COARSE = 2000  # elements of the coarse mesh, about


def coarse_factor(model: DrillingModel) -> float | None:
    """Length of coarse elements over those of the model; None where the model's mesh is not fine."""
    elements = int((~model.mesh.is_joint).sum())
    return elements / COARSE if elements > FINE else None


def coarse_model(model: DrillingModel, factor: float, motion: tuple[float, float]) -> DrillingModel:
    """The model on elements ``factor`` times as long, without rates; collective."""
    from drillpetsc.model.drilling_model import build_model

    return build_model(coarsened(model.case, factor), model.system.comm, motion)


def place_like(model: DrillingModel, coarse: DrillingModel) -> None:
    """Put the string, and its top, where that of a coarse mesh is; collective.

    Between the coarse nodes positions are those of the coarse elements, cubic Hermite polynomials.
    """
    model.top.anchor[:] = coarse.top.anchor
    position, slope, spin = (_whole(coarse, f"string.{name}") for name in ("position", "tangent", "spin"))
    ratio = (
        _whole(coarse, "string.ratio") if "string.ratio" in coarse.system.layout.dofs else np.ones_like(spin)
    )
    mesh, depth = coarse.mesh, model.mesh.node_depth
    s = mesh.node_depth
    cell = np.clip(np.searchsorted(s, depth, side="right") - 1, 0, len(s) - 2)
    cell = np.where(mesh.is_joint[cell], np.maximum(cell - 1, 0), cell)
    h = mesh.length[cell][:, None]
    x = np.maximum(1 - (s[cell + 1] - depth)[:, None] / h, 0.0)
    # below a junction the element begins at the end of a rigid item, with the slope of its own stretch
    axis = slope / np.linalg.norm(slope, axis=1, keepdims=True)
    a, va = position[cell] + mesh.rigid_above[cell][:, None] * axis[cell], h * ratio[cell] * slope[cell]
    b, vb = position[cell + 1], h * slope[cell + 1]
    r = (1 + 2 * x) * (1 - x) ** 2 * a + x**2 * (3 - 2 * x) * b + x * (1 - x) ** 2 * va - x**2 * (1 - x) * vb
    v = 6 * x * (1 - x) * (b - a) / h + ((1 - x) * (1 - 3 * x) * va - x * (2 - 3 * x) * vb) / h
    phi = (1 - x) * spin[cell] + x * spin[cell + 1]
    same = np.minimum(np.searchsorted(s, depth), len(s) - 1)  # a node of both has the coarse node's values
    equal = s[same] == depth
    r[equal], v[equal], phi[equal] = position[same[equal]], slope[same[equal]], spin[same[equal]]
    system = model.system
    system.set_field("string.position", r)
    system.set_field("string.tangent", v)
    system.set_field("string.spin", phi)
    if "string.ratio" in system.layout.dofs:
        system.set_field("string.ratio", np.where(equal[:, None], ratio[same], 1.0))


def _whole(model: DrillingModel, field: str) -> FloatArray:
    """Values (n_nodes, k) of a field at all nodes of the string, on every rank; collective."""
    system = model.system
    values = system.gather(system.field(field))
    whole = values if system.comm.size == 1 else system.comm.tompi4py().bcast(values)
    assert whole is not None
    return whole
