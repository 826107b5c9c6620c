"""Histories of a buckled string that have a meaning for a model (manual: sec-statics-path)."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.start.march import march, stands
from drillpetsc.case.blocks.ends import ForcedBottom
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.tools.reamer import Reamer


def has_path(model: DrillingModel, motion: tuple[float, float]) -> bool:
    """Whether a path has a meaning for ``model`` and ``motion``: of steady sliding, or of a string that nothing moves."""
    return _allowed(model, motion if any(motion) else (1.0, 0.0), "sliding")


def may_slack_off(model: DrillingModel, motion: tuple[float, float]) -> bool:
    """Whether ``motion`` of ``model`` may also be answered by slack-off on a bit that stands."""
    return model.bit is not None and _allowed(model, motion, "slack_off")


def _allowed(model: DrillingModel, motion: tuple[float, float], path: str) -> bool:
    try:
        refuse_path(model, motion, path)
    except CaseError:
        return False
    return True


def nothing_holds(model: DrillingModel) -> bool:
    """Whether the string has no end that takes a force along the hole: it falls, or friction alone holds it."""
    case = model.case
    free = getattr(case.top, "kind", "") == "free" and case.top.force is None
    return free and getattr(case.bottom, "kind", "") in ("free", "force")


def refuse_path(model: DrillingModel, motion: tuple[float, float], got: str) -> None:
    """Raise CaseError if a path has no meaning for ``model``, unstrained along the hole, and ``motion``."""
    at = "--path"
    if got == "slack_off" and motion[0] < 0:
        raise CaseError(at=at, got=got, want="a string that is lowered (--motion lower)")
    if model.case.initial.wob is not None and motion[0] < 0:
        raise CaseError(
            at=at,
            got=f"{got}, hoisted with initial.wob",
            want="a case without initial.wob where the string is hoisted: it slides upward only once the bit is off bottom",
            hint="leave initial.wob and --path out for the pick-up load off bottom; with initial.wob, --motion lower or rotate",
        )
    if model.contact is None:
        raise CaseError(at=at, got=got, want="a string in a hole with contact")
    if nothing_holds(model):
        raise CaseError(at=at, got=got, want="a string that its top or its bottom holds along the hole")
    if model.parts(Reamer):
        raise CaseError(
            at=at,
            got=f"{got} with a reamer",
            want="a string without a reamer",
            hint="leave --path out: how a path shares the weight between bit and reamer is not verified",
        )
    if got == "slack_off" and (motion[1] or not motion[0]):
        raise CaseError(at=at, got=got, want="a string that is lowered and does not turn (--motion lower)")
    if not any(motion):
        raise CaseError(
            at=at, got=got, want="a string that slides or turns (--motion hoist, lower or rotate)"
        )
    if got == "slack_off" and model.case.top.force is None and model.case.initial.wob is None:
        raise CaseError(
            at=at, got=got, want="a push on the bit that stands: initial.wob, or a force of the top"
        )
    if pushed_at_end(model):
        return
    found = march(model, motion, coils=False)
    off_bottom = motion[0] < 0 and stands(
        model
    )  # the weight that its stretch leaves on the bottom ends as it is hoisted
    if found is None or off_bottom or not found.axial_force.min() < 0:
        ends = "a force of the top or at the bottom, or its weight"
        raise CaseError(
            at=at,
            got=f"{got}, and nothing pushes the string",
            want=f"a string that is pushed: by {ends if motion[0] < 0 else 'initial.wob, ' + ends}",
            hint="a string that nothing pushes has one state: leave --path out",
        )


def pushed_at_end(model: DrillingModel) -> bool:
    """Whether the case pushes the string at one of its ends."""
    case = model.case
    return (
        case.top.force is not None
        or case.initial.wob is not None
        or (isinstance(case.bottom, ForcedBottom) and float(np.dot(case.bottom.force, model.tangent[-1])) < 0)
    )
