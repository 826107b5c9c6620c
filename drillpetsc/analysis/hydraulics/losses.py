"""Losses of a steady flow: by string item and hole section, along the depth, and in sum.

Losses of elements are the solver's: power that friction turns into heat, over the flow rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drillpetsc.analysis.hydraulics import trade_formulas as trade
from drillpetsc.analysis.hydraulics.flow_model import FlowModel
from drillpetsc.analysis.hydraulics.nozzles import bit_flow, nozzle_loss, nozzle_rows
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.well import Section
from drillpetsc.kernels.parameters import constant
from drillpetsc.model.fluid import build_rheology
from drillpetsc.model.mud_sections import losses_of_items
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES, ChannelFlow
from drillpetsc.physics.fluid.rheology import Rheology, wall_shear
from drillpetsc.physics.roots import bracketed_root
from drillpetsc.physics.tools.mud_motor import RESULTS as MOTOR_RESULTS
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.unit_systems import System, shown

SHARP = 1e-3  # share of the rounding of small shear rates that leaves nothing out
TINY_DENSITY = 1e-300  # at which the wall shear is that of laminar flow [kg/m3]
TURBULENT_SPAN = 800.0  # Reynolds numbers from the end of laminar to the start of turbulent flow (API RP 13D)


@dataclass(frozen=True)
class Loss:
    """One row of hydraulics.csv, SI; nan where a number does not exist.

    channel: surface line, bore, nozzles, annulus or choke; item: of the string; section: of the hole.
    upper, lower: measured depths [m]; od, id: outer and inner diameter of the channel [m].
    velocity: [m/s], positive with the pumped flow; critical_flow: flow rate at which laminar flow ends [m3/s].
    volume: of the channel [m3].
    flow: flow rate at zero pressure [m3/s], positive with the pumped flow.
    """

    channel: str
    item: str
    section: str
    upper: float = np.nan
    lower: float = np.nan
    od: float = np.nan
    id: float = np.nan
    velocity: float = np.nan
    reynolds: float = np.nan
    regime: str = "-"
    friction_factor: float = np.nan
    pressure_loss: float = 0.0
    critical_flow: float = np.nan
    volume: float = np.nan
    flow: float = np.nan

    @property
    def length(self) -> float:
        """Length along the hole [m]."""
        return self.lower - self.upper


# ---------------------------------------------------------------------- friction in one channel
def reynolds_number(law: Rheology, speed: float, gap: float, slot: bool, density: float) -> float:
    """Compute the Reynolds number [-] by which the friction law finds its regime (manual: eq-mud-blend, sec-mud-api).

    speed: [m/s]; gap: hydraulic diameter [m]; slot: an annulus; density: [kg/m3].
    """
    laminar = abs(float(wall_shear(law, speed, gap, slot, TINY_DENSITY)))
    if laminar == 0.0:
        return np.inf if speed else 0.0
    return (1.5 if slot and law.law == "api" else 1.0) * 8 * density * speed**2 / laminar


def regime(law: Rheology, reynolds: float) -> str:
    """Name the regime at a Reynolds number [-]: laminar, transitional or turbulent."""
    if law.consistency == 0.0:
        return "inviscid"
    limit = 3470.0 - 1370.0 * law.index
    if reynolds < limit:
        return "laminar"
    return "transitional" if reynolds < limit + TURBULENT_SPAN else "turbulent"


def critical_speed(law: Rheology, gap: float, slot: bool, density: float) -> float:
    """Compute the mean speed at which laminar flow ends [m/s]; infinite for a mud that thickens too fast to become turbulent.

    Arguments as in `reynolds_number`.
    """
    if law.consistency == 0.0:
        return 0.0
    limit = 3470.0 - 1370.0 * law.index
    slowest, fastest = np.log(1e-18), np.log(1e6)

    def excess(log_speed: float) -> float:
        return float(np.log(reynolds_number(law, np.exp(log_speed), gap, slot, density) / limit))

    if excess(fastest) < 0:
        return np.inf
    return float(np.exp(bracketed_root(excess, slowest, fastest, 1e-10)))


def annulus_stress(
    channel: ChannelFlow, law: Rheology, speed: FloatArray, density: FloatArray, drift: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Compute stresses (n,) [Pa] of the flow past tube and tool joints in series, as kernels/fluid/annulus_flow.hpp does.

    speed: (n,) in the mean area, relative to the string [m/s]; density: (n,) [kg/m3].
    drift: what the motion of the string adds to the speed at its wall [m/s].
    Returns the stress of the loss, 4 stress/gap per length, and that of the force on the string, stress pi D per length.
    """
    p = {name: channel.parameter(name) for name in ("gap", "joint_gap", "joint_share", "tube_speed")}
    tube = wall_shear(law, speed * p["tube_speed"] + drift, p["gap"], True, density)
    if not p["joint_share"].any():
        return tube, tube
    joint = wall_shear(law, speed * channel.parameter("joint_speed") + drift, p["joint_gap"], True, density)
    loss = (1 - p["joint_share"]) * tube + p["joint_share"] * p["gap"] / p["joint_gap"] * joint
    return loss, channel.parameter("tube_pull") * tube + channel.parameter("joint_pull") * joint


