"""Geometry of the fluid channels, element by element: bore of the string and annulus.

A rigid item between two elements belongs to the channel of the element below it. Its metal volume, mass over
density, reduces the space in hole and bore, independent of the shape of its blades.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import Well

SHORTEST = 1e-3  # a joint without a rigid arm has no more length than this [m]
_GAUSS = np.polynomial.legendre.leggauss(4)  # exact to degree 7


@dataclass(frozen=True)
class Bore:
    """Bore of the string, all arrays (n,).

    area: [m2]; wall: compliance d(ln area)/dp [1/Pa] (manual: eq-mud-wall-bore).
    area_above: of the rigid item above the element [m2].
    body: of the tube between tool joints [m2], for friction; None: ``area``.
    joint_share: fraction of the length with tool joints [-], joint_area: of their bore [m2]; None: no tool joints.
    tool: loss over density and flow rate squared, of tools in the string [1/m4]; None: no tools.
    """

    area: FloatArray
    wall: FloatArray
    area_above: FloatArray
    body: FloatArray | None = None
    joint_share: FloatArray | None = None
    joint_area: FloatArray | None = None
    tool: FloatArray | None = None

    def friction(self, e: np.ndarray) -> dict[str, FloatArray]:
        """Parameters of the friction in the elements ``e`` (k,): tube and tool joints in series."""
        tube = self.area if self.body is None else self.body
        none = np.zeros(len(tube))
        share = none if self.joint_share is None else self.joint_share
        joint = tube if self.joint_area is None else self.joint_area
        return {
            "diameter": self.diameter[e],
            "joint_share": share[e],
            "joint_diameter": np.sqrt(4 / np.pi * joint)[e],
            # kernels work on several elements at once: elements without tool joints have the speed in their area
            "tube_speed": np.where(share > 0, self.area / tube, 1.0)[e],
            "joint_speed": np.where(share > 0, self.area / joint, 1.0)[e],
        }

    @property
    def diameter(self) -> FloatArray:
        """Diameter for friction [m]: the diameter of the tube."""
        return np.sqrt(4 / np.pi * (self.area if self.body is None else self.body))

    @property
    def diameter_above(self) -> FloatArray:
        return np.sqrt(4 / np.pi * self.area_above)


@dataclass(frozen=True)
class Annulus:
    """Space between string and hole, all arrays (n,).

    outer, hole: areas of string and hole [m2].
    wall: compliance d(ln area)/dp [1/Pa] (manual: eq-mud-wall-annulus).
    outer_above: area of the rigid item above the element [m2].
    body: area of the tube between tool joints [m2], for friction; None: ``outer``.
    joint_share: fraction of the length with tool joints [-], joint_area: their area [m2]; None: no tool joints.
    hole_above: area of the hole around the rigid item [m2]; None: the same as at the element.
    """

    outer: FloatArray
    hole: FloatArray
    wall: FloatArray
    outer_above: FloatArray
    body: FloatArray | None = None
    joint_share: FloatArray | None = None
    joint_area: FloatArray | None = None
    hole_above: FloatArray | None = None

    @property
    def hole_around(self) -> FloatArray:
        """Area of the hole around the rigid item above the element [m2]."""
        return self.hole if self.hole_above is None else self.hole_above

    @property
    def outer_diameter(self) -> FloatArray:
        """Diameter of a cylinder with the string's mean section, for added mass and drag across the axis [m]."""
        return np.sqrt(4 / np.pi * self.outer)

    @property
    def hole_diameter(self) -> FloatArray:
        return np.sqrt(4 / np.pi * self.hole)

    @property
    def gap(self) -> FloatArray:
        """Hydraulic diameter D_w - D_o [m], beside the tube between tool joints."""
        return self.hole_diameter - np.sqrt(4 / np.pi * (self.outer if self.body is None else self.body))

    @property
    def gap_above(self) -> FloatArray:
        return np.sqrt(4 / np.pi * self.hole_around) - np.sqrt(4 / np.pi * self.outer_above)

    def friction(self) -> dict[str, FloatArray]:
        """Parameters (n,) of the friction past tube and tool joints in series (manual: sec-tubulars)."""
        tube, count = self.outer if self.body is None else self.body, len(self.outer)
        if self.joint_share is None or self.joint_area is None:
            none, same = np.zeros(count), np.ones(count)
            return {
                "joint_share": none,
                "joint_gap": self.gap,
                "tube_speed": same,
                "joint_speed": same,
                "tube_pull": same,
                "joint_pull": none,
            }
        share = self.joint_share
        joint = np.where(share > 0, self.joint_area, tube)
        hole, tube_d, joint_d = self.hole_diameter, np.sqrt(4 / np.pi * tube), np.sqrt(4 / np.pi * joint)
        open_area, shoulder = self.hole - self.outer, 4 / np.pi * share * (1 - share) * (joint - tube)
        # kernels work on several elements at once: elements without tool joints have the speed in their area
        return {
            "joint_share": share,
            "joint_gap": hole - joint_d,
            "tube_speed": np.where(share > 0, open_area / (self.hole - tube), 1.0),
            "joint_speed": np.where(share > 0, open_area / (self.hole - joint), 1.0),
            "tube_pull": np.where(
                share > 0,
                ((1 - share) * tube_d - shoulder / (hole - tube_d)) / self.outer_diameter,
                1.0,
            ),
            "joint_pull": (share * joint_d + shoulder / (hole - joint_d)) / self.outer_diameter,
        }

    def shoulders(
        self,
        arm: np.ndarray,
        joint: np.ndarray,
        above: Annulus,
        arm_above: np.ndarray,
        joint_above: np.ndarray,
    ) -> FloatArray:
        """Lift by shoulders of the string at the upper end of elements, over rho q^2 (n,) [1/m2].

        Between sections A and B of the flow, the pressure on a shoulder is rho q^2/(2 A B) lower than
        in mud at rest; pressures at the nodes refer to the section of the element above (manual:
        eq-mud-shoulder).

        arm, joint: (n,) whether a rigid item lies above the element, whether it is a joint of the string.
        above: annulus of the elements above, with the same data.
        """
        upper_string = np.where(arm_above & joint_above, above.outer_above, above.outer)
        upper_hole = np.where(arm_above & joint_above, above.hole_around, above.hole)
        string = np.where(arm, self.outer_above, self.outer)
        hole = np.where(arm, self.hole_around, self.hole)
        known = 1 / (above.hole - above.outer) ** 2
        first = (string - upper_string) * (1 / ((hole - string) * (upper_hole - upper_string)) - known)
        second = (self.outer - string) * (1 / ((hole - string) * (self.hole - self.outer)) - known)
        return 0.5 * (first + np.where(joint, 0.0, second))

    def only(self, which: np.ndarray) -> Annulus:
        """Return the annulus of the elements ``which`` (mask or numbers)."""
        return Annulus(
            *(
                None if value is None else value[which]
                for value in (getattr(self, f.name) for f in fields(self))
            )  # type: ignore[arg-type]
        )


