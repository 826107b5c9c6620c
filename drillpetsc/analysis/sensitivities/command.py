"""The `sensitivities` command: derivatives of the outputs of statics, roadmap or hydraulics by numbers of the case."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.sensitivities.answer import Answer
from drillpetsc.analysis.sensitivities.derivatives import Derivative, checked, derivatives
from drillpetsc.analysis.sensitivities.hydraulics import SteadyHydraulics
from drillpetsc.analysis.sensitivities.keys import Key, every_key, key_of
from drillpetsc.analysis.sensitivities.motion.command import run_sensitivities_of_run
from drillpetsc.analysis.sensitivities.points import refusal_of
from drillpetsc.analysis.sensitivities.roadmap import SoftRoadmap
from drillpetsc.analysis.sensitivities.solution import Output, Solution
from drillpetsc.analysis.sensitivities.statics import StaticsSolution
from drillpetsc.analysis.sensitivities.stiff import StiffRoadmap
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import suggestion
from drillpetsc.errors import CaseError
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.progress import counted

#: outputs that are differentiated unless others are named
USUAL = {
    "statics": ("hook_load", "surface_torque"),
    "roadmap": ("hook_load", "surface_torque"),
    "hydraulics": ("pump_pressure", "ecd_bit"),
}
ALL = "all"


@dataclass(frozen=True)
class Question:
    """What is differentiated by what.

    analysis: statics, roadmap, hydraulics or run; motion, operation: of statics; depths: deepest or all, of a roadmap; model: soft or stiff.
    outputs: names, none: the usual ones, `all`: every one; keys: paths, none with ``every``.
    every: all continuous numbers of the case; check: number of derivatives compared with full solutions.
    """

    analysis: str
    outputs: Sequence[str]
    keys: Sequence[str]
    every: bool = False
    check: int = 0
    motion: str | None = None
    operation: str | None = None
    depths: str = "deepest"
    model: str = "soft"


def run_sensitivities(job: Job, question: Question) -> RunResult:
    """Solve once, differentiate, write sensitivities.csv and summary.json (collective).

    Raises CaseError for an output that the case does not have, and for a key that is not a continuous number of it.
    """
    case = job.case
    if bool(question.keys) == question.every:
        raise CaseError(at="--to", want="keys of the case, such as fluid.density, or --all instead")
    keys = every_key(case) if question.every else [key_of(case, name) for name in question.keys]
    if question.analysis == "run":
        return run_sensitivities_of_run(job, question.outputs, keys, question.check, question.every)
    with options_of(case):
        solution = solved(case, question, job.comm)
        usual = USUAL[question.analysis]
        chosen = chosen_outputs(solution.outputs, solution.found.values, question.outputs, usual)
        found, skipped = _differentiated(
            case, solution, chosen, counted(keys, "keys", job.comm.rank), question.every
        )
        compared = checked(case, solution, found, question.check)
    values = {solution.outputs[i].name: float(solution.found.values[i]) for i in chosen}
    answer = Answer(case, question.analysis, values, found, compared, skipped, solution.left_out)
    summary = answer.summary(compared, solution.notes)
    return job.result(job.make_folder(), summary, answer.lines("full solutions"), answer.tables)


def solved(case: Case, question: Question, comm: PETSc.Comm) -> Solution:
    """Solve the problem whose outputs are differentiated; collective."""
    if question.analysis == "roadmap":
        kind = StiffRoadmap if question.model == "stiff" else SoftRoadmap
        return kind(case, question.depths == "deepest")
    if question.analysis == "hydraulics":
        return SteadyHydraulics(case)
    return StaticsSolution(case, comm, question.motion, question.operation)


def chosen_outputs(
    outputs: Sequence[Output], values: FloatArray, asked: Sequence[str], usual: Sequence[str]
) -> list[int]:
    """Numbers of the outputs that are asked for: by name, or `trip_out.hook_load` in one operation; by default the ``usual`` ones.

    Raises CaseError for an output that does not exist.
    """
    present = [i for i in range(len(outputs)) if np.isfinite(values[i])]
    names = list(dict.fromkeys(q for i in present for q in (outputs[i].quantity.name, outputs[i].name)))
    if list(asked) == [ALL]:
        return present
    wanted = list(asked) or [name for name in usual if name in names]
    for name in wanted:
        if name not in names:
            want = f"outputs that the case has: {', '.join(dict.fromkeys(outputs[i].quantity.name for i in present))}, or all"
            raise CaseError(at="--of", got=name, want=want, hint=suggestion(name, names))
    return [i for i in present if {outputs[i].quantity.name, outputs[i].name} & set(wanted)]


def _differentiated(
    case: Case, solution: Solution, chosen: Sequence[int], keys: Iterable[Key], skips: bool
) -> tuple[list[Derivative], dict[str, str]]:
    """Derivatives by all keys; with ``skips`` those that cannot be changed are left out, with the reasons."""
    found: list[Derivative] = []
    skipped: dict[str, str] = {}
    for key in keys:
        try:
            found += derivatives(case, solution, chosen, [key])
        except CaseError as error:
            skipped[key.name] = error.want
            if not skips:
                raise refusal_of(key, error) from None
    return found, skipped
