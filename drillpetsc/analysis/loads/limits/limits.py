"""The `limits` command: stresses, strength, buckling, fatigue and contacts of a static state, with what is left."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.limits.along_string import State, Surroundings, static_state
from drillpetsc.analysis.loads.limits.buckling_loads import law_words
from drillpetsc.analysis.loads.limits.contacts import contact_rows, item_forces
from drillpetsc.analysis.loads.limits.doubts import Judged
from drillpetsc.analysis.loads.limits.operations import (
    OPERATIONS,
    case_of,
    motion_of,
    read_operation,
    words_of,
)
from drillpetsc.analysis.loads.limits.soft_limits import SoftLimits
from drillpetsc.analysis.loads.limits.table import Choices, Strength, element_values, rows
from drillpetsc.analysis.loads.torque_drag.operations import (
    assumed,
    grades_assumed,
    plan_of,
    rotation_note,
    told,
    torque_of_bit,
)
from drillpetsc.analysis.loads.torque_drag.string_rows import bends_left_out, cutters_left_out
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.equilibrium import MOTIONS, StaticState
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import prescribed_motion
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import refuse_quaternion
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import Answer
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.string_forces import held_at_weight
from drillpetsc.output.files.json_file import plain
from drillpetsc.output.files.run_folder import CONTACTS_TABLE, LIMITS_TABLE
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.static_table import static_table
from drillpetsc.output.watches.buckling import buckling
from drillpetsc.physics.bit.bit_on_bottom import bit_torque
from drillpetsc.unit_systems import System, shown

NO_FORCE = 1e-5  # share of the largest force below which the end of a string is not in compression
NO_TORQUE = 1e-5  # over the hook load [m]: the torque of a string that only slides
NO_SHARE = 1e-4  # of a limit, not worth a line
#: keys of the summary that are figures of the static state
OF_STATE = ("motion", "hook_load", "hook_load_total", "surface_torque", "wob", "bit_torque", "stable")
#: summary key, column, True for its largest value, words
WEAKEST = (
    ("safety_factor", False, "Safety factor"),
    ("tension_ratio", True, "Tension over limit"),
    ("torque_ratio", True, "Torque over limit"),
    ("make_up_ratio", True, "Torque over make-up torque"),
    ("fatigue_ratio", True, "Dogleg over permissible"),
    ("side_force_per_joint", True, "Side force per joint"),
    ("burst_ratio", True, "Inside pressure over burst"),
    ("collapse_ratio", True, "Outside pressure over collapse"),
    ("damage_per_hour", True, "Miner's damage per hour"),
    ("casing_wear_rate", True, "Rate of casing wear"),
)


def run_limits(job: Job, operation: str | None = None, choices: Choices | None = None) -> RunResult:
    """Solve for the equilibrium of a case in an operation (collective).

    operation: a word of OPERATIONS or of the trade; None: the case as it is, moving as its top prescribes.
    Raises CaseError if the case cannot be in the operation, SolveError without equilibrium.
    """
    given, comm = job.case, job.comm
    choices, units = choices or Choices(), given.shown_units
    refuse_quaternion(given, "limits")
    if given.hold_string:
        want = "a string that is free to move: a held one has no forces"
        raise CaseError(at="hold_string", got=True, want=want)
    word = read_operation(operation)
    case = held_at_weight(given if word is None else case_of(given, word))
    motion = None if word is None else motion_of(case, word)
    with options_of(case, given):
        model = build_model(case, comm, motion)
        folder = job.make_folder()
        state = find_equilibrium(model, motion, False)
        columns, nodal = static_table(model)
        buckled = buckling(model, columns, nodal) if nodal is not None else None
        statics = static_summary(model, state)
        rotation = state.motion[1] and prescribed_motion(model)[1]
        at_rest = Answer(model=model, figures=statics, rotation=rotation, table=(columns, nodal))
        doubts, remarks = (doubts_at(at_rest, kind) for kind in ("warning", "remark"))
        found, forces = static_state(model), item_forces(model)
        answer: Any = None
        tables: dict[str, list[dict[str, Any]]] = {}
        if comm.rank == 0:
            assert found is not None
            hole, pipe = Surroundings(model), Strength(model, choices)
            turning = _rotation(case, word)
            values = element_values(model, found, hole, pipe, choices, turning)
            table = rows(model, values)
            contacts = [] if forces is None else contact_rows(model, found.nodes, found.tangent, forces)
            soft = SoftLimits(model, choices.helical)
            judged = Judged(
                model=model,
                table=table,
                weakest={name: _worst(table, name, most) for name, most, _ in WEAKEST if name in table},
                choices=choices,
                word=word,
                turning=turning,
                wob=statics.get("wob", 0.0),
                soft=soft.works,
                strength=bool(np.isfinite(pipe.tension_limit).any()),
            )
            summary = {
                "title": case.title,
                "operation": word or "as the case",
                **{key: statics[key] for key in OF_STATE if key in statics},
                "choices": asdict(choices),
                "helical_law": law_words(choices.helical),
                "units": units,
                "neutral_point": {
                    "effective": _neutral_point(table, "effective_tension"),
                    "true": _neutral_point(table, "axial_force"),
                },
                "weakest": judged.weakest,
                "contacts": plain(contacts),
                "rig": None if case.rig is None else case.rig.model_dump(),
                "notes": [
                    *remarks,
                    *doubts_at(judged, "remark"),
                    *grades_assumed(case),
                    *_torque_notes(given, word),
                    *(bends_left_out(case) + cutters_left_out(case) if soft.works else ()),
                ],
                **_margins(model, found, pipe, soft),
                "buckling": {} if buckled is None else buckled.as_dict(),
                "warnings": [*_state_warnings(state, word), *doubts_at(judged, "warning"), *doubts],
            }
            answer = summary
            cells = zip(*table.values(), strict=True)
            tables = {
                LIMITS_TABLE: [dict(zip(table, row, strict=True)) for row in cells],
                CONTACTS_TABLE: contacts,
            }
        summary = comm.tompi4py().bcast(answer)
    return job.result(folder, summary, _lines(given, summary, units), tables)


def _rotation(case: Case, word: str | None) -> float:
    """Rotation of the string in an operation [rad/s]; 0 where it slides.

    word: the operation; None: the case as it is, with the rotation of its top at time 0.
    """
    if word is None:
        return 0.0 if case.top.rotation is None else float(case.top.rotation.value(0.0))
    return motion_of(case, word)[1]


# ---------------------------------------------------------------------- summary
def _torque_notes(case: Case, word: str | None) -> list[str]:
    """Where the torque on bit and the speeds of the operation come from, where the case does not give them."""
    bottom, bit = case.bottom, case.string[-1]
    plan = plan_of(case)
    if word in ("drilling", "backreaming"):
        return [note for note in (assumed(case, plan, word), rotation_note(case, plan)) if note]
    if word is not None or case.formation is not None or not isinstance(bottom, BitBottom):
        return []
    if bit.od is None or not case.initial.wob:
        return []
    units = case.shown_units
    own, other = bit_torque(case.initial.wob, bottom.friction, 0.5 * bit.od), torque_of_bit(case, plan)
    given = "" if "friction" in bottom.model_fields_set else ", the default"
    more = (
        ""
        if abs(own - other) < 0.01 * other
        else f"; --operation drilling takes the roadmap's, {shown(other, 'torque', units)}"
    )
    if not given and not more:
        return []
    return [
        f"torque on bit while the string rotates: {shown(own, 'torque', units)} from bottom.friction {bottom.friction:g}{given}{more}"
    ]


def _worst(table: dict[str, Any], name: str, largest: bool) -> dict[str, Any] | None:
    """Value, measured depth [m] and item of the largest or smallest entry of a column; None if it is empty."""
    values = table[name]
    known = np.isfinite(values)
    if name == "side_force_per_joint":  # the trade's limit is for tool joints
        known &= table["jointed"] > 0
    if not known.any():
        return None
    at = np.flatnonzero(known)[int((np.argmax if largest else np.argmin)(values[known]))]
    return {"value": float(values[at]), "md": float(table["md"][at]), "item": str(table["item"][at])}


def _neutral_point(table: dict[str, Any], name: str) -> dict[str, float] | None:
    """Lowest measured depth [m] at which a force changes from tension above to compression below, and its height
    above the string's lower end [m]; None if there is none."""
    known = np.isfinite(table[name])
    md, force = table["md"][known], table[name][known]
    least = NO_FORCE * float(np.abs(force).max(initial=0.0))
    change = np.flatnonzero((force[:-1] > 0) & (force[1:] <= 0))
    if not len(change) or not (force[change[-1] + 1 :] < -least).any():  # a free end carries nothing
        return None
    k = int(change[-1])
    depth = md[k] + (md[k + 1] - md[k]) * force[k] / (force[k] - force[k + 1])
    return {"md": float(depth), "above_bit": float(table["md"].max() - depth)}


