"""The string at a bit depth as rows of numbers, from the top down: what the soft string needs of each item."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import SHORTEST_PIECE, string_at, with_length
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Flexible, Item, Rigid
from drillpetsc.case.blocks.items.tubulars import Jointed
from drillpetsc.case.case import Case
from drillpetsc.case.checks.fit import misfit
from drillpetsc.errors import CaseError
from drillpetsc.fem.string_mesh import plain_sizes
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import build_well
from drillpetsc.model.item_section import STIFFNESSES, metal_of, section_of
from drillpetsc.units import to_si

JOINT = to_si("31 ft", "m")  # length of a joint where the item names none, range 2 [m]
SHORTEST = 1e-6  # shorter items have a weight and no length [m]


@dataclass(frozen=True)
class StringRows:
    """Items of a string in the hole with its lower end at a measured depth; arrays are (k,) from the top down.

    edges: (k+1,) measured depths [m].
    weight: buoyed weight per length [N/m]; end_weight: buoyed weight of items without length at the lower end [N].
    contact_radius [m]; clearance_radius: from which the clearance of buckling is measured [m].
    axial_stiffness EA [N], bending_stiffness EI, torsional_stiffness GJ [N m2]; infinite for rigid items.
    friction: of the item, nan: that of the hole.
    joint_length [m].
    worn_radius, bore_radius [m], young [Pa], yield_strength [Pa]: for limits; the latter nan if not known.
    half_joint: half the length of a joint whose bending gathers beside the tool joints [m], nan for others.
    pressed_area: area of the wall, of the tube between tool joints, on which the pressure of the mud acts [m2].
    air_weight: weight of the whole string in air [N].
    misfit: which item does not fit the hole there, in words; empty if all do.
    """

    edges: FloatArray
    weight: FloatArray
    contact_radius: FloatArray
    clearance_radius: FloatArray
    axial_stiffness: FloatArray
    bending_stiffness: FloatArray
    torsional_stiffness: FloatArray
    friction: FloatArray
    joint_length: FloatArray
    worn_radius: FloatArray
    bore_radius: FloatArray
    yield_strength: FloatArray
    young: FloatArray
    pressed_area: FloatArray
    half_joint: FloatArray
    end_weight: float
    air_weight: float
    misfit: str = ""

    @property
    def depth(self) -> float:
        """Measured depth of the lower end [m]."""
        return float(self.edges[-1])


def need_well(case: Case, command: str) -> Well:
    """The hole of a case; CaseError where it has none, or touches nothing."""
    well = build_well(case)
    if well is None:
        raise CaseError(at="well", want=f"a well for {command}: without a hole there is no drag")
    return well


def gravity_of(case: Case, command: str) -> float:
    """Gravity [m/s2] of a case for a soft string; CaseError unless it is vertical."""
    north, east, down = case.gravity
    if north or east or not down > 0:
        raise CaseError(at="gravity", got=list(case.gravity), want=f"gravity straight down for {command}")
    return float(down)


def rows_at(case: Case, depth: float, at: str = "roadmap.bit_depth") -> StringRows:
    """The lowest ``depth`` metres of the case's string, its top at the rig; a topmost pipe is cut, or lengthened.

    Raises CaseError, which names the key ``at``, if the string cannot be made so long.
    """
    try:
        items = string_at(case, depth).items
        upper, lower = mud_in_bore(case, depth)
        for edge in (upper, lower):
            items = _cut(items, edge)
    except CaseError as error:
        error.at = at
        raise
    g, fluid = gravity_of(case, "the soft string"), case.fluid
    density = 0.0 if fluid is None else fluid.density
    outside = density if case.has_annulus else 0.0
    rows: list[dict[str, float]] = []
    edges, pending, air = [0.0], 0.0, 0.0
    for item in items:
        middle = edges[-1] + 0.5 * item.length
        mass, metal, bore, row = _of(case, item, middle)
        inside = density if upper <= middle < lower else 0.0
        total = g * (mass + inside * bore - outside * (metal + bore))
        air += g * mass
        if item.length < SHORTEST:
            pending += total
            continue
        row["weight"] = (total + pending) / item.length
        pending = 0.0
        rows.append(row)
        edges.append(edges[-1] + item.length)
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return StringRows(
        edges=np.array(edges), **columns, end_weight=pending, air_weight=air, misfit=_misfit(case, items)
    )


def partly_filled(case: Case) -> str | None:
    """The key of the fluid that says which part of a plugged string holds mud; None if all of the string does, or nothing."""
    fluid = case.fluid
    keys = ("level_in_string", "floated_length")
    return next((key for key in keys if fluid is not None and getattr(fluid, key) is not None), None)


def mud_in_bore(case: Case, depth: float) -> tuple[float, float]:
    """Measured depths [m] between which there is mud in the bore of a string whose lower end is at ``depth``; (0, 0) for none."""
    fluid = case.fluid
    if fluid is None:
        return 0.0, 0.0
    if fluid.level_in_string is not None:
        return fluid.level_in_string, np.inf
    if fluid.floated_length is not None:
        return 0.0, max(depth - fluid.floated_length, 0.0)
    return 0.0, (np.inf if case.has_bore else 0.0)


def _cut(items: tuple[Item, ...], edge: float) -> tuple[Item, ...]:
    """The items with the one at a measured depth [m] in two pieces; a rigid item stays whole, filled by its middle."""
    out: list[Item] = []
    above = 0.0
    for item in items:
        upper = edge - above
        if isinstance(item, Flexible) and SHORTEST_PIECE < upper < item.length - SHORTEST_PIECE:
            out += [with_length(item, upper), with_length(item, item.length - upper, upper)]
        else:
            out.append(item)
        above += item.length
    return tuple(out)


def _misfit(case: Case, items: tuple[Item, ...]) -> str:
    """Which of the items, hung from the rig, does not fit the hole, in words; empty if all do."""
    if case.well is None:
        return ""
    above = 0.0
    for item in items:
        found = misfit(case.well, item, above, above + item.length)
        if found is not None:
            return found.told(item.name, case.shown_units)
        above += item.length
    return ""


def _of(case: Case, item: Item, middle: float) -> tuple[float, float, float, dict[str, float]]:
    """(mass [kg], volume of metal and of the bore [m3], row without its weight) of an item in the hole.

    middle: measured depth of the item's middle [m], where the hole's diameter is taken.
    """
    nan = float("nan")
    if isinstance(item, Rigid):
        s = plain_sizes(item.od or 0.0, item.id) | dict.fromkeys(STIFFNESSES, np.inf)
        mass, bore = item.mass, item.bore_section * item.length
        metal = metal_of(item, item.bore_section, case.well, middle)
    else:
        assert isinstance(item, Flexible)
        s = section_of(item)
        mass, bore = s["mass"] * item.length, s["bore_area"] * item.length
        metal = s["outer_area"] * item.length - bore
    gathers = isinstance(item, Jointed) and item.contact_on == "tool_joint"
    row = {
        "contact_radius": 0.5 * s["contact_diameter"],
        "clearance_radius": 0.5 * s["clearance_diameter"],
        **{key: s[key] for key in STIFFNESSES},
        "friction": nan if item.friction is None else item.friction,
        "joint_length": JOINT if np.isnan(s["joint_length"]) else s["joint_length"],
        "worn_radius": 0.5 * s["worn_diameter"],
        "bore_radius": 0.5 * s["inner_diameter"],
        "yield_strength": s["yield_strength"],
        "young": nan if item.material is None else item.material.young,
        "pressed_area": s["tube_outer_area"] - s["tube_bore_area"],
        "half_joint": 0.5 * s["joint_length"] if gathers else nan,
    }
    return mass, metal, bore, row


def bends_left_out(case: Case) -> list[str]:
    """A sentence on the tools that push or bend the string: a soft string lies along the hole; none without such a tool."""
    tools = [
        item.name
        for item in case.string
        if getattr(item, "rss", None) is not None or getattr(item, "bend", None) is not None
    ]
    if not tools:
        return []
    return [
        f"the soft string leaves out the side forces and torque of steering and bends: {', '.join(tools)}"
    ]


def cutters_left_out(case: Case) -> list[str]:
    """A sentence on a reamer that could cut: weight and torque on bit act at the lower end alone; none without a reamer."""
    reamers = [item.name for item in case.string if isinstance(item, Reamer)]
    if not reamers:
        return []
    return [f"torque and drag leave out the weight and torque of cutters above the bit: {', '.join(reamers)}"]
