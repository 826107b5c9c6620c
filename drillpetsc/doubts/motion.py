"""Doubts about a run: at its start, in its drive and hoist, in its steps, and in what happened until its end."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.case.blocks.top_drive import PythonController
from drillpetsc.case.importers.stations import SHARPEST
from drillpetsc.doubts.doubt import Values, doubt
from drillpetsc.doubts.moments import Built, End, Freed, Moment, Start, Tuned
from drillpetsc.geometry.trajectory import dogleg_severity
from drillpetsc.model.drilling_model import is_quasi_static
from drillpetsc.model.top import autodriller_of
from drillpetsc.output.balances.energy_balance import GAINED
from drillpetsc.output.watches import creep
from drillpetsc.output.watches.operation_watch import NEAR_STALL, Spell
from drillpetsc.parallel import largest
from drillpetsc.physics.bit.bit_laws import Weakening
from drillpetsc.physics.bit.rock_bit import RockBit
from drillpetsc.physics.fluid.hermite.flow import HermiteAnnulus
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.top.hoist import HoistLine
from drillpetsc.physics.top.top_drive import MotorDrive
from drillpetsc.unit_systems import plain
from drillpetsc.unit_tables import GRAVITY

TOLERATED_JUMP = 0.01  # of the hook load, at the start of a run with a top force and a given weight on bit
TOLERATED_CHANGE = 0.01  # of the speed of the top, where a run begins from the end of another
ROUNDED_SPEED = 1e-6  # of a top that stands [m/s]
RESOLVED_FRACTION = 0.3  # of an impact's duration: with longer steps BDF of order 2 gains or loses energy
COARSE_SAMPLE = 0.1  # of the tuned period
FREED_WEIGHT = 0.05  # change of the weight on bit over initial.wob from which it is reported
BLOCK_WEIGHT = 0.01  # difference of two weights of the block from which it is reported, over the weight
CREEPS, ROUNDED = (
    0.2,
    0.01,
)  # creep of a bit that sticks [rad/s], and over the rotary speed, above which peaks may be too low
OTHER_HOLE = 0.05  # of the diameter of the hole beside an element, against that at the start, from which it is reported
UNBALANCED = 3e-3  # energy error over the energy exchanged above which formulation hermite is named
WAVE_COURSE = 3.0  # course over which a new hole is compared with what is drilled [m]
CREPT = 1e-3  # of the weight: friction below it holds nothing worth a message


# ---------------------------------------------------------------------- start
@doubt(
    "the top pulls with {force:force} from time 0 on, and with initial.wob the string hangs on {hook_load:force}: it starts to move",
    "Give the top the hook load of the start, or leave out `initial.wob`.",
)
def top_pulls(at: Freed) -> Values:
    """The force of the top differs from the hook load of the start, so the string moves at once."""
    if abs(at.force - at.hook_load) > TOLERATED_JUMP * abs(at.hook_load):
        yield {"force": at.force, "hook_load": at.hook_load}


@doubt(
    "the top turns at {now:rotation 4} from time 0 on, and turned at {found:rotation 4} at the end of {run}: the jump sends a torsional wave "
    "down the string. Times in the case count from the start of this run",
    "Begin `top.rotation` with the last value of the other run, or continue that run: `--restart` with a later `time.end`.",
)
def top_spins(at: Start) -> Values:
    """A run begins from the end of another, at which the top turned at another speed: time begins at 0 again, and so do tables over time."""
    top = at.case.top
    if at.found is None or at.model.parts(MotorDrive) or top.kind != "top_drive" or top.rotation is None:
        return
    now, found = top.rotation.value(0.0), at.found[0]
    if abs(now - found) > TOLERATED_CHANGE * max(abs(now), abs(found)):
        yield {"now": now, "found": found, "run": at.case.initial.from_}


@doubt(
    "the top is lowered at {now:rop 4} from time 0 on, and was at {found:rop 4} at the end of {run}: the jump sends an axial wave "
    "down the string. Times in the case count from the start of this run",
    "Begin `top.lowering` with the last value of the other run, or continue that run: `--restart` with a later `time.end`.",
)
def top_moves(at: Start) -> Values:
    """A run begins from the end of another, at which the top moved down or up at another speed: time begins at 0 again."""
    top = at.case.top
    if at.found is None or top.kind != "top_drive" or top.hoist is not None or top.force is not None:
        return
    now, found = top.lowering.value(0.0) if top.lowering is not None else 0.0, at.found[1]
    if abs(now - found) > TOLERATED_CHANGE * max(abs(now), abs(found)) + ROUNDED_SPEED:
        yield {"now": now, "found": found, "run": at.case.initial.from_}


@doubt(
    "fixed steps of {step:duration} do not resolve impacts of {impact:duration}: rebounds and their energy are not reliable "
    "(take steps below {most:duration}, or let -ts_rtol control the steps)",
    "Take shorter steps, or let the program choose them with `-ts_rtol`.",
)
def steps_beyond_impacts(at: Start) -> Values:
    """Fixed steps are longer than impacts on the wall, so rebounds and their energy are wrong (manual: sec-contact-impact)."""
    most = RESOLVED_FRACTION * at.impact
    if at.fixed_step is not None and at.fixed_step > most:
        yield {"step": at.fixed_step, "impact": at.impact, "most": most}


@doubt(
    "the string slides at time 0 with initial.wob, {given:force}. When it turns later, rotation frees its friction and the bit carries "
    "about {weight:force 2} until it is drilled off; with top.rotation at time 0 the weight is met while turning",
    "Turn the string at time 0 to meet `initial.wob` while turning.",
)
def freed_weight(at: Start) -> Values:
    """The string slides at time 0 and turns later, so rotation frees its friction and the weight on bit grows."""
    given = at.case.initial.wob
    if at.freed_weight is not None and given and at.freed_weight - given >= FREED_WEIGHT * given:
        yield {"given": given, "weight": at.freed_weight}


@doubt(
    "string[{item}] jar: at time 0 the load {load:force} lies beyond its latch: it {does} at once",
    "Begin with less pull or push, or set the latch above the load of the start.",
)
def jar_beyond_latch(at: Start) -> Values:
    """A jar is loaded beyond its latch when the run begins, so it moves at once."""
    if at.continued:
        return
    for joints in at.model.parts(Joints):
        found = joints.jars_beyond_latch(at.model.system.assembly)
        for item, load, meters in at.model.system.all_entries(found):
            yield {"item": item, "load": load, "does": "meters" if meters else "fires"}


@doubt(
    "the run is continued with {name} {now}; its checkpoint was written with {name} {before}",
    "Continue with the same versions if the last digits matter.",
)
def other_libraries(at: Start) -> Values:
    """Libraries have changed since the checkpoint, so results are equal up to rounding only."""
    for name, before, now in at.libraries:
        yield {"name": name, "before": before, "now": now}


@doubt(
    "changes accepted at a restart act at once: the energy balance counts what they add or remove as gained or lost by the time "
    "integration",
    "Ignore the energy error of the restart, or begin a new run.",
)
def accepted_changes(at: Start) -> Values:
    """The case has changed at a restart, so the energy balance counts the jump as an error."""
    return at.accepted


# ---------------------------------------------------------------------- drive and hoist
@doubt(
    "top.motor: left out, since time.mode is quasi_static: the rotation is prescribed",
    "Use `time.mode: dynamic` if the drive matters.",
)
def motor_left_out(at: Start) -> Values:
    """A quasi-static run prescribes the rotation, so the motor of the top drive is left out."""
    return at.case.top.motor is not None and is_quasi_static(at.case)


@doubt(
    "top.hoist: left out, since time.mode is quasi_static: the lowering moves the top itself",
    "Use `time.mode: dynamic` if block and line matter.",
)
def hoist_left_out(at: Start) -> Values:
    """A quasi-static run moves the top itself, so the hoist is left out."""
    return at.case.top.hoist is not None and is_quasi_static(at.case)


@doubt(
    "{at}.damping: {damping:g} is below 1: the drive yields more than the pipe and reflects with opposite sign; allowed above 0",
    "Give a damping of 1 or more, unless the soft drive is wanted.",
)
def soft_damping(at: Start | Built | Tuned) -> Values:
    """A controller is tuned below the impedance of the pipe, so it reflects waves with the opposite sign."""
    for k, control in enumerate(at.case.top.control if at.laws else ()):
        damping = getattr(control, "damping", None)
        if damping is not None and damping < 1:
            yield {"at": _control(k, len(at.laws)), "damping": damping}


@doubt(
    "{at}.sample: {sample:g} ms is coarser than a tenth of the tuned period, {period:.3g} s: the half-sample delay makes it "
    "reflect more than its tuning states",
    "Give a shorter `sample`.",
)
def coarse_sample(at: Start | Built | Tuned) -> Values:
    """A controller samples too seldom for the vibration to which it is tuned."""
    controls = at.case.top.control
    built_in = [(k, q) for k, q in enumerate(controls) if not isinstance(q, PythonController)]
    for (k, control), law in zip(built_in, at.laws, strict=False):
        if law.frequency and control.sample * law.frequency > COARSE_SAMPLE:
            place = _control(k, len(controls))
            yield {"at": place, "sample": 1e3 * control.sample, "period": 1 / law.frequency}


def _control(number: int, count: int) -> str:
    return "top.control" + (f"[{number}]" if count > 1 else "")


@doubt(
    "top.motor: {key} {limit:torque} is below the torque of the start, {torque:torque}: the string does not turn",
    "Give a stronger motor, or reduce friction or torque on bit.",
)
def weak_motor(at: Start) -> Values:
    """The motor of the top drive is weaker than the torque of the start, so the string does not turn."""
    drive = at.model.part(MotorDrive)
    if drive is None or at.continued or is_quasi_static(at.case):
        return
    torque = float(at.model.system.comm.tompi4py().allreduce(drive.start_torque))
    motor = drive.motor
    if motor.max_torque and not motor.min_torque <= torque <= motor.max_torque:
        key, limit = ("max_torque", motor.max_torque) if torque > 0 else ("min_torque", -motor.min_torque)
        yield {"key": key, "limit": limit, "torque": abs(torque)}


@doubt(
    "rig.block_weight {given:force} is not the weight of top.hoist.block_mass, {weight:force}: hook_load_total has the first, "
    "hook_load_sensor the second",
    "Give the same block in both places.",
)
def other_block_weight(at: Start | Built) -> Values:
    """The rig's block weight differs from the weight of the hoist's block, so two hook loads do not agree."""
    rig, hoist = at.case.rig, at.case.top.hoist
    if hoist is None or rig is None or not rig.block_weight or is_quasi_static(at.case):
        return None
    weight = hoist.block_mass * GRAVITY
    return abs(rig.block_weight / weight - 1) > BLOCK_WEIGHT and {"given": rig.block_weight, "weight": weight}


@doubt(
    "top.autodriller: a bit that starts without weight may reach the bottom at up to {speed:rop}, the maximum speed of the drum; "
    "give max_speed, or also the mode rop",
    "Give `max_speed`, or add the mode `rop`.",
)
def fast_touchdown(at: Start | Built) -> Values:
    """An autodriller without a speed limit may run a bit without weight onto the bottom."""
    drill, given = _autodriller(at)
    if drill is None or given is None or given.max_speed is not None or drill.rate is not None:
        return None
    return not at.case.initial.wob and {"speed": drill.most}


@doubt(
    "top.autodriller: from 0 s with initial.from {start}: the hook load is tared before the string hangs on the hook; start the "
    "autodriller later, or start from statics",
    "Begin from statics, or begin the autodriller later.",
)
def early_tare(at: Start | Built) -> Values:
    """An autodriller tares the hook load before the string hangs on the hook, so its weight on bit is wrong."""
    drill, _ = _autodriller(at)
    start = at.case.initial.from_
    if drill is None or drill.start != 0 or start not in ("rest", "straight"):
        return
    if any(q.kind == "wob" for q in drill.loops) and not drill.at_bit and any(at.case.gravity):
        yield {"start": start}


def _autodriller(at: Moment) -> tuple[Any, Any]:
    """The autodriller of a case with a hoist that acts, and as it was given; (None, None) without one."""
    absent = at.case.top.hoist is None or is_quasi_static(at.case)
    return (None, None) if absent else (autodriller_of(at.case), at.case.top.autodriller)


# ---------------------------------------------------------------------- end
@doubt(
    "torque, weight on bit and side forces are unreliable with the steps of this run: {name} at MD {md:length 5} would roll along "
    "the wall at {frequency:.2g} Hz ({rpm:.3g} rpm, radial clearance {clearance:diameter 3}). These steps remove more than "
    "{lost:g} % of the energy of that whirl in each period; time.integrator: auto, or -ts_adapt_dt_max {step:.2g}, keeps it",
    "Use `time.integrator: auto`, or limit the steps with `-ts_adapt_dt_max`.",
)
def whirl_damped(at: End) -> Values:
    """The steps of the run take energy from a part that could whirl, so they may decide whether it does (manual: sec-time-whirl-steps)."""
    return at.whirl is not None and dict(at.whirl)


@doubt(
    "the top pushes the string into the hole {since}, with up to {push:force} at {time:.6g} s: a hook can only pull; the block "
    "would rest on the string",
    "Lower the string more slowly, give less weight, or model the hoist with its line.",
)
def push_in_run(at: End) -> Values:
    """During the run the top pushes the string into the hole, which a hook cannot (manual: sec-outputs-watch)."""
    spell = at.watch.spells.get("push")
    if spell is not None and not at.pushed_at_start:
        yield {"since": _since(at, spell), "push": spell.largest, "time": spell.at}


@doubt(
    "the torque of the motor is above {percent:g} % of its stall torque {stall:torque} {since}, first at {first:.6g} s: the motor "
    "hardly turns, and most of the mud leaks through it",
    "Give less weight on bit, or more flow.",
)
def motor_stalls(at: End) -> Values:
    """The downhole motor comes close to its stall torque (manual: sec-outputs-watch)."""
    spell = at.watch.spells.get("stall")
    if spell is not None:
        stall, percent = at.watch.stall_torque, 100 * NEAR_STALL
        yield {"since": _since(at, spell), "first": spell.first, "stall": stall, "percent": percent}


@doubt(
    "{name}: {how} its stop {since}: it acts as rigid there",
    "Place it where its load lies within its stroke, or choose another spring or preload.",
)
def shock_sub_on_stop(at: End) -> Values:
    """A shock sub reaches an end of its stroke, so its spring does not act there (manual: sec-outputs-watch)."""
    for name, (item, closed) in at.watch.stops.items():
        if name in at.watch.spells:
            how = "closed to" if closed else "extended to"
            yield {
                "name": item.name or "shock sub",
                "how": how,
                "since": _since(at, at.watch.spells[name]),
            }


def _since(at: End, spell: Spell) -> str:
    return f"from {spell.first:.6g} s on in {plain(100 * spell.rows / at.watch.rows, 2)} % of the rows"


@doubt(
    "the pressure of the mud in the {channel} falls to {pressure:pressure 3} gauge at {time:.6g} s, at MD {md:length 6}, first "
    "below the vapour pressure at {first:.6g} s, at MD {first_md:length 6}: the mud would boil, so results there are not valid",
    "Move the string or change the flow more slowly, or give the outlet a pressure.",
)
def boiling(at: End) -> Values:
    """The pressure of the mud falls below its vapour pressure: the mud would boil, which the model does not contain."""
    watch = at.monitors.boiling
    if watch.first is not None and watch.lowest is not None:
        low, first = watch.lowest, watch.first
        depth = at.top + at.model.mesh.node_depth
        yield {
            "channel": low.channel,
            "pressure": low.pressure,
            "time": low.time,
            "md": depth[low.node],
            "first": first.time,
            "first_md": depth[first.node],
        }


@doubt(
    "the free end of the string passes the end of the hole from {first:.6g} s on, by up to {most:length 3}. Nothing stops it there, "
    "so later results belong to a deeper hole; bottom: {{kind: bit}} stands on the bottom",
    "Use `bottom: {kind: bit}`, or stop the lowering earlier.",
)
def end_beyond_hole(at: End) -> Values:
    """A free lower end passes the end of the hole, where nothing in the model stops it (manual: sec-outputs-watch)."""
    watch = at.monitors.free_end
    return watch.first is not None and {"first": watch.first, "most": watch.most}


@doubt(
    "the new hole has waves, with up to {most:dogleg 3} over {course:length 3} at MD {md:length 5}: its build and turn rates are means "
    "over waves and depend on where the run ends",
    "A smaller `formation.bit_anisotropy` removes the waves; more weight on bit makes them smaller.",
)
def wavy_hole(at: End) -> Values:
    """The new hole is more crooked than holes are drilled: a bit that cuts sideways easily copies each kink that its stabilizer passes, and
    the waves grow (manual: sec-bit-waves).

    The build rate of a run is then a mean over waves, which depends on where the run ends."""
    bit = at.model.bit
    hole, well = (bit.hole, bit.drilled_hole()) if bit is not None else (None, None)
    if hole is None or well is None or well.depth - hole.start < 2 * WAVE_COURSE:
        return
    start = hole.start
    md = np.linspace(start, well.depth, int((well.depth - start) / 0.25) + 2)
    severity = dogleg_severity(md, np.asarray(well.at(md)[1]), WAVE_COURSE)
    severity[md < start + WAVE_COURSE] = 0.0  # the kink where the old hole ends
    worst = int(np.argmax(severity))
    if severity[worst] > SHARPEST:  # a survey with such a bend is refused
        yield {"most": float(severity[worst]), "course": WAVE_COURSE, "md": float(md[worst])}


@doubt(
    "sensor {name}: content above {resolved_to:.3g} Hz is not resolved in {percent:.3g} % of the time; petsc.ts_adapt_dt_max "
    "{step:.3g} ms resolves {finest:g} Hz, or a lower filter.cutoff does",
    "Limit the steps with `-ts_adapt_dt_max`, or lower `filter.cutoff`.",
)
def unresolved_sensor(at: End) -> Values:
    """The time steps do not resolve the frequencies that a downhole sensor should record."""
    for row in _sensors(at):
        if row["coarse_share"] > 0:
            yield {**row, "percent": 100 * row["coarse_share"], "step": 1e3 * row["longest_step"]}


@doubt(
    "sensor {name}: accelerations reached the range of {range:g} m/s2 at {clipped} points",
    "Give the sensor a larger `range` to see the whole acceleration.",
)
def clipped_sensor(at: End) -> Values:
    """Accelerations exceed the range of a downhole sensor, which cuts them off."""
    yield from (row for row in _sensors(at) if row.get("clipped"))


def _sensors(at: End) -> list[dict[str, Any]]:
    return [] if at.recorder.sensors is None else at.recorder.sensors.rows()


@doubt(
    "top.hoist: the lines would be slack from t = {time:.4g} s on; in the model they push the block",
    "Lower the block more slowly; results after that time are not valid.",
)
def slack_line(at: End) -> Values:
    """The drilling line would go slack, but the model's line pushes the block instead."""
    for hoist in at.model.parts(HoistLine):
        if hoist.slack is not None:
            yield {"time": hoist.slack}