def _margins(model: DrillingModel, found: State, pipe: Strength, soft: SoftLimits) -> dict[str, Any]:
    """Margin of overpull, largest weights on bit and largest slack-off, by the soft string."""
    none: dict[str, Any] = dict.fromkeys(
        ("margin_of_overpull", "max_overpull_at_bit", "max_wob", "max_slackoff", "available_wob"), None
    )
    if not soft.works:
        return none
    out = dict(none)
    limit, pressure = pipe.tension_limit[:, None] * np.ones((1, 2)), found.axial - found.effective
    if np.isfinite(limit).any():
        out |= _overpull(soft, limit, pressure)
        if (still := _still_pressure(model)) is not None:
            out["margin_of_overpull_still"] = _overpull(soft, limit, still)["margin_of_overpull"]
    out["max_wob"] = {
        operation: {
            which: soft.max_wob(operation, which == "helical").as_dict("wob")
            for which in ("sinusoidal", "helical")
        }
        for operation in ("drilling", "sliding")
    }
    most = out["max_wob"]["sliding"]["helical"]["wob"]
    if most is not None:
        lower = motion_of(model.case, "sliding")
        out["max_slackoff"] = soft.run(lower, 0.0).hook_load - soft.run(lower, most).hook_load
    rig = model.case.rig
    block = (rig.block_weight if rig is not None else None) or 0.0
    out["available_wob"] = {word: soft.available_wob(word, block) for word in ("drilling", "sliding")}
    return out


