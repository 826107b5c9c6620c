"""Doubts about a static state: in its loads, at its ends, in its tools."""

from __future__ import annotations

import numpy as np

from drillpetsc.case.plausible.plausibility import LARGEST_PUMP_PRESSURE
from drillpetsc.doubts.doubt import Values, doubt, written
from drillpetsc.doubts.moments import Answer, Flowing, Start
from drillpetsc.output.measured.in_hole import below_flow_line
from drillpetsc.output.watches.axial_strain import largest_strain
from drillpetsc.output.watches.operation_watch import LEAST_PUSH
from drillpetsc.parallel import total
from drillpetsc.physics.contact import RESULTS
from drillpetsc.physics.fluid.swirl import steady_share
from drillpetsc.physics.joints import Joints

MOST_STRAIN = 0.01  # along the axis, twice the yield of the strongest pipe [-]
LEAST_DEPTH = 1.0  # of the top below the flow line that is reported [m]
SMALL_TORQUE = 0.02  # share of the surface torque below which the swirl is not reported
STOP_SHARE = (
    1 / 3
)  # of the force of spring and stop, from which a stop is reported: its force sets in gradually


@doubt(
    "the string's top stands in mud, {depth:length} below the flow line. The hook load is the force on the string there, without the "
    "mud's push on its upper face, {push:force}. A rig sees both{both}, and the buoyed weight of what carries the string",
    "To compare with a rig, add the push and the buoyed weight of the running string, or model it as an item.",
)
def mud_above_top(at: Answer | Start) -> Values:
    """The top of the string stands in mud, so the mud pushes on its upper face (manual: sec-mud-ends).

    The hook load balances the string below the top. The face above it is not part of the model: a running string or a hanger
    stands there and carries the push of the mud on it.
    """
    model, annulus = at.model, at.model.annulus
    if annulus is None or model.well is None or not model.beam.moves or at.continued:
        return
    system, found = model.system, np.zeros(2)
    here = np.flatnonzero(system.chain.owned & (system.chain.vertices == 0))
    if len(here):
        position = system.field("string.position")[here[:1]]
        pressure = float(system.field("annulus.pressure")[here[0], 0]) - annulus.flow_line.pressure.value(0.0)
        found[:] = float(below_flow_line(model, position)[0]), pressure
    found = np.asarray(total(system.comm, found))
    if found[0] >= LEAST_DEPTH:  # not with nan, without gravity
        push = found[1] * float(annulus.annulus.outer[0])
        load = at.figures.get("hook_load")
        both = (
            ""
            if load is None
            else written(", {all:force} in all, the buoyed load", {"all": load + push}, at.units)
        )
        yield {"depth": found[0], "push": push, "both": both}


@doubt(
    "the top pushes the string into the hole with {push:force}: a hook can only pull; {weight}friction or mud holds the string up",
    "Give less weight on bit, check friction factors and mud weight, or rotate the string while it is run.",
)
def top_push(at: Answer | Start) -> Values:
    """The top pushes the string into the hole, which a hook cannot (manual: sec-statics-top-push).

    The motion of the top is prescribed, and its force is downward. A string that hangs, and a top with a given force, have no such note.
    """
    load, case = at.figures.get("hook_load"), at.case
    if load is None or load > -LEAST_PUSH or case.well is None or case.top.force is not None:
        return
    on_bottom = case.bottom.kind == "bit"
    weight = "the weight on the bit is more than the string puts there, or " if on_bottom else ""
    yield {"push": -load, "weight": weight}


@doubt(
    "{name} of {value} exceeds rig.{key}, {limit}",
    "Reduce weight, friction, torque or flow rate, or plan for a larger rig.",
)
def beyond_rig(at: Answer | Flowing | Start) -> Values:
    """A load of the state exceeds a limit of the rig."""
    rig, figures = at.case.rig, at.figures
    if rig is None:
        return
    for name, key, kind, value in (
        (
            "hook load",
            "max_hookload",
            "force",
            figures.get("hook_load_total", figures.get("hook_load")),
        ),
        ("surface torque", "max_surface_torque", "torque", figures.get("surface_torque")),
        ("standpipe pressure", "max_spp", "pressure", figures.get("pump_pressure")),
    ):
        limit = getattr(rig, key)
        if value is not None and limit is not None and abs(value) > limit:
            texts = (written(f"{{q:{kind}}}", {"q": q}, at.units) for q in (abs(value), limit))
            yield dict(zip(("name", "key", "value", "limit"), (name, key, *texts), strict=True))


@doubt(
    "pump pressure of {pressure:pressure}: more than any mud pump delivers; {where}",
    "Check the unit of the flow rate, the nozzles, and the diameters of hole and string where the pressure is lost.",
)
def beyond_pumps(at: Answer | Flowing | Start) -> Values:
    """The pump pressure of the state is more than a mud pump can deliver: a flow rate in a wrong unit, or a passage that is nearly closed."""
    pressure = at.figures.get("pump_pressure")
    if pressure is not None and pressure > LARGEST_PUMP_PRESSURE:
        where = at.largest_loss if isinstance(at, Flowing) else "`hydraulics` shows where it is lost"
        yield {"pressure": pressure, "where": where}


