"""The open hole and its pressure window: where a pressure is too high or too low."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import FlowModel
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.well import Window
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_well
from drillpetsc.output.measured.in_hole import LOWEST_COLUMN
from drillpetsc.unit_systems import shown

SPACING = 10.0  # largest distance between points at which the window is compared [m]
WITHIN = "none"  # no limit is passed
NOTHING_OPEN = "no open hole below the flow line: the window limits nothing"
NOT_CHECKED = "-"  # there is no window


def shoe_depth(case: Case) -> float | None:
    """Measured depth of the deepest casing shoe [m]; None in a hole without casing."""
    if case.well is None:
        return None
    return max((s.to for s in case.well.sections if s.kind == "casing"), default=None)


def vertical_depth(case: Case, md: FloatArray) -> FloatArray:
    """Compute the vertical depths (k,) below the rotary table [m] of measured depths (k,) [m]."""
    well = build_well(case)
    assert well is not None
    gravity = np.array(case.gravity)
    return np.asarray(well.at(np.asarray(md, dtype=float))[0]) @ gravity / np.linalg.norm(gravity)


@dataclass(frozen=True)
class OpenHole:
    """Points of the open hole with the limits there, (k,) each.

    md: measured, tvd: vertical depth below the rotary table [m]; pore, frac: equivalent densities [kg/m3].
    """

    md: FloatArray
    tvd: FloatArray
    pore: FloatArray
    frac: FloatArray

    def _beyond(self, flow: FlowModel) -> tuple[FloatArray, FloatArray]:
        """(k,) equivalent density above the fracture density, and below the pore density [kg/m3]."""
        density = flow.equivalent_density(annulus_pressure_at(flow, self.md, self.tvd), self.tvd)
        return density - self.frac, self.pore - density

    def margins(self, flow: FlowModel) -> dict[str, float | None]:
        """Smallest distances from both limits [kg/m3], negative beyond them; None without an open hole."""
        beyond = self._beyond(flow) if len(self.md) else (None, None)
        return {
            name: None if q is None else -float(np.nanmax(q))
            for name, q in zip(("frac_margin", "pore_margin"), beyond, strict=True)
        }

    def limited_by(self, flow: FlowModel) -> str:
        """Name the limit that the pressure in the annulus passes most, with its depth; "none" within the window."""
        if not len(self.md):
            return WITHIN
        over, under = self._beyond(flow)
        worst = np.nanmax([over, under])
        if not worst > 0:
            return WITHIN
        name, excess = ("frac", over) if np.nanmax(over) == worst else ("pore", under)
        return f"{name} at TVD {self.tvd[int(np.nanargmax(excess))]:.0f} m"


def annulus_pressure_at(flow: FlowModel, md: FloatArray, tvd: FloatArray) -> FloatArray:
    """Compute the gauge pressure [Pa] in the hole at measured depths (k,) [m]; still mud below the bit.

    Above the string's top, where there is no annulus, the mud's friction in the open hole is left out.

    tvd: (k,) vertical depths of the same points [m].
    """
    pressure = flow.pressure("annulus")
    assert pressure is not None
    md, inside = np.asarray(md, dtype=float), np.interp(md, flow.md, pressure)
    inside = np.where(md < flow.md[0], flow.pressure_above(tvd), inside)
    return np.where(md <= flow.md[-1], inside, flow.pressure_below(tvd))


def open_hole(case: Case, window: Window | None) -> OpenHole | None:
    """Create the points of the open hole; None without a window.

    Raises CaseError if the table of the window does not cover the open hole.
    """
    if window is None or case.well is None:
        return None
    above, pieces = 0.0, []
    for section in case.well.sections:
        if section.kind == "open_hole":
            count = max(2, int(np.ceil((section.to - above) / SPACING)) + 1)
            pieces.append(np.linspace(above, section.to, count))
        above = section.to
    md = np.concatenate(pieces) if pieces else np.zeros(0)
    tvd = vertical_depth(case, md) if len(md) else md
    below = tvd > (case.fluid.flow_line if case.fluid is not None else 0.0) + LOWEST_COLUMN
    md, tvd = md[below], tvd[below]
    if window.tvd is None:
        pore, frac = np.full(len(md), window.pore[0]), np.full(len(md), window.frac[0])
        return OpenHole(md, tvd, pore, frac)
    if len(tvd) and (tvd.min() < window.tvd[0] - 1e-3 or tvd.max() > window.tvd[-1] + 1e-3):
        units = case.shown_units
        given, needed = (
            f"{shown(a, 'length', units, 5)} to {shown(b, 'length', units, 5)}"
            for a, b in ((window.tvd[0], window.tvd[-1]), (tvd.min(), tvd.max()))
        )
        raise CaseError(
            at="window.tvd",
            got=given,
            want=f"depths that cover the open hole, {needed} TVD",
            hint="the window says nothing of depths outside its table",
        )
    return OpenHole(md, tvd, np.interp(tvd, window.tvd, window.pore), np.interp(tvd, window.tvd, window.frac))
