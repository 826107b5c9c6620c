"""What a room offers to the rest: fields (unknowns), blocks (elements that share a kernel), prescribed
components.

No PETSc and no MPI here: rooms are written against these plain descriptions, ``layout`` and ``assembly`` give
them memory.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]


@dataclass(frozen=True)
class Field:
    """Unknowns that a room owns at each vertex of a region of the line.

    ``second_order`` unknowns bring their own rate as a further unknown of the time integrator (position and
    velocity); the others are first-order states or, with ``differential=False``, algebraic; a
    ``multiplier`` is algebraic, and its rows are constraints.  ``scale`` is the usual magnitude [SI]:
    tolerances and error messages are relative to it.  ``at_rest`` is the value that stands in where an
    element refers to the field and it is absent.
    """

    name: str
    size: int
    region: str = "string"
    scale: float = 1.0
    second_order: bool = True
    differential: bool = True
    multiplier: bool = False
    at_rest: float = 0.0


@dataclass
class ElementBlock:
    """All local elements that share one compiled kernel pair (kernels/core/element.hpp).

    cells/vertices: ``points`` are local numbers of the line; ``slots`` lists (field, end) in the kernel's
    order, end 0 the upper vertex, 1 the lower one; ``spins`` the ends whose spin angle the kernel uses, in
    the kernel's order.  ``params``: (n, p) constants.
    ``update(t)`` refreshes time-dependent parameters before an evaluation; ``context`` is an address handed
    to the kernel.  ``room``: what messages call it, the name unless given.
    """

    name: str
    kernel: str
    on: str  # "cell" or "vertex"
    points: IntArray
    slots: tuple[tuple[str, int], ...]
    spins: tuple[int, ...]
    params: FloatArray
    context: int = 0
    update: Callable[[float], None] | None = None
    keep: tuple[object, ...] = field(default=(), repr=False)  # arrays that ``context`` points to
    component: str = ""

    def __post_init__(self) -> None:
        self.component = self.component or self.name


@dataclass(frozen=True)
class PrescribedMotion:
    """Components of one vertex whose motion is given: ``directions @ x = value(t)``.

    directions: (m, 7) orthonormal rows over (r, v, phi) of the vertex; value and rate return (m,).  The rows
    they replace are the
    reactions: ``names`` says what each is.
    """

    vertex: int
    directions: FloatArray
    value: Callable[[float], FloatArray]
    rate: Callable[[float], FloatArray]
    names: tuple[str, ...]


@dataclass(frozen=True)
class VelocityStabilization:
    """Rates that multipliers correct, y += B(x) mu (fem/corrected.py), at the vertices ``points`` (k,),
    ghosts included.

    field: name of mu (m) at these vertices; directions(rows, x): B (k, 7, m) at the places ``rows`` (k, 7) of
    (r, v, phi) in x.
    """

    field: str
    points: IntArray
    directions: Callable[[IntArray, FloatArray], FloatArray]


class Energies(NamedTuple):
    """Stored energies [J] of a room on this rank; strain includes what contacts and springs store."""

    kinetic: float = 0.0
    strain: float = 0.0
    potential: float = 0.0


class Powers(NamedTuple):
    """Power [W] that a room turns into heat, and that it supplies, on this rank."""

    dissipated: float = 0.0
    supplied: float = 0.0


class Component(Protocol):
    """One physics component."""

    name: str

    def fields(self) -> tuple[Field, ...]: ...

    def blocks(self, part) -> tuple[ElementBlock, ...]: ...

    def prescribed(self) -> tuple[PrescribedMotion, ...]: ...

    def energies(self, t: float, state) -> Energies: ...

    def powers(self, t: float, state) -> Powers: ...

    def update_reference_frames(self) -> None: ...

    def breaks(self) -> tuple[float, ...]: ...

    def reaction(self, name: str, state) -> float: ...  # base class
