"""Place across the hole of a string's top that lies on the wall (manual: sec-statics-top-on-wall)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from drillpetsc.analysis.statics.placement import at_top
from drillpetsc.model.drilling_model import DrillingModel

ACROSS = ("top.side_reaction_1", "top.side_reaction_2")


@contextmanager
def free_across(lies: bool, *models: DrillingModel) -> Iterator[None]:
    """Meanwhile the place across the hole of a top that ``lies`` on the wall is part of the equilibrium; collective.

    The top is then held where it lies.
    """
    for model in models:
        model.system.assembly.release(ACROSS if lies else ())
    try:
        yield
    finally:
        for model in models:
            model.system.assembly.release(())
            if lies:
                model.top.place_across(at_top(model, "string.position"))
                model.system.assembly.invalidate_prescribed_values()
