"""Doubts about quantiles of uncertain outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.sensitivities.solution import Output
from drillpetsc.analysis.uncertain.spread import Spreads
from drillpetsc.case.blocks.uncertain import SURVEY
from drillpetsc.doubts.doubt import CaseMoment, Values, doubt, remark

FAR = (
    0.1  # difference of a quantile by two methods, over the distance of the outer quantiles, that is reported
)
CROOKED = np.radians(0.25) / 30  # rms dogleg of the error of a survey that is reported [rad/m]


@dataclass(frozen=True)
class Drawn(CaseMoment):
    """Quantiles of outputs are found from samples (uncertain).

    levels: their probabilities; found: statistics by each method; kinks: keys with a kink beside the case's value.
    """

    levels: Sequence[float]
    outputs: Sequence[Output]
    found: Sequence[Spreads]
    kinks: Sequence[str]
    samples: int


@doubt(
    "{output}: {failed} of {samples} samples have no solution, and the quantiles are from the others",
    "Narrow the distributions of `uncertain`, or read the share of failed samples as the probability of failing.",
)
def samples_failed(at: Drawn) -> Values:
    """Some samples have no solution: a number outside its limits, no steady flow, or a string that cannot carry its weight on bit."""
    spread = at.found[0]
    worst = int(np.argmax(spread.failed)) if len(spread.failed) else 0
    if len(spread.failed) and spread.failed[worst]:
        failed = int(spread.failed[worst])
        yield {"output": at.outputs[worst].label, "failed": failed, "samples": at.samples}


@doubt(
    "the error of well.survey has doglegs of {rate:dogleg 3} (rms), which raise torque and drag in the mean; "
    "give a longer path.length, usually 100 to 300 m",
    "Give a longer `path.length`, or smaller deviations.",
)
def crooked_survey(at: Drawn) -> Values:
    """The error of the survey has doglegs of its own: the rms of the error's slope is above 0.25 degrees in 30 m.

    Doglegs add side force whatever their direction, so that torque and drag grow in the mean.  A survey's error has none of this size.
    """
    error = (at.case.uncertain or {})[SURVEY].path if SURVEY in (at.case.uncertain or {}) else None
    rate = 0.0 if error is None else float(np.hypot(error.inclination, error.lateral)) / error.length
    return rate > CROOKED and {"rate": rate}


@doubt(
    "linear and Monte Carlo quantiles of {output} differ by {share:.0f} % of the distance from P{low:.4g} to P{high:.4g}: "
    "the output is not linear in the uncertain numbers",
    "Use Monte Carlo.",
    weight="remark",
)
def methods_differ(at: Drawn) -> Values:
    """Linear quantiles differ from those of the samples by more than a tenth of the distance of the outer quantiles."""
    if len(at.found) < 2 or len(at.levels) < 2:
        return
    sampled, linear = (spread.quantiles for spread in at.found[:2])
    width = sampled[:, -1] - sampled[:, 0]
    apart = np.abs(linear - sampled).max(axis=1)
    share = np.divide(apart, width, out=np.zeros_like(apart), where=width > 0)
    worst = int(np.argmax(np.nan_to_num(share)))
    if share[worst] > FAR:
        low, high = 100 * at.levels[0], 100 * at.levels[-1]
        yield {"output": at.outputs[worst].label, "share": 100 * share[worst], "low": low, "high": high}


remark(
    Drawn,
    "a contact, a buckling state or a regime changes beside the case's value of {names}: the linear method holds on one side only",
    lambda at: at.kinks and {"names": ", ".join(at.kinks)},
)
