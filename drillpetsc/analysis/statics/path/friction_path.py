"""Static states of buckled strings with friction: the end of a path on which the string is loaded and slides.

Manual: sec-statics-path.  With friction a buckled string has many states; which one it is depends on its history.  Helices that creep
along the wall while they slide need ``follow_on``: pipe lowered with 100 kN on its bit, `jar-stuck.yaml` lowered, coiled strings hoisted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.statics.imperfection import nodal_weight
from drillpetsc.analysis.statics.path.path_answer import OVERLOAD, STEADY, PathAnswer, PathEnd, PathKind
from drillpetsc.analysis.statics.path.path_question import may_slack_off
from drillpetsc.analysis.statics.placement import end_is_held, place_along_hole, top_depth
from drillpetsc.analysis.statics.snapshot import Snapshot
from drillpetsc.analysis.statics.start.march import March, axial_compliance, march, place_marched
from drillpetsc.analysis.statics.steady_flow import fluid_unknowns, freeze_flow, steady_flow
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import ForcedBottom
from drillpetsc.errors import SolveError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.interfaces import Drive
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.static.lateral_loads import lateral_loads
from drillpetsc.solvers.static.search_limit import SearchEnded
from drillpetsc.solvers.static.static_newton import AXIAL_SHARE, Drag, Equilibrium, StaticNewton
from drillpetsc.unit_systems import shown

SEED = 1e-3  # random side loads, as a share of the weight; part of the history
SPEED = 1.0  # of the string past the hole while it slides [m/s]
SETTLE, HOLD, START = 0.5, 0.5, 1.0  # times of: the string lies down; its load stays; it begins to slide [s]
SLIDE, LONGEST_SLIDE = 30.0, 60.0  # distance that the string slides [m]
LONGEST_STEP = 0.4  # distance that it slides in one step [m]; longer implicit steps damp a growing buckle
RAMP_STEPS = 50  # least steps in which a top force rises on a bit that stands
#: from a state near its own, where no buckle has to grow: distance that the string slides on, longest and first step [m, s]
SLIDES_ON, LONGEST_STEP_ON, FIRST_STEP_ON = 2.0, 1.0, 2e-2
SLIP_SHARE = 5e-3  # rounding velocity over the top's velocity, if the push is given
RUN_IN = 5.0  # distance that the string is run in before it is slacked off [m]
LIFT = 0.2  # height of the bit over the bottom from which the string is slacked off [m]
LOWERING = 0.2  # speed at which the top is lowered onto the bit that stands [m/s]
MOST_LOWERING = 3.0  # largest way of the top in the hole, over the shortening of a straight string
WEIGHT_TOLERANCE = 1e-3  # of the weight on bit, over the weight, where the lowering ends
FIRST_STEP, SHORTEST_STEP = 1e-3, 1e-9  # [s]
MOST_STEPS, MOST_STEPS_ON = 4000, 100
STEP_INCREMENT, STEP_ITERATIONS = 1e-6, 25  # of Newton's method in a step
SPIN_ARM = 0.1  # usual lever of the drag on the spin [m]
CROSSING = 12.0  # over which the string reaches the wall from an item of little clearance [m]
FLOW_STEPS = 10  # steps after which the steady flow is solved again
LEAST_WEIGHT = 1.0  # on the bit before it is loaded [N]


@dataclass(frozen=True)
class Settings:
    """Artificial constants of a path.

    ramp: time in which the load rises [s]; slip: velocity that rounds off Coulomb's law [m/s].
    drag: across the string [N s/m2]; along: its share along the string [-]; arm: its lever on the spin [m].
    """

    ramp: float
    slip: float
    drag: float
    along: float
    arm: float = SPIN_ARM


#: slack-off is slow against drag and friction's creep (docs: sec-statics-path has the figures)
SETTINGS = {
    "sliding": Settings(ramp=1.0, slip=0.01 * SPEED, drag=1000.0, along=0.03),
    # the torque of kilometres of turning string settles within the slide
    "turning": Settings(ramp=1.0, slip=0.01 * SPEED, drag=1000.0, along=0.03, arm=0.1 * SPIN_ARM),
    "slack_off": Settings(ramp=4.0, slip=1e-3, drag=75.0, along=1e-3),
}


class FrictionPath:
    """Paths of one model.

    kind: the question.
    solver: its static solver, with the weight on bit as its constraint if one is given.
    velocity: of the steady motion that friction opposes: along the hole [m/s, down positive] and spin [rad/s].
    surge: (n+1,) rates of the steady motion that the mud sees [SI of each field per second]; None: at rest.
    """

    def __init__(
        self,
        model: DrillingModel,
        kind: PathKind,
        solver: StaticNewton,
        velocity: tuple[float, float],
        surge: FloatArray | None = None,
    ):
        assert model.well is not None
        self.model, self.kind, self.solver, self.velocity = model, kind, solver, velocity
        self.sign, self.turns = float(np.sign(velocity[0])) or 1.0, kind == "sliding" and bool(velocity[1])
        self.settings, self._surge = SETTINGS["turning" if self.turns else kind], surge
        self._slip = self.settings.slip
        self.components = model.components
        self._tangent = np.asarray(model.well.at(model.mesh.node_depth + top_depth(model))[1])
        self._wob = model.case.initial.wob if solver.depth is not None else None
        self.report, self._share = Equilibrium(), 0.0  # of the load that acts
        if kind == "slack_off" and model.case.top.force is not None:
            speed = abs(model.case.top.force.value(0.0)) * axial_compliance(model.mesh) / self.settings.ramp
            self._slip = min(self.settings.slip, SLIP_SHARE * speed)
        self.seeds = lateral_loads(model.system, SEED * nodal_weight(model))
        self._push = self._end_load()
        #: push that changes of the force are compared with [N]: the given one, or the largest of the straight string
        self._scale = (
            abs(model.case.top.force.value(0.0)) if model.case.top.force is not None else self._wob or 0.0
        )
        self._anchor = model.top.anchor.copy()
        self.steps, self.most_steps = 0, MOST_STEPS
        #: (n,) push at the lower end of a string that nothing pushes there, of the largest push of the straight one [N]
        self._obstacle = np.zeros(model.system.layout.size)

    def _end_load(self) -> FloatArray:
        """Given forces (n,) on the ends of the string by the local unknowns [N]: those that rise along a path."""
        model = self.model
        out, force, bottom = np.zeros(model.system.layout.size), model.case.top.force, model.case.bottom
        if force is not None:
            out[self._of_node("string.position", 0)] = -force.value(0.0) * model.tangent[0]
        if isinstance(bottom, ForcedBottom):
            out[self._of_node("string.position", model.mesh.nodes - 1)] += np.array(bottom.force)
        return out

    def _depth(self, system: DiscreteSystem) -> tuple[float, FloatArray, float]:
        """Depth of the bit, its gradient, and the depth of the share of its weight that acts (see ``StaticNewton``)."""
        bit = self.model.bit
        assert bit is not None and self._wob is not None
        return *bit.depth_of_face(system.assembly), bit.depth_for(self._share * self._wob)

    def _of_node(self, field: str, node: int) -> np.ndarray:
        """Local unknowns (k,) or (1, k) of a node that this rank owns, else none."""
        chain = self.model.system.chain
        here = np.flatnonzero(chain.owned & (chain.vertices == node))
        return np.asarray(self.model.system.layout.dofs[field][here])

    def _set_load(self, share: float) -> None:
        """Let ``share`` of the ends' forces, and of the weight on the bit, act."""
        self._share = share
        self.model.system.assembly.dead_load = (
            self.seeds + (share - 1.0) * self._push + max(0.0, share - 1.0) * self._obstacle
        )

    def _friction(self, speed: float) -> None:
        for component in self.components:
            if self.turns:
                # across the hole only the drag acts: the side force would roll the string for ever
                axial = abs(self.velocity[0]) * speed / SPEED
                component.impose_sliding_direction(axial, self.velocity[1], 0.0)
            elif not self.model.parts(MudMotor) or component is not self.model.bit:
                component.follow_overdamped_motion(speed, self._slip)

    # ------------------------------------------------------------------ path
    def follow(self, start: str) -> PathEnd:
        """Load the string, let it slide if that is the question, and close on the state it reaches; collective.

        start: ``straight``, the load rises to its value, or ``overload``, it comes back from ``OVERLOAD`` of it.
        Raises SolveError if a step collapses.
        """
        model, self.steps, self.report = self.model, 0, Equilibrium()
        model.top.anchor[:] = self._anchor
        place_along_hole(model, top_depth(model))
        freeze_flow(model)
        along = self.velocity if self.turns else (self.sign, 0.0)
        straight = march(model, along, coils=False, wob=LEAST_WEIGHT)
        assert straight is not None
        # a small weight may stand below a long level string, which friction alone pushes
        pushed, largest_push = self._scale > 0.0, -float(straight.axial_force.min())
        self._scale = max(self._scale, largest_push, 1.0)
        if not pushed:
            last = model.mesh.nodes - 1
            self._obstacle[self._of_node("string.position", last)] = -self._scale * model.tangent[-1]
        self._lay_down(straight)

        if self.kind == "slack_off":
            return self._moved(start, self._slack_off)
        return self._moved(start, lambda: self._slide(OVERLOAD if start == "overload" else 1.0))

    def follow_on(self, largest_push: float) -> PathEnd:
        """Let the string slide on from its present state, near an equilibrium under its whole load; collective.

        The side loads that act now stay, or small ones are added if none act.
        largest_push: along the string [N], with which changes of the force are compared.
        Raises SolveError if a step collapses.
        """
        load = self.model.system.assembly.dead_load
        self.seeds = self.seeds if load is None else load.copy()
        self._scale = max(self._scale, largest_push, 1.0)
        self.most_steps = MOST_STEPS_ON
        freeze_flow(self.model)

        def move() -> tuple[float, float]:
            self._friction(self.sign * SPEED)
            log = self._advance(
                SLIDES_ON / SPEED, lambda t: 1.0, LONGEST_STEP_ON / SPEED, first=FIRST_STEP_ON
            )
            t, force, _ = np.array(log).T
            return SLIDES_ON, abs(float(force[-1] - np.interp(0.5 * t[-1], t, force))) / self._scale

        return self._moved("buckled", move)

    def _moved(self, start: str, move: Callable[[], tuple[float, float]]) -> PathEnd:
        """Let ``move`` move the string, and close on the state that it reaches; returns the end of the path.

        move() returns the distance that the string slid [m] and the change of what it transmits.
        """
        model, solver = self.model, self.solver
        asm, depth = model.system.assembly, solver.depth
        # the top moves so that the bit carries its weight; in a slack-off it is lowered until the bit does
        solver.depth = self._depth if self._wob is not None and self.kind != "slack_off" else None
        if model.fluid is not None:
            asm.hold_rates(fluid_unknowns(model.system), self._surge)
        try:
            slid, change = move()
            if model.fluid is not None:
                self._renew_flow()
            held = self._held()
        finally:
            asm.hold_rates(None)
            solver.depth = depth
        # the state is an equilibrium already; Newton's method would leave a state that friction alone holds
        asm.dead_load = self.seeds + held
        for component in self.components:  # stability is counted with friction as a dead load
            component.impose_sliding_direction(0.0, 0.0)
        negative = solver.negative_pivots()
        self._friction_at_end()
        solver.rows()
        torque = self._torque() if self.turns else 0.0
        return PathEnd(
            start, *self._end_forces(), torque, negative, change, slid, self.steps, self.report.iterations
        )

    def _lay_down(self, found: March) -> None:
        """Put the string on the wall as ``found`` has it; under a given top force it is unstrained.

        From an item of little clearance the pipe reaches the wall over ``CROSSING``: on short elements a step would be a
        kink of many times the strength of the pipe.
        """
        model, system = self.model, self.model.system
        depth, forced = model.mesh.node_depth, self.model.case.top.force is not None
        if forced and not found.top_on_wall:
            return
        size = np.linalg.norm(found.offset, axis=1)
        reach = size.copy()
        for order in (range(1, len(size)), range(len(size) - 2, -1, -1)):
            for i in order:
                j = i - 1 if order.step > 0 else i + 1
                reach[i] = min(reach[i], reach[j] + size[i] * abs(depth[i] - depth[j]) / CROSSING)
        share = np.divide(reach, size, out=np.zeros_like(size), where=size > 0)
        offset = (share**2 * (3 - 2 * share))[:, None] * found.offset
        centre, tangent = found.centre, found.tangent
        if not forced:
            place_marched(model, found)
        else:
            model.top.displace(offset[0])
            centre, tangent = model.position, model.tangent
        system.set_field("string.position", centre + offset)
        if not model.mesh.is_joint.any():
            system.set_field("string.tangent", tangent + np.gradient(offset, depth, axis=0))

    def _ramp(self, low: float, high: float) -> None:
        """Change the load from ``low`` to ``high``, shares of its value, and hold it."""
        ramp = self.settings.ramp
        self._advance(ramp, lambda t: low + (high - low) * t / ramp, ramp / 20)
        self._advance(HOLD, lambda t: high, ramp / 20)

    def _slide(self, peak: float) -> tuple[float, float]:
        """Let the string slide under its load; returns the distance [m] and the change of what it transmits."""
        # under a given top force the string slides once the load exceeds what friction carries off
        speed, pushed = self.sign * SPEED, self.model.case.top.force is not None
        self._settle(0.0 if pushed else speed)
        self._ramp(0.0, 1.0)
        if pushed:
            self._advance(START, lambda t: 1.0, START / 20, past=lambda t: speed * t / START)
        if peak > 1.0:
            self._ramp(1.0, peak)
            self._ramp(peak, 1.0)
        slid, change, log = 0.0, np.inf, []
        while slid < LONGEST_SLIDE - 1e-9 and change > STEADY:
            part = self._advance(SLIDE / SPEED, lambda t: 1.0, LONGEST_STEP / SPEED)
            log += [(slid + SPEED * t, force, torque) for t, force, torque in part]
            slid += SLIDE
            change = self._change(log)
        return slid, change

    def _settle(self, speed: float) -> None:
        """Let the string lie down while it slides with ``speed`` [m/s].

        On the first touch friction may swing between two directions in every Newton iteration, however short the step.
        The string then lies down with friction along the hole alone, and again with that of its motion.
        """
        start = Snapshot(self.model)
        self._friction(speed)
        try:
            self._advance(SETTLE, lambda t: 0.0, SETTLE / 10)
        except SolveError:
            start.restore()
            for component in self.components:
                component.impose_sliding_direction(self.sign * SPEED if speed else 0.0, 0.0, 0.0)
            self._advance(SETTLE, lambda t: 0.0, SETTLE / 10)
            self._friction(speed)
            self._advance(SETTLE, lambda t: 0.0, SETTLE / 10)

    def _slack_off(self) -> tuple[float, float]:
        """Lower the top onto the bit that stands, or raise the top's force; nothing slides."""
        if self._wob is None:
            self._settle(0.0)
            ramp = self.settings.ramp  # the load is not held: friction would creep
            self._advance(ramp, lambda t: t / ramp, ramp / RAMP_STEPS)
        else:
            self._run_in()
            self._friction(0.0)
            self._lower(self._wob)
        return 0.0, 0.0

    def _run_in(self) -> None:
        """Let the string slide with its bit above the bottom."""
        model, system, own = self.model, self.model.system, (self.settings, self._slip)
        dofs = system.layout.dofs["string.position"]
        system.assembly.x[dofs] -= LIFT * self._tangent[system.chain.vertices]
        model.top.shift(-LIFT)
        self.settings, self._slip = SETTINGS["sliding"], SETTINGS["sliding"].slip
        self._settle(SPEED)
        self._advance(RUN_IN / SPEED, lambda t: 0.0, LONGEST_STEP / SPEED)
        self.settings, self._slip = own

    def _lower(self, target: float) -> None:
        """Lower the top until the bit carries ``target`` [N]; raises SolveError if it does not."""
        way = LIFT + MOST_LOWERING * target * axial_compliance(self.model.mesh) + 1.0
        log = self._advance(way / LOWERING, lambda t: 1.0, 0.02 / LOWERING, speed=LOWERING, target=target)
        wob = self._end_forces()[1]
        if abs(wob - target) > 10 * WEIGHT_TOLERANCE * target:
            units = self.model.case.shown_units
            raise SolveError(
                f"locked up: the bit carries {shown(wob, 'force', units)} after the top was lowered by {shown(log[-1][0] * LOWERING, 'length', units, 3)}, "
                f"not {shown(target, 'force', units)}; friction takes the rest",
                hint="less weight, less friction, rotation, or a stiffer string",
            )

    def _advance(
        self,
        duration: float,
        load: Callable[[float], float],
        longest: float,
        speed: float = 0.0,
        target: float | None = None,
        past: Callable[[float], float] | None = None,
        first: float = FIRST_STEP,
    ) -> list[tuple[float, float, float]]:
        """Advance by ``duration`` [s] under ``load(t)`` with steps of ``longest`` [s] at most.

        speed: of the top [m/s, down]; target: weight on bit [N] at which the advance ends.
        past(t): speed of the string past the hole [m/s]; None: it does not change.  first: length of the first step [s].
        Returns (time, transmitted force, surface torque) after each step.  Raises SolveError if the steps collapse.
        """
        model, system = self.model, self.model.system
        asm, n = system.assembly, system.layout.size
        t, dt, last, last_dt, log = 0.0, first, None, 1.0, [(0.0, *self._transmitted())]
        if speed:  # friction is that of a string that moves with its top
            last = np.zeros(n)
            last[system.layout.dofs["string.position"]] = speed * self._tangent[system.chain.vertices]
        while t < duration - 1e-9:
            d = min(dt, longest, duration - t)
            d = duration - t if d > 0.9 * (duration - t) else d
            before = Snapshot(model)
            self._set_load(load(t + d))
            if past is not None:
                self._friction(past(t + d))
            guess = last * (d / last_dt) if last is not None and d <= 2 * last_dt else None
            iterations = self._step(before, d, speed * d, guess)
            wob = self._end_forces()[1] if target and iterations is not None else 0.0
            beyond = target is not None and wob > (1 + WEIGHT_TOLERANCE) * target
            if iterations is None or beyond:
                before.restore()
                dt, last = d / (2 if beyond else 4), (last if beyond else None)
                if dt < SHORTEST_STEP:
                    raise SolveError(
                        "the path of the buckled string ends: its steps collapse",
                        hint="shorter elements, or a smaller load",
                        **system.locate_largest_residual(0.0),
                    )
                continue
            t, last, last_dt = t + d, asm.x[:n] - before.x[:n], d
            self.steps += 1
            log.append((t, *self._transmitted()))  # the flow's solve leaves no reactions
            if model.fluid is not None and self.steps % FLOW_STEPS == 0:
                self._renew_flow()
            if target is not None and wob >= (1 - WEIGHT_TOLERANCE) * target:
                break
            if self.steps > self.most_steps:
                raise SolveError(f"the path of the buckled string did not end in {self.most_steps} steps")
            factor = 2.0 if iterations <= 6 else 1.5 if iterations <= 10 else 1.0 if iterations <= 18 else 0.7
            if d >= 0.5 * min(dt, longest):
                dt = min(d * factor, longest)
        return log

    def _step(self, before: Snapshot, dt: float, moved: float, guess: FloatArray | None) -> int | None:
        """Take a step of implicit Euler of ``dt`` [s] from ``before``; returns its iterations, None if it does not converge.

        moved: way of the top [m, down].  guess: (n,) first guess of the motion; if it fails, a string that is not near its own state
        tries again without it.
        """
        settings, solver = self.settings, self.solver
        # drag along the string would keep the motion of the top from the bit, which it has to bring to its weight
        along = settings.along if solver.depth is None else AXIAL_SHARE
        again = guess is not None and self.most_steps != MOST_STEPS_ON
        for guessed in (guess, None) if again else (guess,):
            before.restore()
            self.model.top.shift(moved)
            iterations = self.report.iterations
            try:
                with solver.drag(Drag(settings.drag / dt, along, settings.arm, 1.0 / dt)):
                    if guessed is not None:
                        solver.move(guessed)
                    solver.newton(self.report, STEP_INCREMENT, STEP_ITERATIONS)
                return self.report.iterations - iterations
            except SearchEnded:
                raise
            except SolveError:
                continue
        return None

    def _renew_flow(self) -> None:
        """Solve for the steady flow about the present string, and freeze it."""
        system, rates = self.model.system, self.model.system.assembly.y
        before = rates.copy()
        rates[:] = 0.0 if self._surge is None else self._surge
        fluid = fluid_unknowns(system)
        system.assembly.hold_rates(None)
        steady_flow(system, 0.0)
        system.assembly.freeze(fluid)
        system.assembly.hold_rates(fluid, self._surge)
        rates[:] = before

    def _transmitted(self) -> tuple[float, float]:
        """What depends on the path: the weight on bit under a given top force, else the hook load [N]; and the torque
        at the top of a string that turns [N m], else 0."""
        hook, wob = self._end_forces()
        return wob if self.model.case.top.force is not None else hook, self._torque() if self.turns else 0.0

    def _torque(self) -> float:
        """Torque at the top [N m]."""
        system, drive = self.model.system, self.model.part(Drive)
        own = drive.torque(0.0, system.assembly) if drive is not None else 0.0
        return float(system.reaction("top.torque_reaction")) + self.solver.sum(float(own))

    def _end_forces(self) -> tuple[float, float]:
        """Hook load and weight on bit [N]."""
        model, force = self.model, self.model.case.top.force
        hook = force.value(0.0) if force is not None else -model.system.reaction("top.axial_reaction")
        wob = model.bit.weight_and_torque(model.system.assembly)[0] if model.bit is not None else 0.0
        return float(hook), self.solver.sum(wob)

    def _change(self, log: list[tuple[float, float, float]]) -> float:
        """Change of the means of what the string transmits from the third to the last quarter of ``log``: of the force
        over the push, or of the torque over itself, whichever is larger."""
        t, *values = np.array(log).T
        step = np.diff(np.concatenate([[0.0], t]))
        end, means = t[-1], []
        for low, high in ((0.5, 0.75), (0.75, 1.0)):
            there = (t > low * end) & (t <= high * end + 1e-9)
            means.append([float(np.average(v[there], weights=step[there])) for v in values])
        (force, torque), (last_force, last_torque) = means
        return max(
            abs(last_force - force) / self._scale, abs(last_torque - torque) / max(abs(last_torque), 1.0)
        )

    # ------------------------------------------------------------------ closing
    def _held(self) -> FloatArray:
        """Forces (n,) on free unknowns that the equilibrium lacks at the end of a path.

        Those of drag and friction, which is set aside; of a string that turns the drag's alone.
        """
        self._friction_at_end()
        out = self.solver.rows()
        for f in self.model.system.assembly.row_replacements:
            out[f.rows] = f.row_complement @ out[f.rows]
        return out

    def _friction_at_end(self) -> None:
        """Friction of the state that a path ends in: of a string that turns against the imposed motion, else a dead load."""
        for component in self.components:
            component.impose_sliding_direction(*(self.velocity if self.turns else (0.0, 0.0)), 0.0)

    def answer(self, ends: tuple[PathEnd, ...], failed: tuple[tuple[str, str], ...] = ()) -> PathAnswer:
        """What the ``ends`` of paths, that of the present state first, say; ``failed``: as of ``PathAnswer``."""
        return PathAnswer(
            kind=self.kind,
            ends=ends,
            persistent_load=self.seeds,
            force_given=self.model.case.top.force is not None,
            turns=self.turns,
            failed=failed,
            held_end=end_is_held(self.model),
            may_slack_off=may_slack_off(self.model, self.velocity),
        )


def follow_paths(path: FrictionPath, starts: tuple[str, ...]) -> PathAnswer:
    """Follow a path from each of ``starts``; the system is left in the state of the first; collective.

    Raises SolveError if the first has no end.
    """
    ends, failed = [], []
    for start in starts[:0:-1]:  # the first one last, so that its state stays
        try:
            ends.append(path.follow(start))
        except SolveError as error:
            failed.append((start, str(error).splitlines()[0]))
    ends.append(path.follow(starts[0]))
    return path.answer(tuple(ends[::-1]), tuple(failed))
