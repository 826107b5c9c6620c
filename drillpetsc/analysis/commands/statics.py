"""The `statics` command: equilibrium of a case, its table along the string and its summary."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.limits.operations import OPERATIONS, case_of, motion_of, read_operation
from drillpetsc.analysis.loads.torque_drag.operations import plan_of, told
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.equilibrium import MOTIONS, StaticState
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.path.path_answer import PathKind
from drillpetsc.analysis.statics.path.path_question import has_path
from drillpetsc.analysis.statics.placement import prescribed_motion
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import refuse_quaternion
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import StaticAnswer
from drillpetsc.errors import CaseError
from drillpetsc.fem.quantity import Quantity
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.string_forces import held_at_weight
from drillpetsc.output import FieldWriter, write_table
from drillpetsc.output.files.well_files import write_well_files
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.measured.field_output import FieldOutput
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.output.static_table import static_table
from drillpetsc.output.watches.buckling import Buckling, buckling
from drillpetsc.unit_systems import System, display, kind_of, shown


def run_statics(
    job: Job,
    motion: str | None = None,
    path: PathKind | None = None,
    operation: str | None = None,
) -> RunResult:
    """Solve for the equilibrium, write statics.csv, string.pvd and summary.json.

    motion: hoist, lower or rotate; None takes the motion that the top prescribes at time 0.  Collective.
    operation: instead of a motion, a word of OPERATIONS or of the trade, which says whether the bit is on bottom, too.
    path: sliding or slack_off, the question that a path answers (manual: sec-statics-path).
    """
    case, comm = job.case, job.comm
    given, word = case, read_operation(operation)
    case, moving = question_of(case, motion, operation)
    with options_of(case, given):
        model = build_model(case, comm, moving)
        folder = job.make_folder()
        state = find_equilibrium(model, moving, False, path)
        columns, values = static_table(model)
        buckled = buckling(model, columns, values) if values is not None else Buckling()
        figures, one = static_summary(model, state), state.path is None or len(state.path.ends) == 1
        state.warnings += doubts_at(
            StaticAnswer(
                model=model,
                figures=figures,
                rotation=state.motion[1] and prescribed_motion(model)[1],
                table=(columns, values),
                buckled=buckled,
                slides=bool(buckled) and _slides_unfollowed(model, state),
                band=state.band if one else None,
                has_path=has_path(model, state.motion),
                lowering=(prescribed_motion(model) if moving is None else moving)[0],
            )
        )
        summary = {
            "title": case.title,
            **figures,
            "motion": motion or word or "as the top prescribes",
            "warnings": list(state.warnings),
            **(state.path.as_dict() if state.path is not None else {}),
            **({"buckling": buckled.as_dict()} if model.beam.moves else {}),
            **({"helix_band": asdict(state.band)} if buckled and state.band is not None else {}),
        }
        fields = FieldOutput(model).fields(0.0)
        if comm.rank == 0:
            if fields is not None:
                FieldWriter(folder.path).write(0.0, *fields)
            if values is not None:
                write_table(folder.statics, columns, list(values.T))
            write_well_files(model, folder)
    return job.result(folder, summary, _lines(given, state, summary))


def question_of(
    case: Case, motion: str | None = None, operation: str | None = None
) -> tuple[Case, tuple[float, float] | None]:
    """The case of a static question, and the motion that friction opposes, None: that of the top.

    motion, operation: as in ``run_statics``.  Raises CaseError for a question that the case does not have.
    """
    refuse_quaternion(case, "statics")
    if motion is not None and case.well is None:
        raise CaseError(
            at="--motion", got=motion, want="a case with a well: without a hole there is no friction"
        )
    moving, word = MOTIONS[motion] if motion else None, read_operation(operation)
    if word is not None:
        if motion is not None:
            raise CaseError(at="--motion", got=motion, want="one of --motion and --operation")
        case, moving = case_of(case, word), motion_of(case, word)
    return held_at_weight(case), moving


def _slides_unfollowed(model: DrillingModel, state: StaticState) -> bool:
    """Whether friction opposes a sliding string whose state was found without a path, although one has a meaning."""
    if (
        state.path is not None
        or not state.motion[0]
        or model.well is None
        or not has_path(model, state.motion)
    ):
        return False
    return bool(np.any(np.asarray(model.well.friction(model.mesh.node_depth)) > 0))


def _lines(case: Case, state: StaticState, summary: dict[str, Any]) -> list[str]:
    units = case.said_units
    lines = [f"{case.title or 'case'}: static equilibrium, motion {summary['motion']}"]
    lines += (
        [f"  {told(case, plan_of(case), summary['motion'], units)}"]
        if summary["motion"] in OPERATIONS
        else []
    )
    for q in COLUMNS["static_summary"]:
        if summary.get(q.name) is not None:
            number, unit = in_units(summary[q.name], q, units)
            lines.append(f"  {q.label.lower():<15} {number:>14.6g} {unit}")
    for item in summary.get("rigid_items", ()):
        force, unit = display(item["side_force [N]"], "force", units)
        depth, length = display(item["md [m]"], "length", units)
        couple = ""
        if item["contact_force_sum [N]"] > 1.01 * item["side_force [N]"]:  # its ends push to different sides
            couple = f", couple {shown(item['side_couple [N m]'], 'torque', units)}"
        lines.append(
            f"  side force      {force:>14.6g} {unit:<3} on {item['name']} at {depth:g} {length}{couple}"
        )
    held = state.path is not None and state.path.held_by_friction
    stable = (
        "stable"
        if state.stable
        else "held by friction"
        if held
        else f"UNSTABLE: {state.equilibrium.negative_pivots} negative pivots"
    )
    # a path ends in a motion, whose residual is not computed
    residual = (
        f", residual {shown(state.equilibrium.residual, 'force', units, 2)}" if state.path is None else ""
    )
    lines.append(f"  {stable}; {state.equilibrium.iterations} Newton iterations{residual}")
    return lines


def in_units(value: float, quantity: Quantity, units: System) -> tuple[float, str]:
    """(number, unit text) of a value [SI] of an output, as a system of units shows it."""
    kind = kind_of(quantity.unit, quantity.kind)
    return display(value, kind, units) if kind and units != "SI" else (value, quantity.unit)
