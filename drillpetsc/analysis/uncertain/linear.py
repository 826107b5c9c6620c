"""Derivatives of outputs by the uncertain numbers, for the linear method."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.sensitivities.command import Question, solved
from drillpetsc.analysis.sensitivities.derivatives import ONE_SIDED, derivatives
from drillpetsc.analysis.uncertain.responses import Response
from drillpetsc.analysis.uncertain.uncertain_keys import Uncertain
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case

#: of the differences by the weight factor and by a number of the path, a standard deviation of it, which are not keys
FACTOR_STEP, PATH_STEP = 1e-4, 0.1


def slopes_of(
    case: Case, analysis: str, response: Response, keys: Sequence[Uncertain], comm: PETSc.Comm
) -> tuple[FloatArray, list[str]]:
    """(m, k) derivatives of the outputs, nan where there is none; and the keys with a kink beside the case's value (collective)."""
    solution = solved(case, Question(analysis, (), (), depths="all"), comm)
    places = {output: i for i, output in enumerate(solution.outputs)}
    at = [places.get(output, -1) for output in response.outputs]
    chosen = sorted({i for i in at if i >= 0})
    slopes, kinks = np.full((len(at), len(keys)), np.nan), []
    for k, key in enumerate(keys):
        if not key.keys:
            slopes[:, k] = _by_differences(response, keys, k)
            continue
        each = [
            dict(zip(chosen, derivatives(case, solution, chosen, [one]), strict=True)) for one in key.keys
        ]
        slopes[:, k] = [sum(found[i].slope for found in each) if i in each[0] else np.nan for i in at]
        if any(d.flag.startswith(ONE_SIDED) for found in each for d in found.values()):
            kinks.append(key.name)
    return slopes, kinks


def _by_differences(response: Response, keys: Sequence[Uncertain], k: int) -> FloatArray:
    """(m,) derivatives by the weight factor, or by a number of the survey's path."""
    step = FACTOR_STEP if keys[k].path is None else PATH_STEP
    points = np.tile([key.value for key in keys], (2, 1))
    points[:, k] += np.array([-1.0, 1.0]) * step
    below, above = response.values(points)
    return np.asarray((above - below) / (2 * step))
