"""Results of the commands on sensitivities and on uncertain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from drillpetsc.output.summaries.summary import Summary


@dataclass(frozen=True, kw_only=True)
class SensitivitiesSummary(Summary):
    """summary.json of sensitivities."""

    title: Annotated[str, "", "Title of the case."]
    analysis: Annotated[
        str, "", "Command whose outputs are differentiated: statics, roadmap, hydraulics or run."
    ]
    outputs: Annotated[dict[str, float], "", "Values of the outputs at the deepest bit depth [SI], by name."]
    sensitivities: Annotated[
        list[dict[str, Any]],
        "",
        "List: the rows of sensitivities.csv by name, those of the largest relative derivative of each output first.",
    ]
    checked: Annotated[
        list[dict[str, Any]],
        "",
        "List: pairs compared with differences of full solutions: output, key, derivative and difference (relative), error; empty without --check.",
    ]
    cost: Annotated[
        dict[str, float] | None,
        "",
        "Of a run: its steps, and the processor time of its steps with the derivatives (s); with --check also without them (s), and the ratio.",
    ] = None
    skipped: Annotated[dict[str, str], "", "With --all: keys left out, and the reasons."]
    units: Annotated[str, "", "Units of printed and plotted figures; files are in SI."]
    warnings: Annotated[list[str], "", "What makes the numbers doubtful."]
    notes: Annotated[list[str], "", "Omissions of the results, and choices made."]


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
