"""Columns of uncertain.csv, uncertain_limits.csv and uncertain_shares.csv.  The unit of the numbers of a row is that of its output, a column."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.hydraulics import BIT_DEPTH
from drillpetsc.output.quantities.sensitivities import SENSITIVITIES

_SHARED = {q.name: q for q in SENSITIVITIES}


def _row(name: str, label: str, mnemonic: str, doc: str) -> Quantity:
    return Quantity(name, "-", kind="none", on="item", label=label, mnemonic=mnemonic, doc=doc)


_METHOD = _row("method", "Method", "UMET", "Linear or Monte Carlo.")
UNCERTAIN: tuple[Quantity, ...] = (
    _SHARED["output"],
    _SHARED["output_unit"],
    BIT_DEPTH,
    _METHOD,
    _SHARED["value"],
    _row("mean", "Mean", "UMEA", "Mean over the samples [SI]."),
    _row("deviation", "Standard deviation", "UDEV", "Standard deviation over the samples [SI]."),
    _row("failed", "Failed samples", "UFAI", "Samples in which the output has no value."),
    _row("probability", "Probability", "UPRO", "Share of samples below the quantile."),
    _row("quantile", "Quantile", "UQUA", "Value of the output below which that share of samples lies [SI]."),
)
UNCERTAIN_LIMITS: tuple[Quantity, ...] = (
    _SHARED["output"],
    _SHARED["output_unit"],
    BIT_DEPTH,
    _METHOD,
    _row("limit", "Limit", "ULIM", "Value of the output that should not be passed [SI]."),
    _row("meaning", "Meaning", "UMNG", "What it means that the limit is passed."),
    _row(
        "beyond",
        "Probability of passing",
        "UBEY",
        "Share of the samples with a solution that pass the limit.",
    ),
)
UNCERTAIN_SHARES: tuple[Quantity, ...] = (
    _SHARED["output"],
    BIT_DEPTH,
    _METHOD,
    _SHARED["key"],
    _row(
        "share",
        "Share of the variance",
        "USHA",
        "Share of the key in the variance of the output, by its linear part; of correlated keys it may be negative.",
    ),
)
