"""What moving mud does to the axial force of a string: drag of the annulus and thrust of the jets.

The friction of the annulus drags the string up, and its pressure gradient lifts it; the jets push the bit up.  Friction in
the bore and the pressure of the pump cancel in the effective tension less the momentum of the mud in the bore, which is
what the hook carries and what buckles (manual: sec-roadmap-flow).  A string that is run or pulled displaces mud, with the
same forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import FlowModel, Pipe, string_at
from drillpetsc.analysis.hydraulics.losses import annulus_stress, element_losses
from drillpetsc.arrays import FloatArray, sums_from_below
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.model.fluid import build_rheology


@dataclass(frozen=True)
class Circulation:
    """Forces of the mud on a string at a bit depth.

    md: (n+1,) measured depths [m]; below: (n+1,) force that lifts the string below them [N].
    thrust: of the jets on the bit, up [N].
    inside, outside: (n+1,) pressures [Pa]; momentum: (n+1,) density times the square of the flow in the bore [N m2].
    """

    md: FloatArray
    below: FloatArray
    thrust: float
    inside: FloatArray
    outside: FloatArray
    momentum: FloatArray

    def lift(self, edges: FloatArray) -> FloatArray:
        """(k,) lift per length [N/m] between measured depths ``edges`` (k+1,) [m]."""
        below = np.interp(edges, self.md, self.below)
        return np.asarray(-np.diff(below) / np.diff(edges))


def circulation(case: Case, depth: float, flow: float, at: str, speed: float = 0.0) -> Circulation:
    """Forces of the mud that a pump drives with ``flow`` [m3/s] through a string whose bit is at ``depth`` [m].

    at: key of the flow rate, for messages.
    speed: of the string along the hole [m/s], positive down; without a pump the pipe is open, unless its bottom is plugged.
    Raises CaseError without mud or a bore, SolveError if there is no steady flow.
    """
    _need_mud(case, flow, at)
    model = flow_of_row(case, depth, flow, speed)
    model.solve(flow, speed)
    return forces_of(model, speed)


def circulations(case: Case, depth: float, flows: FloatArray, at: str) -> tuple[Circulation, ...]:
    """The same of flow rates (r,) above 0 [m3/s] through a string that stands still: one model, which costs more than its solutions."""
    _need_mud(case, float(flows[0]), at)
    model, out = flow_of_row(case, depth, float(flows[0]), 0.0), []
    for flow in flows:
        model.solve(float(flow))
        out.append(forces_of(model, 0.0))
    return tuple(out)


def _need_mud(case: Case, flow: float, at: str) -> None:
    if case.fluid is None or (flow and not case.has_bore):
        raise CaseError(at=at, got=f"{flow:g} m3/s", want="a fluid in the bore, through which it flows")


def flow_of_row(
    case: Case, depth: float, flow: float, speed: float, like: FlowModel | None = None
) -> FlowModel:
    """The flow model of ``circulation``, not yet solved; like: as for ``FlowModel``."""
    pipe: Pipe = "pumping" if flow else "closed" if case.bottom.plugged else "open"
    return FlowModel(case, string_at(case, depth), pipe, bool(speed), like)


def forces_of(model: FlowModel, speed: float) -> Circulation:
    """Forces on the string of a steady flow that is solved, at the ``speed`` [m/s] of the string along the hole."""
    count = len(model.md) - 1
    force, channel, mesh = np.zeros(count), model.fluid.annulus, model.mesh
    if channel is not None:
        law = build_rheology(model.case, annulus=True)
        losses = element_losses(model, channel, law)
        pressure = np.diff(channel.pressures(model.system)) - losses.weight  # by friction and velocity head
        drift = speed * (1.0 - model.fluid.constants.clinging)
        stress = annulus_stress(channel, law, losses.speed, losses.density, drift)[1]
        drag = -stress * mesh.length  # mud that flows away from the bit drags the string up
        # as in kernels/fluid/annulus_flow.hpp: of the element, of the rigid item above it, of the shoulders
        outer, above = channel.parameter("outer"), channel.parameter("outer_above")
        force = (pressure + losses.above) * outer + drag * np.pi * channel.parameter("diameter")
        around = np.pi * np.sqrt(4 / np.pi * above) * channel.parameter("gap_above") / 4
        force -= losses.above * (above + around)
        mass_flow = channel.flows(model.system) * model.fluid.constants.density
        force += mass_flow**2 / losses.density * channel.parameter("shoulder")
    below = sums_from_below(force)
    still = np.zeros(count + 1)
    bore, annulus = (model.pressure(name) for name in ("bore", "annulus"))
    flows = model.flow_rate("bore")
    through = np.zeros(count + 1) if flows is None else np.append(flows, flows[-1])  # below each node
    return Circulation(
        model.md,
        below,
        _thrust(model, float(through[-1])),
        still if bore is None else bore,
        still if annulus is None else annulus,
        model.fluid.constants.density * through**2,
    )


def _thrust(model: FlowModel, flow: float) -> float:
    """Momentum of the mud that leaves the bit [N]; jets above it point outward and give no thrust.

    flow: through the bit [m3/s].
    """
    bit = model.fluid.bit
    if bit is None or not bit.has_link or not flow:
        return 0.0
    return float(model.fluid.constants.density * flow**2 / (bit.end.nozzle or bit.end.bore))
