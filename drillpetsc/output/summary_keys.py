"""Keys of summary.json that are not quantities of the model: counts, times, balances, settings.

Plain descriptions, like ``drillpetsc.output.quantities``.  ``tests/unit/output/test_catalogue.py`` compares them with
the files that the commands write.
"""

from __future__ import annotations

from drillpetsc.output.summaries.flow import HydraulicsSummary, SurgeSummary
from drillpetsc.output.summaries.linear import (
    CampbellSummary,
    ModesSummary,
    ResponseSummary,
    StabilitySummary,
)
from drillpetsc.output.summaries.loads import LimitsSummary
from drillpetsc.output.summaries.run import RunSummary
from drillpetsc.output.summaries.statics import StaticsSummary
from drillpetsc.output.summaries.summary import SummaryKey

ROADMAP: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey("model", "", "Model of the string: soft, without bending stiffness."),
    SummaryKey("rows", "-", "Number of rows of roadmap.csv."),
    SummaryKey("rows_not_ok", "-", "Number of rows whose status is not ok."),
    SummaryKey("warnings", "", "Unreliable rows, and limits of the rig that are exceeded."),
    SummaryKey(
        "notes", "", "Values assumed because the case did not give them, and omissions of the results."
    ),
)

CALIBRATE: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey(
        "fit",
        "",
        "By parameter: value, 95 % interval, and status: `determined`, or `not determined` with the reason; block weight in N.",
    ),
    SummaryKey("parameters", "", "Names of the parameters, in the order of `correlation`."),
    SummaryKey(
        "correlation", "-", "Matrix of correlations of the parameters; null if one is not determined."
    ),
    SummaryKey(
        "reduced_chi2", "-", "Sum of squares of the weighted residuals over their degrees of freedom."
    ),
    SummaryKey("readings", "-", "Number of hook loads and torques that were fitted."),
    SummaryKey("warnings", "", "Why a result is unreliable."),
    SummaryKey("notes", "", "Assumptions, and omissions of the model."),
)

#: keys by file, as the catalogue names the files
SUMMARY_KEYS = {
    "summary.json of run": RunSummary.described(),
    "summary.json of statics": StaticsSummary.described(),
    "summary.json of modes": ModesSummary.described(),
    "summary.json of campbell": CampbellSummary.described(),
    "summary.json of stability": StabilitySummary.described(),
    "summary.json of response": ResponseSummary.described(),
    "summary.json of hydraulics": HydraulicsSummary.described(),
    "summary.json of surge": SurgeSummary.described(),
    "summary.json of roadmap": ROADMAP,
    "summary.json of limits": LimitsSummary.described(),
    "summary.json of calibrate": CALIBRATE,
}