class HoleVolume:
    """Exact volume of a well's hole from measured depth 0 downwards (manual: sec-borehole-volume).

    Between the ends of transitions the radius squared is a polynomial of degree 6.
    """

    def __init__(self, well: Well):
        rows = well.transitions
        self.well, self._at = well, np.unique(np.concatenate([[0.0], rows[:, 0], rows[:, 0] + rows[:, 1]]))
        self._at = self._at[self._at >= 0]
        self._below = np.concatenate([[0.0], np.cumsum(self._piece(self._at[:-1], self._at[1:]))])

    def moment(self, upper: FloatArray, lower: FloatArray) -> FloatArray:
        """Compute the first moment (k,) [m4] of the hole between measured depths (k,) [m] about their middle, along the hole."""
        ends = np.sort(np.concatenate([self._at, upper, lower]))
        middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
        points = middle[:, None] + half[:, None] * _GAUSS[0]
        # W grows by a polynomial of degree 7 between the ends of transitions
        whole = np.concatenate([[0.0], np.cumsum(half * (self.volume(points) @ _GAUSS[1]))])
        between = whole[np.searchsorted(ends, lower)] - whole[np.searchsorted(ends, upper)]
        return 0.5 * (self.volume(upper) + self.volume(lower)) * (lower - upper) - between

    def _piece(self, upper: FloatArray, lower: FloatArray) -> FloatArray:
        middle, half = 0.5 * (upper + lower), 0.5 * (lower - upper)
        return half * (self.area(middle[..., None] + half[..., None] * _GAUSS[0]) @ _GAUSS[1])

    def area(self, md: FloatArray | float) -> FloatArray:
        """Compute the area (...) [m2] at md (...) [m].

        Beyond the ends of the hole the nearest section is used.
        """
        return np.pi * np.asarray(self.well.radius(md)) ** 2

    def volume(self, md: FloatArray) -> FloatArray:
        """Compute the volume (...) [m3] between measured depth 0 and md (...) [m]."""
        at = self._at[i := np.maximum(np.searchsorted(self._at, md, side="right") - 1, 0)]
        return self._below[i] + self._piece(at, np.asarray(md, dtype=float))