def _still_pressure(model: DrillingModel) -> FloatArray | None:
    """(n, 2) tension of the wall less effective tension [N] in still mud; None if no mud is pumped."""
    fluid, case, mesh = model.fluid, model.case, model.mesh
    if (
        fluid is None
        or case.fluid is None
        or case.fluid.flow_rate is None
        or not case.fluid.flow_rate.value(0.0)
    ):
        return None
    gravity = float(np.linalg.norm(np.array(case.gravity, dtype=float)))
    pressure = case.fluid.density * gravity * np.maximum(Surroundings(model).tvd, 0.0)
    inside = 0.0 if fluid.bore is None else mesh.tube_bore_area[:, None]
    outside = 0.0 if fluid.annulus is None else mesh.tube_outer_area[:, None]
    return np.asarray(pressure * (inside - outside))


def _overpull(soft: SoftLimits, limit: FloatArray, pressure: FloatArray) -> dict[str, Any]:
    """Margin of overpull along the string at pick-up, and the pull at the bit that uses it up with friction."""
    lift = MOTIONS["hoist"]
    tension = soft.tension(lift, 0.0) + pressure
    left = np.where(np.isfinite(limit), limit - tension, np.inf)
    md, item = soft.place(-left)
    at = np.unravel_index(int(np.argmin(left)), left.shape)
    margin = {
        "margin": float(left.min()),
        "ratio": float(limit[at] / tension[at]) if tension[at] > 0 else None,
        "md": md,
        "item": item,
        "hook_load": soft.run(lift, 0.0).hook_load,
    }
    return {
        "margin_of_overpull": margin,
        "max_overpull_at_bit": soft.max_overpull(limit, pressure).as_dict("pull"),
    }


# ---------------------------------------------------------------------- words
def _state_warnings(state: StaticState, word: str | None) -> list[str]:
    """Warnings of the static state; one off bottom may reach below the end of the hole by its stretch."""
    off_bottom = word is not None and not OPERATIONS[word].on_bottom
    return [w for w in state.warnings if not (off_bottom and w.startswith("the string's end lies"))]


def _lines(case: Case, summary: dict[str, Any], units: System) -> list[str]:
    """What the command prints."""
    word = summary["operation"]
    doing = words_of(case, word, units) if word in OPERATIONS else word
    told_lines = [f"  {told(case, plan_of(case), word, units)}"] if word in OPERATIONS else []
    rows = [
        *_load_rows(summary, units),
        *_weakest_rows(summary, units),
        *_margin_rows(summary, units),
        *_contact_rows(summary, units),
    ]
    lines = [f"{case.title or 'case'}: limits, {doing}", *told_lines]
    return lines + [f"  {label:<38}{text}" for label, text in rows]


