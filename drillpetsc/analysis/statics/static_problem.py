"""A static problem and its result: what the steps of the search for an equilibrium share (manual: sec-statics-sequence)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from drillpetsc.analysis.statics.path.path_answer import PathAnswer
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.start.march import HelixBand, March
from drillpetsc.analysis.statics.start.soft_string import TorqueDrag
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton


@dataclass
class StaticState:
    """Result of ``find_equilibrium``; the state itself is in the model's system.

    motion: axial velocity [m/s, down positive] and rotation [rad/s] that friction opposes.
    equilibrium: results of the solver.
    soft_string: results of the soft string, None without one.
    warnings: texts for the user.
    lateral_fraction: fraction of the lateral friction force in the equilibrium [-] (chi in the manual:
    eq-statics-imposed-friction).
    path: answer of the paths of a buckled string with friction, None if Newton's method found the state.
    band: by theory, of what a buckled string that slides transmits; None if it is the same early and late.
    top_lies: the place of the top across the hole is part of the equilibrium (manual: sec-statics-top-on-wall).
    """

    motion: tuple[float, float]
    equilibrium: Equilibrium
    soft_string: TorqueDrag | None = None
    warnings: list[str] = field(default_factory=list)
    lateral_fraction: float = 1.0
    path: PathAnswer | None = None
    band: HelixBand | None = None
    top_lies: bool = False

    @property
    def stable(self) -> bool:
        """Whether the state has neither a negative nor a zero pivot (manual: eq-statics-stable)."""
        return self.equilibrium.negative_pivots == 0 and not self.equilibrium.singular


@dataclass
class StaticProblem:
    """One search for an equilibrium.

    model, solver: see there; state: gets the result.
    fraction: lateral friction fraction that is asked for [-].
    lowering: speed at which the top lowers the string [m/s].
    found, straight: the march of a string that may coil, and of one that stays straight; None without contact.
    origin: the string along the hole.
    leaves_loads: the state found may be stable without its side loads, once string and flow are in equilibrium.
    """

    model: DrillingModel
    solver: StaticNewton
    state: StaticState
    fraction: float
    lowering: float
    found: March | None
    straight: March | None
    origin: Snapshot
    leaves_loads: bool = False

    @property
    def moves(self) -> bool:
        """Whether friction acts."""
        rubs = self.model.contact is not None or self.model.bit is not None
        return rubs and (self.state.motion != (0.0, 0.0) or self.model.motor_speed != 0)

    @property
    def turns(self) -> bool:
        """Whether any part of the string turns."""
        return bool(self.state.motion[1] or self.model.motor_speed)

    def save(self) -> Callable[[], None]:
        """Copy all that a search changes; the function returned puts it back, with friction set aside."""
        asm, solver, report = self.model.system.assembly, self.solver, self.state.equilibrium
        before, load, y = Snapshot(self.model), asm.dead_load, asm.y.copy()
        rates, imperfection = solver.rates, report.imperfection
        last = report.residual, report.increment, report.converged
        fraction = self.state.lateral_fraction

        def restore() -> None:
            before.restore()
            asm.dead_load, asm.y[:] = load, y
            solver.rates, report.imperfection = rates, imperfection
            report.residual, report.increment, report.converged = last
            self.state.lateral_fraction = fraction
            self.set_friction_aside()

        return restore

    def impose(self, fraction: float) -> None:
        """Let friction oppose the motion, with a ``fraction`` of its lateral force, which is then the state's."""
        self.state.lateral_fraction = fraction
        for component in self.model.components:
            component.impose_sliding_direction(*self.state.motion, fraction, self.model.motor_speed)

    def set_friction_aside(self) -> None:
        """No friction acts from now on."""
        for component in self.model.components:
            component.impose_sliding_direction(0.0, 0.0)
