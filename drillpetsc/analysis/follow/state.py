"""What is estimated while a rig is followed, and how far each of it may wander (manual: sec-follow-states)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from drillpetsc.analysis.follow.sigma_points import Belief
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.units import to_si

STAND = 30.0  # three joints of pipe [m]
LENGTH = 15.0  # along which an error of readings is alike: half a stand [m]
HOOK, TORQUE = "hook_error", "torque_error"
PER_STAND = 1 / np.sqrt(STAND)


@dataclass(frozen=True)
class State:
    """A number that is estimated.

    mean, sd: before any reading; walk: standard deviation of its change per square root of a metre [1/sqrt(m)].
    length: along which it is forgotten [m], None for one that is kept.  The sizes are those of manual: sec-follow-states.
    """

    name: str
    mean: float
    sd: float
    walk: float = 0.0
    length: float | None = None


def states_of(factors: Mapping[str, float], block: float, bit_torque: float) -> tuple[State, ...]:
    """The states of a string; those that it is integrated with come first, so that sigma points of the others leave it as it is.

    factors: group of the hole -> its friction factor in the case; block: weight [N]; bit_torque: torque over weight on bit [m].
    """
    return (
        # a casing stays as it is; an open hole changes as it is drilled and stands open
        *(
            State(name, mu, 0.05) if name == "cased" else State(name, mu, 0.1, 0.002)
            for name, mu in factors.items()
        ),
        State("weight_factor", 1.0, 0.02, 0.004 * PER_STAND),
        State("bit_torque", bit_torque, 0.5 * bit_torque, 0.02 * bit_torque),
        State("block_weight", block, to_si("30 kN", "N"), to_si("0.05 kN", "N")),
        State("running_drag", 5e4, 5e4, 15e3 * PER_STAND),
        State(HOOK, 0.0, to_si("6 kN", "N"), length=LENGTH),
        State(TORQUE, 0.0, 0.035, length=LENGTH),
    )


def with_priors(states: Sequence[State], priors: Mapping[str, tuple[float, float]]) -> tuple[State, ...]:
    """The states with (mean, standard deviation) of some; CaseError for a name that is not a state."""
    names = [q.name for q in states]
    for name in priors:
        if name not in names:
            raise CaseError(at="--prior", got=name, want=f"one of {', '.join(names)}")
    return tuple(
        replace(q, mean=priors[q.name][0], sd=priors[q.name][1]) if q.name in priors else q for q in states
    )


def first_belief(states: Sequence[State]) -> Belief:
    """The belief before any reading."""
    return Belief(np.array([q.mean for q in states]), np.diag([q.sd**2 for q in states]))


def walked(states: Sequence[State], belief: Belief, distance: float) -> Belief:
    """The belief after the bit has moved a distance [m] without readings.

    Between readings P grows by q^2 |dMD|; an error of readings keeps the share exp(-|dMD|/length), and its variance stays.
    """
    keep = np.array([1.0 if q.length is None else np.exp(-distance / q.length) for q in states])
    away = np.array([q.walk**2 * distance if q.length is None else q.sd**2 for q in states])
    fresh: FloatArray = np.where([q.length is None for q in states], away, away * (1 - keep**2))
    return Belief(keep * belief.mean, np.outer(keep, keep) * belief.covariance + np.diag(fresh))
