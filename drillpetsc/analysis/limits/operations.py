"""Operations of the rig by their words: which way the string moves, and whether the bit stands on the bottom."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drillpetsc.analysis.equilibrium import MOTIONS
from drillpetsc.case.blocks.ends import BitBottom, HeldBottom
from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import suggestion
from drillpetsc.errors import CaseError

FOOT_PER_MINUTE = 0.3048 / 60  # [m/s]
RPM = math.pi / 30  # [rad/s]
#: other words of the trade
WORDS = {"slackoff": "trip_in", "pickup": "trip_out", "rob": "rotate_off_bottom"}


@dataclass(frozen=True)
class Operation:
    """What the string does.

    words: as reports show them. motion: axial velocity [m/s, down positive] and rotation [rad/s], whose ratio shares out friction.
    on_bottom: the bit carries the weight of `initial.wob`.
    """

    words: str
    motion: tuple[float, float]
    on_bottom: bool


OPERATIONS = {
    "trip_in": Operation("running in (slack-off)", MOTIONS["lower"], False),
    "trip_out": Operation("pulling out (pick-up)", MOTIONS["hoist"], False),
    "rotate_off_bottom": Operation("rotating off bottom", MOTIONS["rotate"], False),
    "drilling": Operation(
        "drilling, 60 ft/h and 100 rpm", (60 * FOOT_PER_MINUTE / 60, 100 * RPM), on_bottom=True
    ),
    "sliding": Operation("sliding", MOTIONS["lower"], on_bottom=True),
    "backreaming": Operation(
        "backreaming, 20 ft/min and 80 rpm", (-20 * FOOT_PER_MINUTE, 80 * RPM), on_bottom=False
    ),
}


def read_operation(word: str | None) -> str | None:
    """The operation that a word of a user means, one of OPERATIONS; None where none is given.

    Raises CaseError for an unknown word.
    """
    if word is None:
        return None
    name = word.strip().lower().replace("-", "_").replace(" ", "_")
    name = WORDS.get(name.replace("_", ""), name)
    if name not in OPERATIONS:
        raise CaseError(
            at="--operation",
            got=word,
            want=", ".join(OPERATIONS),
            hint=suggestion(name, [*OPERATIONS, *WORDS]) or "slackoff, pickup and rob are understood, too",
        )
    return name


def case_of(case: Case, name: str) -> Case:
    """The case in an operation: without weight on bit and off bottom where the operation is.

    Raises CaseError where the case cannot be in it.
    """
    at, operation = "--operation", OPERATIONS[name]
    if case.well is None:
        raise CaseError(at=at, got=name, want="a case with a well: without a hole there is no friction")
    if case.top.force is not None:
        raise CaseError(
            at=at,
            got=name,
            want="no top.force: the operation moves the top, and its hook load is the answer",
            hint="without --operation the case is taken as it is",
        )
    if isinstance(case.bottom, HeldBottom) and case.bottom.kind != "free":
        raise CaseError(
            at=at,
            got=name,
            want=f"a bottom that can move, not bottom: {case.bottom.kind}",
            hint="without --operation the case is taken as it is",
        )
    if operation.on_bottom:
        if not case.initial.wob or not isinstance(case.bottom, BitBottom):
            raise CaseError(
                at=at, got=name, want="initial.wob above 0, and bottom: bit", hint="the bit is on bottom then"
            )
        return case
    if case.initial.wob is None and not isinstance(case.bottom, BitBottom):
        return case
    plugged = case.bottom.plugged
    return case.model_copy(
        update={
            "bottom": HeldBottom(kind="free", plugged=plugged),
            "initial": case.initial.model_copy(update={"wob": None}),
            "formation": None,
        }
    )
