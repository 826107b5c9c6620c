"""Doubts about a valid but unlikely string: too short for its hole, listed from the bit up, a valve that pumps."""

from __future__ import annotations

import math

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.formation import DragBit, Formation, Layer
from drillpetsc.case.blocks.items.agitator import AgitatorTool
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.string import Beam, Bit, Flexible, Item, Rigid, Stabilizer, Tube
from drillpetsc.case.blocks.items.tubulars import DrillCollar, DrillPipe, HeavyPipe, Tubular
from drillpetsc.case.catalogue.formulas import STEEL, steel_tube
from drillpetsc.case.pipe.weighed import lighter_or_heavier
from drillpetsc.case.quantities import largest, said
from drillpetsc.unit_systems import shown

ONE_JOINT = (
    10.0  # a tally is short of its hole by this before it is doubted: stick-up and rounding are less [m]
)
STEEP = math.radians(60)  # inclination above which drill pipe is usual in compression
LEAST_MASS, MOST_MASS = 0.01, 20.0  # of a rigid item, relative to a cylinder of steel [-]


def lumped_masses(case: CaseBlocks) -> list[str]:
    """List rigid items that weigh far more, or less, than steel of their size: tonnes and kilograms mistaken.

    A bit that represents the collars above it, with several times its weight, is usual in models and is not listed.
    """
    out = []
    for i, item in enumerate(case.string):
        if not isinstance(item, Rigid) or not item.mass or not item.od or not item.length > 0:
            continue
        steel = STEEL * item.length * math.pi / 4 * item.od**2
        if not LEAST_MASS < item.mass / steel < MOST_MASS:
            out.append(
                f"string[{i}].mass is {said(item.mass, 'mass', case.said_units)}: a cylinder of steel of this size has {shown(steel, 'mass', case.said_units, 3)}; another unit?"
            )
    return out


def odd_densities(case: CaseBlocks) -> list[str]:
    """List tubes as stiff as steel whose weight is not the weight of steel: a wrong row of a string sheet."""
    units, out = case.said_units, []
    for i, item in enumerate(case.string):
        ratio = lighter_or_heavier(item)
        if ratio is not None:
            assert isinstance(item, Tube)
            steel = shown(steel_tube(item.od, item.id), "weight_per_length", units, 4)
            out.append(
                f"string[{i}] {item.name} weighs {ratio:.2g} times a steel tube of its size, {steel}: a weight, diameter or unit of another row?"
            )
    return out


def short_of_hole(case: CaseBlocks) -> list[str]:
    """Report a string that drills but does not reach from the rig to the end of its hole; empty if it does.

    With initial.wob such a string rests on the bottom with its top below the rig; otherwise it hangs above the bottom.
    """
    if case.well is None or case.bottom.kind != "bit":
        return []
    if case.top.force is not None and case.initial.wob is None:
        return []
    missing = case.well.survey.md[-1] - case.string_length
    if missing <= ONE_JOINT:
        return []
    units = case.shown_units
    length, hole, gap = (
        shown(v, "length", units, 5) for v in (case.string_length, case.well.survey.md[-1], missing)
    )
    where = (
        f"with initial.wob it stands on the bottom, and its top is {gap} below the rig (bit_depth: {length} puts its top at the rig)"
        if case.initial.wob is not None
        else f"without initial.wob it hangs from the rig, and its bit is {gap} above the bottom"
    )
    return [f"the string is {length} long, {gap} short of its hole of {hole}: {where}"]


def idle_mesh(case: CaseBlocks) -> list[str]:
    """Report keys of `mesh` that change nothing, because every item has an element length of its own."""
    given = [
        k
        for k in ("refinement", "frequency")
        if getattr(case.mesh, k) != type(case.mesh).model_fields[k].default
    ]
    lengths = [item.element_length for item in case.string if isinstance(item, Flexible)]
    if not given or not lengths or "auto" in lengths:
        return []
    return [
        f"mesh.{given[0]} changes nothing: every item of the string has its element_length, and mesh is for element_length: auto"
    ]


def listed_upwards(case: CaseBlocks) -> list[str]:
    """Report drill pipe or heavy-wall pipe directly above the bit, below collars; empty if there is none."""
    items = case.string
    if not isinstance(items[-1], Bit):
        return []
    above = next((i for i in range(len(items) - 2, -1, -1) if isinstance(items[i], Flexible)), None)
    if above is None or not isinstance(items[above], (DrillPipe, HeavyPipe)):
        return []
    between = items[above + 1 : -1]
    collars = [i for i in range(above) if isinstance(items[i], DrillCollar)]
    if any(isinstance(item, Stabilizer) or item.length > 1.0 for item in between) or not collars:
        return []
    words = "heavy-wall pipe" if isinstance(items[above], HeavyPipe) else "drill pipe"
    return [
        f"string[{above}] is {items[above].name}: {words} right above the bit, below the collars; the string is listed from "
        "the top down, is its lower part the wrong way round?"
    ]


