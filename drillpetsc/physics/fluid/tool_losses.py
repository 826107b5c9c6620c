"""Losses beside the friction in the string: of tools, measured by a table of the flow rate, and of the lines from pump to string.

Kernel: kernels/fluid/tool_loss.hpp.  Manual: eq-mud-tool-curve.  Losses that go with the flow rate squared are part of the bore's
row of momentum (``BoreFlow``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics.fluid.channel_flow import FluidConstants
from drillpetsc.physics.fluid.rheology import Rheology, pressure_gradient

RESULTS = columns("tool_loss_results")


@dataclass(frozen=True)
class LossTable:
    """Loss of one tool.

    table: (k, 3) flow rate squared [m6/s2], rising from 0, loss [Pa], slope of the loss by the square.
    density: of the fluid of the measurement [kg/m3].
    cells: (m,) elements of the bore that have it; shares: (m,) of each [-].
    """

    table: FloatArray
    density: float
    cells: np.ndarray
    shares: FloatArray


class ToolLosses(Component):
    """Losses of all tools with a table.

    tools: from the top down; fluid: constants.
    """

    name = "tool_losses"

    def __init__(self, tools: tuple[LossTable, ...], fluid: FluidConstants):
        self.tools, self.fluid = tools, fluid
        self._table = np.ascontiguousarray(np.concatenate([tool.table for tool in tools]), dtype=float)
        counts = [len(tool.table) for tool in tools]
        self._first = np.concatenate([[0], np.cumsum(counts)[:-1]])

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        place = {int(c): i for i, c in enumerate(part.cells)}
        rows = [
            (k, place[int(c)], share)
            for k, tool in enumerate(self.tools)
            for c, share in zip(tool.cells, tool.shares, strict=True)
            if int(c) in place
        ]
        which = np.array([k for k, _, _ in rows], dtype=int)
        params = Parameters(
            "tool_loss",
            len(rows),
            first=self._first[which],
            count=np.array([len(tool.table) for tool in self.tools])[which],
            share=np.array([share / self.tools[k].density for k, _, share in rows]),
            density=self.fluid.density,
            compressibility=1.0 / self.fluid.bulk_modulus,
        )
        slots = (("bore.pressure", 0), ("bore.pressure", 1), ("bore.flow", 1))
        points = np.array([i for _, i, _ in rows], dtype=np.int32)
        self._block = ElementBlock(
            "tool_losses",
            "tool_loss",
            "cell",
            points,
            slots,
            (),
            params.array,
            context=pointer(self._table),
            constants=(self._table,),
        )
        self._block.keep = (self._table,)
        self._cells = part.cells
        return (self._block,)

    def losses(self, state) -> FloatArray:
        """(nc,) losses in the local elements of the bore [Pa]."""
        out = np.zeros(len(self._cells))
        found = state.results(self._block, "tool_loss_results", RESULTS.width).table
        np.add.at(out, self._block.points, found[:, RESULTS["loss"]])
        return out

    def powers_of(self, steps) -> tuple[Any, Any]:
        return steps.sums(self._block, "tool_loss_results", RESULTS.width)[:, RESULTS["power"]], 0.0


@dataclass(frozen=True)
class SurfaceLine:
    """A pipe with the string's friction law, or a measured loss scaled with the flow rate squared.

    rheology, density: of the fluid [kg/m3].
    length, diameter: of the pipe [m]; 0 with a measured loss.
    measured, at: loss [Pa] at a flow rate [m3/s]; 0 with a pipe.
    """

    rheology: Rheology
    density: float
    length: float = 0.0
    diameter: float = 0.0
    measured: float = 0.0
    at: float = 0.0

    def loss(self, flow_rate: float) -> float:
        """Compute the pressure loss [Pa], with the sign of the flow rate [m3/s]."""
        if self.at > 0:
            return self.measured * flow_rate * abs(flow_rate) / self.at**2
        speed = flow_rate / (math.pi / 4 * self.diameter**2)
        gradient = pressure_gradient(self.rheology, [speed], [self.diameter], [False], [self.density])
        return float(gradient[0]) * self.length
