"""The moments at which commands ask what is doubtful, with what there is to look at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.doubts.doubt import CaseMoment
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.hole import top_of_string
from drillpetsc.output.balances.energy_balance import EnergyGainMonitor
from drillpetsc.output.files.tables import Column
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.watches.buckling import Buckling
from drillpetsc.output.watches.coarse_mesh import LongElements, expected, of_state
from drillpetsc.output.watches.monitors import Monitors
from drillpetsc.output.watches.operation_watch import OperationWatch
from drillpetsc.physics.top.control import Law
from drillpetsc.physics.top.top_drive import MotorDrive
from drillpetsc.unit_systems import System


@dataclass(frozen=True, kw_only=True)
class Moment:
    """A model at some moment."""

    model: DrillingModel

    @property
    def case(self) -> Case:
        """The case of the model."""
        return self.model.case

    @property
    def units(self) -> System:
        """Units of the reader."""
        return self.case.shown_units

    @property
    def laws(self) -> tuple[Law, ...]:
        """Laws of the controllers of the top drive, empty without a motor."""
        drive = self.model.part(MotorDrive)
        return () if drive is None else drive.described

    @property
    def top(self) -> float:
        """Measured depth [m] of the top of the unstrained string."""
        return top_of_string(self.case, self.model.mesh.total_length)


class Built(Moment):
    """The model has been built, and nothing is computed (check)."""

    @cached_property
    def long_elements(self) -> LongElements:
        """Elements that are too long for the forces to be expected."""
        return expected(self.model)


@dataclass(frozen=True)
class Tuned(CaseMoment):
    """Controllers of the top drive have been tuned, without a model of the string (top-drive)."""

    laws: tuple[Law, ...]


@dataclass(frozen=True)
class Flowing:
    """A steady flow of the mud has been found (hydraulics).

    figures: of summary.json [SI]; largest_loss: words on where most of the pressure is lost.
    """

    case: Case
    figures: Mapping[str, Any]
    units: System
    largest_loss: str


@dataclass(frozen=True, kw_only=True)
class Rest(Moment):
    """A static state.

    figures: hook_load, surface_torque, ... of summary.json [SI]; a missing one is not known.
    rotation: of the string in the equilibrium [rad/s].  table: ``static_table`` of the state, computed if it is needed and None.
    continued: from a checkpoint.
    """

    figures: Mapping[str, Any] = field(default_factory=dict)
    rotation: float = 0.0
    continued: bool = False
    table: tuple[list[Column], FloatArray | None] | None = None

    @cached_property
    def long_elements(self) -> LongElements:
        """Elements that are too long for the state; collective."""
        return of_state(self.model, *(self.table or ()))


@dataclass(frozen=True, kw_only=True)
class Solved(Moment):
    """Statics has found an equilibrium, for any command.

    top_unplaced: the place of the top across the hole was not found.  lateral_friction_failed: no state with lateral friction.
    below_hole: distance of a free end below the end of the hole [m], zero if it is not there.
    negative_pivots: count, 0 for a state whose stability is not reported; singular: the stiffness is.
    """

    top_unplaced: bool = False
    lateral_friction_failed: bool = False
    below_hole: float = 0.0
    negative_pivots: int = 0
    singular: bool = False


@dataclass(frozen=True, kw_only=True)
class Freed(Moment):
    """A string with a weight on bit is let go by statics, and its top pulls with a given force (all commands).

    force: of the top at time 0 [N]; hook_load: of the equilibrium [N].
    """

    force: float
    hook_load: float


class Answer(Rest):
    """A static state is the result (statics, limits)."""


@dataclass(frozen=True, kw_only=True)
class StaticAnswer(Answer):
    """The result of `statics`.

    buckled: where the string is buckled; slides: it slides with friction, and no path was followed although one has a meaning.
    band: of what the string transmits, by theory, where one state was found of several (HelixBand); has_path: `--path` may give them.
    lowering: axial velocity of the string, positive downward [m/s].
    """

    buckled: Buckling
    slides: bool = False
    band: Any = None
    has_path: bool = False
    lowering: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Start(Rest):
    """A motion begins or continues (run, sessions).

    fixed_step: length of the steps [s], None if they are adapted.
    impact: duration of the shortest impact [s].
    freed_weight: weight on bit [N] once rotation has freed the friction of a sliding start; None if the start does not slide.
    libraries: (name, version of the checkpoint, version now) of libraries that have changed; empty at time 0.
    accepted: changes of the case were accepted at a restart.
    found: rotation [rad/s] and lowering [m/s] of the top in the state of the other run that the case begins from; None without one.
    """

    fixed_step: float | None = None
    freed_weight: float | None = None
    libraries: Sequence[tuple[str, str, str]] = ()
    accepted: bool = False
    found: tuple[float, float] | None = None
    impact: float = float("inf")


@dataclass(frozen=True, kw_only=True)
class End(Moment):
    """A run ends.

    time: reached [s]; finished: without an error. Only then may a doubt be collective.  Rows of ``watch`` are on the first rank.
    pushed_at_start: the push of the top was already reported.  whirl: of the part that the steps damp (``WhirlSteps.damped``).
    """

    time: float
    finished: bool
    recorder: Recorder
    monitors: Monitors
    watch: OperationWatch
    gain: EnergyGainMonitor
    pushed_at_start: bool = False
    whirl: Mapping[str, Any] | None = None
