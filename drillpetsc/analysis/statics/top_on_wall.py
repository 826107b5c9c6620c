"""Place across the hole of a string's top that lies on the wall (manual: sec-statics-top-on-wall)."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton

_ACROSS = ("top.side_reaction_1", "top.side_reaction_2")
LEAST_PART = 1 / 64  # of the reactions, taken away at a time
MOST_ITERATIONS = 400


def balance_across(model: DrillingModel, solver: StaticNewton, report: Equilibrium) -> bool:
    """Move the prescribed place of the top across the hole to where nothing pushes it there; collective.

    The state is an equilibrium with the top held where the march put it.  The rows that hold it across the hole are
    released, Newton's method finds the place, and the top is then held there.  Where the place is far, the reactions
    that held the top are taken away in parts.

    Returns whether the place was found; the state is the former one where it was not.
    """
    assert model.top is not None
    start, asm, iterations = Snapshot(model), model.system.assembly, report.iterations
    load = asm.dead_load
    asm.release(_ACROSS)
    try:
        held = _reactions_across(model, solver)
        share, step = 1.0, 1.0  # of the reactions that still holds the top
        while share:
            reached = Snapshot(model)
            asm.dead_load = load if share == step else held * (share - step) + (0.0 if load is None else load)
            try:
                solver.newton(report)
                share -= step
            except SolveError:
                reached.restore()
                step *= 0.25 if step == 1.0 else 0.5
                if step < LEAST_PART or report.iterations - iterations > MOST_ITERATIONS:
                    start.restore()
                    return False
    finally:
        asm.release(())
        asm.dead_load = load
    model.top.place_across(_top_position(model))
    asm.invalidate_prescribed_values()
    return True


def _reactions_across(model: DrillingModel, solver: StaticNewton) -> FloatArray:
    """Load (n,) at the owned unknowns [N] that holds the released top as its reactions did."""
    held, rows = np.zeros(model.system.layout.size), solver.rows()
    for f in model.system.assembly.row_replacements:
        if f.owned and f.condition.names[0].startswith("top."):
            held[f.rows[:3]] = rows[f.rows[:3]]
    return held


def _top_position(model: DrillingModel) -> FloatArray:
    """Position (3,) of the top node [m], the same on all ranks."""
    system = model.system
    here = np.flatnonzero(system.chain.owned & (system.chain.vertices == 0))
    local = system.field("string.position")[here].sum(axis=0)
    return local if system.comm.size == 1 else np.asarray(system.comm.tompi4py().allreduce(local))
