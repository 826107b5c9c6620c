"""Columns of the commands `sensitivities` and `uncertain`, whose rows have the unit of their output, a column."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.hydraulics import BIT_DEPTH


def _row(name: str, label: str, mnemonic: str, doc: str) -> Quantity:
    return Quantity(name, "-", kind="none", on="item", label=label, mnemonic=mnemonic, doc=doc)


SENSITIVITIES: tuple[Quantity, ...] = (
    _row("output", "Output", "SOUT", "Output; of a roadmap with its operation, trip_out.hook_load."),
    _row("output_unit", "Unit of the output", "SOUN", "SI unit of the output."),
    BIT_DEPTH,
    _row("value", "Value of the output", "SVAL", "Value of the output in the case [SI]."),
    _row("key", "Key", "SKEY", "Path of the number in the case."),
    _row(
        "key_unit",
        "Unit of the key",
        "SKUN",
        "SI unit of the key; of a key that only the file has, the unit there.",
    ),
    _row("key_value", "Value of the key", "SKVL", "Value of the key in the case, in its unit."),
    _row(
        "derivative",
        "Derivative",
        "SDER",
        "Change of the output over the change of the key, in the units of both.",
    ),
    _row(
        "relative",
        "Relative derivative",
        "SREL",
        "Share of change of the output over the share of change of the key; empty if one of them is zero.",
    ),
    _row(
        "per",
        "Stated change",
        "SPER",
        "Change of the key for which the effect is stated: 0.05 of friction, 1 % of others.",
    ),
    _row("effect", "Effect", "SEFF", "Derivative times the stated change."),
    _row(
        "effect_below",
        "Effect below",
        "SEFB",
        "Of a flagged row: value less that of a full solution with the stated change taken away.",
    ),
    _row(
        "effect_above",
        "Effect above",
        "SEFA",
        "Of a flagged row: value of a full solution with the stated change, less the value.",
    ),
    _row("flag", "Flag", "SFLG", "One-sided, limit, not determined or differences; empty without a flag."),
)

#: after the time; OUTPUT and KEY stand for the names of both
SENSITIVITIES_OVER_TIME: tuple[Quantity, ...] = (
    _row(
        "OUTPUT",
        "Output over time",
        "SOTM",
        "Column of history.csv, with its name and unit, at ends of steps.",
    ),
    _row(
        "OUTPUT by KEY",
        "Change by a key",
        "SBYK",
        "Derivative of the column by the key, times the value of the key or, if that is zero, its usual size; in the unit of the column.",
    ),
)


_SHARED = {q.name: q for q in SENSITIVITIES}


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
