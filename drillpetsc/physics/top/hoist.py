"""Block on a drilling line at the upper end, its drum and the autodriller that turns it.

Kernel: kernels/top/hoist.hpp.  Manual: sec-hoist.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.component import DRIVE, Component, ElementBlock, Energies, Field, Powers, Start
from drillpetsc.fem.quantity import Quantity
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.end_conditions import EndPlace, Input, PathEnd
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.physics.top.hoisting import LOOPS, Autodriller, Hoisting, dead_line_share
from drillpetsc.unit_systems import shown

_evaluate = function("hoist_line_results", "ippppp" + "p")
RESULTS = columns("hoist_line_results")
#: states in the order of the kernel: name, scale
STATES = (
    ("hoist.pay_out", 1.0),
    ("hoist.weight_integral", 1e-2),
    ("hoist.torque_integral", 1e-2),
    ("hoist.pressure_integral", 1e-2),
    ("hoist.weight", 1e5),
    ("hoist.torque", 1e4),
    ("hoist.pressure", 1e6),
)
TIMED = (
    "given",
    "heave",
    "heave_rate",
    "closed",
    "set",
    "measured",
    "rate",
)  # parameters that follow the time
PAY_OUT, INTEGRAL, FILTERED = 7, 8, 11  # places among the kernel's unknowns
REVERSAL = 1e-4  # speed of the block over which the friction of the sheaves turns [m/s]
NEAR = 1e-9  # times that differ by less of their size are one
OPEN = 1e3  # limits of the drum's speed that are none [m/s]
#: what is shared between ranks after a step
SHARED = ("time", "height", "depth", "line", "hook", "load", "wob", "torque", "differential_pressure")
#: columns of ``Hoist.figures``
FIGURES = (
    "block_position", "block_speed", "drum_speed", "line_tension", "dead_line_tension", "hook_load_sensor",
    "wob_surface", "autodriller_mode",
)  # fmt: skip


class HoistedTop(PathEnd):
    """Guided top whose axial position is prescribed in statics and free in motion.

    The axial row of the directions is zero while it is free.
    """

    name = "top_drive"

    def __init__(self, place: EndPlace, rotation: Input | None):
        super().__init__(place, axial=True, tilt=True, spin=rotation is not None, rotation=rotation)
        self.free = False
        self._fixed = self._condition
        self._condition = replace(self._fixed, along_path=self._at_free, rate=self._rate)

    def _rate(self, t: float) -> FloatArray:
        return self._fixed.rate(t)

    def _at_free(
        self, t: float, x: FloatArray, y: FloatArray | None
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Directions (m, 7), values and rates (m,) as for ``PathEnd._at``; a free axial row is zero."""
        if self._path is None:
            D, value, rate = np.array(self._fixed.directions), self._fixed.value(t), self._fixed.rate(t)
        else:
            self._axial_row = not self.free
            D, value, rate = self._at(t, x, y)
            if self.free:
                D, value, rate = np.vstack([np.zeros(7), D]), np.append(0.0, value), np.append(0.0, rate)
        if self.free:
            D[0], value[0], rate[0] = 0.0, 0.0, 0.0
        return D, value, rate

    def place(self) -> tuple[float, FloatArray, FloatArray]:
        if self._path is None:
            return 0.0, np.zeros(3), self._fixed.directions[0, :3]
        return self.depth, self._path.at(self.depth).centre, self._path.at(self.depth).axes[0]


class Hoist(Component):
    """Block, drum and what turns it, above the top.

    ``sensors``: measurements that are not known to the component, by name: this rank's share as a function of
    the time [s] and the state.
    """

    free_length = "hoist.pay_out"  # nothing returns a drum of given speed
    sensors: Mapping[str, Callable[[float, Any], float]] = {}

    def figures(self, t: float, state: Any) -> FloatArray:
        """Numbers of its quantities at the time ``t`` [s], in the order of ``FIGURES``; this rank's share."""
        raise NotImplementedError

    def sensed_loop(self) -> str | None:
        """Loop in charge after ``balance`` whose measurement is one of ``sensors``; None without."""
        return None

    def set_measured(self, kind: str, value: float) -> float:
        """Set the measurement of a loop of ``sensors``; returns the one before, on the rank with the block."""
        return 0.0


