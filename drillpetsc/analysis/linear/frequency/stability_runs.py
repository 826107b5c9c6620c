"""Stick-slip by runs in time over rotary speed and weight on bit, beside the eigenvalues (manual: sec-stability-runs)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.motion.session.session import Session
from drillpetsc.case.blocks.settings import Time
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import is_quasi_static
from drillpetsc.time_function import Constant, PiecewiseLinear
from drillpetsc.vibration.indices import stick_slip_index, stuck_share

START = 0.8  # share of the speed with which a run begins
RISE = 1.0  # time in which the speed rises to its value [s]
READINGS = 1500  # of the bit's speed in a run
STEADY = 0.05  # index below which a bit turns steadily
STUCK = 0.01  # share of the time at rest from which a bit sticks and slips
LARGE = 0.5  # index from which an oscillation that no longer grows is a limit cycle
BEHAVIOURS = ("steady", "decays", "grows", "stick_slip", "failed")


@dataclass(frozen=True)
class RunPoint:
    """A run at one speed [rad/s] and weight on bit [N].

    index, before: stick-slip index in the last third of the run and in the third before [-]; stuck: share of the last
    third in which the bit is stuck [-]; behaviour: one of ``BEHAVIOURS``.
    """

    speed: float
    weight: float
    index: float
    before: float
    stuck: float
    behaviour: str

    @property
    def unstable(self) -> bool:
        """Whether the oscillation grows, or has grown as far as it can."""
        return self.behaviour in ("grows", "stick_slip")


def refuse(case: Case) -> None:
    """Raise CaseError for a case whose weight and speed a run cannot be started with."""
    if case.top.autodriller is not None:
        raise CaseError(
            at="top.autodriller", want="no autodriller with --method time: the top is lowered at the rate of penetration",
        )  # fmt: skip
    if is_quasi_static(case):
        raise CaseError(at="time.mode", got="quasi_static", want="dynamic with --method time")
    if case.top.torque is not None:
        raise CaseError(at="top.torque", want="a rotation with --method time, not a torque")


def point_case(case: Case, speed: float, weight: float, lowering: float | None, duration: float) -> Case:
    """The case of a run that begins with ``START`` of the speed [rad/s] in the static state with a weight on bit [N].

    lowering: of the top [m/s], None: the case's.
    """
    rise = PiecewiseLinear((0.0, RISE), (START * speed, speed))
    top: dict[str, object] = {"rotation": rise}
    if lowering is not None:
        top["lowering"] = Constant(lowering)
    given = case.time or Time(end=duration)
    return case.model_copy(
        update={
            "top": case.top.model_copy(update=top),
            "initial": case.initial.model_copy(update={"from_": "statics", "wob": weight}),
            "time": given.model_copy(update={"end": duration}),
        }
    )


def classify(time: np.ndarray, spin: np.ndarray) -> tuple[float, float, float, str]:
    """Index in the last third of a run and in the one before, share at rest in the last, and behaviour.

    time: (k,) [s], evenly spaced; spin: (k,) speed of the bit [rad/s].
    """
    last, middle = time >= 2 / 3 * time[-1], (time >= time[-1] / 3) & (time <= 2 / 3 * time[-1])
    indices = [stick_slip_index(spin[part], time[part]) for part in (last, middle)]
    # a bit whose mean speed is below 1 rpm has no index: it sticks
    index, before = (np.inf if np.isnan(q) else q for q in indices)
    rest = stuck_share(time[last], spin[last])
    if rest > STUCK or not np.isfinite(index):
        behaviour = "stick_slip"
    elif index < STEADY:
        behaviour = "steady"
    elif index < before:
        behaviour = "decays"
    else:
        behaviour = "stick_slip" if index > LARGE and before > LARGE else "grows"
    return index, before, rest, behaviour


def run_point(
    case: Case, speed: float, weight: float, lowering: float | None, duration: float, comm: PETSc.Comm
) -> RunPoint:
    """Run the case at one speed [rad/s] and weight on bit [N]; collective.  Parameters as of ``point_case``."""
    try:
        with Session(point_case(case, speed, weight, lowering, duration), comm=comm) as session:
            time = np.linspace(0.0, duration, READINGS + 1)
            spin = [session.get("bit_speed")]
            for _ in time[1:]:
                session.step(duration / READINGS)
                spin.append(session.get("bit_speed"))
    except SolveError:
        return RunPoint(speed, weight, np.nan, np.nan, np.nan, "failed")
    return RunPoint(speed, weight, *classify(time, np.array(spin)))
