"""Figures of the drilling fluid during a run: pressures, flows, what went in and came out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem

Column = tuple[str, str]


class FlowRecorder:
    """Samples the fluid of a scene; sums over ranks are the caller's.

    A sample is (7,): pressures at the pump and at the bit [Pa], flow rates out of the flow line, of the pump
    and through the bit [m3/s], volume at zero pressure of all fluid [m3], and of the rock that becomes part
    of it [m3/s].
    """

    SIZE = 7

    def __init__(self, system: DiscreteSystem, fluid) -> None:
        self.system, self.fluid = system, fluid
        chain, last = system.chain, system.mesh.nodes - 1
        here = {int(v): i for i, v in enumerate(chain.vertices) if chain.owned[i]}
        self._last = here.get(last, -1)
        self.start_content = 0.0
        self._sums = np.zeros(3)  # volumes pumped, returned, and of cuttings taken up [m3]
        self._before: tuple[FloatArray, float] | None = None  # sums one step ago and that step [m3, s]

    @property
    def columns(self) -> list[Column]:
        """Columns of the history, those that this scene has."""
        f = self.fluid
        pump: list[Column] = [("pump_pressure", "Pa")] if f.bore is not None else []
        ends: list[Column] = [("bit_pressure", "Pa"), ("outlet_flow", "m3/s")]
        return pump + ends + ([("pump_flow", "m3/s"), ("bit_flow", "m3/s")] if f.bore is not None else [])

    def row(self, sample: FloatArray) -> list[float]:
        """Values of ``columns`` from a sample."""
        has_bore = self.fluid.bore is not None
        return [
            *([sample[0]] if has_bore else []),
            sample[1],
            sample[2],
            *([sample[3], sample[4]] if has_bore else []),
        ]

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Within this, figures of the channels are worked out once for all who ask; the state must not
        change."""
        with ExitStack() as stack:
            for component in (self.fluid.bore, self.fluid.annulus):
                if component is not None:
                    stack.enter_context(component.taken(self.system.assembly))
            yield

    def sample(self, t: float) -> FloatArray:
        """(6,) this rank's share."""
        f, asm = self.fluid, self.system.assembly
        v = np.zeros(self.SIZE)
        for component in (f.bore, f.annulus):
            if component is not None:
                v[5] += component.figures(asm)[:, 4].sum()
        if f.bit is not None:
            figures = f.bit.figures(asm)
            v[4], v[5], v[6] = figures[1], v[5] + figures[4], figures[6]
        if f.bore is not None:
            flow = f.bore.pumped(t, asm)
            if flow is not None:
                v[0], v[3] = f.bore.upper_pressure(asm), flow
        if f.annulus is not None:
            out = f.annulus.outflow(asm)
            v[2] = 0.0 if out is None else out
            v[5] += f.annulus.content_above(asm)
        else:
            v[2] = v[4]
        if self._last >= 0:
            v[1] = (f.annulus or f.bore).pressures(self.system)[self._last]
        return v

    # ------------------------------------------------------------------ mass
    def begin(self, total: FloatArray) -> None:
        """Open the books at a sample summed over ranks."""
        self._sums, self.start_content, self._before = np.zeros(3), float(total[5]), None

    def step(self, total: FloatArray, dt: float, fresh: bool) -> None:
        """Add up what an accepted step brought in and out, by the formula that the pressures took (BDF of
        order 2): what it makes of a wave front is then no loss of mud.  fresh: the formula starts anew, as
        PETSc does it, by a half step of order 1."""
        now, old = total[[3, 2, 6]], self._sums
        if fresh or self._before is None:
            before, gap = old, 0.5 * dt
            old, rest = old + gap * now, 0.5 * dt
        else:
            (before, gap), rest = self._before, dt
        # derivative at the end of the parabola through three times: new, `rest` and `rest + gap` before it
        a0, a1, a2 = 1 / rest + 1 / (rest + gap), -(rest + gap) / (rest * gap), rest / (gap * (rest + gap))
        self._before = self._sums, dt
        self._sums = (now - a1 * old - a2 * before) / a0

    def balance(self, total: FloatArray) -> dict[str, Any]:
        """Volumes at zero pressure since the start [m3]; the share is relative to the larger of what went in
        and came out.  With a hole that grows, the content is that of the hole as it is; cuttings: rock that
        the mud carries, counted as mud."""
        change, (pumped, returned, cuttings) = float(total[5]) - self.start_content, map(float, self._sums)
        error = change - pumped + returned - cuttings
        largest = max(abs(pumped), abs(returned), abs(change), 1e-300)
        rock = {"cuttings": cuttings} if cuttings else {}
        return {
            "pumped": pumped,
            "returned": returned,
            **rock,
            "content_change": change,
            "error": error,
            "error_share": error / largest,
        }

    def get_state(self) -> dict[str, FloatArray]:
        """What a continued run needs to keep counting."""
        sums, step = self._before if self._before is not None else (np.zeros(3), 0.0)
        return {"mud": np.array([*self._sums, self.start_content, *sums, step])}

    def set_state(self, memory: dict[str, FloatArray]) -> None:
        """Take up a memory."""
        books = np.array(memory["mud"])
        self._sums, self.start_content = books[:3], float(books[3])
        self._before = (books[4:7], float(books[7])) if books[7] > 0.0 else None

    # ------------------------------------------------------------------ along the string
    def nodal(self) -> dict[str, FloatArray]:
        """Pressures [Pa] at the local vertices."""
        names = {"bore": "internal_pressure [Pa]", "annulus": "annulus_pressure [Pa]"}
        components = {title: getattr(self.fluid, component) for component, title in names.items()}
        return {
            title: component.pressures(self.system)
            for title, component in components.items()
            if component is not None
        }

    def wall_tension(self) -> FloatArray:
        """(nc, 2) tension [N] of the pipe's wall at both ends of the local elements beyond EA times strain:
        what keeps a pipe under pressure from growing shorter, 2 nu (p_i A_i - p_o A_o) (Lame)."""
        chain, out = self.system.chain, np.zeros((len(self.system.chain.cells), 2))
        for component, sign in ((self.fluid.bore, 1.0), (self.fluid.annulus, -1.0)):
            if component is not None:
                area = (component.bore.area if component is self.fluid.bore else component.annulus.outer)[
                    chain.cells
                ]
                pressure = component.pressures(self.system)[chain.ends]
                out += sign * 2 * (component.poisson[chain.cells] * area)[:, None] * pressure
        return out

    def pressure_force(self) -> FloatArray:
        """(nc, 2) what effective tension has beyond that of the wall at both ends of the local elements, -p_i
        A_i + p_o A_o [N]."""
        chain, out = self.system.chain, np.zeros((len(self.system.chain.cells), 2))
        for component, sign in ((self.fluid.bore, -1.0), (self.fluid.annulus, 1.0)):
            if component is not None:
                area = (component.bore.area if component is self.fluid.bore else component.annulus.outer)[
                    chain.cells
                ]
                out += sign * area[:, None] * component.pressures(self.system)[chain.ends]
        return out

    def cellwise(self) -> dict[str, FloatArray]:
        """Flow rates [m3/s] and speeds [m/s] in the local elements, towards the bit positive."""
        out = {}
        for component, title in (("bore", "internal"), ("annulus", "annulus")):
            channel = getattr(self.fluid, component)
            if channel is not None:
                out[f"{title}_flow [m3/s]"] = channel.flows(self.system)
                out[f"{title}_speed [m/s]"] = channel.figures(self.system.assembly)[:, 7]
        return out
