"""Place across the hole of a string's top that lies on the wall (manual: sec-statics-top-on-wall)."""

from __future__ import annotations

from drillpetsc.analysis.statics.placement import at_top
from drillpetsc.analysis.statics.relaxation import come_to_rest
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static.static_newton import CONVERGED_INCREMENT, Equilibrium, StaticNewton

ACROSS = ("top.side_reaction_1", "top.side_reaction_2")
MOST_FAILED = 10  # steps with drag, before the top stays where it is


def balance_across(model: DrillingModel, solver: StaticNewton, report: Equilibrium) -> bool:
    """Move the prescribed place of the top across the hole to where nothing pushes it there; collective.

    The state is an equilibrium with the top held where the march put it.  The rows that hold it across the hole are
    released, the string relaxes, and the top is then held where it lies.

    Returns whether the place was found; otherwise the state is the former one.
    """
    start, asm = Snapshot(model), model.system.assembly
    asm.release(ACROSS)
    try:
        come_to_rest(model, solver, report, CONVERGED_INCREMENT, most_failed=MOST_FAILED)
    except SolveError:
        start.restore()
        return False
    finally:
        asm.release(())
    hold_where_it_lies(model)
    return True


def hold_where_it_lies(model: DrillingModel) -> None:
    """Prescribe the present place of the top across the hole; collective."""
    model.top.place_across(at_top(model, "string.position"))
    model.system.assembly.invalidate_prescribed_values()