@doubt(
    "friction of {force:force 3} held by creep of {speed:creep 3} at the end: held loads relax with time; a smaller "
    "contact.slip_velocity ({slip:creep 3}) creeps less",
    "Give a smaller `contact.slip_velocity`, or read held loads soon after the motion ends.",
)
def held_by_creep(at: End) -> Values:
    """At the end, regularised friction holds the string while it creeps or slides slowly, so held loads relax with time (manual: sec-contact-creep)."""
    model, top = at.model, at.case.top
    if not at.finished or at.recorder.energy is None or model.contact is None:  # quasi-static: no slip
        return
    if top.rotation is not None and top.rotation.value(at.time) != 0.0:
        return
    force, speed = creep.held_by_creep(model)
    weight = float(np.sum(model.effective_mass * model.mesh.length) * np.linalg.norm(at.case.gravity))
    if force > CREPT * weight:
        yield {"force": force, "speed": speed, "slip": model.contact.law.slip_velocity}


@doubt(
    "contact.slip_velocity ({slip:creep 3}) lets a bit that sticks creep at up to {speed:rotation 3}, {percent:.2g} % of its rotary "
    "speed: in stick-slip its peak speed may be some per cent too low",
    "Give a smaller `contact.slip_velocity`, and compare: a twentieth gave 3.4 % more in the laboratory rig.",
)
def rounded_sticking(at: Start | Built) -> Values:
    """A small bit that sticks creeps at a notable speed, and its peak speed in stick-slip may be too low.

    The slip velocity is meant for bits of the field. With its default, a laboratory bit of 100 mm has a peak speed that is 3.4 % too
    low (*Measured wells*); a bit of 215.9 mm at 50 rpm 0.2 %."""
    bit, rotation = at.model.part(RockBit), at.case.top.rotation
    if bit is None or not isinstance(bit.law, Weakening) or rotation is None or at.case.time is None:
        return
    turning = abs(rotation.value(at.case.time.end))
    if bit.rounding > max(CREEPS, ROUNDED * turning) and turning:
        percent = 100 * bit.rounding / turning
        yield {"slip": bit.contact.slip, "speed": bit.rounding, "percent": percent}