# ---------------------------------------------------------------------- elements
@dataclass(frozen=True)
class ElementLosses:
    """Losses of one channel, (n,) per element.

    friction: [Pa], of the element and the rigid item above it; above: the rigid item's part [Pa].
    head: rise of the velocity head [Pa]; weight: of the mud from the upper to the lower node [Pa].
    tool: loss of tools in the string [Pa].
    speed, speed_above: mean speed in element and rigid item, towards the bit [m/s]; density: [kg/m3].
    """

    friction: FloatArray
    above: FloatArray
    head: FloatArray
    weight: FloatArray
    tool: FloatArray
    speed: FloatArray
    speed_above: FloatArray
    density: FloatArray


def element_losses(flow: FlowModel, channel: ChannelFlow, law: Rheology) -> ElementLosses:
    """Compute the losses of the elements of a channel with a standing string.  Friction has the sign of the flow."""
    f, mesh = flow.fluid.constants, flow.mesh
    results, q = channel.element_results(flow.system.assembly), channel.flows(flow.system)
    density, speed = (results[:, RESULT_NAMES.index(name)] for name in ("density", "speed"))
    heat = results[:, RESULT_NAMES.index("dissipated")]
    volume_flow = q * f.density / density
    friction = np.divide(heat, volume_flow, out=np.zeros(len(q)), where=np.abs(q) > 0)
    bore = channel.name == "bore"
    _, gap_above, open_above = _cross_sections(channel, above=True)
    speed_above, above = np.zeros(len(q)), np.zeros(len(q))
    rigid = mesh.rigid_above > 0
    if rigid.any():
        speed_above[rigid] = volume_flow[rigid] / open_above[rigid]
        stress = wall_shear(law, speed_above[rigid], gap_above[rigid], not bore, density[rigid])
        above[rigid] = 4 * stress * mesh.rigid_above[rigid] / gap_above[rigid]
    drop = np.diff(flow.system.field("string.position"), axis=0)
    if bore:
        weight = density * (drop @ f.gravity)
    else:
        axis = channel.parameter("tangent1") + channel.parameter("tangent2")
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        weight = density * (axis @ f.gravity) * np.sum(drop * axis, axis=1)
    squared = q**2 * f.density**2 / density
    head, tool = squared * channel.parameter("step"), np.sign(q) * squared * channel.parameter("loss")
    friction = friction - tool  # the channel's own row takes it; a table of the flow rate is a row of its own
    if bore and flow.fluid.losses is not None:
        tool = tool + flow.fluid.losses.losses(flow.system.assembly)
    return ElementLosses(friction, above, head, weight, tool, speed, speed_above, density)


# ---------------------------------------------------------------------- table
def _section_name(section: Section) -> str:
    return f"{section.kind.replace('_', ' ')} to {section.to:g} m"


