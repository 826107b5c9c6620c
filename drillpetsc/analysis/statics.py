"""The `statics` command: equilibrium of a case, its table along the string and its summary."""

from __future__ import annotations

from pathlib import Path

from petsc4py import PETSc

from drillpetsc.analysis.equilibrium import MOTIONS, StaticState
from drillpetsc.analysis.initial_state import find_equilibrium
from drillpetsc.analysis.static_report import static_summary, static_table
from drillpetsc.analysis.transient import make_folder
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import refuse_quaternion
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import FieldWriter, RunFolder, write_summary, write_table
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.well_files import write_well_files
from drillpetsc.solvers import petsc_options as options


def run_statics(
    case: Case,
    out: str | Path | None = None,
    motion: str | None = None,
    overwrite: bool = False,
    name: str = "case",
    comm: PETSc.Comm | None = None,
) -> list[str]:
    """Solve for the equilibrium, write statics.csv, string.pvd and summary.json; returns the lines to show.

    motion: hoist, lower or rotate; None takes the motion that the top prescribes at time 0.  Collective.
    """
    refuse_quaternion(case, "statics")
    comm = comm or PETSc.COMM_WORLD
    if motion is not None and case.well is None:
        raise CaseError(
            at="--motion", got=motion, want="a case with a well: without a hole there is no friction"
        )
    with options.applied(case.petsc):
        model = build_model(case, comm)
        folder = make_folder(comm, name, out, False, overwrite)
        state = find_equilibrium(model, MOTIONS[motion] if motion else None, lateral_friction=False)
        columns, values = static_table(model, state)
        summary = {
            "title": case.title,
            **static_summary(model, state),
            "motion": motion or "as the top prescribes",
        }
        fields = Recorder(model).fields(0.0)
        if comm.rank == 0:
            _write(model, folder, columns, values, summary, fields)
    return _lines(case, folder, state, summary)


def _write(model, folder: RunFolder, columns, values, summary, fields) -> None:
    model.case.dump(folder.case)
    if values is not None:
        write_table(folder.statics, columns, list(values.T))
    if fields is not None:
        FieldWriter(folder.path).write(0.0, *fields)
    if model.well is not None:
        write_well_files(model, folder)
    write_summary(folder.summary, summary)


def _lines(case: Case, folder: RunFolder, state: StaticState, summary) -> list[str]:
    lines = [f"{case.title or 'case'}: static equilibrium, motion {summary['motion']}"]
    shown = (
        ("hook_load", "hook load", "N"),
        ("surface_torque", "surface torque", "N m"),
        ("wob", "weight on bit", "N"),
        ("bit_torque", "torque on bit", "N m"),
        ("stretch", "stretch", "m"),
        ("twist", "twist", "rad"),
    )
    for key, words, unit in shown:
        if summary.get(key) is not None:
            lines.append(f"  {words:<15} {summary[key]:>14.6g} {unit}")
    stable = "stable" if state.stable else f"UNSTABLE: {state.equilibrium.negative_pivots} negative pivots"
    lines.append(
        f"  {stable}; {state.equilibrium.iterations} Newton iterations, residual {state.equilibrium.residual:.2g} N"
    )
    lines += [f"  note: {w}" for w in state.warnings]
    lines.append(f"  results: {folder.path}   (scripts/drillpetsc plot {folder.path})")
    return lines
