"""Operations of the rig by their words: which way the string moves, and whether the bit stands on the bottom."""

from __future__ import annotations

from dataclasses import dataclass

from drillpetsc.analysis.loads.torque_drag.operations import load_of, plan_of, torque_of_bit
from drillpetsc.analysis.statics.equilibrium import MOTIONS
from drillpetsc.case.blocks.ends import BitBottom, HeldBottom
from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import suggestion
from drillpetsc.errors import CaseError
from drillpetsc.physics.bit.bit_on_bottom import bit_torque
from drillpetsc.time_function import Constant
from drillpetsc.unit_systems import System, shown

#: other words of the trade
WORDS = {"slackoff": "trip_in", "pickup": "trip_out", "rob": "rotate_off_bottom"}


@dataclass(frozen=True)
class Operation:
    """What the string does.

    words: as reports show them. motion: axial velocity [m/s, down positive] and rotation [rad/s], whose ratio shares out
    friction; None: that of the roadmap. on_bottom: the bit carries the weight of `initial.wob`.
    """

    words: str
    motion: tuple[float, float] | None
    on_bottom: bool


OPERATIONS = {
    "trip_in": Operation("running in (slack-off)", MOTIONS["lower"], False),
    "trip_out": Operation("pulling out (pick-up)", MOTIONS["hoist"], False),
    "rotate_off_bottom": Operation("rotating off bottom", None, False),
    "drilling": Operation("drilling", None, on_bottom=True),
    "sliding": Operation("sliding", MOTIONS["lower"], on_bottom=True),
    "backreaming": Operation("backreaming", None, on_bottom=False),
}


def motion_of(case: Case, name: str) -> tuple[float, float]:
    """Axial velocity [m/s, down positive] and rotation [rad/s] of an operation, those of the roadmap where it turns."""
    own = OPERATIONS[name].motion
    if own is not None:
        return own
    load = load_of(case, plan_of(case), name)
    return -load.axial_velocity, load.rotation


def words_of(case: Case, name: str, units: System) -> str:
    """The operation as reports show it, with its speeds: `drilling, 60 ft/h and 120 rpm`."""
    words = OPERATIONS[name].words
    if OPERATIONS[name].motion is not None:
        return words
    speed, rotation = motion_of(case, name)
    kind = "rop" if name == "drilling" else "trip_speed"
    along = f"{shown(abs(speed), kind, units)} and " if speed else ""
    return f"{words}, {along}{shown(rotation, 'rotation', units)}"


def read_operation(word: str | None) -> str | None:
    """The operation that a word of a user means, one of OPERATIONS; None if none is given.

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

    Raises CaseError if the case cannot be in it.
    """
    at, operation = "--operation", OPERATIONS[name]
    case = _pumping(case, load_of(case, plan_of(case), name).flow)
    if case.well is None:
        raise CaseError(at=at, got=name, want="a case with a well: without a hole there is no friction")
    if case.top.force is not None:
        raise CaseError(
            at=at,
            got=name,
            want="no top.force: the operation moves the top, and the hook load is a result",
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
        return _with_torque_of_roadmap(case, case.bottom) if name == "drilling" else case
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


def _pumping(case: Case, flow: float) -> Case:
    """The case with the flow rate [m3/s] of an operation; one that is pumped by a pressure stays as it is."""
    fluid = case.fluid
    if fluid is None or not case.has_bore or fluid.flow_rate is None or fluid.flow_rate.value(0.0) == flow:
        return case
    return case.model_copy(update={"fluid": fluid.model_copy(update={"flow_rate": Constant(flow)})})


def _with_torque_of_roadmap(case: Case, bottom: BitBottom) -> Case:
    """The case whose bit on bottom turns with the torque that the roadmap has for drilling; a bit that cuts rock has its own."""
    bit = case.string[-1]
    if case.formation is not None or bit.od is None or not case.initial.wob:
        return case
    friction = torque_of_bit(case, plan_of(case)) / bit_torque(case.initial.wob, 1.0, 0.5 * bit.od)
    return case.model_copy(update={"bottom": bottom.model_copy(update={"friction": friction})})