def _cross_sections(component: ChannelFlow, above: bool = False) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Outer diameter and gap [m] and open area [m2] of a channel, (n,) each; above: of the rigid items above its elements.

    The gap is the diameter by which the friction law goes: that of the bore, the clearance of the annulus.
    """
    tail = "_above" if above else ""
    if component.name == "bore":
        outer = component.parameter("diameter" + tail)
        return outer, outer, component.parameter("area" + tail)
    hole = component.parameter("hole" + tail)
    return (
        np.sqrt(4 / np.pi * hole),
        component.parameter("gap" + tail),
        hole - component.parameter("outer" + tail),
    )


def channel_rows(flow: FlowModel, name: str) -> list[Loss]:
    """Rows of ``bore`` or ``annulus``, from the top down: one for each string item in each hole section, and one for each
    row of rigid items."""
    component = flow.channel(name)
    if component is None:
        return []
    mesh, slot = flow.mesh, name == "annulus"
    law = build_rheology(flow.case, annulus=slot)
    e = element_losses(flow, component, law)
    sections = flow.case.well.sections if flow.case.well is not None else ()
    start, lower = mesh.upper + flow.string.top, mesh.lower + flow.string.top
    which = np.minimum(
        np.searchsorted([s.to for s in sections], 0.5 * (start + lower)), max(len(sections) - 1, 0)
    )
    item = np.array([flow.string.number[k] for k in mesh.item])
    sign = -1.0 if slot else 1.0

    def both(above: np.ndarray, element: np.ndarray) -> np.ndarray:
        """(2n,) values of the rigid items above each element, and of the element."""
        return np.stack([above, element], axis=1).ravel()

    outer, gap, area = map(both, _cross_sections(component, above=True), _cross_sections(component))
    length, upper = both(mesh.rigid_above, mesh.length), both(start - mesh.rigid_above, start)
    lower, speed = both(start, lower), sign * both(e.speed_above, e.speed)
    loss, density = sign * both(e.above, e.friction - e.above), np.repeat(e.density, 2)
    rate, which = np.repeat(sign * component.flows(flow.system), 2), np.repeat(which, 2)
    piece = both(-1 - np.arange(len(item)), item)  # a row of rigid items has a number of its own
    there = np.flatnonzero(both(mesh.rigid_above, np.ones(len(item))) > 0)
    new = (np.diff(piece[there]) != 0) | (np.diff(which[there]) != 0)
    rows: list[Loss] = []
    for group in np.split(there, np.flatnonzero(new) + 1):
        first, mean = group[0], length[group] / length[group].sum()
        names = [b.name for b in mesh.bodies if b.node == first // 2]
        od, clear, open_area = (float(q[group] @ mean) for q in (outer, gap, area))
        row = Loss(
            name,
            ", ".join(names) if piece[first] < 0 else flow.case.string[piece[first]].name,
            _section_name(sections[which[first]]) if slot and sections else "-",
            float(upper[first]),
            float(lower[group[-1]]),
            od,
            od - clear,
            float(speed[group] @ mean),
            volume=float(area[group] @ length[group]),
            flow=float(rate[group] @ mean),
            pressure_loss=float(loss[group].sum()),
        )
        total = float(length[group].sum())
        rows.append(_with_friction(row, law, slot, float(density[group] @ mean), total, open_area))
    return rows


def _with_friction(row: Loss, law: Rheology, slot: bool, density: float, length: float, area: float) -> Loss:
    """The row with Reynolds number, regime, friction factor and critical flow.

    slot: an annulus; density: [kg/m3]; length: of the elements, without rigid items [m]; area: open to flow [m2].
    """
    speed, gap = row.velocity, row.od - row.id
    reynolds, loss = reynolds_number(law, speed, gap, slot, density), abs(row.pressure_loss)
    return replace(
        row,
        reynolds=reynolds,
        regime=regime(law, reynolds),
        friction_factor=loss * gap / (2 * density * speed**2 * length) if speed else np.nan,
        critical_flow=critical_speed(law, gap, slot, density) * area,
    )


def motor_rows(flow: FlowModel) -> list[Loss]:
    """A row of the downhole motor without load, none without one."""
    motor, rates = flow.model.part(MudMotor), flow.flow_rate("bore")
    if motor is None or rates is None:
        return []
    depth = flow.string.top + float(flow.mesh.node_depth[motor.cell])
    lost = float(motor.figures(0.0, flow.system.assembly)[MOTOR_RESULTS["pressure"]])
    name = flow.case.string[flow.string.number[int(flow.mesh.item[motor.cell])]].name
    return [Loss("tool", name, "-", depth, depth, pressure_loss=lost)]


def tool_rows(flow: FlowModel) -> list[Loss]:
    """A row for each item with a `pressure_loss`, and of a downhole motor, from the top down."""
    rows = motor_rows(flow)
    bore = flow.fluid.bore
    if bore is None or all(item.pressure_loss is None for item in flow.case.string):
        return rows
    density = bore.element_results(flow.system.assembly)[:, RESULT_NAMES.index("density")]
    rates = bore.flows(flow.system) * flow.fluid.constants.density / density
    lost = losses_of_items(flow.model.case, flow.mesh, rates, density)
    upper, last = flow.string.top, -1
    for k, (item, number) in enumerate(zip(flow.string.items, flow.string.number, strict=True)):
        lower = upper + item.length
        if k in lost:
            if number == last:  # a piece of the tool above, which an end of a hole section cuts
                rows[-1] = replace(rows[-1], lower=lower, pressure_loss=rows[-1].pressure_loss + lost[k])
            else:
                rows.append(Loss("tool", item.name, "-", upper, lower, pressure_loss=lost[k]))
            last = number
        upper = lower
    return sorted(rows, key=lambda row: row.upper)


def surface_line_loss(flow: FlowModel) -> float:
    """Compute the loss of the lines between pump and string [Pa]; 0 without them."""
    line, rates = flow.fluid.surface_line, flow.flow_rate("bore")
    return 0.0 if line is None or rates is None else line.loss(float(rates[0]))


def choke_loss(flow: FlowModel) -> float:
    """Compute the loss of the choke at the flow line [Pa]; 0 without one."""
    annulus = flow.fluid.annulus
    out = None if annulus is None else annulus.outflow(flow.system.assembly)
    if annulus is None or out is None or not annulus.flow_line.choke:
        return 0.0
    slow = min(
        constant("flow_rounding"), constant("jet_rounding") / np.sqrt(2 * annulus.flow_line.choke)
    )  # as kernels do
    return float(annulus.flow_line.choke * flow.fluid.constants.density * out * np.hypot(out, slow))


def loss_rows(flow: FlowModel) -> list[Loss]:
    """All rows of hydraulics.csv for one flow rate, in the order of the flow down the string, then from the top down."""
    bit, choke = nozzle_loss(flow), choke_loss(flow)
    rows, line = channel_rows(flow, "bore") + tool_rows(flow), surface_line_loss(flow)
    if line:
        rows.insert(0, Loss("surface line", "-", "-", pressure_loss=line))
    at_bit = flow.fluid.bit is not None and flow.fluid.bit.has_link
    for row in nozzle_rows(flow, 0.0)[: -1 if at_bit else None]:
        md, speed, lost = row["md"], row["nozzle_jet_velocity"], row["nozzle_loss"]
        rows.append(Loss("nozzles", row["item"], "-", md, md, velocity=speed, pressure_loss=lost))
    if bit and flow.fluid.bit is not None:
        end, md = flow.fluid.bit.end, flow.string.depth
        speed = trade.jet_velocity(bit_flow(flow), end.nozzle or end.bore)
        name = flow.case.string[-1].name
        rows.append(Loss("nozzles", name, "-", md, md, velocity=speed, pressure_loss=bit))
    rows += channel_rows(flow, "annulus")
    if choke:
        rows.append(Loss("choke", "-", "-", pressure_loss=choke))
    return rows


def largest_loss(rows: list[Loss], units: System) -> str:
    """Words on the row with the largest loss, in the reader's units."""
    row = max(rows, key=lambda q: abs(q.pressure_loss))
    words = f"{shown(abs(row.pressure_loss), 'pressure', units)} of it in the {row.channel}"
    if row.item != "-":
        words += f" {'past' if row.channel == 'annulus' else 'of'} {row.item}"
    if row.length > 0:
        upper, lower = (shown(q, "length", units, 6) for q in (row.upper, row.lower))
        words += f", MD {upper} to {lower}"
    if row.channel == "annulus":
        words += f", in a hole {shown(row.od - row.id, 'diameter', units, 3)} wider than the string"
    return words


