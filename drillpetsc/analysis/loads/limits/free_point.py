"""The `freepoint` command: how much of a stuck string is free, from its stretch under a pull.

A free length stretches by the integral of F/EA. Rigid items do not stretch. Friction in the hole is left out; it
makes the free length look shorter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.case.case import Case
from drillpetsc.case.options.free_point_options import Pair
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.model.mesh import build_mesh
from drillpetsc.unit_systems import System, shown

ROUNDING = 1e-9


@dataclass(frozen=True)
class FreePoint:
    """Free length of a stuck string.

    stretch [m], pull [N]: measured. length: of free pipe below the top [m]; None where all of it is free and more.
    item: in which it ends.
    whole: stretch of the whole string under that pull [m].
    """

    stretch: float
    pull: float
    length: float | None
    item: str | None
    whole: float


def free_point(case: Case, pair: Pair, mesh: StringMesh | None = None) -> FreePoint:
    """Find the free length for a stretch under a pull, from the stretch of each item of the string.

    mesh: of the case, None: it is made.
    """
    mesh = build_mesh(case) if mesh is None else mesh
    cells = np.flatnonzero(~mesh.is_joint)
    stretches = pair.pull * (mesh.lower[cells] - mesh.upper[cells]) / mesh.axial_stiffness[cells]
    below = np.cumsum(stretches)
    whole = float(below[-1])
    if pair.stretch > whole * (1 + ROUNDING):
        return FreePoint(pair.stretch, pair.pull, None, None, whole)
    k = min(int(np.searchsorted(below, pair.stretch)), len(cells) - 1)
    share = 1 - (below[k] - pair.stretch) / stretches[k]
    cell = cells[k]
    length = float(mesh.upper[cell] + min(share, 1.0) * (mesh.lower[cell] - mesh.upper[cell]))
    return FreePoint(pair.stretch, pair.pull, length, case.string[int(mesh.item[cell])].name, whole)


def slope(pairs: Sequence[Pair]) -> Pair | None:
    """The line through several pairs as one pair: rise of the stretch for the span of pulls; None for one pull alone.

    A constant share of friction, or a wrong zero, drops out of it.  None also where the stretch does not rise.
    """
    pulls, stretches = np.array([p.pull for p in pairs]), np.array([p.stretch for p in pairs])
    span = float(np.ptp(pulls))
    if span <= ROUNDING * float(pulls.max(initial=0.0)):
        return None
    rise = float(np.polyfit(pulls - pulls.mean(), stretches, 1)[0]) * span
    return Pair(rise, span) if rise > 0 else None


class FreePoints(dict[str, Any]):
    """``pairs``: the result of each pair; ``slope``: that of the line through all of them, None for one pull.

    lines: report for the screen.
    """

    lines: list[str]


def free_points(case: Case, pairs: Sequence[Pair]) -> FreePoints:
    """Find the free lengths for some pairs, and for the line through them."""
    mesh, line = build_mesh(case), slope(pairs)
    found = FreePoints(
        pairs=[free_point(case, pair, mesh) for pair in pairs],
        slope=None if line is None else free_point(case, line, mesh),
    )
    found.lines = _lines(case, found, case.shown_units)
    return found


def _lines(case: Case, found: FreePoints, units: System) -> list[str]:
    lines = [
        f"{case.title or 'case'}: free point of a stuck string of {shown(case.string_length, 'length', units, 5)}"
    ]

    def text(row: FreePoint) -> str:
        if row.length is None:
            whole = shown(row.whole, "diameter", units)
            return f"more than the whole string would stretch, {whole}: it is free to its lower end, or a figure is wrong"
        return f"free to {shown(row.length, 'length', units, 5)} below the top ({row.item})"

    def given(row: FreePoint) -> str:
        return f"{shown(row.stretch, 'diameter', units)} under {shown(row.pull, 'force', units)}"

    rows, line = found["pairs"], found["slope"]
    lines += [f"  {given(row)}: {text(row)}" for row in rows]
    if isinstance(line, FreePoint):
        lines.append(f"  line through them, {given(line)}: {text(line)}")
    elif len(rows) > 1:
        lines.append(
            "  WARNING: no line through them: the pulls are the same, or the stretch does not rise with the pull"
        )
    lines.append(
        "  note: friction in the hole makes the free length look shorter; pull beyond the weight of the free string"
    )
    return lines
