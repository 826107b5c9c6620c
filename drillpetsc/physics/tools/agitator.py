"""Agitator in the string: pressure pulses of a valve push the halves of a slider apart.

Kernel: kernels/tools/agitator.hpp.  Manual: sec-agitator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import DRIVE, Component, ElementBlock, Field, Powers, Start
from drillpetsc.fem.quantity import Quantity, numbered
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.beam import SLOTS
from drillpetsc.physics.end_conditions import Input
from drillpetsc.physics.tools.mud_motor import MUD_SLOTS

RESULTS = columns("agitator_results")


@dataclass(frozen=True)
class Valve:
    """Valve of an agitator.

    turn: angle of its rotor per volume of mud [rad/m3]; amplitude: of the pressure [Pa]; area: of the piston [m2].
    square: square pulses, else a sine.
    """

    turn: float
    amplitude: float
    area: float
    square: bool = False


class Agitator(Component):
    """Force A_p dp on a slider, dp an oscillation of the valve whose rotor turns with the flow rate.

    Field: ``agitator.angle`` of the rotor at the node below the slider [rad].

    cell: of the slider; valve: of the tool; flow: without mud, flow rate over time [m3/s].
    compressibility: of the mud [1/Pa], None without mud.  With mud the flow rate is taken from the slider's cell, in which the
    mud also loses the pressure of the pulses.
    number: of the agitator in the string, from the top.
    """

    name = "agitator"

    def __init__(
        self,
        mesh: StringMesh,
        cell: int,
        valve: Valve,
        flow: Input | None,
        compressibility: float | None = None,
        number: int = 1,
    ):
        self._number, self.name = number, numbered("agitator", number)
        self.mesh, self.cell, self.valve = mesh, cell, valve
        self.flow, self.compressibility = flow, compressibility

    def regions(self) -> dict[str, np.ndarray]:
        below = np.zeros(self.mesh.nodes, dtype=bool)
        below[self.cell + 1] = True
        return {self.name: below}

    def fields(self) -> tuple[Field, ...]:
        return (
            Field(f"{self.name}.angle", 1, region=self.name, scale=0.1, second_order=False, physics=DRIVE),
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        place = {int(c): i for i, c in enumerate(part.cells)}
        here = [place[self.cell]] if self.cell in place else []
        v, flowing = self.valve, self.flow is None
        kernel = "agitator_flowing" if flowing else "agitator"
        self.params = Parameters(
            kernel,
            len(here),
            held=0.0,
            turn=v.turn,
            amplitude=v.amplitude,
            area=v.area,
            square=float(v.square),
            flow=0.0,
            compressibility=self.compressibility or 0.0,
        )
        self._now = self.params["flow"]
        self._block = ElementBlock(
            self.name,
            kernel,
            "cell",
            np.array(here, dtype=np.int32),
            (*SLOTS, (f"{self.name}.angle", 1), *(MUD_SLOTS if flowing else ())),
            (0, 1),
            self.params.array,
            update=None if flowing else self._update,
        )
        return (self._block,)

    def _update(self, t: float) -> None:
        if self.flow is not None:
            self._now[:] = self.flow.value(t)

    def breaks(self) -> tuple[float, ...]:
        return self.flow.breaks() if self.flow is not None else ()

    def hold(self) -> None:
        self.params["held"] = 1.0

    def begin_motion(self, state: Any, start: Start) -> None:
        self.params["held"] = 0.0

    def balance(self, state: Any) -> str:
        self.hold()
        return "the valve of the agitator is held: its pulses excite the string and do not change its linear response"

    def figures(self, t: float, state: Any) -> FloatArray:
        """Numbers of its quantities at the time ``t`` [s], in the order of ``RESULTS``; this rank's share."""
        self._update(t)
        return np.array(state.evaluated(self._block, self._block.results_kernel, RESULTS.width).sums)

    def powers(self, t: float, state: Any) -> Powers:
        r = self.figures(t, state)
        shaken = float(r[RESULTS["force"]] * r[RESULTS["speed"]])
        if self.flow is not None:
            return Powers(supplied=shaken)
        return Powers(dissipated=float(r[RESULTS["pressure"]] * r[RESULTS["flow_rate"]]) - shaken)

    def quantities(self) -> tuple[Quantity, ...]:
        return tuple(q.numbered(self._number) for q in declared.AGITATOR)
