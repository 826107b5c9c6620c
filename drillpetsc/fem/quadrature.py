"""Quadrature along an element; the coordinate is 0 at its upper and 1 at its lower end."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import StringMesh

# (points, alpha, beta) -> places and weights of Gauss's rule for the weight (1 - x)^alpha (1 + x)^beta on -1..1, as of
# scipy.special.roots_jacobi, whose import is slow; these are the rules of two contact points per element
_TABULATED = {
    (1, 1.0, 1.0): ([0.0], [1.3333333333333333]),
    (2, 0.0, 0.0): ([-0.5773502691896257, 0.5773502691896257], [1.0, 1.0]),
    (2, 0.0, 1.0): ([-0.2898979485566358, 0.6898979485566357], [0.7278344730240914, 1.2721655269759087]),
    (2, 1.0, 0.0): ([-0.6898979485566357, 0.2898979485566358], [1.2721655269759087, 0.7278344730240913]),
}


def _gauss_jacobi(points: int, alpha: float, beta: float) -> tuple[FloatArray, FloatArray]:
    """Places (n,) and weights (n,) on -1..1 of Gauss's rule for the weight (1 - x)^alpha (1 + x)^beta."""
    if points == 0:
        return np.zeros(0), np.zeros(0)
    if (points, alpha, beta) in _TABULATED:
        x, w = _TABULATED[points, alpha, beta]
        return np.array(x), np.array(w)
    from scipy.special import roots_jacobi

    return roots_jacobi(points, alpha, beta)


def rule(points: int, upper: bool = False, lower: bool = False) -> FloatArray:
    """Compute (m, 2) quadrature points and weights [-], exact for polynomials of degree 2 ``points`` - 1 at least.

    points: number m of points of Gauss's rule and of Radau's rule; Lobatto's rule has m = points + 1.
    upper, lower: put a point at that end: one end gives Radau's rule, both give Lobatto's.

    Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 25.4.29 to 25.4.32.
    """
    inside = points - int(upper and lower)
    x, w = _gauss_jacobi(inside, float(lower), float(upper))
    w = w / ((1 - x) ** lower * (1 + x) ** upper)
    if upper:
        x, w = np.append(-1.0, x), np.append(2.0 - w.sum() if not lower else 0.5 * (2.0 - w.sum()), w)
    if lower:
        x, w = np.append(x, 1.0), np.append(w, 2.0 - w.sum())
    return np.ascontiguousarray(np.column_stack([(x + 1) / 2, w / 2]))


def exposed_ends(mesh: StringMesh, free_top: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Find the element ends that are free or beside a thinner item (manual: sec-contact-quadrature).

    mesh: mesh of the string with n elements.
    free_top: the upper end of the first element is free.
    Returns two (n,) masks: elements with an exposed upper end, and with an exposed lower end.
    """
    radius = 0.5 * mesh.contact_diameter
    beside = np.where(mesh.is_joint, np.inf, radius)
    above, below = (
        np.append(0.0 if free_top else np.inf, beside[:-1]),
        np.append(beside[1:], 0.0),
    )  # radii beside an element's two ends
    # in a stack of bodies at one node, the first adjoins the element above, the last the element below
    for body in mesh.bodies:
        if body.node < len(above):
            above[body.node] = body.end_radii[1]
    for body in reversed(mesh.bodies):
        if body.node:
            below[body.node - 1] = body.end_radii[0]
    return radius > above, radius > below
