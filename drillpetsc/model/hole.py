"""From the `well` block of a case to the hole."""

from __future__ import annotations

import numpy as np

from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.geometry.well import Well


def build_well(case: Case) -> Well | None:
    """Create the hole of the case, None without one; CaseError where the geometry is impossible."""
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


def hole_depth(case: Case) -> float:
    """Measured depth of the end of the hole [m]: the last survey station."""
    return float(case.well.survey.md[-1])  # type: ignore[union-attr]
