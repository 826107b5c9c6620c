"""Quasi-static drilling: string and fluid are in equilibrium at all times, the end of the hole is integrated.

Steps are seconds to minutes.  Manual: sec-statics-quasi-static, sec-bit-quasi-static.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.statics.placement import average_over_turn
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.time.time_integrator import TimeIntegrator

FIRST_STEP = 1.0  # [s]
LARGEST_ADVANCE = 0.1  # largest motion of the top in a step [m], during which the wall is fixed
LONGEST_STEP = 60.0  # [s]
CURE = (
    "the string has no equilibrium near the last one, as when its buckles jump to another state under the weight in the last row of "
    "history.csv; less weight on bit, or time.mode: dynamic, which moves through the jump"
)


def longest_step(model: DrillingModel) -> float:
    """Compute the longest step [s] of the error control.

    The shape of the hole limits it if the string slides down.
    """
    case = model.case
    assert case.time is not None
    if case.time.step is not None:
        return case.time.step
    lowering = case.top.lowering
    if lowering is None:
        return LONGEST_STEP
    times = np.linspace(0.0, case.time.end, 200)
    fastest = max((abs(lowering.value(t)) for t in times), default=0.0)
    return min(LONGEST_STEP, LARGEST_ADVANCE / fastest) if fastest > 0 else LONGEST_STEP


class QuasiStatic:
    """Motion of a model without inertia: each step uses the motion that the top prescribes at its end.

    This motion gives the direction of friction and the string's velocity in the fluid.  The string turns
    about its axis in place, and its directors are fixed.  A bent item keeps its tool face while the top
    does not turn; while the top turns, the bend averages out.

    rates: (n+1,) imposed rates of the string.
    lateral_fraction: fraction of the lateral friction force that acts [-].
    """

    def __init__(self, model: DrillingModel):
        self.model, self.system, self.lateral_fraction = model, model.system, 1.0
        layout = self.system.layout
        string = np.array([f.physics == "string" for f in layout.fields])
        self.rates = np.zeros(layout.size + 1)
        # the mud keeps its storage: steps of seconds damp its waves, but its content accumulates
        self._mask = string[layout.field_of]
        average_over_turn(model, self.motion(0.0)[1])  # the static start state also needs this

    def integrator(self) -> TimeIntegrator:
        """Create the integrator of the hole's end; the string is in equilibrium at each step.

        Raises CaseError if PETSc options select another integrator than the condensed BDF.
        """
        longest = longest_step(self.model)
        options: dict[str, Any] = {"ts_adapt_dt_max": longest}
        d = TimeIntegrator(
            self.system,
            first_step=min(FIRST_STEP, longest),
            # the string is in equilibrium at every step, so its motion has no error of the time formula
            controlled=lambda field: field.name.startswith("hole."),
            defaults=options,
            inertia=False,
        )
        if not d.condensed:
            raise CaseError(
                at="time.mode",
                got="quasi_static",
                want="the condensed BDF integrator: no -ts_type and no -snes_type",
            )
        d.before_solve.append(self.move)
        if self.model.bit is not None:
            d.cure = CURE
        return d

    def start(self, t: float = 0.0, lateral_fraction: float = 1.0) -> None:
        """Start quasi-static integration from the static state at ``t`` [s]; collective.

        lateral_fraction: fraction of the lateral friction force that the static solution sustained [-].
        """
        asm, self.lateral_fraction = self.system.assembly, lateral_fraction
        for component in self.model.components:
            # without velocities, constraints act on positions
            component.constrain_positions(True)
        asm.set_imposed_rates(self.rates, self._mask)
        # without inertia accelerations are zero, and rates are imposed (manual: sec-time-imposed)
        asm.y[:] = asm.a[:] = 0.0
        self.move(t)
        asm.apply_imposed_rates()
        self.system.sum_residual(t, self.system.new_condensed())  # updates the reactions in the assembly

    def motion(self, t: float) -> tuple[float, float]:
        """Return lowering [m/s] and rotation [rad/s] of the top at ``t`` [s]."""
        top = self.model.case.top
        # a force moves the top: its speed is not prescribed
        lowering = top.lowering if top.force is None else None
        rotation = top.rotation
        return (lowering.value(t) if lowering is not None else 0.0), (
            rotation.value(t) if rotation is not None else 0.0
        )

    def move(self, t: float) -> None:
        """Set the rates of all nodes and the sliding direction of friction to their values at ``t`` [s]."""
        lowering, rotation = self.motion(t)
        model = self.model
        model.beam.impose_rigid_motion(self.system, self.rates, lowering, rotation)
        average_over_turn(model, rotation)
        for component in model.components:
            component.impose_drilling(lowering, rotation, self.lateral_fraction)
