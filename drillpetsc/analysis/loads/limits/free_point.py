"""The `freepoint` command: how much of a stuck string is free, from its stretch under a pull (manual: sec-guide-freepoint).

A free length stretches by the integral of F/EA, where F is what friction in the hole leaves of the pull.  All of the free string
slides up.  F at a depth therefore does not depend on where the string is stuck below it, and is that of a string held at its lower end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.loads.limits.table import Choices, Strength
from drillpetsc.analysis.statics.equilibrium import MOTIONS
from drillpetsc.analysis.statics.start.soft_string import TorqueDrag
from drillpetsc.analysis.statics.start.soft_string_start import soft_string
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.case.options.free_point_options import Pair
from drillpetsc.model.drilling_model import build_model
from drillpetsc.physics.roots import bracketed_root
from drillpetsc.unit_systems import System, shown

ROUNDING = 1e-9
FELT = 1e-3  # share of the pull; if friction takes more, the length without friction is told as well


@dataclass(frozen=True)
class FreePoint:
    """Free length of a stuck string.

    stretch [m], pull [N]: measured. length: of free pipe below the top [m]; None if all of it is free and more.
    item: in which it ends.
    arrives: share of the pull that friction leaves there [-].
    frictionless: the length without friction in the hole [m]; None if all of it would be free.
    whole: stretch of the whole string under that pull [m].
    """

    stretch: float
    pull: float
    length: float | None
    item: str | None
    arrives: float
    frictionless: float | None
    whole: float


class StuckString:
    """A string that is pulled at its top, all of it sliding up; its lower end is held."""

    def __init__(self, case: Case) -> None:
        self.model = build_model(case, PETSc.COMM_SELF)
        mesh = self.model.mesh
        self.cells = cells = np.flatnonzero(~mesh.is_joint)
        self.upper, self.lower = mesh.upper[cells], mesh.lower[cells]
        #: (n,) stretch of each element over the force in it [m/N]; a rigid item has none
        self.compliance = (self.lower - self.upper) / mesh.axial_stiffness[cells]
        self.names = [case.string[i].name for i in mesh.item[cells]]
        self.free = self._held(0.0)

    def _held(self, pull: float) -> TorqueDrag | None:
        """The string with a pull at its lower end [N]; None without a hole that it touches."""
        return soft_string(self.model, MOTIONS["hoist"], -pull)

    def rise(self, pull: float) -> FloatArray:
        """Rise of the tension in each element (n,) when the hook load rises by ``pull`` over the pick-up weight [N]."""
        free = self.free
        if free is None or pull == 0.0:
            return np.full(len(self.compliance), pull)

        def more(at_end: float) -> FloatArray:
            held = self._held(at_end)
            assert held is not None
            return np.asarray(held.axial_force - free.axial_force)

        # friction grows with the tension, so less arrives at the end than is pulled
        at_end = bracketed_root(
            lambda f: float(more(f)[0]) - pull, 0.0, pull * (1 + 1e-6), 1e-9 * pull, 1e-12
        )
        depth, found = free.md - free.md[0], more(at_end)
        return 0.5 * (np.interp(self.upper, depth, found) + np.interp(self.lower, depth, found))

    def overloaded(self, pull: float) -> str | None:
        """The uppermost item that a ``pull`` [N] over the pick-up weight loads beyond its tension limit; None without one."""
        tension = self.rise(pull)
        if self.free is not None:
            tension = tension + np.interp(self.upper, self.free.md - self.free.md[0], self.free.axial_force)
        over = np.flatnonzero(tension > Strength(self.model, Choices()).tension_limit[self.cells])
        return self.names[over[0]] if len(over) else None

    def find(self, stretch: float, low: float, high: float) -> FreePoint:
        """Free length for the ``stretch`` [m] between two pulls [N]."""
        pull, force = high - low, self.rise(high) - self.rise(low)
        frictionless, _ = self._length(np.full(len(force), pull), stretch)
        length, cell = self._length(force, stretch)
        item = None if length is None else self.names[cell]
        whole = float(force @ self.compliance)
        return FreePoint(stretch, pull, length, item, float(force[cell]) / pull, frictionless, whole)

    def _length(self, force: FloatArray, stretch: float) -> tuple[float | None, int]:
        """Length [m] that stretches by ``stretch`` under the forces (n,) [N], and the element in which it ends."""
        each = force * self.compliance
        below = np.cumsum(each)
        if stretch > below[-1] * (1 + ROUNDING):
            return None, len(each) - 1
        k = min(int(np.searchsorted(below, stretch)), len(each) - 1)
        share = min(1 - (below[k] - stretch) / each[k], 1.0)
        return float(self.upper[k] + share * (self.lower[k] - self.upper[k])), k


def slope(pairs: Sequence[Pair]) -> tuple[float, float, float] | None:
    """The line through several pairs: rise of the stretch [m] between the lowest and the highest pull [N]; None for one pull alone.

    A wrong zero of stretch or pull drops out of it.  None also where the stretch does not rise.
    """
    pulls, stretches = np.array([p.pull for p in pairs]), np.array([p.stretch for p in pairs])
    low, high = float(pulls.min()), float(pulls.max())
    if high - low <= ROUNDING * high:
        return None
    rise = float(np.polyfit(pulls - pulls.mean(), stretches, 1)[0]) * (high - low)
    return (rise, low, high) if rise > 0 else None


class FreePoints(dict[str, Any]):
    """``pairs``: the result of each pair; ``slope``: that of the line through all of them, None for one pull.

    lines: report for the screen.
    """

    lines: list[str]


def free_points(case: Case, pairs: Sequence[Pair]) -> FreePoints:
    """Find the free lengths for some pairs, and for the line through them.

    Raises CaseError for a case that cannot be built.
    """
    string, line = StuckString(case), slope(pairs)
    found = FreePoints(
        pairs=[string.find(pair.stretch, 0.0, pair.pull) for pair in pairs],
        slope=None if line is None else string.find(*line),
    )
    found.lines = _lines(case, found, string, case.shown_units)
    return found


def _lines(case: Case, found: FreePoints, string: StuckString, units: System) -> list[str]:
    lines = [
        f"{case.title or 'case'}: free point of a stuck string of {shown(case.string_length, 'length', units, 5)}"
    ]

    def text(row: FreePoint) -> str:
        if row.length is None:
            whole = shown(row.whole, "diameter", units)
            return f"more than the whole string would stretch, {whole}: it is free to its lower end, or a figure is wrong"
        out = f"free to {shown(row.length, 'length', units, 5)} below the top ({row.item})"
        if row.arrives > 1 - FELT:
            return out
        plain = "all of it" if row.frictionless is None else shown(row.frictionless, "length", units, 5)
        return f"{out}, which {row.arrives:.0%} of the pull reaches; without friction {plain}"

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
    most = max(pair.pull for pair in rows)
    if (item := string.overloaded(most)) is not None:
        size = shown(most, "force", units)
        lines.append(
            f"  WARNING: a pull of {size} takes {item} beyond 0.9 of its tension at yield: is the figure right?"
        )
    if string.free is None:
        lines.append(
            "  note: no hole with contact, so no friction, which would make the free length look shorter"
        )
    else:
        hook = shown(string.free.hook_load, "force", units, 4)
        lines.append(
            f"  note: pull and stretch count from the pick-up weight of the free string, {hook} with the friction of the case"
        )
    return lines