class HoistLine(Hoist):
    """Block that hangs on a drilling line; the drum pays out by a given speed or by an autodriller.

    gear: masses and line; top: the guided top; lowering: speed of the drum while no autodriller acts [m/s].
    gravity: (3,) [m/s2]; nodes: of the string; autodriller: None without.
    statics: the run starts in a static state, in which the weight on bit is tared.
    """

    name = "hoist"

    def __init__(
        self,
        gear: Hoisting,
        top: HoistedTop,
        lowering: Input,
        gravity: FloatArray,
        nodes: int,
        autodriller: Autodriller | None = None,
        statics: bool = True,
    ):
        assert gear.line is not None
        self.gear, self.line, self.top, self.autodriller = gear, gear.line, top, autodriller
        self.lowering, self._gravity, self._statics = lowering, gravity, statics
        self._at_top = np.arange(nodes) == 0
        self._now, self._share, self._changed = 0.0, 1.0, True
        #: of linear models: the loop in charge, as the column autodriller_mode numbers it, and what its set point is raised by
        self._linear: tuple[str, float] | None = None
        #: stretch of the lines at the start [m]
        self.stretch = 0.0
        # travel's zero on the path [m], hook load without weight [N], pressure off bottom [Pa], rise of the floor before
        # this run [m]
        self._reference = self._tare = self._tare_pressure = self._lifted = 0.0
        self._acting = False  # whether the autodriller has begun
        # time [s] and set point [N], of the last step, from which the set point of the weight follows
        self._ramp_start = (0.0, 0.0)
        self._last = np.full(len(SHARED), np.nan)  # after the last step
        self._samples = np.full((2, len(SHARED)), np.nan)  # the last measurements and those before
        self.slack: float | None = None  # time from which the lines are pushed [s]
        self.update_size = len(SHARED)
        drill = autodriller
        self._loops = {q.kind: q for q in drill.loops} if drill is not None else {}
        #: whether a loop's measurement is a sample
        self._sensed = [drill is not None and (drill.at_bit or drill.sample > 0), True, True]

    # ------------------------------------------------------------------ discretisation
    def regions(self) -> dict[str, np.ndarray]:
        """The vertex of the top, and no vertex for states that the autodriller does not have."""
        return {"top": self._at_top, "nowhere": np.zeros_like(self._at_top)}

    def fields(self) -> tuple[Field, ...]:
        filtered = self.autodriller is not None and self.autodriller.filter > 0
        present = [True]
        present += [kind in self._loops and self._loops[kind].i > 0 for kind in LOOPS]
        present += [kind in self._loops and filtered for kind in LOOPS]
        return tuple(
            Field(
                name, 1, region="top" if here else "nowhere", scale=scale, second_order=False, physics=DRIVE
            )
            for (name, scale), here in zip(STATES, present, strict=True)
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([0]))
        drill, line = self.autodriller, self.line
        loops = [self._loops.get(kind) for kind in LOOPS]
        self.params = Parameters(
            "hoist_line",
            len(vertices),
            locked=1.0,
            axis=self.top.place()[2],
            origin=0.0,
            travel=0.0,
            mass=self.gear.mass,
            weight=0.0,
            modulus=line.modulus,
            rope=line.rope,
            lines=float(line.lines),
            stretch=0.0,
            damping=line.damping,
            heave=0.0,
            heave_rate=0.0,
            closed=0.0,
            given=0.0,
            least=drill.least if drill is not None else 0.0,
            most=drill.most if drill is not None else 0.0,
            used=[float(q is not None) for q in loops],
            set=0.0,
            proportional=[q.p if q is not None else 0.0 for q in loops],
            integration=[q.i if q is not None else 0.0 for q in loops],
            filter=[drill.filter if drill is not None and q is not None else 0.0 for q in loops],
            sensed=[float(q) for q in self._sensed],
            measured=0.0,
            tare=0.0,
            rated=float(drill is not None and drill.rate is not None),
            rate=0.0,
        )
        self._views = {name: self.params[name] for name in TIMED}
        slots = (*VERTEX_SLOTS, *((name, 0) for name, _ in STATES))
        self._block = ElementBlock(
            "hoist", "hoist_line", "vertex", vertices, slots, (0,), self.params.array, update=self._update
        )
        return (self._block,)

    @property
    def _here(self) -> bool:
        """Whether this rank has the block."""
        return len(self._block.points) > 0

    def _update(self, t: float) -> None:
        p, drill = self._views, self.autodriller
        self._now = t
        if self._changed or self.top.on_path:
            self._place_block()
        if not self.top.free:
            return
        p["given"][:] = self._share * self.lowering.value(t)
        if self.gear.heave is not None:
            p["heave"][:], p["heave_rate"][:] = (self._share * q for q in self.gear.heave.crown(t))
        if drill is None:
            return
        if self._linear is not None:
            kind, raised = self._linear
            if kind == "rop" and drill.rate is not None:
                p["rate"][:] = drill.rate.value(t) + raised
            elif kind != "rop":
                p["set"][:, LOOPS.index(kind)] = self._loops[kind].goal.value(t) + raised
            return
        p["closed"][:] = self._acting
        for j, kind in enumerate(LOOPS):
            if kind in self._loops:
                p["set"][:, j] = self._goal(kind, t)
                if self._sensed[j]:
                    p["measured"][:, j] = self._measured(kind, t)
        if drill.rate is not None:
            p["rate"][:] = drill.rate.value(t)

    def _place_block(self) -> None:
        """Set what does not change between two starts on a straight path: axis, weight, stretch and tare."""
        p, self._changed = self.params, False
        p["locked"] = float(not self.top.free)
        depth, centre, tangent = self.top.place()
        p["axis"], p["origin"], p["travel"] = tangent, centre, depth - self._reference
        p["weight"] = self.gear.mass * float(self._gravity @ tangent)
        p["stretch"], p["tare"] = self.stretch, self._tare

    def _goal(self, kind: str, t: float) -> float:
        """Set point of a loop at ``t`` [s]; the set point of the weight changes at most at the given rate."""
        now = float(self._loops[kind].goal.value(t))
        ramp = self.autodriller.ramp if self.autodriller is not None else 0.0
        if kind != "wob" or not ramp:
            return now
        start, value = self._ramp_start
        most = ramp * max(0.0, t - start)
        return min(max(now, value - most), value + most)

    def _measured(self, kind: str, t: float) -> float:
        """Measurement ``kind`` at ``t`` [s]: the last sample, or on a straight line through the last two steps."""
        drill = self.autodriller
        assert drill is not None
        k = SHARED.index("load" if kind == "wob" and not drill.at_bit else kind)
        (t0, t1), (earlier, last) = self._samples[::-1, 0], self._samples[::-1, k]
        if np.isnan(last):
            return 0.0
        if not drill.sample and t0 < t1:
            last += (last - earlier) / (t1 - t0) * (t - t1)
        return float(last - (self._tare_pressure if kind == "differential_pressure" else 0.0))

    def breaks(self) -> tuple[float, ...]:
        found = set(self.lowering.breaks())
        if self.gear.heave is not None:
            found |= set(self.gear.heave.amplitude.breaks())
        if self.autodriller is not None:
            found |= {self.autodriller.start} - {0.0}
            goals = [q.goal for q in self._loops.values()]
            goals += [self.autodriller.rate] if self.autodriller.rate is not None else []
            found |= {b for goal in goals for b in goal.breaks()}
        return tuple(sorted(found))

    # ------------------------------------------------------------------ statics and start
    def hold(self) -> None:
        self.top.free, self._changed = False, True

    def begin_motion(self, state: Any, start: Start) -> None:
        """The static load stretches the line; the drum of a start at rest does not turn."""
        self._share = 0.0 if start.at_rest else 1.0
        hook_load, shared = start.hook_load, start.total(self.local_update(state)).copy()
        wob = float(shared[SHARED.index("wob")])
        shared[SHARED.index("time")] = 0.0
        self._acting = self.autodriller is not None and self.autodriller.start == 0
        if self.top.free:  # continues another run, whose heave ended at another height
            if self.gear.heave is not None:
                self.stretch += self.gear.heave.crown(self._now)[0]
                self._lifted += self._risen(self._now)
            self._now, self._changed = 0.0, True
            self._last, self._samples[:] = shared, (shared, shared)
            self._ramp_start, self.slack = (0.0, self._ramp_start[1]), None
            return
        self.top.free, self._changed = True, True
        state.invalidate_prescribed_values()
        weight = self.gear.mass * float(self._gravity @ self.top.place()[2])
        self._reference = float(self.top.anchor[0])
        self.stretch = (hook_load + weight) / self.line.stiffness
        self._tare, self._ramp_start = hook_load + wob, (0.0, wob)
        for name, value in (
            ("height", self.gear.height),
            ("depth", 0.0),
            ("line", hook_load + weight),
            ("hook", hook_load),
            ("load", wob),
        ):
            shared[SHARED.index(name)] = value
        self._last, self._samples[:] = shared, (shared, shared)
        self._tare_pressure = float(shared[SHARED.index("differential_pressure")])
        if not self._here:
            return
        index, size = state.index_of(self._block)[0], state.layout.size
        speed = self._share * self.lowering.value(0.0)
        values = [0.0, speed, speed, speed, wob, shared[SHARED.index("torque")], 0.0]
        for place, value in zip(index[PAY_OUT:], values, strict=True):
            if place < size:
                state.x[place] = value
        self._update(0.0)

    def balance(self, state: Any) -> str:
        drill = self.autodriller
        if drill is None:
            return ""
        measured = {kind: self._measured(kind, 0.0) for kind in self._loops}
        speed = self._share * self.lowering.value(0.0)
        wanted = {
            kind: speed + q.p * (float(q.goal.value(0.0)) - measured[kind]) for kind, q in self._loops.items()
        }
        if drill.rate is not None:
            wanted["rop"] = float(drill.rate.value(0.0))
        kind = min(wanted, key=lambda k: wanted[k])
        if kind == "rop" and drill.rate is not None:
            raised = speed - float(drill.rate.value(0.0))
        else:
            loop = self._loops[kind]
            # without an integrator the error gives the speed
            raised = measured[kind] - float(loop.goal.value(0.0)) + (0.0 if loop.i else speed / loop.p)
        self._linear = kind, raised
        if self._here:
            p = self.params
            p["closed"], p["least"], p["most"] = 1.0, -OPEN, OPEN
            p["used"], p["rated"] = [float(q == kind) for q in LOOPS], float(kind == "rop")
            p["measured"] = [measured.get(q, 0.0) for q in LOOPS]
            self._update(0.0)
        if kind == "rop":
            return "the autodriller holds the speed of the drum (rop): no loop of it is closed"
        others = " of its loops" if len(wanted) > 1 else ""
        return f"the autodriller's loop {kind} is in charge{others}, about the present state and inside the limits"

    def sensed_loop(self) -> str | None:
        if self._linear is None or self._linear[0] == "rop":
            return None
        kind = self._linear[0]
        return kind if self._sensed[LOOPS.index(kind)] else None

    def set_measured(self, kind: str, value: float) -> float:
        j = LOOPS.index(kind)
        if not self._here:
            return 0.0
        before = float(self.params["measured"][0, j])
        self.params["measured"][:, j] = value
        return before

    def at_break(self, t: float, state: Any) -> bool:
        """Start the autodriller from the present speed of the drum; True if states change."""
        drill = self.autodriller
        if drill is None or self._acting or t < drill.start - NEAR * max(1.0, t):
            return False
        self._acting = True
        last = dict(zip(SHARED, map(float, self._last), strict=True))
        if not self._statics:
            self._tare, last["load"] = last["hook"] + last["wob"], last["wob"]
            self._changed = True
        self._ramp_start = t, last["wob" if drill.at_bit else "load"]
        self._tare_pressure = last["differential_pressure"]
        if not self._here:
            return False
        index, size = state.index_of(self._block)[0], state.layout.size
        speed = self._share * self.lowering.value(float(np.nextafter(t, -np.inf)))
        values = {INTEGRAL: speed, INTEGRAL + 1: speed, INTEGRAL + 2: speed, FILTERED + 2: 0.0}
        if not self._statics:
            values[FILTERED] = last["load"]
        for place, value in values.items():
            if index[place] < size:
                state.x[index[place]] = value
        return True

    # ------------------------------------------------------------------ history
    def local_update(self, state: Any) -> FloatArray:
        """(9,) this rank's part of ``SHARED``."""
        out = np.zeros(len(SHARED))
        for name, sensor in self.sensors.items():
            out[SHARED.index(name)] = sensor(self._now, state)
        if self._here and self.top.free:
            r = self._results(state)
            depth, line, hook, load = (r[RESULTS[k]] for k in ("depth", "line", "hook", "load"))
            if self._sensed[0]:  # the loop has the last sample: measure anew
                load = self._tare - hook
            out[:6] = self._now, self._height(depth, self._now), depth, line, hook, load
        return out

    def _height(self, depth: float, t: float) -> float:
        """Height of the block over the floor [m] after the travel ``depth`` [m]."""
        return self.gear.height - depth - self._lifted - self._risen(t)

    def _risen(self, t: float) -> float:
        """Rise of the floor since the time 0 [m]."""
        heave = self.gear.heave
        return 0.0 if heave is None else heave.floor(t)[0] - heave.floor(0.0)[0]

    def apply_update(self, total: FloatArray) -> None:
        """Keep the measurements of a step; raises SolveError if the block meets the floor or the crown."""
        t, height, depth, line = total[:4]
        if not self.top.free or t <= self._last[0]:
            return
        before, last = self._last[:2]
        limit = 0.0 if height < 0 else self.gear.crown
        when = before + (t - before) * (limit - last) / (height - last) if height != last else t
        check_height(self.gear, float(when), float(height), float(depth))
        if line < 0 and self.slack is None:
            self.slack = float(t)
        every, before = self.autodriller.sample if self.autodriller is not None else 0.0, self._samples[0, 0]
        self._last = total
        if not every or np.floor(t / every + 1e-6) > np.floor(before / every + 1e-6):
            self._samples[1], self._samples[0] = self._samples[0], total
        if self.autodriller is not None and self.autodriller.ramp and t >= self.autodriller.start:
            self._ramp_start = float(t), self._goal("wob", float(t))

    def get_state(self) -> dict[str, FloatArray]:
        if not self.top.free:
            return {}
        slack = np.nan if self.slack is None else self.slack
        numbers = [self._reference, self.stretch, self._tare, self._tare_pressure, self._lifted]
        numbers += [float(self._acting), slack, *self._ramp_start]
        return {"numbers": np.array(numbers), "last": self._last.copy(), "samples": self._samples.copy()}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        self.top.free, self._changed = True, True
        numbers = [float(q) for q in state["numbers"]]
        self._reference, self.stretch, self._tare, self._tare_pressure, self._lifted = numbers[:5]
        acting, slack, *start = numbers[5:]
        self._acting = bool(acting)
        self.slack = None if np.isnan(slack) else slack
        self._ramp_start = start[0], start[1]
        self._last[:], self._samples[:] = state["last"], state["samples"]
        self._now = float(self._last[0])

    # ------------------------------------------------------------------ outputs
    def _results(self, state: Any) -> FloatArray:
        """(10,) results by the names of ``RESULTS``; zero on ranks without the top."""
        out = np.zeros((len(self._block.points), RESULTS.width))
        if not len(out):
            return np.zeros(RESULTS.width)
        index, p = state.index_of(self._block), self.params.array
        _evaluate(len(out), *map(pointer, (index, p, state.x, state.y, state.a, out)))
        return out[0]

    def figures(self, t: float, state: Any) -> FloatArray:
        if not self._here:
            return np.zeros(len(FIGURES))
        self._update(t)
        r = self._results(state)
        depth, speed, drum, line, hook, mode = (
            r[RESULTS[k]] for k in ("depth", "speed", "drum", "line", "hook", "mode")
        )
        crown = self.gear.heave.crown(t)[1] if self.gear.heave is not None else 0.0
        anchor = dead_line_tension(self.gear, line, speed + crown)
        weight = self.gear.mass * float(self._gravity @ self.top.place()[2]) if self.gear.tare else 0.0
        return np.array(
            [
                self._height(depth, t),
                speed,
                drum,
                line,
                anchor,
                self.gear.lines * anchor - weight,
                self._tare - hook,
                mode,
            ]
        )

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.HOIST + (declared.AUTODRILLER if self.autodriller is not None else ())

    def hook_load(self, t: float, state: Any) -> float:
        """Pull on the string [N], this rank's share."""
        if not self._here:
            return 0.0
        self._update(t)
        return float(self._results(state)[RESULTS["hook"]])

    def energies(self, t: float, state: Any) -> Energies:
        if not self._here or not self.top.free:
            return Energies()
        self._update(t)
        r, (_, centre, tangent) = self._results(state), self.top.place()
        position = state.x[state.index_of(self._block)[0, :3]]
        foot = centre + tangent * (tangent @ (position - centre))
        return Energies(
            0.5 * self.gear.mass * float(r[RESULTS["speed"]]) ** 2,
            float(r[RESULTS["energy"]]),
            -self.gear.mass * float(self._gravity @ foot),
        )

    def powers(self, t: float, state: Any) -> Powers:
        if not self._here or not self.top.free:
            return Powers()
        self._update(t)
        r = self._results(state)
        return Powers(float(r[RESULTS["lost"]]), float(r[RESULTS["supplied"]]))


