"""Interfaces of the components of the drilling fluid that others use: channels, nozzles, seals, reamed rings."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component


class Channel(Component):
    """Flow of drilling fluid in the bore or in the annulus."""

    @property
    @abstractmethod
    def kernel(self) -> str:
        """First part of the kernels' names."""

    @abstractmethod
    def own_slots(self) -> tuple[tuple[str, int], ...]:
        """Slots of the channel's own unknowns, in the order of the kernel."""

    @abstractmethod
    def parameters(self, e: np.ndarray) -> Any:
        """Parameters of the elements ``e`` (numbers from the top)."""

    @abstractmethod
    def parameter(self, name: str) -> FloatArray:
        """Present values (nc, ...) of a parameter of the local elements, as the kernels' header names it."""

    @abstractmethod
    def element_results(self, state: Any) -> FloatArray:
        """(nc, 9) per local element: the columns of ``physics.fluid.channel_flow.RESULT_NAMES``."""

    @abstractmethod
    def totals(self, state: Any) -> list[float]:
        """10 sums of ``element_results`` over the local elements."""

    @abstractmethod
    def flows(self, system: Any) -> FloatArray:
        """(nc,) flow rates in the local elements, towards the bit [m3/s]."""

    @abstractmethod
    def pressures(self, system: Any) -> FloatArray:
        """(nv,) pressures at the local vertices [Pa]."""

    def pressure_at(self, system: Any, vertex: int) -> float:
        """Pressure at one local vertex [Pa]."""
        return float(self.pressures(system)[vertex])

    @abstractmethod
    def velocity_power(self, above: np.ndarray, below: np.ndarray, state: Any) -> float:
        """Kinetic energy that the flow brings to nodes, minus the energy that it takes away below them in the section above [W].

        above, below: local cells that end, and that begin, at the nodes.
        """

    @abstractmethod
    def upper_flow(self, state: Any) -> float | None:
        """Flow rate into the upper end by conservation of mass [m3/s]; None on ranks without that end."""

    @abstractmethod
    def upper_pressure(self, state: Any) -> float:
        """Pressure at the upper end [Pa], on the rank that holds it."""

    def pumped(self, t: float, state: Any) -> float | None:
        """Flow rate that the pump supplies [m3/s]; None on ranks without the upper end, and in an annulus."""
        return None

    def outflow(self, state: Any) -> float | None:
        """Flow rate out of the flow line [m3/s]; None on ranks without the upper end, and in a bore."""
        return None

    def lateral_sizes(self) -> FloatArray:
        """(nc, 2) outer diameter of the string and diameter of the hole [m] of the local elements; (0, 2) in a bore."""
        return np.zeros((0, 2))

    def set_lateral(self, added: FloatArray, damping: FloatArray) -> None:
        """Replace the coefficients of motion across the hole, of the local elements.

        added: (nc,) added over displaced mass [-]; damping: (nc,) [N s/m2].
        """

    def content_above(self, state: Any) -> float:
        """Volume between the upper node and the flow line [m3], up to a constant; 0 on ranks without the upper end."""
        return 0.0

    @abstractmethod
    def pressure_places(self, system: Any) -> np.ndarray | None:
        """(nv,) places of the pressures at the local vertices in the unknowns; None if they are computed from others."""

    # the same after each of k recorded steps (``fem.step_record``); None if they are found one by one only
    @abstractmethod
    def sums_of(self, steps: Any) -> FloatArray:
        """(k, 10) ``totals``."""

    @abstractmethod
    def upper_pressure_of(self, steps: Any) -> FloatArray:
        """(k,) ``upper_pressure``."""

    @abstractmethod
    def pressure_at_of(self, steps: Any, vertex: int) -> FloatArray:
        """(k,) ``pressure_at``."""

    @abstractmethod
    def upper_flow_of(self, steps: Any) -> FloatArray | None:
        """(k,) ``upper_flow``."""

    def pumped_of(self, steps: Any) -> FloatArray | None:
        """(k,) ``pumped``."""
        return None

    def outflow_of(self, steps: Any) -> FloatArray | None:
        """(k,) ``outflow``."""
        return None

    def content_above_of(self, steps: Any) -> Any:
        """(k,) ``content_above``, or one number for all."""
        return 0.0


class Nozzle(Component):
    """Flow through the bit."""

    @abstractmethod
    def element_results(self, state: Any) -> FloatArray:
        """(8,) results of the bit's chamber: the columns of ``physics.fluid.bit_flow.RESULTS``."""

    @abstractmethod
    def closed_face(self, state: Any) -> FloatArray:
        """Area of the bit's face that does not displace mud, times the hole's direction (3,) [m2].

        Zero if this rank does not have the bit, or the face moves freely in mud.
        """

    @abstractmethod
    def results_of(self, steps: Any) -> FloatArray:
        """(k, 8) ``element_results`` after each of k recorded steps."""


class SideOutlets(Component):
    """Nozzles above the bit, through which mud leaves the bore."""

    @abstractmethod
    def shares_of_pump(self) -> FloatArray:
        """(links,) shares of the pump's flow by areas alone [-], with which the steady flow starts."""

    @abstractmethod
    def local_links(self) -> tuple[int, ...]:
        """Numbers of the links at nodes of this rank, in the order of ``element_results``."""

    @abstractmethod
    def element_results(self, state: Any) -> FloatArray:
        """(k, 4) of the local links: the columns of ``physics.fluid.side_nozzles.RESULTS``."""

    @abstractmethod
    def outflow(self, state: Any) -> float:
        """Flow rate out of the string through the local links [m3/s]."""


class SealSet(Component):
    """Seals of telescoping joints, which move mud."""

    @abstractmethod
    def element_results(self, state: Any) -> FloatArray:
        """(k, 6) of the local joints with seals: columns of ``physics.fluid.joint_seals.SEAL_RESULTS``."""

    @abstractmethod
    def content(self, state: Any) -> float:
        """Volume at zero pressure that the travel of the local joints adds to bore and annulus [m3]."""


class MeasuredLosses(Component):
    """Losses of tools in the string by tables of the flow rate."""

    @abstractmethod
    def losses(self, state: Any) -> FloatArray:
        """(nc,) losses in the local elements of the bore [Pa]."""


class RockInMud(Component):
    """Rock that reamers cut out of the wall, and the mud that takes its place."""

    @abstractmethod
    def cuttings(self, state: Any) -> float:
        """Rock that becomes mud [m3/s at zero pressure], on this rank."""
