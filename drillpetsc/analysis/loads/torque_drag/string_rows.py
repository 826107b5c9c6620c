"""The string at a bit depth as rows of numbers, from the top down: what the soft string needs of each item."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import SHORTEST_PIECE, string_at, with_length
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Beam, Flexible, Item, Rigid, Stabilizer, Tool, Tube
from drillpetsc.case.blocks.items.tubulars import Jointed, Tubular
from drillpetsc.case.case import Case
from drillpetsc.case.checks.fit import misfit
from drillpetsc.case.pipe.section import metal_past, ring, tubular_section
from drillpetsc.errors import CaseError
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import build_well
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
    worn_area [m2], worn_radius, bore_radius [m], yield_strength [Pa], young [Pa]: for limits; nan where not known.
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
    worn_area: FloatArray
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


_COLUMNS = (
    "weight",
    "contact_radius",
    "clearance_radius",
    "axial_stiffness",
    "bending_stiffness",
    "torsional_stiffness",
    "friction",
    "joint_length",
    "worn_area",
    "worn_radius",
    "bore_radius",
    "yield_strength",
    "young",
    "pressed_area",
    "half_joint",
)


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
    columns = {name: np.array([row[name] for row in rows]) for name in _COLUMNS}
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

    middle: measured depth of the item's middle [m].
    """
    nan = float("nan")
    outer, inner = item.od or 0.0, item.id or 0.0
    row = {
        "contact_radius": 0.5 * (item.contact_od or 0.0),
        "clearance_radius": 0.5 * (item.clearance_od or 0.0),
        "axial_stiffness": np.inf,
        "bending_stiffness": np.inf,
        "torsional_stiffness": np.inf,
        "friction": nan if item.friction is None else item.friction,
        "joint_length": JOINT,
        "worn_area": nan,
        "worn_radius": nan,
        "bore_radius": nan,
        "yield_strength": nan,
        "young": nan,
        "pressed_area": 0.0,
        "half_joint": nan,
    }
    if isinstance(item, Rigid):
        return _rigid(case, item, middle, row)
    assert isinstance(item, Flexible)
    if isinstance(item, Tubular):
        s = tubular_section(item)
        per_length, metal, bore = s.mass, s.outer_area - s.bore_area, s.bore_area
        row["pressed_area"] = s.tube_outer_area - s.tube_bore_area
        row |= {
            key: getattr(s, key) for key in ("axial_stiffness", "bending_stiffness", "torsional_stiffness")
        }
        row |= {"worn_radius": 0.5 * s.worn_diameter, "worn_area": ring(s.worn_diameter, item.id)[0]}
        row |= {
            "bore_radius": 0.5 * item.id,
            "yield_strength": s.yield_strength,
            "young": item.material.young,
        }
        if s.joint_length == s.joint_length:
            row["joint_length"] = s.joint_length
        if isinstance(item, Jointed) and item.contact_on == "tool_joint":
            row["half_joint"] = 0.5 * item.joint_length
    elif isinstance(item, Tube):
        m = item.material
        area, moment = ring(outer, inner)
        per_length, bore = m.density * area, item.bore_section
        metal = area if item.annulus_od is None and item.bore_volume is None else item.outer_section - bore
        row |= {"axial_stiffness": m.young * area, "bending_stiffness": m.young * moment}
        row["torsional_stiffness"] = m.young / (1 + m.poisson) * moment
        if isinstance(item, Tool):
            row |= item.given_stiffness
    else:
        assert isinstance(item, Beam)
        per_length, bore = item.mass, np.pi / 4 * inner**2
        metal = np.pi / 4 * outer**2 - bore
        row |= {
            key: getattr(item, key) for key in ("axial_stiffness", "bending_stiffness", "torsional_stiffness")
        }
    if not isinstance(item, Tubular):
        row["pressed_area"] = metal
    return per_length * item.length, metal * item.length, bore * item.length, row


def _rigid(
    case: Case, item: Rigid, middle: float, row: dict[str, float]
) -> tuple[float, float, float, dict[str, float]]:
    """As `_of`, for a rigid item, whose metal displaces mud as in the solver."""
    bore = item.bore_section * item.length
    metal = item.mass / item.material.density
    if item.annulus_od is not None:
        metal = item.outer_section * item.length - bore
    elif isinstance(item, Stabilizer) and item.bypass_area is not None and case.well is not None:
        metal = metal_past(item, case.well.diameter_at(middle))
    return item.mass, metal, bore, row


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
