"""The error of a survey as a smooth random path, in independent standard normal numbers.

A survey is wrong by angles that change slowly along the hole, as the tool, its sag and the field's model do. Errors that are
independent from station to station would add a dogleg to every course length, and with it side force that the hole does not have.
The angles are Gaussian processes with covariance sd^2 exp(-(s - s')^2 / (2 length^2)). Their eigenvectors at the stations, scaled
(Karhunen-Loeve; Ghanem and Spanos 1991, section 2.3), turn them into few numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.uncertain import SurveyError
from drillpetsc.case.blocks.well import Survey
from drillpetsc.errors import CaseError
from drillpetsc.geometry.trajectory import angles, dogleg
from drillpetsc.geometry.well import direction

KEPT = 0.999  # of the variance, by the eigenvectors that are kept
STRAIGHT = 1e-9  # [rad]
MOST_STATIONS = 4000
PER_LENGTH = 4  # stations in a correlation length, at least


@dataclass(frozen=True)
class SurveyPath:
    """Survey of a case with an error.

    md: (n,) depths of the stations and of others between them [m]; tangent: (n, 3) there, without an error.
    frame: (n, 2, 3) unit vectors across the hole; modes: (k, n, 2) angles [rad] along them for each number.
    """

    survey: Survey
    md: FloatArray
    tangent: FloatArray
    frame: FloatArray
    modes: FloatArray

    def at(self, numbers: Sequence[float]) -> Survey:
        """The survey for standard normal numbers (k,)."""
        turn = np.tensordot(np.asarray(numbers, dtype=float), self.modes, axes=1)
        turned = self.tangent + np.einsum("ni,nij->nj", turn, self.frame)
        incl, azim = angles(turned / np.linalg.norm(turned, axis=1, keepdims=True))
        named = {"md": self.md, "inclination": incl, "azimuth": azim}
        return self.survey.model_copy(update={name: tuple(q.tolist()) for name, q in named.items()})


def survey_path(survey: Survey, error: SurveyError) -> SurveyPath:
    """The error of a survey, with more stations on the arcs where they are far apart."""
    given = np.asarray(survey.md, dtype=float)
    ends = direction(np.asarray(survey.inclination), np.asarray(survey.azimuth))
    pieces = np.ceil(np.diff(given) * PER_LENGTH / error.length).astype(int)
    if pieces.sum() > MOST_STATIONS:
        want = (
            f"at least {given[-1] * PER_LENGTH / MOST_STATIONS:.3g} m, for at most {MOST_STATIONS} stations"
        )
        raise CaseError(at="uncertain.well.survey.path.length", got=f"{error.length:g} m", want=want)
    share = np.concatenate([np.arange(n) / n for n in pieces] + [[1.0]])
    above = np.append(np.repeat(np.arange(len(pieces)), pieces), len(pieces) - 1)
    md = given[above] + share * np.diff(given)[above]
    tangent = _on_arc(ends[above], ends[above + 1], share)
    covariance = np.exp(-0.5 * ((md[:, None] - md) / error.length) ** 2)
    values, vectors = np.linalg.eigh(covariance)
    values, vectors = np.maximum(values[::-1], 0.0), vectors[:, ::-1]
    count = int(np.searchsorted(np.cumsum(values), KEPT * len(md))) + 1
    shapes = (vectors[:, :count] * np.sqrt(values[:count])).T
    still = np.zeros_like(shapes)
    modes = [np.stack([error.inclination * shapes, still], axis=-1)] if error.inclination else []
    modes += [np.stack([still, error.lateral * shapes], axis=-1)] if error.lateral else []
    return SurveyPath(survey, md, tangent, _frame(tangent), np.concatenate(modes))


def _on_arc(start: FloatArray, end: FloatArray, share: FloatArray) -> FloatArray:
    """(n, 3) tangents on circular arcs between directions (n, 3), at shares (n,) of their lengths."""
    turn = dogleg(start, end)
    safe = np.where(turn > STRAIGHT, turn, 1.0)
    first = np.where(turn > STRAIGHT, np.sin((1 - share) * safe) / np.sin(safe), 1 - share)
    second = np.where(turn > STRAIGHT, np.sin(share * safe) / np.sin(safe), share)
    between = first[:, None] * start + second[:, None] * end
    return np.asarray(between / np.linalg.norm(between, axis=1, keepdims=True))


def _frame(tangent: FloatArray) -> FloatArray:
    """(n, 2, 3) unit vectors across the hole: to a larger inclination, and to the right, where the hole is most inclined.

    From there they are carried along without twist. Those of each station would turn with an azimuth that a hole close to the vertical hardly has.
    """
    incl, azim = angles(tangent)
    middle = int(np.argmin(np.abs(incl - np.pi / 2)))
    out = np.empty((len(tangent), 2, 3))
    out[middle] = (
        direction(incl[middle] + np.pi / 2, azim[middle]),
        direction(np.pi / 2, azim[middle] + np.pi / 2),
    )
    for places in (range(middle + 1, len(tangent)), range(middle - 1, -1, -1)):
        before = middle
        for i in places:
            both = tangent[before] + tangent[i]
            lean = out[before] @ tangent[i] / (1 + tangent[before] @ tangent[i])
            out[i] = out[before] - lean[:, None] * both
            before = i
    return out
