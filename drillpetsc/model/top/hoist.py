"""From `top.hoist` and `top.autodriller` to the top, the hoist and its measurements."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.case.blocks.ends import TopDrive as TopDriveCase
from drillpetsc.case.case import Case
from drillpetsc.model.fluid import FluidComponents
from drillpetsc.physics import interfaces
from drillpetsc.physics.end_conditions import EndPlace, Input, TopDrive
from drillpetsc.physics.top.hoist import Hoist, HoistedTop, HoistLine, RigidHoist
from drillpetsc.physics.top.hoisting import Autodriller, Heave, HeavingSpeed, Hoisting, Line, Loop


def gear_of(case: Case) -> Hoisting:
    """Masses, line and heave of the case's hoist."""
    h = case.top.hoist
    assert h is not None
    line = None
    if h.line is not None:
        length = h.crown - h.height
        line = Line(h.lines, h.line.stiffness, length, h.fast_line, h.dead_line, h.damping)
    heave = None
    if h.heave is not None:
        heave = Heave(h.heave.amplitude, h.heave.period, h.heave.phase, h.heave.compensation)
    units = case.output.units or case.units
    return Hoisting(h.block_mass, line, h.lines, h.height, h.crown, h.sheave_efficiency, h.tare, heave, units)


def autodriller_of(case: Case) -> Autodriller | None:
    """The autodriller of the case; None without."""
    q, hoist = case.top.autodriller, case.top.hoist
    if q is None or hoist is None:
        return None
    loops = [
        Loop(kind, goal, p, i)
        for kind, goal, p, i in (
            ("wob", q.wob, q.p, q.i),
            ("torque", q.torque, q.torque_p, q.torque_i),
            ("differential_pressure", q.differential_pressure, q.pressure_p, q.pressure_i),
        )
        if goal is not None
    ]
    most = q.max_speed if q.max_speed is not None else hoist.max_speed
    return Autodriller(
        tuple(loops),
        q.rop,
        q.from_,
        -most if q.reverse else 0.0,
        most,
        q.measure == "bit",
        q.filter,
        q.sample,
        q.ramp or 0.0,
    )


def build_hoist(
    case: Case,
    nodes: int,
    place: EndPlace,
    rotation: Input | None,
) -> tuple[interfaces.Top, Hoist]:
    """Create the guided top and the hoist of a case.

    nodes: of the string; place: of its upper end; rotation: prescribed, None: free.
    """
    top, gear = case.top, gear_of(case)
    assert isinstance(top, TopDriveCase)
    gravity = np.array(case.gravity, dtype=float)
    if gear.line is not None:
        guided = HoistedTop(place, rotation)
        statics = case.initial.from_ == "statics"
        return guided, HoistLine(gear, guided, top.lowering, gravity, nodes, autodriller_of(case), statics)
    speed: Any = top.lowering if gear.heave is None else HeavingSpeed(top.lowering, gear.heave)
    weight = gear.mass * float(gravity @ place.tangent)
    guided_by_drum = TopDrive(place, rotation, speed)
    return guided_by_drum, RigidHoist(gear, speed, top.lowering, weight)


def connect_sensors(
    hoist: Hoist,
    drive: interfaces.Drive | None,
    bit: interfaces.Bit | None,
    fluid: FluidComponents | None,
) -> None:
    """Connect the measurements that the hoist's autodriller takes elsewhere."""

    def torque(t: float, state: Any) -> float:
        held = sum(
            float(row.reaction[row.condition.names.index("top.torque_reaction")])
            for row in state.row_replacements
            if row.owned and "top.torque_reaction" in row.condition.names
        )
        return held + (drive.torque(t, state) if drive is not None else 0.0)

    def hook(t: float, state: Any) -> float:
        return -sum(
            float(row.reaction[row.condition.names.index("top.axial_reaction")])
            for row in state.row_replacements
            if row.owned and "top.axial_reaction" in row.condition.names
        )

    def pump_pressure(t: float, state: Any) -> float:
        assert fluid is not None and fluid.bore is not None
        flow = fluid.bore.pumped(t, state)
        if flow is None:  # another rank has the end
            return 0.0
        loss = 0.0 if fluid.surface_line is None else fluid.surface_line.loss(flow)
        return fluid.bore.upper_pressure(state) + loss

    if isinstance(hoist, RigidHoist):
        hoist.sensors = {"hook": hook}
        return
    assert isinstance(hoist, HoistLine)
    found: dict[str, Any] = {}
    drill = hoist.autodriller
    if bit is not None:
        found["wob"] = lambda t, state: bit.weight_and_torque(state)[0]
    kinds = {q.kind for q in drill.loops} if drill is not None else set()
    if "torque" in kinds:
        found["torque"] = torque
    if "differential_pressure" in kinds:
        found["differential_pressure"] = pump_pressure
    hoist.sensors = found
