"""Alarms, and differences of the models, in words that a driller acts on."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.follow.alarms import (
    INSIDE,
    PRESSURE,
    PRESSURE_LOST,
    PULL,
    RUN_IN,
    TORQUE,
    WEIGHT,
    Alarm,
)
from drillpetsc.analysis.follow.follower import Follower, Update
from drillpetsc.analysis.loads.torque_drag.batch import Columns, Hole, soft_strings
from drillpetsc.analysis.loads.torque_drag.operations import groups_of
from drillpetsc.analysis.loads.torque_drag.roadmap import densities_of
from drillpetsc.analysis.loads.torque_drag.string_rows import gravity_of, mud_in_bore, rows_at
from drillpetsc.analysis.loads.torque_drag.table import still_mud, stress_and_margin
from drillpetsc.case.case import Case
from drillpetsc.unit_systems import shown

LOOK_FOR = {
    PULL: "tight hole, cuttings or a ledge",
    RUN_IN: "a ledge, cuttings or lost weight",
    TORQUE: "cuttings packing off, or a worn or balling bit",
    WEIGHT: "a parted string or a washout; compare pressure",
    PRESSURE: "packing off or plugged nozzles",
    PRESSURE_LOST: "a washout, a lost nozzle or a pump that fails",
}
STIFF = "stiff string"
_KIND = {"hook_load": "force", "torque": "torque", "pump_pressure": "pressure"}
_READING = {PULL: "hook_load", RUN_IN: "hook_load", WEIGHT: "hook_load", TORQUE: "torque"}


def told(case: Case, alarm: Alarm, update: Update, follower: Follower) -> str:
    """The text of an alarm in the units of the case."""
    units = case.shown_units
    reading = _READING.get(alarm.kind, "pump_pressure")
    size = shown(abs(alarm.excess), _KIND[reading], units, 3, plot=reading == "torque")
    where, since = (shown(q, "length", units, 5) for q in (alarm.bit_depth, alarm.since))
    side = "above" if alarm.excess > 0 else "below"
    text = f"MD {where}, {alarm.operation.replace('_', ' ')}: {alarm.kind}, {size} ({abs(alarm.share):.0%}) {side} the forecast of one stand before, "
    text += f"building since MD {since}; {_margin(case, reading, update, follower)}; look for {LOOK_FOR[alarm.kind]}"
    return text


def models_told(case: Case, update: Update) -> dict[str, str]:
    """reading -> where beam and soft string differ by more than the 90 % band of its forecast, and which one to trust."""
    both, load, units, out = update.compared, update.reading.load, case.shown_units, {}
    if both is None:
        return {}
    where = shown(load.bit_depth, "length", units, 5)
    for k, name in enumerate(("hook_load", "torque")):
        off, error = float(both.stiff[k] - both.soft[k]), update.forecast.get(name)
        if error is None or abs(off) <= INSIDE * error.sd:
            continue
        size, band = (shown(q, _KIND[name], units, 3, plot=k == 1) for q in (abs(off), INSIDE * error.sd))
        side = "above" if off > 0 else "below"
        text = f"MD {where}, {load.operation.replace('_', ' ')}: {STIFF}, {name.replace('_', ' ')} {size} "
        text += f"({abs(off / both.soft[k]):.0%}) {side} the soft string's, beyond the 90 % band of {band}; "
        if both.origins is None:
            out[name] = text + "trust neither: buckled and held by friction, it has one of several states"
            continue
        origin, more_drag = both.origins[k], off * (1.0 if k else load.velocity) > 0
        why = (
            "presses on bends of the hole" if more_drag else "bridges bends of the hole within its clearance"
        )
        why = "is coiled, which the soft string has as a formula" if origin.coiled else why
        place = " to ".join(shown(q, "length", units, 4) for q in (origin.upper, origin.lower))
        out[name] = f"{text}trust the stiff string: most of it arises at MD {place}, where the pipe {why}"
    return out


def _margin(case: Case, reading: str, update: Update, follower: Follower) -> str:
    """The margin left, in words."""
    row, rig, units = update.reading, case.rig, case.shown_units
    if reading == "torque":
        largest = None if rig is None else rig.max_surface_torque
        if largest is None:
            return "margin unknown: the case has no rig.max_surface_torque"
        return f"{shown(largest - row.torque, 'torque', units, 3, plot=True)} left to rig.max_surface_torque"
    if reading == "pump_pressure":
        return f"pump pressure {shown(row.pump_pressure, 'pressure', units, 4)}"
    margins = {"the strength of the string": _strength_left(case, update, follower)}
    if rig is not None and rig.max_hookload is not None:
        margins["rig.max_hookload"] = rig.max_hookload - row.hook_load
    known = {name: q for name, q in margins.items() if np.isfinite(q)}
    if not known:
        return "margin unknown: neither a grade of the pipe nor rig.max_hookload is given"
    name = min(known, key=lambda q: known[q])
    return f"{shown(known[name], 'force', units, 3)} of pull left to {name}"


def _strength_left(case: Case, update: Update, follower: Follower) -> float:
    """Pull [N] left to 90 % of the yield strength, with the friction as estimated and the hook load as read."""
    load, strings = update.reading.load, follower.strings
    of = dict(zip((q.name for q in follower.states), update.belief.mean, strict=True))
    placed = rows_at(case, load.bit_depth, "bit depth")
    hole = Hole(strings.well, [placed])
    friction = groups_of(case).friction({name: [float(np.clip(mu, 0.0, 1.0))] for name, mu in of.items()})
    columns = Columns(
        np.zeros(1, dtype=int), friction, load.wob, np.nan_to_num(load.torque_on_bit), load.velocity, load.rotation,
        weight_factor=of["weight_factor"],
    )  # fmt: skip
    batch = soft_strings(hole, columns)
    mud = still_mud(hole, [mud_in_bore(case, placed.depth)], densities_of(case), gravity_of(case, "follow"))
    margin = float(stress_and_margin(hole, columns, batch, mud)[1][0])
    top = float(batch.tension[0, 0]) + of["block_weight"]
    return margin - max(update.reading.hook_load - top, 0.0)
