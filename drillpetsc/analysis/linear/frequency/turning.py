"""A model whose rotary speed can be changed, and its state at each speed (manual: sec-frequency-state)."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

from drillpetsc.analysis.linear.linearised_model import mean_over_turn, settle
from drillpetsc.analysis.linear.modal import rest_of, without_motor
from drillpetsc.analysis.motion.session.live_input import LiveInput
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, prescribed_motion, release
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.case.blocks.ends import HeldBottom, HeldTop, TopDrive
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import refuse_quaternion
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel, build_model, is_quasi_static
from drillpetsc.model.top import continuous_control
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.time_function import Constant


def turning_case(case: Case, command: str, without_control: bool = False) -> Case:
    """The case with a top that turns, for an analysis over rotary speeds.

    A clamped or pinned top becomes a top drive at rest, which is hinged where the top is pinned.
    command: name of the command, for messages.
    Raises CaseError for a string that cannot turn.
    """
    refuse_quaternion(case, command)
    if case.hold_string:
        raise CaseError(at="hold_string", got=True, want=f"a string that moves, with {command}")
    top = case.top
    if isinstance(top, HeldTop):
        if top.kind == "free":
            raise CaseError(
                at="top",
                got="free",
                want=f"a top that can turn with {command}: top_drive, driven, pinned or clamped",
            )
        top = TopDrive(kind="top_drive", hinged=top.kind == "pinned")
    if isinstance(case.bottom, HeldBottom) and case.bottom.kind == "clamped":
        raise CaseError(
            at="bottom", got="clamped", want=f"a lower end that can turn with {command}",
            hint="pinned holds its position only",
        )  # fmt: skip
    case = continuous_control(mean_over_turn(case.model_copy(update={"top": top})))
    case = without_motor(case) if without_control else case
    if case.top.torque is not None:
        raise CaseError(
            at="top.torque",
            want=f"a rotation with {command}, not a torque",
            hint="--without-control holds the top",
        )
    return case.model_copy(update={"time": None}) if is_quasi_static(case) else case


class TurningModel:
    """A model, and its state at any rotary speed.

    case: from ``turning_case``; comm: communicator.
    balanced: without what turns with the section (``build_model``).

    The mesh is that of the case at its own rotation.
    """

    def __init__(self, case: Case, comm: PETSc.Comm | None = None, balanced: bool = False):
        self._live = LiveInput(case.top.rotation if case.top.rotation is not None else Constant(0.0))
        changed = {"rotation": self._live}
        self._down: LiveInput | None = None
        if case.top.lowering is not None and case.top.force is None:
            self._down = changed["lowering"] = LiveInput(case.top.lowering)
        top = case.top.model_copy(update=changed)
        self.model: DrillingModel = build_model(case.model_copy(update={"top": top}), comm, balanced=balanced)
        self._static: tuple[Any, StaticState, Snapshot] | None = None
        self.solved = 0  # static equilibria found

    def at(self, speed: float, lowering: float | None = None) -> StaticState:
        """Set the model to the steady motion at ``speed`` [rad/s]; returns its static equilibrium.  Collective.

        lowering: of the top [m/s], None: the case's.

        At speed 0, and without lowering, it is the equilibrium without friction, at rest, as ``modes --about rest``.
        Equilibria that do not depend on the size of the speed are found once.
        Raises SolveError if none is found.
        """
        self._live.set(0.0, float(speed))
        if lowering is not None and self._down is not None:
            self._down.set(0.0, float(lowering))
        model = self.model
        model.system.assembly.invalidate_prescribed_values()
        motion = prescribed_motion(model)
        key = self._key(motion)
        if self._static is None or self._static[0] != key:
            state = find_equilibrium(model, motion)
            self.solved += 1
            self._static = key, state, Snapshot(model)
        else:
            self._static[2].restore()
            for component in model.components:
                component.hold()
            state = self._static[1]
        if motion == (0.0, 0.0) and not model.parts(MudMotor):
            notes = rest_of(model)
        else:
            release(model)
            model.system.assembly.a[:] = 0.0
            move_rigidly(model)
            notes = settle(model)
        state.warnings += [note for note in notes if note not in state.warnings]
        return state

    def _key(self, motion: tuple[float, float]) -> Any:
        """What the static equilibrium depends on."""
        lowering, speed = motion
        drills = self.model.drilling is not None
        if drills or self.model.parts(MudMotor) or (lowering and self.model.contact is not None):
            return motion
        return lowering != 0, (speed > 0) - (speed < 0)
