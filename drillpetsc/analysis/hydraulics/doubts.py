"""Doubts about the steady flow of the mud: hydraulics and surge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import SHORTEST_PIECE, FlowModel
from drillpetsc.analysis.hydraulics.open_hole import (
    NOT_CHECKED,
    NOTHING_OPEN,
    WITHIN,
    OpenHole,
    vertical_depth,
)
from drillpetsc.case.blocks.items.string import Flexible
from drillpetsc.case.plausible.plausible_string import short_of_hole
from drillpetsc.doubts.doubt import CaseMoment, Values, doubt, remark
from drillpetsc.doubts.moments import Flowing
from drillpetsc.model.fluid import build_rheology
from drillpetsc.model.tools.mud_motor import motor_item
from drillpetsc.output.watches.boiling import VAPOUR_PRESSURE

BLEND_EXCESS = 0.05  # excess of the law blend over the exact one above which it is reported [-]
ROUNDED_OFF = 0.05  # share of the friction that rounding leaves out, above which it is reported
SHORT = 1e-3  # distance of the string's end from the end of the hole that is reported [m]


# ---------------------------------------------------------------------- moments
@dataclass(frozen=True)
class OfCase(CaseMoment):
    """The flow of a case is prepared."""


@dataclass(frozen=True)
class PumpedString(OfCase):
    """The flow of a case is prepared (hydraulics).  window: of the open hole, None without one; end: of the hole [m]."""

    flow: FlowModel
    window: OpenHole | None
    end: float | None


@dataclass(frozen=True)
class Pumped(Flowing):
    """Mud is pumped at one flow rate (hydraulics).

    excess: of the friction by rheology.law: blend [-]; missing: share of the friction that the rounding of small shear rates leaves out;
    limited: what passes the window (``OpenHole.limited_by``).
    """

    flow: FlowModel
    excess: float
    missing: float
    limited: str


@dataclass(frozen=True)
class Tripped(OfCase):
    """The string moves at one speed (surge); excess and missing have the meaning that they have in ``Pumped``."""

    flow: FlowModel
    excess: float
    missing: float


@dataclass(frozen=True)
class TripPlan(OfCase):
    """Trips are prepared (surge).

    pipes: closed, open, pumping; acceleration: of a start from rest [m/s2], None without one; hole: the open hole, None without a window.
    top: measured depth of the string's top [m], which a trip lengthens to the rig.
    """

    pipes: tuple[str, ...]
    acceleration: float | None
    hole: OpenHole | None
    top: float


# ---------------------------------------------------------------------- warnings
@doubt(
    "the pressure in the {channel} falls to {pressure:pressure 3} gauge at MD {md:length 6}, below a vacuum: the mud would part "
    "there, and pressures and flow are not valid",
    "Trip more slowly, fill the pipe, or pump more.",
)
def below_vacuum(at: Pumped | Tripped) -> Values:
    """The pressure of the mud falls below a vacuum: the mud would part there."""
    for channel in ("bore", "annulus"):
        pressure = at.flow.pressure(channel)
        if pressure is not None and pressure.min() < VAPOUR_PRESSURE:
            k = int(np.argmin(pressure))
            yield {"channel": channel, "pressure": float(pressure[k]), "md": float(at.flow.md[k])}


@doubt(
    "rheology.law: blend overstates the annulus friction of this mud by {percent:.0f} % here (yield stress, slow flow); rheology: "
    "{{law: exact}} does not",
    "Use `rheology: {law: exact}`.",
)
def blend_overstates(at: Pumped | Tripped) -> Values:
    """The blended law of friction is too high for a slow flow of mud with a yield stress."""
    return at.excess > BLEND_EXCESS and {"percent": 100 * at.excess}


@doubt(
    "the mud moves so slowly that its friction is {percent:.0f} % too low here: stresses are rounded below fluid.rheology.shear_rate, "
    "{rate:.3g} 1/s; {smaller:.3g} 1/s shows the gel",
    "Set `fluid.rheology.shear_rate` (and that of `annulus_rheology`) to a hundredth.",
)
def slow_mud(at: Pumped | Tripped) -> Values:
    """The mud moves so slowly that the rounding of small shear rates takes off some of its stress: a gel creeps in place of standing."""
    if at.missing <= ROUNDED_OFF:
        return None
    rate = build_rheology(at.case, annulus=True).shear_rate_eps
    return {"percent": 100 * at.missing, "rate": rate, "smaller": 0.01 * rate}


@doubt(
    "the pressure passes the window: {limit}",
    "Change mud weight, rheology or flow rate, or set casing deeper.",
)
def outside_window(at: Pumped) -> Values:
    """The pressure in the open hole passes the pore or the fracture pressure."""
    return at.limited not in (WITHIN, NOT_CHECKED) and {"limit": at.limited}


@doubt(
    "window.tvd ends at {end:length 5}, the measured depth of the hole, whose end is at TVD {tvd:length 5}: are these measured "
    "depths?",
    "Give the depths of the window as vertical depths.",
)
def window_in_measured_depth(at: PumpedString) -> Values:
    """The table of the window ends at the measured depth of the hole, which its vertical depth does not reach."""
    case, window = at.case, at.case.window
    if window is None or window.tvd is None or case.well is None:
        return None
    end = float(case.well.survey.md[-1])
    tvd = float(vertical_depth(case, np.array([end]))[0])
    return abs(window.tvd[-1] - end) <= 1e-3 * end and tvd <= 0.98 * end and {"end": end, "tvd": tvd}


# ---------------------------------------------------------------------- remarks of hydraulics


def _nothing_open(hole: OpenHole | None) -> bool:
    return hole is not None and not len(hole.md)


remark(
    PumpedString,
    "fluid.formulation: hermite: hydraulics takes mixed, whose steady flow is the same",
    lambda at: at.case.fluid.formulation == "hermite",
)
remark(
    PumpedString,
    "the string's top lies at MD {top:length 6}: the pump pressure is the pressure there, and the mud rises in the hole above it "
    "without friction",
    lambda at: at.flow.string.top > SHORTEST_PIECE and {"top": at.flow.string.top},
)


@doubt(
    "nozzles above the bit, at the upper ends of their items: {names}; their loss has the bit's discharge coefficient"
)
def side_names(at: PumpedString) -> Values:
    side, string = at.flow.fluid.side, at.flow.string
    if side is None:
        return None
    names = [at.case.string[string.number[n]].name for link in side.links for n, _ in link.items]
    return {"names": ", ".join(names)}


remark(
    PumpedString,
    "fluid.check_valve is at the bit: mud can flow into the string through the nozzles above it",
    lambda at: at.flow.fluid.side is not None and at.case.fluid.check_valve,
)
remark(
    PumpedString,
    "bottom.plugged: all mud leaves through the nozzles above the bit",
    lambda at: at.flow.fluid.bit is None or not at.flow.fluid.bit.has_link,
)
remark(
    PumpedString,
    "no nozzles: the string ends open, without a loss; jet velocity, impact and power are absent",
    lambda at: at.flow.fluid.bit is not None and at.flow.fluid.bit.has_link and not at.flow.fluid.bit.end.nozzle,
)  # fmt: skip


@doubt(
    "{name}: the motor's pressure is its no-load pressure; torque on bit raises it and the pump pressure{more} (statics and runs count it)"
)
def motor(at: PumpedString) -> Values:
    found = motor_item(at.case)
    if found is None:
        return None
    side = at.flow.fluid.side is not None
    more = ", and sends more mud through the nozzles above it" if side else ""
    return {"name": found[1].name, "more": more}


@doubt(
    "no friction along the rigid items below the last pipe: {names}; the pressure under the bit is that at the lower end of the pipe, "
    "MD {md:length 6}"
)
def rigid_below(at: PumpedString) -> Values:
    string = at.case.string
    last = max(i for i, item in enumerate(string) if isinstance(item, Flexible))
    names = [item.name for item in string[last + 1 :] if item.length > 0]
    return {"names": ", ".join(names), "md": float(at.flow.md[-1])} if names else None


remark(
    PumpedString,
    "mud without cuttings: their weight and volume are not in the pressures and densities of the annulus",
    lambda at: at.case.formation is not None,
)


@doubt(
    "the string ends at MD {md:length 6}, {above:length 6} above the end of the hole; the mud below it stands still"
)
def above_end(at: PumpedString) -> Values:
    if at.end is None or at.end - at.flow.string.depth <= SHORT or short_of_hole(at.case):
        return None
    return {"md": at.flow.string.depth, "above": at.end - at.flow.string.depth}


remark(
    PumpedString,
    "no annulus: no densities, and the mud leaves at the string's lower end",
    lambda at: at.flow.fluid.annulus is None,
)
remark(
    PumpedString,
    "no window: pore and fracture limits are not compared (key window)",
    lambda at: at.flow.fluid.annulus is not None and at.case.window is None,
)
remark(
    PumpedString,
    NOTHING_OPEN,
    lambda at: at.flow.fluid.annulus is not None and _nothing_open(at.window),
)

# ---------------------------------------------------------------------- remarks of surge
remark(
    TripPlan,
    "steady: the pressure that accelerates the mud is left out",
    lambda at: at.acceleration is None,
)
remark(
    TripPlan,
    "pressure of the start: from rest with {acceleration:g} m/s2 at the top, elastic string and compressible mud, friction of the "
    "case; no gels, no stop; window and largest trip speeds are compared with the steady pressure",
    lambda at: at.acceleration is not None and {"acceleration": at.acceleration},
)
remark(
    TripPlan,
    "open pipe with fluid.check_valve: the valve stays shut while running in{way}",
    lambda at: (
        "open" in at.pipes
        and at.case.fluid.check_valve
        and {"way": "; mud enters through the nozzles above the bit" if at.case.side_nozzles else ""}
    ),
)
remark(
    TripPlan,
    "open pipe with an outlet_pressure: the mud flows up the pipe with the string at rest, too",
    lambda at: "open" in at.pipes and at.case.fluid.outlet_pressure.value(0.0) > 0,
)
remark(
    TripPlan,
    "closed pipe: full of mud and closed at its top, so nothing flows through the nozzles above the bit on the whole; a float below "
    "open nozzles is --pipe open with fluid.check_valve: true",
    lambda at: "closed" in at.pipes and at.case.side_nozzles,
)
remark(
    TripPlan,
    "bottom.plugged holds for a closed pipe only",
    lambda at: at.case.bottom.plugged and not at.case.side_nozzles and set(at.pipes) != {"closed"},
)
remark(
    TripPlan,
    "no window: no largest trip speed; give --window PORE,FRAC, or the key window of the case",
    lambda at: at.hole is None,
)
remark(TripPlan, NOTHING_OPEN, lambda at: _nothing_open(at.hole))
remark(
    TripPlan,
    "the string's top lies at MD {top:length 6}: for a trip the topmost item ({name}) is lengthened to the rig",
    lambda at: at.top > SHORTEST_PIECE and {"top": at.top, "name": at.case.string[0].name},
)
