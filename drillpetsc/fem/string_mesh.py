"""Mesh of the string: elements with section properties, rigid items at nodes, joints."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray

END_OF_ITEM = 1e-3  # blades that end closer than this to the end of their item reach it [m]


@dataclass(frozen=True)
class RigidItem:
    """A rigid part of the string at a node.

    name, kind: words of the case file.
    node: number from the top.
    above: distance from the node down to the item's upper end [m].
    length [m]; mass [kg].
    center: distance from the node down to the centre of gravity [m].
    offset: (2,) offset of the centre of gravity across the axis, along the node's directors [m].
    axial, transverse: moments of inertia about the centre of gravity [kg m2].
    radius: outer radius [m], 0 for none.
    friction: friction coefficient of the item [-], None: the hole's.
    touching: (distance from the node down to the part that touches the wall, its length) [m]; None: the item.  Of length 0: a bit, which
        touches at one point.
    guided: friction of the wall does not push it round the hole.
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
    touching: tuple[float, float] | None = None
    guided: bool = False

    @property
    def contact_above(self) -> float:
        """Distance from the node down to the part that touches the wall [m]."""
        return self.above if self.touching is None else self.touching[0]

    @property
    def contact_length(self) -> float:
        """Length of the part that touches the wall [m]."""
        return self.length if self.touching is None else self.touching[1]

    @property
    def middle(self) -> float:
        """Distance from the node down to the middle of the item or of its blades [m], at which its forces are reported."""
        if not self.contact_length:
            return self.above + 0.5 * self.length
        return self.contact_above + 0.5 * self.contact_length

    @property
    def contact_span(self) -> float:
        """Length over which the wall pushes [m]; at one point it pushes as stiffly as along the item, or along its diameter."""
        return self.contact_length or self.length or 2 * self.radius

    @property
    def end_radii(self) -> tuple[float, float]:
        """Radii that touch the wall at the item's upper and lower end [m], 0 if nothing does."""
        if not self.contact_length:
            return self.radius, self.radius
        first, last = self.contact_above, self.contact_above + self.contact_length
        at_upper, at_lower = first - self.above < END_OF_ITEM, self.above + self.length - last < END_OF_ITEM
        return self.radius if at_upper else 0.0, self.radius if at_lower else 0.0


@dataclass(frozen=True)
class JarLaw:
    """Latch of a jar (manual: sec-jar).

    threshold: force that the latch holds [N]; metering: travel [m] over which the jar meters at resistance [N s/m]; 0: at once.
    latch: its stiffness [N/m]; up, down: directions in which it fires; item: number of the string item.
    """

    threshold: float
    metering: float
    resistance: float
    latch: float
    up: bool
    down: bool
    item: int


