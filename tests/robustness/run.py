"""Computation of one part of a robustness case, in this process."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from drillpetsc.analysis.commands.statics import run_statics
from drillpetsc.analysis.motion import checkpoint
from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.analysis.motion.transient import run
from drillpetsc.analysis.statics.placement import place_along_hole, release
from drillpetsc.case import Case, load_case
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output import RunFolder
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.recorder import Recorder

PRESSED_DEPTH = 0.02  # initial penetration of the wall in X16 [m]
PRESSED_SPEED = 5.0  # initial speed into the wall in X16 [m/s]
TRANSITION = 12.0  # length over which the offset grows from zero at the top to its value in the wall [m]


@dataclass(frozen=True)
class Part:
    """One computation of a robustness case.

    name: name of the run folder.
    case: name of the case file without suffix.
    kind: a run, statics, or a run that starts inside the wall.
    motion: motion that friction opposes in statics.
    weight_on_bit: replaces that of the case [N].
    """

    name: str
    case: str = ""
    kind: Literal["run", "statics", "wall"] = "run"
    motion: str | None = None
    weight_on_bit: float | None = None


def compute(part: Part, cases: Path, out: Path) -> None:
    """Compute a part into the run folder ``out``/name, replacing its results.

    cases: folder of the case files.
    """
    case, folder = load_case(cases / f"{part.case}.yaml"), out / part.name
    if part.kind == "statics":
        if part.weight_on_bit is not None:
            case = case.model_copy(
                update={"initial": case.initial.model_copy(update={"wob": part.weight_on_bit})}
            )
        run_statics(Job(case, folder, overwrite=True, name=part.name), part.motion)
    elif part.kind == "wall":
        run_from_wall(case, folder)
    else:
        run(case, folder, overwrite=True, name=part.name, progress="silent")


# ---------------------------------------------------------------------- start inside the wall
def press_into_wall(model: DrillingModel, depth: float = PRESSED_DEPTH, speed: float = PRESSED_SPEED) -> None:
    """Move the straight string in a level hole to ``depth`` [m] beyond the low side, with ``speed`` [m/s] into
    the wall.

    The top drive holds the top on the axis. Over TRANSITION the offset is a cubic smooth step, so that the
    slopes are consistent.
    """
    place_along_hole(model)
    mesh, well = model.mesh, model.well
    assert well is not None
    u = np.clip(mesh.node_depth / TRANSITION, 0.0, 1.0)
    share, slope = u * u * (3 - 2 * u), 6 * u * (1 - u) / TRANSITION
    clearance = np.asarray(well.radius(mesh.node_depth)) - 0.5 * np.append(
        mesh.outer_diameter, mesh.outer_diameter[-1]
    )
    down = np.array([0.0, 0.0, 1.0])
    m = model.system
    m.set_field("string.position", model.position + ((clearance + depth) * share)[:, None] * down)
    m.set_field("string.tangent", model.tangent + ((clearance + depth) * slope)[:, None] * down)
    m.set_field("string.position", speed * share[:, None] * down, "y")
    m.set_field("string.tangent", speed * slope[:, None] * down, "y")
    release(model)


def run_from_wall(case: Case, folder: Path) -> RunResult:
    """Run ``case`` (X16) into ``folder`` from the state of ``press_into_wall``, which no case file can state.

    The state is written as a checkpoint to a folder beside ``folder``, from which the run starts.
    """
    start = RunFolder.create("start", folder.with_name(folder.name + "-start"), overwrite=True)
    model = build_model(case)
    press_into_wall(model)
    integrator, recorder = make_integrator(model), Recorder(model)
    recorder.start(0.0)
    taken = checkpoint.take(model, recorder, integrator, 0.0, {})
    assert taken is not None  # on one rank
    checkpoint.write(start.checkpoint, taken)
    begun = case.model_copy(update={"initial": case.initial.model_copy(update={"from_": str(start.path)})})
    return run(begun, folder, overwrite=True, name=folder.name, progress="silent")