# ---------------------------------------------------------------------- sums
def balance(flow: FlowModel) -> dict[str, float]:
    """Pressure losses of the loop [Pa], from the standpipe to the outlet.

    surface_line_loss, string_loss, tool_loss (with tools only), bit_loss, annulus_loss, choke_loss; velocity_head: change of the velocity head at steps of the
    section; column_difference: weight of the mud in the annulus, up to the flow line, less that in the bore.
    outlet: pressure at the outlet; pump_pressure: at the upper end of the bore plus the loss of the surface line.  pump_pressure - outlet is the sum of
    all others up to the rounding of the solver.
    """
    out = dict.fromkeys(
        (
            "surface_line_loss",
            "string_loss",
            "bit_loss",
            "annulus_loss",
            "choke_loss",
            "velocity_head",
            "column_difference",
        ),
        0.0,
    )
    bore, annulus = flow.fluid.bore, flow.fluid.annulus
    if bore is not None:
        e = element_losses(flow, bore, build_rheology(flow.case))
        out["string_loss"] = float(e.friction.sum())
        motor = sum(row.pressure_loss for row in motor_rows(flow))
        if e.tool.any() or motor:
            out["tool_loss"] = float(e.tool.sum()) + motor
        out["velocity_head"] += float(e.head.sum())
        out["column_difference"] -= float(e.weight.sum())
        out["surface_line_loss"] = surface_line_loss(flow)
        out["pump_pressure"] = float(bore.pressures(flow.system)[0]) + out["surface_line_loss"]
    if annulus is not None:
        e = element_losses(flow, annulus, build_rheology(flow.case, annulus=True))
        out["annulus_loss"] = -float(e.friction.sum())
        out["velocity_head"] -= float(e.head.sum())
        above = flow.fluid.constants.density * flow.gravity * (float(flow.tvd[0]) - flow.flow_line)
        out["column_difference"] += float(e.weight.sum()) + above
    out["bit_loss"], out["choke_loss"] = nozzle_loss(flow), choke_loss(flow)
    assert flow.case.fluid is not None
    out["outlet"] = flow.case.fluid.outlet_pressure.value(0.0)
    return out


