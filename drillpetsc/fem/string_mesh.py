"""The string as a list of elements with section properties, and of rigid items that sit on its nodes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray


@dataclass(frozen=True)
class RigidItem:
    """A rigid part of the string at a node.

    node: number from the top; above: distance from the node down to the item's upper end [m]; length [m];
    mass [kg];
    center: distance from the node down to the centre of gravity [m]; offset: (2,) of the centre of gravity
    across the axis in the node's directors [m]; axial, transverse: moments of inertia about the centre of
    gravity [kg m2]; radius [m] outside, 0: none.
    """

    name: str
    kind: str
    node: int
    above: float
    length: float
    mass: float
    center: float
    offset: tuple[float, float]
    axial: float
    transverse: float
    radius: float
    friction: float | None = None


@dataclass(frozen=True)
class StringJoint:
    """A joint: a cell without length between two nodes at the same place.

    depth: measured depth [m]; axes: (3, 3) orthonormal rows, the joint's axes in (tangent, director 2,
    director 3); spring [N/m], damping [N s/m] along a slider, stroke: the least and largest travel [m]
    between its stops, of stop_stiffness [N/m].
    """

    depth: float
    kind: str
    cell: int
    axes: tuple[tuple[float, float, float], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    stabilised: bool = False
    spring: float = 0.0
    damping: float = 0.0
    stroke: tuple[float, float] | None = None
    stop_stiffness: float = 0.0


@dataclass(frozen=True)
class StringMesh:
    """Elements from the top down; all arrays (n,) in SI unless said otherwise.

    upper, lower: measured depth of the element's ends [m]; node_depth: (n+1,) measured depth of the nodes
    (the upper end of a rigid item that hangs on a node); rigid_above: (n,) length of the rigid items between
    the upper node and the element [m].
    """

    upper: FloatArray
    lower: FloatArray
    node_depth: FloatArray
    axial_stiffness: FloatArray
    bending_stiffness: FloatArray
    torsional_stiffness: FloatArray
    mass: FloatArray
    polar_inertia: FloatArray
    outer_diameter: FloatArray
    inner_diameter: FloatArray
    stiffness_damping: FloatArray
    mass_damping: FloatArray
    rigid_above: FloatArray
    eccentricity: FloatArray  # (n, 2) in the directors [m]
    curvature: FloatArray  # (n, 2) stress-free, in the directors [1/m]
    item: np.ndarray  # (n,) index of the case's string item
    friction: FloatArray  # nan: the hole's
    bodies: tuple[RigidItem, ...] = ()
    bends: tuple[tuple[int, float, float], ...] = ()  # (node, angle, tool face): kink of a bent sub
    junction: np.ndarray = field(
        default_factory=lambda: np.zeros(0, dtype=bool)
    )  # (n+1,) nodes with a stretch ratio
    joints: tuple[StringJoint, ...] = ()  # their cells have no length and no element

    @property
    def length(self) -> FloatArray:
        """(n,) element lengths [m]."""
        return self.lower - self.upper

    @property
    def is_joint(self) -> np.ndarray:
        """(n,) cells that are joints, not elements."""
        mask = np.zeros(len(self.upper), dtype=bool)
        mask[[j.cell for j in self.joints]] = True
        return mask

    @property
    def divisor(self) -> FloatArray:
        """(n,) element lengths [m], one for joints: what is zero there stays zero per length."""
        return np.where(self.is_joint, 1.0, self.length) if self.joints else self.length

    @property
    def loose_slopes(self) -> np.ndarray:
        """Nodes beside a joint whose slope no element holds at a length: only rigid items hang on them, or a
        stretch ratio takes it."""
        joint = np.concatenate(
            [[False], self.is_joint, [False]]
        )  # joint[i], joint[i + 1]: the cells above and below node i
        there = np.concatenate([[False], ~self.is_joint, [False]])
        ratio = self.junction if len(self.junction) else np.zeros(self.nodes, dtype=bool)
        held = there[:-1] | (there[1:] & ~ratio)
        return np.flatnonzero((joint[:-1] | joint[1:]) & ~held)

    @property
    def nodes(self) -> int:
        return len(self.node_depth)

    @property
    def total_length(self) -> float:
        """Measured depth of the string's lower end [m], rigid items included."""
        last = max((b.above + b.length for b in self.bodies if b.node == self.nodes - 1), default=0.0)
        return float(self.node_depth[-1] + last)


def tube(outer: float, inner: float, young: float, poisson: float, density: float) -> dict[str, float]:
    """Stiffness and mass of a round tube per length: EA [N], EI, GJ [N m2], mass [kg/m], polar mass moment
    [kg m]."""
    area = np.pi / 4 * (outer**2 - inner**2)
    inertia = np.pi / 64 * (outer**4 - inner**4)
    shear = young / (2 * (1 + poisson))
    return {
        "axial_stiffness": young * area,
        "bending_stiffness": young * inertia,
        "torsional_stiffness": shear * 2 * inertia,
        "mass": density * area,
        "polar_inertia": density * 2 * inertia,
    }


def uniform_string(length: float, elements: int, **section: float) -> StringMesh:
    """One uniform piece, from section values as ``tube`` gives; missing values are zero."""
    depth = np.linspace(0.0, length, elements + 1)

    def full(key: str, default: float = 0.0) -> FloatArray:
        return np.full(elements, float(section.get(key, default)))

    names = (
        "axial_stiffness",
        "bending_stiffness",
        "torsional_stiffness",
        "mass",
        "polar_inertia",
        "stiffness_damping",
        "mass_damping",
    )
    columns: dict[str, Any] = {k: full(k) for k in names}
    return StringMesh(
        upper=depth[:-1],
        lower=depth[1:],
        node_depth=depth,
        **columns,
        outer_diameter=full("outer_diameter"),
        inner_diameter=full("inner_diameter"),
        rigid_above=np.zeros(elements),
        eccentricity=np.zeros((elements, 2)),
        curvature=np.zeros((elements, 2)),
        item=np.zeros(elements, dtype=int),
        friction=np.full(elements, np.nan),
        junction=np.zeros(elements + 1, dtype=bool),
    )
