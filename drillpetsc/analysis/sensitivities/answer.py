"""What the command `sensitivities` answers: summary.json, sensitivities.csv and what is printed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drillpetsc.analysis.sensitivities.derivatives import ONE_SIDED, Derivative
from drillpetsc.analysis.sensitivities.doubts import Checked, Differentiated
from drillpetsc.case.case import Case
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.doubt import CaseMoment
from drillpetsc.output.files.json_file import plain
from drillpetsc.output.files.run_folder import SENSITIVITIES_TABLE
from drillpetsc.output.shown_units import key_unit, shown_unit

SHOWN = 15  # keys printed for an output


@dataclass(frozen=True)
class Answer:
    """Derivatives of the outputs of an analysis, and how they were checked.

    values: of the outputs, by name; skipped: reasons of keys left out; left_out: of rows without derivatives, by bit depth [m].
    """

    case: Case
    analysis: str
    values: dict[str, float]
    found: Sequence[Derivative]
    compared: Sequence[Checked]
    skipped: dict[str, str]
    left_out: dict[float, str] = field(default_factory=dict)
    cost: dict[str, float] | None = None

    @property
    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """The table sensitivities.csv."""
        return {SENSITIVITIES_TABLE: [row_of(d) for d in self.found]}

    def summary(self, moments: Sequence[CaseMoment], notes: Sequence[str] = ()) -> dict[str, Any]:
        """The data of summary.json; moments: at which warnings may be due."""
        effective = {d.key.name for d in self.found if d.slope}
        keys = {d.key.name: d.key for d in self.found}
        differentiated = Differentiated(
            self.case,
            self.analysis,
            any(ONE_SIDED in d.flag for d in self.found),
            [name for name in keys if name not in effective],
            self.left_out,
            [name for name, key in keys.items() if key.unit == "m3/s" and not key.value],
        )
        return {
            "title": self.case.title,
            "analysis": self.analysis,
            "outputs": self.values,
            "sensitivities": plain([row_of(d) for d in self.found]),
            "checked": plain([row_of_check(at) for at in self.compared]),
            "cost": self.cost,
            "skipped": self.skipped,
            "units": self.case.shown_units,
            "warnings": [sentence for at in moments for sentence in doubts_at(at)],
            "notes": [*notes, *doubts_at(differentiated)],
        }

    def lines(self, by: str) -> list[str]:
        """What is printed, in the units of the case; by: what the derivatives were checked with."""
        system = self.case.shown_units
        of = "a run" if self.analysis == "run" else self.analysis
        lines = [f"{self.case.title or 'case'}: sensitivities of {of}, effect of a change of each key"]
        deepest = max((d.output.bit_depth for d in self.found), default=np.nan)
        for output in dict.fromkeys(d.output for d in self.found):
            if output.bit_depth == output.bit_depth and output.bit_depth != deepest:
                continue
            own = [d for d in self.found if d.output == output]
            mine = sorted((d for d in own if d.slope and np.isfinite(d.slope)), key=lambda d: -abs(d.effect))
            size, unit = shown_unit(output.quantity.name, output.quantity.unit, system)
            lines.append(f"  {output.name} {own[0].value / size:.6g} {unit}".rstrip())
            for d in mine[:SHOWN]:
                step, word = key_unit(d.key.name, d.key.unit, system)
                change = f"{d.key.value / step:.6g} + {d.key.per / step:.3g} {word}".rstrip()
                relative = "" if np.isnan(d.relative) else f"{d.relative:.3f}"
                lines.append(
                    f"    {d.key.name:<40} {change:<28} {d.effect / size:>+12.5g} {unit:<6} {relative:>10}  {d.flag}".rstrip()
                )
            if len(mine) > SHOWN:
                lines.append(f"    and {len(mine) - SHOWN} keys of less effect in sensitivities.csv")
        if self.compared:
            worst = np.nan_to_num([at.error for at in self.compared], nan=np.inf).max()
            lines.append(f"  {len(self.compared)} derivatives checked by {by}: largest error {worst:.1e}")
        if self.skipped:
            lines.append(f"  note: {len(self.skipped)} keys left out, with reasons in summary.json")
        return lines


def row_of(d: Derivative) -> dict[str, Any]:
    """A row of sensitivities.csv."""
    return {
        "output": d.output.name,
        "output_unit": d.output.quantity.unit,
        "bit_depth": d.output.bit_depth,
        "value": d.value,
        "key": d.key.name,
        "key_unit": d.key.unit or "-",
        "key_value": d.key.value,
        "derivative": d.slope,
        "relative": d.relative,
        "per": d.key.per,
        "effect": d.effect,
        "effect_below": d.below,
        "effect_above": d.above,
        "flag": d.flag,
    }


def row_of_check(at: Checked) -> dict[str, Any]:
    """A derivative and its difference, for summary.json."""
    return {
        "output": at.output,
        "key": at.key,
        "derivative": at.derivative,
        "difference": at.difference,
        "error": at.error,
    }