# ---------------------------------------------------------------------- what the law of friction leaves out


def wall_friction(flow: FlowModel, channel: ChannelFlow, law: Rheology, speed: float = 0.0) -> float:
    """Compute the friction of a channel by a law [Pa], at the present flow, whichever law it was found with.

    speed: of the string [m/s], down positive.
    """
    results = channel.element_results(flow.system.assembly)
    w, density = (results[:, RESULT_NAMES.index(name)] for name in ("speed", "density"))
    if channel.name == "bore":
        gap = _cross_sections(channel)[1]
        stress = wall_shear(law, w, gap, False, density)
    else:
        gap = channel.parameter("gap")
        stress = annulus_stress(channel, law, w, density, speed * (1.0 - flow.fluid.constants.clinging))[0]
    return float(np.abs(4 * stress / gap * flow.mesh.length).sum())


def blend_excess(flow: FlowModel, speed: float = 0.0) -> float:
    """Compute by how much the law ``blend`` exceeds the exact law in the annulus [-], at the present flow.

    The explicit laminar stress of a mud with a yield stress is too high in slow flow (manual: sec-mud-blend); 0 for
    other laws and muds.

    speed: of the string [m/s], down positive.
    """
    law, annulus = build_rheology(flow.case, annulus=True), flow.fluid.annulus
    if annulus is None or law.law != "blend" or law.yield_stress == 0.0 or law.model == "casson":
        return 0.0
    blend, exact = (wall_friction(flow, annulus, q, speed) for q in (law, replace(law, law="exact")))
    return blend / exact - 1.0 if exact > 0 else 0.0


def rounded_off(
    flow: FlowModel, speed: float = 0.0, channels: Sequence[str] = ("bore", "annulus")
) -> tuple[float, float]:
    """(friction of some channels that the rounding of small shear rates leaves out [Pa], its share [-]), at the present flow.

    A gel that hardly moves has its yield stress; rounded over ``rheology.shear_rate`` it creeps under any pressure (manual: sec-mud-exact).

    speed: of the string [m/s], down positive.
    """
    rounded = sharp = 0.0
    for channel in filter(None, map(flow.channel, channels)):
        law = build_rheology(flow.case, annulus=channel.name == "annulus")
        rounded += wall_friction(flow, channel, law, speed)
        sharp += wall_friction(flow, channel, replace(law, shear_rate_eps=SHARP * law.shear_rate_eps), speed)
    # rounding adds to the friction of a mud that thickens
    return max(sharp - rounded, 0.0), 1.0 - rounded / sharp if sharp > 0 else 0.0
