"""Columns of sensitivities.csv.  Their units follow from the output and the key of the row, whose units are columns."""

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
