"""Base of the components of the drilling fluid: constants of the fluid, fields, element blocks, results.

Manual: sec-mud-unknowns, sec-mud-mass, sec-mud-momentum.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Field
from drillpetsc.kernels import function, pointer
from drillpetsc.physics.beam import SLOTS, SPLIT_SLOTS

FIGURES = (
    "kinetic",
    "stored",
    "potential",
    "dissipated",
    "content",
    "storage_upper",
    "storage_lower",
    "speed",
    "density",
)
PRESSURE_SCALE, FLOW_SCALE = 1.0e7, 1.0e-2  # usual magnitudes [Pa], [m3/s]


class _Fluid(ctypes.Structure):
    """Fluid of kernels/fluid/flow.hpp."""

    _fields_ = [
        ("density", ctypes.c_double),
        ("compressibility", ctypes.c_double),
        ("gravity", ctypes.c_double * 3),
        ("clinging", ctypes.c_double),
        ("rheology", ctypes.c_void_p),
    ]


@dataclass
class FluidConstants:
    """Constants of the fluid (manual: eq-mud-density).

    density: at zero gauge pressure [kg/m3]; bulk_modulus: [Pa]; gravity: (3,) [m/s2].
    rheology: parameters in the layout of kernels/fluid/rheology.hpp.
    clinging: clinging factor [-] (manual: eq-mud-clinging).

    ``address`` is the kernels' argument; the object must live as long as the blocks that use it.
    """

    density: float
    bulk_modulus: float
    gravity: FloatArray
    rheology: FloatArray
    clinging: float = 0.45

    def __post_init__(self) -> None:
        self.rheology = np.ascontiguousarray(self.rheology, dtype=float)
        record = _Fluid(
            self.density,
            1.0 / self.bulk_modulus,
            (ctypes.c_double * 3)(*self.gravity),
            self.clinging,
            pointer(self.rheology),
        )
        self._record = record
        self.address = ctypes.addressof(record)

    def enthalpy(self, pressure: FloatArray | float) -> FloatArray | float:
        """Compute the flow work of a pressure [Pa] per volume at zero pressure [J/m3].

        Manual: sec-mud-energy.

        It is int dp rho0/rho = K (1 - exp(-p/K)).
        """
        return -self.bulk_modulus * np.expm1(-np.asarray(pressure) / self.bulk_modulus)


class ChannelFlow(Component):
    """Elements of one channel; the subclass defines its name, kernel and parameters.

    mesh: of the string; fluid: constants; held: the string is held, so the kernel has none of its unknowns.
    """

    name = ""
    spins: tuple[int, ...] = ()  # ends whose spin the kernel uses

    def __init__(self, mesh, fluid: FluidConstants, held: bool = False):
        self.mesh, self.fluid, self.held = mesh, fluid, held
        self._blocks: list[ElementBlock] = []
        self._taken: FloatArray | None = None

    def fields(self) -> tuple[Field, ...]:
        return (
            Field(f"{self.name}.pressure", 1, physics="fluid", scale=PRESSURE_SCALE, second_order=False),
            Field(
                f"{self.name}.flow",
                1,
                physics="fluid",
                region="below_top",
                scale=FLOW_SCALE,
                second_order=False,
            ),
        )

    def own_slots(self) -> tuple[tuple[str, int], ...]:
        """Slots of the channel's own unknowns, in the order of the kernel."""
        return (f"{self.name}.pressure", 0), (f"{self.name}.pressure", 1), (f"{self.name}.flow", 1)

    @property
    def kernel(self) -> str:
        """Common first part of the kernels' names."""
        return f"{self.name}_flow"

    def parameters(self, e: np.ndarray) -> FloatArray:
        """(k, parameters) of the elements ``e`` (numbers from the top), in the order of the kernel."""
        raise NotImplementedError

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        """Blocks of the local cells: below a junction or not.

        Those of a held string have none of its unknowns.
        """
        m, own = self.mesh, self.own_slots()
        junction = m.junction if len(m.junction) else np.zeros(m.nodes, dtype=bool)
        self._part, self._blocks, self._reports = part, [], []
        split = junction[part.cells] if not self.held else np.zeros(len(part.cells), dtype=bool)
        for kind in (False, True):
            if kind and (self.held or not junction[:-1].any()):
                continue
            chosen = np.flatnonzero(split == kind).astype(np.int32)
            kernel = self.kernel + ("_held" if self.held else "_split" if kind else "")
            slots = own if self.held else (SPLIT_SLOTS if kind else SLOTS) + own
            spins = () if self.held else self.spins
            block = ElementBlock(
                f"{self.name}_flow" + ("_junction" if kind else ""),
                kernel,
                "cell",
                chosen,
                slots,
                spins,
                np.ascontiguousarray(self.parameters(part.cells[chosen])),
                context=self.fluid.address,
            )
            block.keep = (self.fluid,)
            self._blocks.append(block)
            self._reports.append(function(f"{kernel}_report", "ipppppp"))
        top = [(b, i) for b in self._blocks for i in np.flatnonzero(part.cells[b.points] == 0)]
        self._top = top[0] if top else None  # block and row of the uppermost element, where this rank has it
        for b in self._blocks:
            b.update = self._update_of(b)
        return tuple(self._blocks)

    def _update_of(self, block: ElementBlock):
        """Return the function of time that updates the block's parameters, or None."""
        return None

    @contextmanager
    def taken(self, state) -> Iterator[None]:
        """Context in which ``figures`` returns the results of the present state, which are computed once."""
        self._taken = self.figures(state)
        try:
            yield
        finally:
            self._taken = None

    def figures(self, state) -> FloatArray:
        """Compute (nc, 9) for the local elements: the columns of ``FIGURES``.

        Energies [J], dissipated power [W], content and storage as volume at zero pressure [m3, m3/s], speed
        [m/s], density [kg/m3].
        """
        if self._taken is not None:
            return self._taken
        out = np.zeros((len(self._part.cells), len(FIGURES)))
        for b, report in zip(self._blocks, self._reports, strict=True):
            if len(b.points):
                index, part = state.index_of(b), np.zeros((len(b.points), len(FIGURES)))
                report(
                    len(b.points),
                    pointer(index),
                    pointer(b.params),
                    b.context,
                    pointer(state.x),
                    pointer(state.y),
                    pointer(part),
                )
                out[b.points] = part
        return out

    def upper_flow(self, state) -> float | None:
        """Compute the flow rate into the channel's upper end from the mass balance [m3/s].

        None on ranks without the end.
        """
        if self._top is None:
            return None
        block, row = self._top
        figures = self.figures(state)[int(block.points[row])]
        return float(figures[FIGURES.index("storage_upper")] + state.x[state.index_of(block)[row, -1]])

    def flows(self, system) -> FloatArray:
        """Return the flow rates (nc,) in the local elements, towards the bit [m3/s]."""
        return system.field(f"{self.name}.flow")[system.chain.ends[:, 1], 0]

    def pressures(self, system) -> FloatArray:
        """Return the pressures (nv,) at the local vertices [Pa]."""
        return system.field(f"{self.name}.pressure")[:, 0]

    def upper_pressure(self, state) -> float:
        """Return the pressure at the channel's upper end [Pa], on the rank with this end."""
        block, row = self._top  # type: ignore[misc]
        return float(state.x[state.index_of(block)[row, -3]])