@doubt(
    "{name} at MD {md:length 5} is {strained} by {percent:.2g} % along its axis: any pipe yields at about 0.5 %, which this state leaves out",
    "Check the diameters, the loads, and their units; `limits` compares stresses with the yield strength.",
)
def overstrained(at: Answer | Start) -> Values:
    """The axial load strains a pipe far beyond the yield of any metal, which the model does not contain: a diameter, a load or a unit is wrong."""
    if not at.model.beam.moves or "string.tangent" not in at.model.system.layout.dofs:
        return
    strain, cell = largest_strain(at.model)
    if abs(strain) > MOST_STRAIN:
        mesh = at.model.mesh
        yield {
            "name": at.case.string[int(mesh.item[cell])].name,
            "md": at.top + float(mesh.node_depth[cell]),
            "strained": "stretched" if strain > 0 else "shortened",
            "percent": 100 * abs(strain),
        }


@doubt(
    "the mud that swirls with the turning string adds about {added:torque} to the torque in motion ({percent:.2g} %): it presses "
    "pipe that lies on the wall and brakes it; this equilibrium leaves the swirl out (fluid.swirl)",
    "Add the torque by hand, or simulate the motion with `run`, which contains the swirl.",
)
def swirl_left_out(at: Answer) -> Values:
    """Mud that swirls with a turning string adds to the torque, and the equilibrium leaves the swirl out (manual: sec-mud-swirl).

    An element on the wall, with the clearance c, is pressed to it by M_a Omega_s^2 c per length and braked by share k_v Omega_s c^2.
    """
    model = at.model
    fluid, contact, torque = model.case.fluid, model.contact, abs(at.figures.get("surface_torque") or 0.0)
    annulus = model.annulus
    if fluid is None or annulus is None or contact is None or not at.rotation or fluid.swirl == 0.0:
        return None
    cells, _ = contact.element_results(model.system.assembly)
    own, mesh = model.system.chain.cells, model.mesh
    normal = cells[:, RESULTS["normal"]]
    lever = np.abs(cells[:, RESULTS["torque"]]) / np.maximum(normal, 1e-9)  # friction times radius
    outer, hole = annulus.lateral_sizes().T
    share = steady_share(outer, hole) if fluid.swirl == "auto" else np.full(len(outer), float(fluid.swirl))
    swirl, length = share * abs(at.rotation), mesh.length[own]
    clearance = np.maximum(0.0, 0.5 * (hole - mesh.contact_diameter[own]))
    pressed = annulus.parameter("chi") * fluid.density * np.pi / 4 * outer**2 * swirl**2 * clearance * length
    braked = share * annulus.parameter("damping") * swirl * clearance**2 * length
    here = np.where(normal > 0, pressed * lever + braked, 0.0).sum()
    added = float(total(model.system.comm, here))
    return added > SMALL_TORQUE * torque and {"added": added, "percent": 100 * added / max(torque, 1e-9)}


@doubt(
    "the mud's viscous torque on the turning string, {added:torque 3} at {rotation:rotation}, is left out of this equilibrium (fluid.rotation_drag)",
    "Add the torque by hand, or simulate the motion with `run`, which contains it.",
)
def rotation_drag_left_out(at: Answer) -> Values:
    """The viscous torque of the mud on a turning string (`fluid.rotation_drag`) follows its speed, which an equilibrium does not have."""
    annulus, system = at.model.annulus, at.model.system
    if annulus is None or not at.rotation:
        return None
    here = (annulus.parameter("turning") * at.model.mesh.length[system.chain.cells]).sum()
    added = float(total(system.comm, here)) * abs(at.rotation)
    return added > 0 and {"added": added, "rotation": at.rotation}


@doubt(
    "the slider at MD {md:length 6} is {how} to its stop at {end:diameter}, which carries {stop:force 3}: it acts as rigid at "
    "this load",
    "Place the tool where its load lies within its stroke, or choose another spring or preload.",
)
def slider_on_stop(at: Answer) -> Values:
    """A stop carries the load of a telescoping tool, so its spring does not act (manual: sec-statics-march)."""
    system = at.model.system
    for joints in at.model.parts(Joints):
        rows = np.asarray(total(system.comm, joints.element_results(system.assembly)))
        travels, stops = (rows[:, joints.RESULTS.index(name)] for name in ("travel", "stop"))
        for joint, travel, stop in zip(joints.joints, travels, stops, strict=True):
            sprung = joint.jar is None and joint.spring > 0
            if (
                joint.stroke is not None
                and sprung
                and abs(stop) >= STOP_SHARE * (abs(stop) + joint.spring * abs(travel))
            ):
                end, how = (joint.stroke[0], "closed") if stop < 0 else (joint.stroke[1], "extended")
                yield {"md": at.top + joint.depth, "how": how, "end": end, "stop": abs(stop)}
