"""A top that pushes the string into the hole, which a hook cannot (manual: sec-statics-top-push)."""

from __future__ import annotations

from drillpetsc.case import Case
from drillpetsc.output.watches.operation_watch import LEAST_PUSH
from drillpetsc.unit_systems import shown


def top_push(case: Case, hook_load: float | None) -> list[str]:
    """Sentence on a prescribed motion of the top that needs a push; none where the string hangs, or where the force is given.

    hook_load: force [N] with which the top pulls the string, None for a string that is held.
    """
    if hook_load is None or hook_load > -LEAST_PUSH or case.well is None or case.top.force is not None:
        return []
    push = shown(-hook_load, "force", case.shown_units)
    weight = (
        "the weight on the bit is more than the string puts there, or " if case.bottom.kind == "bit" else ""
    )
    return [
        f"the top pushes the string into the hole with {push}: a hook can only pull; {weight}friction or mud holds the string up"
    ]
