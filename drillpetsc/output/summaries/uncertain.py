"""Result of the command on uncertain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from drillpetsc.output.summaries.summary import Summary


@dataclass(frozen=True, kw_only=True)
class UncertainSummary(Summary):
    """summary.json of uncertain."""

    title: Annotated[str, "", "Title of the case."]
    analysis: Annotated[str, "", "Command whose outputs are meant: roadmap or hydraulics."]
    method: Annotated[str, "", "Method: linear, monte-carlo or both."]
    samples: Annotated[int, "", "Number of samples."]
    seed: Annotated[int, "", "Seed of the samples."]
    levels: Annotated[list[float], "", "Probabilities of the quantiles."]
    keys: Annotated[
        list[dict[str, Any]], "", "List: uncertain numbers with unit, value and distribution [SI]."
    ]
    failed: Annotated[int, "", "Most samples in which an output has no value."]
    measured: Annotated[
        list[dict[str, Any]],
        "",
        "List: measured values between rows of a roadmap, the lowest and highest quantile there [SI], and whether the value lies between.",
    ]
    units: Annotated[str, "", "Units of printed and plotted figures; files are in SI."]
    warnings: Annotated[list[str], "", "What makes the numbers doubtful."]
    notes: Annotated[list[str], "", "Omissions of the results, and choices made."]