@dataclass(frozen=True)
class StringJoint:
    """A joint: a cell without length between two nodes at the same position.

    depth: measured depth [m].
    kind: word of the case file, or torsion_slider; cell: number of the joint's cell from the top.
    axes: (3, 3) orthonormal rows, the joint's axes in (tangent, director 2, director 3).
    stabilised: velocity constraints are added (manual: eq-joint-ggl).
    spring [N/m], damping [N s/m]: along a slider (manual: eq-joint-slider).
    stroke: least and largest travel of a slider between its stops [m].
    stop_stiffness: stiffness of the stops [N/m].
    seal_area: area on which the mud pushes the parts of a slider apart [m2] (manual: eq-joint-seal-force).
    preload: force by which the spring of a slider pushes its parts apart at zero travel [N].
    stop_rounding: length over which the force of a stop sets in [m], None: as for all joints; jar: its latch.
    torsion_spring: stiffness of a torsion_slider, whose parts turn about its axis [N m/rad].
    item: number of the string item whose tool has the joint, -1: a joint by itself.
    driven: a motor turns the part below.
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
    seal_area: float = 0.0
    preload: float = 0.0
    torsion_spring: float = 0.0
    stop_rounding: float | None = None
    jar: JarLaw | None = None
    item: int = -1
    driven: bool = False


@dataclass(frozen=True)
class BentCell:
    """A stress-free curvature of one element.

    cell: number of the element from the top; node: at which the tool face is measured.
    size: of the curvature [1/m]; tool_face: direction in which the element bends downward [rad].
    """

    cell: int
    node: int
    size: float
    tool_face: float


@dataclass(frozen=True)
class StringMesh:
    """Elements from the top down; arrays are (n,) unless a line below gives another shape.

    upper, lower: measured depth of the element's ends [m].
    node_depth: (n+1,) measured depth of the nodes [m]; with a rigid item at a node, the depth of the item's
    upper end. axial_stiffness EA [N], bending_stiffness EI [N m2], torsional_stiffness GJ [N m2].
    mass per length [kg/m], polar_inertia: polar mass moment per length [kg m].
    outer_diameter, inner_diameter [m].
    stiffness_damping [s], mass_damping [1/s]: Rayleigh coefficients.
    rigid_above: length of the rigid items between the upper node and the element [m].
    eccentricity: (n, 2) offset of the centre of mass along the directors [m].
    curvature: (n, 2) stress-free curvature, an axial vector along the directors [1/m].
    item: index of the string item in the case.
    friction: friction coefficient [-], nan: the hole's.
    bodies: rigid items; bent: stress-free curvatures by tool face, from which ``curvature`` follows.
    junction: (n+1,) nodes with a stretch ratio (manual: eq-junction-kinematics).
    joints: the joints, whose cells have no length and no element.
    limited: figures of automatic elements that are longer than the physics requires (``ElementLengths.limited``).
    contact_diameter: that touches the wall, of tool joints where there are any [m].
    clearance_diameter: from which the clearance of buckling loads is measured [m].
    outer_area: for buoyancy and end forces [m2]; bore_area: of the mud inside [m2].
    tube_outer_area, tube_bore_area: of the tube between tool joints, whose wall is reported on [m2].
    joint_length [m], worn_diameter: outer diameter of the worn tube [m], yield_strength [Pa]; nan if unknown.
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
    eccentricity: FloatArray
    curvature: FloatArray
    item: np.ndarray
    friction: FloatArray
    contact_diameter: FloatArray
    clearance_diameter: FloatArray
    outer_area: FloatArray
    bore_area: FloatArray
    tube_outer_area: FloatArray
    tube_bore_area: FloatArray
    joint_length: FloatArray
    worn_diameter: FloatArray
    yield_strength: FloatArray
    bodies: tuple[RigidItem, ...] = ()
    bent: tuple[BentCell, ...] = ()
    junction: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    joints: tuple[StringJoint, ...] = ()
    limited: tuple[dict[str, Any], ...] = ()

    @property
    def length(self) -> FloatArray:
        """(n,) element lengths [m]."""
        return self.lower - self.upper

    @property
    def motor_cell(self) -> int | None:
        """Cell of the joint below which a downhole motor turns the string; None without a motor."""
        return next((j.cell for j in self.joints if j.driven), None)

    @property
    def is_joint(self) -> np.ndarray:
        """(n,) mask of the cells that are joints, not elements."""
        mask = np.zeros(len(self.upper), dtype=bool)
        mask[[j.cell for j in self.joints]] = True
        return mask

    @property
    def below_junction(self) -> np.ndarray:
        """(n,) mask of the elements with the kinematics of eq-junction-kinematics: below a junction, and below a rigid
        item at the top (stretch ratio 1)."""
        ratio = self.junction[:-1] if len(self.junction) else np.zeros(len(self.upper), dtype=bool)
        return ratio | ((self.rigid_above > 0) & ~self.is_joint)

    @property
    def length_divisor(self) -> FloatArray:
        """(n,) divisors for values per length: element lengths [m], 1 for joints, whose values are zero."""
        return np.where(self.is_joint, 1.0, self.length) if self.joints else self.length

    def slope_at_nodes(self, values: FloatArray) -> FloatArray:
        """Slope (n_nodes,) along the string of ``values`` (n_nodes,), in their unit per metre: the mean of both elements."""
        slope = np.diff(values) / self.length_divisor
        element = ~self.is_joint
        total, count = np.zeros(self.nodes), np.zeros(self.nodes)
        for first in (0, 1):
            np.add.at(total, np.flatnonzero(element) + first, slope[element])
            np.add.at(count, np.flatnonzero(element) + first, 1.0)
        return total / np.maximum(count, 1.0)

    @property
    def free_slope_nodes(self) -> np.ndarray:
        """Nodes beside a joint whose slope length is undetermined (manual: eq-joint-unit-slope).

        No element constrains it: the node has only rigid items, or a stretch ratio replaces the slope length.
        """
        # entries i and i + 1 are the cells above and below node i
        joint = np.concatenate([[False], self.is_joint, [False]])
        element = np.concatenate([[False], ~self.is_joint, [False]])
        ratio = self.junction if len(self.junction) else np.zeros(self.nodes, dtype=bool)
        constrained = element[:-1] | (element[1:] & ~ratio)
        return np.flatnonzero((joint[:-1] | joint[1:]) & ~constrained)

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.node_depth)

    def place_of(self, depth: float) -> tuple[int, float]:
        """The element at a measured depth [m], and the part of it above; in a rigid item above a joint the end beside it."""
        cell = int(np.clip(np.searchsorted(self.lower, depth), 0, len(self.lower) - 1))
        if self.is_joint[cell]:
            return (cell - 1, 1.0) if cell else (1, 0.0)
        return cell, float(np.clip((depth - self.upper[cell]) / self.length[cell], 0.0, 1.0))

    def nearest_node(self, depth: float) -> int:
        """Number of the node nearest to a measured depth [m]."""
        return int(np.argmin(np.abs(self.node_depth - depth)))

    @property
    def total_length(self) -> float:
        """Measured depth of the string's lower end [m], rigid items included."""
        last = max((b.above + b.length for b in self.bodies if b.node == self.nodes - 1), default=0.0)
        return float(self.node_depth[-1] + last)


def plain_sizes(outer: Any, inner: Any) -> dict[str, Any]:
    """Sizes of plain tubes by the names of ``StringMesh``, of their outer and inner diameters [m]: numbers or (n,)."""
    unknown = np.nan * outer
    sizes = {
        "outer_diameter": outer,
        "inner_diameter": inner,
        "contact_diameter": outer,
        "clearance_diameter": outer,
        "outer_area": np.pi * (0.5 * outer * (0.5 * outer)),
        "bore_area": np.pi * (0.5 * inner * (0.5 * inner)),
        "joint_length": unknown,
        "worn_diameter": outer,
        "yield_strength": unknown,
    }
    return sizes | {f"tube_{key}": sizes[key] for key in ("outer_area", "bore_area")}


def tube(outer: float, inner: float, young: float, poisson: float, density: float) -> dict[str, float]:
    """Compute stiffness and mass per length of a round tube (manual: eq-beam-tube).

    outer, inner: diameters [m].
    young: Young's modulus [Pa]; poisson: Poisson's ratio [-]; density [kg/m3].
    Returns EA [N], EI and GJ [N m2], mass [kg/m], polar mass moment [kg m].
    """
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
