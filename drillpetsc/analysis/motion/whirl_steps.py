"""Steps that keep the energy of parts that may whirl (manual: sec-time-whirl-steps).

A part of the string of radius R that turns at the rate w and rolls on the wall with the radial clearance c goes round the hole
backward at the rate w R/c (Jansen, 1991). It is the fastest motion that friction feeds.  The formula of a time integrator takes
energy from it in each period. If this is more than ``LOST``, the formula may decide whether the part whirls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np

from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.fem.string_mesh import RigidItem
from drillpetsc.kernels import function, pointer
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.rigid_items import RigidItems
from drillpetsc.physics.contact import Contact

_fastest_on_wall = function("fastest_on_wall", "ippppip")
SLOWEST = 0.1  # rotation [rad/s] below which nothing whirls
#: clearance over radius below which an item fills its hole: the bit does not roll on the wall
SMALLEST_CLEARANCE = 2e-3
LOST = 1e-3  # energy that a formula may take from a whirl in a period, over its energy [-]
LARGEST_PRODUCT = (
    0.3  # of angular frequency and step of generalised-alpha: 21 steps a period, frequency 0.8 % too low
)
#: the same of a turning unbalance, whose orbit is then within 1 % away from resonance: generalised-alpha, BDF of order 2
UNBALANCE_PRODUCT, UNBALANCE_PRODUCT_BDF = 0.2, 0.1


def product_of_alpha(radius: float) -> float:
    """Largest product of angular frequency and step [-] with generalised-alpha of a spectral radius.

    The energy lost in a period is 2 pi ((1 - radius)/(1 + radius))^3 product^3 (manual: eq-time-energy-lost).
    """
    damping = (1 - radius) / (1 + radius)
    # at radius 0.8 the energy alone would allow 0.49; the frequency sets the limit (manual: sec-time-whirl-steps)
    return LARGEST_PRODUCT if damping == 0 else min(LARGEST_PRODUCT, (LOST / (2 * pi)) ** (1 / 3) / damping)


PRODUCT_BDF = (LOST / pi) ** (1 / 3)  # the same for BDF of order 2, which takes pi product^3


def unbalanced(model: DrillingModel) -> bool:
    """Whether mass or shape of the string turn with it."""
    m = model.mesh
    return bool(np.any(m.eccentricity) or np.any(m.curvature) or any(np.any(b.offset) for b in m.bodies))


def _rolling(ratio: float, fastest: float) -> Callable[[float], float]:
    """Rate of a part of radius over clearance ``ratio`` that rolls on the wall, at most ``fastest`` [rad/s]."""
    return lambda spin: min(ratio * spin, fastest)


@dataclass(frozen=True)
class _Part:
    """A rigid item, or elements of one section of pipe, that may roll on the wall.

    name: for the user; cells: (k,) local elements, or body: number of the rigid item; node: local node with its spin, -1 on other
    ranks; rate(spin): at which it whirls [rad/s] at a spin [rad/s]; depth: measured, in the hole [m]; clearance: radial [m].
    """

    name: str
    cells: np.ndarray
    body: int
    node: int
    rate: Callable[[float], float]
    depth: float
    clearance: float


class WhirlSteps:
    """The parts of a string that may whirl, and the steps that keep their energy; all ranks create and call it.

    model: the drilling model, in the state from which the run starts; product: largest product of angular frequency and step [-].
    """

    def __init__(self, model: DrillingModel, product: float) -> None:
        self.model, self.product = model, product
        self._parts: list[_Part] | None = None
        #: (parts,) steps that a part has limited, and the shortest limit [s]
        self._limited: list[int] = []
        self._shortest: list[float] = []
        self._contacts: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None  # see ``_find_contacts``
        self._spins_call: tuple[
            int, ...
        ] = ()  # arguments of the compiled call, whose arrays keep their places
        self._always = np.ones(1)
        self._always_at = pointer(self._always)

    @property
    def parts(self) -> list[_Part]:
        """The parts, at the clearances that they have at the start."""
        if self._parts is None:
            self._parts = [] if self.model.contact is None else self._find(self.model.contact)
            self._limited, self._shortest = [0] * len(self._parts), [np.inf] * len(self._parts)
            self._spins = np.zeros(len(self._parts))  # largest beside the contacts of each part
        return self._parts

    def _find(self, contact: Contact) -> list[_Part]:
        model, mesh, well = self.model, self.model.mesh, contact.well
        chain, out = model.system.chain, []
        local = {int(v): i for i, v in enumerate(chain.vertices) if chain.owned[i]}
        # the initial place of the string in the hole of the case: a restarted run finds the same parts
        place = mesh.node_depth + top_depth(model)
        for k in RigidItems(model).items:
            body = mesh.bodies[k]
            md = float(place[body.node])
            clearance = float(np.asarray(well.radius(md))) - body.radius
            if clearance >= SMALLEST_CLEARANCE * body.radius:
                node = local.get(body.node, -1)
                rolling = _rolling(body.radius / clearance, self._fastest(body))
                out.append(_Part(body.name, np.zeros(0, int), int(k), node, rolling, md, clearance))
            # a bit in gauge does not roll, but its side may drive it round the hole (manual: eq-bit-whirl)
            elif body.kind == "bit" and not body.guided:
                out.append(
                    _Part(
                        body.name,
                        np.zeros(0, int),
                        int(k),
                        local.get(body.node, -1),
                        self._of_bit(body),
                        md,
                        0.0,
                    )
                )
        radius = 0.5 * mesh.contact_diameter
        middle = 0.5 * (place[:-1] + place[1:])
        clearance = np.asarray(well.radius(middle)) - radius
        rolls = (radius > 0) & ~mesh.is_joint & (clearance > SMALLEST_CLEARANCE * radius)
        ratio = np.where(rolls, radius / np.maximum(clearance, 1e-9), 0.0)
        # one part for each item and clearance, however many elements it has
        for key in np.unique(np.column_stack([mesh.item, np.round(ratio, 6)])[rolls], axis=0):
            chosen = np.flatnonzero(rolls & (mesh.item == key[0]) & (np.round(ratio, 6) == key[1]))
            cells = np.flatnonzero(np.isin(chain.cells, chosen))
            k = int(chosen[0])
            name = model.case.string[int(key[0])].name
            out.append(
                _Part(
                    name,
                    cells,
                    -1,
                    -1,
                    _rolling(float(ratio[k]), np.inf),
                    float(middle[chosen].mean()),
                    float(clearance[k]),
                )
            )
        return out

    def _fastest(self, body: RigidItem) -> float:
        """Rate [rad/s] at which a body vibrates on its contact with the wall: no whirl that lasts is faster."""
        contact = self.model.given_contact
        mass = sum(b.mass for b in self.model.mesh.bodies if b.node == body.node)
        return float(np.sqrt(contact.law.stiffness * body.contact_span / mass))

    def _of_bit(self, body: RigidItem) -> Callable[[float], float]:
        """Whirl rate of a bit in gauge whose side may drive it round the hole (manual: eq-bit-whirl)."""
        fastest = self._fastest(body)
        strength = None if self.model.drilling is None else self.model.drilling.side_strength
        if strength is None:
            return lambda spin: fastest if spin > SLOWEST else 0.0
        mass = sum(b.mass for b in self.model.mesh.bodies if b.node == body.node)
        return lambda spin: min(fastest, strength / (mass * spin * body.radius)) if spin > SLOWEST else 0.0

    def _find_contacts(self, parts: list[_Part]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Contacts of the parts on this rank: addresses (k,) of their normal forces, places (k, 2) of the spins beside them in the rates,
        their parts (k,).  The bit in gauge touches always."""
        contact, system = self.model.given_contact, self.model.system
        asm, ends = system.assembly, system.chain.ends
        (of_cells, of_bodies), dofs = contact.normal_forces_at(asm), asm.dofs_of("string.spin")[:, 0]
        at, nodes, of = [], [], []
        for k, part in enumerate(parts):
            for cell in part.cells[of_cells[part.cells] != 0]:
                at.append(of_cells[cell])
                nodes.append(ends[cell])
                of.append(k)
            force = (
                self._always_at if part.clearance == 0.0 else of_bodies[part.body] if part.body >= 0 else 0
            )
            if part.node >= 0 and force:
                at.append(force)
                nodes.append((part.node, part.node))
                of.append(k)
        places = np.ascontiguousarray(dofs[np.reshape(nodes, (-1, 2)).astype(int)], dtype=np.int32)
        return np.array(at, dtype=np.uintp), places, np.array(of, dtype=np.int32)

    def _rates(self) -> list[float]:
        """Whirl rate [rad/s] of each part at present, 0 if it does not turn or touch the wall; the same on all ranks."""
        parts, asm, contact = self.parts, self.model.system.assembly, self.model.contact
        if not parts or contact is None:
            return [0.0] * len(parts)
        # a part off the wall cannot roll, so it does not limit the step (manual: sec-time-choice)
        contact.evaluate(asm)
        if self._contacts is None:
            self._contacts = at, spins, of = self._find_contacts(parts)
            arrays = *map(pointer, (at, spins, asm.y, of)), len(parts), pointer(self._spins)
            self._spins_call = len(at), *arrays
        _fastest_on_wall(*self._spins_call)
        # a part that does not touch has no spin here, and no rate
        out = [
            part.rate(spin) if spin else 0.0 for part, spin in zip(parts, self._spins.tolist(), strict=True)
        ]
        comm = self.model.system.comm
        if comm.size > 1:
            from mpi4py import MPI

            # a part may have elements on several ranks, and all ranks take the same step
            found = np.array(out)
            comm.tompi4py().Allreduce(MPI.IN_PLACE, found, op=MPI.MAX)
            out = found.tolist()
        return [rate if rate > SLOWEST else 0.0 for rate in out]

    def __call__(self, wanted: float) -> float:
        """The ``wanted`` step [s], or the longest that keeps the energy of all parts that turn and touch the wall at present; collective."""
        rates = self._rates()
        fastest = max(rates, default=0.0)
        if wanted * fastest <= self.product:
            return wanted
        k, step = rates.index(fastest), self.product / fastest
        self._limited[k] += 1
        self._shortest[k] = min(self._shortest[k], step)
        return step

    def summary(self, steps: int) -> dict[str, object] | None:
        """Part that limits most of the ``steps`` of a run, for summary.json; None if none does."""
        most = max(self._limited, default=0)
        if not most:
            return None
        k = self._limited.index(most)
        part = self.parts[k]
        return {
            "name": part.name,
            "md [m]": part.depth,
            "share": most / max(1, steps),
            "shortest [s]": self._shortest[k],
        }

    def damped(self, step: float, turned: float) -> dict[str, object] | None:
        """The part whose whirl is the fastest, if steps that this object has not limited take more of its energy; None without one.

        step: median step of the run [s]; turned: largest rotation of the string [rad/s].  Collective.
        Returns the values of the sentence of ``whirl_damped``.
        """
        touched = self._rates()
        lost = [
            (part.rate(turned), part)
            for part, rate in zip(self.parts, touched, strict=True)
            if turned > SLOWEST and part.rate(turned) * step > self.product and (part.body >= 0 or rate > 0.0)
        ]
        if not lost:
            return None
        rate, part = max(lost, key=lambda pair: pair[0])
        return {
            "name": part.name,
            "md": part.depth,
            "frequency": rate / (2 * pi),
            "rpm": 60 * turned / (2 * pi),
            "clearance": part.clearance,
            "lost": 100 * LOST,
            "step": self.product / rate,
        }