@dataclass(frozen=True)
class AnnulusWalls:
    """Walls of the annulus: string and rock.

    outer, inner: (n,) radii of the elements [m]; young: (n,) [Pa]; poisson: (n,) [-].
    outer_above: (n,) mean section of the rigid items above the element [m2]; rigid_above: (n,) their length
    [m].
    section_to: (m,) lower end of each hole section [m]; give: (m,) compliance of its rock, (1 + nu)/E [1/Pa].
    elastic: the walls are elastic, otherwise rigid.
    section: (n,) mean outer area of the elements with tool joints [m2]; None: from ``outer``.
    joint_share: (n,) fraction of the length with tool joints [-], joint_area: (n,) their area [m2]; None: no tool joints.
    body: (n,) area beside which the mud flows, between tool joints [m2]; None: from ``outer``.
    """

    outer: FloatArray
    inner: FloatArray
    young: FloatArray
    poisson: FloatArray
    outer_above: FloatArray
    rigid_above: FloatArray
    section_to: FloatArray
    give: FloatArray
    elastic: bool
    section: FloatArray | None = None
    joint_share: FloatArray | None = None
    joint_area: FloatArray | None = None
    body: FloatArray | None = None

    def annulus(self, hole: HoleVolume, e: np.ndarray, upper: FloatArray, lower: FloatArray) -> Annulus:
        """Create the annulus of the elements ``e`` (k,) between measured depths ``upper`` and ``lower`` (k,) [m].

        Compliance (Lame; manual: eq-mud-wall-annulus): 2/(Rw^2 - Ro^2) {Rw^2 (1 + nu_r)/E_r + (Ro^2/E) [2 (1 - nu^2)
        Ro^2/(Ro^2 - Ri^2) - 1 - nu]}.  The first term is for infinite rock; it is left out if a section
        has no compliance (a rigid wall).
        """
        top, outer, inner, wall = (
            upper - self.rigid_above[e],
            self.outer[e] ** 2,
            self.inner[e] ** 2,
            np.zeros(len(e)),
        )

        def mean(first: FloatArray, last: FloatArray) -> FloatArray:
            long = np.abs(last - first) > SHORTEST
            area = (hole.volume(last) - hole.volume(first)) / np.where(long, last - first, 1.0)
            return np.where(long, area, hole.area(last))

        below = np.abs(lower - upper) > SHORTEST  # a joint below a rigid item has nothing but its arm
        area = mean(np.where(below, upper, top), lower)
        tube = np.pi * outer if self.body is None else self.body[e]
        above = np.where(below & (self.rigid_above[e] > 0), mean(top, upper), area)
        if self.elastic:
            square = area / np.pi
            section = np.minimum(
                np.searchsorted(self.section_to, 0.5 * (upper + lower)), len(self.section_to) - 1
            )
            nu = self.poisson[e]
            steel = outer / self.young[e] * (2 * (1 - nu**2) * outer / (outer - inner) - 1 - nu)
            wall = (
                2
                / (square - (outer if self.body is None else tube / np.pi))
                * (square * self.give[section] + steel)
            )
        section = tube if self.section is None else self.section[e]
        share, joint = (None if q is None else q[e] for q in (self.joint_share, self.joint_area))
        return Annulus(section, area, wall, self.outer_above[e], tube, share, joint, above)
