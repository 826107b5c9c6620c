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
from drillpetsc.output.summaries.sensitivities import SensitivitiesSummary, UncertainSummary
from drillpetsc.output.summaries.statics import StaticsSummary
from drillpetsc.output.summaries.summary import SummaryKey

ROADMAP: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey("model", "", "Model of the string: soft, without bending stiffness."),
    SummaryKey("rows", "-", "Number of rows of roadmap.csv."),
    SummaryKey("rows_not_ok", "-", "Number of rows whose status is not ok."),
    SummaryKey(
        "measured",
        "",
        "Measured points beside the case, by kind of reading: number, bias, rms and largest residual (SI, and over the reading), share in the band.",
        "measured points",
    ),
    SummaryKey("warnings", "", "Unreliable rows, and limits of the rig that are exceeded."),
    SummaryKey(
        "notes", "", "Values assumed because the case did not give them, and omissions of the results."
    ),
)

BY_DEPTH, IN_TIME = "with `--model soft` and `stiff`", "with `--model dynamic`"
CALIBRATE: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey("model", "", "`soft`, `stiff` or `dynamic`: the model of the string."),
    SummaryKey(
        "fit",
        "",
        "By parameter: value, 95 % interval, that of independent errors, SI unit, and status: `determined`, `prior kept`, or "
        "`not determined` with the reason.",
    ),
    SummaryKey("parameters", "", "Names of the parameters, in the order of `correlation`."),
    SummaryKey(
        "correlation", "-", "Matrix of correlations of the parameters; null if one is not determined."
    ),
    SummaryKey(
        "reduced_chi2", "-", "Sum of squares of the weighted residuals over their degrees of freedom."
    ),
    SummaryKey("readings", "-", "Number of readings that were fitted."),
    SummaryKey("errors", "", "`correlated` or `independent`: how the intervals were computed."),
    SummaryKey(
        "correlation_length",
        "",
        "By operation and quantity: readings, correlation length along depth raw and detrended, effective number of readings; null if "
        "errors are independent, as are `block` and `resamples`.",
        BY_DEPTH,
    ),
    SummaryKey("block", "m", "Length of the blocks that the bootstrap draws.", BY_DEPTH),
    SummaryKey("resamples", "-", "Number of resamples of the bootstrap.", BY_DEPTH),
    SummaryKey(
        "drift", "", "Friction factor by windows of depth, its slope, whether it drifts; or null.", BY_DEPTH
    ),
    SummaryKey(
        "hold_out",
        "",
        "By quantity: readings that were predicted, bias, rms, 95th percentile and largest error over the reading, share in the band; null without --hold-out.",
        BY_DEPTH,
    ),
    SummaryKey(
        "next_readings",
        "",
        "Readings that would determine what is not determined: operation, bit depth in m, quantity, and half widths of the intervals "
        "expected with it and those before it; empty if nothing is missing, or no readings would do.",
        BY_DEPTH,
    ),
    SummaryKey(
        "correlation_time",
        "",
        "By column: readings, time over which errors are alike, effective number of readings; null if errors are "
        "independent.",
        IN_TIME,
    ),
    SummaryKey(
        "misfit",
        "-",
        "By column: rms of computed less read, over the scatter of the log from row to row.",
        IN_TIME,
    ),
    SummaryKey(
        "next_columns",
        "",
        "A further column that would determine what is not determined, and half widths of the intervals expected with it; empty if nothing "
        "is missing, or no column would do.",
        IN_TIME,
    ),
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
    "summary.json of sensitivities": SensitivitiesSummary.described(),
    "summary.json of uncertain": UncertainSummary.described(),
    "summary.json of hydraulics": HydraulicsSummary.described(),
    "summary.json of surge": SurgeSummary.described(),
    "summary.json of roadmap": ROADMAP,
    "summary.json of limits": LimitsSummary.described(),
    "summary.json of calibrate": CALIBRATE,
}
