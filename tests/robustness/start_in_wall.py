"""X16: a run that starts inside the wall, which no case file can ask for: the state is set here and left as a
checkpoint to start from."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drillpetsc.analysis import checkpoint
from drillpetsc.analysis.equilibrium import place_along_hole, release
from drillpetsc.analysis.transient import RunResult, make_integrator, run
from drillpetsc.case import Case
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output import RunFolder
from drillpetsc.output.recorder import Recorder

DEPTH, SPEED = 0.02, 5.0  # inside the wall [m], towards it [m/s]
# length over which the string comes from the axis, where the top holds it, to its place in the wall [m]
BENT = 12.0


def press_into_wall(model: DrillingModel, depth: float = DEPTH, speed: float = SPEED) -> None:
    """The straight string moved down into the low side of a level hole, ``depth`` [m] beyond its wall, with
    ``speed`` [m/s] into it; near the top, which holds it, less, by a smooth step (cubic, so that the slopes
    are consistent)."""
    place_along_hole(model)
    mesh, well = model.mesh, model.well
    assert well is not None
    u = np.clip(mesh.node_depth / BENT, 0.0, 1.0)
    share, slope = u * u * (3 - 2 * u), 6 * u * (1 - u) / BENT
    component = np.asarray(well.radius(mesh.node_depth)) - 0.5 * np.append(
        mesh.outer_diameter, mesh.outer_diameter[-1]
    )
    down = np.array([0.0, 0.0, 1.0])
    m = model.system
    m.set_field("string.position", model.position + ((component + depth) * share)[:, None] * down)
    m.set_field("string.tangent", model.tangent + ((component + depth) * slope)[:, None] * down)
    m.set_field("string.position", speed * share[:, None] * down, "y")
    m.set_field("string.tangent", speed * slope[:, None] * down, "y")
    release(model)


def run_from_wall(case: Case, folder: Path) -> RunResult:
    """Run ``case`` from ``press_into_wall``; the run folder is ``folder``, the state at the start lies beside
    it."""
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