@doubt(
    GAINED,
    "Use a smaller `-ts_rtol`, `-ts_bdf_order 1`, or `contact: {energy_strict: true}`.",
)
def energy_gained(at: End) -> Values:
    """The time steps have created more energy than allowed, so the run is not accurate enough."""
    return at.gain.summary().get("flag") and at.gain.figures()


@doubt(
    "formulation: hermite leaves {percent:.2g} % of the energy exchanged unbalanced, whatever the time steps: "
    "compare with formulation: mixed before you use these results",
    "Use `formulation: mixed`.",
)
def unbalanced_volumes(at: End) -> Values:
    """With `formulation: hermite` the energy of mud and string is not balanced in some runs, whatever the time steps."""
    fluid, energy = at.case.fluid, at.recorder.energy
    if fluid is None or fluid.formulation != "hermite" or energy is None:
        return None
    share = energy.last_error / energy.exchanged
    return abs(share) > UNBALANCED and {"percent": 100 * abs(share)}


@doubt(
    "formulation: hermite lets the mud flow in the hole that was beside the string at the start: the hole there now differs by up to "
    "{percent:.2g} % of its diameter, and pressure losses and waves are those of the start",
    "Use `formulation: mixed`, which reads the hole where the string is.",
)
def hole_of_start(at: End) -> Values:
    """With `formulation: hermite` the mud beside an element keeps the hole of the start, though the string has moved into another section."""
    annulus = at.model.annulus
    if not at.finished or not isinstance(annulus, HermiteAnnulus):
        return None
    share = largest(at.model.system.comm, annulus.other_hole())
    return share > OTHER_HOLE and {"percent": 100 * share}
