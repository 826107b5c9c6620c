"""Base of the components of the drilling fluid: constants of the fluid, fields, element blocks, results.

Manual: sec-mud-unknowns, sec-mud-mass, sec-mud-momentum.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from math import expm1
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.bound_parts import BlockResults
from drillpetsc.fem.component import Component, ElementBlock, Field
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import Table, columns, structure
from drillpetsc.physics.beam import JUNCTION_SLOTS, SLOTS
from drillpetsc.time_function import TimeFunction

RESULT_NAMES = columns("flow_results").names
ENERGIES = columns("flow_results").span("kinetic", "potential")  # in the order of ``Energies``
_DISSIPATED, _LEFT_OUT = RESULT_NAMES.index("dissipated"), RESULT_NAMES.index("left_out")
_STORAGE_UPPER, SPEED = RESULT_NAMES.index("storage_upper"), RESULT_NAMES.index("speed")
_DENSITY = RESULT_NAMES.index("density")
_Fluid = structure("fluid")  # Fluid of kernels/fluid/flow.hpp
PRESSURE_SCALE, FLOW_SCALE = 1.0e7, 1.0e-2  # usual magnitudes [Pa], [m3/s]


@dataclass
class FluidConstants:
    """Constants of the fluid (manual: eq-mud-density).

    density: at zero gauge pressure [kg/m3]; bulk_modulus: [Pa]; gravity: (3,) [m/s2].
    rheology: parameters in the layout of kernels/fluid/rheology.hpp.
    clinging: clinging factor [-] (manual: eq-mud-clinging).
    usual_pressure, usual_flow: typical magnitudes for the tolerances [Pa], [m3/s] (manual: sec-time-error).

    ``address`` is the kernels' argument; the object must live as long as the blocks that use it.
    """

    density: float
    bulk_modulus: float
    gravity: FloatArray
    rheology: FloatArray
    clinging: float = 0.45
    usual_pressure: float = PRESSURE_SCALE
    usual_flow: float = FLOW_SCALE

    def __post_init__(self) -> None:
        self.rheology = np.ascontiguousarray(self.rheology, dtype=float)
        record = _Fluid(
            density=self.density,
            compressibility=1.0 / self.bulk_modulus,
            gravity=tuple(self.gravity),
            clinging=self.clinging,
            rheology=pointer(self.rheology),
        )
        self._record = record
        self.address = ctypes.addressof(record)

    @property
    def constants(self) -> tuple[Any, ...]:
        """The numbers at ``address``."""
        return self.density, self.bulk_modulus, self.gravity, self.clinging, self.rheology

    def enthalpy(self, pressure: FloatArray | float) -> FloatArray | float:
        """Compute the flow work of a pressure [Pa] per volume at zero pressure [J/m3].

        Manual: sec-mud-energy.

        It is int dp rho0/rho = K (1 - exp(-p/K)).
        """
        if isinstance(pressure, float):
            return -self.bulk_modulus * expm1(-pressure / self.bulk_modulus)
        return -self.bulk_modulus * np.expm1(-np.asarray(pressure) / self.bulk_modulus)


def ambient_update(params: Table, ambient: TimeFunction) -> Callable[[float], None]:
    """Function of time that sets the pressure outside the string [Pa] in the parameters of a block."""
    outside = params["ambient"]

    def update(t: float) -> None:
        outside[:] = ambient.value(t)

    return update


class ChannelFlow(Component):
    """Elements of one channel; the subclass gives its name, kernel and parameters.

    poisson: (n,) Poisson's ratio [-], 0 if stretch does not change the section (manual: eq-mud-narrowing).
    held_at: (n+1, 3) positions of the nodes of a held string [m], None for a string that moves.
    """

    name = ""
    spins: tuple[int, ...] = ()  # ends whose spin the kernel uses

    def __init__(self, mesh, fluid: FluidConstants, poisson: FloatArray, held_at: FloatArray | None = None):
        self.mesh, self.fluid, self.poisson = mesh, fluid, poisson
        self.held_at, self.held = held_at, held_at is not None
        self._blocks: list[ElementBlock] = []
        self._places: tuple[Any, np.ndarray] | None = None  # of the pressures in a layout's unknowns

    def fields(self) -> tuple[Field, ...]:
        return (
            Field(
                f"{self.name}.pressure",
                1,
                physics="fluid",
                scale=self.fluid.usual_pressure,
                second_order=False,
            ),
            Field(
                f"{self.name}.flow",
                1,
                physics="fluid",
                region="below_top",
                scale=self.fluid.usual_flow,
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

    def parameters(self, e: np.ndarray) -> Table:
        """Parameters of the elements ``e`` (k,) (numbers from the top)."""
        raise NotImplementedError

    def _along(self, e: np.ndarray) -> dict[str, FloatArray]:
        """Parameters of the elements ``e`` (k,) along the string: lengths, weight of the mud, narrowing."""
        length, rigid, zero = self.mesh.length[e], self.mesh.rigid_above[e], np.zeros(len(e))
        poisson = self.poisson[e]
        if self.held_at is None:
            return {"length": length, "rigid": rigid, "poisson": poisson, "drop": zero, "head": zero}
        upper, lower = (self.held_at[e + end] @ self.fluid.gravity for end in (0, 1))
        drop, head = lower - upper, 0.5 * (lower + upper)
        return {"length": length + rigid, "rigid": zero, "poisson": poisson, "drop": drop, "head": head}

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        """Blocks of the local cells: below a junction or not, and across joints.

        Blocks of a held string contain no unknowns of the string.
        """
        m, own = self.mesh, self.own_slots()
        junction, joint = m.below_junction, m.is_joint
        self._part, self._blocks = part, []
        kinds = np.where(joint, "_joint", np.where(junction, "_junction", ""))[part.cells]
        if self.held:
            kinds[:] = ""
        present = ("", "_junction" if junction.any() else None, "_joint" if joint.any() else None)
        for kind in present[:1] if self.held else (k for k in present if k is not None):
            chosen = np.flatnonzero(kinds == kind).astype(np.int32)
            kernel = self.kernel + ("_held" if self.held else kind)
            slots = own if self.held else (JUNCTION_SLOTS if kind == "_junction" else SLOTS) + own
            spins = () if self.held else self.spins
            block = ElementBlock(
                f"{self.name}_flow{kind}",
                kernel,
                "cell",
                chosen,
                slots,
                spins,
                self.parameters(part.cells[chosen]).array,
                context=self.fluid.address,
                constants=self.fluid.constants,
            )
            block.keep = (self.fluid,)
            self._blocks.append(block)
        top = [(b, i) for b in self._blocks for i in np.flatnonzero(part.cells[b.points] == 0)]
        self._top = top[0] if top else None  # block and row of the uppermost element, if this rank has it
        for b in self._blocks:
            b.update = self._update_of(b)
        return tuple(self._blocks)

    def _update_of(self, block: ElementBlock):
        """Return the function of time that updates the block's parameters, or None."""
        return None

    def element_results(self, state) -> FloatArray:
        """(nc, 10) per local element: the columns of ``RESULT_NAMES`` (content: volume at zero pressure [m3]).

        Do not change or keep the array: the next evaluation overwrites it.
        """
        parts = [self._block_results(b, state).table for b in self._blocks]
        if len(parts) == 1:  # all elements, in depth order
            return parts[0]
        out = np.zeros((len(self._part.cells), len(RESULT_NAMES)))
        for b, part in zip(self._blocks, parts, strict=True):
            out[b.points] = part
        return out

    def _block_results(self, block: ElementBlock, state) -> BlockResults:
        return state.results(block, block.results_kernel, len(RESULT_NAMES))

    def parameter(self, name: str) -> FloatArray:
        """Present values (nc, ...) of a parameter of the local elements, as the kernels' header names it."""
        out = np.zeros((len(self._part.cells), *self._blocks[0].named[name].shape[1:]))
        for b in self._blocks:
            out[b.points] = b.named[name]
        return out

    def velocity_power(self, above: np.ndarray, below: np.ndarray, state) -> float:
        """Sum of q rho0 w^2/2 over cells ``above``, less the sum over cells ``below`` with their flow in the section above them.

        The rows of the cells below contain the velocity head of the section step above them (manual:
        eq-mud-momentum).
        """
        total = 0.0
        for b in self._blocks:
            results, q = self._block_results(b, state).table, state.x[state.index_of(b)[:, -1]]
            for cells, sign in ((above, 1.0), (below, -1.0)):
                rows = np.flatnonzero(np.isin(b.points, cells))
                if not len(rows):
                    continue
                speed = results[rows, SPEED]
                square = (speed + self._string_speed(b, rows, state)) ** 2
                if sign < 0:
                    thin = self.fluid.density / results[rows, _DENSITY]
                    square -= 2 * b.named["step"][rows] * (q[rows] * thin) ** 2
                total += sign * 0.5 * self.fluid.density * float(q[rows] @ square)
        return total

    def _string_speed(self, block: ElementBlock, rows: np.ndarray, state) -> FloatArray:
        """(k,) speed of the string to be added to the mud's speed in the ``rows`` (k,) of a block [m/s]: zero in the bore."""
        return np.zeros(len(rows))

    def sums_of(self, steps) -> FloatArray:
        """(k, 10) sums of ``element_results`` over the local elements after each of k steps."""
        first, *others = (steps.sums(b, b.results_kernel, len(RESULT_NAMES)) for b in self._blocks)
        return np.asarray(sum(others, first))

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        return tuple(self.sums_of(steps)[:, ENERGIES].T)

    def _channel_powers_of(self, steps, at_end: Any) -> tuple[Any, Any]:
        """Powers of the channel [W], with the power ``at_end`` supplied at its upper end."""
        total = self.sums_of(steps)
        return total[:, _DISSIPATED], at_end + total[:, _LEFT_OUT]

    @property
    def _upper_element(self) -> tuple[ElementBlock, int]:
        """Block and row of the uppermost element, on the rank that has it."""
        assert self._top is not None
        return self._top

    def _top_result_of(self, steps, column: int) -> FloatArray:
        """(k,) result of the uppermost element after each of k recorded steps, on the rank with this end."""
        block, row = self._upper_element
        table = steps.results(block, block.results_kernel, len(RESULT_NAMES)).table
        return np.asarray(steps.numbers(table, row * len(RESULT_NAMES) + column))

    def _top_unknown_of(self, steps, slot: int) -> FloatArray:
        """(k,) unknown of the uppermost element, counted from the last."""
        block, row = self._upper_element
        return np.asarray(steps.unknowns(steps.assembly.index_of(block).item(row, slot)))

    def _upper_motion_of(self, steps) -> tuple[FloatArray, FloatArray]:
        """Place [m] and velocity [m/s] of the upper node, (k, 3) each, on the rank that has it."""
        if self.held_at is not None:
            return self.held_at[:1], np.zeros((1, 3))
        place = steps.assembly.layout.dofs["string.position"][0]
        return steps.unknowns(place), steps.rates(place)

    def upper_pressure_of(self, steps) -> FloatArray:
        """(k,) pressure at the channel's upper end [Pa], on the rank with this end."""
        return self._top_unknown_of(steps, -3)

    def upper_flow_of(self, steps) -> FloatArray | None:
        """(k,) flow rate into the channel's upper end from the mass balance [m3/s]; None on ranks without the end."""
        if self._top is None:
            return None
        return self._top_result_of(steps, _STORAGE_UPPER) + self._top_unknown_of(steps, -1)

    def flows(self, system) -> FloatArray:
        """Return the flow rates (nc,) in the local elements, towards the bit [m3/s]."""
        return system.field(f"{self.name}.flow")[system.chain.ends[:, 1], 0]

    def pressures(self, system) -> FloatArray:
        """Return the pressures (nv,) at the local vertices [Pa]."""
        return np.asarray(system.assembly.x.take(self._pressure_places(system)))

    def pressure_at_of(self, steps, vertex: int) -> FloatArray:
        """(k,) pressure at one local vertex [Pa]."""
        return np.asarray(steps.unknowns(steps.assembly.layout.dofs[f"{self.name}.pressure"].item(vertex, 0)))

    def pressure_places(self, system) -> np.ndarray | None:
        """(nv,) places of the pressures at the local vertices in the unknowns; None if they are computed from others."""
        return self._pressure_places(system)

    def _pressure_places(self, system) -> np.ndarray:
        if self._places is None or self._places[0] is not system.layout:
            dofs = system.layout.dofs[f"{self.name}.pressure"][:, 0]  # there is one at every node
            self._places = system.layout, np.ascontiguousarray(dofs)
        return self._places[1]

    def lateral_sizes(self) -> FloatArray:
        """(nc, 2) outer diameter of the string and diameter of the hole [m] of the local elements; (0, 2) in a bore."""
        return np.zeros((0, 2))

    def set_lateral(self, added: FloatArray, damping: FloatArray) -> None:
        """Replace the coefficients of motion across the hole, of the local elements.

        added: (nc,) added over displaced mass [-]; damping: (nc,) [N s/m2].
        """
