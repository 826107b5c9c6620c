"""Quasi-static drilling: string and fluid in equilibrium at every time, the hole's end integrated; steps of
seconds to minutes."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.time_integrator import TimeIntegrator

FIRST_STEP = 1.0  # [s]
ADVANCE = 0.1  # metres that the top may come down in a step: the wall stands still meanwhile
LONGEST_STEP = 60.0  # [s]


def longest_step(model: DrillingModel) -> float:
    """Step that the error control may not exceed [s]: what the hole's shape asks for where the string slides
    down it."""
    case = model.case
    assert case.time is not None
    if case.time.step is not None:
        return case.time.step
    lowering = case.top.lowering
    if lowering is None:
        return LONGEST_STEP
    times = np.linspace(0.0, case.time.end, 200)
    fastest = max((abs(lowering.value(t)) for t in times), default=0.0)
    return min(LONGEST_STEP, ADVANCE / fastest) if fastest > 0 else LONGEST_STEP


class QuasiStatic:
    """Moves a scene without inertia: before each step friction and fluid see the motion that the top
    prescribes then.

    The string turns about its own axis without changing place, so its directors stand still (a bent item
    keeps its tool face while the top does not turn; while it turns its bend averages out).
    """

    def __init__(self, model: DrillingModel):
        self.model, self.system, self.share = model, model.system, 1.0
        layout = self.system.layout
        string = np.array([f.physics == "string" for f in layout.fields])
        self.rates = np.zeros(layout.size + 1)
        self._mask = string[
            layout.field_of
        ]  # mud keeps its storage: at steps of seconds its waves are gone, its content adds up
        self._average_over_turn(self.motion(0.0)[1])  # also in the static state it starts from

    def integrator(self) -> TimeIntegrator:
        """The integrator of the hole's end, with the string following."""
        longest = longest_step(self.model)
        options: dict[str, Any] = {"ts_adapt_dt_max": longest}
        d = TimeIntegrator(
            self.system,
            first_step=min(FIRST_STEP, longest),
            controlled=lambda field: field.name.startswith("hole."),
            defaults=options,
        )
        if not d.condensed:
            raise CaseError(
                at="time.mode",
                got="quasi_static",
                want="the condensed BDF integrator: no -ts_type and no -snes_type",
            )
        d.before_solve.append(self.move)
        return d

    def begin(self, t: float = 0.0, share: float = 1.0) -> None:
        """From the static state to quasi-static motion; share of the side push of friction, as the static
        state could keep it."""
        asm, self.share = self.system.assembly, share
        asm.set_imposed_rates(self.rates, self._mask)
        asm.y[:] = asm.a[:] = 0.0
        self.move(t)
        asm.apply_imposed_rates()
        self.system.sum_residual(t, self.system.new_condensed())  # so that reactions stand in the assembly

    def motion(self, t: float) -> tuple[float, float]:
        """Lowering [m/s] and rotation [rad/s] of the top at ``t``."""
        top = self.model.case.top
        lowering = top.lowering if top.force is None else None
        rotation = top.rotation
        return (lowering.value(t) if lowering is not None else 0.0), (
            rotation.value(t) if rotation is not None else 0.0
        )

    def move(self, t: float) -> None:
        """Rates of all nodes and the sliding that friction opposes, at ``t``."""
        lowering, rotation = self.motion(t)
        layout, asm = self.system.layout, self.system.assembly
        slope = layout.dofs["string.tangent"]
        v = asm.x[slope]
        self.rates[layout.dofs["string.position"]] = lowering * v / np.linalg.norm(v, axis=1, keepdims=True)
        self.rates[layout.dofs["string.spin"][:, 0]] = rotation
        model = self.model
        self._average_over_turn(rotation)
        for component in model.components:
            component.impose_drilling(lowering, rotation, self.share)

    def _average_over_turn(self, rotation: float) -> None:
        """Leave a bent item its bend while the top stands, and nothing of it while the top turns."""
        for component in self.model.components:
            component.average_over_turn(bool(rotation))
