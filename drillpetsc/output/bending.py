"""Curvature and bending moment of the string, in total and beyond its stress-free shape."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.geometry.frames import cross, directors
from drillpetsc.model.drilling_model import DrillingModel


def curvatures(model: DrillingModel) -> FloatArray:
    """(nc, 2, 2, 3) curvature vectors [1/m] of the local elements (manual: eq-beam-curvature-vector).

    First the curvature r' x r''/|r'|^2, then its part beyond the stress-free shape; each at the upper and the lower end.
    """
    system, mesh, chain = model.system, model.mesh, model.system.chain
    r, v, phi = (system.field(f"string.{k}") for k in ("position", "tangent", "spin"))
    a, b, e = chain.ends[:, 0], chain.ends[:, 1], chain.cells
    L, t = mesh.length_divisor[e][:, None], v[a] / np.linalg.norm(v[a], axis=1, keepdims=True)
    d = r[b] - r[a] - mesh.rigid_above[e][:, None] * t
    va, vb = v[a], v[b]
    if "string.ratio" in system.layout.dofs:
        va = va * system.field("string.ratio")[a]
    out = np.zeros((len(e), 2, 2, 3))
    for end, (slope, second) in enumerate(
        ((va, 6 * d / L**2 - 4 * va / L - 2 * vb / L), (vb, -6 * d / L**2 + 2 * va / L + 4 * vb / L))
    ):
        node = (a, b)[end]
        d2, d3 = directors(model.frames, chain.vertices[node], v[node], phi[node, 0])
        kappa = cross(slope, second) / np.sum(slope * slope, axis=1, keepdims=True)
        out[:, 0, end] = kappa
        out[:, 1, end] = kappa - mesh.curvature[e][:, :1] * d2 - mesh.curvature[e][:, 1:] * d3
    out[mesh.is_joint[e]] = 0.0
    return out


def bending_moments(model: DrillingModel) -> FloatArray:
    """(nc, 2) bending moment [N m] at the upper and lower end of each local element: EI times the curvature
    beyond the stress-free one."""
    bend = np.linalg.norm(curvatures(model)[:, 1], axis=2)
    return model.mesh.bending_stiffness[model.system.chain.cells][:, None] * bend
