"""Pressure under the bit while a string starts to move: a run of string and mud from rest to the trip speed.

The steady pressure of `surge` leaves out the mud's inertia and compressibility and the string's stretch.  Here the top
accelerates to the trip speed and goes on at it until pressure waves have passed the annulus a few times.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.hydraulics.flow_model import (
    BELOW_BIT,
    Pipe,
    PlacedString,
    flow_case,
    string_at,
)
from drillpetsc.analysis.motion.initial_state import initial_state
from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.case.blocks.ends import TopDrive
from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.time_function import Constant, PiecewiseLinear

ACCELERATION = 0.3  # of the top [m/s2]
PASSAGES = 6.0  # of a pressure wave along the annulus after the acceleration


@dataclass(frozen=True)
class DynamicSurge:
    """Largest pressure under the bit beyond the pressure with the string at rest at the same depth.

    pressure: [Pa], swab negative; time: of it, from the start [s]; last: pressure at the end of the run [Pa].
    """

    pressure: float
    time: float
    last: float


def duration(case: Case, length: float, speed: float) -> tuple[float, float]:
    """Time of the acceleration, and of the whole run [s].

    length: of the string [m]; speed: [m/s].
    """
    started = speed / ACCELERATION
    return started, started + PASSAGES * length * float(
        np.sqrt(case.given_fluid.density / case.given_fluid.bulk_modulus)
    )


def dynamic_surge(
    case: Case, string: PlacedString, pipe: Pipe, velocity: float, flow: float = 0.0
) -> DynamicSurge:
    """Run string and mud from rest (one process).

    velocity: of the top, positive down [m/s]; flow: of the pump, for a pumping string [m3/s].
    Raises SolveError if there is no static state or no step can be taken.
    """
    if abs(string.top) > 1e-6:  # the top of a run is at measured depth 0
        string = string_at(case, string.depth)
    started, end = duration(case, string.length, abs(velocity))
    bare, _ = flow_case(case, string, pipe, True, BELOW_BIT + abs(velocity) * end)
    assert bare.fluid is not None
    mud = {"flow_rate": Constant(flow)} if pipe == "pumping" else {}
    top = TopDrive(kind="top_drive", lowering=PiecewiseLinear((0.0, started), (0.0, velocity)))
    moving = bare.model_copy(
        update={
            "fluid": bare.fluid.model_copy(update=mud),
            "top": top,
            "contact": case.contact,
            "beam": case.beam,
            "initial": case.initial.model_copy(update={"wob": None}),
        }
    )
    model = build_model(moving, PETSc.COMM_SELF)
    integrator = make_integrator(model)
    initial_state(model, moving, None, None)
    annulus, fluid = model.annulus, model.fluid
    assert annulus is not None and fluid is not None
    f = fluid.constants

    def still() -> float:
        """Pressure under the bit less the weight of the mud above it, up to a constant [Pa]."""
        place = model.system.field("string.position")[-1]
        return float(annulus.pressures(model.system)[-1]) - f.density * float(f.gravity @ place)

    at_rest = still()
    times, pressures = [0.0], [0.0]

    def keep(t: float) -> None:
        times.append(t)
        pressures.append(still() - at_rest)

    integrator.on_step_end.append(keep)
    integrator.run(0.0, end, (started, *model.breaks), resume=False)
    k = int(np.argmax(np.sign(velocity) * np.array(pressures)))
    return DynamicSurge(pressures[k], times[k], pressures[-1])
