"""Components of the user: a function builds them from the string and its hole (manual: sec-plug-ins)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.fem.component import Component
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.geometry.well import Well
from drillpetsc.own_code import place_of


@dataclass(frozen=True)
class Site:
    """What a component of the user is built from.

    case: the whole case; mesh: of the string; frames: reference frames of its nodes; well: the hole, None without one.
    position, tangent: (n_nodes, 3) of the unstrained string along the hole [m, -].
    """

    case: Case
    mesh: StringMesh
    frames: Frames
    well: Well | None
    position: FloatArray
    tangent: FloatArray

    @property
    def gravity(self) -> FloatArray:
        """Acceleration (3,) of gravity [m/s2]."""
        return np.array(self.case.gravity, dtype=float)

    def nearest_node(self, depth: float) -> int:
        """Number of the node nearest to a distance from the upper end of the string [m]."""
        return self.mesh.nearest_node(depth)


def own_components(site: Site, taken: Iterable[str]) -> tuple[Component, ...]:
    """Build the components of ``components`` in a case; ``taken``: names of the others.

    Raises CaseError if a function fails, or returns something else than components with names of their own.
    """
    out: list[Component] = []
    names = set(taken)
    for k, given in enumerate(site.case.components):
        at = f"components[{k}].function"
        try:
            built: Any = given.call(site, **given.parameters)
        except CaseError:
            raise
        except Exception as error:  # the user's function may raise anything
            place = place_of(error, given.call)
            got = f"{given.function} stopped with {type(error).__name__}: {error}" + (
                f" ({place})" if place else ""
            )
            raise CaseError(at=at, got=got, want="a function that builds components", longest=600) from error
        found = tuple(built) if isinstance(built, Iterable) else (built,)
        for q in found:
            if not isinstance(q, Component) or not q.name or q.name in names:
                want = "a Component, or several, each with a name that no other has"
                raise CaseError(at=at, got=f"{given.function} returned {q!r}", want=want, longest=300)
            names.add(q.name)
        out += found
    return tuple(out)