Row = tuple[str, str]  # label and text of a printed row


def _place(row: dict[str, Any], units: System) -> str:
    return f"at MD {shown(row['md'], 'length', units, 5)} ({row['item']})"


def _load_rows(summary: dict[str, Any], units: System) -> Iterator[Row]:
    """Loads of the state, and where the string is neutral."""
    for key, label, kind in (
        ("hook_load_total", "Hook load with the block", "force"),
        ("hook_load", "Hook load", "force"),
        ("surface_torque", "Surface torque", "torque"),
        ("wob", "Weight on bit", "force"),
        ("bit_torque", "Torque on bit", "torque"),
    ):
        value = summary.get(key)
        if value is not None and (key != "bit_torque" or value):
            none = kind == "torque" and abs(value) < NO_TORQUE * abs(summary["hook_load"])
            yield label, shown(0.0 if none else value, kind, units)
    for key, label in (
        ("effective", "Neutral point, effective tension"),
        ("true", "Neutral point, axial force"),
    ):
        point = summary["neutral_point"][key]
        if point is None:
            yield label, "none"
        else:
            depth, above = shown(point["md"], "length", units, 5), shown(point["above_bit"], "length", units)
            yield label, f"MD {depth}, {above} above the lower end"


def _weakest_rows(summary: dict[str, Any], units: System) -> Iterator[Row]:
    """The worst place of each limit."""
    for name, _, label in WEAKEST:
        worst = summary["weakest"].get(name)
        least = NO_SHARE if name.endswith("_ratio") else 0.0
        if worst is not None and abs(worst["value"]) >= least:
            of = {"side_force_per_joint": "force", "casing_wear_rate": "wear_rate"}.get(name)
            value = shown(worst["value"], of, units) if of else f"{worst['value']:.3g}"
            yield label, f"{value} {_place(worst, units)}"


def _margin_rows(summary: dict[str, Any], units: System) -> Iterator[Row]:
    """What is left to pull, to push and to slack off."""
    margin = summary["margin_of_overpull"]
    if margin is not None:
        yield "Margin of overpull", f"{shown(margin['margin'], 'force', units)} {_place(margin, units)}"
        if (still := summary.get("margin_of_overpull_still")) is not None:
            text = f"{shown(still['margin'], 'force', units)} {_place(still, units)}"
            yield "Margin of overpull, pumps off", text
        pull = summary["max_overpull_at_bit"]
        if pull["pull"] is not None:
            text = f"{shown(pull['pull'], 'force', units)}, limited {_place(pull, units)}"
            yield "Largest overpull at the bit", text
    for operation, loads in (summary["max_wob"] or {}).items():
        for which, row in loads.items():
            text = "no limit found"
            if row["wob"] is not None:
                text = f"{shown(row['wob'], 'force', units)}, first {_place(row, units)}"
            yield f"Weight on bit, {operation}, {which}", text
    for operation, row in (summary["available_wob"] or {}).items():
        if row["wob"] is not None:
            why = "then it coils" if row["limited_by"] == "helical" else "then no hook load is left"
            yield f"Available weight on bit, {operation}", f"{shown(row['wob'], 'force', units)}, {why}"
    if summary["max_wob"]:
        yield "Law of the helical limit", summary["helical_law"]
    if summary["max_slackoff"] is not None:
        yield "Largest slack-off", shown(summary["max_slackoff"], "force", units)


def _contact_rows(summary: dict[str, Any], units: System) -> Iterator[Row]:
    """Side forces on rigid items."""
    for row in summary["contacts"]:
        if row["gap"] is None and row["tilt"] is None:
            continue
        force = "-" if row["side_force"] is None else shown(row["side_force"], "force", units)
        if row["side_force"] is not None and row["contact_force_sum"] > 1.01 * row["side_force"]:
            force += f" and a couple of {shown(row['side_couple'], 'torque', units)}"
        if row["direction"] is not None:
            force += f", towards {round(np.degrees(row['direction'])) % 360} deg"
        yield f"Side force on {row['item']}", f"{force}, at MD {shown(row['md'], 'length', units, 5)}"