class RigidHoist(Hoist):
    """Block that moves with the drum: the lines do not stretch, and the top's motion is prescribed.

    gear: without a line; speed: of the block over time, down [m/s]; drum: of the drum; weight: of the block [N].
    """

    name = "hoist"

    def __init__(self, gear: Hoisting, speed: Input, drum: Input, weight: float):
        self.gear, self.speed, self.drum, self._weight = gear, speed, drum, weight

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        self._here = len(local_vertices(part, np.array([0]))[1]) > 0
        return ()

    def figures(self, t: float, state: Any) -> FloatArray:
        hook = self.sensors["hook"](t, state)
        gear, depth, speed = self.gear, self.speed.integral(t), self.speed.value(t)
        risen, crown = 0.0, 0.0
        if gear.heave is not None:
            risen, crown = gear.heave.floor(t)[0] - gear.heave.floor(0.0)[0], gear.heave.crown(t)[1]
        check_height(gear, t, gear.height - depth - risen, depth)
        if not self._here:
            return np.zeros(len(FIGURES))
        line = hook + self._weight - gear.mass * self.speed.rate(t)
        anchor = dead_line_tension(gear, line, speed + crown)
        sensor = gear.lines * anchor - (self._weight if gear.tare else 0.0)
        return np.array(
            [gear.height - depth - risen, speed, self.drum.value(t), line, anchor, sensor, 0.0, 0.0]
        )

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.HOIST


def dead_line_tension(gear: Hoisting, line: float, speed: float) -> float:
    """Compute the dead-line tension [N] under the force ``line`` [N] of all lines (manual: eq-hoist-sheaves).

    speed: of the block below the crown, down [m/s].
    """
    down = float(np.tanh(speed / REVERSAL))
    rest = 1.0 / gear.lines
    moving = dead_line_share(gear.efficiency, gear.lines, down > 0)
    return line * (rest + abs(down) * (moving - rest))


def check_height(gear: Hoisting, t: float, height: float, travel: float) -> None:
    """Raise SolveError for a block below the floor or above the crown.

    t: time of passing [s]; height: of the block over the floor; travel: of the block [m].
    """
    for passed, what, key in (
        (height < 0, "floor", "height"),
        (height > gear.crown, "crown", "crown_height"),
    ):
        if passed:
            raise SolveError(
                f"the block would pass the {what} at t = {t:.4g} s, after a travel of {shown(travel, 'length', gear.units)}: "
                "connections are not modelled",
                time=t,
                hint=f"end the run earlier, or give another top.hoist.{key}",
            )
