"""From the `well` block of a case to the hole."""

from __future__ import annotations

import numpy as np

from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.geometry.well import StraightAxis, Well, direction

ROUNDING = 1e-9  # difference of two lengths that is none [m]


def build_well(case: Case) -> Well | None:
    """Create the hole of the case, None without one; CaseError if the geometry is impossible."""
    if case.well is None:
        return None
    survey, sections = case.well.survey, case.well.sections
    try:
        return Well.from_survey(
            np.array(survey.md),
            np.array(survey.inclination),
            np.array(survey.azimuth),
            [q.to for q in sections],
            [0.5 * q.diameter for q in sections],
            [q.friction for q in sections],
            [q.kind for q in sections],
        )
    except ValueError as error:
        raise CaseError(at="well", want=str(error)) from None


def axis_of(case: Case, well: Well | None) -> Well | StraightAxis:
    """The axis along which the unstrained string lies: of the hole, or the initial direction of a case without one."""
    return well or StraightAxis(np.zeros(3), direction(case.initial.inclination, case.initial.azimuth))


def top_of_string(case: Case, length: float) -> float:
    """Measured depth [m] of the top of the unstrained string of this ``length`` [m] in statics.

    A string with a weight on bit is lowered onto the bottom of its hole, which may be deeper than the string is
    long.
    """
    if case.well is None or case.initial.wob is None:
        return 0.0
    depth = hole_depth(case) - length
    return depth if abs(depth) > ROUNDING else 0.0


def hole_depth(case: Case) -> float:
    """Measured depth of the end of the hole [m]: the last survey station."""
    return float(case.given_well.survey.md[-1])