def pumping_valves(case: CaseBlocks) -> list[str]:
    """Warn of agitators in mud whose mean loss is below the amplitude of their pulses: part of each pulse would drive the mud.

    With a given pump pressure the flow rate is not known, and only an agitator without a mean loss is doubted.
    """
    if case.fluid is None or not case.has_bore:
        return []
    units, fluid = case.shown_units, case.fluid
    flow = None if fluid.pump_pressure is not None else largest(fluid.flow_rate)
    words = []
    for i, item in enumerate(case.string):
        if not isinstance(item, AgitatorTool) or flow == 0.0:
            continue
        amplitude, given = item.agitator.pressure_amplitude, item.pressure_loss
        if given is None:
            mean = 0.0
        elif flow is None:
            continue
        else:
            mean = item.tool_loss(flow, fluid.density)
        if mean < (1 - 1e-9) * amplitude:
            words.append(
                f"string[{i}].pressure_loss is {shown(mean, 'pressure', units)} at the largest flow rate: less than "
                f"agitator.pressure_amplitude, {shown(amplitude, 'pressure', units)}, so the valve drives the mud in a part of each pulse"
            )
    return words


def beyond_curves(case: CaseBlocks, flow: float | None = None) -> list[str]:
    """Warn of loss curves of tools that end below the flow rate.

    flow: through the string [m3/s]; None: the largest of the pump.
    """
    if case.fluid is None or not case.has_bore:
        return []
    units = case.shown_units
    flow = (
        (largest(case.fluid.flow_rate) if case.fluid.pump_pressure is None else 0.0) if flow is None else flow
    )
    words = []
    for i, item in enumerate(case.string):
        loss = item.pressure_loss
        if loss is None or loss.curve is None or flow <= (1 + 1e-9) * loss.curve.flow_rate[-1]:
            continue
        last, asked = (shown(q, "flow", units) for q in (loss.curve.flow_rate[-1], flow))
        words.append(
            f"string[{i}].pressure_loss.curve ends at {last}, the flow rate is {asked}: beyond its end the curve is extended with its last "
            "slope over the squared flow rate"
        )
    return words


def beyond_lower_part(case: CaseBlocks) -> list[str]:
    """Warn of weights on bit above the buoyed weight below the drill pipe along the hole.

    Empty in holes above STEEP, whose wall holds drill pipe in compression.
    """
    found = _weight_of_lower_part(case)
    if found is None:
        return []
    weight, names = found
    units = case.shown_units
    keys = {"initial.wob": case.initial.wob}
    if case.roadmap is not None:
        keys |= {f"roadmap.{word}.wob": getattr(case.roadmap, word).wob for word in ("drilling", "sliding")}
    words = []
    for key, wob in keys.items():
        same = [k for k in keys if keys[k] == wob]
        if wob is not None and wob > weight and key == same[0]:
            words.append(
                f"{' and '.join(same)} is {shown(wob, 'force', units)}: more than the weight below the drill pipe "
                f"{'in the mud ' if case.fluid is not None else ''}along the hole, {shown(weight, 'force', units)} ({names}); drill pipe is in compression"
            )
    return words


def standing_bit(case: CaseBlocks) -> list[str]:
    """Report a bit without rotation that is lowered onto rock that only a turning bit drills: the weight on it grows without limit."""
    rock, top = case.formation, case.top
    if (
        rock is None
        or case.time is None
        or any(isinstance(q, PositiveDisplacementMotor) for q in case.string)
    ):
        return []
    moved = top.lowering is not None and largest(top.lowering) > 0
    if not moved or largest(top.rotation) > 0 or getattr(top, "torque", None) is not None:
        return []
    cure = "give a rotation or a pdm"
    if not isinstance(rock.bit_law, DragBit):
        parts: list[Formation | Layer] = [rock, *rock.layers]
        drilled = [q.rotary_exponent for q in parts if q.drillability]
        if not drilled or not all(drilled):
            return []
        cure += "; formation.rotary_exponent 0 is the rate of a bit that a motor outside of the model turns"
    return [
        f"top.rotation is 0 and no motor turns the bit: it drills nothing, and the weight on it grows as the string is lowered; {cure}"
    ]


def _weight_of_lower_part(case: CaseBlocks) -> tuple[float, str] | None:
    """Buoyed weight along the hole [N] of the string below the drill pipe, and the names of the items; None if there is
    no such part, or the hole is steep there. The inclination is taken from the nearest survey station."""
    pipe = [i for i, item in enumerate(case.string) if isinstance(item, DrillPipe)]
    if not pipe or case.well is None or not any(item.length for item in case.string[pipe[-1] + 1 : -1]):
        return None
    survey = case.well.survey
    top = survey.md[-1] - case.string_length if case.initial.wob is not None else 0.0
    mud = 0.0 if case.fluid is None else case.fluid.density
    gravity, sum_ = math.hypot(*case.gravity), 0.0
    for item, depths in list(zip(case.string, case.item_depths, strict=True))[pipe[-1] + 1 :]:
        middle = top + 0.5 * sum(depths)
        nearest = min(range(len(survey.md)), key=lambda k: abs(survey.md[k] - middle))
        inclination = survey.inclination[nearest]
        if inclination > STEEP:
            return None
        mass, metal = _mass(item)
        sum_ += mass * (1 - mud / metal) * gravity * math.cos(inclination)
    return sum_, ", ".join(dict.fromkeys(item.name for item in case.string[pipe[-1] + 1 : -1]))


def _mass(item: Item) -> tuple[float, float]:
    """Mass of an item [kg] and density of its metal [kg/m3]."""
    if isinstance(item, Beam):
        return item.mass * item.length, STEEL
    if isinstance(item, Rigid):
        return item.mass, item.material.density
    if isinstance(item, Tubular):
        return item.adjusted_weight * item.length, item.material.density
    assert isinstance(item, Tube)
    area = math.pi / 4 * (item.od**2 - item.id**2)
    return item.material.density * area * item.length, item.material.density
